"""The regeneration counts what ran, in an empty directory, and believes nothing else."""

import json
import shutil

import pytest

from robins.foundation.errors import InputError
from robins.publish import regenerate
from robins.publish.check import Comparison

SNAKEFILE = """
rule all:
    input: "b.txt"
rule a:
    output: "a.txt"
    shell: "echo {config[word]} > {output}"
rule b:
    input: "a.txt"
    output: "b.txt"
    shell: "cp {input} {output}"
"""
PLAN = "Job stats:\njob      count\n-----  -------\na            1\nall          1\ntotal        2\n\n"


def test_jobs_are_counted_in_the_plan_and_in_what_ran():
    assert regenerate.planned_jobs(PLAN + "rule a:\n" + PLAN) == 2
    assert regenerate.executed_jobs("1 of 2 steps (50%) done\n2 of 2 steps (100%) done\n") == 2


def test_nothing_to_be_done_counts_as_nothing():
    text = "Building DAG of jobs...\nNothing to be done (all requested files are present and up to date).\n"
    assert regenerate.planned_jobs(text) == 0
    assert regenerate.executed_jobs(text) == 0
    assert regenerate.executed_jobs("1 of 2 steps (50%) done\n") == 0


@pytest.fixture
def toy(tmp_path):
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    (tmp_path / "run").mkdir()
    return tmp_path


def test_a_workflow_runs_whole_in_the_empty_directory(toy, capsys):
    assert regenerate.run(toy, toy / "run", ["word=hello"], 1, 2) == 3
    assert (toy / "run" / "b.txt").read_text() == "hello\n"
    assert "3 of 3 steps (100%) done" in capsys.readouterr().out


def test_a_workflow_with_fewer_jobs_than_the_registry_is_refused(toy):
    with pytest.raises(InputError, match="jobs planned in an empty directory: found 3, expected at least 4"):
        regenerate.run(toy, toy / "run", ["word=hello"], 1, 4)


def test_a_workflow_that_has_nothing_to_do_is_refused(toy):
    regenerate.run(toy, toy / "run", ["word=hello"], 1, 1)
    with pytest.raises(InputError, match="found 0"):
        regenerate.run(toy, toy / "run", ["word=hello"], 1, 1)


def test_a_workflow_that_fails_is_an_error(toy, capsys):
    with pytest.raises(InputError, match="exit code"):
        regenerate.run(toy, toy / "run", ["other=hello"], 1, 1)
    assert "word" in capsys.readouterr().err


def test_the_report_says_what_was_compared_and_what_was_skipped(capsys):
    assert regenerate.report(Comparison([], 3, 42, 1.5e-12), 17, ["laser-gyro.csv"]) == 0
    out = capsys.readouterr().out
    assert "17 jobs executed; 3 tables, 42 cells compared; largest relative difference 1.5e-12" in out
    assert "skipped field/laser-gyro.csv" in out
    assert regenerate.report(Comparison(["a difference"], 3, 42), 17, []) == 1
    assert "robins: a difference" in capsys.readouterr().err


def test_a_new_reference_holds_tables_claims_and_manifest_only(reference, tmp_path):
    results = shutil.copytree(reference, tmp_path / "results")
    target = tmp_path / "tests" / "reference"
    target.mkdir(parents=True)
    (target / "stale.csv").write_text("old")
    regenerate.replace_reference(results, target)
    names = sorted(path.relative_to(target).as_posix() for path in target.rglob("*") if path.is_file())
    tables = [f"nobody1999/tables/{name}.csv" for name in ("extra-parameters", "table-1")]
    assert names == ["claims.csv", "manifest.json", *tables]
    assert json.loads((target / "manifest.json").read_text())["artefacts"]
    assert sorted(path.name for path in target.parent.iterdir()) == ["reference"]


def test_only_a_smoke_run_can_become_the_reference(capsys):
    with pytest.raises(SystemExit):
        regenerate.main(["--ensemble", "standard", "--update-reference"])
    assert "needs --ensemble smoke" in capsys.readouterr().err
