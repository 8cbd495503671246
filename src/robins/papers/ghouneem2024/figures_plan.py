"""Figures 3 and 9: the median run of each trajectory from above."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D

from robins.papers.ghouneem2024.figures_traces import BACK_TO_FRONT, BASELINE, NEEDS, TRUTH_WIDTH, WIDTHS, kept, median_words, outages
from robins.papers.ghouneem2024.palette import look
from robins.papers.ghouneem2024.panels import LINE, PLACES, family_of, headline, label_of
from robins.papers.ghouneem2024.self_tuning import radii
from robins.papers.ghouneem2024.trajectories import trajectory
from robins.papers.ghouneem2024.variants import NEW
from robins.papers.protocol import Results
from robins.publish import style

__all__ = ["NEEDS", "draw_plan"]

NORTH_EAST = [0, 1]
FRAMED = (BASELINE, NEW)
"""Tracks that are seen as a whole, with the reference; what leaves the frame around them is cut off."""
MARGIN = 0.03
FIX = {"linestyle": "none", "marker": ".", "markersize": 2.2, "color": style.GREY}
REJECTED = {"linestyle": "none", "marker": "x", "markersize": 4, "markeredgewidth": 0.9, "color": style.BLACK}
OUTAGE = {"color": LINE, "linewidth": 6.0, "solid_capstyle": "round"}


def degrees(place: str, position: np.ndarray) -> np.ndarray:
    """Longitude from the origin's, and latitude, both in degrees, of positions ``(K, 2)`` in metres north and east."""
    angle = np.degrees(position / radii(place))
    return np.column_stack([angle[:, 1], np.degrees(trajectory(place).latitude) + angle[:, 0]])


def draw_plan(results: Results, place: str) -> Drawing:
    """Reference, RISS alone, both readings of the EKF, the new method, and the fixes."""
    arrays = results.arrays("traces")
    figure = Drawing(figsize=(style.WIDTH, 6.0))
    ax = figure.subplots()
    time, truth = arrays[f"{place}.time"], degrees(place, arrays[f"{place}.truth"][:, NORTH_EAST])
    for start, end in outages(arrays[f"{place}.fix_time"], time[-1]):
        aside(ax, truth[(time >= start) & (time <= end)], zorder=0.5, **OUTAGE)
    fixes, rejected = degrees(place, arrays[f"{place}.fixes"][:, NORTH_EAST]), arrays[f"{place}.{NEW}.rejected"]
    aside(ax, fixes[~rejected], zorder=1, **FIX)
    aside(ax, fixes[rejected], zorder=1.5, **REJECTED)
    ax.plot(*truth.T, color=style.BLACK, linewidth=TRUTH_WIDTH, zorder=2)
    for name in BACK_TO_FRONT:
        track = degrees(place, kept(arrays, place, name)[:, NORTH_EAST])
        if name in FRAMED:
            ax.plot(*track.T, zorder=3, **line_look(name))
        else:
            aside(ax, track, zorder=3, **line_look(name))
    ax.margins(MARGIN)
    ax.set_aspect(1.0 / np.cos(trajectory(place).latitude), adjustable="datalim")
    ax.set(xlabel="longitude from the origin (deg)", ylabel="latitude (deg)")
    ax.ticklabel_format(useOffset=False)
    headline(figure, f"{PLACES[place]}: {median_words(results, place)}", entries(), columns=4)
    return figure


def aside(ax: Axes, points: np.ndarray, **look_of_line) -> None:
    """Draw a line through `points` (K, 2) that does not widen the axes."""
    ax.add_artist(Line2D(*points.T, **look_of_line))


def line_look(name: str) -> dict:
    """Colour, style and width of a track."""
    return {key: look(family_of(name))[key] for key in ("color", "linestyle")} | {"linewidth": WIDTHS[name]}


def entries() -> list[Line2D]:
    """Legend of the tracks and the fixes."""
    return [
        Line2D([], [], color=style.BLACK, linewidth=TRUTH_WIDTH, label="reference"),
        *(Line2D([], [], label=label_of(name), **line_look(name)) for name in BACK_TO_FRONT),
        Line2D([], [], label="GPS fix", **FIX),
        Line2D([], [], label="fix that New rejects", **REJECTED),
        Line2D([], [], label="outage (reference)", **OUTAGE),
    ]
