"""What the brief asks beyond the factorial: severity, cause, initialisation, sigma points, P0, ablations, levels of self-tuning.

All on runs of their own, with both readings of the EKF, the EKF with the method's model and the UKF; NEW is the paper's method with
the settings that T1's tuning runs gave.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pandas as pd

from robins.navigation.riss import AZIMUTH, V_EAST, V_UP
from robins.papers.ghouneem2024.filters import FILTERS, VELOCITY_FLOOR, Design, Variances, design, physical
from robins.papers.ghouneem2024.gps import ENVIRONMENTS, Environment
from robins.papers.ghouneem2024.runs import Case, controls, headline, prepare, received, run, scores
from robins.papers.ghouneem2024.self_tuning import LEVELS, self_tuned
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import MULTIPLES, frozen, learned_from
from robins.papers.ghouneem2024.variants import NEW
from robins.papers.protocol import Output, Results, Settings

FIRST_SIDE_RUN = 400
HEADLINE = "t1"
"""Whose tuning runs give the frozen settings of the headline and of every study."""
SEVERITIES = (0.0, 0.25, 0.5, 1.0)
CAUSES = ("misleading", "multipath", "outages")
AZIMUTH_ERRORS = tuple(np.radians([0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 179.0]))
ALPHAS = (1e-3, 0.1, 1.0)
PRIOR_SCALES = (0.0, 1e-4, 1e-2, 1.0)
PRIOR_ERROR = float(np.radians(30.0))
DATA_SHEET, MATCHED = PRIORS = ("data sheet", "matched")
"""What the filters of the study ``initialisation`` believe of their initial azimuth."""
LONG_OUTAGE = (600.0, 300.0)
"""First second and length of the outage of the study ``long-outage``."""
JUMP_FIX, JUMP_METRES = 900, 200.0


def side_runs(settings: Settings) -> range:
    """The runs of the studies."""
    return range(FIRST_SIDE_RUN, FIRST_SIDE_RUN + settings.sizes["side_runs"])


def plain(settings: Settings, names: Sequence[str] = FILTERS, **fields) -> dict[tuple[str], Design]:
    """Filters with the data sheet's variances."""
    return {(name,): design(name, settings.options, **fields) for name in names}


def physical_design(settings: Settings, gate: str) -> Design:
    """The EKF with physical Q."""
    return design("ekf-f", settings.options, physical(), gate=gate)


def over(cases: Mapping[tuple, Case], runs: range, designs: Mapping[tuple, Design], labels: Sequence[str], names: Sequence[str]) -> Output:
    """Scores in several cases; the keys of `cases` are the values of the columns `labels`, those of `designs` of `names`."""
    frames = []
    for key, case in cases.items():
        table = scores(case, runs, designs, list(names))
        for position, (label, value) in enumerate(zip(labels, key, strict=True)):
            table.insert(position, label, value)
        frames.append(table)
    return Output(pd.concat(frames, ignore_index=True))


def cases_of(settings: Settings, make: Callable[[str], Mapping]) -> dict[tuple, Case]:
    """Cases on both trajectories: ``make(place)`` gives, by label, what replaces fields of the headline's case."""
    return {
        (place, *key): headline(settings.seed, place)._replace(**fields) for place in TRAJECTORIES for key, fields in make(place).items()
    }


def calibration(settings: Settings) -> Output:
    """RISS alone and both readings of the EKF on the runs that the environment was chosen on: columns trajectory, filter."""
    made = plain(settings, ("ekf-pi", "ekf-pm")) | {("riss-only",): design("ekf-f", settings.options, updates=False)}
    cases = cases_of(settings, lambda place: {(): {}})
    return over(cases, range(settings.sizes["calibration_runs"]), made, ["trajectory"], ["filter"])


def severity(settings: Settings, results: Results) -> Output:
    """Errors over the severity of the environment: columns trajectory, severity, filter."""
    made = plain(settings) | {
        (NEW,): frozen(results, settings, "ukf", HEADLINE, "st-gate"),
        ("ekf-f-nis-recovery",): physical_design(settings, "nis-recovery"),
    }
    cases = cases_of(settings, lambda place: {(value,): {"environment": ENVIRONMENTS[place].scaled(value)} for value in SEVERITIES})
    return over(cases, side_runs(settings), made, ["trajectory", "severity"], ["filter"])


def only(environment: Environment, cause: str) -> Environment:
    """An environment in which one thing goes wrong."""
    counts = {"misleading": "misleading", "multipath": "bursts", "outages": "outages"}
    return environment._replace(**{field: 0.0 for other, field in counts.items() if other != cause})


def cause(settings: Settings) -> Output:
    """The gate by cause of the bad fixes: columns trajectory, cause, filter, gate, multiple."""
    gated = {
        (name, "integrity", multiple): design(name, settings.options, gate="integrity", multiple=multiple)
        for name in FILTERS
        for multiple in (0.5, 2.0, 8.0, np.inf)
    }
    controls = {("physical", gate, np.inf): physical_design(settings, gate) for gate in ("none", "nis", "nis-recovery")}
    cases = cases_of(settings, lambda place: {(name,): {"environment": only(ENVIRONMENTS[place], name)} for name in CAUSES})
    return over(cases, side_runs(settings), gated | controls, ["trajectory", "cause"], ["filter", "gate", "multiple"])


def initialisation(settings: Settings) -> Output:
    """Convergence from a wrong azimuth with clean satellites: columns trajectory, azimuth_error, prior, filter, alpha.

    prior: the filters believe in the data sheet's 5 deg, or in the error that there is (matched, where it is larger).
    """
    frames = []
    for error in AZIMUTH_ERRORS:
        made = {}
        for prior_words in PRIORS:
            for name, alpha in (*((name, settings.options["alpha"]) for name in FILTERS), ("ukf", 1.0)):
                base = design(name, settings.options, alpha=alpha)
                initial = base.variances.initial.copy()
                if prior_words == MATCHED:
                    initial[AZIMUTH] = max(initial[AZIMUTH], error**2)
                made[(prior_words, name, alpha)] = base._replace(variances=Variances(base.variances.process, initial))
        frames.append(started_wrong(settings, error, made, ["prior", "filter", "alpha"]))
    return Output(pd.concat(frames, ignore_index=True))


def started_wrong(settings: Settings, error: float, made: Mapping[tuple, Design], names: Sequence[str]) -> pd.DataFrame:
    """Scores with clean satellites and an initial azimuth that is wrong by `error`: columns trajectory, azimuth_error and `names`."""
    cases = cases_of(settings, lambda place: {(error,): {"environment": ENVIRONMENTS[place].scaled(0.0), "azimuth_error": error}})
    return over(cases, side_runs(settings), made, ["trajectory", "azimuth_error"], names).table


def unscented(settings: Settings) -> Output:
    """Spread and weights of the sigma points, and whether they are drawn again: columns trajectory, alpha, weights, redrawn."""
    made = {
        (alpha, weights, True): design("ukf", settings.options, alpha=alpha, printed_weights=weights == "printed")
        for alpha in ALPHAS
        for weights in ("corrected", "printed")
    }
    made[(settings.options["alpha"], "corrected", False)] = design("ukf", settings.options, redrawn=False)
    return over(cases_of(settings, lambda place: {(): {}}), side_runs(settings), made, ["trajectory"], ["alpha", "weights", "redrawn"])


def prior(settings: Settings) -> Output:
    """Errors and convergence over a multiplier of P0, from an azimuth that is wrong by `PRIOR_ERROR`, with clean satellites.

    Columns trajectory, azimuth_error, prior_scale, filter. In the frozen environment the last outage would decide when the azimuth
    stays within its bound.
    """
    made = {}
    for scale in PRIOR_SCALES:
        for name in FILTERS:
            base = design(name, settings.options)
            made[(scale, name)] = base._replace(variances=Variances(base.variances.process, scale * base.variances.initial))
    return Output(started_wrong(settings, PRIOR_ERROR, made, ["prior_scale", "filter"]))


def ablations(settings: Settings) -> Output:
    """Readings of (1) and (3), one at a time: columns trajectory, ablation, filter."""
    alone = {"updates": False}
    changes = {
        "as run": {}, "tilt corrected": {"tilt": "corrected"}, "tilt literal": {"tilt": "literal"}, "two dimensions": {"tilt": "level"},
        "azimuth literal": {"clockwise": 1.0},
    }  # fmt: skip
    made = {}
    for label, fields in changes.items():
        made[(label, "riss-only")] = design("ekf-f", settings.options, **fields, **alone)
        for name in ("ukf",) if label == "azimuth literal" else FILTERS:
            made[(label, name)] = design(name, settings.options, **fields)
    made[("turn terms", "ekf-pi")] = design("ekf-pi", settings.options, turning=True)
    for name in ("ekf-pi", "ekf-pm"):
        made[("velocity floor", name)] = floored(design(name, settings.options))
    table = over(cases_of(settings, lambda place: {(): {}}), side_runs(settings), made, ["trajectory"], ["ablation", "filter"]).table
    held = {("odometer held", name): design(name, settings.options) for name in FILTERS}
    late = over(cases_of(settings, lambda place: {(): {"hold": True}}), side_runs(settings), held, ["trajectory"], ["ablation", "filter"])
    return Output(pd.concat([table, late.table], ignore_index=True))


def floored(made: Design) -> Design:
    """A design whose velocity gets the process noise that only the total-state filters have."""
    process = made.variances.process.copy()
    process[V_EAST : V_UP + 1] += VELOCITY_FLOOR
    return made._replace(variances=made.variances._replace(process=process))


def literal(settings: Settings, results: Results) -> Output:
    """Levels of self-tuning without a scale, by filter: columns trajectory, level, filter, alpha. Statistics are those of T1's runs."""
    made = {}
    for level in LEVELS:
        for name in FILTERS if level == "st-inc" else ("ekf-f", "ukf"):
            learned = learned_from(results, name, HEADLINE)
            variances = self_tuned(name, level, learned.mechanisation, learned.filtered, HEADLINE)
            made[(level, name, settings.options["alpha"])] = design(name, settings.options, variances)
            if name == "ukf" and level != "st-inc":
                made[(level, name, 1.0)] = design(name, settings.options, variances, alpha=1.0)
    for name in FILTERS:
        made[("ds", name, settings.options["alpha"])] = design(name, settings.options)
    return over(cases_of(settings, lambda place: {(): {}}), side_runs(settings), made, ["trajectory"], ["level", "filter", "alpha"])


def long_outage(settings: Settings) -> Output:
    """One outage of 300 s and nothing else, the tightest gate and none: columns trajectory, filter, multiple."""
    made = {
        (name, multiple): design(name, settings.options, gate="integrity", multiple=multiple)
        for name in FILTERS
        for multiple in (MULTIPLES[0], MULTIPLES[-1])
    }
    cases = cases_of(settings, lambda place: {(): {"environment": ENVIRONMENTS[place].scaled(0.0), "outage": LONG_OUTAGE}})
    return over(cases, side_runs(settings), made, ["trajectory"], ["filter", "multiple"])


def jump(settings: Settings) -> Output:
    """One fix that is 200 m off in a clean run of T1, by filter and multiple: what became of it, of the fix after it, and of all others.

    Columns filter, multiple, run, rejected_jump, rejected_next (bool), false_alarms (other fixes that were rejected).
    """
    rows = []
    for number in side_runs(settings):
        case = headline(settings.seed, HEADLINE)._replace(environment=ENVIRONMENTS[HEADLINE].scaled(0.0))
        fixes = received(case, number)
        fixes.value[JUMP_FIX, 0] += JUMP_METRES
        prepared = prepare(case, number, fixes)
        for name in FILTERS:
            for multiple in MULTIPLES[:-1]:
                made = design(name, settings.options, gate="integrity", multiple=multiple)
                refused = np.any(run(made, prepared, controls(prepared, made.tilt)).weights[0, fixes.epoch] == 0.0, axis=1)
                others = np.delete(refused, [JUMP_FIX, JUMP_FIX + 1])
                rows.append((name, multiple, number, refused[JUMP_FIX], refused[JUMP_FIX + 1], int(others.sum())))
    return Output(pd.DataFrame(rows, columns=["filter", "multiple", "run", "rejected_jump", "rejected_next", "false_alarms"]))
