"""What the wing's figures share: names and units of the channels, published numbers, axes, marks with intervals.

A mark is a value with its interval on a row of a forest; a filter's colour and marker are the same everywhere.
"""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from robins.evaluate.geometric import GeometricMean, GeometricRatio
from robins.evaluate.published import published_value
from robins.papers.ghouneem2024.palette import look
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import NEW, VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

NAMES = dict(zip((*CHANNELS, "horizontal"), ("azimuth", "east velocity", "north velocity", "up velocity", "latitude", "longitude",
                                             "altitude", "horizontal position"), strict=True))  # fmt: skip
UNITS = dict(zip((*CHANNELS, "horizontal"), ("deg", "m/s", "m/s", "m/s", "m", "m", "m", "m"), strict=True))
PLACES = {"t1": "T1, suburban", "t2": "T2, dense urban"}
NEW_LABEL = "New: UKF + self-tuning + gate"
SMALL, LINE, LABELS = 8, "#D9D9D9", 8.5
"""Points of remarks, colour of lines between rows, points of labels that panels share."""
FARTHEST = 10.0
"""How far, as a factor, an interval may widen an axis."""


class Spread(NamedTuple):
    """Median of a measure over the runs, and where 5 % to 95 % of them lie; `failed` of `n` runs have none."""

    estimate: float
    low: float
    high: float
    n: int
    failed: int


class Mark(NamedTuple):
    """A value with its interval: where, what, in which look.

    Attributes
    ----------
    row : float
        Place on the axis across.
    found : GeometricMean, GeometricRatio or Spread
    family : str
        Of `robins.papers.ghouneem2024.palette`.
    hollow : bool
        An open marker and a thinner line.
    factor : float
        From SI to what the axis shows.
    changes : mapping
        Keywords that replace those of the look.
    """

    row: float
    found: GeometricMean | GeometricRatio | Spread
    family: str
    hollow: bool = False
    factor: float = 1.0
    changes: Mapping = MappingProxyType({})


def factor(channel: str) -> float:
    """What SI is multiplied by before it is shown: angles are shown in degrees."""
    return float(np.degrees(1.0)) if UNITS[channel] == "deg" else 1.0


def family_of(variant: str) -> str:
    """The look of a variant; the paper's method has its own."""
    return "new" if variant == NEW else VARIANTS[variant].family


def label_of(variant: str) -> str:
    """What readers call a variant."""
    return NEW_LABEL if variant == NEW else VARIANTS[variant].label


def published_rmse(results: Results, place: str, channel: str, method: str) -> float:
    """What Table II or III prints, in its unit; `method` is "EKF" or "New-Algorithm". The horizontal is that of latitude and longitude."""
    if channel == "horizontal":
        return float(np.hypot(*(published_rmse(results, place, one, method) for one in ("north", "east"))))
    quantity = f"{place.upper()} {NAMES[channel].capitalize()} RMSE, {method}"
    return published_value(results.published, f"C{TRAJECTORIES.index(place) + 1}", quantity)


def published_ratio(results: Results, place: str, channel: str) -> float:
    """The published RMSE of the new method over that of the EKF."""
    return published_rmse(results, place, channel, "New-Algorithm") / published_rmse(results, place, channel, "EKF")


def spread_of(values: np.ndarray, failed: np.ndarray) -> Spread:
    """Of the runs that did not fail; NaN when there is none. Infinite values count as such."""
    kept = values[~failed & ~np.isnan(values)]
    low, middle, high = np.quantile(kept, (0.05, 0.5, 0.95), method="inverted_cdf") if kept.size else np.full(3, np.nan)
    return Spread(float(middle), float(low), float(high), len(values), len(values) - kept.size)


def lost(found) -> int:
    """Runs that failed, in a ratio those in either filter."""
    return found.n - found.survivors if isinstance(found, GeometricRatio) else found.failed


def reach(marks: Iterable[Mark], more: Iterable[float] = (), margin: float = 1.2) -> tuple[float, float]:
    """Limits of a logarithmic axis that holds the marks, their intervals where these are not too wide, and the values `more`."""
    known = [value for value in more if np.isfinite(value) and value > 0.0]
    for mark in marks:
        value = mark.found.estimate * mark.factor
        if np.isfinite(value) and value > 0.0:
            known += [value, max(mark.found.low * mark.factor, value / FARTHEST), min(mark.found.high * mark.factor, value * FARTHEST)]
    known = known or [1.0]
    return min(known) / margin, max(known) * margin


def draw_marks(ax: Axes, marks: Sequence[Mark]) -> None:
    """Marks on rows of a forest, and in words how many runs failed; the limits of a logarithmic x axis stand already."""
    for mark in marks:
        low, value, high = (mark.factor * end for end in (mark.found.low, mark.found.estimate, mark.found.high))
        kept = look(mark.family)
        if np.isfinite(value):
            ends = np.clip([low, high], *ax.get_xlim())
            ax.hlines(mark.row, *ends, color=mark.changes.get("color", kept["color"]), linewidth=0.9 if mark.hollow else 1.7, zorder=3)
            ax.plot([value], [mark.row], **dot(mark.family, mark.hollow, **mark.changes))
        if lost(mark.found):
            words = f"{lost(mark.found)} of {mark.found.n} fail" if np.isfinite(value) else f"all {mark.found.n} fail"
            remark(ax, mark.row, words)


def remark(ax: Axes, row: float, words: str) -> None:
    """Words at the right end of a row, over whatever is drawn there."""
    paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.4}
    ax.text(0.99, row, words, transform=ax.get_yaxis_transform(), fontsize=SMALL, ha="right", va="center", bbox=paper, zorder=6)


def dot(family: str, hollow: bool = False, **changes) -> dict:
    """Marker of a family, without a line: keywords for ``Axes.plot``."""
    kept = look(family)
    face = {"markerfacecolor": "white"} if hollow else {}
    return {"color": kept["color"], "marker": kept["marker"] or "o", "linestyle": "", "markersize": 5.5, "zorder": 4} | face | changes


def key(family: str, label: str, hollow: bool = False, **changes) -> Line2D:
    """A legend's entry for marks."""
    return Line2D([], [], label=label, **dot(family, hollow, **changes))


def published_key(label: str = "published (one run)") -> Line2D:
    """A legend's entry for published numbers."""
    return style.published_marker(Figure().subplots(), [], [], label=label)


def headline(figure: FigureBase, text: str, handles: Iterable, columns: int = 3) -> None:
    """Title of a figure and below it one legend for all panels."""
    figure.legend(handles=list(handles), loc="outside upper left", ncols=columns, handlelength=2.6, columnspacing=1.4,
                  borderaxespad=0.2, title=text, title_fontsize=9, alignment="left")  # fmt: skip


def panel_title(ax: Axes, left: str, right: str = "") -> None:
    """Title of a panel, and a remark at its right end."""
    ax.set_title(left, pad=3)
    ax.set_title(right, loc="right", fontsize=SMALL, color="#505050", pad=3)


def name_rows(ax: Axes, labels: Sequence[str], every: int = 1) -> None:
    """Names of the rows 0, 1, ... from top to bottom, with a line after every `every` of them."""
    ax.set_yticks(range(len(labels)), labels)
    ax.set_ylim(len(labels) - 0.5, -0.5)
    ax.tick_params(axis="y", length=0)
    ax.grid(False, axis="y")
    for row in np.arange(every, len(labels), every) - 0.5:
        ax.axhline(row, color=LINE, linewidth=0.7, zorder=0.5)


def plain_ticks(ax: Axes, axis: str, places, labels=None) -> None:
    """Ticks at `places` and nowhere else, with plain numbers or `labels`."""
    chosen = getattr(ax, f"{axis}axis")
    words = dict(zip(places, labels or [f"{place:g}" for place in places], strict=True))
    chosen.set_major_locator(FixedLocator(list(words)))
    chosen.set_minor_locator(NullLocator())
    chosen.set_major_formatter(FuncFormatter(lambda value, _: words[min(words, key=lambda place: abs(place - value))]))


STEPS = ((1, 1.1, 1.2, 1.5, 2, 3, 5, 7), (1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,))
"""Steps within a decade, from fine to coarse."""
TICK_GAP = {"x": 0.13, "y": 0.1}
"""Smallest distance of two ticks, as a share of the axis: labels along x are wider than they are high."""


def decades(ax: Axes, axis: str, low: float, high: float) -> None:
    """A logarithmic axis with a few round ticks between positive limits."""
    getattr(ax, f"set_{axis}scale")("log")
    getattr(ax, f"set_{axis}lim")(low, high)
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    inside = [[step * 10.0**power for power in powers for step in steps if low <= step * 10.0**power <= high] for steps in STEPS]
    gap = TICK_GAP[axis] * np.log(high / low)
    ticks = next((few for few in inside if np.diff(np.log(few)).min(initial=np.inf) >= gap), inside[-1][::2])
    plain_ticks(ax, axis, ticks, [tick_words(tick) for tick in ticks])


def tick_words(tick: float) -> str:
    """A plain number, or a power of ten (times something) where that is shorter."""
    power = int(np.floor(np.log10(tick) + 1e-9))
    if -4 <= power < 4:
        return f"{tick:g}"
    step = tick / 10.0**power
    return f"$10^{{{power}}}$" if abs(step - 1.0) < 1e-6 else f"${step:g}·10^{{{power}}}$"


def ratio_axis(ax: Axes, limits: tuple[float, float]) -> None:
    """A logarithmic x axis of ratios that holds 1, at which it has a line."""
    decades(ax, "x", min(limits[0], 0.85), max(limits[1], 1.18))
    ax.axvline(1.0, color=style.BLACK, linewidth=0.8, zorder=1)
