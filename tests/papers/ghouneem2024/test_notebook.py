"""The notebook's derivations lead to tests that exist, and its cells to tables, figures and claims that the wing has."""

import json
import re

import pytest

from robins.papers.ghouneem2024 import PAPER
from robins.papers.ghouneem2024.register_decisions import PROPOSITIONS
from robins.publish.equations import test_exists as exists

NUMBERS = [proposition.name.removeprefix("Prop") for proposition in PROPOSITIONS]


@pytest.fixture(scope="module")
def cells(repository) -> list[dict]:
    return json.loads((repository / "workflow" / "notebooks" / "ghouneem2024.ipynb").read_text(encoding="utf-8"))["cells"]


def text_of(cells: list[dict], kind: str) -> str:
    return "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == kind)


@pytest.mark.parametrize("number", NUMBERS)
def test_a_proposition_of_the_register_names_a_test_that_exists(cells, repository, number):
    paragraph = next(part for part in text_of(cells, "markdown").split("\n\n") if part.startswith(f"**Proposition {number} "))
    named = re.findall(r"`(tests/[\w/.]+::\w+)`", paragraph)
    assert named
    assert [name for name in named if not exists(name, repository)] == []


def test_every_test_that_is_named_exists(cells, repository):
    named = re.findall(r"`(tests/[\w/.]+::\w+)`", text_of(cells, "markdown"))
    assert len(named) > len(NUMBERS)
    assert [name for name in named if not exists(name, repository)] == []


def test_a_cell_reads_tables_and_figures_that_the_wing_makes(cells):
    code = text_of(cells, "code")
    made = {product.name for product in (*PAPER.tables, *PAPER.figures)}
    read = set(re.findall(r'"((?:extra|table|figure)-[\w-]+)(?:\.svg)?"', code))
    assert read - made == set()
    assert {figure.name for figure in PAPER.figures} - read == set(), "a figure that the notebook does not show"


def test_columns_and_claims_that_a_cell_names_are_the_wings(cells):
    code = text_of(cells, "code")
    claims = {claim.claim_id for claim in PAPER.claims}
    assert set(re.findall(r'judged\("(\w+)"', code)) <= claims
    columns = {table.name: {column.name for column in table.columns} for table in PAPER.tables}
    for name, filters in re.findall(r'table\("([\w-]+)", ([^)]*)\)', code):
        assert set(re.findall(r"(\w+)=", filters)) <= columns[name], name


def test_the_source_has_no_output(cells):
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
