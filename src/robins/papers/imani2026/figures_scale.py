"""Kernel scale: the map of improvements over outlier rate and kernel scale, and the way from no update to the EKF."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D

from robins.papers.imani2026.comparisons import GROUPS
from robins.papers.imani2026.palette import look
from robins.papers.imani2026.panels import (
    TITLES,
    UNITS,
    Grouped,
    decades,
    group_level,
    group_ratio,
    headline,
    panel_title,
    percent,
    plain_ticks,
)
from robins.papers.imani2026.studies import GATES, KERNEL_SCALES, NOISE_DECADES, OUTLIER_RATES, SINGLE_WIDTHS
from robins.papers.protocol import Results
from robins.publish import style

DIVERGING = LinearSegmentedColormap.from_list("improvement", [style.VERMILLION, "#F6C9A8", "#FFFFFF", "#B9D9EE", style.BLUE])
"""Worse, no difference, better."""
STRONGEST = 4.0
"""Ratio of errors at which the colours end."""
CI = {"method": "ci-seq", "scale": 1.0}
MAPPED = {"mk-norm-gain": "multi-kernel on the gain", "mk-norm": "multi-kernel on the noise"}


def scaled(method: str, value: float) -> dict:
    """Labels of a filter in the study."""
    return {"method": method, "scale": value}


def cell_text(ratio: float) -> str:
    """Improvement in per cent; where the error is at least doubled, how many times it is."""
    return percent(round(100 * (1 - ratio)) + 0) if ratio < 2 else f"×{ratio:.{ratio < 9.95:d}f}"


def draw_improvement_map(results: Results) -> Drawing:
    """Improvement over the CI-RKF by outlier rate and kernel scale, F1: one row of panels for each group of channels."""
    figure = Drawing(figsize=(style.WIDTH, 7.6))
    axes = figure.subplots(len(GROUPS), len(MAPPED), sharex=True, sharey=True)
    norm = Normalize(-np.log(STRONGEST), np.log(STRONGEST))
    for column, (method, words) in zip(axes.T, MAPPED.items(), strict=True):
        ratios = map_ratios(results, method)
        for ax, (group, found) in zip(column, zip(GROUPS, ratios, strict=True), strict=True):
            ax.imshow(-np.log(found), cmap=DIVERGING, norm=norm, aspect="auto")
            for (row, place), ratio in np.ndenumerate(found):
                color = "white" if ratio < STRONGEST**-0.8 else style.BLACK  # black reads better on vermillion, white on blue
                ax.text(place, row, cell_text(ratio), horizontalalignment="center", verticalalignment="center", fontsize=8, color=color)
            panel_title(ax, group, words)
            ax.grid(False)
            ax.tick_params(length=0)
            ax.spines[:].set_visible(False)
    plain_ticks(axes[0, 0], "x", range(len(KERNEL_SCALES)), ["∞" if np.isinf(c) else f"{c:g}" for c in KERNEL_SCALES])
    plain_ticks(axes[0, 0], "y", range(len(OUTLIER_RATES)), [f"{100 * rate:g}" for rate in OUTLIER_RATES])
    figure.supxlabel("kernel scale: multiplier of the conventional widths (1)", fontsize=8.5)
    figure.supylabel("outliers: share of the samples of a channel (%)", fontsize=8.5)
    ticks = [-300, -100, -50, 0, 33, 50, 75]
    bar = figure.colorbar(ScalarMappable(norm, DIVERGING), ax=axes, location="top", fraction=0.02, pad=0.01, aspect=60,
                          ticks=[-np.log(1 - p / 100) for p in ticks], extend="both")  # fmt: skip
    bar.ax.set_xticklabels([percent(p) for p in ticks])
    bar.set_label(f"improvement of RMSE over the CI-RKF (%), R as tuned · {TITLES['F1']}", fontsize=8.5)
    return figure


def map_ratios(results: Results, method: str) -> np.ndarray:
    """RMSE over that of the CI-RKF by group, outlier rate and kernel scale."""
    found = np.array([
        [group_ratio(results, "scale", {"formulation": "F1", "rate": rate}, scaled(method, c), CI).estimate for c in KERNEL_SCALES]
        for rate in OUTLIER_RATES
    ])  # fmt: skip
    return np.moveaxis(found, -1, 0)


SIZE, GAP = 4.2, 2.6
WIDTH_LIMITS = (0.02, 130.0)
INFINITE_AT = 70.0
"""Where an infinite width is drawn: right of the axis's last tick."""


def middle_width(options: Mapping) -> float:
    """The conventional width in the middle of the mixture, in standard deviations of the innovation."""
    return float(np.median(options["kernel_widths"]))


def curves(options: Mapping) -> dict[str, tuple[str, str, list[tuple[float, float]]]]:
    """By method: words, family, and pairs of the study's scale and the width or threshold it means."""
    middle = middle_width(options)
    kernels = [(c, c * middle) for c in KERNEL_SCALES]
    return {
        "mk-norm-gain": ("multi-kernel on the gain", "multi-kernel-gain", kernels),
        "mk-norm": ("multi-kernel on the noise", "multi-kernel", kernels),
        "single-kernel": ("single kernel", "single-kernel", [(width, width) for width in SINGLE_WIDTHS]),
        "gate": ("gate", "gated", [(threshold, threshold) for threshold in GATES]),
    }


def draw_scale_curve(results: Results, formulation: str) -> Drawing:
    """RMSE against kernel width and threshold, beside it against the multiplier of R; no outliers; in F0 R is nominal, in F1 as tuned."""
    figure = Drawing(figsize=(style.WIDTH, 6.4))
    axes = figure.subplots(len(GROUPS) // 2, len(GROUPS), sharey=False, width_ratios=(2.6, 1, 2.6, 1))
    where = {"formulation": formulation, "rate": 0.0}
    for number, group in enumerate(GROUPS):
        wide, narrow = axes[number // 2, 2 * (number % 2) : 2 * (number % 2) + 2]
        drawn = [*draw_widths(wide, results, where, number), *draw_inflated(narrow, results, where, number)]
        for name, family in (("no-update", "no-update"), ("ci-seq", "chi-square")):
            found = group_level(results, "scale", where, scaled(name, 0.0 if name == "no-update" else 1.0))
            drawn.append(shown(found, number))
            for ax in (wide, narrow):
                ax.axhspan(drawn[-1][1], drawn[-1][2], color=look(family)["color"], alpha=0.16, linewidth=0, zorder=0)
                ax.axhline(drawn[-1][0], **look(family) | {"marker": ""}, linewidth=1.2)
        limits = np.array(drawn)
        for ax in (wide, narrow):
            decades(ax, "y", limits.min() / 1.15, limits.max() * 1.15)
        narrow.tick_params(labelleft=False)
        panel_title(wide, group)
        wide.set_ylabel(f"RMSE ({UNITS[group]})")
    figure.supxlabel("left: width or threshold in standard deviations of the innovation (1); right: multiplier of R (1)", fontsize=8.5)
    chosen = {"F0": "nominal settings", "F1": "R and CI-RKF as tuned"}[formulation]
    words = f"From no update to the EKF: {chosen}, no outliers · {TITLES[formulation]}"
    headline(figure, words, legend(results.settings.options), columns=4)
    return figure


def shown(found: Grouped, number: int) -> tuple[float, float, float]:
    """Estimate and ends of one group in the unit it is shown in."""
    unit = 180 / np.pi if list(GROUPS)[number] == "Euler angles" else 1.0
    return tuple(unit * values[number] for values in found[:3])


def draw_widths(ax: Axes, results: Results, where: Mapping, number: int) -> list[tuple]:
    """Kernels and gates against width; returns what was drawn."""
    drawn = []
    for method, (_, family, places) in curves(results.settings.options).items():
        found = [shown(group_level(results, "scale", where, scaled(method, value)), number) for value, _ in places]
        x = np.array([INFINITE_AT if np.isinf(width) else width for _, width in places])
        estimate, low, high = np.transpose(found)
        finite = x < INFINITE_AT
        ax.plot(x[finite], estimate[finite], **look(family) | {"marker": ""}, linewidth=1.0)
        style.interval(ax, x, estimate, low, high, family, horizontal=False)
        drawn += found
    ax.set(xscale="log", xlim=WIDTH_LIMITS)
    ax.axvline(np.sqrt(INFINITE_AT * 24.0), color=style.GREY, linewidth=0.7, linestyle=(0, (1, 2)))
    plain_ticks(ax, "x", [0.03, 0.1, 0.3, 1, 3, 10, INFINITE_AT], ["0.03", "0.1", "0.3", "1", "3", "10", "∞"])
    return drawn


def draw_inflated(ax: Axes, results: Results, where: Mapping, number: int) -> list[tuple]:
    """The EKF with R enlarged; returns what was drawn."""
    x = [10.0**k for k in NOISE_DECADES]
    found = [shown(group_level(results, "scale", where, scaled("ekf-r", value)), number) for value in x]
    estimate, low, high = np.transpose(found)
    ax.plot(x, estimate, **look("inflated") | {"marker": ""}, linewidth=1.0)
    style.interval(ax, x, estimate, low, high, "inflated", horizontal=False)
    ax.set(xscale="log", xlim=(10**1.5, 10**8.5))
    plain_ticks(ax, "x", [1e2, 1e5, 1e8], ["$10^2$", "$10^5$", "$10^8$"])
    return found


def legend(options: Mapping) -> list[Line2D]:
    """Entries of the curves and of the two levels."""
    handles = [Line2D([], [], **look(family), label=words) for words, family, _ in curves(options).values()]
    levels = (("EKF, R enlarged", "inflated"), ("CI-RKF", "chi-square"), ("no update", "no-update"))
    for words, family in levels:
        handles.append(Line2D([], [], **look(family) | {"marker": look(family)["marker"] if family == "inflated" else ""}, label=words))
    return handles
