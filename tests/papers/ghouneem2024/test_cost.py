"""The cost of a step is a committed record's, with its machine; where there is none the table says nothing."""

import json

import pytest

from robins.papers.ghouneem2024 import cost

PAIR = {"ratio": 2.5, "least": 2.4, "greatest": 2.7, "rounds": 9, "ekf_us": 0.8, "ukf_us": 2.0}
COLUMNS = ["ratio", "least", "greatest", "rounds", "ekf_us", "ukf_us", "machine"]


@pytest.fixture
def written(tmp_path, monkeypatch):
    path = tmp_path / "ghouneem2024.json"
    path.write_text(json.dumps({"machine": {"processor": "x", "cores": 2}, "pairs": {cost.PAIR: PAIR}}), encoding="utf-8")
    monkeypatch.setattr(cost, "RECORD", path)
    return path


def test_the_table_is_the_record(settings, written):
    table = cost.cost(settings(), recorded=cost.record()).table
    assert list(table.columns) == COLUMNS and len(table) == 1
    assert table.iloc[0].to_dict() == PAIR | {"machine": "cores 2, processor x"}


def test_without_a_record_the_table_has_its_columns_and_no_row(settings, tmp_path, monkeypatch):
    monkeypatch.setattr(cost, "RECORD", tmp_path / "none.json")
    assert cost.record() == {}
    table = cost.cost(settings(), recorded={}).table
    assert list(table.columns) == COLUMNS and table.empty


def test_a_record_lies_beside_the_benchmarks(repository):
    assert cost.RECORD.parent == repository / "benchmarks" / "records" or not cost.RECORD.is_relative_to(repository)
