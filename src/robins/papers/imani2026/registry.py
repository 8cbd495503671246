"""What the wing offers to the workflow: its scenarios, variants, studies, tables, figures and claims, by name."""

from functools import partial

from robins.papers.imani2026 import ablations, ensemble, studies, theory, tune
from robins.papers.imani2026.claims import CLAIMS
from robins.papers.imani2026.drive import KEY
from robins.papers.imani2026.figures import FIGURES
from robins.papers.imani2026.methods import FAMILIES
from robins.papers.imani2026.noise import DIAGNOSTICS_TABLE
from robins.papers.imani2026.options import OPTIONS, validate
from robins.papers.imani2026.register import ASSUMPTIONS, EQUATIONS
from robins.papers.imani2026.tables import TABLES
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Job, Paper

TUNING = {family: f"tuning-{family}" for family in FAMILIES}


def _job(module, name: str, label: str, compute, definition=None, family: str = "", needs: tuple[str, ...] = ()) -> Job:
    return Job(name, label, compute, (module.__name__,), definition or {}, family, needs)


def _needs(composition: dict) -> tuple[str, ...]:
    """The tuning job of a row that is tuned."""
    return (TUNING[composition["tuned"]],) if "tuned" in composition else ()


PAPER = Paper(
    key=KEY,
    title="Robust State Estimation in Atomic Inertial Navigation Systems: A Comparative Study of CI-RKF and MKMC-EKF Filters",
    citation="F. Imani, J. Keighobadi, NAVIGATION: Journal of the Institute of Navigation 73 (2026) navi.768",
    doi="10.33012/navi.768",
    summary="A car drives through a campus with an atomic inertial measurement unit and no satellites. Two robust Kalman filters are "
    "compared: one inflates the noise of a channel whose chi-square increment is too large (CI-RKF), one weighs the innovations by a "
    "mixture of kernels (MKMC-EKF), which is reported to be better by 37 % to more than 99 % in every quantity. As printed the problem is "
    "degenerate: one sample drives the prediction and is the measurement again, so that the innovation is zero. Three readings of it are "
    "run (F0: the printed states and a car that is taken to stand still; F1: the transients are states, the headline; F2: a second sensor "
    "drives), over an ensemble of simulated drives, with the printed filters and their corrected forms, and with every family tuned on "
    "the same number of settings. The recording, the measurement function, the noise levels, the thresholds and the kernels are not "
    "published; a level of error cannot be checked, which filter is better can.",
    scenarios=(_job(ensemble, "drive", "Campus drive, 10 Hz", ensemble.scenario),),
    variants=tuple(
        _job(ensemble, name, row.label, partial(ensemble.variant, composition=row.composition), row.composition, row.family,
             _needs(row.composition))
        for name, row in VARIANTS.items()
    ),
    studies=(
        *(_job(tune, TUNING[name], f"Tuning: {family.label}", partial(tune.tune, family=name)) for name, family in FAMILIES.items()),
        _job(studies, "outliers", "Noise laws and outliers", studies.outliers, needs=studies.TUNING_JOBS),
        _job(studies, "scale", "Kernel scale with its controls", studies.scale, needs=studies.TUNING_JOBS),
        _job(studies, "grades", "Sensor grades", studies.grades, needs=studies.TUNING_JOBS),
        _job(studies, "rates", "Sampling rates", studies.rates, needs=studies.TUNING_JOBS),
        _job(ablations, "ablations", "Readings and choices, one at a time", ablations.ablations),
        _job(studies, "grids", "Thresholds and numbers of kernels", studies.grids),
        _job(theory, "theory", "Propositions and analytic values", theory.theory),
    ),
    tables=(*TABLES, DIAGNOSTICS_TABLE),
    figures=FIGURES,
    claims=CLAIMS,
    equations=EQUATIONS,
    assumptions=ASSUMPTIONS,
    sizes={
        "smoke": {"runs": 8, "tuning_runs": 2, "sweep_runs": 2, "fast_runs": 2, "bootstrap": 200},
        "standard": {"runs": 100, "tuning_runs": 20, "sweep_runs": 20, "fast_runs": 5, "bootstrap": 2000},
        "full": {"runs": 500, "tuning_runs": 20, "sweep_runs": 100, "fast_runs": 20, "bootstrap": 5000},
    },
    first_runs={"tuning_runs": ensemble.FIRST_TUNING_RUN},
    options=OPTIONS,
    validate=validate,
)  # fmt: skip
