"""A small made-up paper and its results, to publish, to perturb and to read."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure as Drawing

from robins.papers.protocol import Assumption, Claim, Column, Equation, Figure, Paper, Table
from robins.publish import check, manifest, style, tables

KEY = "nobody1999"
FILTERS = ("classical", "differencing", "augmented")
STATES = ("u", "q")


def nothing(results):
    """Stands where a builder, a rule or a drawing would; the made-up results are written by hand."""
    raise NotImplementedError


ERRORS = Table(
    name="table-1",
    title="Errors of the filters",
    location="Table 1",
    columns=(
        Column("filter", "key"),
        Column("state", "key"),
        Column("rmse", "number", "m/s", relative=1e-6),
        Column("ci_low", "number", "m/s", relative=1e-6),
        Column("ci_high", "number", "m/s", relative=1e-6),
        Column("n", "count"),
        Column("note", "text"),
    ),
    build=nothing,
    needs=(),
    modules=(),
    caption="Root mean square of $\\hat x - x$ with a 95 % interval.",
    size="runs",
)
PROVENANCE = Table(
    name="extra-parameters",
    title="Parameters",
    location="",
    columns=(Column("symbol", "key"), Column("value", "number", relative=1e-9), Column("source", "text")),
    build=nothing,
    needs=(),
    modules=(),
)


def make_paper() -> Paper:
    """The made-up paper."""
    claims = (
        Claim("C1", "The differencing filter is better in $u$", nothing, (), ()),
        Claim("C2", "Its noise is white", nothing, (), ()),
    )
    equations = (
        Equation("6", "Differencing", r"\mu(k)=z(k+1)-A_n z(k)", "ok", "", "tests/test_it.py::test_differencing"),
        Equation(
            "18", "Innovation covariance", r"E[\Delta\Delta^T]=H_dPH_d^T+R+H_dC+C^TH_d^T", "wrong", "Holds for $Q_v=0$ only.",
            "tests/test_it.py::TestInnovation::test_covariance", r"H_dPH_d^T+R",
        ),
    )  # fmt: skip
    figures = (
        Figure("figure-01", "Estimate of u", "Fig. 1", nothing, (), (), "Open diamonds: published.", "runs"),
        Figure("schematic", "How it works", "", nothing, (), (), suffix=".svg"),
    )
    return Paper(
        key=KEY, title="A made-up filter", citation="Nobody (1999)", doi="10.0/0", summary="Nothing of this <was> published.",
        scenarios=(), variants=(), studies=(), tables=(ERRORS, PROVENANCE), figures=figures, claims=claims, equations=equations,
        assumptions=(Assumption("A1", "assumption", "Sampling at $\\Delta t = 0.1$ s", "Ratios do not depend on it"),),
    )  # fmt: skip


def errors_frame() -> pd.DataFrame:
    """Made-up errors; one of them has no surviving run."""
    rows = []
    for position, (name, state) in enumerate((name, state) for name in FILTERS for state in STATES):
        value = 1.0 + 0.37 * position
        rows.append((name, state, value, 0.9 * value, 1.1 * value, 1000, "a note"))
    frame = pd.DataFrame(rows, columns=[column.name for column in ERRORS.columns]).astype({"rmse": object})
    frame.loc[5, "rmse"] = tables.FAILED
    return frame


def parameters_frame() -> pd.DataFrame:
    """Made-up parameters."""
    return pd.DataFrame({"symbol": ["tau", "dt"], "value": [100.0, 0.1], "source": ["assumed", "published"]})


def ledger_frame() -> pd.DataFrame:
    """A made-up claim ledger."""
    base = dict(paper=KEY, location="Table 1", unit="", published_high="", variant="differencing", n=1000)
    rows = [
        base | dict(claim_id="C1", quantity="ratio", condition="overall", published="0.54", ours="0.6123456", ci_low="0.59", ci_high="0.63",
                    verdict="replicated", reason="Ratio 0.612 in both branches."),
        base | dict(claim_id="C1", quantity="ratio", condition="deg", published="0.54", ours="0.6", ci_low="0.58", ci_high="0.62",
                    verdict="replicated", reason="The interval lies below 1."),
        base | dict(claim_id="C2", quantity="autocovariance at lag 1", condition="overall", published="", ours="not white", ci_low="",
                    ci_high="", verdict="refuted", reason="$-A_n Q_v$ is not zero.", n=0),
    ]  # fmt: skip
    return pd.DataFrame(rows)[[column.name for column in check.CLAIM_TABLE.columns]]


def published_frame() -> pd.DataFrame:
    """What the made-up paper prints."""
    return pd.DataFrame({"claim_id": ["C1", "C1;C2", "A3"], "location": ["Table 1", "sec 3", "eq (6)"]})


def drawing() -> Drawing:
    """A figure with most of the helpers in it."""
    with style.use():
        figure = Drawing()
        ax = figure.subplots()
        k = np.arange(100)
        ax.plot(k, np.sin(k / 9), label="truth", **style.family("truth"))
        ax.plot(k, np.sin(k / 9 - 0.2), label="estimate", markevery=10, **style.family("differencing"))
        style.shade_window(ax, 40, 70)
        style.published_marker(ax, [10, 60], [0.5, -0.3])
        style.interval(ax, [20, 80], [0.2, 0.4], [0.0, 0.3], [0.4, 0.6], "augmented", horizontal=False)
        ax.legend()
    return figure


def publish(folder, paper: Paper) -> None:
    """Write the made-up results to `folder`."""
    cells = {}
    for table, frame in ((ERRORS, errors_frame()), (PROVENANCE, parameters_frame())):
        name = f"{KEY}/tables/{table.name}.csv"
        cells[name] = tables.write(frame, table, folder / name, 1000)
    for figure in paper.figures:
        style.save(drawing(), folder / KEY / "figures" / f"{figure.name}{figure.suffix}")
    tables.write_csv(ledger_frame(), folder / check.CLAIMS)
    cells[check.CLAIMS] = tables.cells(len(ledger_frame()), check.CLAIM_TABLE)
    record, lock = folder / "record.json", folder / "requirements.lock"
    manifest.write_record(record, {name: manifest.entry("table", 1000, "0" * 64, count) for name, count in cells.items()})
    lock.write_text("numpy==2.4.6\n")
    manifest.write_manifest(folder / "manifest.json", [record], lock, {"seed": 1}, {"seed": 1})
    record.unlink()
    lock.unlink()


@pytest.fixture(scope="session")
def paper() -> Paper:
    """The made-up paper."""
    return make_paper()


@pytest.fixture(scope="session")
def published() -> dict[str, pd.DataFrame]:
    """What the made-up paper prints, by key."""
    return {KEY: published_frame()}


@pytest.fixture(scope="session")
def reference(tmp_path_factory, paper):
    """A folder with the made-up results; nobody writes into it."""
    folder = tmp_path_factory.mktemp("reference")
    publish(folder, paper)
    return folder
