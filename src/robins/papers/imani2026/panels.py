"""What the wing's figures share: symbols and units of the channels, legends, axes of improvements, groups of three channels.

A group of channels (the paper's domains) is shown by one number, the geometric mean over its three channels, so that none
outweighs the others; the ensemble value of a channel is that of `robins.papers.imani2026.comparisons`.
"""

from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from robins.evaluate.ensembles import log_ends, multiplicities, with_stand_ins
from robins.foundation.randomness import stream
from robins.papers.imani2026.comparisons import GROUPS, Filter, Scores, sweep_scores
from robins.papers.imani2026.drive import CHANNELS, KEY
from robins.papers.imani2026.palette import look
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

SYMBOLS = dict(zip(CHANNELS, ("$V_e$", "$V_n$", "$V_u$", "$a_e$", "$a_n$", "$a_u$", r"$\omega_e$", r"$\omega_n$", r"$\omega_u$",
                              r"$\phi$", r"$\theta$", r"$\psi$"), strict=True))  # fmt: skip
UNITS = dict(zip(GROUPS, ("m/s", "m/s²", "rad/s", "deg"), strict=True))
GROUP_OF = {channel: group for group, channels in GROUPS.items() for channel in channels}
TITLES = {"F0": "F0, quasi-static", "F1": "F1, augmented", "F2": "F2, hybrid"}
PERCENTAGES = (
    tuple(range(-50, 51, 2)),
    tuple(range(-50, 51, 5)),
    tuple(range(-60, 61, 10)),
    (-100, -60, -40, -20, 0, 20, 40, 60),
    (-300, -200, -100, -50, 0, 50, 70, 80),
    (-1500, -700, -300, -100, 0, 50, 75, 90, 99),
    (-9900, -900, 0, 90, 99, 99.9),
    (-999900, -9900, 0, 99, 99.99),
)
"""Ticks of an axis of improvements, per cent, from fine to coarse."""
TICK_GAP = {"x": 0.11, "y": 0.08}
"""Smallest distance of two ticks, as a share of the axis: labels along x are wider than they are high."""


class Grouped(NamedTuple):
    """A number for each of `GROUPS` with its interval, shape (4,), and how many of the runs failed."""

    estimate: np.ndarray
    low: np.ndarray
    high: np.ndarray
    failed: int


def factor(channel: str) -> float:
    """What SI is multiplied by before it is shown: angles are shown in degrees."""
    return 180.0 / np.pi if GROUP_OF[channel] == "Euler angles" else 1.0


def axis_label(channel: str) -> str:
    """Symbol and unit."""
    return f"{SYMBOLS[channel]} ({UNITS[GROUP_OF[channel]]})"


def line_of(variant: str, **changes) -> dict:
    """Colour, line and label of a variant, without markers: keywords for ``Axes.plot``."""
    row = VARIANTS[variant]
    return look(row.family) | {"marker": "", "label": row.label} | changes


def dot_of(variant: str, **changes) -> dict:
    """Colour, marker and label of a variant, without a line."""
    return look(VARIANTS[variant].family) | {"linestyle": "", "label": VARIANTS[variant].label} | changes


def in_words(text: str) -> Line2D:
    """An entry of a legend that has no picture."""
    return Line2D([], [], linestyle="none", label=text)


def failure_words(results: Results, variant: str, formulation: str) -> str:
    """How many runs of a variant failed; "" when none did."""
    failed = results.arrays(variant)[f"{formulation}.failed"]
    return f"{VARIANTS[variant].label}: fails in {failed.sum()} of {len(failed)} runs" if failed.any() else ""


def headline(figure: FigureBase, text: str, handles, columns: int = 4) -> None:
    """Title of a figure and below it one legend for all panels."""
    figure.legend(handles=list(handles), loc="outside upper left", ncols=columns, handlelength=3.2, columnspacing=1.6,
                  borderaxespad=0.2, title=text, title_fontsize=9, alignment="left")  # fmt: skip


def panel_title(ax: Axes, left: str, right: str = "") -> None:
    """Title of a panel, what it shows on the left and under what condition on the right."""
    ax.set_title(left, pad=3)
    ax.set_title(right, loc="right", fontsize=8, color="#505050", pad=3)


def plain_ticks(ax: Axes, axis: str, places, labels=None) -> None:
    """Ticks at `places` and nowhere else, with plain numbers or `labels`."""
    chosen = getattr(ax, f"{axis}axis")
    words = dict(zip(places, labels or [f"{place:g}" for place in places], strict=True))
    chosen.set_major_locator(FixedLocator(list(words)))
    chosen.set_minor_locator(NullLocator())
    chosen.set_major_formatter(FuncFormatter(lambda value, _: words[min(words, key=lambda place: abs(place - value))]))


def percent(improvement: float) -> str:
    """An improvement in per cent as its axis writes it."""
    return f"{improvement:g}".replace("-", "−")


def improvement_axis(ax: Axes, axis: str, ratios, margin: float = 1.06) -> None:
    """An axis on which ratios of errors are drawn and improvements are read: logarithmic, better upwards or to the right.

    It holds all `ratios` and no improvement, at which it has a line.
    """
    finite = [np.ravel(values)[np.isfinite(np.ravel(values)) & (np.ravel(values) > 0)] for values in ratios]
    known = np.concatenate([*finite, [1.0, 0.97, 1.03]])
    best, worst = known.min() / margin, known.max() * margin
    getattr(ax, f"set_{axis}scale")("log")
    getattr(ax, f"set_{axis}lim")(worst, best)
    gap = TICK_GAP[axis] * np.log(worst / best)
    inside = [[p for p in ticks if best <= 1 - p / 100 <= worst] for ticks in PERCENTAGES]
    ticks = next((few for few in inside if np.diff(-np.log1p(-np.array(few) / 100)).min(initial=np.inf) >= gap), inside[-1])
    plain_ticks(ax, axis, [1 - p / 100 for p in ticks], [percent(p) for p in ticks])
    (ax.axvline if axis == "x" else ax.axhline)(1.0, color=style.BLACK, linewidth=0.8, zorder=1)


DECADES = ((1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1,))
"""Steps within a decade, from fine to coarse."""


def decades(ax: Axes, axis: str, low: float, high: float) -> None:
    """A logarithmic axis with a few round ticks between positive limits."""
    getattr(ax, f"set_{axis}scale")("log")
    getattr(ax, f"set_{axis}lim")(low, high)
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    inside = [[step * 10.0**power for power in powers for step in steps if low <= step * 10.0**power <= high] for steps in DECADES]
    gap = 1.3 * TICK_GAP[axis] * np.log(high / low)
    ticks = next((few for few in inside if np.diff(np.log(few)).min(initial=np.inf) >= gap), inside[-1][::2])
    plain_ticks(ax, axis, ticks, [f"{tick:g}" if 1e-4 <= tick < 1e5 else f"$10^{{{np.log10(tick):.0f}}}$" for tick in ticks])


@cache
def _multiplicities(seed: int, runs: int, resamples: int) -> np.ndarray:
    return multiplicities(stream(seed, f"{KEY}/bootstrap/0/figures-{runs}"), runs, resamples)


def _counts(results: Results, runs: int) -> np.ndarray:
    """Resampled runs, the same for everything of a figure."""
    return _multiplicities(results.settings.seed, runs, results.settings.sizes["bootstrap"])


def _by_group(values: np.ndarray) -> np.ndarray:
    """Mean over the three channels of each group: (..., 12) to (..., 4)."""
    return np.mean(values.reshape(*values.shape[:-1], len(GROUPS), -1), axis=-1)


def _grouped(results: Results, above: np.ndarray, below: np.ndarray | None) -> np.ndarray:
    """Estimate and ends of the groups' ensemble values, or of their ratios, from squared errors; one run has no interval."""
    logs = np.log(np.mean(above, axis=0) / (1.0 if below is None else np.mean(below, axis=0))) / 2
    estimate = _by_group(logs)
    if len(above) < 2:
        return np.exp([estimate] * 3)
    return np.exp([estimate, *log_ends(above, below, 2, lambda: _counts(results, len(above)), _by_group)])


def group_level(results: Results, study: str, where: Mapping, of: Filter) -> Grouped:
    """Ensemble RMSE of a study's filter over the surviving runs, SI; NaN when none survives."""
    found = sweep_scores(results, study, where, of)
    squares = np.square(found.rmse[~found.failed])
    if not len(squares):
        return Grouped(*np.full((3, len(GROUPS)), np.nan), int(found.failed.sum()))
    return Grouped(*_grouped(results, squares, None), int(found.failed.sum()))


def group_ratio(results: Results, study: str, where: Mapping, numerator: Filter, denominator: Filter) -> Grouped:
    """Ratio of the ensemble RMSE of two of a study's filters; a failed run is a loss of the filter that failed."""
    above, below = (sweep_scores(results, study, where, side) for side in (numerator, denominator))
    return ratio_of(results, above, below)


def ratio_of(results: Results, above: Scores, below: Scores) -> Grouped:
    """`group_ratio` of scores; its ``failed`` are the runs that failed in the numerator; NaN when no run survives in both."""
    failed = int(above.failed.sum())
    if (above.failed | below.failed).all():
        return Grouped(*np.full((3, len(GROUPS)), np.nan), failed)
    errors = with_stand_ins(above.rmse, below.rmse, above.failed, below.failed, 2)
    return Grouped(*_grouped(results, errors[0] ** 2, errors[1] ** 2), failed)
