"""Prediction: extended (linearised) and unscented. Both work with any model.

References: Julier & Uhlmann 2004, Proc. IEEE 92(3); Wan & van der Merwe 2000 (scaled sigma points).
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import overload

from robins.foundation.smallmat import assign, cholesky, congruence, kernel, multiply
from robins.kalman.model import linearise, propagate


class Ekf(NamedTuple):
    """Prediction by the Jacobian; exact for a linear model."""


class Ukf(NamedTuple):
    """Prediction by scaled sigma points with spread `alpha`, prior knowledge `beta` and secondary scaling `kappa`."""

    alpha: float = 1e-3
    beta: float = 2.0
    kappa: float = 0.0


@kernel
def propagate_covariance(F, Q, FP, P):
    """``P <- F P F^T + Q``; leaves ``F P`` in `FP`."""
    multiply(F, P, FP)
    congruence(FP, F, Q, P)  # (20) imani2026


@kernel
def add_covariance(P, Q):
    """``P += Q`` for symmetric matrices."""
    for i in range(P.shape[0]):
        for j in range(P.shape[0]):
            P[i, j] += Q[i, j]


def predict(predictor, model, x, P, u, work):
    """Replace `x` ``(n,)`` and `P` ``(n, n)`` by their predictions one step ahead with the input `u` ``(l,)``.

    Leaves the Jacobian in ``work.F`` and ``F P`` (the covariance between the predicted and the present state)
    in ``work.FP``; for the UKF ``work.FP`` is the same covariance by sigma points.

    Returns
    -------
    bool
        False when `P` has no Cholesky factor and sigma points are asked for; `x` and `P` are then as they were.
    """
    raise NotImplementedError("predict runs inside compiled code")


@overload(predict, jit_options={"forceinline": True})
def _predict(predictor, model, x, P, u, work):
    kind = getattr(predictor, "instance_class", None)
    if kind is Ekf:

        def extended(predictor, model, x, P, u, work):
            F, Q, FP = work.F, work.Q, work.FP
            linearise(model, x, u, F, Q)
            propagate(model, x, u)
            propagate_covariance(F, Q, FP, P)
            return True

        return extended
    if kind is Ukf:

        def unscented(predictor, model, x, P, u, work):
            linearise(model, x, u, work.F, work.Q)
            n = x.size
            centre, spread = ukf_constants(predictor, n)
            if not sigma_points(x, P, spread, work.T, work.points):
                return False
            assign(work.points[1 : n + 1], work.A)  # before propagation, for the cross-covariance
            before = x.copy()
            for point in work.points:
                propagate(model, point, u)
            sigma_moments(predictor, centre, spread, before, x, P, work)
            add_covariance(P, work.Q)
            return True

        return unscented
    return None


@njit(cache=True)
def ukf_constants(predictor, n):
    """Mean weight of the central sigma point and the squared spread ``n + lambda``."""
    spread = predictor.alpha**2 * (n + predictor.kappa)
    return (spread - n) / spread, spread


@njit(cache=True)
def sigma_points(x, P, spread, root, points):
    """The 2n+1 sigma points ``x, x + c_i, x - c_i`` with ``c_i`` the columns of the Cholesky root of ``spread P``."""
    n = x.size
    if not cholesky(P, root):
        return False
    scale = np.sqrt(spread)
    for i in range(n):
        points[0, i] = x[i]
        for j in range(n):
            step = scale * root[j, i] if j >= i else 0.0
            points[1 + i, j] = x[j] + step
            points[1 + n + i, j] = x[j] - step
    return True


@njit(cache=True)
def sigma_moments(predictor, centre, spread, before, x, P, work):
    """Mean and covariance of the propagated sigma points into `x` and `P`, cross-covariance into ``work.FP``."""
    n, points, weight = x.size, work.points, 0.5 / spread
    for j in range(n):
        total = 0.0  # the weights add up to one, so the mean is this far from the central point: no difference of millions
        for i in range(1, 2 * n + 1):
            total += weight * (points[i, j] - points[0, j])
        x[j] = points[0, j] + total
    P[:] = 0.0
    work.FP[:] = 0.0
    for i in range(2 * n + 1):
        w = weight if i > 0 else centre + 1.0 - predictor.alpha**2 + predictor.beta
        for a in range(n):
            deviation = w * (points[i, a] - x[a])
            for b in range(a, n):
                P[a, b] += deviation * (points[i, b] - x[b])
    for i in range(n):
        for a in range(n):
            difference = weight * (points[1 + i, a] - points[1 + n + i, a])
            for b in range(n):
                work.FP[a, b] += difference * (work.A[i, b] - before[b])
    for a in range(n):
        for b in range(a):
            P[a, b] = P[b, a]
