"""What the tests of every wing share: an estimator that knows no recursion."""

from collections.abc import Callable

import numpy as np
import pytest


def condition_jointly(A, B, Q, H, R, mean0, P0, controls, measurements):
    """Mean and covariance of x(0..K) given z(0..K) by conditioning one joint Gaussian: no filter, no recursion over data.

    ``x(k+1) = A x(k) + B u(k) + w(k)``, ``z(k) = H x(k) + v(k)``. The covariance of all states at once is built from
    ``cov(x_i, x_j) = A^(i-j) cov(x_j)`` and conditioned on all measurements at once.

    Parameters
    ----------
    measurements : ndarray, shape (K+1, m)

    Returns
    -------
    ndarray, shape (K+1, n)
        ``E[x(k) | z(0..K)]`` for every k.
    ndarray, shape (K+1, n, n)
    """
    epochs, n = len(measurements), len(mean0)
    means, joint, own = [np.asarray(mean0, float)], np.zeros((epochs, n, epochs, n)), np.asarray(P0, float)
    for j in range(epochs):
        block = own
        for i in range(j, epochs):
            joint[i, :, j], joint[j, :, i] = block, block.T
            block = A @ block
        own = A @ own @ A.T + Q
        means.append(A @ means[-1] + B @ controls[j])
    means = np.array(means[:epochs])
    seen = np.einsum("ab,ibjc->iajc", H, joint)
    covariance = np.einsum("iajc,dc->iajd", seen, H)
    for k in range(epochs):
        covariance[k, :, k] += R
    size = epochs * H.shape[0]
    covariance, cross = covariance.reshape(size, size), seen.reshape(size, epochs, n)
    scale = np.sqrt(np.diag(covariance))  # channels have different units
    root = np.linalg.cholesky(covariance / np.outer(scale, scale))
    residual = (measurements - means @ H.T).reshape(size) / scale
    white = np.linalg.solve(root, residual)
    white_cross = np.linalg.solve(root, cross.reshape(size, epochs * n) / scale[:, None]).reshape(size, epochs, n)
    estimate = means + np.einsum("zkn,z->kn", white_cross, white)
    posterior = np.array([joint[k, :, k] - white_cross[:, k].T @ white_cross[:, k] for k in range(epochs)])
    return estimate, posterior


@pytest.fixture(scope="session")
def joint_gaussian() -> Callable:
    """`condition_jointly`: an independent implementation of filter, predictor and smoother of a linear system."""
    return condition_jointly
