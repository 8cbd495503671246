"""Where the real recordings are, and a small file in the same format whose content is known."""

import os

import numpy as np
import pytest

from robins.field import psins
from robins.foundation.errors import InputError


@pytest.fixture(scope="session")
def recording_path(repository):
    """The verified upstream recording; tests that need it are skipped where there is none."""
    folder = os.environ.get("ROBINS_RECORDINGS") or repository.parent / "shared" / "data" / "raw"
    try:
        return psins.locate(folder)
    except InputError as error:
        if os.environ.get("ROBINS_RECORDINGS"):
            raise
        pytest.skip(f"no recording here (set ROBINS_RECORDINGS to the folder that holds it): {error}")


HEADER = """% PSINS-format SIMU log file. (DO NOT EDIT!)
% a comment

{roll} 0.000000 -90.600000 0.000000 0.000000 0.000000
34.24604800 108.90966400 380.000 5.00000000 {interval} 9.780327
0.100000 0.200000 0.300000 125.000 125.000 {scale}
"""


@pytest.fixture
def write_log(tmp_path):
    """Write a PSINS log of the given counts (rows of six) and return its path."""

    def write(rows, roll="0.000000", interval="10.00000000", scale="125.000"):
        path = tmp_path / "unit.imu"
        lines = [" ".join(map(str, row)) for row in rows]
        path.write_text(HEADER.format(roll=roll, interval=interval, scale=scale) + "".join(f"{line}\n" for line in lines))
        return path

    return write


@pytest.fixture
def rows():
    """Counts of a unit at rest: 80 counts of 125 ug s in 10 ms are 1 g."""
    rng = np.random.default_rng(8)
    gyros, level = rng.integers(-9, 10, (50, 3)), rng.integers(-2, 3, (50, 3))
    return np.hstack([gyros, level + [0, 0, 80]])
