"""Figures 1-4 as drawings of our own: the two sensors' principles, the loop of the filter, and the vehicle's axes.

Nothing is copied from the paper. Each drawing is one column (85 mm) wide, in letters of 7 points or more at that width.
Coordinates are inches from the lower left corner. Heavy lines and fills say what matters, so that grey prints say it too.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Arc, Circle, FancyBboxPatch, Rectangle

from robins.papers.protocol import Results
from robins.publish import style

COLUMN = 85 / 25.4  # inches
SMALL, NORMAL = 7.0, 7.5  # points
LIGHT, FAINT = "#D9D9D9", "#F2F2F2"


def canvas(height: float) -> tuple[Drawing, Axes]:
    """A drawing one column wide and `height` inches high; data coordinates are inches."""
    figure = Drawing(figsize=(COLUMN, height), layout="none")
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, COLUMN), ylim=(0, height))
    ax.axis("off")
    return figure, ax


def words(ax: Axes, x: float, y: float, text: str, **changes) -> None:
    """A text centred at (x, y)."""
    look = {"horizontalalignment": "center", "verticalalignment": "center", "fontsize": NORMAL, "linespacing": 1.15, "zorder": 5}
    ax.text(x, y, text, **look | changes)


def block(ax: Axes, centre, size, text: str, fill: str = "white", edge: str = style.BLACK, width: float = 0.8, **changes) -> None:
    """A box of `size` (width, height) around `centre` with a text in it."""
    corner = (centre[0] - size[0] / 2 + 0.03, centre[1] - size[1] / 2 + 0.03)
    look = {"boxstyle": "round,pad=0.03,rounding_size=0.04", "facecolor": fill, "edgecolor": edge, "linewidth": width, "zorder": 3}
    ax.add_patch(FancyBboxPatch(corner, size[0] - 0.06, size[1] - 0.06, **look))
    words(ax, *centre, text, **changes)


def arrow(ax: Axes, *points, color: str = style.BLACK, width: float = 0.9, dashed: bool = False, zorder: float = 2) -> None:
    """A line through `points` with a head at the last."""
    *before, start, end = points
    dash = (0, (3, 1.5)) if dashed else "-"
    if before:
        ax.plot(*np.array([*before, start]).T, color=color, linewidth=width, linestyle=dash, solid_joinstyle="miter", zorder=zorder)
    look = {"arrowstyle": "-|>", "color": color, "linewidth": width, "linestyle": dash, "mutation_scale": 7, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", end, start, arrowprops=look, zorder=zorder)


def draw_gyroscope(results: Results) -> Drawing:
    """Figure 1: spins in a vapour cell; the frequency of their precession about the bias field tells the rotation."""
    figure, ax = canvas(2.72)
    x, y = 1.5, 1.26
    draw_cell(ax, x, y)
    block(ax, (0.32, y), (0.52, 0.38), "pump\nlaser")
    arrow(ax, (0.58, y), (x - 0.33, y), color=style.VERMILLION, width=2.4)
    ax.add_patch(Rectangle((0.76, y - 0.17), 0.07, 0.34, facecolor=LIGHT, edgecolor=style.BLACK, linewidth=0.6, zorder=4))
    words(ax, 0.795, y - 0.28, r"$\lambda/4$", fontsize=SMALL)
    block(ax, (x, 0.18), (0.8, 0.24), "probe laser")
    arrow(ax, (x, 0.3), (x, y - 0.33), color=style.BLUE, width=1.4, dashed=True)
    arrow(ax, (x, y + 0.33), (x, 2.34), color=style.BLUE, width=1.4, dashed=True)
    block(ax, (x, 2.52), (1.3, 0.34), "polarisation analyser,\nbalanced detector", fontsize=SMALL)
    block(ax, (2.83, 2.52), (0.84, 0.34), "phase-locked\nloop", fontsize=SMALL)
    arrow(ax, (x + 0.65, 2.52), (2.41, 2.52))
    arrow(ax, (2.6, 2.35), (2.6, 1.93), (x + 0.24, 1.93), (x + 0.24, y + 0.33), color=style.GREY, width=1.2)
    words(ax, 2.2, 2.03, "drive $B_1\\cos\\omega t$", fontsize=SMALL, color="#505050")
    arrow(ax, (3.05, 2.35), (3.05, 1.87))
    words(ax, 2.88, 1.74, r"$\omega=\gamma B_0-\Omega$")
    arrow(ax, (x + 0.33, y), (3.1, y), width=1.6)
    words(ax, 2.33, y + 0.11, "bias field $B_0$")
    ax.add_patch(Arc((2.93, y), 0.14, 0.4, theta1=20, theta2=320, color=style.BLACK, linewidth=1.1, zorder=4))
    arrow(ax, (2.94, y - 0.2), (2.985, y - 0.13), width=1.1)
    words(ax, 2.68, y - 0.34, "rotation $\\Omega$ of the\ncase about $B_0$", fontsize=SMALL)
    return figure


def draw_cell(ax: Axes, x: float, y: float) -> None:
    """The cell between two field coils, with a spin that precesses about the horizontal axis."""
    for side in (-0.5, 0.5):
        ax.add_patch(Rectangle((x + side - 0.04, y - 0.52), 0.08, 0.2, facecolor=style.GREY, edgecolor=style.BLACK, linewidth=0.6))
        ax.add_patch(Rectangle((x + side - 0.04, y + 0.32), 0.08, 0.2, facecolor=style.GREY, edgecolor=style.BLACK, linewidth=0.6))
    words(ax, x - 0.56, y + 0.63, "coils of $B_0$", fontsize=SMALL)
    block(ax, (x, y), (0.66, 0.66), "", fill=FAINT)
    arrow(ax, (x - 0.2, y), (x + 0.15, y + 0.2), width=1.6, zorder=6)
    ax.add_patch(Arc((x + 0.14, y), 0.12, 0.4, color=style.BLACK, linewidth=0.7, linestyle=(0, (2, 1.2)), zorder=4))
    words(ax, x - 0.12, y + 0.18, "$M$")
    words(ax, x - 0.11, y - 0.22, "Rb, Xe", fontsize=SMALL)


def paths(acceleration: float, points: int = 41) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Heights of the two arms of a pi/2-pi-pi/2 interferometer at times 0..2 (unit: T); recoil velocity 1, units of length with it.

    Returns
    -------
    time, upper, lower : ndarray, shape (points,)
        The upper arm is kicked by the first pulse and stopped by the second; the lower one is kicked by the second.
    """
    time = np.linspace(0, 2, points)
    fallen = acceleration * time**2 / 2
    return time, np.minimum(time, 1.0) + fallen, np.maximum(time - 1.0, 0.0) + fallen


def draw_interferometer(results: Results) -> Drawing:
    """Figure 2: height over time of the two arms, without and with an acceleration, and the phase at each pulse."""
    figure, ax = canvas(2.85)
    left, bottom, length, height = 0.5, 0.97, 1.2, 1.0
    place = {"x": lambda time: left + length * time, "y": lambda z: bottom + height * z}
    for time, name in enumerate((r"$\pi/2$", r"$\pi$", r"$\pi/2$")):
        ax.add_patch(Rectangle((place["x"](time) - 0.035, 0.75), 0.07, 1.68, facecolor=LIGHT, edgecolor="none", zorder=0))
        words(ax, place["x"](time), 2.71, name, fontsize=9)
        words(ax, place["x"](time), 2.53, rf"$\phi_{time + 1}$", fontsize=NORMAL)
    draw_arms(ax, place)
    for time, tick in enumerate(("0", "$T$", "$2T$")):
        words(ax, place["x"](time), 0.65, tick)
    arrow(ax, (0.3, 0.75), (3.25, 0.75))
    arrow(ax, (0.3, 0.75), (0.3, 2.35))
    words(ax, 3.17, 0.65, "time", fontsize=SMALL)
    words(ax, 0.16, 1.55, "height along the light", fontsize=SMALL, rotation=90)
    phase = r"$\Delta\Phi=\phi_1-\phi_2^{\mathrm{up}}-\phi_2^{\mathrm{low}}+\phi_3$"
    words(ax, COLUMN / 2, 0.41, phase, fontsize=8)
    words(ax, COLUMN / 2, 0.15, r"$=k_{\mathrm{eff}}\,a\,T^2=\frac{1}{4}\,k_{\mathrm{eff}}\,a\,(2T)^2$", fontsize=8)
    return figure


def draw_arms(ax: Axes, place) -> None:
    """The arms in free fall relative to the light, and as dashed lines what they were without acceleration."""
    for acceleration, look in ((0.0, {"linestyle": (0, (3, 2)), "color": style.GREY, "linewidth": 0.8}), (-0.22, {"color": style.BLACK})):
        time, upper, lower = paths(acceleration)
        for arm, kicked in ((upper, time <= 1.0), (lower, time >= 1.0)):
            for part in (kicked, ~kicked | (time == 1.0)):
                heavy = {"linewidth": 2.2 if part is kicked else 1.0} if acceleration else {}
                ax.plot(place["x"](time[part]), place["y"](arm[part]), zorder=3, **look | heavy)
    words(ax, 0.9, 1.87, "$p+\\hbar k_{\\mathrm{eff}}$", fontsize=SMALL)
    words(ax, 2.05, 1.68, "$p$", fontsize=SMALL)
    words(ax, 2.3, 2.07, "$a=0$", fontsize=SMALL, color="#505050")
    words(ax, 2.5, 1.2, "$a\\neq 0$", fontsize=SMALL)


def draw_loop(results: Results) -> Drawing:
    """Figure 3: the filter's loop in two formulations, with the way of the sample as heavy lines."""
    figure, ax = canvas(4.55)
    draw_formulation(ax, 2.32, augmented=False)
    draw_formulation(ax, 0.0, augmented=True)
    ax.plot([0.08, COLUMN - 0.08], [2.26, 2.26], color=LIGHT, linewidth=0.8)
    return figure


def draw_formulation(ax: Axes, base: float, augmented: bool) -> None:
    """One panel: the sample enters the update alone (F1, `augmented`) or the prediction too (F0)."""
    title = "F1, augmented: the sample is used once" if augmented else "F0, quasi-static: the sample is used twice"
    words(ax, 0.08, base + 2.08, title, fontsize=8, fontweight="bold", horizontalalignment="left")
    low, high, update = base + 0.68, base + 1.45, base + 0.91
    block(ax, (0.43, low), (0.72, 0.46), "atomic IMU,\nsample $z_k$", fill=LIGHT)
    block(ax, (1.66, low), (0.98, 0.46), "innovation\n$y=z_k-h(\\hat{x}_k^-)$", linespacing=1.5)
    block(ax, (2.85, low), (0.8, 0.46), "weights $w(y)$,\nupdate")
    if augmented:
        block(ax, (1.53, high), (1.36, 0.46), "prediction, no input,\n$\\dot{x}_f=-x_f/\\tau$, same for $x_\\omega$", linespacing=1.3)
    else:
        block(ax, (1.53, high), (1.0, 0.46), "prediction\n$f(\\hat{x}_{k-1},u_k)$", linespacing=1.3)
    arrow(ax, (0.79, low), (1.17, low), width=2.2)
    words(ax, 0.97, low + 0.13, "as $z_k$", fontsize=SMALL)
    if not augmented:
        arrow(ax, (0.43, update), (0.43, high), (1.03, high), width=2.2)
        words(ax, 0.72, high + 0.13, "as $u_k$", fontsize=SMALL)
    arrow(ax, (1.5, high - 0.23), (1.5, update))
    words(ax, 1.8, (high - 0.23 + update) / 2, "$h(\\hat{x}_k^-)$", fontsize=SMALL)
    arrow(ax, (2.21 if augmented else 2.03, high), (2.7, high), (2.7, update))
    words(ax, 2.5, high + 0.13, "$\\hat{x}_k^-,P_k^-$", fontsize=SMALL)
    arrow(ax, (2.15, low), (2.45, low))
    words(ax, 2.3, low + 0.1, "$y$", fontsize=SMALL)
    arrow(ax, (3.08, update), (3.08, base + 1.87), (1.53, base + 1.87), (1.53, high + 0.23), color=style.GREY)
    words(ax, 2.4, base + 1.79, "next epoch", fontsize=SMALL, color="#505050")
    arrow(ax, (2.85, low - 0.23), (2.85, base + 0.2), (2.62, base + 0.2))
    states = r"\hat{r},\hat{v},\hat{q},\hat{b}_a,\hat{b}_g" + (r",\hat{x}_f,\hat{x}_\omega" if augmented else "")
    said = f"states: ${states}" + (r"$" if augmented else r"$; $a$ and $\omega$ from $z_k-\hat{b}$")
    words(ax, 2.56, base + 0.2, said, fontsize=SMALL, horizontalalignment="right")


def draw_layout(results: Results) -> Drawing:
    """Figure 4: a vehicle from above with what it carries, and the two sets of axes; no position is to scale."""
    figure, ax = canvas(2.9)
    outline = {"boxstyle": "round,pad=0.0,rounding_size=0.22", "facecolor": "white", "edgecolor": style.BLACK, "linewidth": 1.2}
    ax.add_patch(FancyBboxPatch((0.1, 1.4), 3.12, 1.42, **outline))
    words(ax, 3.08, 2.3, "front", fontsize=SMALL, rotation=-90)
    frame = {"facecolor": FAINT, "edgecolor": style.BLACK, "linewidth": 0.7, "linestyle": (0, (4, 1.5)), "zorder": 1}
    ax.add_patch(Rectangle((0.24, 1.94), 2.74, 0.78, **frame))
    words(ax, 0.3, 2.63, "frame on the roof", fontsize=SMALL, horizontalalignment="left")
    block(ax, (0.7, 2.27), (0.76, 0.4), "reference\nunit, GNSS", fontsize=SMALL)
    block(ax, (1.65, 2.31), (0.9, 0.58), "atomic IMU\n$f_{ib}^b,\\ \\omega_{ib}^b$", fill=LIGHT, width=1.6, linespacing=1.5)
    block(ax, (2.56, 2.27), (0.62, 0.4), "stereo\ncamera", fontsize=SMALL)
    block(ax, (1.65, 1.6), (1.3, 0.26), "data logger")
    arrow(ax, (1.65, 2.02), (1.65, 1.73), width=2.0)
    arrow(ax, (0.7, 2.07), (0.7, 1.6), (1.0, 1.6), dashed=True)
    arrow(ax, (2.56, 2.07), (2.56, 1.6), (2.3, 1.6), dashed=True)
    arrow(ax, (1.14, 1.47), (1.14, 1.17), width=2.0)
    block(ax, (1.14, 0.99), (0.58, 0.36), "filters:\nIMU only", fontsize=SMALL)
    arrow(ax, (1.84, 1.47), (1.84, 1.17), dashed=True)
    block(ax, (1.84, 0.99), (0.66, 0.36), "scores:\nreference", fontsize=SMALL)
    draw_navigation_axes(ax, 0.28, 0.44)
    draw_body_axes(ax, 2.48, 0.44)
    words(ax, 1.6, 0.3, "seen from above,\nup to the reader", fontsize=SMALL)
    return figure


def draw_navigation_axes(ax: Axes, x: float, y: float) -> None:
    """East, north, up, and the yaw angle from east to the vehicle's front, counter-clockwise."""
    draw_axes(ax, (x, y), ("east", "north", "$n$: ENU"))
    yaw, reach = np.deg2rad(38.0), 0.52
    arrow(ax, (x, y), (x + reach * np.cos(yaw), y + reach * np.sin(yaw)), dashed=True)
    ax.add_patch(Arc((x, y), 0.56, 0.56, theta1=0.0, theta2=38.0, color=style.BLACK, linewidth=0.8, zorder=4))
    words(ax, x + 0.36 * np.cos(yaw / 2), y + 0.36 * np.sin(yaw / 2), r"$\psi$", fontsize=SMALL)


def draw_body_axes(ax: Axes, x: float, y: float) -> None:
    """Forward, left, up; the vehicle's front is at the right."""
    draw_axes(ax, (x, y), ("$x$ front", "$y$ left", "$b$: FLU"))


def draw_axes(ax: Axes, origin, names) -> None:
    """Two axes in the page and one towards the reader; `names` of the axis to the right, of that upwards, and of the frame."""
    x, y = origin
    arrow(ax, (x, y), (x + 0.44, y), width=1.2)
    arrow(ax, (x, y), (x, y + 0.44), width=1.2)
    words(ax, x + 0.48, y, names[0], fontsize=SMALL, horizontalalignment="left")
    words(ax, x - 0.08, y + 0.53, names[1], fontsize=SMALL, horizontalalignment="left")
    words(ax, x + 0.22, y - 0.27, names[2])
    ax.add_patch(Circle((x, y), 0.06, facecolor="white", edgecolor=style.BLACK, linewidth=0.9, zorder=4))
    ax.add_patch(Circle((x, y), 0.018, facecolor=style.BLACK, edgecolor="none", zorder=5))
