"""Loops and BLAS are timed on the same product."""

import numpy as np
import pytest

from benchmarks.propagation import propagations
from benchmarks.steps import CASES


@pytest.mark.slow
@pytest.mark.parametrize("case", [case for case in CASES if "UKF" not in case])
def test_loops_and_blas_compute_the_same_covariance(case):
    by_loops, by_blas = (np.array(make()) for make in propagations(CASES[case](40)).values())
    np.testing.assert_allclose(by_loops, by_blas, rtol=1e-11, atol=1e-15 * np.abs(by_blas).max())
