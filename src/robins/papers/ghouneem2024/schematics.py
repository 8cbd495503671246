"""Figures 1 and 2 as drawings of our own: the baseline's closed loop, and the new method with the places where it needs the truth.

Nothing is copied from the paper. Each drawing is one column (85 mm) wide, in letters of 7 points or more at that width.
Coordinates are inches from the lower left corner. Fills and heavy lines say what matters, so that grey prints say it too: light grey
is measured, white on black is made with the truth.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Circle, FancyBboxPatch, Rectangle

from robins.papers.protocol import Results
from robins.publish import style

COLUMN = 85 / 25.4  # inches
SMALL, NORMAL = 7.0, 7.5  # points
LIGHT, FAINT = "#D9D9D9", "#F2F2F2"
TRUTH = "truth used here"
"""What the mark of figure 2 says."""


def canvas(height: float) -> tuple[Drawing, Axes]:
    """A drawing one column wide and `height` inches high; data coordinates are inches."""
    figure = Drawing(figsize=(COLUMN, height), layout="none")
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, COLUMN), ylim=(0, height))
    ax.axis("off")
    return figure, ax


def words(ax: Axes, x: float, y: float, text: str, **changes) -> None:
    """A text centred at (x, y)."""
    look = {"horizontalalignment": "center", "verticalalignment": "center", "fontsize": NORMAL, "linespacing": 1.3, "zorder": 5}
    ax.text(x, y, text, **look | changes)


def block(ax: Axes, centre, size, text: str, fill: str = "white", width: float = 0.8, **changes) -> None:
    """A box of `size` (width, height) around `centre` with a text in it."""
    corner = (centre[0] - size[0] / 2 + 0.03, centre[1] - size[1] / 2 + 0.03)
    look = {"boxstyle": "round,pad=0.03,rounding_size=0.04", "facecolor": fill, "edgecolor": style.BLACK, "linewidth": width, "zorder": 3}
    ax.add_patch(FancyBboxPatch(corner, size[0] - 0.06, size[1] - 0.06, **look))
    words(ax, *centre, text, **changes)


def tag(ax: Axes, centre, size, text: str) -> None:
    """What is made with the truth: white on black."""
    block(ax, centre, size, text, fill=style.BLACK, color="white", fontweight="bold")


def arrow(ax: Axes, *points, width: float = 0.9, dashed: bool = False) -> None:
    """A line through `points` with a head at the last."""
    *before, start, end = points
    dash = (0, (3, 1.5)) if dashed else "-"
    if before:
        ax.plot(*np.array([*before, start]).T, color=style.BLACK, linewidth=width, linestyle=dash, solid_joinstyle="miter", zorder=2)
    look = {
        "arrowstyle": "-|>",
        "color": style.BLACK,
        "linewidth": width,
        "linestyle": dash,
        "mutation_scale": 7,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    ax.annotate("", end, start, arrowprops=look, zorder=2)


def draw_baseline(results: Results) -> Drawing:
    """Figure 1: sensors, mechanisation, error-state EKF, and the feedback that the paper leaves open."""
    figure, ax = canvas(3.0)
    top, middle, low = 2.55, 1.4, 0.38
    block(ax, (0.55, top), (0.98, 0.76), "accelerometers $f$,\ngyro $\\omega^z$,\nodometer $V^{od}$", fill=LIGHT, fontsize=SMALL)
    block(ax, (1.87, top), (1.22, 0.76), "RISS (1):\npitch, roll, azimuth,\nvelocity, position")
    arrow(ax, (1.04, top), (1.26, top))
    arrow(ax, (2.48, top), (3.27, top))
    words(ax, 2.87, top + 0.2, "navigation\nstate", fontsize=SMALL)
    block(ax, (1.33, middle), (2.1, 0.66), "error-state EKF, model (2)–(6):\npredict (7), (8), $\\Phi=I+F\\Delta t$\n"
          "correct (9)–(11)", fontsize=SMALL)  # fmt: skip
    draw_difference(ax, (2.87, middle), top, low)
    arrow(ax, (2.16, top - 0.38), (2.16, middle + 0.33), dashed=True)
    words(ax, 2.45, 1.97, "$A,p,r,a^{od}$", fontsize=SMALL)
    arrow(ax, (1.5, middle + 0.33), (1.5, top - 0.38), width=2.2)
    words(ax, 0.98, 1.97, "feedback of\nthe errors", fontsize=SMALL)
    block(ax, (1.16, low), (2.16, 0.6), "and the velocity? The paper does not say.\nEKF-Pi: its correction persists\n"
          "EKF-Pm: the odometer overwrites it", fill=FAINT, fontsize=SMALL)  # fmt: skip
    ax.plot([0.16, 0.16, 0.6], [low + 0.3, 1.97, 1.97], color=style.BLACK, linewidth=0.9, linestyle=":", zorder=1)
    return figure


def draw_difference(ax: Axes, centre, top: float, low: float) -> None:
    """State and fix meet in a circle; their difference goes to the filter at the left."""
    x, y = centre
    ax.add_patch(Circle(centre, 0.11, facecolor="white", edgecolor=style.BLACK, linewidth=0.9, zorder=4))
    words(ax, x, y, "$-$", fontsize=9)
    arrow(ax, (x, top), (x, y + 0.11))
    arrow(ax, (x - 0.11, y), (2.38, y))
    words(ax, 2.56, y + 0.12, "$Z$", fontsize=SMALL)
    block(ax, (2.83, low), (0.9, 0.6), "GPS, 1 Hz:\nposition,\nvelocity, $R$", fill=LIGHT, fontsize=SMALL)
    arrow(ax, (x, low + 0.3), (x, y - 0.11))


def draw_new_method(results: Results) -> Drawing:
    """Figure 2: self-tuning, then the loop of sigma points, prediction, gate and correction; black is what needs the truth."""
    figure, ax = canvas(4.75)
    draw_self_tuning(ax, 4.1)
    draw_cycle(ax)
    return figure


def draw_self_tuning(ax: Axes, y: float) -> None:
    """The part that needs a reference unit, before the filter runs."""
    frame = {"facecolor": FAINT, "edgecolor": style.BLACK, "linewidth": 1.4, "linestyle": (0, (4, 1.5)), "zorder": 1}
    ax.add_patch(Rectangle((0.06, y - 0.5), COLUMN - 0.12, 1.05, **frame))
    tag(ax, (0.66, y + 0.38), (1.04, 0.22), TRUTH)
    words(ax, 2.25, y + 0.38, "self-tuning, before the drive", fontsize=SMALL)
    block(ax, (0.5, y - 0.12), (0.72, 0.46), "reference\nunit $S_{ref}$", fill=LIGHT)
    block(ax, (1.62, y - 0.12), (1.0, 0.6), "means of\n$S_{ref}-S_{RISS}$ (12),\n$S_{ref}-S_{RISS/GPS}$ (13)", fontsize=SMALL)
    block(ax, (2.8, y - 0.12), (0.84, 0.6), "then by hand:\n$Q$, $P_0$,\nthresholds", fontsize=SMALL)
    arrow(ax, (0.86, y - 0.12), (1.12, y - 0.12), width=2.2)
    arrow(ax, (2.12, y - 0.12), (2.38, y - 0.12))


def draw_cycle(ax: Axes) -> None:
    """One epoch from top to bottom, inputs at the left, what was tuned at the right, the next epoch around the right edge."""
    x, half, edge = 1.74, 0.68, 3.26
    points, prediction, gate, correction = 2.95, 2.25, 1.5, 0.7
    block(ax, (x, points), (2 * half, 0.42), "sigma points\n(14)–(21)")
    block(ax, (x, prediction), (2 * half, 0.42), "predict through (1):\n(22), (23)")
    block(ax, (x, gate), (2 * half, 0.5), "GPS integrity (24):\nboth differences small?", width=1.6)
    block(ax, (x, correction), (2 * half, 0.42), "correct\n(25)–(31)")
    for above, below in ((points, prediction), (prediction, gate + 0.04), (gate - 0.04, correction)):
        arrow(ax, (x, above - 0.21), (x, below + 0.21))
    words(ax, x + 0.2, 1.08, "yes", fontsize=SMALL)
    block(ax, (0.42, prediction), (0.72, 0.42), "$f$, $\\omega^z$, $V^{od}$\n20 Hz", fill=LIGHT)
    block(ax, (0.42, gate), (0.72, 0.42), "GPS fix\n1 Hz", fill=LIGHT)
    arrow(ax, (0.78, prediction), (x - half, prediction))
    arrow(ax, (0.78, gate), (x - half, gate))
    arrow(ax, (0.42, gate - 0.21), (0.42, correction), (x - half, correction))
    words(ax, 0.72, correction + 0.11, "$Z$, $R$", fontsize=SMALL)
    for y, text in ((points, "$P_0$"), (prediction, "$Q$"), (gate + 0.1, "$TH$")):
        tag(ax, (2.85, y), (0.36, 0.24), text)
        arrow(ax, (2.67, y), (x + half, y))
    arrow(ax, (x + half, gate - 0.15), (edge, gate - 0.15))
    words(ax, 2.84, gate - 0.25, "no: rejected", fontsize=SMALL)
    arrow(ax, (x, correction - 0.21), (x, 0.28), (edge, 0.28), (edge, 3.4), (x, 3.4), (x, points + 0.21))
    words(ax, 2.6, 0.17, "next epoch", fontsize=SMALL)
    words(ax, x - 0.22, 0.37, "$\\hat{X}$, $P$", fontsize=SMALL)
