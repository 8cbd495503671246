"""What surrounds every step: signs of life, failures in one line, and results that a product has not asked for."""

import time
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest

from robins.evaluate import storage
from robins.foundation.errors import InputError
from robins.papers import pipeline, steps
from robins.papers.configuration import Configuration
from robins.papers.protocol import Job, Output

from .conftest import PLUGIN, ROOT


@pytest.fixture
def script(tmp_path):
    """What Snakemake hands to a script, as far as `running` looks at it."""
    return SimpleNamespace(rule="estimate", wildcards=["toy", "plain"], log=[str(tmp_path / "logs" / "plain.log")])


def test_a_long_step_says_that_it_is_alive(script, monkeypatch, capsys):
    monkeypatch.setattr(steps, "HEARTBEAT", 0.01)
    with steps.running(script):
        time.sleep(0.1)
    lines = capsys.readouterr().err.splitlines()
    assert lines
    assert set(lines) == {"robins: estimate toy plain: 0 s"}
    assert Path(script.log[0]).read_text().startswith("estimate toy plain: 0.1 s")


def test_a_failure_is_one_line_and_its_traceback_goes_to_the_log(script, capsys):
    with pytest.raises(SystemExit) as ended, steps.running(script):
        raise RuntimeError("first line\nno pen")
    assert ended.value.code == 1
    assert capsys.readouterr().err == f"robins: estimate toy plain: RuntimeError: no pen (see {script.log[0]})\n"
    assert "Traceback" in Path(script.log[0]).read_text()


def test_bad_input_found_in_a_step_reads_as_it_does_at_the_door(script, capsys):
    with pytest.raises(SystemExit), steps.running(script):
        raise InputError("data.csv", "row 3", "text", "a number")
    assert capsys.readouterr().err == "robins: estimate toy plain: data.csv: row 3: found text, expected a number\n"


def desk(*jobs):
    """The desk of a paper that has these jobs."""
    paper = SimpleNamespace(
        key="toy",
        sizes={"smoke": {"runs": 8, "sweep_runs": 2, "tuning_runs": 5, "bootstrap": 200}},
        options={"level": 3.0},
        first_runs={"tuning_runs": 1000},
        published=PLUGIN / "toy.csv",
        scenarios=(),
        jobs={job.name: job for job in jobs},
    )
    return steps.Desk(paper, Configuration("smoke", 1, ("toy",)), pipeline.Layout(ROOT, "smoke"))


def test_an_output_says_which_runs_it_reports_and_which_its_filters_were_tuned_on():
    metadata = desk().metadata
    assert metadata["reporting_runs"] == {"runs": "0 to 7", "sweep_runs": "0 to 1"}
    assert metadata["tuning_runs"] == {"tuning_runs": "1000 to 1004"}


def test_a_result_that_is_not_among_the_needs_is_refused():
    with pytest.raises(LookupError, match="'shrunk' is not among the needs"):
        desk().results(["plain"]).table("shrunk")


def test_a_job_is_handed_what_it_needs_and_no_published_number(tmp_path, monkeypatch):
    def tuned(settings, results):
        with pytest.raises(LookupError, match="'other' is not among the needs"):
            results.table("other")
        assert results.published.empty and results.ledger is None
        return Output(settings.options["level"] * results.table("tuning"))

    tuning = Job("tuning", "", lambda settings: Output(pd.DataFrame({"weight": [0.5]})), ())
    at = desk(tuning, Job("tuned", "", tuned, (), needs=("tuning",)))
    monkeypatch.chdir(tmp_path)
    for name in ("tuning", "tuned"):
        steps.compute(at, name)
    table, _ = storage.read_output(*at.layout.outputs(at.paper, "tuned"))
    assert table["weight"].tolist() == [1.5]
    assert not at.published.empty
