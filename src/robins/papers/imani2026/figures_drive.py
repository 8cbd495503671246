"""Figure 5: the drive, from above and over time."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from robins.papers.imani2026.drive import DURATION
from robins.papers.imani2026.palette import look
from robins.papers.imani2026.panels import headline
from robins.papers.protocol import Results
from robins.publish import style

PLACES = {"P1": (-3, -13, "right"), "P2": (7, -3, "left"), "P3": (-9, 3, "right"), "P4": (4, -13, "left"), "P5": (8, -5, "left"),
          "P6": (4, 7, "left")}  # fmt: skip
"""Where a way point's name stands beside it: offset in points, and the side of the text that is next to the point."""
HEADS = (35.0, 80.0, 145.0, 205.0, 258.0, 295.0)
"""Times of the arrow heads that tell which way the car goes [s], one on each leg."""


def draw_drive(results: Results) -> Drawing:
    """Plan view with the way points; height and speed against time."""
    arrays = results.arrays("drive")
    figure = Drawing(figsize=(style.WIDTH, 4.5))
    axes = figure.subplot_mosaic([["plan", "height"], ["plan", "speed"]], width_ratios=(1.15, 1))
    draw_plan(axes["plan"], arrays)
    time, true, seen = arrays["time"], look("truth"), look("reference")
    axes["height"].plot(time, arrays["reference_position"][:, 2], color=seen["color"], linewidth=0.8)
    axes["height"].plot(time, arrays["position"][:, 2], color=true["color"], linewidth=1.2)
    axes["height"].set(ylabel="height above P1 (m)")
    axes["speed"].plot(time, arrays["speed"], color=true["color"], linewidth=1.2)
    axes["speed"].set(ylabel="speed (m/s)", ylim=(0, None))
    for name in ("height", "speed"):
        mark_times(axes[name], arrays["way_point_times"])
    handles = [axes["height"].lines[1], axes["height"].lines[0]]
    for handle, words in zip(handles, ("truth", "reference (VITANS-like), with its own errors"), strict=True):
        handle.set_label(words)
    headline(figure, "The drive through the campus, way points P1 to P6", handles)
    return figure


def draw_plan(ax: Axes, arrays) -> None:
    """East and north to one scale, with the way points and the direction of travel."""
    path, time = arrays["position"], arrays["time"]
    ax.plot(*arrays["reference_position"][:, :2].T, color=look("reference")["color"], linewidth=0.8)
    ax.plot(*path[:, :2].T, color=look("truth")["color"], linewidth=1.2)
    for at in HEADS:
        k = int(abs(time - at).argmin())
        head = {"arrowstyle": "-|>", "color": style.BLACK, "mutation_scale": 11, "linewidth": 0}
        ax.annotate("", path[k + 5, :2], path[k - 5, :2], arrowprops=head)
    for (name, (x, y, side)), point in zip(PLACES.items(), arrays["way_points"], strict=True):
        ax.plot(*point[:2], color=style.BLACK, marker="o", markersize=5.5, markerfacecolor="white", markeredgecolor=style.BLACK, zorder=4)
        ax.annotate(name, point[:2], (x, y), textcoords="offset points", horizontalalignment=side, fontsize=9, fontweight="bold")
    ax.set_aspect("equal", adjustable="datalim")
    ax.set(xlabel="east (m)", ylabel="north (m)")


def mark_times(ax: Axes, times) -> None:
    """Lines at the way points, their names above, and the axis of time."""
    for name, time in zip(PLACES, times, strict=True):
        ax.axvline(time, color=style.GREY, linewidth=0.7, linestyle=(0, (2, 2)), zorder=1)
        ax.text(time, 1.02, name, transform=ax.get_xaxis_transform(), horizontalalignment="center", fontsize=8)
    ax.set(xlabel="time (s)", xlim=(0, DURATION))
