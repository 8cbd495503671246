"""The benchmark's package, found from the root of the repository, and its kernels known only while its own tests run."""

import sys
from pathlib import Path

import pytest

from robins.kalman import extension

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

_before = set(extension._loose_ends)
import benchmarks.models  # noqa: E402, F401

KERNELS = extension._loose_ends - _before
extension._loose_ends -= KERNELS  # every other test may go on using the disk cache


@pytest.fixture(scope="package", autouse=True)
def kernels_outside_the_package():
    """Filters of the benchmark's model are compiled afresh, as in ``python -m benchmarks``."""
    extension._loose_ends |= KERNELS
    yield
    extension._loose_ends -= KERNELS
