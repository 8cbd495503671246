"""How every figure looks: one style sheet, and one colour, line and marker for each family of filters.

Colours are those of Okabe and Ito [1]_, which the common kinds of colour blindness keep apart; line styles and markers
differ as well, so a grey print can be read. A family has the same look in every figure of every paper. Dashes belong
to the adaptive or inflated relative of the filter that has the same colour.

References
----------
.. [1] M. Okabe, K. Ito, Color Universal Design, 2008.
"""

from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from robins.foundation.files import replacing

WIDTH = 7.0  # inches: the widest figure, two columns of text

BLACK, GREY = "#000000", "#767676"
ORANGE, SKY, GREEN, YELLOW = "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILLION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"

_DENSE_DASH, _LONG_DASH, _DASH_DOT_DOT = (0, (3, 1)), (0, (7, 2)), (0, (5, 1.5, 1, 1.5, 1, 1.5))

_FAMILIES = {
    "truth": (BLACK, "-", ""),
    "published": (BLACK, "", "D"),
    "oracle": (BLACK, _DENSE_DASH, "*"),
    "classical": (SKY, "-", "o"),
    "inflated": (SKY, "--", "s"),
    "differencing": (BLUE, "-", "s"),
    "lagged": (BLUE, ":", "x"),
    "adaptive-differencing": (VERMILLION, "--", "^"),
    "gated": (ORANGE, "-.", ">"),
    "scalar": (ORANGE, ":", "<"),
    "corrected": (GREEN, "-", "v"),
    "corrected-adaptive": (GREEN, "--", "P"),
    "augmented": (PURPLE, "-", "p"),
    "augmented-adaptive": (PURPLE, "--", "h"),
    "ukf": (GREY, _LONG_DASH, "d"),
    "correntropy": (VERMILLION, _DASH_DOT_DOT, "X"),
    "multi-kernel": (BLUE, _DENSE_DASH, "H"),
    "huber": (GREEN, "-.", "1"),
    "integrity": (GREY, "-.", "2"),
}

_SHEET = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so the same letters everywhere
    "font.size": 8.5,
    "axes.titlesize": 9,
    "axes.labelsize": 8.5,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "figure.titlesize": 10,
    "figure.figsize": (WIDTH, 3.6),
    "figure.dpi": 150,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 150,
    "savefig.facecolor": "white",
    "svg.hashsalt": "robins",
    "svg.fonttype": "path",
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
    "lines.markeredgewidth": 0.9,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "axes.titlelocation": "left",
    "grid.color": "#D9D9D9",
    "grid.linewidth": 0.5,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.frameon": False,
    "errorbar.capsize": 0,
}


@contextmanager
def use():
    """Apply the style sheet, whatever the user's own matplotlib settings are; figures are made and saved inside."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_SHEET)
        yield


def add_family(name: str, color: str, linestyle: str, marker: str) -> None:
    """Give a family of filters that is not in this list (a plug-in's) its colour, line style and marker.

    Raises
    ------
    ValueError
        The family has a look already.
    """
    if name in _FAMILIES and _FAMILIES[name] != (color, linestyle, marker):
        raise ValueError(f"the filter family {name!r} has a look already")
    _FAMILIES[name] = (color, linestyle, marker)


def family(name: str) -> dict:
    """Colour, line style and marker of a family of filters, as keywords for ``Axes.plot``.

    Raises
    ------
    KeyError
        No such family.
    """
    if name not in _FAMILIES:
        raise KeyError(f"no filter family {name!r}; there are {', '.join(_FAMILIES)}")
    return dict(zip(("color", "linestyle", "marker"), _FAMILIES[name], strict=True))


def families() -> tuple[str, ...]:
    """The names that `family` knows."""
    return tuple(_FAMILIES)


def published_marker(ax: Axes, x, y, label: str = "published"):
    """Mark published values at (x, y) by open diamonds. Returns the artist."""
    look = family("published")
    return ax.plot(
        x, y, linestyle="none", marker=look["marker"], markersize=5.5, markerfacecolor="white", markeredgecolor=look["color"],
        markeredgewidth=1.0, zorder=5, label=label,
    )[0]  # fmt: skip


def interval(ax: Axes, position, value, low, high, name: str, horizontal: bool = True, label: str | None = None):
    """Draw values with their intervals in the colour and marker of the family `name`.

    Parameters
    ----------
    position : array_like, shape (n,)
        Where each interval sits on the axis across it.
    value, low, high : array_like, shape (n,)
        The value and the ends of its interval (absolute, not half-widths).
    horizontal : bool
        Along x (a forest plot), else along y.
    """
    look = family(name)
    along = ax.hlines if horizontal else ax.vlines
    along(position, low, high, color=look["color"], linewidth=1.4, zorder=3)
    x, y = (value, position) if horizontal else (position, value)
    return ax.plot(x, y, linestyle="none", marker=look["marker"] or "o", color=look["color"], zorder=4, label=label)[0]


def shade_window(ax: Axes, start: float, end: float, label: str | None = None):
    """Shade start <= x <= end (a fault, a scoring window) behind everything else."""
    return ax.axvspan(start, end, color="#000000", alpha=0.07, linewidth=0, zorder=0, label=label)


def save(figure: Figure, path) -> None:
    """Write `figure` as PNG or SVG, the same bytes each time: no dates, no versions, no random ids; whole or not at all."""
    suffix = Path(path).suffix
    FigureCanvasAgg(figure)
    with use(), replacing(path) as temporary:
        if suffix == ".svg":
            figure.savefig(temporary, format="svg", metadata={"Date": None, "Creator": None})
        elif suffix == ".png":
            _save_png(figure, temporary)
        else:
            raise ValueError(f"{path}: a figure is .png or .svg, not {suffix!r}")


def _save_png(figure: Figure, path) -> None:
    """Write a PNG with a palette of 256 colours: a third of the size, and the eye sees no difference in a line drawing."""
    drawn = BytesIO()
    figure.savefig(drawn, format="png", metadata={"Software": None})
    with Image.open(drawn) as image:
        image.convert("RGB").quantize(256, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(
            path, format="png", optimize=True
        )
