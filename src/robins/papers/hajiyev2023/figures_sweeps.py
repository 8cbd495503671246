"""Figures of ratios away from the baseline: one quantity at a time, and random sets of all of them."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as Drawing
from matplotlib.figure import FigureBase
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from robins.papers.hajiyev2023.comparisons import published_ratio
from robins.papers.hajiyev2023.panels import (
    PAIR_WORDS,
    family_of,
    headline,
    margin_mark,
    published_handle,
    published_mark,
    ratio_axis,
    ratio_interval,
    reach_of,
    rows_of_panels,
    state_grid,
)
from robins.papers.hajiyev2023.scenario import BRANCHES
from robins.papers.hajiyev2023.studies import ADAPTED, AUGMENTED, PLAIN
from robins.papers.protocol import Results
from robins.publish import style


class Sweep(NamedTuple):
    """How one sweep is shown: its name in the table, axis label, scale, ticks, and where the paper stands (None: not printed)."""

    name: str
    label: str
    scale: str
    ticks: tuple
    published: float | None


WINDOW = Sweep("window", "length of the window $M$ (steps)", "log", (3, 5, 10, 20, 50), None)
MULTIPLIER = Sweep("multiplier", r"fault multiplier of the noise of $q$ (1); that of $\theta$ is 5/8 of it", "log", (1, 2, 4, 8, 16, 32), 8)
TAU = Sweep("tau", r"correlation time $\tau$ (s)", "log", (2, 5, 20, 100, 500), None)
DURATION = Sweep("duration", "length of the fault and of the score (steps)", "linear", (10, 30, 70, 110), 70)
SPECIAL = {"9, 6": (70.0, "L", "D"), "8, 1": (120.0, "$q$", "<"), "1, 5": (210.0, r"$\theta$", ">")}
"""Settings of the fault that are no point of the curve: place on its axis and tick label."""


def sweep_points(table: pd.DataFrame, sweep: Sweep, pair: str, state: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Value, geometric mean ratio, low and high of each setting: those of the curve, and those of `SPECIAL`."""
    chosen = table[(table["sweep"] == sweep.name) & (table["pair"] == pair) & (table["state"] == state) & ~table["failed"]]
    rows = []
    for setting, group in chosen.groupby("setting", sort=False):
        logs = (np.log(group["numerator"]) - np.log(group["denominator"])).to_numpy()
        rows.append((setting, group["value"].iloc[0], *ratio_interval(logs)))
    points = pd.DataFrame(rows, columns=["setting", "value", "ratio", "low", "high"])
    special = points["setting"].isin(SPECIAL) & (sweep.name == "multiplier")
    return points[~special].sort_values("value"), points[special]


def sweep_grid(figure: FigureBase, results: Results, sweep: Sweep) -> None:
    """The ratios AMDKF/MDKF and AAKF/AKF against one quantity, state by state."""
    tables = {branch: results.table(f"sweep-{branch}") for branch in BRANCHES}
    for row in rows_of_panels(state_grid(figure)):
        drawn = [[published_ratio(results, panel.state) for panel in row]]
        for panel in row:
            for pair in (ADAPTED, PLAIN):
                points, special = sweep_points(tables[panel.branch], sweep, pair, panel.state)
                look = style.family(family_of(pair)) | {"label": PAIR_WORDS[pair]}
                panel.ax.fill_between(points["value"], points["low"], points["high"], color=look["color"], alpha=0.2, linewidth=0)
                panel.ax.plot(points["value"], points["ratio"], **look, linewidth=1.0)
                places = [SPECIAL[setting][0] for setting in special["setting"]]
                style.interval(panel.ax, places, special["ratio"], special["low"], special["high"], family_of(pair), horizontal=False)
                drawn += [frame[["low", "high"]].to_numpy() for frame in (points, special)]
            panel.ax.set_xscale(sweep.scale)
            ticks = list(sweep.ticks) + [place for place, *_ in SPECIAL.values()] * (sweep.name == "multiplier")
            words = [f"{tick:g}" for tick in sweep.ticks] + [word for _, word, _ in SPECIAL.values()] * (sweep.name == "multiplier")
            panel.ax.xaxis.set_minor_locator(NullLocator())
            panel.ax.set_xticks(ticks, words)
            limits = panel.ax.get_xlim()
            if sweep.published is None:
                span = sweep.ticks[-1] / sweep.ticks[0]
                limits = (sweep.ticks[0] * span**-0.05, sweep.ticks[-1] * span**0.12)  # room for the mark
                margin_mark(panel.ax, published_ratio(results, panel.state))
            else:
                published_mark(panel.ax, [sweep.published], [published_ratio(results, panel.state)])
            panel.ax.set_xlim(limits)
        for panel in row:
            ratio_axis(panel.ax, "y", reach_of(*drawn))
    figure.supxlabel(sweep.label, fontsize=8.5)


def draw_sweeps(results: Results, sweeps: tuple[Sweep, ...], title: str) -> Drawing:
    """F13, F14, F15: one block of panels for each sweep."""
    figure = Drawing(figsize=(style.WIDTH, 0.7 + 4.6 * len(sweeps) - 0.5 * (len(sweeps) > 1)))
    if len(sweeps) == 1:
        sweep_grid(figure, results, sweeps[0])
    else:
        for block, sweep in zip(figure.subfigures(len(sweeps), 1), sweeps, strict=True):
            sweep_grid(block, results, sweep)
    figure.supylabel("RMSE ratio, adaptive over plain filter (1)", fontsize=8.5)
    handles = [Line2D([], [], **style.family(family_of(pair)), label=PAIR_WORDS[pair]) for pair in (ADAPTED, PLAIN)]
    headline(figure, title, [published_handle(), *handles])
    return figure


CURVES = {AUGMENTED: "-", PLAIN: "--", ADAPTED: "-"}
"""Pairs of the specification curve in the order of drawing, with their dashes: two have the colour of the AKF."""


def draw_specification_curve(results: Results) -> Drawing:
    """F12: ratios of many random parameter sets, each pair sorted by itself."""
    tables = {branch: results.table(f"specification-{branch}") for branch in BRANCHES}
    figure = Drawing(figsize=(style.WIDTH, 5.8))
    looks = {pair: {"color": style.family(family_of(pair))["color"], "linestyle": dash} for pair, dash in CURVES.items()}
    for row in rows_of_panels(state_grid(figure)):
        drawn = [[published_ratio(results, panel.state) for panel in row]]
        for panel in row:
            table = tables[panel.branch]
            for pair, look in looks.items():
                chosen = table[(table["pair"] == pair) & (table["state"] == panel.state) & (table["n"] > 0)]
                ratios = np.sort(chosen["ratio"].to_numpy())
                panel.ax.plot((np.arange(len(ratios)) + 0.5) / len(ratios) * 100, ratios, **look)
                drawn.append(ratios)
                if pair == ADAPTED:
                    panel.ax.text(0.04, 0.95, f"{100 * np.mean(ratios < 1):.0f} % < 1", transform=panel.ax.transAxes,
                                  color=look["color"], verticalalignment="top", fontsize=8)  # fmt: skip
            margin_mark(panel.ax, published_ratio(results, panel.state))
            panel.ax.set(xlim=(0, 109), xticks=(0, 25, 50, 75, 100))
        for panel in row:
            ratio_axis(panel.ax, "y", reach_of(*drawn))
    figure.supxlabel("parameter sets, sorted by their ratio (%)", fontsize=8.5)
    figure.supylabel("RMSE ratio, mean of a set's runs (1)", fontsize=8.5)
    handles = [Line2D([], [], **look, label=PAIR_WORDS[pair]) for pair, look in looks.items()]
    headline(figure, "Random parameter sets around each branch", [published_handle(), *reversed(handles)])
    return figure
