"""Equations (10)-(24) of the paper, letter by letter, with no regard for speed or for what is right.

The variants of `estimators` are the fast, composed form of the same filter; a test holds the two together.
Only the ablation "covariance unscaled" (brief A10) reports from here: with the scaled gain (24) and the
unscaled bracket in (16) the result is no covariance of anything, so the house's update cannot produce it.
"""

import numpy as np
from numba import njit

from robins.kalman.differencing import differenced_measurements
from robins.papers.hajiyev2023.scenario import Ensemble, Parameters, System, controls, differenced


def scale_matrix(seen, H_d, P, C, R):
    """S(k) of equation (21), with R^-1 on the right as printed; shapes (8, 8)."""
    return (seen - H_d @ P @ H_d.T - H_d @ C - C.T @ H_d.T) @ np.linalg.inv(R)  # (21) hajiyev2023


@njit(cache=True)
def run_literally(A, B, Q, H_d, D, R, C, P0, x0, u, mu, window, scale_covariance):
    """The AMDKF over one ensemble, equations (12)-(24) in the paper's order and notation.

    Parameters
    ----------
    A, B, Q, H_d, D, R, C, P0 : ndarray
        Matrices of the paper; ``D = H B`` and ``Q = G Q_w G^T``.
    x0, u, mu : ndarray, shapes (runs, 8), (N+1, 3), (runs, N+1, 8)
    window : int
        M; more than N+1 gives the MDKF, since then S* stays the identity.
    scale_covariance : bool
        Whether equation (16) uses S* R, as the gain (24) does, or R (brief A10).

    Returns
    -------
    estimate, variance : ndarray, shape (runs, N+1, 8)
        x(k/k) and the diagonal of P(k/k) for k = 1..N-1, NaN elsewhere.
    """
    runs, epochs, n = mu.shape
    estimate, variance = np.full(mu.shape, np.nan), np.full(mu.shape, np.nan)
    for run in range(runs):
        x, P = x0[run].copy(), P0.copy()
        innovations = np.zeros((epochs, n))
        for k in range(1, epochs - 1):
            x = A @ x + B @ u[k - 1]  # (13) hajiyev2023
            P = A @ P @ A.T + Q  # (15) hajiyev2023
            innovation = mu[run, k] - D @ u[k] - H_d @ x  # (17) hajiyev2023
            innovations[k] = innovation
            scaled = np.eye(n)
            if k >= window:
                recent = innovations[k - window + 1 : k + 1]
                seen = recent.T @ recent / window  # (19) hajiyev2023
                S = (seen - H_d @ P @ H_d.T - H_d @ C - C.T @ H_d.T) @ np.linalg.inv(R)  # (20), (21) hajiyev2023
                for i in range(n):
                    scaled[i, i] = max(1.0, S[i, i])  # (22), (23) hajiyev2023
            unscaled_bracket = H_d @ P @ H_d.T + R + H_d @ C + C.T @ H_d.T  # (18) hajiyev2023
            bracket = H_d @ P @ H_d.T + scaled @ R + H_d @ C + C.T @ H_d.T  # (24) hajiyev2023
            K = (P @ H_d.T + C) @ np.linalg.inv(bracket)  # (14), (24) hajiyev2023
            x = x + K @ innovation  # (12) hajiyev2023
            P = P - K @ (bracket if scale_covariance else unscaled_bracket) @ K.T  # (16) hajiyev2023
            P = (P + P.T) / 2.0  # brief A7: round-off only
            estimate[run, k] = x
            variance[run, k] = np.diag(P)
    return estimate, variance


def literal(parameters: Parameters, matrices: System, ensemble: Ensemble, condition: str, window: int, scale_covariance: bool = True):
    """`run_literally` on an ensemble; returns its estimate and variance."""
    d = differenced(matrices)
    mu = differenced_measurements(ensemble.z[condition], matrices.A_n)
    R = d.R_process + d.R_sensor
    return run_literally(matrices.A, matrices.B, matrices.Q, d.H_d, d.D, R, d.C, matrices.P0, ensemble.guess, controls(parameters),
                         mu, window, scale_covariance)  # fmt: skip
