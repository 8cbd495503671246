"""The factorial of filter, self-tuning and gate: errors of its cells, and what each part contributes."""

from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Patch

from robins.evaluate.geometric import mean_of_logs
from robins.evaluate.intervals import Interval
from robins.papers.ghouneem2024.comparisons import (
    HEADLINE,
    PARTS,
    attribution,
    cell,
    mean_of,
    resampling,
    shapley,
    values,
    variant,
)
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.palette import look
from robins.papers.ghouneem2024.panels import (
    FARTHEST,
    LABELS,
    NAMES,
    NEW_LABEL,
    PLACES,
    SMALL,
    UNITS,
    Mark,
    decades,
    draw_marks,
    family_of,
    headline,
    key,
    name_rows,
    panel_title,
    published_key,
    published_ratio,
    published_rmse,
    ratio_axis,
    reach,
    remark,
)
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import BASELINES, CONTROL, FACTORIAL, VARIANTS, variant_name
from robins.papers.protocol import Results
from robins.publish import style

NEEDS = tuple(FACTORIAL)
MEASURES = ("horizontal", "height")
CELLS = {"none": "neither", "gate": "gate", "st": "self-tuning", "st-gate": "self-tuning\n+ gate"}
SHIFTS = dict(zip(FILTERS, (-0.26, -0.09, 0.08, 0.25), strict=True))
PUBLISHED_ROWS = {"EKF": ("none", -0.42), "New-Algorithm": ("st-gate", 0.42)}


def cell_marks(results: Results, place: str, measure: str) -> list[Mark]:
    """Geometric means of the sixteen cells."""
    return [
        Mark(row + shift, mean_of(results, variant(variant_name(name, part), place), measure), family_of(variant_name(name, part)))
        for row, part in enumerate(CELLS)
        for name, shift in SHIFTS.items()
    ]


def draw_factorial(results: Results) -> Drawing:
    """Horizontal and altitude errors in every cell, both trajectories."""
    figure = Drawing(figsize=(style.WIDTH, 6.4))
    for row, measure in zip(figure.subplots(2, 2, sharey=True), MEASURES, strict=True):
        for ax, place in zip(row, TRAJECTORIES, strict=True):
            printed = [published_rmse(results, place, measure, method) for method in PUBLISHED_ROWS]
            marks = cell_marks(results, place, measure)
            decades(ax, "x", *reach(marks, printed))
            name_rows(ax, list(CELLS.values()))
            rows = [list(CELLS).index(part) + shift for part, shift in PUBLISHED_ROWS.values()]
            style.published_marker(ax, printed, rows).set(clip_on=False)
            draw_marks(ax, marks)
            panel_title(ax, PLACES[place], f"published New/EKF: {published_ratio(results, place, measure):.2f}")
            ax.set_xlabel(f"RMSE, {NAMES[measure]} ({UNITS[measure]})")
    handles = [key(name, VARIANTS[name].label) for name in FILTERS] + [key("new", NEW_LABEL), published_key()]
    headline(figure, f"Filter × self-tuning × gate, settings of {HEADLINE.upper()}'s tuning runs", handles)
    return figure


def between(results: Results, old: str, new: str, place: str, measure: str, lost: np.ndarray) -> dict[frozenset, np.ndarray]:
    """Logarithms of a measure in the eight cells between two filters, by the set of parts that are new, of runs not `lost`."""
    found = {}
    for size in range(len(PARTS) + 1):
        for parts in combinations(PARTS, size):
            name = cell(new if "filter" in parts else old, "self-tuning" in parts, "gate" in parts)
            found[frozenset(parts)] = np.log(values(results, variant(name, place), measure)[0][~lost])
    return found


def split(results: Results, baseline: str, place: str, measure: str) -> dict[str, Interval]:
    """The filter's Shapley value in two: from the baseline to the EKF that has the UKF's model, and from there to the UKF.

    Over the runs that survive in every cell of all three filters; the two add up to the filter's value over the same runs.
    """
    lost = np.any([values(results, variant(variant_name(name, part), place), measure)[1]
                   for name in (baseline, CONTROL, "ukf") for part in CELLS], axis=0)  # fmt: skip
    found = {}
    for what, old, new in (("model", baseline, CONTROL), ("unscented transform", CONTROL, "ukf")):
        effect = shapley(between(results, old, new, place, measure, lost), "filter")
        generator = resampling(results, f"split-{baseline}-{place}-{measure}-{what}")
        ends = mean_of_logs(effect, generator, results.settings.sizes["bootstrap"])
        found[what] = Interval(float(effect.mean()) if effect.size else float("nan"), *ends, lost.size)
    return found


BARS = ("filter", "model", "unscented transform", "self-tuning", "gate", "all three")
BAR_NAMES = dict(zip(BARS, ("filter", "of it: model", "of it: unscented\ntransform", "self-tuning", "gate", "all three"), strict=True))
HEIGHT = 0.34
SHORT = 0.005
"""Logarithm of a factor below which the bar is too short to be seen."""
OUTLINED = {"hatch": "////", "facecolor": "white"}
"""Bars from the second baseline; the first's are filled."""


def contributions(results: Results, baseline: str, place: str, measure: str) -> dict[str, Interval]:
    """What each of `BARS` adds to the logarithm of a measure."""
    whole = attribution(results, baseline, place, measure=measure)
    return whole.parts | split(results, baseline, place, measure) | {"all three": whole.total}


def draw_attribution(results: Results) -> Drawing:
    """Shapley values as factors on the error, from either baseline, both trajectories."""
    figure = Drawing(figsize=(style.WIDTH, 6.6))
    for row, measure in zip(figure.subplots(2, 2, sharey=True), MEASURES, strict=True):
        for ax, place in zip(row, TRAJECTORIES, strict=True):
            printed = published_ratio(results, place, measure)
            draw_bars(ax, {name: contributions(results, name, place, measure) for name in BASELINES}, printed)
            style.published_marker(ax, [printed], [len(BARS) - 1])
            panel_title(ax, PLACES[place], NAMES[measure] + left_out(results, place, measure))
    figure.supxlabel("factor on the RMSE (1); left of 1 the part makes the error smaller", fontsize=LABELS)
    handles = [Patch(label=f"from {VARIANTS[name].label}", **bar_look(name)) for name in BASELINES]
    title = f"What each part contributes to the new method (Shapley values), settings of {HEADLINE.upper()}'s tuning runs"
    headline(figure, title, [*handles, published_key("published New/EKF (one run)")])
    return figure


def left_out(results: Results, place: str, measure: str) -> str:
    """How many runs fail in a cell and are left out, in words; nothing when none does."""
    failed = max(attribution(results, name, place, measure=measure).failed for name in BASELINES)
    return f" · {failed} of {results.settings.sizes['runs']} fail" if failed else ""


def bar_look(baseline: str) -> dict:
    """Fill and edge of the bars from a baseline."""
    color = look(baseline)["color"]
    filled = {"facecolor": color} if baseline == BASELINES[0] else OUTLINED
    return {"edgecolor": color, "linewidth": 0.8} | filled


def draw_bars(ax: Axes, found: dict[str, dict[str, Interval]], printed: float) -> None:
    """Bars from 1 with their intervals, a number where a bar is too short to be seen; the axis holds the ratio `printed`."""
    effects = [interval for each in found.values() for interval in each.values() if np.isfinite(interval.estimate)]
    widest = np.log(FARTHEST)
    ends = [end for one in effects for end in (max(one.low, one.estimate - widest), min(one.high, one.estimate + widest))]
    ends.append(np.log(printed))
    ratio_axis(ax, (np.exp(min(ends)) / 1.15, np.exp(max(ends)) * 1.15))
    name_rows(ax, list(BAR_NAMES.values()))
    ax.axhline(len(BARS) - 1.5, color=style.BLACK, linewidth=0.9)
    for (baseline, each), shift in zip(found.items(), (-HEIGHT / 2, HEIGHT / 2), strict=True):
        for row, part in enumerate(BARS):
            interval = each[part]
            if not np.isfinite(interval.estimate):
                remark(ax, row + shift, "no run survives")
                continue
            ax.barh(row + shift, np.expm1(interval.estimate), HEIGHT * 0.9, left=1.0, zorder=2, **bar_look(baseline))
            if abs(interval.estimate) < SHORT:
                ax.annotate(
                    f"×{np.exp(interval.estimate):.5f}", (1.0, row + shift), (5, 0), textcoords="offset points", fontsize=SMALL, va="center"
                )
            low, high = np.clip(np.exp([interval.low, interval.high]), *ax.get_xlim())
            ax.hlines(row + shift, low, high, color=style.BLACK, linewidth=1.2, zorder=3)
