"""Away from the headline condition: outliers by law and side, sampling rates, sensor grades; and what was tuned.

All in F1 with the settings that were tuned under the headline condition, unless a mark says that it was tuned again.
"""

from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D

from robins.papers.imani2026.comparisons import GROUPS
from robins.papers.imani2026.methods import FAMILIES, SWEPT
from robins.papers.imani2026.palette import look
from robins.papers.imani2026.panels import (
    TITLES,
    UNITS,
    decades,
    group_level,
    group_ratio,
    headline,
    improvement_axis,
    in_words,
    panel_title,
    plain_ticks,
)
from robins.papers.imani2026.studies import OUTLIER_RATES, variant_name
from robins.papers.imani2026.tune import RETUNED_RATE
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

CI = "ci-seq"
SWEPT_FILTERS = tuple(variant_name(family) for family in SWEPT)
COMPARED = tuple(name for name in SWEPT_FILTERS if name != CI)
LAW_WORDS = {"nig-zero-mean": "zero-mean NIG", "nig-zero-mode": "zero-mode NIG"}
COLUMNS = [(law, sided) for law in LAW_WORDS for sided in ("two-sided", "one-sided")]


def swept_line(name: str, **changes) -> dict:
    """Line and marker of a filter of the sweeps, without its label's remark on tuning: all are tuned."""
    row = VARIANTS[name]
    return look(row.family) | {"label": label_of(name), "linewidth": 1.0} | changes


def label_of(name: str) -> str:
    """The filter's label without the remark that it is tuned."""
    return VARIANTS[name].label.replace(" (tuned)", "").replace(", tuned", "")


def swept_entries(names) -> list[Line2D]:
    """Legend of filters of the sweeps."""
    return [Line2D([], [], **swept_line(name)) for name in names]


def curve(ax: Axes, x, rows: list[tuple[float, float, float]], name: str, place: float = 1.0) -> None:
    """A line through estimates with their intervals; `place` moves them aside along a logarithmic axis, NaN leaves a gap."""
    estimate, low, high = np.transpose(rows)
    at = np.asarray(x, float) * place
    ax.plot(at, estimate, **swept_line(name))
    ax.vlines(at, low, high, color=look(VARIANTS[name].family)["color"], linewidth=1.0)


def pick(found, number: int, unit: float = 1.0) -> tuple[float, float, float]:
    """Estimate and ends of one group."""
    return tuple(unit * values[number] for values in found[:3])


OUTLIER_PLACES = (0.5, 1, 2, 5, 10)
"""Where the rates of `OUTLIER_RATES` stand on a logarithmic axis, per cent: none is at the left end."""


def draw_outliers(results: Results) -> Drawing:
    """Improvement over the CI-RKF against the rate of outliers, by noise law and side, one row of panels per group of channels."""
    figure = Drawing(figsize=(style.WIDTH, 8.2))
    axes = figure.subplots(len(GROUPS), len(COLUMNS) + 1, sharex="col", sharey="row", width_ratios=(*[1] * len(COLUMNS), 0.34))
    for number, (row, group) in enumerate(zip(axes, GROUPS, strict=True)):
        drawn = []
        for ax, (law, sided) in zip(row, COLUMNS, strict=False):
            drawn += draw_outlier_panel(ax, results, number, law, sided)
            panel_title(ax, group if ax is row[0] else "", f"{LAW_WORDS[law]},\n{sided}" if number == 0 else "")
        drawn += draw_mixture(row[-1], results, number)
        panel_title(row[-1], "", "mixture" if number == 0 else "")
        for ax in row:
            improvement_axis(ax, "y", drawn)
    for ax in axes[0, :-1]:
        ax.set(xscale="log", xlim=(0.4, 12.5))
        plain_ticks(ax, "x", OUTLIER_PLACES, [f"{100 * rate:g}" for rate in OUTLIER_RATES])
    axes[0, -1].set(xlim=(-0.5, 0.5))
    plain_ticks(axes[0, -1], "x", [0.0], ["0"])
    figure.supxlabel("outliers: share of the samples of a channel (%)", fontsize=8.5)
    figure.supylabel("improvement of RMSE over the CI-RKF (%)", fontsize=8.5)
    again = in_words(f"hollow: tuned again at {100 * RETUNED_RATE:g} %")
    headline(figure, f"Outliers, law and side; all filters tuned · {TITLES['F1']}", [*swept_entries(COMPARED), again], columns=4)
    return figure


def aside(names=COMPARED) -> dict[str, float]:
    """Small shifts, as factors, that keep the intervals of filters apart at one abscissa."""
    return dict(zip(names, 1.0 + 0.035 * (np.arange(len(names)) - (len(names) - 1) / 2), strict=True))


def draw_outlier_panel(ax: Axes, results: Results, number: int, law: str, sided: str) -> list[tuple]:
    """One law and side; returns what was drawn."""
    drawn = []
    for name, place in aside().items():
        cases = [{"law": law, "sided": sided if rate else "two-sided", "rate": rate, "tuned": "headline"} for rate in OUTLIER_RATES]
        rows = [pick(group_ratio(results, "outliers", where, name, CI), number) for where in cases]
        curve(ax, OUTLIER_PLACES, rows, name, place)
        drawn += rows
        if (law, sided) == COLUMNS[0]:
            again = {"law": law, "sided": sided, "rate": RETUNED_RATE, "tuned": "outliers"}
            estimate = pick(group_ratio(results, "outliers", again, name, CI), number)[:1]
            hollow = swept_line(name) | {"linestyle": "", "markerfacecolor": "white"}
            ax.plot([100 * RETUNED_RATE * place * 1.25], estimate, **hollow)
            drawn.append(estimate)
    return drawn


def draw_mixture(ax: Axes, results: Results, number: int) -> list[tuple]:
    """The impulsive law, to which no outliers are added; returns what was drawn."""
    where = {"law": "mixture", "sided": "two-sided", "rate": 0.0, "tuned": "headline"}
    drawn = []
    for name, place in aside().items():
        drawn.append(pick(group_ratio(results, "outliers", where, name, CI), number))
        curve(ax, [3.0 * (place - 1.0)], [drawn[-1]], name)
    return drawn


NOISES = {"equal-sample": "equal per sample", "equal-psd": "equal density"}
"""What stays the same when the rate changes: the noise of a sample, or its density."""


def draw_rates(results: Results) -> Drawing:
    """RMSE of the tuned filters, and improvement over the CI-RKF, against the sampling rate."""
    figure = Drawing(figsize=(style.WIDTH, 8.0))
    axes = figure.subplots(len(GROUPS), 2 * len(NOISES), sharex=True)
    rates = list(results.settings.options["rates_hz"])
    for number, (row, group) in enumerate(zip(axes, GROUPS, strict=True)):
        unit = 180 / np.pi if group == "Euler angles" else 1.0
        levels, ratios = [], []
        for column, (noise, words) in enumerate(NOISES.items()):
            cases = [{"rate_hz": rate, "noise": noise} for rate in rates]
            for name, place in aside(SWEPT_FILTERS).items():
                levels.append([pick(group_level(results, "rates", where, name), number, unit)[0] for where in cases])
                row[column].plot(np.array(rates) * place, levels[-1], **swept_line(name))
            for name, place in aside().items():
                ratios.append([pick(group_ratio(results, "rates", where, name, CI), number) for where in cases])
                curve(row[2 + column], rates, ratios[-1], name, place)
            for ax in row[column::2]:
                panel_title(ax, words if number == 0 else "")
        share_levels(row[:2], levels)
        for ax in row[2:]:
            improvement_axis(ax, "y", ratios)
        row[0].set_ylabel(f"{group}: RMSE ({UNITS[group]})")
        row[2].set_ylabel("improvement of RMSE (%)")
        for ax in row[1::2]:
            ax.tick_params(labelleft=False)
    axes[0, 0].set(xscale="log", xlim=(rates[0] / 1.5, rates[-1] * 1.5))
    plain_ticks(axes[0, 0], "x", rates, sparse_labels(rates))
    figure.supxlabel("sampling rate (Hz)", fontsize=8.5)
    words = f"Sampling rate and noise; settings of the headline condition · {TITLES['F1']}"
    headline(figure, words, swept_entries(SWEPT_FILTERS), columns=4)
    return figure


def sparse_labels(values) -> list[str]:
    """Labels of a short logarithmic axis: from the largest down, those that do not touch the one before."""
    labels, last = [], np.inf
    for value in sorted(values, reverse=True):
        fits = np.log10(last / value) > 0.11 * len(f"{last:g}")
        labels.append(f"{value:g}" if fits else "")
        last = value if fits else last
    return labels[::-1]


def share_levels(axes, levels) -> None:
    """The same logarithmic limits for panels that show the same quantity."""
    for ax in axes:
        decades(ax, "y", np.nanmin(levels) / 1.25, np.nanmax(levels) * 1.25)


GRADE_WORDS = {"vehicle": "vehicle grade", "atomic-ideal": "ideal atomic grade"}


def draw_grades(results: Results) -> Drawing:
    """Improvement over the CI-RKF of every tuned filter with two grades of sensors."""
    figure = Drawing(figsize=(style.WIDTH, 3.8))
    axes = figure.subplots(1, len(GRADE_WORDS), sharey=True)
    for ax, (grade, words) in zip(axes, GRADE_WORDS.items(), strict=True):
        drawn = []
        for place, name in enumerate(COMPARED):
            found = group_ratio(results, "grades", {"grade": grade}, name, CI)
            rows = np.arange(len(GROUPS)) + 0.11 * (place - (len(COMPARED) - 1) / 2)
            style.interval(ax, rows, found.estimate, found.low, found.high, VARIANTS[name].family)
            drawn += [found.estimate, found.low, found.high]
        improvement_axis(ax, "x", drawn)
        panel_title(ax, words)
        ax.grid(False, axis="y")
        for edge in np.arange(len(GROUPS) - 1) + 0.5:
            ax.axhline(edge, color="#D9D9D9", linewidth=0.7)
    axes[0].set_yticks(range(len(GROUPS)), levels_in_words(results))
    axes[0].set_ylim(len(GROUPS) - 0.5, -0.5)
    for ax in axes:
        ax.tick_params(axis="y", length=0)
    figure.supxlabel("improvement of RMSE over the CI-RKF (%)", fontsize=8.5)
    entries = [Line2D([], [], **swept_line(name) | {"linestyle": ""}) for name in COMPARED]
    headline(figure, f"Sensor grades; all filters tuned · {TITLES['F1']}", entries, columns=4)
    return figure


def levels_in_words(results: Results) -> list[str]:
    """Each group with the RMSE of the CI-RKF at every grade."""
    found = [group_level(results, "grades", {"grade": grade}, CI).estimate * (1, 1, 1, 180 / np.pi) for grade in GRADE_WORDS]
    levels = [" | ".join(f"{value:.2g}" for value in values) for values in np.transpose(found)]
    return [f"{group}\n{level} {unit}" for (group, unit), level in zip(UNITS.items(), levels, strict=True)]


SEQUENTIAL = LinearSegmentedColormap.from_list("loss", ["#FFFFFF", "#B9D9EE", style.BLUE])
WORST = 0.4
"""Excess of the objective at which the colours end."""


def draw_tuning(results: Results, condition: str) -> Drawing:
    """The sixteen evaluated settings of every family: excess of the objective over the family's best, which is marked."""
    columns = 4
    figure = Drawing(figsize=(style.WIDTH, 2.35 * -(-len(FAMILIES) // columns)))
    axes = figure.subplots(-(-len(FAMILIES) // columns), columns).flat
    for ax in axes[len(FAMILIES) :]:
        ax.remove()
    for ax, (key, family) in zip(axes, FAMILIES.items(), strict=False):
        draw_settings(ax, results.table(f"tuning-{key}"), condition)
        panel_title(ax, family.label.replace("sequential", "seq."))
        ax.set_xlabel(fill(unit_of(family.parameter), 15), labelpad=2)
    figure.supylabel("multiplier of R (1)", fontsize=8.5)
    words = {"headline": "headline condition", "outliers": f"{100 * RETUNED_RATE:g} % two-sided outliers"}[condition]
    square = Line2D([], [], linestyle="none", marker="s", markersize=9, markerfacecolor="none", markeredgecolor=style.BLACK,
                    markeredgewidth=1.8, label="chosen")  # fmt: skip
    excess = in_words("numbers: 100 × (objective − the family's best); F: a run fails")
    headline(figure, f"Tuning, {words}: 16 settings of two knobs for each family · {TITLES['F1']}", [square, excess], columns=2)
    return figure


def unit_of(parameter: str) -> str:
    """A knob's name with its unit in parentheses, 1 where it has none."""
    return parameter.replace("[", "(").replace("]", ")") if "[" in parameter else f"{parameter} (1)"


def short(value: float) -> str:
    """A knob's value in a few letters; probabilities near one keep three digits."""
    return f"{value:.{3 if 0.9 < value < 1 else 2}g}".removeprefix("0")


def draw_settings(ax: Axes, table, condition: str) -> None:
    """One family's settings as a square of cells."""
    table = table[table["condition"] == condition]
    values, scales = sorted(table["value"].unique()), sorted(table["noise_scale"].unique())
    cells = table.pivot(index="noise_scale", columns="value", values="objective").loc[scales, values].to_numpy()
    excess = cells - np.min(cells)
    ax.imshow(np.minimum(excess, WORST), cmap=SEQUENTIAL, vmin=0, vmax=WORST, aspect="auto", origin="lower")
    for (row, column), value in np.ndenumerate(excess):
        text = "F" if not np.isfinite(value) else f"{100 * value:.0f}"
        ax.text(column, row, text, horizontalalignment="center", verticalalignment="center", fontsize=8,
                color="white" if value > 0.8 * WORST else style.BLACK)  # fmt: skip
    chosen = table[table["chosen"]].iloc[0]
    place = values.index(chosen["value"]), scales.index(chosen["noise_scale"])
    ax.plot(*place, color=style.BLACK, marker="s", markersize=15, markerfacecolor="none", markeredgewidth=1.8)
    plain_ticks(ax, "x", range(len(values)), [short(value) for value in values])
    plain_ticks(ax, "y", range(len(scales)), [f"{value:g}" for value in scales])
    ax.grid(False)
    ax.tick_params(length=0)
    ax.spines[:].set_visible(False)
