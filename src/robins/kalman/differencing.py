"""Measurement differencing: a filter for measurement noise that is correlated in time.

A measurement ``z(k) = H x(k) + v(k) + lambda(k)`` with the Gauss-Markov error
``lambda(k) = A_n lambda(k-1) + B_n U(k-1)`` is turned into the difference

    mu(k) = z(k+1) - A_n z(k) = H_d x(k) + H B u(k) + xi(k),   H_d = H A - A_n H
    xi(k) = H G w(k) + B_n U(k) + v(k+1) - A_n v(k)

in which lambda no longer appears. What is left has three properties that a filter must respect:

* mu(k) contains z(k+1): an estimate of x(k) from it looks one step ahead;
* xi(k) is correlated with the process noise G w(k) of the *coming* step, ``C = E[G w(k) xi(k)^T]``,
  which belongs in the prediction to k+1, not in the update at k (`Sensor.C_predict`);
* if v is not zero, xi is a moving average of first order, not white.

References: Bryson & Henrikson 1968, J. Spacecraft 5(6); Petovello et al. 2009, J. Geodesy 83; hajiyev2023 equations (6)-(11).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.smallmat import multiply, times_vector, whiten


class DifferencedNoise(NamedTuple):
    """Matrices of the differenced measurement.

    Attributes
    ----------
    H_d : ndarray, shape (m, n)
        Measurement matrix of mu.
    D : ndarray, shape (m, l)
        Feedthrough of the input, H B.
    R_process, R_sensor : ndarray, shape (m, m)
        Covariance of xi: the part from w and U, which no sensor fault touches, and the part from v.
    C : ndarray, shape (n, m)
        ``E[G w(k) xi(k)^T]``.
    """

    H_d: np.ndarray
    D: np.ndarray
    R_process: np.ndarray
    R_sensor: np.ndarray
    C: np.ndarray


def difference(A, B, Q, H, A_n, Q_lambda, Q_v) -> DifferencedNoise:
    """The differenced measurement of a linear system.

    Parameters
    ----------
    A, B, Q : ndarray, shapes (n, n), (n, l), (n, n)
        State equation; `Q` is the covariance of G w.
    H : ndarray, shape (m, n)
    A_n, Q_lambda : ndarray, shape (m, m)
        Transition of the correlated error and the covariance ``B_n Q_U B_n^T`` of its driving noise.
    Q_v : ndarray, shape (m, m)
        Covariance of the white part of the measurement noise.
    """
    return DifferencedNoise(
        H_d=H @ A - A_n @ H,  # (8) hajiyev2023
        D=H @ B,  # (6) hajiyev2023
        R_process=H @ Q @ H.T + Q_lambda,  # (10) hajiyev2023, first two terms
        R_sensor=Q_v + A_n @ Q_v @ A_n.T,  # (10) hajiyev2023, last two terms
        C=Q @ H.T,  # (11) hajiyev2023
    )


def differenced_measurements(z, A_n):
    """``mu(k) = z(k+1) - A_n z(k)``, equations (6) and (8) of hajiyev2023, for `z` of shape (..., N+1, m).

    The result has the shape of `z`; its last epoch, which would need z(N+1), is zero.
    """
    mu = np.zeros_like(z)
    mu[..., :-1, :] = z[..., 1:, :] - z[..., :-1, :] @ A_n.T  # (6), (8) hajiyev2023
    return mu


@njit(cache=True)
def correlate_prediction(x, P, C, work):
    """Correct a prediction for process noise that is correlated with the measurement noise just processed.

    Call it after `update` at k and `predict` to k+1, in place:

        x <- x + C S^-1 Delta
        P <- P - C S^-1 C^T - F K C^T - C K^T F^T

    which together are the one-step predictor of Bryson & Henrikson, with gain ``(F P H^T + C) S^-1``.

    Parameters
    ----------
    C : ndarray, shape (n, m)
        ``E[w(k) v(k)^T]``.
    work : Workspace
        As `update` and `predict` left it.
    """
    n, m = C.shape
    white_C, FK = np.empty((n, m)), np.empty((n, m))
    for i in range(n):
        whiten(work.L, C[i], white_C[i])
    times_vector(white_C, work.white, work.shift)
    multiply(work.F, work.K, FK)
    for i in range(n):
        x[i] += work.shift[i]
        for j in range(i, n):
            total = 0.0
            for k in range(m):
                total += white_C[i, k] * white_C[j, k] + FK[i, k] * C[j, k] + C[i, k] * FK[j, k]
            P[i, j] -= total
            P[j, i] = P[i, j]
