"""From a row of the registry to a filter: the method's weights and the knobs that are tuned (sections 4.2, 4.3 of the paper).

Every family has two knobs and the same budget: the multiplier of R, which all share, and one of its own. A row of
`robins.papers.imani2026.variants` is ``{"method": name, ...}``; a row that names a family under "tuned" takes both knobs from
that family's tuning job.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from scipy.special import erf

from robins.kalman import chi_square as increments
from robins.kalman.chi_square import chi_square
from robins.kalman.gates import gate
from robins.kalman.m_estimators import correntropy, huber
from robins.kalman.weights import Iteration, Weighting, weighting
from robins.papers.imani2026.as_printed import Printed, plain_noise, raw_correntropy
from robins.papers.imani2026.sensors import Sensors

INCREMENTS = {"sequential": increments.SEQUENTIAL, "marginal": increments.MARGINAL, "temporal": increments.TEMPORAL}
SHAPES = {"linear": increments.LINEAR, "root": increments.ROOT, "reject": increments.REJECT}
LI = Iteration(limit=3, tolerance=1e-5, floor=1e-4, warm=False, prior=np.zeros(0))
"""Iterations, tolerance and smallest weight of Li et al.'s program; the prior keeps weight one."""
CHEN = Iteration(limit=3, tolerance=1e-6, floor=1e-8, warm=False, prior=np.zeros(0))
"""Chen et al.; the prior's kernel is set beside the measurement's."""
NORMAL_GATE = 1.959963984540054
"""Square root of the 95 % quantile of chi-square with one degree of freedom."""


class Method(NamedTuple):
    """What `robins.kalman.filter.run_filter` is told beyond the formulation.

    Attributes
    ----------
    weighting : Weighting or Printed
    noise_scale, process_scale : float
        Multipliers of R and Q.
    updates : bool
        Whether measurements are processed at all.
    """

    weighting: Weighting | Printed
    noise_scale: float = 1.0
    process_scale: float = 1.0
    updates: bool = True


class Setting(NamedTuple):
    """The two knobs of a family: the multiplier of R and the family's own parameter."""

    noise_scale: float
    value: float


class Family(NamedTuple):
    """A family that is tuned.

    Attributes
    ----------
    label, parameter : str
        Words for readers: the family, and its own knob.
    values : tuple of float
        Five values; the middle one is the conventional setting, the outer ones are what the grid of the inner three is extended by.
    build : callable
        ``build(options, value) -> Weighting``.
    """

    label: str
    parameter: str
    values: tuple[float, float, float, float, float]
    build: Callable[[Mapping, float], Weighting]

    @property
    def grid(self) -> tuple[float, float, float]:
        """The values to begin with."""
        return self.values[1:4]


def around(conventional: float, step: float = 2.0) -> tuple[float, ...]:
    """Five values, a factor `step` apart: every robust family reaches as far on either side of its conventional setting."""
    return tuple(conventional * step**k for k in (-2, -1, 0, 1, 2))


def within(deviations: float) -> float:
    """The probability of a normal variable within so many standard deviations: the beta whose chi-square quantile is their square."""
    return float(erf(deviations / np.sqrt(2.0)))


def kernels(options: Mapping, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """The configured widths times `scale`, and the mixing weights."""
    return scale * np.array(options["kernel_widths"], float), np.array(options["kernel_weights"], float)


def multi_kernel(options: Mapping, scale: float, on_gain: bool = False) -> Weighting:
    """Normalised multi-kernel correntropy of standardised innovations; `on_gain` multiplies the gain instead of dividing R."""
    return correntropy(*kernels(options, scale))._replace(on_gain=on_gain)


def fixed_point(width: float, iteration: Iteration, prior: bool = False) -> Weighting:
    """Correntropy with one width for every whitened residual, iterated; `prior` weighs the prior's residuals alike."""
    method = correntropy([width], [1.0])
    return method._replace(iteration=iteration._replace(prior=method.parameters if prior else np.zeros(0)))


def increment(options: Mapping, kind: str = "sequential", shape: str = "linear", correct: bool = False, probability: float = 0.0,
              lower: float = 0.0, upper: float = 0.0) -> Weighting:  # fmt: skip
    """Chi-square increments with the configured probability and thresholds, unless others are given."""
    low = lower or options["chi_square_lower"]
    high = upper or options["chi_square_upper"]
    return chi_square(6, INCREMENTS[kind], SHAPES[shape], probability or options["chi_square_probability"], low, high, correct)


FAMILIES: Mapping[str, Family] = {
    "ekf": Family("EKF", "multiplier of Q", around(1.0, 10.0 ** (1 / 3)), lambda options, value: weighting("unit")),
    "ci-seq": Family(
        "CI-RKF, sequential", "threshold [sd]", around(NORMAL_GATE), lambda options, value: increment(options, probability=within(value))
    ),
    "ci-corr": Family(
        "CI-RKF, corrected", "threshold [sd]", around(NORMAL_GATE),
        lambda options, value: increment(options, probability=within(value), correct=True),
    ),
    "gate": Family("hard gate", "threshold [sd]", around(NORMAL_GATE), lambda options, value: gate(value)),
    "single-kernel": Family(
        "single kernel, R / w", "width [sd]", around(3.0), lambda options, value: correntropy([value], [1.0])
    ),
    "single-kernel-gain": Family(
        "single kernel, K W", "width [sd]", around(3.0), lambda options, value: correntropy([value], [1.0])._replace(on_gain=True)
    ),
    "mk-norm": Family("multi-kernel, R / w", "multiplier of the widths", around(1.0), multi_kernel),
    "mk-norm-gain": Family(
        "multi-kernel, K W", "multiplier of the widths", around(1.0),
        lambda options, value: multi_kernel(options, value, on_gain=True),
    ),
    "mk-li": Family("fixed point (Li)", "width [sd]", around(3.0), lambda options, value: fixed_point(value, LI)),
    "mcc1": Family(
        "fixed point (Chen)", "width [sd]", around(3.0), lambda options, value: fixed_point(value, CHEN, prior=True)
    ),
    "huber": Family("Huber", "threshold [sd]", around(1.345), lambda options, value: huber(value)),
}  # fmt: skip
"""The families that are tuned, in the order of the tables."""

SWEPT = ("ekf", "ci-seq", "ci-corr", "gate", "single-kernel", "mk-norm", "mk-norm-gain", "mk-li")
"""The families whose tuned filters run in every sweep; the tuned EKF's variant is called ``ekf-tuned``."""


def tuned(family: str, options: Mapping, setting: Setting) -> Method:
    """A family's filter at a setting."""
    method = FAMILIES[family].build(options, setting.value)
    return Method(method, setting.noise_scale, setting.value if family == "ekf" else 1.0)


def raw_widths(options: Mapping, sensors: Sensors, rate_hz: int) -> np.ndarray:
    """Kernel widths in proportion to the residuals' standard deviation, as section 4.3 prescribes, SI, shape (6, L)."""
    return np.outer(sensors.noise_sd(rate_hz), options["kernel_widths"])


def nominal(row: Mapping, options: Mapping, sensors: Sensors, rate_hz: int) -> Method:
    """The filter of a row of the registry that is not tuned."""
    choices = dict(row)
    name = choices.pop("method")
    if name == "ekf":
        return Method(weighting("unit"), noise_scale=10.0 ** choices.get("decades", 0))
    if name == "no-update":
        return Method(weighting("unit"), updates=False)
    if name == "chi-square":
        return Method(increment(options, **choices))
    if name == "chi-square-plain-r":
        return Method(plain_noise(increment(options)))
    if name == "gate":
        return Method(gate(choices["threshold"]))
    if name == "huber":
        return Method(huber(options["huber_threshold"]))
    if name == "correntropy":
        return Method(multi_kernel(options, 1.0, choices.get("on_gain", False)))
    if name == "correntropy-raw":
        return Method(raw_correntropy(raw_widths(options, sensors, rate_hz), options["kernel_weights"]))
    raise ValueError(f"no method is called {name!r}")
