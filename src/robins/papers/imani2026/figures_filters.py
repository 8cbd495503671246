"""Comparisons at the headline condition: the paper's claims as a forest, consistency, and drift of position."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from robins.evaluate.consistency import chi_square_band
from robins.papers.imani2026.comparisons import GROUPS, PAIR, improvements
from robins.papers.imani2026.drive import CHANNELS, DURATION
from robins.papers.imani2026.formulations import FORMULATIONS
from robins.papers.imani2026.palette import look
from robins.papers.imani2026.panels import (
    SYMBOLS,
    TITLES,
    decades,
    headline,
    improvement_axis,
    line_of,
    panel_title,
)
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

PUBLISHED = {"velocity": "C1", "acceleration": "C2", "angular rate": "C3"}
"""Claims that give a number."""
FOREST_METRICS = {"rmse": ("RMSE", "full"), "mean": ("|mean error|", "none"), "drift": ("|final drift|", "bottom")}
"""Words and fill of the marker."""
SHIFT = 0.26
WORST_SHOWN = 12.0
"""Ratio at which the forest's axis ends; what lies beyond is a triangle at its edge."""


def published_range(results: Results, claim_id: str) -> tuple[float, ...]:
    """The published improvements of a claim, per cent: lower and upper end, or the upper end alone."""
    row = results.published[results.published["claim_id"] == claim_id].iloc[0]
    return tuple(float(row[name]) for name in ("value", "value_high") if row[name])


def draw_forest(results: Results, published: bool) -> Drawing:
    """Improvement of the MKMC-EKF over the CI-RKF by channel, metric and formulation; `published` widens it to what the paper says."""
    figure = Drawing(figsize=(style.WIDTH, 6.6))
    axes = figure.subplots(1, len(FORMULATIONS), sharey=True)
    for ax, name in zip(axes, FORMULATIONS, strict=True):
        drawn = mark_published(ax, results) if published else []
        drawn += [draw_metric(ax, results, name, metric, place) for place, metric in enumerate(FOREST_METRICS)]
        improvement_axis(ax, "x", [np.minimum(np.ravel(values), WORST_SHOWN) for values in drawn], 1.5 if published else 1.02)
        edge_triangles(ax, results, name)
        panel_title(ax, TITLES[name])
        ax.grid(False, axis="y")
        for row in np.arange(len(GROUPS) - 1) * 3 + 2.5:
            ax.axhline(row, color="#D9D9D9", linewidth=0.7)
        ax.tick_params(axis="y", length=0)
    axes[0].set_yticks(range(len(CHANNELS)), [SYMBOLS[channel] for channel in CHANNELS])
    axes[0].set_ylim(len(CHANNELS) - 0.4, -0.6)
    figure.supxlabel("improvement of the MKMC-EKF over the CI-RKF (%)", fontsize=8.5)
    look_mkmc = look(VARIANTS[PAIR[0]].family) | {"linestyle": "", "marker": "o"}
    marks = [
        Line2D([], [], **look_mkmc, fillstyle=fill, markerfacecoloralt="white", label=words) for words, fill in FOREST_METRICS.values()
    ]
    if published:
        marks.append(style.published_marker(Drawing().subplots(), [], [], label="published (RMSE, one run)"))
        marks.append(Patch(color=style.BLACK, alpha=0.09, linewidth=0, label="published range"))
    headline(figure, "The paper's comparison, both filters tuned, headline condition", marks, columns=3)
    return figure


def draw_metric(ax: Axes, results: Results, formulation: str, metric: str, place: int) -> np.ndarray:
    """One metric's ratios with their intervals in all channels; returns what has to fit on the axis."""
    found = improvements(results, *PAIR, formulation, "truth", metric)
    ratio, worse, better = 1 - found.estimate, 1 - found.low, 1 - found.high
    rows = np.arange(len(CHANNELS)) + SHIFT * (place - 1)
    shown = np.isfinite(ratio)
    marker = style.interval(ax, rows[shown], ratio[shown], better[shown], np.minimum(worse, 1e6)[shown], VARIANTS[PAIR[0]].family)
    marker.set(marker="o", markersize=4, fillstyle=FOREST_METRICS[metric][1], markerfacecoloralt="white")
    return np.array([ratio, np.minimum(worse, WORST_SHOWN), better])


def edge_triangles(ax: Axes, results: Results, formulation: str) -> None:
    """A triangle at the left edge for what is worse than the axis shows."""
    worst = ax.get_xlim()[0]
    for place, metric in enumerate(FOREST_METRICS):
        found = improvements(results, *PAIR, formulation, "truth", metric)
        beyond = np.flatnonzero(1 - found.estimate > worst)
        if len(beyond):
            color = look(VARIANTS[PAIR[0]].family)["color"]
            ax.plot(np.full(len(beyond), worst), beyond + SHIFT * (place - 1), linestyle="none", marker="<", color=color, clip_on=False)


def mark_published(ax: Axes, results: Results) -> list[float]:
    """Open diamonds at published numbers, on the rows of the channels they are about, and the range between two; returns the ratios."""
    drawn = []
    for group, claim_id in PUBLISHED.items():
        ratios = [1 - p / 100 for p in published_range(results, claim_id)]
        rows = [CHANNELS.index(channel) for channel in GROUPS[group]]
        if len(ratios) > 1:
            ax.fill_betweenx([rows[0] - 0.5, rows[-1] + 0.5], *ratios, color=style.BLACK, alpha=0.09, linewidth=0, zorder=0)
        for ratio in ratios:
            style.published_marker(ax, [ratio] * len(rows), rows).set(zorder=1.5)
        drawn += ratios
    return drawn


CONSISTENT = {"ekf": 1.0, "ekf-tuned": 1.2, "ci-seq": 2.2, "ci-corr": 1.1, "mk-norm-gain": 1.0}
"""Variants, and widths that keep lines visible where they coincide."""
MEASURES = {
    "nees_attitude": ("NEES of attitude", 3),
    "nees_bias": ("NEES of biases", 6),
    "nis_mean": ("NIS, means of 10 s", 6),
}
"""Words and degrees of freedom."""
WINDOW = 10
"""Plotting epochs (one a second) whose NIS is averaged."""


def consistent_line(variant: str) -> dict:
    """How a variant is drawn here: the nominal EKF shares its family with the tuned one and is dotted."""
    if variant == "ekf":
        return line_of(variant, label="EKF, nominal", linestyle=":", linewidth=CONSISTENT[variant])
    return line_of(variant, marker=look(VARIANTS[variant].family)["marker"], linewidth=CONSISTENT[variant])


def draw_consistency(results: Results) -> Drawing:
    """NEES of attitude and biases, and NIS, over time in the three formulations, with the band of an honest filter."""
    figure = Drawing(figsize=(style.WIDTH, 6.4))
    axes = figure.subplots(len(MEASURES), len(FORMULATIONS), sharex=True, sharey="row")
    runs = results.settings.sizes["runs"]
    for row, (measure, (words, dof)) in zip(axes, MEASURES.items(), strict=True):
        band = chi_square_band(dof, runs * (WINDOW if measure == "nis_mean" else 1))
        drawn = [band.low, band.high]
        for ax, name in zip(row, FORMULATIONS, strict=True):
            ax.axhspan(band.low, band.high, color=style.BLACK, alpha=0.16, linewidth=0)
            ax.axhline(dof, color=style.BLACK, linewidth=0.7)
            for place, variant in enumerate(CONSISTENT):
                time, values = over_time(results, variant, name, measure)
                ax.plot(time, values, **consistent_line(variant), markevery=(place, 5))
                drawn += list(values)
            panel_title(ax, TITLES[name] if measure == "nees_attitude" else "")
        decades(row[0], "y", min(drawn) / 1.3, max(drawn) * 1.3)
        row[0].set_ylabel(f"{words} (1)")
    axes[-1, 0].set(xlim=(0, DURATION), xticks=(0, 100, 200, 300))
    figure.supxlabel("time (s)", fontsize=8.5)
    figure.align_ylabels()
    band = Patch(color=style.BLACK, alpha=0.16, linewidth=0, label="95 % band of an honest filter")
    headline(figure, "Consistency, mean of the runs, headline condition",
             [*(Line2D([], [], **consistent_line(variant)) for variant in CONSISTENT), band], columns=3)  # fmt: skip
    return figure


def over_time(results: Results, variant: str, formulation: str, measure: str) -> tuple[np.ndarray, np.ndarray]:
    """Time [s] and mean over the surviving runs, that of NIS averaged over windows; empty when no run survives."""
    arrays = results.arrays(variant)
    survived = ~arrays[f"{formulation}.failed"]
    if not survived.any():
        return np.empty(0), np.empty(0)
    if measure == "nis_mean":
        values = arrays[f"{formulation}.nis_mean"][1:].reshape(-1, WINDOW).mean(axis=1)
        return (np.arange(len(values)) + 0.5) * WINDOW, values
    return arrays[f"{formulation}.marks"] / results.settings.options["rate_hz"], arrays[f"{formulation}.{measure}"][survived].mean(axis=0)


def draw_position(results: Results) -> Drawing:
    """Root mean square and final position error of every filter in the three formulations."""
    figure = Drawing(figsize=(style.WIDTH, 6.8))
    axes = figure.subplots(1, len(FORMULATIONS), sharey=True)
    names = list(VARIANTS)
    for ax, formulation in zip(axes, FORMULATIONS, strict=True):
        drawn = [ends for row, name in enumerate(names) for ends in position_row(ax, results, row, name, formulation)]
        decades(ax, "x", min(map(min, drawn)) / 1.3, max(map(max, drawn)) * 1.3)
        panel_title(ax, TITLES[formulation])
        ax.tick_params(axis="y", length=0)
        for row in np.arange(len(names) - 1) + 0.5:
            ax.axhline(row, color="#D9D9D9", linewidth=0.4)
        ax.grid(False, axis="y")
    axes[0].set_yticks(range(len(names)), [VARIANTS[name].label for name in names])
    axes[0].set_ylim(len(names) - 0.4, -0.6)
    figure.supxlabel("position error (m)", fontsize=8.5)
    shapes = [Line2D([], [], color=style.BLACK, linestyle="none", marker="o", fillstyle=fill, label=words)
              for fill, words in (("full", "root mean square over the drive"), ("none", "at the end"))]  # fmt: skip
    bar = Line2D([], [], color=style.BLACK, linewidth=1.0, label="5 % to 95 % of runs; mark: median")
    headline(figure, "Position, which no filter observes, headline condition", [*shapes, bar], columns=3)
    return figure


def position_row(ax: Axes, results: Results, row: int, name: str, formulation: str) -> list[tuple[float, float]]:
    """One filter's errors, and in words how many of its runs failed; returns the ends of what was drawn."""
    arrays = results.arrays(name)
    survived = ~arrays[f"{formulation}.failed"]
    if not survived.all():
        lost = np.sum(~survived)
        words = f"{lost} of {len(survived)} fail" if survived.any() else f"all {lost} runs fail"
        paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
        ax.text(0.02, row, words, fontsize=8, verticalalignment="center", transform=ax.get_yaxis_transform(), bbox=paper)
    if not survived.any():
        return []
    return [
        draw_lengths(ax, arrays[f"{formulation}.{what}"][survived], row + shift, name, fill)
        for what, shift, fill in (("position_rms", -0.16, "full"), ("position_final", 0.16, "none"))
    ]


def draw_lengths(ax: Axes, errors: np.ndarray, row: float, name: str, fill: str) -> tuple[float, float]:
    """Median and 5 % to 95 % of the length of position errors ``(runs, 3)``; returns the ends."""
    low, middle, high = np.quantile(np.linalg.norm(errors, axis=1), (0.05, 0.5, 0.95))
    color = look(VARIANTS[name].family)["color"]
    ax.hlines(row, low, high, color=color, linewidth=1.0)
    ax.plot([middle], [row], linestyle="none", marker="o", markersize=3.6, color=color, fillstyle=fill, markerfacecoloralt="white")
    return low, high
