"""How the weights enter the update: on the noise, on the gain, or iterated on the noise and the prior."""

import numpy as np
from numba import njit
from numba.extending import overload

from robins.kalman.extension import has_kernel, kernel_of
from robins.kalman.fixed_point import update_iterated
from robins.kalman.update import innovation_covariance, update_error
from robins.kalman.weights import weigh


def process(weighting, P, sensor, correlated, memory, epoch, weights, predicted, work):
    """Process ``work.innovation`` with ``work.H``: update `P`, leave the correction in ``work.shift`` and the weights in `weights`.

    Parameters
    ----------
    weighting : Weighting
        Or a type that has registered a kernel for `process` of its own: an update that no weights can express.
    P : ndarray, shape (n, n)
    sensor : NamedTuple
        With the noise of `robins.kalman.model.Sensor`.
    correlated : bool
        Whether ``sensor.C_update`` is not zero.
    memory : ndarray, shape (r, c)
        The run's own.
    epoch : int
        Number of updates before this one.
    weights : ndarray, shape (m,)
    predicted : ndarray, shape (m, m)
        Scratch.
    work : Workspace

    Returns
    -------
    float
        As `robins.kalman.update.update_error`.
    """
    return kernel_of("process", weighting)(weighting, P, sensor, correlated, memory, epoch, weights, predicted, work)


@overload(process)
def _process(weighting, P, sensor, correlated, memory, epoch, weights, predicted, work):
    kernel = kernel_of("process", weighting) if has_kernel("process", weighting) else process_weighted
    return lambda weighting, P, sensor, correlated, memory, epoch, weights, predicted, work: kernel(
        weighting, P, sensor, correlated, memory, epoch, weights, predicted, work
    )


@njit(cache=True)
def process_weighted(weighting, P, sensor, correlated, memory, epoch, weights, predicted, work):
    """`process` for every weight function."""
    for j in range(weights.size):
        weights[j] = work.gain_factor[j] = 1.0
    if weighting.kind == 0:
        return update_error(P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, correlated, weights, work)
    if weighting.iteration.limit > 0:
        return update_iterated(weighting, P, work.innovation, work.H, sensor.R, sensor.C_update, memory, epoch, weights, work)
    innovation_covariance(P, work.H, sensor.R_fixed, sensor.C_update, correlated, weights, work.K, predicted)
    weigh(weighting, weighting.parameters, work.innovation, predicted, sensor.R, memory, epoch, weights)
    if not weighting.on_gain:
        return update_error(P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, correlated, weights, work)
    for j in range(weights.size):
        work.gain_factor[j] = weights[j]
        if not 0.0 <= weights[j] < np.inf:
            return np.nan
    return update_error(P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, correlated, np.ones(weights.size), work)
