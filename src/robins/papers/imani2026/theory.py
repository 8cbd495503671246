"""Numbers behind the propositions (register) and behind claims C5, C6 and C14: analytic, by quadrature and by Monte Carlo.

Each row says what theory expects of a quantity and what this library's own functions give for it. Where draws decide, ``low`` and
``high`` are a 95 % interval and ``n`` counts the draws; where nothing is drawn they equal the value and ``n`` is 0.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd
from numba import njit
from scipy import stats

from robins.diagnostics.normality import lilliefors, shapiro_wilk
from robins.evaluate.intervals import LEVEL, Z, mean_interval, proportion_interval
from robins.foundation.noise_laws import robust_location
from robins.foundation.randomness import stream
from robins.kalman.chi_square import LINEAR, SEQUENTIAL, chi_square, sequential_increments, temporal_increments
from robins.kalman.weights import weigh
from robins.papers.imani2026 import reference
from robins.papers.imani2026.as_printed import raw_weights, reduce_printed
from robins.papers.imani2026.drive import CHANNELS, DURATION, KEY
from robins.papers.imani2026.ensemble import batches, headline
from robins.papers.imani2026.methods import raw_widths
from robins.papers.imani2026.observability import all_ranks
from robins.papers.imani2026.sensors import LAWS, Sensors
from robins.papers.protocol import Output, Settings

DRAWS = 200_000
PROBABILITIES = (0.95, 0.99)
"""Quantiles of chi-square(1) whose exceedance is counted: 3.841 and 6.635."""
VARIANCE, NOISE = 1.0, 0.5
"""Prior and noise variance of proposition 4's example."""
SCALAR_WEIGHTS = (0.25, 1.0, 1.6)
INNOVATION = 8.0
"""Innovation of proposition 5's example, in its standard deviations."""
RATIOS = (17.6, 1.0, 0.04)
"""P/R of proposition 5's examples."""
SHARES = (0.37, 0.90, 0.99)
CELLS = 24
"""Cells of mean error and final drift in Table 5: twelve channels each."""
RECORDS, LONG_RECORDS, LONG = 2000, 200, 10
"""Records of the paper's length for the spread of sample moments, and of records `LONG` times as long."""
NORMALITY_LEVEL = 0.05
EXPECTED_RANKS = {"F0": (8, 9), "F1, tau = 2 s": (14, 14), "F1": (6, 14), "F2": (6, 6)}
"""Ranks at the two thresholds of `robins.papers.imani2026.observability` (brief, check A16). At the first, gravity shows tilt and the
samples show biases and transients where these change; at the second also yaw shows, by the earth's rate, in F0."""
ANGLE_NOISE = float(np.radians(0.1))
"""White noise of the reference angles in proposition 8's example [rad]."""


class Fact(NamedTuple):
    """One row of the table; see the module's docstring."""

    quantity: str
    expected: float
    value: float
    low: float
    high: float
    n: int


def exact(quantity: str, expected: float, value: float) -> Fact:
    """A fact without sampling error."""
    return Fact(quantity, float(expected), float(value), float(value), float(value), 0)


def share(quantity: str, expected: float, hits: np.ndarray) -> Fact:
    """A fact that is a share of draws, with Wilson's interval."""
    found = proportion_interval(int(np.sum(hits)), hits.size)
    return Fact(quantity, float(expected), found.estimate, found.low, found.high, found.n)


def draws_of(settings: Settings, what: str) -> np.random.Generator:
    """The stream of one proposition."""
    return stream(settings.seed, f"{KEY}/theory/0/{what}")


@njit(cache=True)
def increments(S, innovations, increment, change):
    """Sequential increments ``(N, m)`` of the first update of each pair ``(N, 2, m)``, and (30) of the second ``(N,)``."""
    pairs, _, m = innovations.shape
    memory, R, out = np.zeros((m, m + 1)), np.zeros((m, m)), np.zeros(m)
    for i in range(pairs):
        sequential_increments(innovations[i, 0], S, R, memory, out)
        for j in range(m):
            increment[i, j] = out[j]
        temporal_increments(memory, 0, out)
        sequential_increments(innovations[i, 1], S, R, memory, out)
        temporal_increments(memory, 1, out)
        change[i] = out[0]


def difference_exceedance(threshold: float, n: int) -> float:
    """``P(X - Y > threshold)`` for independent X, Y ~ chi-square(n), by quadrature over the quantiles of Y."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    return float(0.5 * weights @ stats.chi2.sf(threshold + stats.chi2.ppf(0.5 * (1.0 + nodes), n), n))


def increment_facts(settings: Settings) -> Iterator[Fact]:
    """Claim C14: neither definition is tested with the other's law."""
    for m in (6, 1):
        S = 0.5 * np.eye(m) + 0.5
        white = draws_of(settings, f"increments-{m}").standard_normal((DRAWS, 2, m))
        increment, change = np.empty((DRAWS, m)), np.empty(DRAWS)
        increments(S, white @ np.linalg.cholesky(S).T, increment, change)
        for probability in PROBABILITIES:
            threshold = stats.chi2.ppf(probability, 1)
            yield share(f"exceedance of {threshold:.3f}, sequential increment, n = {m}", 1 - probability, increment > threshold)
            expected = difference_exceedance(threshold, m)
            yield share(f"exceedance of {threshold:.3f}, difference in time, n = {m}", expected, change > threshold)


def weight_facts(settings: Settings) -> Iterator[Fact]:
    """Proposition 3: the printed weight of a zero innovation, by the widths that the paper prescribes."""
    sensors, rate_hz = Sensors(), settings.options["rate_hz"]
    weights, mixing = np.empty(6), np.array(settings.options["kernel_weights"], float)
    raw_weights(np.zeros(6), raw_widths(settings.options, sensors, rate_hz), mixing, weights)
    relative = float(np.sum(mixing / np.square(settings.options["kernel_widths"])))
    for name, channel in (("accelerometer", 0), ("gyroscope", 3)):
        yield exact(f"w(0) as printed, {name}", relative / sensors.noise_sd(rate_hz)[channel] ** 2, weights[channel])


def variance_facts(settings: Settings) -> Iterator[Fact]:
    """Proposition 4: true and printed posterior variance when the gain is multiplied by a weight."""
    gain = VARIANCE / (VARIANCE + NOISE)
    state, noise = draws_of(settings, "posterior").standard_normal((2, DRAWS)) * np.sqrt([[VARIANCE], [NOISE]])
    for w in SCALAR_WEIGHTS:
        expected = VARIANCE * (1 - gain * w * (2 - w))
        value = float(np.var(state - w * gain * (state + noise), ddof=1))
        reach = Z * value * np.sqrt(2 / DRAWS)
        yield Fact(f"posterior variance, w = {w:g}", expected, value, value - reach, value + reach, DRAWS)
        P = np.array([[VARIANCE]])
        reduce_printed(P, np.array([[w * gain]]), np.ones((1, 1)))
        yield exact(f"posterior variance as printed, w = {w:g}", (1 - w * gain) * VARIANCE, P[0, 0])


def gain_facts(settings: Settings) -> Iterator[Fact]:
    """Proposition 5: gains after the chi-square test of one large innovation, as printed and corrected."""
    probability = settings.options["chi_square_probability"]
    rho = INNOVATION**2 / stats.chi2.ppf(probability, 1)
    for ratio in RATIOS:
        total = ratio + 1.0
        alphas = {"printed": rho, "corrected": 1.0 + (rho - 1.0) * total}
        for name, alpha in alphas.items():
            method = chi_square(1, SEQUENTIAL, LINEAR, probability, 1.0, 1.0, correct=name == "corrected")
            weights = np.ones(1)
            innovation = np.array([INNOVATION * np.sqrt(total)])
            weigh(method, method.parameters, innovation, np.array([[ratio]]), np.eye(1), method.memory.copy(), 0, weights)
            yield exact(f"gain, {name}, P/R = {ratio:g}", ratio / (ratio + alpha), ratio / (ratio + 1.0 / weights[0]))


def location_facts(settings: Settings) -> Iterator[Fact]:
    """Proposition 7: where a robust location settles in skewed zero-mean noise [sd]; expected by quadrature, found by iteration."""
    threshold = settings.options["huber_threshold"]

    def kernel_of(width: float) -> Callable:
        return lambda e: np.exp(-0.5 * np.square(e / width))

    weights = {f"kernel {width:g} sd": kernel_of(width) for width in (1.0, *settings.options["kernel_widths"])}
    weights[f"Huber {threshold:g}"] = lambda e: threshold / np.maximum(np.abs(e), threshold)
    law = LAWS["nig-zero-mean"]
    x = law.sample(draws_of(settings, "location"), (DRAWS // 5000, 5000))
    for name, weight in weights.items():
        m = np.zeros((len(x), 1))
        for _ in range(100):
            w = weight(x - m)
            m = (np.sum(w * x, axis=1) / np.sum(w, axis=1))[:, None]
        found = mean_interval(m[:, 0])
        yield Fact(f"location bias, {name}", robust_location(law, weight), *map(float, found[:3]), DRAWS)


def floor_facts(settings: Settings) -> Iterator[Fact]:
    """Proposition 8: error of rates that are differentiated reference angles, and the CI-RKF's error that an improvement needs."""
    case, highest = headline(settings), SHARES[-1]
    rate_hz = case.rate_hz
    white = draws_of(settings, "reference").standard_normal((DRAWS // 100, 100)) * ANGLE_NOISE
    rates = np.gradient(white, 1.0 / rate_hz, axis=1)[:, 1:-1]
    found, expected = mean_interval(np.sqrt(np.mean(rates**2, axis=1))), ANGLE_NOISE * rate_hz / np.sqrt(2)
    examples = [("0.1 deg of white noise", expected, found, DRAWS)]
    runs, errors = settings.sizes["sweep_runs"], reference.ReferenceErrors()
    up = CHANNELS.index("w_u")
    seen = [reference.observe(case.seed, case.scenario, run, case.driven).channels[1:-1, up] for run in range(runs)]
    true = case.driven.rate_n[1:-1, 2]
    own = mean_interval(np.array([np.sqrt(np.mean(np.square(values - true))) for values in seen]))
    sd, time_constant = errors.yaw
    step = 2.0 / rate_hz
    wandering = 2.0 * sd**2 * -np.expm1(-step / time_constant)
    examples.append(("this study's reference, w_u", np.sqrt(wandering + 2.0 * errors.angle_noise**2) / step, own, runs))
    for name, expected, found, n in examples:
        for words, factor in (("rms error of the reference rate", 1.0), ("RMSE needed for an improvement of 99 %", 1 / (1 - highest))):
            yield Fact(f"{words}, {name}", float(expected * factor), *(float(value * factor) for value in found[:3]), n)


def single_run_facts(settings: Settings) -> Iterator[Fact]:
    """Proposition 9: improvements that two equally good filters show in one run."""
    ours, other = np.abs(draws_of(settings, "single-run").standard_normal((2, DRAWS // CELLS, CELLS)))
    improved = 1 - ours / other
    for x in SHARES:
        one = 2 / np.pi * np.arctan(1 - x)
        yield share(f"P(improvement above {x:.0%}), one cell", one, improved > x)
        yield share(f"P(any of {CELLS} cells above {x:.0%})", 1 - (1 - one) ** CELLS, np.any(improved > x, axis=1))


def moment_facts(settings: Settings) -> Iterator[Fact]:
    """Claim C5: what skewness and excess kurtosis a record of the law shows; median and central 95 % over records, no interval."""
    law, length = LAWS["nig-zero-mean"], DURATION * settings.options["rate_hz"]
    quantiles = [0.5, (1 - LEVEL) / 2, (1 + LEVEL) / 2]
    for records, samples in ((RECORDS, length), (LONG_RECORDS, LONG * length)):
        generator = draws_of(settings, f"moments-{samples}")
        shapes = np.array([shape_of(law.sample(generator, (samples,))) for _ in range(records)])
        for column, (name, expected) in enumerate((("skewness", law.skewness), ("excess kurtosis", law.excess_kurtosis))):
            yield Fact(f"sample {name}, {samples} samples", expected, *np.quantile(shapes[:, column], quantiles).tolist(), records)


def shape_of(samples: np.ndarray) -> tuple[float, float]:
    """Sample skewness and excess kurtosis (biased, as the paper's software has them by default)."""
    deviation = samples - samples.mean()
    square = np.square(deviation)
    variance = square.mean()
    return float((square * deviation).mean() / variance**1.5), float(np.square(square).mean() / variance**2 - 3.0)


def normality_facts(settings: Settings) -> Iterator[Fact]:
    """Claim C6: share of the reporting runs whose noise the tests reject, by sensor, with normal noise as the control."""
    case, runs = headline(settings), range(settings.sizes["runs"])
    noise = np.concatenate([measured.noise[:, :, ::3] for _, measured in batches(case, runs)])  # first axis of each sensor
    generator = draws_of(settings, "normality")
    control = generator.standard_normal((len(runs), noise.shape[1]))
    for name, records, expected in (
        ("gyroscope", noise[:, :, 1], 1.0),
        ("accelerometer", noise[:, :, 0], 1.0),
        ("normal noise", control, NORMALITY_LEVEL),
    ):
        for test, p_value in (
            ("Shapiro-Wilk", lambda values: shapiro_wilk(values, generator).p_value),
            ("Lilliefors", lambda values: lilliefors(values).p_value),
        ):
            hits = np.array([p_value(values) < NORMALITY_LEVEL for values in records])
            yield share(f"share of runs rejected, {test}, {name}", expected, hits)


def rank_facts(settings: Settings) -> Iterator[Fact]:
    """Proposition 2: directions of the initial error that the measurements see."""
    case = headline(settings)
    for name, (found, states) in all_ranks(case.driven, case.sensors).items():
        for (threshold, rank), expected in zip(found.items(), EXPECTED_RANKS[name], strict=True):
            yield exact(f"information rank of {states} at {threshold:g}, {name}", expected, rank)


PARTS = (increment_facts, weight_facts, variance_facts, gain_facts, location_facts, floor_facts, single_run_facts, moment_facts,
         normality_facts, rank_facts)  # fmt: skip


def theory(settings: Settings) -> Output:
    """All facts: columns quantity, expected, value, low, high, n."""
    return Output(pd.DataFrame([fact for part in PARTS for fact in part(settings)], columns=list(Fact._fields)))
