"""The figures of the wing: the paper's eight, and those that the study adds."""

from functools import partial

from robins.papers.imani2026 import figures_channels as channels
from robins.papers.imani2026 import figures_drive as drive
from robins.papers.imani2026 import figures_filters as filters
from robins.papers.imani2026 import figures_scale as scale
from robins.papers.imani2026 import figures_sweeps as sweeps
from robins.papers.imani2026 import influence, schematics
from robins.papers.imani2026.comparisons import GROUPS, PAIR
from robins.papers.imani2026.ensemble import FIRST_TUNING_RUN
from robins.papers.imani2026.methods import FAMILIES
from robins.papers.imani2026.noise import DIAGNOSTICS_FIGURE
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Figure

HEADLINE = "Headline condition: 10 Hz, zero-mean NIG gyro noise, no outliers. "
RUNS = "Runs 0 to n-1. "
TUNED = f"Tuned filters: two knobs, one budget, on runs {FIRST_TUNING_RUN} and up in F1, which are reported nowhere else. "
GROUPED = "A group's RMSE is the geometric mean over its three channels. "
BARS = "Bars: 95 % intervals over the runs, from a bootstrap, or below fifty runs Student's on a jackknife. "
PRINTED = "MKMC-EKF: weights normalised, W on the gain; as printed it runs too, and the title says in how many runs it fails. "
SHORT = dict(zip(GROUPS, ("velocity", "acceleration", "rate", "euler"), strict=True))
"""Groups of channels as they stand in file names."""
LETTERS = dict(zip(GROUPS, "abcd", strict=True))
TUNINGS = tuple(f"tuning-{family}" for family in FAMILIES)


def module_of(draw) -> tuple[str]:
    """The module in which a figure is drawn; what it imports is followed from there."""
    return ((draw.func if isinstance(draw, partial) else draw).__module__,)


def schematic(number: int, title: str, draw, caption: str) -> Figure:
    """One of figures 1-4: a drawing of our own, without data."""
    return Figure(f"figure-{number}", title, f"Figure {number}", draw, (), module_of(draw), caption, suffix=".svg")


def extra(name: str, title: str, draw, needs: tuple[str, ...], caption: str, size: str) -> Figure:
    """A figure that the paper does not have."""
    return Figure(f"extra-{name}", title, "extra", draw, needs, module_of(draw), caption, size)


def estimates_figure(group: str) -> Figure:
    """One of figures 7 a-d."""
    return Figure(
        f"figure-7-{SHORT[group]}",
        f"{group[0].upper()}{group[1:]}: reference, truth and estimates",
        f"Figure 7{LETTERS[group]}",
        partial(channels.draw_estimates, group=group, formulation="F1"),
        channels.NEEDS,
        module_of(channels.draw_estimates),
        "F1, run 0, chosen before any run was made. " + HEADLINE + TUNED + PRINTED + "Acceleration and rate are drawn once a second; "
        "lines that coincide lie over each other, the thinner in front; angles are wrapped, so a yaw near 180 deg changes sides. The "
        "reference has errors of its own; its acceleration and rate are differentiated.",
        "runs",
    )


def errors_figure(group: str) -> Figure:
    """One of figures 8 a-d."""
    return Figure(
        f"figure-8-{SHORT[group]}",
        f"{group[0].upper()}{group[1:]}: errors against the truth",
        f"Figure 8{LETTERS[group]}",
        partial(channels.draw_errors, group=group, formulation="F1"),
        channels.NEEDS,
        module_of(channels.draw_errors),
        "F1; lines: run 0, once a second; filled (CI-RKF) and outlined (MKMC-EKF): 5 % to 95 % of runs 0 to n-1, of those that survive. "
        + HEADLINE + TUNED + PRINTED + "Angle errors are wrapped.",
        "runs",
    )  # fmt: skip


def forest(name: str, title: str, published: bool, caption: str) -> Figure:
    """The paper's comparison by channel."""
    return extra(
        name, title, partial(filters.draw_forest, published=published), PAIR,
        "Panels: F0, F1, F2. One minus the ratio of ensemble values, with 95 % paired bootstrap intervals; right of 0 the MKMC-EKF is "
        "better; logarithmic in the ratio; a triangle at the left edge: worse than the axis shows. "
        + caption + HEADLINE + TUNED + RUNS, "runs",
    )  # fmt: skip


SCALE_SETTINGS = {"F0": "F0, conventional settings. ", "F1": "F1, R of the kernels and the gate and the CI-RKF as tuned. "}


def scale_curve(formulation: str, size: str) -> Figure:
    """The way from no update to the EKF in one formulation."""
    return extra(
        f"kernel-scale-{formulation.lower()}", f"Kernel scale from no update to the EKF, {formulation}",
        partial(scale.draw_scale_curve, formulation=formulation), ("scale",),
        "Kernels and gates by width, for a mixture that of its middle kernel; ∞ is the EKF. Beside it the EKF with R enlarged. Lines and "
        "bands across: no update, and the CI-RKF. A filter that wins only where it stops updating has not become robust. "
        + GROUPED + BARS + SCALE_SETTINGS[formulation]
        + HEADLINE + RUNS, size,
    )  # fmt: skip


def tuning(name: str, title: str, condition: str) -> Figure:
    """What was evaluated when the filters were tuned."""
    return extra(
        name, title, partial(sweeps.draw_tuning, condition=condition), TUNINGS,
        "Objective: mean over the 12 channels of the log ensemble RMSE against the truth in F1, on n runs from run "
        f"{FIRST_TUNING_RUN} on. A 3 x 3 grid around the conventional setting, then one row and one column more on the side of the "
        "optimum; colours end at an excess of 40.", "tuning_runs",
    )  # fmt: skip


FIGURES = (
    schematic(
        1, "Principle of an NMR gyroscope", schematics.draw_gyroscope,
        "Our own schematic of the principle; nothing is to scale and nothing is taken from the paper's picture.",
    ),
    schematic(
        2, "Mach-Zehnder atom interferometer", schematics.draw_interferometer,
        "Heights of the two arms in free fall, with and without acceleration (our own drawing). T is the time between pulses; with the "
        "total time 2T the quarter of equation (6) appears.",
    ),
    schematic(
        3, "The filter's loop in two formulations", schematics.draw_loop,
        "Our own diagram. F0 uses a sample twice, as input and as measurement; F1 once.",
    ),
    schematic(
        4, "Sensors on the vehicle, and axes", schematics.draw_layout,
        "Our own block sketch in place of the paper's photograph; no position is to scale.",
    ),
    Figure(
        "figure-5", "The drive, from above and over time", "Figure 5", drive.draw_drive, ("drive",), module_of(drive.draw_drive),
        "Truth of the simulated drive, a design of ours after the paper's words and way points; reference: run 0. Arrow heads: direction "
        "of travel. The paper's axes and scale were not available.",
    ),
    DIAGNOSTICS_FIGURE,
    *(estimates_figure(group) for group in GROUPS),
    *(errors_figure(group) for group in GROUPS),
    extra(
        "figure-7-f0", "All channels in the printed states (F0)", partial(channels.draw_all_estimates, formulation="F0"),
        channels.NEEDS,
        "As figure 7, but F0: the sample is input and measurement, and the quasi-static model takes every manoeuvre for a tilt. Run 0. "
        + HEADLINE + TUNED + PRINTED, "runs",
    ),
    forest(
        "forest", "What the paper claims and what an ensemble says", True,
        "Open diamonds and band: the published RMSE improvements (C1-C3), one run; the paper does not say which channel they belong to. ",
    ),
    forest("forest-detail", "The same comparison on its own scale", False, "Each panel has its own scale. "),
    extra(
        "consistency", "Consistency of the filters", filters.draw_consistency, tuple(filters.CONSISTENT),
        "Columns: F0, F1, F2. Normalised squared errors of attitude (3 degrees of freedom) and biases (6) every 30 s, and of "
        "innovations (6) once a second, averaged over 10 s: means of the surviving runs, with the central 95 % of a chi-square mean. Above "
        "the band a filter believes itself better than it is, below it worse. The objective of the tuning does not look at consistency. "
        + HEADLINE + TUNED + RUNS, "runs",
    ),
    extra("influence", "Influence of one innovation", influence.draw_influence, (),
          "Proposition 6: how far one innovation moves a state that is measured directly, in units of what the EKF does with an "
          "innovation of one standard deviation. P and R: variances of prediction and noise. Conventional settings.", ""),
    extra(
        "improvement-map", "Improvement by outlier rate and kernel scale", scale.draw_improvement_map, ("scale",),
        "RMSE improvement over the CI-RKF, per cent; ×k: k times its RMSE. White is no difference. F1, zero-mean NIG gyro noise, 10 Hz, "
        "two-sided outliers; R of the kernels and the CI-RKF as tuned. " + GROUPED + TUNED + RUNS, "sweep_runs",
    ),
    scale_curve("F0", "runs"),
    scale_curve("F1", "sweep_runs"),
    extra(
        "outliers", "Outliers by rate, law and side", sweeps.draw_outliers, ("outliers",),
        "RMSE improvement over the CI-RKF in F1 at 10 Hz. Zero-mean or zero-mode NIG gyro noise with two-sided or one-sided outliers of 15 "
        "sd times U(0.5, 1.5); right: an impulsive mixture with the same moments. Settings of the headline condition, frozen; hollow "
        "(the cross: alone): all filters tuned again at 2 %, the CI-RKF too. " + GROUPED + BARS + RUNS + TUNED, "sweep_runs",
    ),
    extra(
        "rates", "Sampling rate", sweeps.draw_rates, ("rates",),
        "Left: RMSE; right: its improvement over the CI-RKF. The noise of a sample, or its density, is that of 10 Hz. F1, zero-mean NIG "
        "gyro noise, no outliers; fewer runs above 10 Hz, without bars where there is one. Thresholds count in standard deviations and "
        "stay. " + GROUPED + BARS + RUNS + TUNED, "sweep_runs",
    ),
    extra(
        "grades", "Grade of the sensors", sweeps.draw_grades, ("grades",),
        "RMSE improvement over the CI-RKF in F1; below each group the CI-RKF's RMSE, vehicle | ideal atomic grade. Zero-mean NIG gyro "
        "noise, 10 Hz, no outliers; settings of the headline condition. " + GROUPED + BARS + RUNS + TUNED, "sweep_runs",
    ),
    tuning("tuning", "Tuning under the headline condition", "headline"),
    tuning("tuning-outliers", "Tuning at two per cent of outliers", "outliers"),
    extra(
        "position", "Position error of every filter", filters.draw_position, tuple(VARIANTS),
        "Length of the position error in F0, F1 and F2; lines and marks over the surviving runs, each panel on its own scale. "
        "Colours as elsewhere: the filter's family. Without an update F1 predicts a car at rest, and the drive ends where it began. The "
        "paper gives no number. " + HEADLINE + TUNED + RUNS, "runs",
    ),
)  # fmt: skip
"""Every figure, in the order of the report."""
