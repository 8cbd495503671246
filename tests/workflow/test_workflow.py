"""The workflow on a throw-away paper: what it runs, what it runs again, and what it leaves alone."""

import json
import os

import pytest

from .conftest import ROOT

pytestmark = pytest.mark.slow

PUBLISHING = {"claims": 1, "manifest": 1, "report": 1, "complete": 1, "all": 1}
NOTEBOOKS = 1 + (ROOT / "workflow" / "notebooks" / "overview.ipynb").is_file()
EVERYTHING = PUBLISHING | {
    "simulate": 1,
    "diagnose": 1,
    "estimate": 5,
    "evaluate": 1,
    "tables_toy": 1,
    "figures_toy": 1,
    "notebook": NOTEBOOKS,
}


def test_an_empty_folder_needs_every_job(fresh):
    assert fresh.planned() == EVERYTHING


def test_results_without_intermediates_do_not_stand_in_for_the_science(finished, fresh):
    for name, content in finished.published().items():  # what a fresh clone has
        (fresh.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (fresh.folder / name).write_bytes(content)
    assert fresh.planned() == EVERYTHING


def test_everything_the_registry_promises_is_published(finished):
    names = set(finished.published())
    tables = {f"results/toy/tables/{name}{suffix}" for name in ("table-1", "extra-plain") for suffix in (".csv", ".md")}
    others = {
        "results/toy/figures/figure-01.png",
        "results/claims.csv",
        "results/manifest.json",
        "results/report.html",
        "notebooks/toy.ipynb",
    }
    assert names - {"notebooks/overview.ipynb"} == tables | others
    manifest = json.loads((finished.folder / "results" / "manifest.json").read_text())
    assert {f"results/{name}" for name in manifest["artefacts"]} == {
        name for name in names if name.endswith(("1.csv", "n.csv", ".png", "s.csv"))
    }
    spans = {"reporting_runs": {"toy": {"runs": "0 to 39"}}, "tuning_runs": {"toy": {"tuning_runs": "1000 to 1003"}}}
    assert manifest["seeds"] == {"seed": 20261124, **spans}
    assert "toy,C1," in (finished.folder / "results" / "claims.csv").read_text()
    complete = json.loads((finished.folder / "build" / "complete.json").read_text())
    assert len(complete) == 2 * 6 + 2  # scenario, variants and studies with two files each, diagnostics, claims


def test_a_second_run_does_nothing_and_says_so_quickly(finished):
    began = os.times()
    run = finished("--cores", "2")
    ended = os.times()
    assert run.returncode == 0
    assert "Nothing to be done" in run.stderr
    # In processor time: the other half of the suite is at work meanwhile.
    assert ended.children_user + ended.children_system - began.children_user - began.children_system < 10


def test_a_comment_or_a_docstring_reruns_nothing(finished, tmp_path):
    workflow = finished.copy(tmp_path)
    workflow.edit("toykernel.py", "    estimates =", "    # The mean is unbiased.\n    estimates =")
    workflow.edit("toykernel.py", "One row for each run", "One row per run")
    assert workflow.planned() == {}


def test_a_changed_definition_reruns_that_variant_and_what_depends_on_it(finished, tmp_path):
    workflow = finished.copy(tmp_path)
    workflow.edit("toy.py", 'variant("shrunk", 0.5)', 'variant("shrunk", 0.25)')
    once = {"estimate": 1, "evaluate": 1, "tables_toy": 1, "notebook": NOTEBOOKS}
    assert workflow.planned() == PUBLISHING | once


def test_a_changed_tuning_job_reruns_the_variant_that_it_tunes_and_what_depends_on_that(finished, tmp_path):
    workflow = finished.copy(tmp_path)
    workflow.edit("toy.py", "weights=(0.9, 1.0)", "weights=(0.8, 1.0)")
    once = {"estimate": 2, "figures_toy": 1, "manifest": 1, "report": 1, "notebook": NOTEBOOKS, "complete": 1, "all": 1}
    assert workflow.planned() == once


def test_changed_code_reruns_every_job_that_uses_it(finished, tmp_path):
    workflow = finished.copy(tmp_path)
    workflow.edit("toykernel.py", "weight * readings", "(weight + 1e-3) * readings")
    assert workflow.planned() == EVERYTHING


def test_a_missing_published_table_is_made_again(finished, tmp_path):
    workflow = finished.copy(tmp_path)
    (workflow.folder / "results" / "toy" / "tables" / "table-1.csv").unlink()
    assert workflow.planned()["tables_toy"] == 1


@pytest.mark.parametrize("ensemble", ["smoke", "full"])
def test_other_ensembles_write_below_build_only(finished, ensemble):
    run = finished("--cores", "1", "--dry-run", config=(f"ensemble={ensemble}",))
    outputs = [line.split("output: ")[1] for line in run.stdout.splitlines() if line.strip().startswith("output: ")]
    assert outputs
    assert all(name.startswith(f"build/{ensemble}/") for line in outputs for name in line.split(", "))


def test_one_core_and_two_give_the_same_bytes(finished, fresh):
    run = fresh("--cores", "1")
    assert run.returncode == 0, run.stderr
    assert fresh.published() == finished.published()
    complete = [(workflow.folder / "build" / "complete.json").read_bytes() for workflow in (fresh, finished)]
    assert complete[0] == complete[1]


def test_a_failing_step_says_why_in_one_line_and_leaves_what_is_published(finished, tmp_path):
    workflow = finished.copy(tmp_path)
    workflow.edit("toy.py", "    drawing = Drawing()\n", '    raise RuntimeError("no pen")\n')
    workflow.edit("toy.py", 'Figure("figure-01", "Errors"', 'Figure("figure-01", "The errors"')
    run = workflow("--cores", "2")
    assert run.returncode == 1
    assert "robins: figures_toy: RuntimeError: no pen (see build/standard/logs/toy/figures.log)" in run.stderr.splitlines()
    assert workflow.published() == finished.published()


def test_a_negative_count_is_refused_and_results_stay(finished, tmp_path):
    workflow = finished.copy(tmp_path)
    line = workflow.refusal("sizes={toy: {standard: {runs: -5}}}")
    assert line == "robins: --config: sizes.toy.standard.runs: found -5, expected a whole number, one or more"


def test_the_default_profile_is_understood(fresh):
    assert fresh.planned("--workflow-profile", str(ROOT / "workflow" / "profiles" / "default")) == EVERYTHING


def test_lint_has_nothing_to_say(fresh):
    run = fresh("--lint")
    assert "Congratulations" in run.stderr + run.stdout
    assert run.returncode == 0


def test_no_rule_names_a_paper_or_uses_a_run_directive():
    keys = [path.stem for path in (ROOT / "data" / "published").glob("*.csv")]
    for path in [ROOT / "Snakefile", *(ROOT / "workflow" / "rules").glob("*.smk")]:
        text = path.read_text()
        assert not any(key in text for key in keys), path
        assert "run:" not in text.split(), path


def test_scripts_are_thin():
    for path in (ROOT / "workflow" / "scripts").glob("*.py"):
        assert len(path.read_text().splitlines()) <= 30, path
