"""The filters of section II-B: which mechanisation, which variances, which gate. A filter is a `Design`; an ablation replaces a field.

Variances are those of the brief, sections 2.5 and 1 (22): metric states, one 20 Hz step. The paper prints none of them.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from robins.kalman.predict import Ekf, Ukf, unscented
from robins.navigation.riss import (
    AZIMUTH,
    GYRO_BIAS,
    INCREMENTAL,
    MEMORYLESS,
    ODOMETER,
    PRINTED,
    STATES,
    TOTAL,
    V_EAST,
    V_UP,
    Riss,
    riss,
)
from robins.papers.ghouneem2024.as_printed import printed_centre
from robins.papers.ghouneem2024.trajectories import RATE_HZ, trajectory

FILTERS = ("ekf-pi", "ekf-pm", "ekf-f", "ukf")
LOOPS = {"ekf-pi": INCREMENTAL, "ekf-pm": MEMORYLESS, "ekf-f": TOTAL, "ukf": TOTAL}
"""What becomes of the velocity that the filter corrects; the paper does not say."""
DT = 1.0 / RATE_HZ
HEIGHT_OF_ORIGIN = 100.0
GYRO_NOISE = np.radians(0.0237)
"""White noise of a 20 Hz sample, rad/s."""
TURN_ON = np.radians(0.03)
BIAS_TIME, ODOMETER_TIME = 300.0, 60.0
VELOCITY_FLOOR = 1e-6
"""(m/s)^2 that a step adds to each velocity of the total-state filters, whose velocity is a function of other states."""
PREDICTION_LIMITS = np.array([30.0, 30.0, 30.0, 5.0, 5.0, 2.0])
JUMP_LIMITS = np.array([40.0, 40.0, 20.0, 6.0, 6.0, 2.0])
"""TH_RISS and TH_GPS of (24) for the multiple one: m and m/s."""
NIS_LIMIT = 22.457744484825323
"""99.9 % quantile of chi-square with six degrees of freedom."""
PATIENCE = 10
"""Consecutive rejections after which the gate with recovery accepts a fix."""


class Variances(NamedTuple):
    """What a step adds (Q), and what the filter starts with (P0), each (9,)."""

    process: np.ndarray
    initial: np.ndarray


class Design(NamedTuple):
    """One filter.

    Attributes
    ----------
    filter : str
        One of `FILTERS`.
    variances : Variances
        Without the floor of the total-state filters.
    gate : str
        ``none``, ``integrity`` (24), ``nis`` or ``nis-recovery``.
    multiple : float
        Of both thresholds of (24).
    noise_scale : float
        Of R.
    updates : bool
        Whether fixes are used at all.
    tilt, turning, clockwise
        See `robins.navigation.riss`.
    alpha, beta, kappa : float
        Of the sigma points.
    printed_weights, redrawn : bool
        Whether W0c is the product that (18) prints; whether sigma points are drawn again for the update, which (25) does not say.
    """

    filter: str
    variances: Variances
    gate: str = "none"
    multiple: float = np.inf
    noise_scale: float = 1.0
    updates: bool = True
    tilt: str = PRINTED
    turning: bool = False
    clockwise: float = -1.0
    alpha: float = 0.1
    beta: float = 2.0
    kappa: float = 0.0
    printed_weights: bool = False
    redrawn: bool = True


def gauss_markov(deviation: float, time: float) -> float:
    """Variance that a step adds to a first-order Gauss-Markov process, ``2 sigma^2 dt / tau``."""
    return 2.0 * deviation**2 * DT / time  # (5), (6) ghouneem2024


def datasheet(name: str) -> Variances:
    """Variances from data sheet and Allan deviation, without a reference: the level ``ds`` (brief, 2.5)."""
    total = LOOPS[name] == TOTAL
    process = np.zeros(STATES)
    process[AZIMUTH] = (1.3 * GYRO_NOISE * DT) ** 2
    process[GYRO_BIAS] = gauss_markov(np.radians(10.0 / 3600.0), BIAS_TIME)
    process[ODOMETER] = gauss_markov(0.3 if total else 0.113, ODOMETER_TIME)
    initial = np.array([3.0, 3.0, 5.0, 0.3, 0.3, 0.3, np.radians(5.0), TURN_ON, 0.3 if total else 0.12]) ** 2
    return Variances(process, initial)


def physical() -> Variances:
    """Variances of the EKF that was set once, from physics, before any run (brief, 2.5)."""
    process = np.r_[
        np.array([0.3, 0.3, 0.5]) ** 2 * DT, np.array([0.15, 0.15, 0.3]) ** 2, (2.0 * GYRO_NOISE * DT) ** 2,
        gauss_markov(np.radians(20.0 / 3600.0), BIAS_TIME), gauss_markov(0.3, ODOMETER_TIME),
    ]  # fmt: skip
    return Variances(process, datasheet("ekf-f").initial)


def design(name: str, options: Mapping, variances: Variances | None = None, **fields) -> Design:
    """A `Design` with the configured sigma points and, unless others are given, the variances of the data sheet.

    Raises
    ------
    ValueError
        No such filter or gate; a multiple, variance or noise scale that is not positive (variances of Q and P0 may be zero).
    """
    if name not in FILTERS:
        raise ValueError(f"filter: found {name!r}, expected one of {', '.join(FILTERS)}")
    made = Design(name, datasheet(name) if variances is None else variances)
    made = made._replace(**{"alpha": options["alpha"], "beta": options["beta"], "kappa": options["kappa"]} | fields)
    if made.gate not in ("none", "integrity", "nis", "nis-recovery"):
        raise ValueError(f"gate: found {made.gate!r}, expected none, integrity, nis or nis-recovery")
    for field, value in (("multiple", made.multiple), ("noise_scale", made.noise_scale)):
        if not value > 0.0:
            raise ValueError(f"{field}: found {value}, expected a positive number")
    for field, value in made.variances._asdict().items():
        if value.shape != (STATES,) or not (np.isfinite(value).all() and (value >= 0.0).all()):
            raise ValueError(f"{field}: found {value}, expected {STATES} variances, none of them negative")
    return made


def model(made: Design, place: str) -> Riss:
    """The mechanisation of a design at the origin of a trajectory."""
    noise = made.variances.process.copy()
    if LOOPS[made.filter] == TOTAL:
        noise[V_EAST : V_UP + 1] += VELOCITY_FLOOR
    latitude = trajectory(place).latitude
    return riss(LOOPS[made.filter], DT, latitude, HEIGHT_OF_ORIGIN, noise, BIAS_TIME, ODOMETER_TIME, made.turning, made.clockwise)


def predictor(made: Design) -> Ekf | Ukf:
    """Linearisation, or sigma points with the design's weights."""
    if made.filter != "ukf":
        return Ekf()
    points = unscented(STATES, made.alpha, made.beta, made.kappa)
    return points._replace(covariance_centre=printed_centre(points, made.alpha, made.beta)) if made.printed_weights else points
