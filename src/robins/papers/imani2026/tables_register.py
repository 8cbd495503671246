"""Tables that say where things come from: every claim's verdict and the audit of the equations."""

import pandas as pd

from robins.evaluate.ledger import OVERALL
from robins.papers.columns import counts, keys, make, texts
from robins.papers.imani2026.claims import CLAIMS
from robins.papers.imani2026.register import EQUATIONS
from robins.papers.protocol import Results, Table


def claims(results: Results) -> pd.DataFrame:
    """The verdict of every claim in short."""
    ledger = results.ledger
    overall = ledger[ledger["condition"] == OVERALL].set_index("claim_id")
    rows = []
    for claim in CLAIMS:
        found = overall.loc[claim.claim_id]
        row = {"claim_id": claim.claim_id, "location": found["location"], "statement": claim.statement}
        rows.append(row | {"n": int(found["n"]), "verdict": found["verdict"], "reason": found["reason"]})
    return pd.DataFrame(rows)


def equations(results: Results) -> pd.DataFrame:
    """The audit of the paper's equations."""
    rows = [(e.number, e.title, e.status, e.note, e.test) for e in EQUATIONS]
    return pd.DataFrame(rows, columns=["number", "title", "status", "note", "test"])


REGISTER_TABLES: tuple[Table, ...] = (
    make(
        "extra-claims", "Claims and verdicts in short", claims,
        (keys("claim_id"), texts("location", "statement"), counts("n"), texts("verdict", "reason", kind="prose")), ("claims",),
        "Decided under the headline condition: F1 against the truth, 10 Hz, zero-mean normal-inverse-Gaussian gyro noise, no outliers, "
        "tuned filters. Runs 0 to n - 1 of the configuration's seed. Every row behind a verdict is in the claim ledger.",
    ),
    make(
        "extra-equations", "Audit of the paper's equations", equations, (keys("number"), texts("title", "status", "note", "test")), (),
        "ok: stands as printed; ambiguous: a reading had to be chosen; wrong: shown to be so by the test.", "",
    ),
)  # fmt: skip
"""Tables of provenance, in the order of the report."""
