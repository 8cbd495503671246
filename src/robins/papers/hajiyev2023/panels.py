"""What the wing's figures share: names and units of the states, the grid of panels, axes of ratios, paired ratios."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from robins.evaluate.intervals import TIE, log_interval
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.comparisons import LATERAL, LONGITUDINAL, cases, scores
from robins.papers.hajiyev2023.scenario import BRANCHES, baseline
from robins.papers.hajiyev2023.studies import ADAPTED, AUGMENTED, PLAIN
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

SUBSTITUTE = "substitute aircraft (F-4C)"
PUBLISHED = "published (one run)"
SYMBOLS = dict(zip(STATES, ("$u$", "$w$", "$q$", r"$\theta$", r"$\beta$", "$p$", "$r$", r"$\phi$"), strict=True))
NAMES = dict(zip(STATES, ("forward velocity", "vertical velocity", "pitch rate", "pitch angle", "sideslip", "roll rate", "yaw rate",
                          "roll angle"), strict=True))  # fmt: skip
CORRECTED = "abh/bh"
PAIR_WORDS = {
    ADAPTED: "AMDKF / MDKF as printed",
    CORRECTED: "ABH / BH (corrected)",
    PLAIN: "AAKF / AKF",
    AUGMENTED: "AKF / MDKF as printed",
}
TICKS = {
    1.35: (0.8, 0.9, 1, 1.1, 1.25),
    2.2: (0.5, 0.67, 0.8, 1, 1.25, 1.5, 2),
    7.0: (0.25, 0.5, 1, 2, 4),
    25.0: (0.1, 0.2, 0.5, 1, 2, 5, 10),
    np.inf: (0.001, 0.01, 0.1, 1, 10, 100, 1000),
}
"""Ticks of a ratio's axis, by how far the axis reaches from 1."""

FAULT = (baseline("deg").fault_start, baseline("deg").fault_start + baseline("deg").fault_length)


class Panel(NamedTuple):
    """One panel of `state_grid`: its axes, its state and the branch it shows (for both, the lateral rows)."""

    ax: Axes
    state: str
    branch: str

    @property
    def index(self) -> int:
        """The state's index."""
        return STATES.index(self.state)


def line_of(variant: str, **changes) -> dict:
    """Colour, line and label of a variant, without markers: keywords for ``Axes.plot``."""
    row = VARIANTS[variant]
    return style.family(row.family) | {"marker": "", "label": row.label} | changes


def headline(figure: FigureBase, text: str, handles=None, columns: int = 4) -> None:
    """Title of a figure, which says that the aircraft is a substitute, and below it one legend for all panels.

    By default the legend holds the labelled artists of the first panel.
    """
    handles = figure.axes[0].get_legend_handles_labels()[0] if handles is None else handles
    figure.legend(handles=handles, loc="outside upper left", ncols=columns, handlelength=2.4, columnspacing=1.6, borderaxespad=0.2,
                  title=f"{text} · {SUBSTITUTE}", title_fontsize=9, alignment="left")  # fmt: skip


def state_grid(figure: FigureBase, sharex=True, sharey="row") -> list[Panel]:
    """Twelve panels: longitudinal states by branch, and the lateral states, whose results no choice of units changes."""
    axes = figure.subplots(3, 4, sharex=sharex, sharey=sharey)
    rows = [(branch, f"{branch} branch", LONGITUDINAL) for branch in BRANCHES] + [("deg", "both branches", LATERAL)]
    panels = []
    for row, (branch, words, states) in zip(axes, rows, strict=True):
        for ax, state in zip(row, states, strict=True):
            ax.set_title(SYMBOLS[state], pad=3)
            ax.set_title(words, loc="right", fontsize=8, color=style.GREY, pad=3)
            panels.append(Panel(ax, state, branch))
    return panels


def rows_of_panels(panels: list[Panel]) -> Iterator[list[Panel]]:
    """The panels of a `state_grid` row by row."""
    return (panels[start : start + 4] for start in range(0, len(panels), 4))


def ratio_axis(ax: Axes, axis: str, reach: float, ticks=None) -> None:
    """Make `axis` ("x" or "y") a logarithmic axis of ratios from 1/`reach` to `reach`, with a line at 1; `ticks` replaces `TICKS`."""
    getattr(ax, f"set_{axis}scale")("log")
    getattr(ax, f"set_{axis}lim")(1 / reach, reach)
    chosen = getattr(ax, f"{axis}axis")
    ticks = ticks or next(values for limit, values in TICKS.items() if reach <= limit)
    chosen.set_major_locator(FixedLocator([tick for tick in ticks if 1 / reach <= tick <= reach]))
    chosen.set_minor_locator(NullLocator())
    chosen.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    (ax.axvline if axis == "x" else ax.axhline)(1.0, color=style.BLACK, linewidth=0.8, zorder=1)


def reach_of(*values, margin: float = 1.12) -> float:
    """How far an axis of ratios has to reach from 1 to hold all `values`."""
    logs = np.abs(np.log(np.concatenate([np.ravel(value) for value in values])))
    return float(np.exp(np.max(logs[np.isfinite(logs)], initial=np.log(1.05)))) * margin


def published_mark(ax: Axes, x, y):
    """Published values as open diamonds, behind our own marks so that neither hides the other."""
    marker = style.published_marker(ax, x, y, label=PUBLISHED)
    marker.set(markersize=6.2, zorder=1.5)
    return marker


def margin_mark(ax: Axes, y: float) -> None:
    """Mark a published value on the right-hand edge of a panel: its abscissa is not published."""
    published_mark(ax, [1.0], [y]).set(transform=ax.get_yaxis_transform(), clip_on=False, zorder=4)


def family_of(pair: str) -> str:
    """The family whose look stands for a pair: that of its numerator."""
    return VARIANTS[pair.split("/")[0]].family


def published_handle() -> Line2D:
    """Legend entry of published values."""
    return published_mark(Figure().subplots(), [], [])


def paired_logs(results: Results, pair: str, estimate: str = "delayed") -> dict[tuple[str, str, str], np.ndarray]:
    """Log ratios of the RMSE of ``numerator/denominator``, the runs that survive in both, by (branch, condition, state)."""
    logs = {}
    for branch, condition in cases():
        above, below = (scores(results, name, branch, condition, estimate) for name in pair.split("/"))
        survived = ~(above.failed | below.failed)
        values = np.log(above.rmse[survived]) - np.log(below.rmse[survived])
        values[np.abs(values) < TIE] = 0.0
        logs |= {(branch, condition, state): values[:, i] for i, state in enumerate(STATES)}
    return logs


def ratio_interval(logs: np.ndarray) -> np.ndarray:
    """Geometric mean and the ends of its 95 % interval."""
    return np.exp(log_interval(np.asarray(logs, float)))
