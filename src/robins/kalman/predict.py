"""Prediction: extended (linearised) and unscented. Both work with any model.

References: Julier & Uhlmann 2004, Proc. IEEE 92(3); Wan & van der Merwe 2000 (scaled sigma points).
"""

from typing import NamedTuple

import numpy as np
from numba.extending import overload

from robins.foundation.smallmat import cholesky, congruence, kernel, multiply
from robins.kalman.model import linearise, process_noise, propagate


class Ekf(NamedTuple):
    """Prediction by the Jacobian; exact for a linear model."""


class Ukf(NamedTuple):
    """Prediction by the central sigma point and n pairs around it; see `unscented`.

    Attributes
    ----------
    spread : float
        ``n + lambda``: the points lie at the columns of the Cholesky root of ``spread P``.
    mean_centre, covariance_centre, other : float
        Weight of the central point in the mean and in the covariance; weight of every other point in both. ``mean_centre`` and
        the others add up to one, so that the mean is taken from the central point without it.
    """

    spread: float
    mean_centre: float
    covariance_centre: float
    other: float


def unscented(n: int, alpha: float = 0.1, beta: float = 2.0, kappa: float = 0.0) -> Ukf:
    """Scaled sigma points for `n` states. Equations (17)-(21) of ghouneem2024, with a sum in (18).

    Parameters
    ----------
    alpha : float
        Distance of the points, in (0, 1]. The covariance loses about ``-4 log10(alpha)`` digits to cancellation.
    beta : float
        Prior knowledge: 2 is best for a normal distribution.
    kappa : float
        Secondary scaling, above -n.

    Raises
    ------
    ValueError
        `alpha` or `kappa` is outside its range, or a number is not finite.
    """
    if not 0.0 < alpha <= 1.0:
        raise ValueError(f"alpha: {alpha:g} is not in (0, 1]")
    if not np.isfinite(beta):
        raise ValueError(f"beta: {beta:g} is not finite")
    if not -n < kappa < np.inf:
        raise ValueError(f"kappa: {kappa:g} is not a finite number above -{n}")
    spread = alpha**2 * (n + kappa)  # (20) ghouneem2024: lambda = spread - n
    mean_centre = (spread - n) / spread  # (17) ghouneem2024
    return Ukf(spread, mean_centre, mean_centre + 1.0 - alpha**2 + beta, 0.5 / spread)  # (18), (19) ghouneem2024


@kernel
def propagate_covariance(F, Q, FP, P):
    """``P <- F P F^T + Q``; leaves ``F P`` in `FP`."""
    multiply(F, P, FP)
    congruence(FP, F, Q, P)  # (20) imani2026 # (8) ghouneem2024


def predict(predictor, model, x, P, u, work):
    """Replace `x` ``(n,)`` and `P` ``(n, n)`` by their predictions one step ahead with the input `u` ``(l,)``.

    Leaves the process noise in ``work.Q`` and the covariance between the predicted and the present state in ``work.FP``; the EKF
    also leaves the Jacobian in ``work.F``, the UKF the propagated sigma points in ``work.points``, the central one first.

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

        def by_jacobian(predictor, model, x, P, u, work):
            F, Q, FP = work.F, work.Q, work.FP
            linearise(model, x, u, F, Q)
            propagate(model, x, u)  # (7) ghouneem2024
            propagate_covariance(F, Q, FP, P)
            return True

        return by_jacobian
    if kind is Ukf:

        def by_sigma_points(predictor, model, x, P, u, work):
            process_noise(model, x, u, work.Q)
            if not sigma_points(x, P, predictor.spread, work.T, work.points):
                return False
            for point in work.points:
                propagate(model, point, u)
            sigma_deviations(work.points, work.A, work.F)
            sigma_moments(predictor, work, x, P)
            sigma_cross_covariance(predictor, work.F, work.T, work.FP)
            return True

        return by_sigma_points
    return None


@kernel
def sigma_points(x, P, spread, root, points):
    """The 2n+1 sigma points ``x, x + c_i, x - c_i`` with ``c_i`` the columns of the Cholesky root of ``spread P``."""
    n = x.size
    if not cholesky(P, root):
        return False
    scale = np.sqrt(spread)  # (21) ghouneem2024
    for j in range(n):
        points[0, j] = x[j]  # (14) ghouneem2024
    for i in range(n):
        for j in range(n):
            step = scale * root[j, i]
            points[1 + i, j] = x[j] + step  # (15) ghouneem2024
            points[1 + n + i, j] = x[j] - step  # (16) ghouneem2024
    return True


@kernel
def sigma_deviations(points, even, odd):
    """Sum and difference of each pair's distances from the central point, row by row; both ``(n, n)``.

    The even part is what no linear model has.
    """
    n = even.shape[0]
    for i in range(n):
        for j in range(n):
            centre = points[0, j]
            ahead, behind = points[1 + i, j] - centre, points[1 + n + i, j] - centre
            even[i, j], odd[i, j] = ahead + behind, ahead - behind


@kernel
def sigma_moments(predictor, work, x, P):
    """Mean and covariance of the propagated sigma points into `x` and `P`.

    With the distances ``a_i``, ``b_i`` of a pair from the central point and ``d`` that of the mean, the weighted sum of the products
    of distances from the mean is ``w sum (a a^T + b b^T) + (W_0 + 2 n w - 2) d d^T``; it is summed over even and odd parts.
    """
    n, even, odd, points = x.size, work.A, work.F, work.points
    weight = predictor.other
    for j in range(n):
        total = 0.0
        for i in range(n):
            total += even[i, j]
        work.shift[j] = weight * total
        x[j] = points[0, j] + work.shift[j]  # (22) ghouneem2024, without a difference of millions
    centre = predictor.covariance_centre + 2.0 * n * weight - 2.0
    for a in range(n):
        factor = centre * work.shift[a]
        for b in range(n):
            P[a, b] = work.Q[a, b] + factor * work.shift[b]
    add_gram(0.5 * weight, even, P)  # (23) ghouneem2024
    add_gram(0.5 * weight, odd, P)
    for a in range(n):
        for b in range(a):
            P[b, a] = P[a, b]


@kernel
def add_gram(scale, A, out):
    """``out += scale A^T A``, three rows of `A` at a time."""
    rows, n = A.shape
    triples = 3 * (rows // 3)
    for k in range(0, triples, 3):
        for i in range(n):
            a, b, c = scale * A[k, i], scale * A[k + 1, i], scale * A[k + 2, i]
            for j in range(n):
                out[i, j] += a * A[k, j] + b * A[k + 1, j] + c * A[k + 2, j]
    for k in range(triples, rows):
        for i in range(n):
            a = scale * A[k, i]
            for j in range(n):
                out[i, j] += a * A[k, j]


@kernel
def sigma_cross_covariance(predictor, odd, root, FP):
    """Covariance between the predicted and the present state, whose sigma points are the columns of `root`."""
    n = odd.shape[0]
    weight = predictor.other * np.sqrt(predictor.spread)
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(j + 1):
                total += odd[k, i] * root[j, k]
            FP[i, j] = weight * total
