"""The schemas say the same as the code that reads and writes the files, and the files keep to them."""

import csv
import json

import pytest
from jsonschema import Draft202012Validator

from robins.evaluate import ledger, published
from robins.evaluate.verdicts import Verdict

from .conftest import PLUGIN, ROOT

SCHEMAS = ROOT / "workflow" / "schemas"
PUBLISHED = [*sorted((ROOT / "data" / "published").glob("*.csv")), PLUGIN / "toy.csv"]
LEDGERS = [path for path in (ROOT / "results" / "claims.csv",) if path.is_file()]


def schema(name: str) -> dict:
    return json.loads((SCHEMAS / f"{name}.schema.json").read_text())


def row(name: str) -> dict:
    """What a schema says about one row."""
    return schema(name)["items"]


def objections(name: str, path) -> list[str]:
    """What a schema has against a CSV file."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return [f"{list(error.path)}: {error.message}" for error in Draft202012Validator(schema(name)).iter_errors(rows)]


@pytest.mark.parametrize("name", ["config", "published", "ledger"])
def test_a_schema_is_one_and_allows_no_unknown_key(name):
    Draft202012Validator.check_schema(schema(name))
    assert (schema(name) if name == "config" else row(name))["additionalProperties"] is False


def test_columns_kinds_and_verdicts_are_those_of_the_code():
    assert tuple(row("published")["properties"]) == published.COLUMNS
    assert tuple(row("published")["properties"]["kind"]["enum"]) == published.KINDS
    assert tuple(row("ledger")["properties"]) == ledger.COLUMNS
    assert row("ledger")["properties"]["verdict"]["enum"] == [word.value for word in Verdict]


@pytest.mark.parametrize("path", PUBLISHED, ids=lambda path: path.stem)
def test_published_numbers_keep_to_the_schema(path):
    assert objections("published", path) == []


@pytest.mark.parametrize("path", LEDGERS, ids=lambda path: path.stem)
def test_the_claim_ledger_keeps_to_the_schema(path):
    assert objections("ledger", path) == []


def test_text_in_a_number_column_breaks_the_schema(tmp_path):
    path = tmp_path / "toy.csv"
    path.write_text((PLUGIN / "toy.csv").read_text().replace("1.5", "about 1.5"))
    assert objections("published", path)
