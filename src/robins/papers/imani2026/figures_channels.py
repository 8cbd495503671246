"""Figures 7 and 8: estimates and errors of the channels over time, of run 0, with the spread of all runs."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from robins.foundation.rotation import wrapped
from robins.papers.imani2026.comparisons import GROUPS, PAIR
from robins.papers.imani2026.drive import CHANNELS, DURATION
from robins.papers.imani2026.palette import look
from robins.papers.imani2026.panels import TITLES, axis_label, factor, failure_words, headline, line_of
from robins.papers.imani2026.scoring import ANGLES, AVERAGED
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

EKF, PRINTED = "ekf-tuned", "mk-raw"
MKMC, CI = PAIR
FILTERS = (EKF, CI, MKMC)
"""From the back to the front."""
NEEDS = ("drive", *FILTERS, PRINTED)
WIDTHS = {"truth": 0.8, "reference": 1.6, EKF: 0.8, CI: 2.2, MKMC: 1.0}
"""The narrower line is in front, so that both are seen where they coincide."""
NOISY, THINNER = CHANNELS[AVERAGED], 0.6
"""Channels that are drawn once a second and in thinner lines: noise at every epoch would cover everything."""
HALF_TURN = 180.0


def once_a_second(time: np.ndarray) -> slice:
    """The epochs at whole seconds."""
    return slice(None, None, (len(time) - 1) // DURATION)


def plot_channel(ax: Axes, time: np.ndarray, values: np.ndarray, channel: str, **changes) -> None:
    """One series of a channel (SI); angles are wrapped, shown in degrees and not joined where they jump by a turn."""
    if channel in CHANNELS[ANGLES]:
        values = wrapped(values)
    values = values * factor(channel)
    jumps = np.flatnonzero(np.abs(np.diff(values)) > HALF_TURN) + 1 if channel in CHANNELS[ANGLES] else []
    ax.plot(np.insert(time, jumps, np.nan), np.insert(values, jumps, np.nan), **changes)


def series(results: Results, formulation: str) -> dict[str, np.ndarray]:
    """Channels over the epochs (N+1, 12), SI: truth, reference, and run 0 of the filters in which it did not fail."""
    drive = results.arrays("drive")
    found = {"truth": drive["truth"], "reference": drive["reference"]}
    for name in FILTERS:
        arrays = results.arrays(name)
        if not arrays[f"{formulation}.failed"][0]:
            found[name] = arrays[f"{formulation}.estimate0"]
    return found


def look_of(name: str, thinner: float = 1.0) -> dict:
    """How a series is drawn."""
    width = {"linewidth": thinner * WIDTHS[name]}
    if name in VARIANTS:
        return line_of(name, **width)
    words = {"truth": "truth", "reference": "reference (VITANS-like)"}[name]
    return look(name) | width | {"label": words}


ORDER = ("reference", "truth", *FILTERS)


def entries(names: Iterable[str]) -> list[Line2D]:
    """Legend of the series."""
    return [Line2D([], [], **look_of(name)) for name in names]


def title(results: Results, text: str, formulation: str) -> str:
    """Title of a figure, with a line that says which filters failed."""
    words = [failure_words(results, name, formulation) for name in (*FILTERS, PRINTED)]
    failed = "; ".join(text for text in words if text)
    return f"{text} · {TITLES[formulation]}" + (f"\n{failed}" if failed else "")


def draw_estimates(results: Results, group: str, formulation: str) -> Drawing:
    """One of figures 7 a-d: three channels against time."""
    found, time = series(results, formulation), results.arrays("drive")["time"]
    figure = Drawing(figsize=(style.WIDTH, 5.2))
    axes = figure.subplots(3, 1, sharex=True)
    for ax, channel in zip(axes, GROUPS[group], strict=True):
        draw_channel(ax, time, found, channel)
    axes[-1].set(xlabel="time (s)", xlim=(0, DURATION))
    figure.align_ylabels()
    headline(figure, title(results, f"{group[0].upper()}{group[1:]}, run 0", formulation), entries(found), columns=3)
    return figure


def draw_channel(ax: Axes, time: np.ndarray, found: dict[str, np.ndarray], channel: str) -> None:
    """Every series of one channel."""
    noisy = channel in NOISY
    shown = once_a_second(time) if noisy else slice(None)
    for name in ORDER:
        if name in found:
            values = found[name][shown, CHANNELS.index(channel)]
            plot_channel(ax, time[shown], values, channel, **look_of(name, THINNER if noisy else 1.0))
    ax.set_ylabel(axis_label(channel))
    if channel == "yaw":
        ax.set_yticks((-180, -90, 0, 90, 180))


def draw_all_estimates(results: Results, formulation: str) -> Drawing:
    """All twelve channels in small, for a formulation that is not the main one."""
    found, time = series(results, formulation), results.arrays("drive")["time"]
    figure = Drawing(figsize=(style.WIDTH, 7.2))
    axes = figure.subplots(4, 3, sharex=True)
    for ax, channel in zip(axes.flat, CHANNELS, strict=True):
        draw_channel(ax, time, found, channel)
    for ax in axes[-1]:
        ax.set(xlabel="time (s)", xlim=(0, DURATION), xticks=(0, 100, 200, 300))
    figure.align_ylabels()
    headline(figure, title(results, "All channels, run 0", formulation), entries(found), columns=3)
    return figure


def draw_errors(results: Results, group: str, formulation: str) -> Drawing:
    """One of figures 8 a-d: errors of three channels against time, with the central 90 % of all runs of both robust filters."""
    found, time = series(results, formulation), results.arrays("drive")["time"]
    shown = once_a_second(time)
    figure = Drawing(figsize=(style.WIDTH, 5.4))
    axes = figure.subplots(3, 1, sharex=True)
    for ax, channel in zip(axes, GROUPS[group], strict=True):
        i = CHANNELS.index(channel)
        for name in (CI, MKMC):
            draw_band(ax, results.arrays(name)[f"{formulation}.error_quantiles"][..., i], channel, name)
        for name in ("reference", *FILTERS):
            if name in found:
                error = (found[name] - found["truth"])[shown, i]
                plot_channel(ax, time[shown], error, channel, **look_of(name, THINNER if channel in NOISY else 1.0))
        ax.axhline(0, color=style.BLACK, linewidth=0.7, zorder=1)
        ax.set_ylabel(f"error of {axis_label(channel)}")
    axes[-1].set(xlabel="time (s)", xlim=(0, DURATION))
    figure.align_ylabels()
    bands = [Patch(label=f"{VARIANTS[name].label}, 5 % to 95 %", **band_look(name)) for name in (CI, MKMC)]
    handles = [*entries(name for name in found if name != "truth"), *bands]
    words = f"{group[0].upper()}{group[1:]}: estimate − truth, run 0 and the middle of all runs"
    headline(figure, title(results, words, formulation), handles, columns=3)
    return figure


def band_look(name: str) -> dict:
    """A band's fill and edge; the CI-RKF's is filled, the MKMC-EKF's is outlined, so that both are seen where they overlap."""
    color = look(VARIANTS[name].family)["color"]
    if name == CI:
        return {"facecolor": color, "alpha": 0.28, "linewidth": 0}
    return {"facecolor": "none", "edgecolor": color, "linewidth": 0.9}


def draw_band(ax: Axes, quantiles: np.ndarray, channel: str, name: str) -> None:
    """5 % to 95 % of the errors of the surviving runs, shape (3, E); nothing when none survives."""
    low, _, high = quantiles * factor(channel)
    seconds = np.arange(len(low))
    if np.isfinite(low[1:]).all():
        ax.fill_between(seconds[1:], low[1:], high[1:], zorder=2, **band_look(name))
