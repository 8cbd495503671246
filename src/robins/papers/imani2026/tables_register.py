"""Tables that say where things come from: the audit of the equations."""

import pandas as pd

from robins.papers.columns import keys, make, texts
from robins.papers.imani2026.register import EQUATIONS
from robins.papers.protocol import Results, Table


def equations(results: Results) -> pd.DataFrame:
    """The audit of the paper's equations."""
    rows = [(e.number, e.title, e.status, e.note, e.test) for e in EQUATIONS]
    return pd.DataFrame(rows, columns=["number", "title", "status", "note", "test"])


REGISTER_TABLES: tuple[Table, ...] = (
    make(
        "extra-equations", "Audit of the paper's equations", equations, (keys("number"), texts("title", "status", "note", "test")), (),
        "ok: stands as printed; ambiguous: a reading had to be chosen; wrong: shown to be so by the test.", "",
    ),
)  # fmt: skip
"""Tables of provenance, in the order of the report."""
