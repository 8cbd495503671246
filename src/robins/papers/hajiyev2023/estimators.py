"""Sections 3 and 4 of the paper: every filter of the study, as a composition of the kalman floor.

A filter is a `Filter`: which measurement it reads (z itself, the difference mu, or mu one step late), its
model and sensor, its weights, and which of the recorded moments is its estimate of x(k) from z(0..k)
("filtered") and from z(0..k+1) ("delayed").

The printed filter is the one update with the cross-covariance C in it, equations (14) and (16). The
corrected one (Bryson & Henrikson) has C in the prediction instead. `as_printed` holds equations
(10)-(24) once more, literally, and a test holds the two together.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.stats import chi2

from robins.kalman.differencing import differenced_measurements
from robins.kalman.filter import Record, run_filter, run_schedule, schedule
from robins.kalman.model import LinearModel, Sensor, linear_sensor
from robins.kalman.predict import Ekf
from robins.kalman.tuning import GATED, PER_CHANNEL, SCALAR_MEAN, SCALAR_TRACE, matching
from robins.kalman.weights import Weighting
from robins.papers.hajiyev2023.scenario import Q_CHANNEL, THETA_CHANNEL, Ensemble, Parameters, System, controls, differenced

GATE_PROBABILITY = 0.999
"""Quantile of chi2_M / M above which a gated scale factor is applied (brief A12)."""

RULES = {"per-channel": PER_CHANNEL, "gated": GATED, "scalar-trace": SCALAR_TRACE, "scalar-mean": SCALAR_MEAN}


class Filter(NamedTuple):
    """One filter, ready to run over an ensemble; see the module's docstring.

    Attributes
    ----------
    model : LinearModel
    sensor : Sensor
    P0 : ndarray, shape (n, n)
    reads : str
        ``z``, ``mu`` or ``mu-late``.
    valid : ndarray of bool, shape (N+1,)
    weights : Weighting or ndarray
        A weight function, or the weights ``(N+1, 8)`` when no data enters them: gains are then computed once.
    filtered, delayed : str
        Names of the moments in `Record`; empty where the filter has no such estimate.
    """

    model: LinearModel
    sensor: Sensor
    P0: np.ndarray
    reads: str
    valid: np.ndarray
    weights: Weighting | np.ndarray
    filtered: str
    delayed: str


def gate_threshold(window: int) -> float:
    """Ratio of seen to predicted variance beyond which a channel counts as faulty."""
    return chi2.ppf(GATE_PROBABILITY, window) / window


def adaptation(rule: str, parameters: Parameters, minimum: int | None = None) -> Weighting | np.ndarray:
    """The weights of a rule of `RULES`, or ones for every epoch when `rule` is empty."""
    if not rule:
        return np.ones((parameters.steps + 1, 8))
    return matching(parameters.window, 8, RULES[rule], gate_threshold(parameters.window), minimum)


def epochs_valid(parameters: Parameters, first: int, last: int) -> np.ndarray:
    """True for the epochs first..last, both included."""
    k = np.arange(parameters.steps + 1)
    return (k >= first) & (k <= last)


def classical(matrices: System, parameters: Parameters, inflated: bool = False) -> Filter:
    """The Kalman filter on x alone. It ignores lambda, or adds its variance to R when `inflated`."""
    m = matrices
    sensor = linear_sensor(m.H, m.Q_v + inflated * m.P0_lambda, inputs=3)
    return Filter(LinearModel(m.A, m.B, m.Q), sensor, m.P0, "z", epochs_valid(parameters, 0, parameters.steps),
                  adaptation("", parameters), "posterior", "delayed")  # fmt: skip


def augmented(matrices: System, parameters: Parameters, rule: str = "", P0_lambda=None) -> Filter:
    """The Kalman filter on ``[x; lambda]``: the textbook answer to equation (4), with R = Q_v."""
    m = matrices
    model = LinearModel(block_diag(m.A, m.A_n), np.vstack([m.B, np.zeros_like(m.B)]), block_diag(m.Q, m.Q_lambda))
    sensor = linear_sensor(np.hstack([m.H, np.eye(8)]), m.Q_v, inputs=3)
    P0 = block_diag(m.P0, m.P0_lambda if P0_lambda is None else P0_lambda)
    return Filter(model, sensor, P0, "z", epochs_valid(parameters, 0, parameters.steps), adaptation(rule, parameters),
                  "posterior", "delayed")  # fmt: skip


def oracle(matrices: System, parameters: Parameters) -> Filter:
    """The augmented filter that is told the fault: Q_v of the two channels times the squared multiplier while it lasts."""
    weights = np.ones((parameters.steps + 1, 8))
    weights[parameters.fault, Q_CHANNEL] = parameters.multiplier_q**-2.0
    weights[parameters.fault, THETA_CHANNEL] = parameters.multiplier_theta**-2.0
    return augmented(matrices, parameters)._replace(weights=weights)


def printed(matrices: System, parameters: Parameters, rule: str = "", minimum: int | None = None, cross: bool = True) -> Filter:
    """MDKF of equations (10)-(16), or AMDKF of (17)-(24) with a `rule`, as printed.

    It starts with the prediction to k = 1 and ends at N-1, because mu(k) needs z(k+1): its estimate of x(k) is
    the delayed one (brief A1). `cross` False sets C = 0.
    """
    d = differenced(matrices)
    noise = d.R_process + d.R_sensor  # (10) hajiyev2023
    sensor = linear_sensor(d.H_d, noise, d.D, C_update=d.C if cross else None)  # (14), (16) hajiyev2023: C at the wrong index
    return Filter(LinearModel(matrices.A, matrices.B, matrices.Q), sensor, matrices.P0, "mu",
                  epochs_valid(parameters, 1, parameters.steps - 1), adaptation(rule, parameters, minimum), "", "posterior")  # fmt: skip


def late(matrices: System, parameters: Parameters, rule: str = "") -> Filter:
    """The misaligned reading of brief A2: mu(k-1) is processed at k as if it were a measurement of x(k)."""
    form = printed(matrices, parameters, rule)
    sensor = form.sensor._replace(D=np.zeros_like(form.sensor.D))
    valid = epochs_valid(parameters, 1, parameters.steps)
    return form._replace(sensor=sensor, reads="mu-late", valid=valid, filtered="posterior", delayed="")


def corrected(matrices: System, parameters: Parameters, rule: str = "") -> Filter:
    """The differencing filter of Bryson & Henrikson: C in the prediction, and only R_v scaled by a `rule` (brief A5, A8)."""
    d = differenced(matrices)
    sensor = linear_sensor(d.H_d, d.R_sensor, d.D, R_fixed=d.R_process, C_predict=d.C)
    return Filter(LinearModel(matrices.A, matrices.B, matrices.Q), sensor, matrices.P0, "mu",
                  epochs_valid(parameters, 0, parameters.steps - 1), adaptation(rule, parameters), "prior", "posterior")  # fmt: skip


def measurements(reads: str, ensemble: Ensemble, condition: str, matrices: System, inputs: np.ndarray) -> np.ndarray:
    """What a filter reads, shape (runs, N+1, 8): z, mu(k), or mu(k-1) - H B u(k-1) for ``mu-late``."""
    z = ensemble.z[condition]
    if reads == "z":
        return z
    mu = differenced_measurements(z, matrices.A_n)  # (6), (8) hajiyev2023
    if reads == "mu":
        return mu
    shifted = np.zeros_like(mu)
    shifted[:, 1:] = mu[:, :-1] - inputs[:-1] @ (matrices.H @ matrices.B).T
    return shifted


def run(form: Filter, parameters: Parameters, matrices: System, ensemble: Ensemble, condition: str) -> Record:
    """Run a filter over every record of an ensemble; the record holds the eight states of x."""
    inputs = controls(parameters)
    z = measurements(form.reads, ensemble, condition, matrices, inputs)
    n = form.P0.shape[0]
    x0 = np.zeros((z.shape[0], n))
    x0[:, :8] = ensemble.guess
    delayed = form.delayed == "delayed"
    if isinstance(form.weights, Weighting):
        return run_filter(Ekf(), form.model, form.sensor, form.weights, x0, form.P0, inputs, z, form.valid, 8, delayed)
    plan = schedule(Ekf(), form.model, form.sensor, form.P0, form.weights, form.valid, 8, delayed)
    return run_schedule(plan, form.model, form.sensor, x0, inputs, z, 8, delayed)


FORMS = {"classical": classical, "augmented": augmented, "oracle": oracle, "printed": printed, "late": late, "corrected": corrected}
"""The forms that a row of `robins.papers.hajiyev2023.variants` names; all take the system, the parameters and their options."""


def build(composition: Mapping, matrices: System, parameters: Parameters) -> Filter:
    """The filter of a composition ``{"form": name, **options}`` of `FORMS`."""
    options = dict(composition)
    return FORMS[options.pop("form")](matrices, parameters, **options)
