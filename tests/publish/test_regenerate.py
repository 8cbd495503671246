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


def test_a_workflow_runs_whole_in_an_empty_directory_and_is_refused_where_nothing_is_to_be_done(toy, capsys):
    assert regenerate.run(toy, toy / "run", ["word=hello"], 1, 2) == 3
    assert (toy / "run" / "b.txt").read_text() == "hello\n"
    assert "3 of 3 steps (100%) done" in capsys.readouterr().out
    with pytest.raises(InputError, match="found 0"):
        regenerate.run(toy, toy / "run", ["word=hello"], 1, 1)


def test_a_workflow_with_fewer_jobs_than_the_registry_is_refused(toy):
    with pytest.raises(InputError, match="jobs planned in an empty directory: found 3, expected at least 4"):
        regenerate.run(toy, toy / "run", ["word=hello"], 1, 4)


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


@pytest.fixture
def clone(reference, paper, published, tmp_path, monkeypatch):
    """A clone with one made-up paper, whose workflow copies the results in `clone/outcome`."""
    shutil.copytree(reference, tmp_path / "tests" / "reference")
    shutil.copytree(reference, tmp_path / "results")
    shutil.copytree(reference, tmp_path / "outcome")
    (tmp_path / "data" / "published").mkdir(parents=True)
    (tmp_path / "data" / "published" / "nobody1999.csv").touch()
    monkeypatch.setattr("robins.papers.all_papers", lambda: {"nobody1999": paper})
    monkeypatch.setattr("robins.evaluate.published.read_published", lambda path: published[path.stem])

    def run(repository, folder, config, cores, least):
        ensemble = dict(entry.split("=") for entry in config)["ensemble"]
        assert list(folder.iterdir()) == []
        shutil.copytree(tmp_path / "outcome", folder / ("results" if ensemble == "standard" else f"build/{ensemble}/results"))
        return 7

    monkeypatch.setattr(regenerate, "run", run)
    return tmp_path


@pytest.mark.parametrize("ensemble", ["smoke", "standard"])
def test_the_command_is_green_on_equal_results_and_red_on_a_changed_cell(ensemble, clone, capsys):
    command = ["--ensemble", ensemble, "--repository", str(clone)]
    assert regenerate.main(command) == 0
    assert "7 jobs executed; 3 tables, 64 cells compared; largest relative difference 0; 0 differences" in capsys.readouterr().out
    table = clone / "outcome" / "nobody1999" / "tables" / "table-1.csv"
    table.write_text(table.read_text().replace("1.37,", "1.38,"))
    assert regenerate.main(command) == 1
    assert "row (classical, q), rmse: found 1.38, expected 1.37" in capsys.readouterr().err


def test_the_command_makes_a_new_reference_when_asked(clone):
    table = clone / "outcome" / "nobody1999" / "tables" / "table-1.csv"
    table.write_text(table.read_text().replace("1.37,", "1.38,"))
    assert regenerate.main(["--ensemble", "smoke", "--repository", str(clone), "--update-reference"]) == 0
    assert regenerate.main(["--ensemble", "smoke", "--repository", str(clone)]) == 0
    assert regenerate.main(["--ensemble", "standard", "--repository", str(clone)]) == 1


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
