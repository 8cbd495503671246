"""Hajiyev & Hacizade (2023): a covariance-matching adaptive measurement-differencing Kalman filter for INS errors.

WSEAS Transactions on Systems and Control 18, 478-486, doi 10.37394/23203.2023.18.51 (CC BY 4.0).

``scenario`` and ``ensemble``: section 5; ``estimators``, ``variants`` and ``as_printed``: sections 3 and 4; ``studies``:
what the brief asks beyond the paper; ``tables``, ``figures``, ``noise``, ``claims``, ``register``: what is published.
"""

from functools import partial

from robins.papers.hajiyev2023 import ensemble, studies
from robins.papers.hajiyev2023.claims import CLAIMS
from robins.papers.hajiyev2023.figures import FIGURES
from robins.papers.hajiyev2023.noise import DIAGNOSTICS_FIGURE, DIAGNOSTICS_TABLE
from robins.papers.hajiyev2023.register import ASSUMPTIONS, EQUATIONS
from robins.papers.hajiyev2023.scenario import BRANCHES, KEY, load_plant
from robins.papers.hajiyev2023.tables import TABLES
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Job, Paper

READING = {"deg": "angles in degrees, as labelled", "rad": "angles in radians"}


def _job(module, name: str, label: str, compute, definition=None, family: str = "") -> Job:
    return Job(name, label, compute, (module.__name__,), definition or {}, family)


PAPER = Paper(
    key=KEY,
    title="A Covariance Matching-Based Adaptive Measurement Differencing Kalman Filter for INS's Error Compensation",
    citation="C. Hajiyev, U. Hacizade, WSEAS Transactions on Systems and Control 18 (2023) 478-486",
    doi="10.37394/23203.2023.18.51",
    summary="An aircraft's states are measured by an inertial system whose errors drift. Differencing two measurements removes the "
    "drift (MDKF); matching the innovation covariance in a sliding window adapts the filter to a faulty gyro (AMDKF). The paper reports "
    "one run, in which adaptation improves the four longitudinal states and worsens the four lateral ones. None of its matrices, noise "
    "levels or seeds is published, so a substitute aircraft (F-4C) stands in, with the angles read both in degrees and in radians. "
    "Beside the printed filters run the conventional Kalman filter on the states alone (CKF), the filter augmented with the drifting "
    "errors (AKF), and the corrected differencing filter after Bryson and Henrikson (BH); a leading A marks adaptation by covariance "
    "matching (ABH, AAKF). A delayed estimate of x(k) has used z(k+1), a filtered one has not; like is compared with like.",
    scenarios=tuple(
        _job(ensemble, f"aircraft-{branch}", f"Substitute aircraft, {READING[branch]}", partial(ensemble.scenario, branch=branch))
        for branch in BRANCHES
    ),
    variants=tuple(
        _job(ensemble, name, row.label, partial(ensemble.variant, composition=row.composition), row.composition, row.family)
        for name, row in VARIANTS.items()
    ),
    studies=(
        _job(studies, "theory", "Whiteness, statement 1 and the loss of information", studies.theory),
        *(_job(studies, f"sweep-{b}", f"One-at-a-time sweeps, {READING[b]}", partial(studies.sweep, branch=b)) for b in BRANCHES),
        *(
            _job(studies, f"specification-{b}", f"Specification curve, {READING[b]}", partial(studies.specification, branch=b))
            for b in BRANCHES
        ),
    ),
    tables=(*TABLES, DIAGNOSTICS_TABLE),
    figures=(*FIGURES, DIAGNOSTICS_FIGURE),
    claims=CLAIMS,
    equations=EQUATIONS,
    assumptions=ASSUMPTIONS,
    sizes={
        "smoke": {"runs": 8, "sweep_runs": 8, "specification_sets": 8, "specification_runs": 8, "bootstrap": 200},
        "standard": {"runs": 1000, "sweep_runs": 100, "specification_sets": 300, "specification_runs": 30, "bootstrap": 2000},
        "full": {"runs": 5000, "sweep_runs": 500, "specification_sets": 600, "specification_runs": 60, "bootstrap": 5000},
    },
    options={"plant": "f4c"},
    validate=lambda settings: load_plant(settings.options["plant"]),
)
