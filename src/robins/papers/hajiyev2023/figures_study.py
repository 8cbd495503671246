"""Figures of ratios at the baseline: what adaptation does to each state's error, and how far one run may stray."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from robins.navigation.aircraft import STATES, continuous_matrices
from robins.papers.hajiyev2023.comparisons import FAULTY, MDKF, labelled, published_ratio, published_rmse, scores
from robins.papers.hajiyev2023.panels import (
    CORRECTED,
    NAMES,
    PAIR_WORDS,
    PUBLISHED,
    SYMBOLS,
    family_of,
    headline,
    paired_logs,
    published_handle,
    published_mark,
    ratio_axis,
    ratio_interval,
    reach_of,
    rows_of_panels,
    state_grid,
)
from robins.papers.hajiyev2023.scenario import BRANCHES, load_plant
from robins.papers.hajiyev2023.studies import ADAPTED, PLAIN
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

CENTRAL = (0.025, 0.975)


def state_rows(ax: Axes, names: bool) -> None:
    """A row for each state, the first on top, with the longitudinal and the lateral ones apart."""
    labels = [f"{NAMES[state]} {SYMBOLS[state]}" if names else SYMBOLS[state] for state in STATES]
    ax.set_yticks(range(8), [label + "*" * (state in FAULTY) for label, state in zip(labels, STATES, strict=True)])
    ax.set_ylim(7.6, -0.6)
    ax.axhline(3.5, color=style.GREY, linewidth=0.6, linestyle=":")
    ax.tick_params(axis="y", length=0)
    ax.grid(False, axis="y")


def ratio_row(ax: Axes, y: float, logs: np.ndarray, family: str, hollow: bool = False, label: str | None = None) -> np.ndarray:
    """The geometric mean of a state's ratios with its 95 % interval (thick) and the central 95 % of the runs (thin)."""
    mean, low, high = ratio_interval(logs)
    ends = np.exp(np.quantile(logs, CENTRAL))
    ax.hlines(y, *ends, color=style.family(family)["color"], linewidth=0.8, zorder=2)
    marker = style.interval(ax, [y], [mean], [low], [high], family, label=label)
    ax.collections[-1].set_linewidth(2.6)
    marker.set(markersize=4.2, markerfacecolor="white" if hollow else style.family(family)["color"])
    return ends


def draw_overview(results: Results) -> Drawing:
    """What the paper claims and what the ensemble says, at a glance."""
    logs = paired_logs(results, ADAPTED)
    figure = Drawing(figsize=(style.WIDTH, 3.7))
    ax = figure.subplots()
    published = [published_ratio(results, state) for state in STATES]
    drawn = [published]
    for i, state in enumerate(STATES):
        for branch, shift in zip(BRANCHES, (-0.17, 0.17), strict=True):
            label = f"ours, {branch} branch" if i == 0 else None
            drawn.append(ratio_row(ax, i + shift, logs[branch, "fault", state], family_of(ADAPTED), branch == "rad", label))
    published_mark(ax, published, range(8))
    reach = reach_of(*drawn)
    ratio_axis(ax, "x", reach)
    ax.axvspan(1, reach, color=style.BLACK, alpha=0.06, linewidth=0, zorder=0)
    state_rows(ax, names=True)
    for side, words in ((0.25, "adaptation better"), (0.75, "adaptation worse")):
        ax.text(side, 1.01, words, transform=ax.transAxes, horizontalalignment="center", verticalalignment="bottom", fontsize=8.5)
    ax.set(xlabel="RMSE of AMDKF over RMSE of MDKF (1)")
    headline(figure, "Does adaptation help when two channels (*) are faulty?", ordered(ax))
    return figure


def ordered(ax: Axes) -> list:
    """The labelled artists of `ax`, the published values before all others."""
    return sorted(ax.get_legend_handles_labels()[0], key=lambda artist: artist.get_label() != PUBLISHED)


def draw_forest(results: Results) -> Drawing:
    """F9: paired ratios of three adaptive filters to their plain forms, by branch, with and without the fault."""
    pairs = {pair: paired_logs(results, pair) for pair in (ADAPTED, CORRECTED, PLAIN)}
    figure = Drawing(figsize=(style.WIDTH, 7.2))
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    published = [published_ratio(results, state) for state in STATES]
    drawn = [published]
    for row, (condition, words) in zip(axes, (("fault", "with the fault"), ("healthy", "no fault")), strict=True):
        for ax, branch in zip(row, BRANCHES, strict=True):
            for (pair, logs), shift in zip(pairs.items(), (-0.25, 0.0, 0.25), strict=True):
                for i, state in enumerate(STATES):
                    label = PAIR_WORDS[pair] if i == 0 else None
                    drawn.append(ratio_row(ax, i + shift, logs[branch, condition, state], family_of(pair), label=label))
            if condition == "fault":
                published_mark(ax, published, np.arange(8) - 0.25)
            ax.set_title(words)
            ax.set_title(f"{branch} branch", loc="right", fontsize=8, color=style.GREY)
    for ax in axes.flat:
        ratio_axis(ax, "x", reach_of(*drawn))
        state_rows(ax, names=False)
    for ax in axes[:, 0]:
        ax.set_ylabel("state (* faulty channel)")
    figure.supxlabel("RMSE of the adaptive over RMSE of the plain filter (1); left of 1: adaptation better", fontsize=8.5)
    headline(figure, "Paired error ratios", ordered(axes[0, 0]))
    return figure


def draw_single_seed_ratios(results: Results) -> Drawing:
    """F17: how far one run's ratio can be from the mean, and where the published run lies."""
    logs, look = paired_logs(results, ADAPTED), style.family(family_of(ADAPTED))
    figure = Drawing(figsize=(style.WIDTH, 5.8))
    for row in rows_of_panels(state_grid(figure, sharex="row", sharey=False)):
        runs = {panel.state: logs[panel.branch, "fault", panel.state] for panel in row}
        outer = [np.exp(np.quantile(values, (0.001, 0.999))) for values in runs.values()]
        reach = reach_of(*outer, [published_ratio(results, state) for state in runs])
        edges = np.linspace(-np.log(reach), np.log(reach), 57)
        for panel in row:
            values = runs[panel.state]
            counts = np.histogram(values, edges)[0] / len(values) * 100
            panel.ax.stairs(counts, np.exp(edges), fill=True, color=look["color"], alpha=0.45)
            panel.ax.hlines(1.1 * counts.max(), *np.exp(np.quantile(values, CENTRAL)), color=style.BLACK, linewidth=1.4)
            style.published_marker(panel.ax, [published_ratio(results, panel.state)], [1.1 * counts.max()])
            panel.ax.text(0.02, 0.96, f"{100 * np.mean(values < 0):.0f} % < 1", transform=panel.ax.transAxes, verticalalignment="top",
                          fontsize=8)  # fmt: skip
            ratio_axis(panel.ax, "x", reach, (0.1, 0.2, 0.5, 1, 2, 5, 10) if reach > 3 else (0.5, 0.7, 1, 1.4, 2))
            panel.ax.yaxis.set_major_locator(MaxNLocator(4, integer=True))
            panel.ax.set_ylim(0, 1.42 * counts.max())
    figure.supxlabel("RMSE ratio AMDKF / MDKF of a single run (1)", fontsize=8.5)
    figure.supylabel("share of the runs in a bin (%)", fontsize=8.5)
    bars = [Patch(color=look["color"], alpha=0.45, label="our runs"), Line2D([], [], color=style.BLACK, label="their central 95 %")]
    headline(figure, "What a single run may show", [published_handle(), *bars])
    return figure


def expected_from_gust(results: Results) -> dict[str, float]:
    """Errors of q (rad/s), theta and beta (rad) that the published error of w implies on the substitute (brief, 2.4).

    In the short period ``|q| = omega |w| / U0`` and ``|theta| = |w| / U0``; sideslip is to the gust from the side what
    ``w / U0`` is to the one from below.
    """
    A, _ = continuous_matrices(load_plant(results.settings.options["plant"]))
    incidence = published_rmse(results, "w", "MDKF") / A[1, 2]
    omega = np.max(np.abs(np.linalg.eigvals(A[:4, :4])))
    return {"q": omega * incidence, "theta": incidence, "beta": incidence}


def draw_units(results: Results) -> Drawing:
    """Brief 2.4: are the published angles degrees or radians? Kinematics on the left, our own levels on the right."""
    figure = Drawing(figsize=(style.WIDTH, 3.9))
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.25))
    readings = {"deg": np.pi / 180, "rad": 1.0}
    left.axvspan(0.5, 2, color=style.BLACK, alpha=0.08, linewidth=0)
    for row, (state, expected) in enumerate(expected_from_gust(results).items()):
        places = {name: published_rmse(results, state, "MDKF") * factor / expected for name, factor in readings.items()}
        left.plot(list(places.values()), [row, row], color=style.GREY, linewidth=0.8, zorder=1)
        style.published_marker(left, list(places.values()), [row, row])
        for name, side, align in (("deg", -7, "right"), ("rad", 7, "left")):
            left.annotate(name, (places[name], row), (side, 0), textcoords="offset points", horizontalalignment=align,
                          verticalalignment="center", fontsize=8)  # fmt: skip
    left.set_yticks(range(3), [f"{NAMES[state]} {SYMBOLS[state]}" for state in ("q", "theta", "beta")])
    left.set(ylim=(2.5, -0.6), xlabel="published over implied by $w$ (1)", title="published angles, read both ways")
    ratio_axis(left, "x", 300.0)
    left.grid(False, axis="y")
    left.tick_params(axis="y", length=0)
    drawn, look = [], style.family(VARIANTS[MDKF].family)
    for i, state in enumerate(STATES):
        for branch, shift in zip(BRANCHES, (-0.17, 0.17), strict=True):
            values = level_ratios(results, state, branch)
            right.hlines(i + shift, *np.quantile(values, CENTRAL), color=look["color"], linewidth=0.8)
            marker = right.plot([np.median(values)], [i + shift], **look | {"linestyle": ""}, markersize=4.4,
                                label=f"our MDKF, {branch} branch" if i == 0 else None)[0]  # fmt: skip
            marker.set(markerfacecolor=look["color"] if branch == "deg" else "white")
            drawn.append(np.quantile(values, CENTRAL))
    ratio_axis(right, "x", reach_of(*drawn))
    state_rows(right, names=False)
    right.set(xlabel="RMSE of our MDKF over published (1)", title="our levels, each branch in its unit")
    handles = [published_handle(), *right.get_legend_handles_labels()[0]]
    headline(figure, "Degrees or radians? A hypothesis", handles)
    return figure


def level_ratios(results: Results, state: str, branch: str) -> np.ndarray:
    """RMSE of our MDKF with the fault over the published one, run by run, the published number read in the branch's unit."""
    seen = scores(results, MDKF, branch, "fault")
    return labelled(seen.rmse[~seen.failed, STATES.index(state)], state, branch) / published_rmse(results, state, "MDKF")
