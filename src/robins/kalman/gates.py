"""Hard gates: a measurement that is too unlikely is left out.

The oldest robust filters, and the control of every other one: what a smooth weight gains over them is the gain of
smoothness, what both gain over the plain filter is the gain of leaving outliers out.

    gate             each channel by itself, by its innovation in standard deviations
    nis_gate         the whole measurement, by its normalised innovation squared; a patient one gives in after many rejections
    integrity_gate   the whole measurement, by the size of its innovation and of its change since the measurement before

References: Bar-Shalom, Li & Kirubarajan 2001, Estimation with Applications to Tracking and Navigation; ghouneem2024 equation (24).
"""

import numpy as np
from numba import njit

from robins.foundation.smallmat import cholesky, kernel, whiten
from robins.kalman.weights import Weighting, weight, weighting


def gate(threshold: float) -> Weighting:
    """A gate of `threshold` innovation standard deviations, for each channel by itself.

    Infinity never closes it: the plain filter.

    Raises
    ------
    ValueError
        `threshold` is zero, negative or NaN.
    """
    if not threshold > 0.0:
        raise ValueError(f"threshold: {threshold:g} is not positive")
    return weighting("gate", (threshold,))


@weight("gate")
@kernel
def close_gate(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weight 0 where ``|y_i| / sqrt(S_ii)`` exceeds the threshold ``parameters[0]``, else 1; ``S = predicted + R``."""
    for i in range(innovation.size):
        standardised = abs(innovation[i]) / np.sqrt(predicted[i, i] + R[i, i])
        weights[i] = 0.0 if standardised > parameters[0] else 1.0


def nis_gate(threshold: float, patience: int | None = None) -> Weighting:
    """A gate on ``y^T S^-1 y``, for all channels together.

    Parameters
    ----------
    threshold : float
        Infinity never closes the gate: the plain filter.
    patience : int, optional
        After more than so many rejections one after the other, the next measurement is accepted, with ``R max(1, NIS / m)``, and
        the count begins again. Without it a filter that has lost its way may reject for good.

    Raises
    ------
    ValueError
        `threshold` is not positive, or `patience` is negative.
    """
    if not threshold > 0.0:
        raise ValueError(f"threshold: {threshold:g} is not positive")
    if patience is not None and not patience >= 0:
        raise ValueError(f"patience: {patience} is negative")
    return weighting("nis-gate", (threshold, np.inf if patience is None else patience))


@weight("nis-gate")
@njit(cache=True, error_model="numpy")
def close_nis_gate(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weights 0 where the NIS exceeds ``parameters[0]``, else 1; ``memory[0, 0]`` counts the rejections one after the other.

    All one where ``S = predicted + R`` is not positive definite, for then no update is possible either.
    """
    m = innovation.size
    root, white = np.empty((m, m)), np.empty(m)
    for i in range(m):
        for j in range(m):
            root[i, j] = predicted[i, j] + R[i, j]
    if not cholesky(root, root):
        return
    whiten(root, innovation, white)
    nis = 0.0
    for i in range(m):
        nis += white[i] * white[i]
    trust = 1.0
    if nis > parameters[0]:
        patient = memory[0, 0] <= parameters[1]
        trust = 0.0 if patient else 1.0 / max(1.0, nis / m)
        memory[0, 0] = memory[0, 0] + 1.0 if patient else 0.0
    else:
        memory[0, 0] = 0.0
    for i in range(m):
        weights[i] = trust


def integrity_gate(prediction_limits, jump_limits, measurements) -> Weighting:
    """A gate on the innovation and on the change since the last received measurement, (24) of ghouneem2024, for all channels together.

    What was received before counts whether it was accepted or not, so that one false measurement costs the one after it too. The
    first measurement has no change.

    Parameters
    ----------
    prediction_limits, jump_limits : array_like, shape (m,)
        In the units of the channels; infinity never closes the gate.
    measurements : array_like, shape (updates, m)
        The measurements that the filter will process, without the epochs that have none. They are those of one run: so is the
        weighting.

    Raises
    ------
    ValueError
        A limit is not positive, or the shapes disagree.
    """
    limits = {"prediction_limits": np.asarray(prediction_limits, float), "jump_limits": np.asarray(jump_limits, float)}
    measurements = np.asarray(measurements, float)
    for name, values in limits.items():
        if not np.all(values > 0.0):
            raise ValueError(f"{name}: {values.tolist()} are not all positive")
        if measurements.ndim != 2 or values.shape != measurements.shape[1:]:
            raise ValueError(f"{name}: shape {values.shape} for measurements of shape {measurements.shape}")
    jumps = np.zeros((len(measurements), 1))
    jumps[1:, 0] = np.any(np.abs(np.diff(measurements, axis=0)) > limits["jump_limits"], axis=1)  # (24) ghouneem2024
    return weighting("integrity-gate", limits["prediction_limits"], jumps)


@weight("integrity-gate")
@njit(cache=True, error_model="numpy")
def close_integrity_gate(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weights 0 where an innovation exceeds its limit in `parameters` ``(m,)`` or ``memory[epoch, 0]`` says that a channel has jumped.

    Raises
    ------
    ValueError
        There are more updates than measurements that `integrity_gate` has seen, or other channels.
    """
    if epoch >= memory.shape[0] or innovation.size != parameters.size:
        raise ValueError("measurements: the filter's updates are not those that integrity_gate() was made for")
    rejected = memory[epoch, 0] != 0.0
    for i in range(innovation.size):
        if abs(innovation[i]) > parameters[i]:  # (24) ghouneem2024
            rejected = True
    for i in range(innovation.size):
        weights[i] = 0.0 if rejected else 1.0
