"""Forests of the headline: the new method over both readings of the EKF by channel, and what leakage is worth."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Patch

from robins.papers.ghouneem2024.comparisons import HEADLINE, ratio_of, variant, where
from robins.papers.ghouneem2024.in_sample import COMPARED
from robins.papers.ghouneem2024.panels import (
    LABELS,
    NAMES,
    PLACES,
    Mark,
    draw_marks,
    headline,
    key,
    name_rows,
    panel_title,
    published_key,
    published_ratio,
    ratio_axis,
    reach,
)
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import CELLS
from robins.papers.ghouneem2024.variants import BASELINES, NEW, VARIANTS, variant_name
from robins.papers.protocol import Results
from robins.publish import style

ROWS = (*CHANNELS, "horizontal")
OTHER = next(place for place in TRAJECTORIES if place != HEADLINE)
SAME_SIZE = 1.5
"""Factor within which the claims' rules call a ratio of the published size."""
SHIFTS = {HEADLINE: (-0.16, 0.01), OTHER: (0.2, 0.37)}
"""Where a row has the marks of both baselines, by whose settings the method runs with."""
PUBLISHED_AT = -0.33
CHANNEL_NEEDS = (NEW, *BASELINES)


def channel_marks(results: Results, place: str) -> list[Mark]:
    """Ratios of the new method to both readings of the EKF, with the settings of either trajectory's tuning runs."""
    return [
        Mark(row + shift, ratio_of(results, variant(NEW, place, frozen), variant(name, place), channel), name, frozen != HEADLINE)
        for row, channel in enumerate(ROWS)
        for frozen, shifts in SHIFTS.items()
        for name, shift in zip(BASELINES, shifts, strict=True)
    ]


def draw_channels(results: Results) -> Drawing:
    """New over EKF by channel on both trajectories, against both readings of the EKF, beside the published ratios."""
    figure = Drawing(figsize=(style.WIDTH, 6.9))
    marks = {place: channel_marks(results, place) for place in TRAJECTORIES}
    printed = {place: [published_ratio(results, place, channel) for channel in ROWS] for place in TRAJECTORIES}
    limits = reach(sum(marks.values(), []), [ratio for ratios in printed.values() for ratio in ratios])
    for ax, place in zip(figure.subplots(1, 2, sharey=True), TRAJECTORIES, strict=True):
        ratio_axis(ax, limits)
        name_rows(ax, [NAMES[channel] for channel in ROWS])
        ax.axhline(len(CHANNELS) - 0.5, color=style.BLACK, linewidth=0.9)
        mark_published(ax, printed[place])
        draw_marks(ax, marks[place])
        panel_title(ax, PLACES[place], f"{results.settings.sizes['runs']} runs")
    figure.supxlabel("← new method better      ratio of RMSE, New over EKF (1)      EKF better →", fontsize=LABELS)
    against = [key(name, f"against {VARIANTS[name].label}") for name in BASELINES]
    settings = [
        key(BASELINES[0], f"settings of {place.upper()}'s tuning runs", hollow) for place, hollow in ((HEADLINE, False), (OTHER, True))
    ]
    band = Patch(color=style.BLACK, alpha=0.09, linewidth=0, label=f"within a factor {SAME_SIZE:g} of it")
    handles = [*against, *settings, published_key(), band]
    headline(figure, "The paper's comparison: RMSE of the new method over that of the EKF, out of sample", handles)
    return figure


def mark_published(ax: Axes, ratios: list[float]) -> None:
    """Open diamonds at the published ratios, and behind each row the range that counts as the same size."""
    for row, ratio in enumerate(ratios):
        ends = [ratio / SAME_SIZE, ratio * SAME_SIZE]
        ax.fill_betweenx([row - 0.46, row + 0.46], *ends, color=style.BLACK, alpha=0.09, linewidth=0, zorder=0)
    style.published_marker(ax, ratios, np.arange(len(ratios)) + PUBLISHED_AT)


CELL_NAMES = {"none": "neither", "gate": "gate", "st": "self-tuning", "st-gate": "self-tuning + gate"}
LEAKAGE_NEEDS = (
    "in-sample",
    *(variant_name(name, cell) for name in COMPARED for cell in ("none", *CELLS)),
)
UNTUNED_LOOK = {"marker": "x", "color": style.BLACK}


def leakage_marks(results: Results, place: str) -> list[Mark]:
    """Errors out of sample, and of the data sheet's filter without a gate, over those with settings chosen in the evaluated run."""
    found = []
    for row, (name, cell) in enumerate((name, cell) for name in COMPARED for cell in CELLS):
        inside = where("in-sample", trajectory=place, filter=name, cell=cell)
        for frozen, hollow, shift in ((place, False, -0.22), (other_than(place), True, 0.0)):
            found.append(Mark(row + shift, ratio_of(results, variant(variant_name(name, cell), place, frozen), inside, "horizontal"),
                              name, hollow))  # fmt: skip
        found.append(Mark(row + 0.22, ratio_of(results, variant(name, place), inside, "horizontal"), name, True, changes=UNTUNED_LOOK))
    return found


def other_than(place: str) -> str:
    """The other trajectory."""
    return next(name for name in TRAJECTORIES if name != place)


def draw_leakage(results: Results) -> Drawing:
    """Out-of-sample errors over in-sample errors, by filter and tuned cell."""
    figure = Drawing(figsize=(style.WIDTH, 4.6))
    marks = {place: leakage_marks(results, place) for place in TRAJECTORIES}
    limits = reach(sum(marks.values(), []))
    labels = [f"{VARIANTS[name].label}\n{CELL_NAMES[cell]}" for name in COMPARED for cell in CELLS]
    for ax, place in zip(figure.subplots(1, 2, sharey=True), TRAJECTORIES, strict=True):
        ratio_axis(ax, limits)
        name_rows(ax, labels)
        ax.axhline(len(CELLS) - 0.5, color=style.BLACK, linewidth=0.9)
        draw_marks(ax, marks[place])
        panel_title(ax, PLACES[place], f"{results.settings.sizes['in_sample_runs']} runs")
    figure.supxlabel("horizontal RMSE over that with settings chosen in the evaluated run (1)", fontsize=LABELS)
    handles = [
        key("truth", "frozen on other runs of this trajectory", marker="o"),
        key("truth", "frozen on the other trajectory", True, marker="o"),
        key("truth", "data sheet's variances, no gate", **UNTUNED_LOOK),
    ]
    headline(figure, "What it is worth to choose the settings with the truth of the evaluated run", handles, columns=2)
    return figure
