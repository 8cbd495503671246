"""What the wing offers to the workflow: its scenarios, variants, studies, tables, figures and claims, by name."""

from functools import partial

from robins.papers.ghouneem2024 import cost, ensemble, in_sample, studies, theory, traces, tune
from robins.papers.ghouneem2024.claims import CLAIMS
from robins.papers.ghouneem2024.figures import FIGURES
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.noise import DIAGNOSTICS_TABLE
from robins.papers.ghouneem2024.options import OPTIONS, validate
from robins.papers.ghouneem2024.register import ASSUMPTIONS, EQUATIONS
from robins.papers.ghouneem2024.tables import TABLES
from robins.papers.ghouneem2024.trajectories import KEY
from robins.papers.ghouneem2024.variants import LABELS, NEW, VARIANTS
from robins.papers.protocol import Job, Paper

TUNING = {name: tune.job_name(name) for name in FILTERS}


def _job(module, name: str, label: str, compute, definition=None, family: str = "", needs: tuple[str, ...] = ()) -> Job:
    return Job(name, label, compute, (module.__name__,), definition or {}, family, needs)


def _needs(composition: dict) -> tuple[str, ...]:
    """The tuning job of a row that is tuned."""
    return (TUNING[composition["filter"]],) if composition.get("cell", "none") != "none" else ()


PAPER = Paper(
    key=KEY,
    title="An Innovative Approach for Improving Navigation Performance of Robust Land-Based Vehicles",
    citation="M. Ghouneem, A. Wassal, International Journal on Informatics Visualization (JOIV), November 2024",
    doi="",
    summary="A car navigates with one vertical gyro, an odometer, accelerometers for its tilt, and GPS. A method of three parts (an "
    "unscented filter, noise covariances tuned with a reference, a gate for the fixes) is reported to have 28 % to 54 % of the horizontal "
    "error of an extended Kalman filter on two drives. Neither the drives nor the settings are published, and how the baseline feeds its "
    "corrections back is not said: two readings of it are run, and an EKF with the unscented filter's own model. The eight combinations "
    "of the three parts run on simulated drives with settings frozen on other runs; what leakage is worth is measured by tuning on the "
    "evaluated run itself. A level of error cannot be checked; which filter is better, and because of what, can.",
    scenarios=(
        _job(ensemble, "t1", "Trajectory 1: suburban", partial(ensemble.scenario, place="t1")),
        _job(ensemble, "t2", "Trajectory 2: dense urban", partial(ensemble.scenario, place="t2")),
    ),
    variants=tuple(
        _job(ensemble, name, row.label, partial(ensemble.variant, composition=row.composition), row.composition, row.family,
             _needs(row.composition))
        for name, row in VARIANTS.items()
    ),
    studies=(
        *(_job(tune, TUNING[name], f"Tuning: {LABELS[name]}", partial(tune.tune, name=name)) for name in FILTERS),
        _job(studies, "calibration", "Calibration of the environment", studies.calibration),
        _job(in_sample, "in-sample", "Settings tuned on the evaluated run", in_sample.in_sample),
        _job(studies, "severity", "Severity of the environment", studies.severity, needs=(TUNING["ukf"],)),
        _job(studies, "cause", "Cause of the bad fixes", studies.cause),
        _job(studies, "initialisation", "Initial azimuth", studies.initialisation),
        _job(studies, "unscented", "Sigma points: spread, weights, redrawing", studies.unscented),
        _job(studies, "prior", "Initial covariance", studies.prior),
        _job(studies, "ablations", "Readings of the mechanisation, one at a time", studies.ablations),
        _job(studies, "literal", "Levels of self-tuning", studies.literal, needs=tuple(TUNING.values())),
        _job(studies, "long-outage", "One long outage", studies.long_outage),
        _job(studies, "jump", "One bad fix", studies.jump),
        _job(traces, "traces", "The median run", traces.traces, needs=(TUNING["ukf"], traces.BASELINE, NEW)),
        _job(theory, "theory", "Analytic values and moments", theory.theory),
        _job(cost, "cost", "Cost of a step", partial(cost.cost, recorded=cost.record()), cost.record()),
    ),
    tables=(*TABLES, DIAGNOSTICS_TABLE),
    figures=FIGURES,
    claims=CLAIMS,
    equations=EQUATIONS,
    assumptions=ASSUMPTIONS,
    sizes={
        "smoke": {"runs": 8, "side_runs": 2, "in_sample_runs": 2, "tuning_runs": 2, "calibration_runs": 2, "bootstrap": 200},
        "standard": {"runs": 50, "side_runs": 12, "in_sample_runs": 12, "tuning_runs": 8, "calibration_runs": 12, "bootstrap": 2000},
        "full": {"runs": 200, "side_runs": 50, "in_sample_runs": 50, "tuning_runs": 8, "calibration_runs": 12, "bootstrap": 5000},
    },
    first_runs={
        "runs": ensemble.FIRST_RUN,
        "in_sample_runs": ensemble.FIRST_RUN,
        "side_runs": studies.FIRST_SIDE_RUN,
        "tuning_runs": tune.FIRST_TUNING_RUN,
    },
    options=OPTIONS,
    validate=validate,
)  # fmt: skip
