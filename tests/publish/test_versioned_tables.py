"""The check, tried on the very tables that are versioned: results/ and tests/reference/."""

import pytest

from robins.papers import all_papers
from robins.publish import tables
from robins.publish.check import CLAIM_TABLE, CLAIMS
from robins.publish.comparison import Comparison, compare_frames
from robins.publish.tolerances import refuse_columns, refuse_tolerances


@pytest.fixture(params=["results", "tests/reference"])
def versioned(request, repository) -> dict:
    """Specification and text of every versioned table, by path."""
    folder = repository / request.param
    if not (folder / CLAIMS).is_file():
        pytest.skip(f"{request.param} has not been made yet")
    built_in = {key: paper for key, paper in all_papers().items() if paper.published is None}
    specifications = {f"{key}/tables/{table.name}.csv": table for key, paper in built_in.items() for table in paper.tables}
    specifications[CLAIMS] = CLAIM_TABLE
    return {name: (table, folder / name) for name, table in specifications.items()}


def perturbed(cell: str, column) -> str | None:
    """The cell changed by ten tolerances (a count by one), or None when it is no number."""
    try:
        value = float(cell)
    except ValueError:
        return None
    if column.kind == "count":
        return str(int(value) + 1)
    return f"{value + 10 * (column.absolute + column.relative * abs(value) + (column.relative if value == 0 else 0)):.17g}"


def test_every_numeric_cell_changed_by_ten_tolerances_is_named(versioned):
    for name, (table, path) in versioned.items():
        frame = tables.read_text(path)
        keys = list(map(", ".join, frame[tables.key_columns(table)].itertuples(index=False, name=None)))
        for column in table.columns:
            if column.kind not in ("number", "count", "optional"):
                continue
            spoilt = frame.copy()
            changed = {row: perturbed(cell, column) for row, cell in enumerate(frame[column.name])}
            spoilt[column.name] = [changed[row] or cell for row, cell in enumerate(frame[column.name])]
            outcome = Comparison()
            compare_frames(name, table, spoilt, frame, outcome)
            named = {line.partition(": found ")[0] for line in outcome.differences}
            places = [f"{name}: row ({keys[row]}), {column.name}" for row, cell in changed.items() if cell is not None]
            assert [place for place in places if place not in named] == []


def test_every_table_equals_itself_and_is_what_its_specification_promises(versioned):
    for name, (table, path) in versioned.items():
        outcome = Comparison()
        compare_frames(name, table, tables.read_text(path), tables.read_text(path), outcome)
        assert outcome.differences == [] and outcome.cells > 0
        if table is not CLAIM_TABLE:
            tables.read(path, table)


def test_no_tolerance_is_too_wide_for_its_table(versioned):
    for name, (table, path) in versioned.items():
        if table is not CLAIM_TABLE:
            assert [f"{name}: {problem}" for problem in refuse_columns(table) + refuse_tolerances(table, tables.read(path, table))] == []
