"""``F P F^T + Q`` by this package's loops and by BLAS, for the F, P and Q that a drive has in its middle."""

from collections.abc import Callable

import numpy as np
from numba import njit

from benchmarks.models import Drive
from benchmarks.ours import run_whole
from robins.kalman.model import linearise
from robins.kalman.predict import propagate_covariance

CALLS = 1000
"""Products that one timed call makes."""


@njit
def matrices_at(model, x, u, F, Q):
    """F and Q of one step."""
    linearise(model, x, u, F, Q)


@njit
def by_loops(F, Q, FP, start, P):
    """`CALLS` products with the kernel that the filters use."""
    for _ in range(CALLS):
        P[:] = start
        propagate_covariance(F, Q, FP, P)


@njit
def by_blas(F, Q, FP, FT, start, P):
    """`CALLS` products with ``np.dot``, which Numba hands to BLAS, into arrays that are there already."""
    for _ in range(CALLS):
        np.dot(F, start, FP)
        np.dot(FP, FT, P)
        P += Q


def propagations(drive: Drive) -> dict[str, Callable[[], np.ndarray]]:
    """Both ways of the product, ready to be timed; each returns what it computed."""
    states, covariances, _ = run_whole(drive)
    middle, n = len(states) // 2, drive.P0.shape[0]
    F, Q, FP, P = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    matrices_at(drive.model, states[middle].copy(), drive.controls[middle], F, Q)
    start, FT = np.ascontiguousarray(covariances[middle]), np.ascontiguousarray(F.T)

    def loops() -> np.ndarray:
        by_loops(F, Q, FP, start, P)
        return P

    def blas() -> np.ndarray:
        by_blas(F, Q, FP, FT, start, P)
        return P

    return {"loops": loops, "BLAS": blas}
