"""Running a filter over a record, or over an ensemble of records.

`run_filter` composes a prediction, a model, a sensor and a weighting. `schedule` and `run_schedule` are
the same filter for a linear model whose weights do not depend on the data: gains and covariances are
computed once and then applied to every run.

At each epoch k the order is: measurement update, record, prediction to k+1. `controls[k]` is u(k);
`measurements[k]` is processed at k where ``valid[k]``. A state may have more numbers than its error has
(`robins.kalman.model.retract`): covariances, gains and variances are those of the error.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.smallmat import assign, kernel, multiply, solve_rows, times_vector, whiten
from robins.kalman.differencing import correlate_prediction
from robins.kalman.extension import entry_point, has_kernel
from robins.kalman.model import linearise_observation, measurement_noise, observe, propagate, retract
from robins.kalman.predict import Ukf, predict
from robins.kalman.reweighted import process
from robins.kalman.update import update, workspace
from robins.kalman.weights import ONCE


class Record(NamedTuple):
    """What a filter leaves behind, for an ensemble of `runs` records of N epochs.

    Attributes
    ----------
    prior, posterior, delayed : ndarray, shape (runs, N, r)
        The first r states before and after the update at k, and the estimate of x(k) after the measurement
        of k+1 (NaN at the last epoch; no epochs where it was not asked for).
    prior_variance, posterior_variance, delayed_variance : ndarray, shape (runs, N, min(r, n))
        The filter's own variances of the leading errors (one run only where they are the same for all; `delayed_variance` has
        the epochs of `delayed`).
    innovation, innovation_variance, weights, gain_norm, gain_diagonal : ndarray, shape (runs, N, m)
        Innovation, diagonal of S (infinite for a channel of weight zero), weights, Euclidean norm of the gain's
        columns, diagonal of the gain (NaN for a channel beyond the last state); NaN where nothing was processed.
    nis : ndarray, shape (runs, N)
        Normalised innovation squared.
    covariance : ndarray, shape (runs, marks, n, n)
        The whole posterior covariance at the marked epochs.
    failed : ndarray of int, shape (runs,)
        Epoch whose update or prediction failed (a covariance without Cholesky factor; a state, a variance, an
        innovation or a weight that is not finite), or -1. What would have followed is NaN.
    """

    prior: np.ndarray
    posterior: np.ndarray
    delayed: np.ndarray
    prior_variance: np.ndarray
    posterior_variance: np.ndarray
    delayed_variance: np.ndarray
    innovation: np.ndarray
    innovation_variance: np.ndarray
    weights: np.ndarray
    gain_norm: np.ndarray
    gain_diagonal: np.ndarray
    nis: np.ndarray
    covariance: np.ndarray
    failed: np.ndarray


@njit(cache=True)
def empty_record(runs, epochs, states, errors, channels, variances, marks, delayed):
    """A `Record` full of NaN, with `variances` runs in the arrays that do not depend on the data, for `errors` error states."""
    own, shared, late = (runs, epochs, states), (variances, epochs, min(states, errors)), epochs if delayed else 0
    seen, shared_seen = (runs, epochs, channels), (variances, epochs, channels)
    return Record(
        np.full(own, np.nan), np.full(own, np.nan), np.full((runs, late, states), np.nan),
        np.full(shared, np.nan), np.full(shared, np.nan), np.full((variances, late, shared[2]), np.nan),
        np.full(seen, np.nan), np.full(shared_seen, np.nan), np.full(shared_seen, np.nan), np.full(shared_seen, np.nan),
        np.full(shared_seen, np.nan), np.full((runs, epochs), np.nan), np.full((runs, marks, errors, errors), np.nan),
        np.full(runs, -1),
    )  # fmt: skip


class Noise(NamedTuple):
    """The noise of one epoch's measurement, in the fields of `robins.kalman.model.Sensor`; `R` is rewritten from epoch to epoch."""

    R: np.ndarray
    R_fixed: np.ndarray
    C_update: np.ndarray


@kernel
def has_elements(A):
    """Whether the matrix `A` has an element that is not zero."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            if A[i, j] != 0.0:
                return True
    return False


@kernel
def record_states(x, states, run, k):
    """Copy the leading states out."""
    for i in range(states.shape[2]):
        states[run, k, i] = x[i]


@kernel
def record_moments(x, P, states, variances, run, k):
    """Copy the leading states and the leading errors' variances out."""
    record_states(x, states, run, k)
    for i in range(variances.shape[2]):
        variances[run, k, i] = P[i, i]


@njit(cache=True)
def record_delayed(work, states, variances, earlier, earlier_variances):
    """The estimate of the previous epoch's state after this epoch's update, from ``E[x(k) z(k+1)^T]``.

    ``work.FP`` holds the covariance between predicted and earlier state, ``work.H``, ``work.L`` and
    ``work.white`` the update that followed: x(k/k+1) = x(k/k) + (F P)^T H^T S^-1 Delta.
    """
    m = work.H.shape[0]
    row = np.empty(m)
    for i in range(states.size):
        for j in range(m):
            total = 0.0
            for k in range(work.H.shape[1]):
                total += work.FP[k, i] * work.H[j, k]
            row[j] = total
        whiten(work.L, row, row)
        states[i] = earlier[i]
        variances[i] = earlier_variances[i]
        for j in range(m):
            states[i] += row[j] * work.white[j]
            variances[i] -= row[j] * row[j]


@kernel
def is_sound(x, P):
    """Whether the state and its variances are finite."""
    for i in range(x.size):
        if not np.isfinite(x[i]):
            return False
    for i in range(P.shape[0]):
        if not np.isfinite(P[i, i]):
            return False
    return True


def run_filter(predictor, model, sensor, weighting, x0, P0, controls, measurements, valid, states, delayed, marks=()) -> Record:
    """Run one filter over every record of an ensemble.

    Parameters
    ----------
    predictor : Ekf or Ukf
    model, sensor : NamedTuple
        With kernels for the functions of `robins.kalman.model`; the sensor also has the noise of `Sensor`.
    weighting : Weighting
    x0 : ndarray, shape (runs, n)
        Longer than the error where the model retracts.
    P0 : ndarray, shape (n, n)
        Prior of the first epoch, before its measurement.
    controls : ndarray, shape (N, l) or (runs, N, l)
        The same for all runs, or each its own.
    measurements : ndarray, shape (runs, N, m)
    valid : ndarray of bool, shape (N,)
    states : int
        How many leading states to record.
    delayed : bool
        Whether to record the one-step-delayed estimate.
    marks : sequence of int
        Epochs, increasing, at which to record the whole covariance.

    Returns
    -------
    Record

    Raises
    ------
    ValueError
        The delayed estimate, or an iterated weighting, is asked for although a cross-covariance is not zero (its gain would be
        another); the delayed estimate although weights are iterated or act on the gain (likewise); an iterated weighting although
        a part of the noise is fixed; the error and the state differ in length where the delayed estimate or sigma points need them
        equal; sigma points are of another number of states, or leave no Jacobian for ``sensor.C_predict``; or controls of each run
        are of another number of runs.
    """
    iteration = getattr(weighting, "iteration", ONCE)
    correlated = np.any(sensor.C_update) or np.any(sensor.C_predict)
    if delayed and correlated:
        raise ValueError("the delayed estimate needs zero cross-covariances")
    if delayed and (iteration.limit > 0 or getattr(weighting, "on_gain", False)):
        raise ValueError("the delayed estimate needs weights that act on the noise, once")
    if iteration.limit > 0 and (correlated or np.any(sensor.R_fixed)):
        raise ValueError("iterated weights need zero cross-covariances and no fixed part of the noise")
    if x0.shape[1] != P0.shape[0] and (delayed or isinstance(predictor, Ukf)):
        raise ValueError("the delayed estimate and sigma points need a state that is as long as its error")
    check_sigma_points(predictor, P0.shape[0], sensor)
    if not 0 < states <= x0.shape[1]:
        raise ValueError(f"{states} states cannot be recorded of {x0.shape[1]}")
    controls = controls if controls.ndim == 3 else controls[None]
    if controls.shape[0] not in (1, len(measurements)):
        raise ValueError(f"there are controls of {controls.shape[0]} runs and measurements of {len(measurements)}")
    return filter_records(
        predictor, model, sensor, weighting, x0, P0, controls, measurements, valid, states, delayed, np.array(marks, dtype=np.int64)
    )


def check_sigma_points(predictor, n, sensor) -> None:
    """Raise ValueError where `predictor` has sigma points that do not suit `n` states or the sensor."""
    if isinstance(predictor, Ukf):
        others = 2 * n * predictor.other
        if abs(predictor.mean_centre + others - 1.0) > 1e-6 * others:
            raise ValueError(f"the weights of the sigma points do not add up to one for {n} states")
        if np.any(sensor.C_predict):
            raise ValueError("sigma points leave no Jacobian for noise that is correlated with the coming prediction")


@entry_point
def filter_records(predictor, model, sensor, weighting, x0, P0, controls, measurements, valid, states, delayed, marks):
    """The compiled part of `run_filter`; `controls` ``(1 or runs, N, l)``."""
    runs, epochs, m = measurements.shape
    n = P0.shape[0]
    record = empty_record(runs, epochs, states, n, m, runs, marks.size, delayed)
    work, noise = workspace(n, m), Noise(sensor.R.copy(), sensor.R_fixed, sensor.C_update)
    at_update, at_prediction = has_elements(sensor.C_update), has_elements(sensor.C_predict)
    predicted, weights, predicted_z = np.empty((m, m)), np.ones(m), np.empty(m)
    for run in range(runs):
        x, P, u = x0[run].copy(), P0.copy(), controls[min(run, controls.shape[0] - 1)]
        memory = weighting.memory.copy()
        updates, marked = 0, 0
        assign(sensor.R, noise.R)
        for k in range(epochs):
            record_moments(x, P, record.prior, record.prior_variance, run, k)
            if valid[k]:
                linearise_observation(sensor, x, u[k], work.H)
                observe(sensor, x, u[k], predicted_z)  # (26) ghouneem2024, whose h is linear
                for i in range(m):
                    work.innovation[i] = measurements[run, k, i] - predicted_z[i]  # (27) imani2026
                measurement_noise(sensor, u[k], noise.R)
                nis = process(weighting, P, noise, at_update, memory, updates, weights, predicted, work)
                updates += 1
                if not np.isnan(nis):
                    retract(model, x, work.shift)
                if np.isnan(nis) or not is_sound(x, P):
                    record.failed[run] = k
                    break
                record.nis[run, k] = nis
                record_update(work, weights, record, run, k)
                if delayed and k > 0:
                    record_delayed(work, record.delayed[run, k - 1], record.delayed_variance[run, k - 1],
                                   record.posterior[run, k - 1], record.posterior_variance[run, k - 1])  # fmt: skip
            record_moments(x, P, record.posterior, record.posterior_variance, run, k)
            if marked < marks.size and k == marks[marked]:
                assign(P, record.covariance[run, marked])
                marked += 1
            if k + 1 < epochs:
                predictable = predict(predictor, model, x, P, u[k], work)
                if predictable and at_prediction and valid[k]:
                    correlate_prediction(x, P, sensor.C_predict, work)
                if not (predictable and is_sound(x, P)):
                    record.failed[run] = k
                    break
    return record


run_filter.dispatcher = filter_records.dispatcher


@kernel
def record_update(work, weights, record, run, k):
    """Copy innovation, its variance, weights and the gain's norms and diagonal of one update out."""
    for j in range(weights.size):
        record.innovation[run, k, j] = work.innovation[j]
        record.innovation_variance[run, k, j] = work.S[j, j]
        record.weights[run, k, j] = weights[j]
        total = 0.0
        for i in range(work.KT.shape[1]):
            total += work.KT[j, i] * work.KT[j, i]
        record.gain_norm[run, k, j] = np.sqrt(total)
        if j < work.KT.shape[1]:
            record.gain_diagonal[run, k, j] = work.KT[j, j]


class Schedule(NamedTuple):
    """Gains and covariances that no data enters, for N epochs.

    Attributes
    ----------
    gain, carry, delay : ndarray, shapes (N, n, m), (N, n, m), (N, r, m)
        K(k); the correction ``C S^-1`` of the coming prediction; the gain from the innovation of k+1 to x(k).
    factor : ndarray, shape (N, m, m)
        Lower Cholesky factor of S(k).
    prior_covariance, posterior_covariance : ndarray, shape (N, n, n)
    delayed_variance : ndarray, shape (N, r)
    weights : ndarray, shape (N, m)
    valid : ndarray of bool, shape (N,)
    failed : int
        Epoch whose update or prediction failed, or -1; the arrays hold zero or NaN from there on.
    """

    gain: np.ndarray
    carry: np.ndarray
    delay: np.ndarray
    factor: np.ndarray
    prior_covariance: np.ndarray
    posterior_covariance: np.ndarray
    delayed_variance: np.ndarray
    weights: np.ndarray
    valid: np.ndarray
    failed: int


def schedule(predictor, model, sensor, P0, weights, valid, states, delayed) -> Schedule:
    """Gains and covariances of a linear filter with the given `weights` ``(N, m)``; see `run_filter`.

    Raises
    ------
    ValueError
        The delayed estimate is asked for although a cross-covariance is not zero; sigma points do not suit, as in `run_filter`; or
        the sensor's noise differs from epoch to epoch with an input that a schedule does not know.
    """
    check_sigma_points(predictor, P0.shape[0], sensor)
    if delayed and (np.any(sensor.C_update) or np.any(sensor.C_predict)):
        raise ValueError("the delayed estimate needs zero cross-covariances")
    if has_kernel("measurement_noise", sensor):
        raise ValueError("a schedule needs measurement noise that does not depend on the input")
    return plan_gains(predictor, model, sensor, P0, weights, valid, states, delayed)


@entry_point
def plan_gains(predictor, model, sensor, P0, weights, valid, states, delayed):
    """The compiled part of `schedule`."""
    epochs, m = weights.shape
    n = P0.shape[0]
    gain, carry, delay = np.zeros((epochs, n, m)), np.zeros((epochs, n, m)), np.zeros((epochs, states, m))
    factor, delayed_variance = np.zeros((epochs, m, m)), np.full((epochs, states), np.nan)
    prior, posterior = np.full((epochs, n, n), np.nan), np.full((epochs, n, n), np.nan)
    work, x, P, u, failed = workspace(n, m), np.zeros(n), P0.copy(), np.zeros(model.B.shape[1]), -1
    at_update, at_prediction = has_elements(sensor.C_update), has_elements(sensor.C_predict)
    for k in range(epochs):
        assign(P, prior[k])
        if valid[k]:
            linearise_observation(sensor, x, u, work.H)
            if np.isnan(update(x, P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, at_update, weights[k], work)):
                failed = k
                break
            assign(work.K, gain[k])
            assign(work.L, factor[k])
            assign(sensor.C_predict, carry[k])
            solve_rows(work.L, carry[k])
            if delayed and k > 0:
                multiply(np.ascontiguousarray(work.FP.T[:states]), np.ascontiguousarray(work.H.T), delay[k - 1])
                for i in range(states):
                    white = np.empty(m)
                    whiten(work.L, delay[k - 1, i], white)
                    delayed_variance[k - 1, i] = posterior[k - 1, i, i] - np.sum(white * white)
                solve_rows(work.L, delay[k - 1])
        assign(P, posterior[k])
        if k + 1 < epochs:
            predictable = predict(predictor, model, x, P, u, work)
            if predictable and at_prediction and valid[k]:
                correlate_prediction(x, P, sensor.C_predict, work)
            if not (predictable and is_sound(x, P)):
                failed = k
                break
    return Schedule(gain, carry, delay, factor, prior, posterior, delayed_variance, weights, valid, failed)


@njit(cache=True)
def record_plan(plan, record):
    """Copy what a `Schedule` knows of every run out; what no epoch reached stays NaN."""
    epochs, n, m = plan.gain.shape
    for k in range(epochs):
        for i in range(record.prior_variance.shape[2]):
            record.prior_variance[0, k, i] = plan.prior_covariance[k, i, i]
            record.posterior_variance[0, k, i] = plan.posterior_covariance[k, i, i]
            if k < record.delayed_variance.shape[1]:
                record.delayed_variance[0, k, i] = plan.delayed_variance[k, i]
        if not plan.valid[k] or np.isnan(plan.posterior_covariance[k, 0, 0]):
            continue
        for j in range(m):
            variance, squared_gain = 0.0, 0.0
            for b in range(j + 1):
                variance += plan.factor[k, j, b] ** 2
            for i in range(n):
                squared_gain += plan.gain[k, i, j] ** 2
            record.innovation_variance[0, k, j] = variance
            record.weights[0, k, j] = plan.weights[k, j]
            record.gain_norm[0, k, j] = np.sqrt(squared_gain)
            if j < n:
                record.gain_diagonal[0, k, j] = plan.gain[k, j, j]


@njit(cache=True)
def apply_gain(plan, k, innovation, x, record, run, delayed):
    """Update `x` at epoch k of a `Schedule` and record it; False, with `x` as it was, when the innovation is not finite."""
    m = innovation.size
    white, shift = np.empty(m), np.empty(x.size)
    for j in range(m):
        record.innovation[run, k, j] = innovation[j]
        if plan.weights[k, j] == 0.0:
            innovation[j] = 0.0  # removed, whatever it is
    whiten(plan.factor[k], innovation, white)
    nis = 0.0
    for j in range(m):
        nis += white[j] * white[j]
    if not np.isfinite(nis):
        record.innovation[run, k] = np.nan
        return False
    record.nis[run, k] = nis
    if delayed and k > 0:
        times_vector(plan.delay[k - 1], innovation, record.delayed[run, k - 1])
        for i in range(record.delayed.shape[2]):
            record.delayed[run, k - 1, i] += record.posterior[run, k - 1, i]
    times_vector(plan.gain[k], innovation, shift)
    for i in range(x.size):
        x[i] += shift[i]
    return True


@entry_point
def run_schedule(plan, model, sensor, x0, controls, measurements, states, delayed):
    """Apply a `Schedule` to every record of an ensemble; arguments and result as in `run_filter`.

    A schedule that failed fails every run at its epoch, or before.
    """
    runs, epochs, m = measurements.shape
    n = x0.shape[1]
    record = empty_record(runs, epochs, states, n, m, 1, 0, delayed)
    record_plan(plan, record)
    innovation, shift, P = np.empty(m), np.empty(n), np.zeros((n, n))
    for run in range(runs):
        x = x0[run].copy()
        for k in range(epochs):
            record_states(x, record.prior, run, k)
            if plan.valid[k]:
                observe(sensor, x, controls[k], innovation)
                for j in range(m):
                    innovation[j] = measurements[run, k, j] - innovation[j]
                no_gain = k == plan.failed and np.isnan(plan.posterior_covariance[k, 0, 0])
                if no_gain or not apply_gain(plan, k, innovation, x, record, run, delayed):
                    record.failed[run] = k
                    break
            record_states(x, record.posterior, run, k)
            if k + 1 < epochs:
                propagate(model, x, controls[k])
                if plan.valid[k]:
                    times_vector(plan.carry[k], innovation, shift)
                    for i in range(n):
                        x[i] += shift[i]
                if k == plan.failed or not is_sound(x, P):
                    record.failed[run] = k
                    break
    return record
