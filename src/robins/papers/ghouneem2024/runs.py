"""One run: what the sensors see of a trajectory, a filter over it, and what it got wrong.

All filters of a run read the same samples. Errors are over the whole 20 Hz run, the azimuth's are wrapped.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from robins.evaluate.consistency import normalised_squared
from robins.kalman.filter import Record, run_filter
from robins.kalman.gates import integrity_gate, nis_gate
from robins.kalman.weights import Weighting, weighting
from robins.navigation.fixes import fix_sensor
from robins.navigation.riss import AZIMUTH, EAST, HEIGHT, INPUTS, NORTH, STATES, inputs, require_regular, tilt
from robins.papers.ghouneem2024.as_printed import reused
from robins.papers.ghouneem2024.filters import (
    JUMP_LIMITS,
    NIS_LIMIT,
    PATIENCE,
    PREDICTION_LIMITS,
    Design,
    model,
    predictor,
)
from robins.papers.ghouneem2024.gps import ENVIRONMENTS, Environment, Fixes, receive
from robins.papers.ghouneem2024.sensors import Sensed, initial_error, sense
from robins.papers.ghouneem2024.trajectories import RATE_HZ, trajectory

CHANNELS = ("azimuth", "v_east", "v_north", "v_up", "north", "east", "height")
"""The rows of Tables II and III: north and east are the errors of latitude and longitude in metres."""
ORDER = [6, 3, 4, 5, 0, 1, 2]
"""Where the channels stand in the state."""
BOUND = 1e5
"""Metres of horizontal error beyond which a run has failed."""
MARK_SPACING = 60
"""Seconds between the epochs whose whole covariance is kept."""
SETTLED = np.radians(5.0)
FIRST_MOTION = 60.0
"""Seconds of standstill at the start of both trajectories."""


class Case(NamedTuple):
    """What is measured on which trajectory.

    Attributes
    ----------
    seed : int
    place : str
        Name of the trajectory.
    environment : Environment
        What goes wrong with the satellites.
    hold : bool
        Whether the odometer's readings are held until the next one, instead of interpolated.
    azimuth_error : float or None
        Initial error of the azimuth, rad, in place of a random one.
    outage : tuple of float or None
        First second and length of an outage beside those of the environment.
    """

    seed: int
    place: str
    environment: Environment
    hold: bool = False
    azimuth_error: float | None = None
    outage: tuple[float, float] | None = None


class Prepared(NamedTuple):
    """A run that any filter can be given.

    Attributes
    ----------
    case : Case
    run : int
    sensed, fixes : Sensed, Fixes
    x0 : ndarray, shape (9,)
    valid : ndarray of bool, shape (N+1,)
        Epochs with a fix.
    measurements : ndarray, shape (N+1, 6)
    """

    case: Case
    run: int
    sensed: Sensed
    fixes: Fixes
    x0: np.ndarray
    valid: np.ndarray
    measurements: np.ndarray


def headline(seed: int, place: str) -> Case:
    """The frozen environment of a trajectory."""
    return Case(seed, place, ENVIRONMENTS[place])


@cache
def truth(place: str) -> np.ndarray:
    """The first seven states of a trajectory, shape (N+1, 7)."""
    driven = trajectory(place)
    return np.column_stack([driven.position, driven.velocity, driven.azimuth])


def initial_state(case: Case, run: int) -> np.ndarray:
    """Truth with initial errors; standing still, with no knowledge of bias and odometer, shape (9,)."""
    error = initial_error(case.seed, trajectory(case.place), run)
    x = np.zeros(STATES)
    x[NORTH : HEIGHT + 1] = truth(case.place)[0, NORTH : HEIGHT + 1] + error[:3]
    x[AZIMUTH] = truth(case.place)[0, AZIMUTH] + (error[3] if case.azimuth_error is None else case.azimuth_error)
    return x


def received(case: Case, run: int) -> Fixes:
    """The fixes of a run, without those in the case's own outage."""
    fixes = receive(case.seed, trajectory(case.place), run, case.environment)
    if case.outage is None:
        return fixes
    first, length = case.outage
    time = fixes.epoch / RATE_HZ
    kept = (time < first) | (time >= first + length)
    return Fixes(*(values[kept] for values in fixes))


def prepare(case: Case, run: int, fixes: Fixes | None = None) -> Prepared:
    """The samples of a run; `fixes` in place of those of the environment."""
    driven = trajectory(case.place)
    require_regular(f"trajectory {case.place}", driven.time, 1.0 / RATE_HZ)
    fixes = received(case, run) if fixes is None else fixes
    valid = np.zeros(driven.time.size, bool)
    measurements = np.zeros((driven.time.size, 6))
    valid[fixes.epoch] = True
    measurements[fixes.epoch] = fixes.value
    sensed = sense(case.seed, driven, run, case.hold)
    return Prepared(case, run, sensed, fixes, initial_state(case, run), valid, measurements)


def controls(prepared: Prepared, mode: str) -> np.ndarray:
    """Inputs of the mechanisation with the tilt `mode`, then the reported standard deviations of the fixes, shape (N+1, 15)."""
    sensed = prepared.sensed
    pitch, roll = tilt(mode, sensed.force, sensed.speed, sensed.acceleration, sensed.rate)
    u = np.zeros((sensed.rate.size, INPUTS + 6))
    u[:, :INPUTS] = inputs(sensed.rate, sensed.speed, sensed.acceleration, pitch, roll)
    u[prepared.fixes.epoch, INPUTS:] = prepared.fixes.sigma
    return u


def weights(design: Design, fixes: Fixes) -> Weighting:
    """The gate of a design for the fixes of a run."""
    if design.gate == "integrity" and np.isfinite(design.multiple):
        return integrity_gate(design.multiple * PREDICTION_LIMITS, design.multiple * JUMP_LIMITS, fixes.value)
    if design.gate in ("nis", "nis-recovery"):
        return nis_gate(NIS_LIMIT, PATIENCE if design.gate == "nis-recovery" else None)
    return weighting("unit")


def marks(place: str) -> np.ndarray:
    """Epochs whose covariance is kept."""
    step = MARK_SPACING * RATE_HZ
    return np.arange(step, trajectory(place).time.size, step)


def run(design: Design, prepared: Prepared, u: np.ndarray) -> Record:
    """Filter a run; `u` are its `controls` with the design's tilt."""
    place = prepared.case.place
    method = weights(design, prepared.fixes)
    return run_filter(
        predictor(design), model(design, place), fix_sensor(INPUTS, STATES, design.noise_scale),
        method if design.redrawn else reused(method), prepared.x0[None], np.diag(design.variances.initial), u,
        prepared.measurements[None], prepared.valid & design.updates, STATES, False, marks(place),
    )  # fmt: skip


def wrapped(angle: np.ndarray) -> np.ndarray:
    """Angles in [-pi, pi)."""
    return np.remainder(angle + np.pi, 2.0 * np.pi) - np.pi


def errors(estimate: np.ndarray, place: str, at=slice(None)) -> np.ndarray:
    """Estimate ``(N+1, 7 or more)`` minus truth, shape (N+1, 7), the azimuth's wrapped; or at the epochs `at` only."""
    difference = estimate[at, :7] - truth(place)[at]
    difference[:, AZIMUTH] = wrapped(difference[:, AZIMUTH])
    return difference


def measure(estimate: np.ndarray, place: str) -> dict[str, float]:
    """Errors of one run: RMSE by channel, horizontal, of the azimuth without wrapping, roughness, and seconds until it settled."""
    with np.errstate(over="ignore", invalid="ignore"):  # a run that diverged may hold anything
        error = errors(estimate, place)
        rmse = np.sqrt(np.mean(np.square(error), axis=0))[ORDER]
        whole = 2.0 * np.pi
        raw = np.remainder(estimate[:, AZIMUTH], whole) - np.remainder(truth(place)[:, AZIMUTH], whole)
        bend = np.diff(error[:, [NORTH, EAST]], 2, axis=0)
        return dict(zip(CHANNELS, rmse, strict=True)) | {
            "horizontal": np.hypot(rmse[4], rmse[5]),
            "azimuth_unwrapped": np.sqrt(np.mean(np.square(raw))),
            "roughness": np.sqrt(np.mean(np.sum(np.square(bend), axis=1))),
            "settled": settling(error[:, AZIMUTH]),
        }


def settling(error: np.ndarray) -> float:
    """Seconds from the first motion until the azimuth error stays below 5 degrees, infinite when it never does; `error` (N+1,)."""
    beyond = np.flatnonzero(~(np.abs(error) < SETTLED))
    last = beyond[-1] + 1 if beyond.size else 0
    return np.inf if last == error.size else max(0.0, last / RATE_HZ - FIRST_MOTION)


MEASURES = (*CHANNELS, "horizontal", "azimuth_unwrapped", "roughness", "settled")


def longest(flags: np.ndarray) -> int:
    """Length of the longest run of true values."""
    edges = np.flatnonzero(np.diff(np.r_[0, flags.astype(int), 0]))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


def consistency(record: Record, prepared: Prepared) -> dict[str, float]:
    """Mean NIS of the accepted fixes, mean NEES of position and azimuth at the marked epochs, and counts of rejected fixes."""
    used = prepared.fixes.epoch
    rejected = np.any(record.weights[0, used] == 0.0, axis=1)
    error = errors(record.posterior[0], prepared.case.place, marks(prepared.case.place))
    P = record.covariance[0]
    position = slice(NORTH, HEIGHT + 1)
    accepted = record.nis[0, used][~rejected]
    return {
        "nis": float(np.mean(accepted)) if accepted.size else np.nan,
        "nees_position": float(np.mean(normalised_squared(error[:, position], P[:, position, position]))),
        "nees_azimuth": float(np.mean(error[:, AZIMUTH] ** 2 / P[:, AZIMUTH, AZIMUTH])),
        "fixes": used.size,
        "rejected": int(np.sum(rejected)),
        "longest_rejection": longest(rejected),
    }


COUNTS = ("nis", "nees_position", "nees_azimuth", "fixes", "rejected", "longest_rejection")
COLUMNS = ("run", *MEASURES, *COUNTS, "failed", "reason")
"""What every table of scores has behind its labels: SI, radians and seconds; a failed run has NaN for its errors."""


def failure(record: Record, place: str) -> str:
    """Why a run failed, "" where it did not."""
    if record.failed[0] >= 0:
        return f"no Cholesky factor or not finite at epoch {record.failed[0]}"
    error = record.posterior[0, :, NORTH : EAST + 1] - truth(place)[:, NORTH : EAST + 1]
    return "" if np.max(np.hypot(*error.T)) <= BOUND else f"horizontal error beyond {BOUND:g} m"


def score(design: Design, prepared: Prepared, u: np.ndarray) -> dict:
    """A row of `COLUMNS`."""
    record = run(design, prepared, u)
    reason = failure(record, prepared.case.place)
    if reason:
        lost = dict.fromkeys((*MEASURES, *COUNTS), np.nan) | {"fixes": prepared.fixes.epoch.size, "rejected": 0, "longest_rejection": 0}
        return {"run": prepared.run, **lost, "failed": True, "reason": reason}
    found = measure(record.posterior[0], prepared.case.place) | consistency(record, prepared)
    return {"run": prepared.run, **found, "failed": False, "reason": ""}


def held_fixes(prepared: Prepared) -> np.ndarray:
    """The estimate without any filter, (N+1, 7): the last fix, and its course as azimuth where the speed exceeds 1 m/s."""
    fixes, x0 = prepared.fixes, prepared.x0
    values = np.vstack([x0[:AZIMUTH], fixes.value])
    moving = np.hypot(values[:, 3], values[:, 4]) > 1.0
    course = np.where(moving, np.arctan2(values[:, 3], values[:, 4]), np.nan)
    course[0] = x0[AZIMUTH]
    known = np.maximum.accumulate(np.where(np.isfinite(course), np.arange(course.size), 0))
    last = np.searchsorted(fixes.epoch, np.arange(prepared.valid.size), side="right")
    return np.column_stack([values, course[known]])[last]


def score_held(prepared: Prepared) -> dict:
    """A row of `COLUMNS` for `held_fixes`."""
    none = dict.fromkeys(COUNTS[:3], np.nan) | {"fixes": prepared.fixes.epoch.size, "rejected": 0, "longest_rejection": 0}
    return {"run": prepared.run, **measure(held_fixes(prepared), prepared.case.place), **none, "failed": False, "reason": ""}


def scores(case: Case, runs: Sequence[int], designs: Mapping[tuple, Design], labels: Sequence[str]) -> pd.DataFrame:
    """Scores of several designs on the same samples; the keys of `designs` are the values of the columns `labels`."""
    rows = []
    for number in runs:
        prepared = prepare(case, number)
        inputs_of = {mode: controls(prepared, mode) for mode in {made.tilt for made in designs.values()}}
        for key, made in designs.items():
            rows.append(dict(zip(labels, key, strict=True)) | score(made, prepared, inputs_of[made.tilt]))
    return pd.DataFrame(rows, columns=[*labels, *COLUMNS])
