"""The figures of the wing: the paper's eight in two branches, those that the study adds, and two schematics."""

from functools import partial

from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023 import figures_epochs as epochs
from robins.papers.hajiyev2023 import figures_study as study
from robins.papers.hajiyev2023 import figures_sweeps as sweeps
from robins.papers.hajiyev2023 import schematics
from robins.papers.hajiyev2023.comparisons import AMDKF, MDKF
from robins.papers.hajiyev2023.panels import NAMES, SUBSTITUTE
from robins.papers.hajiyev2023.scenario import BRANCHES
from robins.papers.protocol import Figure

OPEN_DIAMOND = "Open diamond: the published value, one run. "
LOOK_AHEAD = "AMDKF/MDKF compares estimates of x(k) from z(0) to z(k+1), AAKF/AKF from z(0) to z(k). "
RUNS = f"Runs 0 to n-1; {SUBSTITUTE}."
BOTH = "The lateral states do not depend on the branch. "


def module_of(draw) -> tuple[str]:
    """The module in which a figure is drawn; what it imports is followed from there."""
    return ((draw.func if isinstance(draw, partial) else draw).__module__,)


def state_figure(number: int, branch: str) -> Figure:
    """One of the paper's figures 1-8 in a branch: odd numbers are the AMDKF, even ones the MDKF."""
    state, variant = STATES[(number - 1) // 2], AMDKF if number % 2 else MDKF
    partner = number + 1 if number % 2 else number - 1
    name = "AMDKF" if number % 2 else "MDKF"
    return Figure(
        name=f"figure-{number:02d}-{branch}",
        title=f"{NAMES[state].capitalize()} and its estimate by the {name}, {branch} branch",
        location=f"Figure {number}",
        draw=partial(epochs.draw_state, variant=variant, state=state, branch=branch),
        needs=(AMDKF, MDKF),
        modules=module_of(epochs.draw_state),
        caption=f"{name} as printed, run 0, chosen before any run was made. Above: truth (solid) and estimate (dashed). Below: error of "
        "this run, three standard deviations as the filter itself believes them, and the central 95 % of the errors of runs 0 to n-1 "
        "(dotted); the first steps may leave the frame. "
        f"Shaded: the fault and the score, k = 80 to 150. Limits as in figure {partner}. The estimate of step k uses z(k+1). "
        f"The paper's own axes are not known; {SUBSTITUTE}.",
        size="runs",
    )


def extra(name: str, title: str, draw, needs: tuple[str, ...], caption: str, size: str = "runs") -> Figure:
    """A figure that the paper does not have."""
    return Figure(f"extra-{name}", title, "extra", draw, needs, module_of(draw), caption, size)


def schematic(name: str, title: str, draw, caption: str) -> Figure:
    """A drawing without data."""
    return Figure(f"schematic-{name}", title, "extra", draw, (), module_of(draw), caption, suffix=".svg")


SWEEPS = tuple(f"sweep-{branch}" for branch in BRANCHES)
SWEEP_CAPTION = "Geometric mean of the paired ratios with its 95 % interval (shaded), all else as in the baseline, fault on. " + LOOK_AHEAD

FIGURES = (
    *(state_figure(number, branch) for branch in BRANCHES for number in range(1, 9)),
    extra(
        "overview", "What the paper claims and what an ensemble says", study.draw_overview, (AMDKF, MDKF),
        OPEN_DIAMOND + "Triangles: geometric mean of the paired ratios, with the fault; thick: its 95 % interval, mostly narrower than the "
        "mark; thin: central 95 % of single runs. " + BOTH + RUNS,
    ),
    extra(
        "forest", "Paired error ratios of three adaptive filters", study.draw_forest, (AMDKF, MDKF, "abh", "bh", "aakf", "akf"),
        OPEN_DIAMOND + "Marks: geometric mean of the paired ratios; thick: its 95 % interval, mostly narrower than the mark; thin: "
        "central 95 % of single runs. Every estimate of x(k) uses z(0) to z(k+1). " + BOTH + RUNS,
    ),
    extra(
        "scale-factors", "Scale factors of the AMDKF", epochs.draw_scale_factors, (AMDKF,),
        "Median and 5 % to 95 % of the runs with the fault, 95 % quantile without; dashed: 1 + (m^2 - 1) R_v / R, what a fault of "
        "multiplier m alone would give. The window is full from step 20. " + BOTH + RUNS,
    ),
    extra(
        "innovation-autocorrelation", "Autocorrelation of the innovations", epochs.draw_innovation_autocorrelation,
        (MDKF, "bh", "akf", "theory"),
        "Lags 1 to 20 (lag 0 is 1), pooled over the runs and the steps from 30 on, without a fault; marks at the first three lags. Open "
        "marks, dotted: the same filters without white measurement noise. " + BOTH + RUNS,
    ),
    extra(
        "specification-curve", "Ratios of random parameter sets", sweeps.draw_specification_curve,
        tuple(f"specification-{branch}" for branch in BRANCHES),
        OPEN_DIAMOND + "It has no abscissa. Each curve: geometric mean ratios of n sets, fault on, sorted by themselves; number: share "
        "of the sets in which AMDKF/MDKF is below 1. " + LOOK_AHEAD
        + "AKF/MDKF: both from z(0) to z(k+1). " + BOTH + SUBSTITUTE + ".", "specification_sets",
    ),
    extra(
        "window", "Error ratio and length of the window",
        partial(sweeps.draw_sweeps, sweeps=(sweeps.WINDOW,), title="Length of the innovation window"), SWEEPS,
        OPEN_DIAMOND + "The paper does not print M, so it stands at the edge. " + SWEEP_CAPTION + BOTH + RUNS, "sweep_runs",
    ),
    extra(
        "fault-multiplier", "Error ratio and size of the fault",
        partial(sweeps.draw_sweeps, sweeps=(sweeps.MULTIPLIER,), title="Size of the fault"), SWEEPS,
        OPEN_DIAMOND + SWEEP_CAPTION + "At 1 there is no fault. L: equations (27) and (28) read literally (9 and 6); q, theta: a fault of "
        "8 or 5 in that channel alone; bars: 95 % intervals. " + BOTH + RUNS, "sweep_runs",
    ),
    extra(
        "tau-duration", "Error ratio, correlation time and length of the fault",
        partial(sweeps.draw_sweeps, sweeps=(sweeps.TAU, sweeps.DURATION), title="Correlation time and length of the fault"), SWEEPS,
        OPEN_DIAMOND + "The paper does not print tau, so it stands at the edge above. " + SWEEP_CAPTION
        + "The scored steps are those of the fault. " + BOTH + RUNS, "sweep_runs",
    ),
    extra(
        "nis", "Normalised innovation squared", epochs.draw_nis, epochs.CONSISTENT,
        "Mean over the runs at each step; a consistent filter stays in the band, the central 95 % of a chi-square mean with 8 degrees of "
        "freedom. With the fault the line of the MDKF is mostly hidden by that of the BH; the Oracle is told the fault. " + RUNS,
    ),
    extra(
        "single-seed-ratios", "What a single run may show", study.draw_single_seed_ratios, (AMDKF, MDKF),
        OPEN_DIAMOND + "Histograms: RMSE ratio AMDKF/MDKF of single runs with the fault; bar: their central 95 %; number: share of the "
        "runs in which adaptation is better. " + BOTH + RUNS,
    ),
    extra(
        "information-loss", "What differencing loses of the first measurement", epochs.draw_information_loss, ("theory",),
        f"Ratio of the filters' own standard deviations, a deterministic recursion without white measurement noise; {SUBSTITUTE}.", "",
    ),
    extra(
        "units", "Are the published angles degrees or radians?", study.draw_units, (MDKF,),
        "Left: published RMSE of the MDKF (open diamonds), read as degrees and as radians, over what its published error of w implies at "
        "the substitute's speed and short period; shaded: within a factor of two. A hypothesis: it rests on the substitute, and theta fits "
        "neither reading. Right: RMSE of our MDKF with the fault over the published number, median and central 95 % of the runs: no branch "
        "fits all states. " + BOTH + RUNS,
    ),
    extra(
        "convergence", "Has the filter converged when the score begins?", epochs.draw_convergence, (MDKF, "akf"),
        "Root mean square over the runs of the filters' own standard deviation (solid) and of their error (dashed), without a fault; "
        "shaded: the scored steps. " + BOTH + RUNS,
    ),
    schematic(
        "differencing", "Which measurements the difference holds, and where C belongs", schematics.draw_differencing,
        "The noise w(k) drives x(k+1), which z(k+1) measures and mu(k) contains. What mu(k) and the state share is therefore the noise of "
        "the step from k to k+1, not the error of the prediction to k.",
    ),
    schematic(
        "filters", "The filters of the study", schematics.draw_filters,
        "One update; a filter is what it reads, where the correlated error goes, where C enters, and its weights.",
    ),
)  # fmt: skip
"""Every figure, in the order of the report."""
