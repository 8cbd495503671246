"""The gate: what it rejects in the median run, its longest run of rejections, and its worth by the cause of the bad fixes."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D

from robins.papers.ghouneem2024.comparisons import HEADLINE, ratio_of, values, variant, where
from robins.papers.ghouneem2024.figures_traces import SHADE, median_words, shade
from robins.papers.ghouneem2024.filters import FILTERS, PATIENCE
from robins.papers.ghouneem2024.gps import MISLEADING, MULTIPATH
from robins.papers.ghouneem2024.palette import look
from robins.papers.ghouneem2024.panels import (
    LABELS,
    PLACES,
    Mark,
    draw_marks,
    family_of,
    headline,
    key,
    label_of,
    name_rows,
    panel_title,
    plain_ticks,
    ratio_axis,
    reach,
    remark,
)
from robins.papers.ghouneem2024.studies import CAUSES
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import NEW, VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

GATED = (*(f"{name}-gate" for name in FILTERS), NEW, "ekf-f-nis", "ekf-f-nis-recovery")
NEEDS = ("traces", *GATED)
KINDS = {"clean": 0, "multipath": MULTIPATH, "misleading": MISLEADING}
ACCEPTED = {"linestyle": "none", "marker": "|", "markersize": 7, "markeredgewidth": 0.5, "color": style.GREY}
REJECTED = {"linestyle": "none", "marker": "x", "markersize": 5, "markeredgewidth": 1.0, "color": look("new")["color"]}
RUN_TICKS = (0, 1, 3, 10, 30, 100, 300, 1000)
SPACING = {True: -0.2, False: 0.2}
"""Where a row has the runs with the headline's settings (true) and those with the other trajectory's."""


def kind_of(cause: np.ndarray) -> np.ndarray:
    """Row of `KINDS` that each fix belongs to; one that is misleading and in a burst is misleading."""
    return np.where(cause & MISLEADING, 2, np.where(cause & MULTIPATH, 1, 0))


def draw_gate(results: Results) -> Drawing:
    """Rejections in the median runs over time, and the longest run of rejections in every run."""
    figure = Drawing(figsize=(style.WIDTH, 7.2))
    upper, lower = figure.subfigures(2, 1, height_ratios=(1, 1.15))
    for ax, place in zip(upper.subplots(2, 1), TRAJECTORIES, strict=True):
        draw_timeline(ax, results, place)
    marks = [Line2D([], [], label="fix accepted", **ACCEPTED), Line2D([], [], label="fix rejected", **REJECTED), SHADE]
    headline(upper, "What the new method rejects, by what is wrong with the fix (numbers: rejected of all)", marks)
    for ax, place in zip(lower.subplots(1, 2, sharey=True), TRAJECTORIES, strict=True):
        draw_longest(ax, results, place)
    lower.supxlabel("longest run of consecutive rejections (fixes)", fontsize=LABELS)
    settings = [key("truth", f"settings of {place.upper()}'s tuning runs", place != HEADLINE, marker="o") for place in TRAJECTORIES]
    median = Line2D([], [], color=style.BLACK, linestyle="none", marker="|", markersize=9, markeredgewidth=1.6, label="median of the runs")
    headline(lower, "Does the gate lock out? Every run is a mark", [*settings, median])
    return figure


def draw_timeline(ax: Axes, results: Results, place: str) -> None:
    """Fixes over time by what is wrong with them, those that the new method rejects marked."""
    arrays = results.arrays("traces")
    time, rejected, rows = arrays[f"{place}.fix_time"], arrays[f"{place}.{NEW}.rejected"], kind_of(arrays[f"{place}.fix_cause"])
    ax.plot(time[~rejected], rows[~rejected], **ACCEPTED)
    ax.plot(time[rejected], rows[rejected], **REJECTED)
    counts = [f"{kind}\n{rejected[rows == row].sum()} of {(rows == row).sum()}" for row, kind in enumerate(KINDS)]
    name_rows(ax, counts)
    shade([ax], arrays, place)
    ax.set(xlabel="time (s)", xlim=(0, arrays[f"{place}.time"][-1]))
    panel_title(ax, PLACES[place], median_words(results, place))


def settings_of(name: str) -> tuple[str, ...]:
    """Whose settings a variant runs with; one place where nothing is tuned."""
    return TRAJECTORIES if VARIANTS[name].composition.get("cell", "none") != "none" else (HEADLINE,)


def draw_longest(ax: Axes, results: Results, place: str) -> None:
    """The longest run of rejections of every run, by variant and settings, with the median."""
    ax.set_xscale("symlog", linthresh=1.0, linscale=0.4)
    for row, name in enumerate(GATED):
        chosen, lost = settings_of(name), 0
        for frozen in chosen:
            lengths, failed = values(results, variant(name, place, frozen), "longest_rejection")
            lengths = lengths[~failed]
            lost += int(failed.sum())
            y = row + (SPACING[frozen == HEADLINE] if len(chosen) > 1 else 0.0)
            color = look(family_of(name))["color"]
            face = color if frozen == HEADLINE else "white"
            ax.plot(lengths, np.full(len(lengths), y), linestyle="none", marker="o", markersize=3.4, markeredgewidth=0.7, color=color,
                    markerfacecolor=face, alpha=0.75)  # fmt: skip
            if len(lengths):
                ax.plot([np.median(lengths)], [y], color=style.BLACK, linestyle="none", marker="|", markersize=10, markeredgewidth=1.6)
        if lost:
            remark(ax, row, f"{lost} fail")
    ax.axvline(PATIENCE, color=style.BLACK, linewidth=0.7, linestyle=(0, (2, 2)), zorder=1)
    name_rows(ax, [label_of(name).replace("New: ", "New:\n").replace(", NIS", ",\nNIS") for name in GATED])
    ax.set_xlim(-0.3, 2000)
    plain_ticks(ax, "x", RUN_TICKS)
    panel_title(ax, PLACES[place], f"{results.settings.sizes['runs']} runs")


MULTIPLES = (0.5, 2.0, 8.0)
CAUSE_WORDS = {"misleading": "misleading fixes", "multipath": "multipath", "outages": "outages"}
NIS_GATES = {"nis": "NIS", "nis-recovery": "NIS,\nrecovery"}
SHIFTS = dict(zip(FILTERS, (-0.27, -0.09, 0.09, 0.27), strict=True))
CAUSE_NEEDS = ("cause",)


def cause_marks(results: Results, place: str, cause: str) -> list[Mark]:
    """Horizontal error with a gate over that without: (24) by filter and multiple, and the two NIS gates of the physical filter."""

    def at(name: str, gate: str, multiple: float):
        return where("cause", trajectory=place, cause=cause, filter=name, gate=gate, multiple=multiple)

    found = [
        Mark(row + shift, ratio_of(results, at(name, "integrity", multiple), at(name, "integrity", np.inf), "horizontal"), name)
        for row, multiple in enumerate(MULTIPLES)
        for name, shift in SHIFTS.items()
    ]
    plain = at("physical", "none", np.inf)
    controls = [ratio_of(results, at("physical", gate, np.inf), plain, "horizontal") for gate in NIS_GATES]
    return found + [Mark(len(MULTIPLES) + row, ratio, "physical") for row, ratio in enumerate(controls)]


def draw_causes(results: Results) -> Drawing:
    """What a gate changes when only one thing goes wrong with the satellites."""
    figure = Drawing(figsize=(style.WIDTH, 7.4))
    labels = [f"(24), ×{multiple:g}" for multiple in MULTIPLES] + list(NIS_GATES.values())
    for row, cause in zip(figure.subplots(len(CAUSES), 2, sharex=True, sharey=True), CAUSES, strict=True):
        for ax, place in zip(row, TRAJECTORIES, strict=True):
            name_rows(ax, labels)
            panel_title(ax, f"{PLACES[place]}: only {CAUSE_WORDS[cause]}")
    marks = {(place, cause): cause_marks(results, place, cause) for place in TRAJECTORIES for cause in CAUSES}
    limits = reach(sum(marks.values(), []))
    for ax, (cause, place) in zip(figure.axes, ((cause, place) for cause in CAUSES for place in TRAJECTORIES), strict=True):
        ratio_axis(ax, limits)
        draw_marks(ax, marks[place, cause])
    figure.supxlabel("horizontal RMSE with the gate over that without (1); left of 1 the gate helps", fontsize=LABELS)
    handles = [key(name, VARIANTS[name].label) for name in FILTERS] + [key("physical", "EKF, physical Q (NIS gates)")]
    headline(figure, f"The gate by cause of the bad fixes, {results.settings.sizes['side_runs']} runs", handles)
    return figure
