"""Tables that say where things come from: every parameter, every equation, every claim's verdict."""

import numpy as np
import pandas as pd

from robins.evaluate.ledger import OVERALL
from robins.navigation.aircraft import STATES, continuous_matrices
from robins.papers.columns import LINEAR, counts, keys, make, numbers, texts
from robins.papers.hajiyev2023.claims import CLAIMS, RATIO_CLAIMS
from robins.papers.hajiyev2023.comparisons import published_ratio, unit
from robins.papers.hajiyev2023.equations import EQUATIONS
from robins.papers.hajiyev2023.scenario import BRANCHES, baseline, load_plant
from robins.papers.hajiyev2023.table_parts import SUBSTITUTE
from robins.papers.protocol import Results, Table

INPUTS = ("elevator", "aileron", "rudder")
PER_STATE = {
    "sigma_w": ("calibrated", "fitted to the MDKF column, rounded, frozen; per step, G = I"),
    "sigma_v": ("calibrated", "fitted to the MDKF column, rounded, frozen"),
    "sigma_lambda": ("assumed", "stationary deviation of the correlated error"),
    "sigma_0": ("assumed", "initial error and its covariance"),
}
LOWERED = {
    ("sigma_0", "theta"): "lowered by hand after the fit from 0.5",
    ("sigma_0", "beta"): "lowered by hand after the fit from 0.5",
    ("sigma_0", "phi"): "lowered by hand after the fit from 0.5",
    ("sigma_lambda", "phi"): "lowered by hand after the fit from 0.3",
}
"""Levels that were changed by hand, in the labelled unit (register, D2)."""

COLUMNS = ("symbol", "channel", "branch", "value", "unit", "published", "origin", "source")


def parameters(results: Results) -> pd.DataFrame:
    """Where every number of the experiment comes from."""
    rows = [*common_rows(), *(row for branch in BRANCHES for row in level_rows(branch)), *plant_rows(results.settings.options["plant"])]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def common_rows() -> list[tuple]:
    """Numbers that are the same in both branches."""
    p = baseline(BRANCHES[0])
    both = (
        ("fault start", p.fault_start, "step", "Y", "published", "eqs (27), (28)"),
        ("fault end", p.fault_start + p.fault_length, "step", "Y", "published", "eqs (27), (28)"),
        ("multiplier of v_q", p.multiplier_q, "1", "Y", "published", "sec 5.2; the equation read literally gives 9"),
        ("multiplier of v_theta", p.multiplier_theta, "1", "Y", "published", "sec 5.2; the equation read literally gives 6"),
        ("RMSE divisor", p.fault_length, "1", "Y", "published", "eq (29): 70, for 71 terms"),
        ("lower bound of s_i", 1.0, "1", "Y", "published", "eq (23)"),
        ("dt", p.dt, "s", "N", "assumed", "80 steps are several short periods; swept"),
        ("tau", p.tau, "s", "N", "assumed", "correlation time of eqs (25), (26), every channel; swept"),
        ("A_n", 1 - p.dt / p.tau, "1", "N", "assumed", "times the identity: 1 - dt / tau"),
        ("B_n", p.dt, "s", "N", "assumed", "times the identity"),
        ("H", 1.0, "1", "N", "assumed", "times the identity: eight rows of Table 1, z_q and z_theta named"),
        ("G", 1.0, "1", "N", "assumed", "times the identity"),
        ("M", p.window, "step", "N", "assumed", "eq (19); swept"),
        ("N", p.steps, "step", "N", "assumed", "the score ends at 150"),
        ("x(0)", 0.0, "1", "N", "assumed", "every state; does not change any error"),
        ("doublet", 1.0, "deg", "N", "assumed", "elevator, aileron at 1 s, rudder at 4 s; inputs do not change any error"),
        ("bound of a failed run", p.divergence, "m/s or rad", "N", "assumed", "an error beyond it is a failure"),
    )
    return [(symbol, "all", "both", float(value), *rest) for symbol, value, *rest in both]


def level_rows(branch: str) -> list[tuple]:
    """Noise levels of a branch, as labelled."""
    rows = []
    for symbol, (origin, source) in PER_STATE.items():
        for state, value in zip(STATES, getattr(baseline(branch), symbol), strict=True):
            note = LOWERED.get((symbol, state), "")
            rows.append((symbol, state, branch, float(value), unit(state, branch), "N", origin, f"{source}; {note}" if note else source))
    return rows


def plant_rows(name: str) -> list[tuple]:
    """The substitute's matrices in continuous time, SI and radians; entries that are zero are left out."""
    plant = load_plant(name)
    A, B = continuous_matrices(plant)
    rows = []
    for symbol, matrix, heads in (("A", A, STATES), ("B", B, INPUTS)):
        for i, j in zip(*np.nonzero(matrix), strict=True):
            block = "longitudinal" if i < 4 else "lateral"
            entry = f"{symbol} [{STATES[i]}, {heads[j]}]"
            rows.append(
                (entry, block, "both", float(matrix[i, j]), "SI, rad", "N", "substitute", f"{plant['name']}: {plant[block]['source']}")
            )
    return rows


def equations(results: Results) -> pd.DataFrame:
    """The audit of the paper's equations."""
    rows = [(e.number, e.title, e.status, e.note, e.test) for e in EQUATIONS]
    return pd.DataFrame(rows, columns=["number", "title", "status", "note", "test"])


def claims(results: Results) -> pd.DataFrame:
    """The verdict of every claim in short; for the ratio claims the numbers of both branches."""
    ledger = results.ledger
    states = {claim_id: state for state, (claim_id, _) in RATIO_CLAIMS.items()}
    rows = []
    for claim in CLAIMS:
        of_claim = ledger[ledger["claim_id"] == claim.claim_id]
        overall = of_claim[of_claim["condition"] == OVERALL].iloc[0]
        row = {"claim_id": claim.claim_id, "location": overall["location"], "statement": claim.statement}
        row |= dict.fromkeys(("published", *BRANCHES), "")
        if claim.claim_id in states:
            row["published"] = published_ratio(results, states[claim.claim_id])
            for branch in BRANCHES:
                ours = of_claim[(of_claim["condition"] == f"{branch}, fault") & (of_claim["variant"] == overall["variant"])].iloc[0]["ours"]
                row[branch] = float(ours) if ours != "failed" else ours
        rows.append(row | {"n": int(overall["n"]), "verdict": overall["verdict"], "reason": overall["reason"]})
    return pd.DataFrame(rows)


REGISTER_TABLES: tuple[Table, ...] = (
    make(
        "extra-claims", "Claims and verdicts in short", claims,
        (keys("claim_id"), texts("location", "statement"), numbers("published", *BRANCHES, kind="optional"), counts("n"),
         texts("verdict", "reason", kind="prose")),
        ("claims",),
        f"{SUBSTITUTE} published, deg, rad: RMSE ratio AMDKF/MDKF with the fault, one run in the paper, geometric mean of ours "
        "in each branch. Every row behind a verdict is in the claim ledger.",
    ),
    make(
        "extra-parameters", "Where every number of the experiment comes from", parameters,
        (keys("symbol", "channel", "branch"), numbers("value", relative=LINEAR), texts("unit", "published", "origin", "source")), (),
        "The paper prints few of its numbers. Calibrated: fitted to the published MDKF column alone, then frozen; assumed: chosen; "
        "substitute: the F-4C stands in for the paper's BRAVO.", "",
    ),
    make(
        "extra-equations", "Audit of the paper's equations", equations,
        (keys("number"), texts("title", "status", "note", "test")), (),
        "ok: stands as printed; ambiguous: a reading had to be chosen; wrong: shown to be so by the test.", "",
    ),
)  # fmt: skip
"""Tables of provenance, in the order of the report."""
