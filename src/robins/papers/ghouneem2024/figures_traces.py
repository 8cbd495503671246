"""Figures 4 to 8: position, velocity and azimuth of the median run over time, and their errors."""

from collections.abc import Iterable, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from robins.foundation.rotation import wrapped
from robins.navigation.riss import AZIMUTH, EAST, HEIGHT, NORTH, V_EAST, V_NORTH, V_UP
from robins.papers.ghouneem2024.palette import look
from robins.papers.ghouneem2024.panels import PLACES, UNITS, factor, family_of, headline, label_of, panel_title
from robins.papers.ghouneem2024.runs import BOUND
from robins.papers.ghouneem2024.traces import BASELINE
from robins.papers.ghouneem2024.variants import BASELINES, NEW
from robins.papers.protocol import Results
from robins.publish import style

NEEDS = ("traces",)
ALONE = "riss-only"
FILTERS = (BASELINES[1], BASELINE, NEW)
BACK_TO_FRONT = (ALONE, *FILTERS)
WIDTHS = {ALONE: 1.1, BASELINES[1]: 0.8, BASELINE: 1.3, NEW: 1.2}
TRUTH_WIDTH = 0.9
INDEX = {"north": NORTH, "east": EAST, "height": HEIGHT, "v_east": V_EAST, "v_north": V_NORTH, "v_up": V_UP, "azimuth": AZIMUTH}
"""Where a channel stands in the arrays of the study."""
WORDS = {"north": "latitude", "east": "longitude", "height": "altitude", "v_east": "$V^e$", "v_north": "$V^n$", "v_up": "$V^{up}$",
         "azimuth": "azimuth"}  # fmt: skip
POSITIONS, VELOCITIES = ("north", "east", "height"), ("v_east", "v_north", "v_up")
GAP = 1.5
"""Seconds without a fix that are an outage."""
AROUND = 30.0
"""Seconds before and after the longest outage that the enlarged panels show."""
BANDED = (BASELINE, NEW)
TURN = 360.0


def kept(arrays: Mapping[str, np.ndarray], place: str, name: str) -> np.ndarray:
    """Estimates of a filter (E, 7); NaN from the second on in which it has failed."""
    estimate = arrays[f"{place}.{name}.estimate"].copy()
    beyond = ~(np.abs(estimate - arrays[f"{place}.truth"])[:, :2].max(axis=1) <= BOUND)
    if beyond.any():
        estimate[np.argmax(beyond) :] = np.nan
    return estimate


def median_words(results: Results, place: str) -> str:
    """Which run is shown, and by what rule."""
    row = results.table("traces").set_index("trajectory").loc[place]
    if not np.isfinite(row["ratio"]):
        return f"run {row['run']:.0f}; no run survives in both filters"
    return f"run {row['run']:.0f}, the median of horizontal New/EKF (incremental): {row['ratio']:.2f}"


def outages(fix_time: np.ndarray, end: float) -> np.ndarray:
    """First and last second of every stretch without fixes, shape (K, 2)."""
    known = np.r_[0.0, fix_time, end]
    gaps = np.flatnonzero(np.diff(known) > GAP)
    return np.column_stack([known[gaps], known[gaps + 1]])


def longest_outage(arrays: Mapping[str, np.ndarray], place: str) -> tuple[float, float]:
    """Window around the longest outage; the whole run where there is none."""
    end = arrays[f"{place}.time"][-1]
    gaps = outages(arrays[f"{place}.fix_time"], end)
    if not len(gaps):
        return 0.0, end
    start, stop = gaps[np.argmax(gaps[:, 1] - gaps[:, 0])]
    return max(0.0, start - AROUND), min(end, stop + AROUND)


def line_look(name: str, **changes) -> dict:
    """Colour, style, width and label of a filter's line."""
    kept_look = {key: look(family_of(name))[key] for key in ("color", "linestyle")}
    return kept_look | {"linewidth": WIDTHS[name], "label": label_of(name)} | changes


REFERENCE = {"color": style.BLACK, "linewidth": TRUTH_WIDTH, "label": "reference"}
SHADE = Patch(facecolor="#000000", alpha=0.07, linewidth=0, label="outage")


def band_look(name: str) -> dict:
    """The new method's band is filled, the EKF's outlined, so that both are seen where they overlap."""
    color = look(family_of(name))["color"]
    filled = {"facecolor": color, "alpha": 0.25, "linewidth": 0}
    return filled if name == NEW else {"facecolor": "none", "edgecolor": color, "linewidth": 0.6, "linestyle": ":"}


def bands() -> list[Patch]:
    """Legend of the bands."""
    return [Patch(label=f"±3σ, {'New' if name == NEW else 'EKF, incremental'}", **band_look(name)) for name in BANDED]


def lines(names: Iterable[str]) -> list[Line2D]:
    """Legend of the filters."""
    return [Line2D([], [], **line_look(name)) for name in names]


def shade(axes: Iterable[Axes], arrays: Mapping[str, np.ndarray], place: str) -> None:
    """Shade the outages."""
    for start, end in outages(arrays[f"{place}.fix_time"], arrays[f"{place}.time"][-1]):
        for ax in axes:
            style.shade_window(ax, start, end)


def draw_errors(results: Results, place: str, channels: tuple[str, ...], what: str) -> Drawing:
    """Figures 4 and 6: errors of three channels with three standard deviations; RISS alone on axes of its own."""
    arrays = results.arrays("traces")
    figure = Drawing(figsize=(style.WIDTH, 6.2))
    axes = figure.subplots(3, 2, sharex="col", width_ratios=(2.3, 1))
    for (wide, narrow), channel in zip(axes, channels, strict=True):
        i, time, truth = INDEX[channel], arrays[f"{place}.time"], arrays[f"{place}.truth"]
        for name in FILTERS:
            wide.plot(time, kept(arrays, place, name)[:, i] - truth[:, i], **line_look(name))
        view = wide.get_ylim()
        for name in BANDED:
            draw_band(wide, time, arrays[f"{place}.{name}.deviation"][:, i], name)
        wide.set_ylim(view)
        narrow.plot(time, kept(arrays, place, ALONE)[:, i] - truth[:, i], **line_look(ALONE))
        wide.set_ylabel(f"{WORDS[channel]} error ({UNITS[channel]})")
        shade((wide, narrow), arrays, place)
    end = arrays[f"{place}.time"][-1]
    axes[-1, 0].set_xlim(0, end)
    axes[-1, 1].set(xlim=(0, end), xticks=(0, end / 2, end))
    panel_title(axes[0, 0], "with GPS")
    panel_title(axes[0, 1], "RISS only, own scale")
    figure.supxlabel("time (s)", fontsize=8.5)
    figure.align_ylabels()
    headline(figure, f"{PLACES[place]}, {what}: {median_words(results, place)}", [*lines(BACK_TO_FRONT), *bands(), SHADE], columns=4)
    return figure


def draw_band(ax: Axes, time: np.ndarray, deviation: np.ndarray, name: str) -> None:
    """Three standard deviations of a filter on both sides of zero."""
    ax.fill_between(time, -3.0 * deviation, 3.0 * deviation, zorder=1.5, **band_look(name))


def draw_velocities(results: Results, place: str) -> Drawing:
    """Figure 5: velocities with the reference, over the run and around its longest outage."""
    arrays = results.arrays("traces")
    figure = Drawing(figsize=(style.WIDTH, 5.8))
    axes = figure.subplots(3, 2, sharex="col", sharey="row", width_ratios=(1.5, 1))
    for row, channel in zip(axes, VELOCITIES, strict=True):
        i, time = INDEX[channel], arrays[f"{place}.time"]
        for ax in row:
            for name in BACK_TO_FRONT:
                ax.plot(time, kept(arrays, place, name)[:, i], **line_look(name))
            ax.plot(time, arrays[f"{place}.truth"][:, i], zorder=2.5, **REFERENCE)
        row[0].set_ylabel(f"{WORDS[channel]} ({UNITS[channel]})")
    finish_pair(figure, axes, results, place, "velocities")
    return figure


def finish_pair(figure: Drawing, axes: np.ndarray, results: Results, place: str, what: str) -> None:
    """Outages, windows, titles and legend of a figure with the whole run at the left and the longest outage at the right."""
    arrays = results.arrays("traces")
    shade(list(axes.flat), arrays, place)  # every outage goes over all axes: an iterator would serve the first alone
    axes[-1, 0].set_xlim(0, arrays[f"{place}.time"][-1])
    axes[-1, 1].set_xlim(*longest_outage(arrays, place))
    panel_title(axes[0, 0], "whole run")
    panel_title(axes[0, 1], "around the longest outage")
    figure.supxlabel("time (s)", fontsize=8.5)
    figure.align_ylabels()
    legend = [Line2D([], [], **REFERENCE), *lines(BACK_TO_FRONT), SHADE]
    headline(figure, f"{PLACES[place]}, {what}: {median_words(results, place)}", legend)


def unjoined(time: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A series of degrees that is not joined where it jumps by more than half a turn."""
    jumps = np.flatnonzero(np.abs(np.diff(angle)) > TURN / 2) + 1
    return np.insert(time, jumps, np.nan), np.insert(angle, jumps, np.nan)


def compass(azimuth: np.ndarray) -> np.ndarray:
    """Radians as degrees in [0, 360)."""
    return np.degrees(azimuth) % TURN


def draw_azimuth(results: Results, place: str) -> Drawing:
    """Figure 7: azimuth in [0, 360) with the reference, over the run and around its longest outage."""
    arrays = results.arrays("traces")
    figure = Drawing(figsize=(style.WIDTH, 3.6))
    axes = figure.subplots(1, 2, sharey=True, squeeze=False, width_ratios=(1.5, 1))
    time = arrays[f"{place}.time"]
    for ax in axes.flat:
        for name in BACK_TO_FRONT:
            ax.plot(*unjoined(time, compass(kept(arrays, place, name)[:, AZIMUTH])), **line_look(name))
        ax.plot(*unjoined(time, compass(arrays[f"{place}.truth"][:, AZIMUTH])), zorder=2.5, **REFERENCE)
    axes[0, 0].set(ylabel="azimuth (deg)", ylim=(0, TURN), yticks=range(0, 361, 90))
    finish_pair(figure, axes, results, place, "azimuth")
    return figure


def draw_azimuth_errors(results: Results, place: str) -> Drawing:
    """Figure 8: the wrapped azimuth error with three standard deviations, that of RISS alone, and the difference without wrapping."""
    arrays = results.arrays("traces")
    figure = Drawing(figsize=(style.WIDTH, 5.8))
    axes = figure.subplots(3, 1, sharex=True, height_ratios=(1.5, 1, 1))
    time, truth = arrays[f"{place}.time"], arrays[f"{place}.truth"][:, AZIMUTH]
    estimates = {name: kept(arrays, place, name)[:, AZIMUTH] for name in BACK_TO_FRONT}
    for ax, names in zip(axes, (FILTERS, (ALONE,)), strict=False):
        for name in names:
            ax.plot(*unjoined(time, np.degrees(wrapped(estimates[name] - truth))), **line_look(name))
    view = axes[0].get_ylim()
    for name in BANDED:
        draw_band(axes[0], time, factor("azimuth") * arrays[f"{place}.{name}.deviation"][:, AZIMUTH], name)
    axes[0].set_ylim(view)
    for name in BACK_TO_FRONT:
        axes[2].plot(time, compass(estimates[name]) - compass(truth), **line_look(name, alpha=0.6, linewidth=0.7))
    axes[2].set(ylim=(-1.05 * TURN, 1.05 * TURN), yticks=(-360, -180, 0, 180, 360))
    for ax, words in zip(
        axes, ("with GPS, wrapped", "RISS only, wrapped, own scale", "both in [0, 360), difference not wrapped"), strict=True
    ):
        panel_title(ax, words)
        ax.set_ylabel("error (deg)")
    shade(axes, arrays, place)
    axes[-1].set(xlabel="time (s)", xlim=(0, time[-1]))
    figure.align_ylabels()
    headline(figure, f"{PLACES[place]}, azimuth error: {median_words(results, place)}", [*lines(BACK_TO_FRONT), *bands(), SHADE], columns=4)
    return figure
