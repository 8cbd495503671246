"""How far one innovation moves the state, filter by filter (proposition 6 of the register).

One state is measured directly, with prior variance P and noise variance R. A filter that divides the noise by its weight w moves
the state by ``P y / (P + R/w)``, one that multiplies the gain by it ``w P y / (P + R)``. Both are shown in units of what the
EKF does with an innovation of one standard deviation, so the EKF is the diagonal. The weights are those that the
filters use, evaluated by the same functions.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from scipy.stats import chi2

from robins.kalman.chi_square import LINEAR, REJECT, ROOT, SEQUENTIAL, chi_square
from robins.kalman.gates import gate
from robins.kalman.m_estimators import correntropy, huber
from robins.kalman.weights import Weighting, weigh, weighting
from robins.papers.imani2026.palette import look
from robins.papers.protocol import Results
from robins.publish import style

RATIOS = {"noise dominates": 0.04, "prior dominates": 17.6}
"""P/R of the two kinds of channel: little and much of the innovation's variance is the prior's."""
REACH = 8.0
INNOVATIONS = np.linspace(0.0, REACH, 801)


class Curve(NamedTuple):
    """One filter: its name for readers, its family, its weights, and what it changes of the family's look."""

    label: str
    family: str
    weighting: Weighting
    changes: Mapping = {}


def curves(options: Mapping) -> dict[str, list[Curve]]:
    """The filters by column of the figure, with the conventional settings that `options` (of the configuration) hold."""
    probability, lower, upper = (options[f"chi_square_{name}"] for name in ("probability", "lower", "upper"))
    widths, mixing = options["kernel_widths"], options["kernel_weights"]
    middle = float(np.median(widths))
    threshold = float(np.sqrt(chi2.ppf(probability, 1)))

    def increments(shape, correct=False):
        return chi_square(1, SEQUENTIAL, shape, probability, lower, upper, correct)

    kernels = correntropy(widths, mixing)
    ekf = Curve("EKF", "ekf", weighting("unit"))
    return {
        "chi-square tests": [
            ekf,
            Curve("CI, linear (as read)", "chi-square", increments(LINEAR)),
            Curve("CI, root", "chi-square", increments(ROOT), {"linestyle": ":", "linewidth": 1.6}),
            Curve("CI, rejecting", "chi-square", increments(REJECT), {"color": style.BLACK, "linestyle": (0, (2, 2)), "linewidth": 0.9}),
            Curve("CI, corrected", "chi-square-corrected", increments(LINEAR, correct=True)),
            Curve(f"gate, {threshold:.2f}", "gated", gate(threshold)),
        ],
        "M-estimators": [
            ekf,
            Curve(f"Huber, {options['huber_threshold']:g}", "huber", huber(options["huber_threshold"])),
            Curve(f"one kernel, {middle:g}", "single-kernel", correntropy([middle], [1.0])),
            Curve("kernels on the noise", "multi-kernel", kernels),
            Curve("kernels on the gain", "multi-kernel-gain", kernels._replace(on_gain=True)),
        ],
    }


def influence(chosen: Weighting, innovations: np.ndarray, ratio: float) -> np.ndarray:
    """Correction of the state over that of the EKF at an innovation of one standard deviation.

    Parameters
    ----------
    chosen : Weighting
        For one channel.
    innovations : ndarray, shape (n,)
        In standard deviations of the innovation.
    ratio : float
        P/R, positive.

    Returns
    -------
    ndarray, shape (n,)
        ``w y`` for weights on the gain, ``(P + R) / (P + R/w) y`` for weights on the noise; zero where the weight is.
    """
    predicted, R = np.array([[ratio]]), np.eye(1)
    weights = np.ones((len(innovations), 1))
    for standardised, weight in zip(innovations, weights, strict=True):
        innovation = np.array([standardised * np.sqrt(ratio + 1.0)])
        weigh(chosen, chosen.parameters, innovation, predicted, R, chosen.memory.copy(), 0, weight)
    weights = weights[:, 0]
    return innovations * (weights if chosen.on_gain else weights * (ratio + 1.0) / (weights * ratio + 1.0))


def draw_influence(results: Results) -> Drawing:
    """Four panels: filters by kind across, channels by the size of P/R down."""
    columns = curves(results.settings.options)
    figure = Drawing(figsize=(style.WIDTH, 5.0))
    axes = figure.subplots(len(RATIOS), len(columns), sharex=True, sharey=True)
    for row, (name, ratio) in zip(axes, RATIOS.items(), strict=True):
        for ax, (kind, drawn) in zip(row, columns.items(), strict=True):
            draw_panel(ax, drawn, ratio)
            ax.set_title(f"{kind}: {name}, $P/R={ratio:g}$")
    for ax in axes[0]:
        ax.legend(loc="upper left", handlelength=2.8, labelspacing=0.25, borderaxespad=0.1)
    figure.supxlabel("innovation, in its standard deviations (1)", fontsize=8.5)
    figure.supylabel("correction, over that of the EKF at one standard deviation (1)", fontsize=8.5)
    return figure


def draw_panel(ax: Axes, drawn: list[Curve], ratio: float) -> None:
    """The curves of some filters for one channel."""
    for curve in drawn:
        line = look(curve.family) | {"marker": "", "label": curve.label, "linewidth": 1.5} | dict(curve.changes)
        ax.plot(INNOVATIONS, influence(curve.weighting, INNOVATIONS, ratio), **line)
    ax.set(xlim=(0.0, REACH), ylim=(-0.15, REACH))
