"""The figures of the wing: the paper's nine, and those that the study adds."""

from functools import partial

from robins.papers.ghouneem2024 import figures_controls as controls
from robins.papers.ghouneem2024 import figures_factorial as factorial
from robins.papers.ghouneem2024 import figures_forest as forest
from robins.papers.ghouneem2024 import figures_gate as gate
from robins.papers.ghouneem2024 import figures_plan as plan
from robins.papers.ghouneem2024 import figures_sweeps as sweeps
from robins.papers.ghouneem2024 import figures_traces as traces
from robins.papers.ghouneem2024 import schematics
from robins.papers.ghouneem2024.ensemble import FIRST_RUN
from robins.papers.ghouneem2024.studies import FIRST_SIDE_RUN
from robins.papers.ghouneem2024.tune import FIRST_TUNING_RUN
from robins.papers.protocol import Figure

RUNS = f"Reporting runs {FIRST_RUN} and up, frozen environment. "
SIDE_RUNS = f"Runs {FIRST_SIDE_RUN} and up. "
TUNED = f"Self-tuned Q, P0 and thresholds come from the tuning runs ({FIRST_TUNING_RUN} and up) of T1 on both trajectories. "
DATASHEET = "Filters without self-tuning have the data sheet's variances. "
MEANS = "Marks: geometric means over the runs; bars: 95 % intervals, from a bootstrap over the runs, below fifty Student's on logarithms. "
RATIOS = (
    "Marks: geometric means of paired ratios; bars: 95 % intervals, from a bootstrap over the runs, below fifty Student's on logarithms; "
    "a failed run counts as a loss. "
)
MEDIAN = (
    "The reporting run whose ratio of horizontal errors, New over incremental EKF, is the median of all; its number and ratio stand in "
    "the title. Once a second; a filter that fails is drawn until it does. "
)
METHODS = "New: UKF, self-tuning and gate with settings of T1's tuning runs. EKFs: data sheet's variances, no gate. "
ONE_RUN = "One run shows what happens, not how often. "


def module_of(draw) -> tuple[str]:
    """The module in which a figure is drawn; what it imports is followed from there."""
    return ((draw.func if isinstance(draw, partial) else draw).__module__,)


def schematic(number: int, title: str, draw, caption: str) -> Figure:
    """Figure 1 or 2: a drawing of our own, without data."""
    return Figure(f"figure-{number}", title, f"Figure {number}", draw, (), module_of(draw), caption, suffix=".svg")


def trace(number: int, title: str, draw, caption: str) -> Figure:
    """One of figures 3 to 9: the median run."""
    words = MEDIAN + METHODS + caption + ONE_RUN
    return Figure(f"figure-{number}", title, f"Figure {number}", draw, traces.NEEDS, module_of(draw), words, "runs")


def extra(name: str, title: str, draw, needs: tuple[str, ...], caption: str, size: str = "runs") -> Figure:
    """A figure that the paper does not have."""
    return Figure(f"extra-{name}", title, "extra", draw, needs, module_of(draw), caption, size)


SEEN_FROM_ABOVE = (
    "Longitude is counted from the origin, since the drive is a design of ours. RISS alone may leave the frame. Grey dots: GPS fixes; "
    "crosses: fixes that New rejects; grey band: the reference where there are no fixes. "
)
ERRORS = "Estimate minus reference. Bands: three of the filter's own standard deviations around zero, cut where they leave the panel. "

FIGURES = (
    schematic(
        1, "The baseline: RISS, GPS and an error-state EKF", schematics.draw_baseline,
        "Our own diagram. What becomes of the corrected velocity the paper does not say; both readings are run.",
    ),
    schematic(
        2, "The new method, and where it needs the truth", schematics.draw_new_method,
        "Our own diagram. White on black: made with a reference that a vehicle does not have while it drives.",
    ),
    trace(3, "Trajectory 1 from above", partial(plan.draw_plan, place="t1"), SEEN_FROM_ABOVE),
    trace(
        4, "Trajectory 1: position errors",
        partial(traces.draw_errors, place="t1", channels=traces.POSITIONS, what="position errors"), ERRORS,
    ),
    trace(
        5, "Trajectory 1: velocities", partial(traces.draw_velocities, place="t1"),
        "At the right the longest outage with half a minute before and after. Up velocity is made from the accelerometers' pitch as "
        "printed, which takes acceleration for a slope. ",
    ),
    trace(
        6, "Trajectory 1: velocity errors",
        partial(traces.draw_errors, place="t1", channels=traces.VELOCITIES, what="velocity errors"), ERRORS,
    ),
    trace(
        7, "Trajectory 1: azimuth", partial(traces.draw_azimuth, place="t1"),
        "Azimuth clockwise from north in [0, 360); lines are not joined across north. At the right the longest outage. ",
    ),
    trace(
        8, "Trajectory 1: azimuth errors", partial(traces.draw_azimuth_errors, place="t1"),
        ERRORS + "Below: both angles in [0, 360) and their difference not wrapped, as a careless evaluation has it: jumps of 360 deg where "
        "reference and estimate lie on different sides of north. ",
    ),
    trace(9, "Trajectory 2 from above", partial(plan.draw_plan, place="t2"), SEEN_FROM_ABOVE),
    extra(
        "forest-channels", "New over EKF by channel, beside the published ratios", forest.draw_channels, forest.CHANNEL_NEEDS,
        "Ratio of RMSE, New over EKF, out of sample, against both readings of the EKF. Filled: New with the settings of T1's tuning runs "
        "(the headline, on both trajectories); open triangles: with those of T2's. Open diamonds: Tables II and III, one run each, "
        f"settings unknown; grey: within a factor {forest.SAME_SIZE:g} of them, where the claims' rule calls the size the same. "
        "EKFs: data sheet's variances, no gate. A claim can hold only where both filled bars lie left of 1. " + RATIOS + RUNS,
    ),
    extra(
        "factorial", "Filter × self-tuning × gate", factorial.draw_factorial, factorial.NEEDS,
        "The eight combinations from either EKF to the new method, and those of the EKF with the UKF's own model and exact Jacobian. Open "
        "diamonds: published RMSE of EKF and New; levels cannot be compared (other data), their distance on this axis is the published "
        "ratio. " + MEANS + TUNED + DATASHEET + RUNS,
    ),
    extra(
        "attribution", "What filter, self-tuning and gate contribute", factorial.draw_attribution, factorial.NEEDS,
        "Shapley values of the logarithm of the RMSE, shown as factors; they multiply to the whole ratio. The filter's is split: from the "
        "EKF to the EKF with the UKF's model (model), from there to the UKF (unscented transform). A bar too short to be seen has its "
        "number. Lines: 95 % intervals, from a bootstrap over the runs, below fifty Student's. " + TUNED + DATASHEET + RUNS,
    ),
    extra(
        "in-sample", "Settings in and out of sample", forest.draw_leakage, forest.LEAKAGE_NEEDS,
        "Denominator: Q, P0, scale and threshold chosen with the truth of the evaluated run itself, by the tuning's criterion (mean log "
        "RMSE over the seven channels, not the horizontal alone; a ratio below 1 is possible). Right of 1: what the truth of the run was "
        "worth. " + RATIOS + RUNS, "in_sample_runs",
    ),
    extra(
        "severity", "Severity of the environment", sweeps.draw_severity, ("severity",),
        "The mean numbers of outages, bursts and misleading fixes are scaled; 1 is the frozen environment, 0 clean fixes. Marks stand "
        "aside so that bars do not cover each other; ≤ k fail: the most runs that any one filter loses. "
        + MEANS + TUNED + DATASHEET + SIDE_RUNS, "side_runs",
    ),
    extra(
        "gate", "What the gate rejects, and for how long", gate.draw_gate, gate.NEEDS,
        "Above: the median run of each trajectory, every fix by what is wrong with it, with the settings of T1's tuning runs. Below: the "
        f"longest run of consecutive rejections in every run. Dotted: {gate.PATIENCE} fixes, after which the gate with recovery accepts "
        "one. A run of hundreds means that the gate never opens again or not for minutes. Filters that are not tuned have filled "
        "marks. " + RUNS,
    ),
    extra(
        "gate-causes", "The gate by cause of the bad fixes", gate.draw_causes, gate.CAUSE_NEEDS,
        "Only one thing goes wrong with the satellites, as often as in the frozen environment. Gate (24) with its thresholds times 0.5, 2, "
        "8 on four filters with the data sheet's variances; NIS gates (99.9 % of chi-square) on the EKF with physical Q. Denominator: the "
        "same filter without a gate. " + RATIOS + SIDE_RUNS, "side_runs",
    ),
    extra(
        "consistency", "NIS and NEES", controls.draw_consistency, controls.CHECKED,
        "Means over a run: NIS of accepted fixes (6 degrees of freedom), NEES of position (3) and azimuth (1) once a minute. Marks: median "
        "of the runs, bars: 5 % to 95 % of them. Grey: the central 95 % of a single chi-square value, generous for the mean of a run. "
        "Right of it a filter believes itself better than it is. A gate on NIS leaves out what would raise it. " + TUNED + DATASHEET + RUNS,
    ),
    extra(
        "initial-azimuth", "Convergence from a wrong azimuth", sweeps.draw_initialisation, ("initialisation",),
        "Clean satellites; the filters believe in 5 deg. Seconds from the first motion until the error stays below 5 deg; never: not "
        "within the run, or the run fails. Lines: median of the runs, bars: 5 % to 95 % of them, moved aside. "
        + DATASHEET + SIDE_RUNS, "side_runs",
    ),
    extra(
        "sigma-points", "Spread and weights of the sigma points", sweeps.draw_sigma_points, ("unscented",),
        "Failed: the covariance has no Cholesky factor, or the horizontal error exceeds 100 km. Metres: geometric mean of the surviving "
        "runs. (18) as printed multiplies where it should add; points that are not redrawn after the prediction are (25) taken literally. "
        "A dash: not run. Data sheet's variances, no gate. " + SIDE_RUNS, "side_runs",
    ),
    extra(
        "pitch", "The pitch in (1), up velocity and altitude", controls.draw_pitch, controls.PITCH_NEEDS,
        "Pitch from the accelerometers as printed takes acceleration for a slope; corrected, the odometer's acceleration is removed; sign "
        "and all: upside down for accelerometers that measure specific force; without pitch the predicted up velocity is zero. Lines and "
        "diamonds: published, one run on another drive, so that only orders of magnitude can be compared. "
        + MEANS + DATASHEET + SIDE_RUNS, "side_runs",
    ),
    extra(
        "physical", "Filters without tuning against the new method", controls.draw_controls, controls.CONTROL_NEEDS,
        "Physical Q: set once before any run, from what sensors and model leave out. NIS gate: 99.9 % of chi-square with six degrees of "
        f"freedom; recovery: after {gate.PATIENCE} rejections one fix is accepted with a larger R. " + RATIOS + TUNED + DATASHEET + RUNS,
    ),
)  # fmt: skip
"""Every figure, in the order of the report."""
