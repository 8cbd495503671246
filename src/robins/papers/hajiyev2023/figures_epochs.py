"""Figures over the epochs: the paper's figures 1-8, scale factors, autocorrelation, NIS, convergence, lost information."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from scipy.stats import chi2

from robins.evaluate.intervals import LEVEL, Z
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.comparisons import AMDKF, LATERAL, MDKF, expected_scale, labelled, unit
from robins.papers.hajiyev2023.panels import (
    FAULT,
    NAMES,
    SYMBOLS,
    Panel,
    headline,
    line_of,
    state_grid,
)
from robins.papers.hajiyev2023.scenario import BRANCHES
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

TRANSIENT = 10
"""Epochs that do not decide an axis's limits: the first guess is forgotten meanwhile."""
BRANCH_WORDS = {"deg": "angles read in degrees", "rad": "angles read in radians"}
ITERATION = "iteration $k$ (steps)"
WORDS = {"fault": "with the fault", "healthy": "no fault"}


def fault_shade(ax: Axes, words: str = "") -> None:
    """Shade the epochs of the fault, which are those of the score, with `words` at the top."""
    style.shade_window(ax, *FAULT)
    if words:
        ax.text(sum(FAULT) / 2, 0.985, words, transform=ax.get_xaxis_transform(), horizontalalignment="center", verticalalignment="top",
                fontsize=8, color=style.GREY)  # fmt: skip


def state_limits(results: Results, state: str, branch: str) -> tuple[tuple[float, float], float]:
    """Limits of the upper panel and half-width of the lower one that serve AMDKF and MDKF alike."""
    i, levels, errors = STATES.index(state), [], []
    for name in (MDKF, AMDKF):
        arrays = results.arrays(name)
        truth, estimate, sd, quantiles = (
            arrays[f"{branch}.fault.{what}"][..., :-1, i] for what in ("truth0", "estimate0", "sd0", "error_quantiles")
        )
        levels += [truth, estimate[TRANSIENT:]]
        errors += [(estimate - truth)[TRANSIENT:], 3 * sd[TRANSIENT:], quantiles[:, TRANSIENT:].ravel()]
    low, high = np.nanmin(np.concatenate(levels)), np.nanmax(np.concatenate(levels))
    edge = 0.08 * (high - low)
    half = 1.08 * np.nanmax(np.abs(np.concatenate(errors)))
    return tuple(labelled([low - edge, high + 2.5 * edge], state, branch)), float(labelled(half, state, branch))


def draw_state(results: Results, variant: str, state: str, branch: str) -> Drawing:
    """One of figures 1-8: truth and estimate of run 0 above, its error with the filter's band and the ensemble's below."""
    arrays, i, look = results.arrays(variant), STATES.index(state), style.family(VARIANTS[variant].family)

    def of(what):
        return labelled(arrays[f"{branch}.fault.{what}"][..., i], state, branch)[..., :-1]  # mu(N) needs z(N+1): no estimate at N

    truth, estimate, sd, quantiles = of("truth0"), of("estimate0"), of("sd0"), of("error_quantiles")
    k = np.arange(len(truth))
    figure = Drawing(figsize=(style.WIDTH, 4.3))
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1.15))
    level, half = state_limits(results, state, branch)
    fault_shade(upper, "fault")
    upper.plot(k, truth, **style.family("truth") | {"label": "truth", "marker": ""}, linewidth=1.0)
    upper.plot(k, estimate, color=look["color"], linestyle=(0, (4, 1.5)), label=f"estimate, {VARIANTS[variant].label}")
    upper.set(ylabel=f"{SYMBOLS[state]} ({unit(state, branch)})", ylim=level)
    fault_shade(lower)
    lower.fill_between(k, -3 * sd, 3 * sd, color=look["color"], alpha=0.18, linewidth=0, label=r"$\pm 3\sqrt{P_{ii}}$, the filter's own")
    for end in (quantiles[0], quantiles[-1]):
        lower.plot(k, end, color=style.GREY, linestyle=(0, (1, 1.2)), linewidth=1.0)
    lower.axhline(0, color=style.BLACK, linewidth=0.6)
    lower.plot(k, estimate - truth, color=look["color"], label="error of this run")
    lower.set(ylabel=f"estimate − truth ({unit(state, branch)})", ylim=(-half, half), xlabel=ITERATION, xlim=(0, len(k)))
    figure.align_ylabels()
    band = Line2D([], [], color=style.GREY, linestyle=(0, (1, 1.2)), linewidth=1.0, label="central 95 % of all runs")
    handles = upper.get_legend_handles_labels()[0] + lower.get_legend_handles_labels()[0] + [band]
    headline(figure, f"{NAMES[state].capitalize()} {SYMBOLS[state]}, {BRANCH_WORDS[branch]}", handles, columns=3)
    return figure


def draw_scale_factors(results: Results) -> Drawing:
    """F10: the printed AMDKF's scale factors, channel by channel, with and without the fault."""
    arrays, look = results.arrays(AMDKF), line_of(AMDKF)
    figure = Drawing(figsize=(style.WIDTH, 5.4))
    for panel in state_grid(figure, sharey=True):
        low, middle, high = arrays[f"{panel.branch}.fault.scale_quantiles"][..., panel.index]
        healthy = arrays[f"{panel.branch}.healthy.scale_quantiles"][..., panel.index]
        k = np.arange(len(middle))
        fault_shade(panel.ax, "fault" if panel.ax is figure.axes[0] else "")
        panel.ax.fill_between(k, low, high, color=look["color"], alpha=0.22, linewidth=0, label="with the fault, 5 % to 95 % of runs")
        panel.ax.plot(k, middle, color=look["color"], label="with the fault, median")
        panel.ax.plot(k, healthy[2], color=style.BLACK, linestyle=":", linewidth=1.0, label="no fault, 95 %")
        expected = expected_scale(results, panel.branch)
        if panel.state in expected:
            panel.ax.hlines(expected[panel.state], *FAULT, color=style.BLACK, linestyle="--", linewidth=1.0)
        panel.ax.set(yscale="log", ylim=(0.8, 200), xlim=(0, k[-1]))
        plain_log(panel.ax, (1, 10, 100))
        panel.ax.xaxis.set_major_locator(FixedLocator([0, 80, 150, 200]))
    figure.supxlabel(ITERATION, fontsize=8.5)
    figure.supylabel("scale factor $s_i(k)$ (1)", fontsize=8.5)
    theory = Line2D([], [], color=style.BLACK, linestyle="--", linewidth=1.0, label="what the fault alone gives")
    headline(figure, "Scale factors of the AMDKF as printed", [*figure.axes[0].get_legend_handles_labels()[0], theory], columns=2)
    return figure


def plain_log(ax: Axes, ticks) -> None:
    """Label these `ticks` of a logarithmic y axis with plain numbers, and no others."""
    ax.yaxis.set_major_locator(FixedLocator(ticks))
    ax.yaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


CORRELATED = (("mdkf-printed", "no-v", 5.5), ("bh", "no-v", 3.4), ("mdkf-printed", "", 5.5), ("bh", "", 3.4), ("akf", "", 2.4))
"""Filters whose innovations are looked at, as simulated or without white noise (``no-v``), and the size of their markers."""


def draw_innovation_autocorrelation(results: Results) -> Drawing:
    """F11: autocorrelation of the innovations without a fault, of filters that do and do not claim them white."""
    figure = Drawing(figsize=(style.WIDTH, 5.6))
    for panel in state_grid(figure, sharey=True):
        half = Z / np.sqrt(results.arrays("akf")[f"{panel.branch}.healthy.innovation_count"])
        panel.ax.fill_between(np.arange(len(half)), -half, half, color=style.BLACK, alpha=0.15, linewidth=0)
        for name, kind, size in CORRELATED:
            key = f"{panel.branch}.{name}.no-v" if kind else f"{panel.branch}.healthy"
            values = results.arrays("theory" if kind else name)[f"{key}.innovation_autocorrelation"][1:, panel.index]
            look, label = style.family(VARIANTS[name].family), VARIANTS[name].label + r", $\sigma_v = 0$" * bool(kind)
            panel.ax.plot(np.arange(1, len(values) + 1), values, color=look["color"], linestyle=":" if kind else "-", linewidth=1.0,
                          marker=look["marker"], markevery=range(3), markersize=size, label=label,
                          markerfacecolor="white" if kind else look["color"])  # fmt: skip
        panel.ax.set(xlim=(0, 20.5), xticks=(1, 5, 10, 15, 20), ylim=(-0.6, 0.6))
    figure.supxlabel("lag (steps)", fontsize=8.5)
    figure.supylabel("autocorrelation of the innovation (1)", fontsize=8.5)
    band = Patch(color=style.BLACK, alpha=0.15, linewidth=0, label=r"$\pm 1.96/\sqrt{n}$")
    headline(figure, "Whiteness of the innovations, no fault", [*figure.axes[0].get_legend_handles_labels()[0], band], columns=3)
    return figure


CONSISTENT = ("mdkf-printed", "amdkf-printed", "bh", "akf", "aakf", "oracle")


def draw_nis(results: Results) -> Drawing:
    """F16: mean NIS over the runs at each epoch with the chi-square band of that mean."""
    figure = Drawing(figsize=(style.WIDTH, 4.8))
    axes = figure.subplots(2, 2, sharex=True, sharey="row")
    runs = results.settings.sizes["runs"]
    band = chi2.ppf([(1 - LEVEL) / 2, (1 + LEVEL) / 2], 8 * runs) / runs
    for row, condition in zip(axes, ("healthy", "fault"), strict=True):
        for ax, branch in zip(row, BRANCHES, strict=True):
            ax.axhspan(*band, color=style.BLACK, alpha=0.18, linewidth=0, label=r"95 % band of the mean, $\chi^2_8$")
            if condition == "fault":
                fault_shade(ax, "fault")
            for place, name in enumerate(CONSISTENT if condition == "fault" else CONSISTENT[:-1]):
                values, look = results.arrays(name)[f"{branch}.{condition}.nis_mean"], style.family(VARIANTS[name].family)
                ax.plot(np.arange(len(values)), values, **look, linewidth=0.9, markevery=(5 + 6 * place, 45), label=VARIANTS[name].label)
            ax.set_title(WORDS[condition])
            ax.set_title(f"{branch} branch", loc="right", fontsize=8, color=style.GREY)
            ax.set(xlim=(0, len(values) - 1), ylim=(4.8, 11))
            if condition == "fault":
                ax.set(yscale="log", ylim=(4.2, 130))
                plain_log(ax, (5, 8, 20, 50, 100))
    figure.supxlabel(ITERATION, fontsize=8.5)
    figure.supylabel("normalised innovation squared, mean of the runs (1)", fontsize=8.5)
    headline(figure, "Consistency of the innovations", axes[1, 0].get_legend_handles_labels()[0])
    return figure


def draw_convergence(results: Results) -> Drawing:
    """C16: what the filters believe and what their errors are, from the first step to the last."""
    figure = Drawing(figsize=(style.WIDTH, 5.8))
    for panel in state_grid(figure, sharey=False):
        fault_shade(panel.ax, "scored" if panel.ax is figure.axes[0] else "")
        for name in (MDKF, "akf"):
            look = style.family(VARIANTS[name].family)
            for what, line in (("sd_mean", "-"), ("rms_error", (0, (2, 1)))):
                values = labelled(results.arrays(name)[f"{panel.branch}.healthy.{what}"][:-1, panel.index], panel.state, panel.branch)
                words = {"sd_mean": "its own $\\sqrt{P_{ii}}$", "rms_error": "rms error of the runs"}[what]
                panel.ax.plot(np.arange(len(values)), values, color=look["color"], linestyle=line, label=f"{VARIANTS[name].label}: {words}")
        panel.ax.set(yscale="log", xlim=(0, 200), xticks=(0, 80, 150),
                     ylabel=f"{SYMBOLS[panel.state]} ({unit(panel.state, panel.branch)})")  # fmt: skip
        decade_limits(panel)
    figure.supxlabel(ITERATION, fontsize=8.5)
    figure.supylabel("standard deviation and rms error", fontsize=8.5)
    headline(figure, "Convergence without a fault", columns=2)
    return figure


def decade_limits(panel: Panel) -> None:
    """Limits and a few round ticks of a logarithmic y axis, from what is drawn in it."""
    drawn = np.concatenate([line.get_ydata() for line in panel.ax.lines])
    low, high = np.nanmin(drawn) / 1.15, np.nanmax(drawn) * 1.15
    steps = (1, 1.5, 2, 3, 5, 7) if high / low < 5 else (1, 2, 5) if high / low < 40 else (1,)
    panel.ax.set_ylim(low, high)
    plain_log(panel.ax, [step * 10.0**power for power in range(-6, 4) for step in steps])


SIDES = ({"color": style.BLACK, "linestyle": "-"}, {"color": style.GREY, "linestyle": "--"})
"""How longitudinal and lateral states are drawn where no filter is meant."""


def draw_information_loss(results: Results) -> Drawing:
    """F18: what differencing loses of the first measurement, without white noise."""
    figure = Drawing(figsize=(style.WIDTH, 3.4))
    for ax, branch in zip(figure.subplots(1, 2, sharey=True), BRANCHES, strict=True):
        loss = results.arrays("theory")[f"{branch}.information-loss"]
        k = np.arange(len(loss))
        for i, state in enumerate(STATES):
            ax.plot(k, loss[:, i], **SIDES[state in LATERAL])
        for height, words in joined_labels(loss[-1], 1.035):
            ax.text(k[-1] + 4, height, words, verticalalignment="center", fontsize=8.5)
        ax.set(yscale="log", ylim=(0.95, 2.4), xlim=(0, k[-1]), xlabel=ITERATION, title=f"{branch} branch")
        plain_log(ax, (1, 1.2, 1.4, 1.6, 1.8, 2, 2.2))
    figure.axes[0].set_ylabel(r"$\sqrt{P_{ii}}$ of BH over AKF (1)")
    lines = [Line2D([], [], **look, label=words) for look, words in zip(SIDES, ("longitudinal", "lateral"), strict=True)]
    headline(figure, r"Information lost with the first measurement, $\sigma_v = 0$", lines)
    return figure


def joined_labels(ends: np.ndarray, factor: float) -> list[tuple[float, str]]:
    """Labels of curves at their right-hand ends; curves that end within `factor` of each other share one."""
    groups: list[list[int]] = []
    for i in np.argsort(-ends, kind="stable"):
        if groups and ends[groups[-1][-1]] / ends[i] < factor:
            groups[-1].append(i)
        else:
            groups.append([i])
    return [(float(np.exp(np.mean(np.log(ends[group])))), ", ".join(SYMBOLS[STATES[i]] for i in group)) for group in groups]
