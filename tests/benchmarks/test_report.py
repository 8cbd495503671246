"""Interleaving, what Snakemake noted, the command line and the record; nothing here depends on a time."""

import json
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from benchmarks import __main__ as entry
from benchmarks import goals, steps, system, whole_runs
from benchmarks.rounds import interleave, ratio
from robins.papers import all_papers
from robins.papers.ghouneem2024 import cost


def test_candidates_take_turns():
    calls = []
    seconds = interleave({"a": lambda: calls.append("a"), "b": lambda: calls.append("b")}, rounds=3, shortest=1e-12)
    assert "".join(calls) == "ab" * 4  # once before the first round
    assert all(each.shape == (3,) and (each > 0).all() for each in seconds.values())


def test_a_ratio_is_that_of_the_minima_with_the_span_of_single_rounds():
    seconds = {"ours": np.array([2.0, 1.0, 4.0]), "peer": np.array([4.0, 10.0, 8.0])}
    assert ratio(seconds, "ours", "peer") == {"of_minima": 0.25, "least": 0.1, "greatest": 0.5}


def test_core_seconds_add_up_for_each_paper(tmp_path):
    folder = tmp_path / "benchmarks" / "toy2024"
    folder.mkdir(parents=True)
    header = "s\th:m:s\tmax_rss\tcpu_time\n"
    (folder / "one.tsv").write_text(header + "3.5\t0:00:03\t100.0\t2.5\n")
    (folder / "too-short-to-see.tsv").write_text(header + "0.25\t0:00:00\tNA\tNA\n")
    assert system.core_seconds(tmp_path) == {"toy2024": {"one": 2.5, "too": 0.25}}
    assert system.core_seconds(tmp_path / "elsewhere") == {}


def test_the_description_of_the_machine_holds_no_path():
    described = json.dumps(system.machine())
    assert str(Path.home()) not in described and str(Path(sys.prefix)) not in described and "/bin/" not in described


@pytest.mark.parametrize(("value", "text"), [(1 / 18, "1/18.0"), (1.5, "1.50")])
def test_a_ratio_below_one_is_a_fraction(value, text):
    assert goals.as_fraction(value) == text


@pytest.mark.parametrize(("value", "word"), [(1.0, "good"), (1.3, "met"), (1.6, "MISSED")])
def test_a_goal_is_judged(value, word):
    assert goals.verdict(value, required=1.5, good=1.1) == word


def test_too_few_rounds_are_refused(capsys):
    with pytest.raises(SystemExit):
        entry.main(["--rounds", "6"])
    assert "--rounds: found 6, expected 7 or more" in capsys.readouterr().err


def test_a_missing_peer_says_why(capsys):
    each = {"unit weights": np.array([1e-3]), "filterpy": np.array([2e-2])}
    steps.show_steps("9 states", each, {"unit weights": {"filterpy": ratio(each, "unit weights", "filterpy")}}, "no C compiler")
    printed = capsys.readouterr().out
    assert "not measured: no C compiler" in printed and "against filterpy: 1/20.0" in printed and "against C" not in printed


def measure_nothing(monkeypatch):
    for part in ("steps", "pairs", "propagation", "runs"):
        monkeypatch.setattr(entry, f"measure_{part}", lambda rounds: {})
    monkeypatch.setattr(entry, "measure_system", lambda: {})


def test_a_record_is_written_only_on_demand(tmp_path, monkeypatch):
    monkeypatch.setattr(entry, "ROOT", tmp_path)
    measure_nothing(monkeypatch)
    monkeypatch.setattr(entry, "measure_steps", lambda rounds: {"rounds": rounds})
    (tmp_path / "benchmarks").mkdir()
    entry.main([])
    assert not list(tmp_path.rglob("*.json"))
    entry.main(["--record", "quiet", "--rounds", "9"])
    written = json.loads((tmp_path / "benchmarks" / "records" / "quiet.json").read_text())
    assert written["steps"] == {"rounds": 9} and written["machine"]["numba"]
    assert set(written) == {"machine", "steps", "pairs", "propagation", "runs", "system"}


def test_a_ratio_without_a_goal_is_shown_and_not_judged(capsys):
    each = {"unit weights": np.array([1e-3]), "filterpy": np.array([2e-2]), "C": np.array([1e-3])}
    ratios = {"unit weights": {peer: ratio(each, "unit weights", peer) for peer in ("filterpy", "C")}}
    steps.show_steps("21 error states", each, ratios, "")
    printed = capsys.readouterr().out
    assert "1/20.0" in printed and "against C: 1.00" in printed and "against filterpy" not in printed


def test_every_case_has_a_goal_against_c_and_9_states_against_filterpy():
    assert set(steps.GOALS) == set(steps.CASES) and all(goal["C"] == (1.5, 1.1) for goal in steps.GOALS.values())
    assert {case for case, goal in steps.GOALS.items() if "filterpy" in goal} == {"9 states", "9 states, UKF"}
    assert steps.GOALS["9 states, UKF"]["filterpy"] == (1 / 80, 1 / 110)


def test_every_published_paper_has_a_goal_for_its_ensemble():
    assert set(entry.CORE_SECONDS_GOALS) == set(all_papers())


def test_a_pair_has_what_the_cost_of_ghouneem2024_is_read_from(monkeypatch, tmp_path, capsys):
    """`robins.papers.ghouneem2024.cost` makes a row of the record, whose ratio is that of the two minima."""
    monkeypatch.setattr(steps.ours, "run_ours", lambda recorded, weights: None)
    pairs = steps.measure_pairs(7)
    path = tmp_path / "ghouneem2024.json"
    path.write_text(json.dumps({"machine": {"cores": 2}, "pairs": pairs}))
    monkeypatch.setattr(cost, "RECORD", path)
    row = cost.cost(None, recorded=cost.record()).table.iloc[0]
    assert row["ratio"] == pytest.approx(row["ukf_us"] / row["ekf_us"]) and row["rounds"] == 7 and row["machine"] == "cores 2"
    assert row["least"] <= row["greatest"]
    assert "UKF over EKF, 9 states" in capsys.readouterr().out


def test_the_runs_of_ghouneem2024_last_half_an_hour_with_a_fix_in_each_second():
    for name in ("ekf-f", "ukf"):
        assert whole_runs.drive_run(name)[0] == {"predictions": 36000, "updates": 1800}


def test_a_run_is_judged_in_milliseconds(monkeypatch, capsys):
    monkeypatch.setattr(whole_runs, "strapdown_run", lambda: ({"predictions": 9, "updates": 10}, lambda: None))
    slow = {"ekf-f": 0.05, "ukf": 0.0}  # seconds; the goals are 40 ms and 160 ms
    monkeypatch.setattr(whole_runs, "drive_run", lambda name: ({"predictions": 36, "updates": 2}, lambda: time.sleep(slow[name])))
    found = whole_runs.measure_runs(7)
    assert set(found) == set(whole_runs.GOALS) and found["ghouneem2024, UKF"]["updates"] == 2
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[-1] for line in lines if line] == ["good", "MISSED", "good"]


@pytest.mark.parametrize(("load", "warned"), [(0.1, False), (1.7, True), (None, False)])
def test_a_busy_machine_is_called_so(load, warned, monkeypatch, capsys):
    monkeypatch.setattr(system, "machine", lambda: {"load": load})
    measure_nothing(monkeypatch)
    entry.main([])
    assert ("flatter us" in capsys.readouterr().out) is warned
