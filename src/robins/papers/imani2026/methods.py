"""From a row of the registry to a filter: the method's weights and the knobs that are tuned (sections 4.2, 4.3 of the paper).

Every family has two knobs and the same budget: the multiplier of R, which all share, and one of its own. A row of
`robins.papers.imani2026.variants` is ``{"method": name, ...}``; a row that names a family under "tuned" takes both knobs from
that family's tuning job.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

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
    grid : tuple of float
        The three values to begin with, the middle one the conventional setting.
    below, above : float
        What the grid is extended by.
    build : callable
        ``build(options, value) -> Weighting``.
    """

    label: str
    parameter: str
    grid: tuple[float, float, float]
    below: float
    above: float
    build: Callable[[Mapping, float], Weighting]


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
    "ekf": Family("EKF", "multiplier of Q", (0.1, 1.0, 10.0), 0.01, 100.0, lambda options, value: weighting("unit")),
    "ci-seq": Family(
        "CI-RKF, sequential", "probability beta", (0.90, 0.95, 0.99), 0.80, 0.999,
        lambda options, value: increment(options, probability=value),
    ),
    "ci-corr": Family(
        "CI-RKF, corrected", "probability beta", (0.90, 0.95, 0.99), 0.80, 0.999,
        lambda options, value: increment(options, probability=value, correct=True),
    ),
    "gate": Family("hard gate", "threshold [sd]", (NORMAL_GATE, 3.0, 4.5), 1.3, 6.75, lambda options, value: gate(value)),
    "single-kernel": Family(
        "single kernel", "width [sd]", (1.5, 3.0, 6.0), 0.75, 12.0, lambda options, value: correntropy([value], [1.0])
    ),
    "mk-norm": Family("multi-kernel, R / w", "multiplier of the widths", (0.5, 1.0, 2.0), 0.25, 4.0, multi_kernel),
    "mk-norm-gain": Family(
        "multi-kernel, K W", "multiplier of the widths", (0.5, 1.0, 2.0), 0.25, 4.0,
        lambda options, value: multi_kernel(options, value, on_gain=True),
    ),
    "mk-li": Family("fixed point (Li)", "width [sd]", (1.5, 3.0, 6.0), 0.75, 12.0, lambda options, value: fixed_point(value, LI)),
    "mcc1": Family(
        "fixed point (Chen)", "width [sd]", (1.5, 3.0, 6.0), 0.75, 12.0, lambda options, value: fixed_point(value, CHEN, prior=True)
    ),
    "huber": Family("Huber", "threshold [sd]", (0.6725, 1.345, 2.69), 0.33625, 5.38, lambda options, value: huber(value)),
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
