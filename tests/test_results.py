"""The versioned results agree with each other and with the registry, the configuration and the published numbers."""

import json

import nbformat
import pandas as pd
import pytest

import robins
from robins.evaluate.published import read_published
from robins.papers import all_papers, configuration, pipeline, steps
from robins.publish import check, report, tables

PAPERS = {key: paper for key, paper in all_papers().items() if paper.published is None}  # a plug-in's results are not versioned here
TABLES = [(key, table) for key, paper in PAPERS.items() for table in paper.tables]
NOTEBOOKS = [*PAPERS, "overview"]


@pytest.fixture(scope="module")
def results(repository):
    """The folder results/."""
    folder = repository / "results"
    assert (folder / "manifest.json").is_file(), "run the standard ensemble and commit results/"
    return folder


@pytest.fixture(scope="module")
def manifest(results) -> dict:
    """The content of results/manifest.json."""
    return json.loads((results / "manifest.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def claims(results) -> pd.DataFrame:
    """The claim ledger, every cell text."""
    return tables.read_text(results / check.CLAIMS)


@pytest.fixture(scope="module")
def desks(repository) -> dict[str, steps.Desk]:
    """Everything that the standard run of the committed configuration works with, by paper."""
    chosen = configuration.load(repository / "config" / "config.yaml", {"ensemble": "standard", "papers": list(PAPERS)})
    layout = pipeline.Layout(repository, "standard")
    return {key: steps.Desk(paper, chosen, layout) for key, paper in PAPERS.items()}


def files_below(folder) -> list[str]:
    """Every file below `folder`, relative to it."""
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def source_cells(notebook) -> list[tuple[str, str]]:
    """Kind and source of every cell."""
    return [(cell.cell_type, cell.source) for cell in notebook.cells]


def test_the_results_hold_the_files_of_the_registry_and_no_other(results, desks):
    expected = {"claims.csv", "manifest.json", "report.html"}
    for at in desks.values():
        for stage in ("tables", "figures"):
            expected |= {name.removeprefix("results/") for name in at.layout.products(at.paper, stage)}
    assert [name for name in files_below(results) if not name.startswith("field/")] == sorted(expected)


def test_the_field_results_hold_the_files_of_their_manifest_and_no_other(results):
    if not (results / "field").is_dir():
        pytest.skip("no results from recordings are versioned")
    listed = json.loads((results / "field" / "manifest.json").read_text(encoding="utf-8"))["artefacts"]
    assert files_below(results / "field") == sorted(["manifest.json", *listed])


@pytest.mark.parametrize(("key", "table"), TABLES, ids=[f"{key}-{table.name}" for key, table in TABLES])
def test_the_markdown_shows_the_numbers_of_the_csv_beside_it(results, desks, key, table):
    path = results / key / "tables" / f"{table.name}.csv"
    expected = tables.markdown(tables.read(path, table), table, desks[key].size(table))
    assert path.with_suffix(".md").read_text(encoding="utf-8") == expected


def test_the_report_shows_these_results(results):
    assert report.render(PAPERS, results, "standard") == (results / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("key", "table"),
    [(key, table) for key, table in TABLES if table.name == "extra-claims"],
    ids=lambda value: str(getattr(value, "name", value)),
)
def test_the_short_table_of_claims_repeats_the_ledger(results, claims, key, table):
    shown = tables.read_text(results / key / "tables" / f"{table.name}.csv")
    columns = ["claim_id", "location", "n", "verdict", "reason"]
    overall = claims[(claims["paper"] == key) & (claims["condition"] == "overall")]
    assert sorted(map(tuple, shown[columns].to_numpy())) == sorted(map(tuple, overall[columns].to_numpy()))


def test_every_claim_of_the_published_numbers_and_the_registry_has_one_overall_row(repository, claims):
    overall = claims[claims["condition"] == "overall"]
    expected = {(key, claim.claim_id) for key, paper in PAPERS.items() for claim in paper.claims}
    for path in (repository / "data" / "published").glob("*.csv"):
        expected |= {(path.stem, claim) for claim in check.claim_ids(read_published(path))}
    assert sorted(zip(overall["paper"], overall["claim_id"], strict=True)) == sorted(expected)


def test_no_verdict_lacks_runs(claims):
    assert claims.loc[claims["verdict"] == check.TOO_SMALL, ["paper", "claim_id", "condition"]].to_numpy().tolist() == []


def test_the_manifest_is_that_of_this_configuration_and_these_pins(manifest, desks, tmp_path, monkeypatch):
    (tmp_path / "results").mkdir()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "record.json").write_text(json.dumps(manifest["artefacts"]))
    steps.write_manifest(list(desks.values()), ["record.json"])
    made_again = json.loads((tmp_path / "results" / "manifest.json").read_text(encoding="utf-8"))
    for field in ("lock_hash", "config_hash", "seeds", "source_hash"):
        assert manifest[field] == made_again[field], field
    assert manifest.keys() == made_again.keys()


def test_the_manifest_names_this_version_and_the_pinned_packages(repository, manifest):
    pins = dict(
        line.split()[0].split("==") for line in (repository / "requirements.lock").read_text().splitlines() if "==" in line.split("#")[0]
    )
    recorded = dict(manifest["versions"])
    assert recorded.pop("robins") == robins.__version__
    recorded.pop("python")  # the lock does not pin it
    assert recorded == {name: pins.get(name) for name in recorded}


def test_the_manifest_gives_each_artefact_its_rule_its_n_and_its_number_of_cells(results, manifest, claims, desks):
    expected = {check.CLAIMS: {"rule": "claims", "n": None, "cells": tables.cells(len(claims), check.CLAIM_TABLE)}}
    for at in desks.values():
        for stage in ("tables", "figures"):
            for product in pipeline.products(at.paper, stage):
                expected[at.layout.product(at.paper, stage, product)] = {"rule": stage, "n": at.size(product)}
        for table in at.paper.tables:
            name = at.layout.product(at.paper, "tables", table)
            expected[name]["cells"] = tables.cells(len(tables.read_text(results / name)), table)
    recorded = {
        name: {fact: value for fact, value in entry.items() if fact != "source_hash"} for name, entry in manifest["artefacts"].items()
    }
    assert recorded == expected


def test_the_notebooks_are_those_of_the_papers_and_the_overview(repository):
    assert files_below(repository / "notebooks") == sorted(f"{name}.ipynb" for name in NOTEBOOKS)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_is_its_source_executed_without_an_error(repository, name):
    executed, source = (
        nbformat.read(repository / folder / f"{name}.ipynb", as_version=4) for folder in ("notebooks", "workflow/notebooks")
    )
    assert source_cells(executed) == source_cells(source)
    code = [cell for cell in executed.cells if cell.cell_type == "code"]
    assert all(cell.execution_count for cell in code)
    kinds = [output.output_type for cell in code for output in cell.outputs]
    assert kinds
    assert "error" not in kinds


def test_table_5_of_imani2026_says_what_its_other_tables_say(results):
    """The comparison stands in three tables, which one falsified number cannot all agree with."""
    folder = results / "imani2026" / "tables"
    short, everywhere, filters, ratios = (
        pd.read_csv(folder / f"{name}.csv") for name in ("table-5", "extra-table-5", "extra-filters", "extra-ratios")
    )
    headline = everywhere[(everywhere["formulation"] == "F1") & (everywhere["against"] == "truth")]
    compared = filters["filter"].isin(["ci-seq", "mk-norm-gain"]) & (filters["formulation"] == "F1")
    levels = filters[compared].set_index(["filter", "channel"])["rmse"].map(float)
    pair = ratios[(ratios["filter"] == "mk-norm-gain") & (ratios["over"] == "ci-seq") & (ratios["formulation"] == "F1")].set_index(
        "channel"
    )
    for row in short.to_dict("records"):
        channel = row["channel"]
        assert row["rmse_ci"] == pytest.approx(levels["ci-seq", channel], rel=1e-9)
        assert row["rmse_mkmc"] == pytest.approx(levels["mk-norm-gain", channel], rel=1e-9)
        assert row["rmse_improvement"] == pytest.approx(100 * (1 - row["rmse_mkmc"] / row["rmse_ci"]), abs=1e-6)
        assert row["rmse_improvement"] == pytest.approx(100 * (1 - float(pair.loc[channel, "ratio"])), abs=1e-6)
        for metric in ("drift", "rmse", "mean", "sd"):
            (other,) = headline[(headline["channel"] == channel) & (headline["metric"] == metric)]["improvement"].map(float)
            assert row[f"{metric}_improvement"] == pytest.approx(other, abs=1e-9)
