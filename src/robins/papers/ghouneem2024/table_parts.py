"""What the wing's tables share: the words of their captions, units as the paper has them, and cells of errors, ratios and gates."""

import numpy as np
import pandas as pd

from robins.evaluate.ensembles import BOOTSTRAP_RUNS
from robins.evaluate.intervals import Interval, mean_interval, proportion_interval
from robins.papers.columns import ends, finite
from robins.papers.ghouneem2024.comparisons import GeometricRatio, Where, mean_of, ratio_of, rows
from robins.papers.ghouneem2024.ensemble import FIRST_RUN
from robins.papers.ghouneem2024.studies import FIRST_SIDE_RUN
from robins.papers.ghouneem2024.tune import FIRST_TUNING_RUN
from robins.papers.protocol import Results
from robins.publish.tables import FAILED

FROZEN = f"Settings were tuned on runs {FIRST_TUNING_RUN} and on and frozen; T1-frozen: on those of T1."
RUNS = f"Runs {FIRST_RUN} to {FIRST_RUN - 1} + n of the configuration's seed on each trajectory. {FROZEN}"
"""Which runs a table reports from, and which it does not."""
SIDE_RUNS = f"Runs {FIRST_SIDE_RUN} to {FIRST_SIDE_RUN - 1} + n of the configuration's seed on each trajectory."
TUNING_RUNS = f"Runs {FIRST_TUNING_RUN} to {FIRST_TUNING_RUN - 1} + n of the configuration's seed, which no other result uses."
PLAIN = "Data sheet's variances, no gate."
INTERVAL = f"95 % interval over the runs (percentiles of a bootstrap; below {BOOTSTRAP_RUNS} runs Student's t), of the logarithm"
MEAN = f"Geometric mean over the surviving runs with its {INTERVAL}"
RATIO = f"Ratios are paired geometric means with their {INTERVAL}; a failed run counts as a loss of its filter."
FILTER_WORDS = (
    "ekf-pi, ekf-pm: the printed EKF, incremental and memoryless; ekf-f: EKF with the UKF's model; ukf-st-gate: the paper's method."
)  # fmt: skip

UNITS = {"azimuth": "deg", "azimuth_unwrapped": "deg", "v_east": "m/s", "v_north": "m/s", "v_up": "m/s"}
"""Units of the tables; measures that are not named are in metres. Jobs have radians."""
SMALLEST_PERCENT = 1e-3
SHORT = ("horizontal", "height", "azimuth")
"""The measures of tables that do not show all channels."""


def unit_of(measure: str) -> str:
    """Unit of a measure in a table."""
    return UNITS.get(measure, "m")


def shown(value: float, unit: str) -> float:
    """`value` in the unit of a table: degrees instead of radians."""
    return float(np.degrees(value)) if unit.startswith("deg") else float(value)


def interval_names(*names: str) -> tuple[str, ...]:
    """Each name, followed by those of the ends of its interval."""
    return tuple(f"{name}{end}" for name in names for end in ("", "_low", "_high"))


def mean_cells(results: Results, name: str, at: Where, measure: str) -> dict[str, float | str]:
    """``<name>``, ``<name>_low`` and ``<name>_high``: geometric mean of a measure, in the table's unit."""
    found, unit = mean_of(results, at, measure), unit_of(measure)
    low, high = (shown(value, unit) for value in (found.low, found.high))
    return {name: finite(shown(found.estimate, unit))} | ends(name, low, high)


def quantile_cells(results: Results, at: Where, measure: str) -> dict[str, float | str]:
    """``median`` and ``q90`` over all runs, a failed run's error being infinite."""
    found, unit = mean_of(results, at, measure), unit_of(measure)
    return {"median": finite(shown(found.median, unit)), "q90": finite(shown(found.upper, unit))}


def tally(results: Results, at: Where) -> dict[str, int]:
    """``n`` and ``failed``."""
    failed = rows(results, at)["failed"]
    return {"n": len(failed), "failed": int(failed.sum())}


def ratio_cells(found: GeometricRatio, name: str = "ratio") -> dict[str, float | str]:
    """``<name>``, ``<name>_low`` and ``<name>_high``."""
    return {name: finite(found.estimate)} | ends(name, found.low, found.high)


def compared(results: Results, above: Where, below: Where, measure: str = "horizontal") -> dict:
    """A ratio with the share of runs that its numerator wins, ``n``, ``failed`` and ``over_failed``."""
    found = ratio_of(results, above, below, measure)
    counts = {"n": found.n, "failed": found.numerator_failed, "over_failed": found.denominator_failed}
    return ratio_cells(found) | {"better": found.better.estimate} | counts


COMPARED = (*interval_names("ratio"), "better")
COMPARED_TALLY = ("n", "failed", "over_failed")


def interval_cells(name: str, found: Interval) -> dict[str, float | str]:
    """An estimate with the ends of its interval."""
    return {name: finite(found.estimate)} | ends(name, found.low, found.high)


def average_cells(name: str, values: pd.Series) -> dict[str, float | str]:
    """Mean over the runs that have a value, with its interval (Student's t)."""
    kept = values.to_numpy(float)
    kept = kept[np.isfinite(kept)]
    return interval_cells(name, mean_interval(kept) if kept.size else Interval(np.nan, np.nan, np.nan, 0))


def gate_cells(results: Results, at: Where) -> dict[str, float | str]:
    """Share of fixes rejected, mean over the surviving runs, and the longest run of consecutive rejections in any of them (fixes)."""
    found = rows(results, at)
    kept = found[~found["failed"]]
    share, longest = (kept["rejected"] / kept["fixes"]).mean(), kept["longest_rejection"].max()
    return {"rejected": finite(share), "longest_rejection": finite(longest)}


def settling_cells(results: Results, at: Where) -> dict[str, float | str]:
    """Median time to settle and share of runs that settle at all, with Wilson's interval; a failed run never does."""
    found = rows(results, at)
    time = np.where(found["failed"], np.inf, found["settled"])
    share = proportion_interval(int(np.isfinite(time).sum()), len(time))
    return {"settled": finite(np.quantile(time, 0.5, method="inverted_cdf"))} | interval_cells("share", share)


def percent(difference: float) -> str:
    """A largest relative difference in per cent as text; what regenerates no closer than rounding is ``below 0.001``."""
    if not np.isfinite(difference):
        return FAILED
    return f"{100 * difference:.4g}" if 100 * difference >= SMALLEST_PERCENT else f"below {SMALLEST_PERCENT:g}"


def largest_difference(results: Results, above: Where, below: Where, measures: tuple[str, ...]) -> str:
    """Largest relative difference of two filters in a run that both survive and in any of `measures`, in per cent (`percent`)."""
    own, other = (rows(results, at)[list(measures)].to_numpy(float) for at in (above, below))
    return percent(np.max(np.abs(own / other - 1.0), initial=-np.inf, where=np.isfinite(own + other)))


def multiple_words(multiple: float) -> str:
    """A multiple of the gate's thresholds as text: infinity is no gate."""
    return f"{multiple:g}" if np.isfinite(multiple) else "no gate"


def framed(made: list[dict]) -> pd.DataFrame:
    """Rows as a table with the counts of runs behind everything else."""
    frame = pd.DataFrame(made)
    last = [name for name in ("n", "failed") if name in frame] + [name for name in frame.columns if name.endswith("_failed")]
    return frame[[name for name in frame.columns if name not in last] + last]


def labels_of(table: pd.DataFrame, names: tuple[str, ...]) -> list[dict]:
    """The combinations of these columns, in the order of the rows."""
    return table[list(names)].drop_duplicates().to_dict("records")
