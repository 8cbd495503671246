"""What the wing's tables are made of: columns with their tolerances, and summaries of surviving runs."""

from collections.abc import Callable, Iterable

import numpy as np

from robins.evaluate.intervals import TIE, log_interval, mean_interval
from robins.papers.hajiyev2023.comparisons import LATERAL, LONGITUDINAL, Scores
from robins.papers.protocol import Column, Table
from robins.publish.tables import FAILED

ADAPTIVE = 1e-6
"""Relative tolerance of a table that holds adaptive filters."""
LINEAR = 1e-9
ROUND_OFF = 1e-12
"""Absolute tolerance: what is zero on one machine may be rounding on another."""
SUBSTITUTE = "Substitute aircraft (F-4C)."


def keys(*names: str) -> tuple[Column, ...]:
    """Columns that identify a row."""
    return tuple(Column(name, "key") for name in names)


def texts(*names: str, kind: str = "text") -> tuple[Column, ...]:
    """Columns of words."""
    return tuple(Column(name, kind) for name in names)


def counts(*names: str) -> tuple[Column, ...]:
    """Columns of whole numbers."""
    return tuple(Column(name, "count") for name in names)


def numbers(*names: str, kind: str = "number", relative: float = ADAPTIVE, unit: str = "") -> tuple[Column, ...]:
    """Columns of numbers with a relative tolerance."""
    return tuple(Column(name, kind, unit, relative, ROUND_OFF) for name in names)


def make(name: str, title: str, build: Callable, columns: Iterable[tuple[Column, ...]], needs: Iterable[str], caption: str,
         size: str = "runs", location: str = "extra") -> Table:  # fmt: skip
    """A table whose modules are the one that builds it, and what that imports."""
    return Table(
        name, title, location, tuple(c for group in columns for c in group), build, tuple(needs), (build.__module__,), caption, size
    )


def finite(value: float) -> float | str:
    """`value`, or the word ``failed`` where no surviving run gave one."""
    return float(value) if np.isfinite(value) else FAILED


def ends(name: str, low: float, high: float) -> dict[str, float | str]:
    """Both ends of an interval as ``<name>_low`` and ``<name>_high``, or twice the word ``failed``."""
    sound = np.isfinite([low, high]).all()
    return {f"{name}_low": float(low) if sound else FAILED, f"{name}_high": float(high) if sound else FAILED}


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
