"""What the wing's tables share: the words of their captions, units as the paper has them, and cells of levels and improvements."""

import numpy as np

from robins.evaluate.ensembles import Improvement, Level
from robins.papers.columns import ends, finite
from robins.papers.imani2026.comparisons import GROUPS
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.methods import SWEPT
from robins.papers.imani2026.studies import variant_name
from robins.publish.tables import FAILED

RUNS = "Runs 0 to n - 1 of the configuration's seed; settings were tuned on runs from 1000 on, in F1, and frozen."
"""Which runs a table reports from, and which it does not."""
HEADLINE = "10 Hz, zero-mean normal-inverse-Gaussian gyro noise, no outliers."
RATIO = "an improvement is what the ratio lacks to 1"
INTERVAL = "95 % interval over the runs (bootstrap; below fifty runs Student's on a jackknife)"
LOSSES = "A failed run counts as a loss of its filter."
SURVIVORS = "Over the surviving runs; the median counts a failed run as infinite."
FORMULATIONS_CAPTION = "F0: quasi-static (printed states), F1: augmented, F2: hybrid."

IMPROVEMENT_TOLERANCE = 5e-8
"""Absolute tolerance of an improvement in per cent: the difference of two errors that agree to nine digits and regenerate to as many."""
UNITS = dict(zip(GROUPS, ("m/s", "m/s^2", "rad/s", "deg"), strict=True))
"""Units of the tables by domain; jobs have radians."""
UNIT = {channel: UNITS[group] for group, channels in GROUPS.items() for channel in channels}
SWEPT_FILTERS = tuple(variant_name(family) for family in SWEPT)
"""Filters of all sweeps."""


def not_available(number: int) -> str:
    """The disclosure that a table of the paper came without its cells (D1 of the register)."""
    return f"The cells of the paper's Table {number} were not in the text that was available; every cell here is ours."


def shown(value: float, unit: str) -> float:
    """`value` in the unit of a table: degrees instead of radians."""
    return float(np.degrees(value)) if unit.startswith("deg") else value


def level_cells(name: str, found: Level, unit: str) -> dict[str, float | str]:
    """``<name>``, ``<name>_low`` and ``<name>_high`` of an ensemble value, in the table's unit."""
    estimate, low, high = (shown(value, unit) for value in found[:3])
    return {name: finite(estimate)} | ends(name, low, high)


def improvement_cells(name: str, found: Improvement) -> dict[str, float | str]:
    """``<name>``, ``<name>_low`` and ``<name>_high`` of an improvement, in per cent."""
    return {name: finite(100.0 * found.estimate)} | ends(name, 100.0 * found.low, 100.0 * found.high)


def ratio_cells(found: Improvement) -> dict[str, float | str]:
    """``ratio``, ``ratio_low`` and ``ratio_high``: one minus the improvement, which keeps its digits where two filters hardly differ."""
    return {"ratio": finite(1.0 - found.estimate)} | ends("ratio", 1.0 - found.high, 1.0 - found.low)


def p_value(found: Improvement, value: float) -> float | str:
    """`value`, or the word ``failed`` where fewer than two runs survive and nothing was tested."""
    return float(value) if found.survivors > 1 else FAILED


def interval_names(*names: str) -> tuple[str, ...]:
    """Each name, followed by those of the ends of its interval."""
    return tuple(f"{name}{end}" for name in names for end in ("", "_low", "_high"))


def channel_units() -> list[tuple[str, str]]:
    """Every channel with its unit."""
    return [(channel, UNIT[channel]) for channel in CHANNELS]
