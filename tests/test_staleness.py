"""The versioned results were made by the code that is here now."""

import ast
import json
import re

import pytest

from robins.papers import all_papers, configuration, pipeline
from robins.publish.sourcehash import source_hash

AGAIN = "run the standard ensemble again and commit results/"


@pytest.fixture(scope="module")
def recorded(repository) -> dict[str, str]:
    """Source hashes in results/manifest.json, by artefact."""
    path = repository / "results" / "manifest.json"
    assert path.is_file(), AGAIN
    artefacts = json.loads(path.read_text(encoding="utf-8"))["artefacts"]
    return {name: entry["source_hash"] for name, entry in artefacts.items()}


@pytest.fixture(scope="module")
def current(repository) -> dict[str, str]:
    """The source hash that each artefact of the built-in papers would get if it were made now."""
    layout = pipeline.Layout(repository, "standard")
    chosen = configuration.load(repository / "config" / "config.yaml", {"ensemble": "standard"})
    found, judged = {}, {}
    for key, paper in all_papers().items():
        if paper.published is not None:  # a plug-in's results are not versioned here
            continue
        sources = pipeline.Sources(paper, configuration.settings_for(paper, chosen), layout.published_numbers(paper))
        for stage in ("tables", "figures"):
            for product in pipeline.products(paper, stage):
                found[layout.product(paper, stage, product)] = sources.product(product)
        judged[key] = sources.result(pipeline.CLAIMS)
    return found | {"claims.csv": source_hash((), judged)}


def test_the_results_hold_exactly_what_the_registry_promises(recorded, current):
    assert sorted(recorded) == sorted(current), AGAIN


def test_no_table_figure_or_verdict_is_stale(recorded, current):
    assert [name for name in sorted(current) if recorded.get(name) != current[name]] == [], AGAIN


def test_every_artefact_of_the_manifest_is_there(repository, recorded):
    assert [name for name in recorded if not (repository / "results" / name).is_file()] == [], AGAIN


def test_the_tables_and_figures_of_the_recording_are_not_stale(repository):
    path = repository / "results" / "field" / "manifest.json"
    if not path.parent.is_dir():
        pytest.skip("no results from recordings are versioned")
    rule = (repository / "workflow" / "rules" / "field.smk").read_text(encoding="utf-8")
    (modules,) = re.findall(r"source=source_hash\((\[[^\]]*\])\)", rule)
    artefacts = json.loads(path.read_text(encoding="utf-8"))["artefacts"]
    assert {entry["source_hash"] for entry in artefacts.values()} == {source_hash(ast.literal_eval(modules))}, AGAIN
