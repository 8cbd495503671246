"""What surrounds every step: signs of life, failures in one line, and results that a product has not asked for."""

import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from robins.foundation.errors import InputError
from robins.papers import pipeline, steps
from robins.papers.configuration import Configuration

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


def test_a_result_that_is_not_among_the_needs_is_refused():
    paper = SimpleNamespace(key="toy", sizes={}, options={}, published=PLUGIN / "toy.csv")
    at = steps.Desk(paper, Configuration("smoke", 1, ("toy",)), pipeline.Layout(ROOT, "smoke"))
    with pytest.raises(LookupError, match="'shrunk' is not among the needs"):
        at.results(["plain"]).table("shrunk")
