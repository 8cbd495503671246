"""How the weights enter the update: on the noise, on the gain, or iterated on the noise and the prior."""

import numpy as np
from numba import njit
from numba.extending import overload

from robins.foundation.smallmat import kernel
from robins.kalman.extension import has_kernel, kernel_of
from robins.kalman.fixed_point import update_iterated
from robins.kalman.update import innovation_covariance, update_error
from robins.kalman.weights import weigh


def process(weighting, P, noise, correlated, memory, epoch, weights, predicted, work):
    """Process ``work.innovation`` with ``work.H``: update `P`, leave the correction in ``work.shift`` and the weights in `weights`.

    Parameters
    ----------
    weighting : Weighting
        Or a type that has registered a kernel for `process` of its own: an update that no weights can express.
    P : ndarray, shape (n, n)
    noise : NamedTuple
        R, R_fixed and C_update of this measurement, as in `robins.kalman.model.Sensor`.
    correlated : bool
        Whether ``noise.C_update`` is not zero.
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
    return kernel_of("process", weighting)(weighting, P, noise, correlated, memory, epoch, weights, predicted, work)


@overload(process, jit_options={"error_model": "numpy", "_nrt": False})
def _process(weighting, P, noise, correlated, memory, epoch, weights, predicted, work):
    if not has_kernel("process", weighting):
        return process_weighted
    own = kernel_of("process", weighting)  # may allocate, as a weight function may

    @njit(_nrt=True)
    def allocating(weighting, P, noise, correlated, memory, epoch, weights, predicted, work):
        return own(weighting, P, noise, correlated, memory, epoch, weights, predicted, work)

    return lambda weighting, P, noise, correlated, memory, epoch, weights, predicted, work: allocating(
        weighting, P, noise, correlated, memory, epoch, weights, predicted, work
    )


@njit(cache=True, _nrt=True)
def find_weights(weighting, innovation, predicted, R, memory, epoch, weights):
    """`weigh` for a caller that counts no references: a weight function may allocate and raise."""
    weigh(weighting, weighting.parameters, innovation, predicted, R, memory, epoch, weights)


@kernel
def trust_all(weights, work):
    """Weights and gain factors of one."""
    for j in range(weights.size):
        weights[j] = work.gain_factor[j] = 1.0


@kernel
def move_to_gain(weights, work):
    """Make the weights gain factors and leave weights of one; False when a weight is negative or not finite."""
    valid = True
    for j in range(weights.size):
        if not 0.0 <= weights[j] < np.inf:
            valid = False
        work.gain_factor[j], weights[j] = weights[j], 1.0
    return valid


def process_weighted(weighting, P, noise, correlated, memory, epoch, weights, predicted, work):
    """`process` for every weight function; compiled where it is used, for each function in between optimises all of this once more."""
    if weighting.kind != 0 and weighting.iteration.limit > 0:
        return update_iterated(weighting, P, work.innovation, work.H, noise.R, noise.C_update, memory, epoch, weights, work)
    trust_all(weights, work)
    if weighting.kind != 0:
        innovation_covariance(P, work.H, noise.R_fixed, noise.C_update, correlated, weights, work.K, predicted)
        find_weights(weighting, work.innovation, predicted, noise.R, memory, epoch, weights)
        if weighting.on_gain and not move_to_gain(weights, work):
            return np.nan
    nis = update_error(P, work.innovation, work.H, noise.R, noise.R_fixed, noise.C_update, correlated, weights, work)
    if weighting.on_gain:
        for j in range(weights.size):
            weights[j] = work.gain_factor[j]
    return nis
