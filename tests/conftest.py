"""What every test shares: one thread for each BLAS, figures without a display, and the same examples in every run."""

import os
import shutil
from pathlib import Path

# The libraries read these when they are first imported, so they stand above every import of them.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["MPLBACKEND"] = "Agg"

import hypothesis  # noqa: E402
import pytest  # noqa: E402

# Derandomised: a red build must be red for everybody. No deadline: a first example may compile a kernel.
hypothesis.settings.register_profile("robins", derandomize=True, deadline=None, print_blob=True)
hypothesis.settings.load_profile("robins")


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the source tree."""
    return Path(__file__).resolve().parents[1]


def pytest_collection_modifyitems(items):
    """Skip what needs a SLURM cluster where there is none."""
    if shutil.which("sbatch"):
        return
    for item in items:
        if item.get_closest_marker("slurm"):
            item.add_marker(pytest.mark.skip(reason="no SLURM cluster here (sbatch not found)"))
