"""What the wing's tables are made of: summaries of surviving runs."""

from collections.abc import Iterable

import numpy as np

from robins.evaluate.intervals import TIE, log_interval, mean_interval
from robins.papers.columns import ends, finite
from robins.papers.hajiyev2023.comparisons import LATERAL, LONGITUDINAL, Scores
from robins.publish.tables import FAILED

SUBSTITUTE = "Substitute aircraft (F-4C)."


def level(values: np.ndarray) -> dict[str, float | str]:
    """Mean with its interval, 5 % and 95 % quantiles of the surviving runs' values, shape (runs,)."""
    if len(values) < 2:
        return dict.fromkeys(("mean", "low", "high", "p5", "p95"), FAILED)
    mean = mean_interval(values)
    p5, p95 = np.quantile(values, (0.05, 0.95))
    return {name: float(value) for name, value in zip(("mean", "low", "high", "p5", "p95"), (*mean[:3], p5, p95), strict=True)}


def median(values: np.ndarray, failed: np.ndarray) -> float | str:
    """Median over all runs, a failed one as infinite."""
    return finite(np.median(np.where(failed, np.inf, values)))


def survivors(found: Iterable[Scores]) -> np.ndarray:
    """True for the runs that fail in none of these, shape (runs,)."""
    return ~np.any([each.failed for each in found], axis=0)


def geometric(numerator: np.ndarray, denominator: np.ndarray) -> dict[str, float | str]:
    """Geometric mean of paired ratios with its normal interval; runs that survive in both."""
    logs = np.log(numerator) - np.log(denominator)
    logs[np.abs(logs) < TIE] = 0.0
    estimate, low, high = np.exp(log_interval(logs))
    return {"ratio": finite(estimate)} | ends("ci", low, high)


def patterns(found: np.ndarray) -> dict[str, np.ndarray]:
    """Which runs (or parameter sets) have each pattern of the paper's Table 1; signs ``(n, 8)``, -1 better, 1 worse."""
    longitudinal = np.all(found[:, : len(LONGITUDINAL)] < 0, axis=1)
    lateral = np.all(found[:, -len(LATERAL) :] > 0, axis=1)
    return {
        "four longitudinal better": longitudinal,
        "four lateral worse": lateral,
        "both, as published": longitudinal & lateral,
    }
