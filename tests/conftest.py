"""What every test shares: one thread for each BLAS, figures without a display, the same examples in every run, and two processes."""

import os
import shutil
from collections import Counter
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


def pytest_xdist_auto_num_workers(config) -> int:
    """Two processes for the whole suite; none of their own for a part of it, nor for a test that runs pytest.

    Each process compiles what the other has not yet left in the cache, so that a third one, or two for a few files, gain nothing.
    """
    whole = config.args_source == config.ArgsSource.TESTPATHS
    return 2 if whole and "PYTEST_XDIST_WORKER" not in os.environ else 0


def pytest_collection_modifyitems(config, items):
    """Skip what needs a SLURM cluster where there is none; in two processes, begin with the files that take longest."""
    if not shutil.which("sbatch"):
        for item in items:
            if item.get_closest_marker("slurm"):
                item.add_marker(pytest.mark.skip(reason="no SLURM cluster here (sbatch not found)"))
    if hasattr(config, "workerinput"):
        slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
        items.sort(key=lambda item: -slow[item.path])
