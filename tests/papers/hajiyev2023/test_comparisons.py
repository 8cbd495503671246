"""Scores by run, paired ratios made once, units as labelled, and the rules that need no published number."""

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.intervals import paired_ratio
from robins.evaluate.published import read_published
from robins.evaluate.verdicts import Verdict
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023 import comparisons
from robins.papers.hajiyev2023.comparisons import ADAPTED, Pair, direction_rule
from robins.papers.protocol import Output, Results, Settings

RUNS = 40
RANDOM = np.random.default_rng(11)
LEVELS = {name: np.exp(RANDOM.normal(size=(2, RUNS, 8))) for name in ("mdkf-printed", "amdkf-printed", "akf")}


def table(name, shuffled=False) -> pd.DataFrame:
    """A variant with independent errors with and without the fault; without it they are divided by 3."""
    frames = []
    kinds = ["filtered", "delayed"] if name == "akf" else ["delayed"]
    for k, kind in enumerate(kinds):
        for c, condition in enumerate(("fault", "healthy")):
            frames.append(pd.DataFrame({
                "branch": "deg", "condition": condition, "estimate": kind, "run": np.repeat(np.arange(RUNS), 8),
                "state": np.tile(STATES, RUNS), "rmse": (LEVELS[name][c] * (k + 1) / (1 + 2 * c)).ravel(), "scale": 1.0, "gain_norm": 1.0,
                "own_gain": 1.0, "nis_settled": 8.0, "nis_window": 8.0, "failed": False,
            }))  # fmt: skip
    whole = pd.concat(frames, ignore_index=True)
    return whole.sort_values("run", ascending=False, kind="stable") if shuffled else whole


def results(published=None, loaded=None, **changes) -> Results:
    def load(name):
        if loaded is not None:
            loaded.append(name)
        return Output(table(name, **changes))

    return Results(Settings("smoke", 1, {"runs": RUNS, "bootstrap": 100}), published, load)


def test_scores_are_arranged_by_run_and_state_whatever_the_order_of_the_rows():
    for shuffled in (False, True):
        found = comparisons.scores(results(shuffled=shuffled), "akf", "deg", "fault", "delayed")
        assert np.array_equal(found.rmse, 2 * LEVELS["akf"][0])
        assert found.failed.shape == found.nis_settled.shape == (RUNS,)


def test_a_table_without_one_row_for_each_run_and_state_is_refused():
    broken = table("akf").replace({"state": {"u": "w"}})
    with pytest.raises(ValueError, match="akf, deg, fault, filtered"):
        comparisons.scores(Results(Settings("smoke", 1, {}), None, lambda name: Output(broken)), "akf", "deg", "fault")


def test_a_ratio_pairs_the_runs_and_reads_the_kind_of_estimate_that_the_pair_names():
    seen = results()
    for pair, numerator in ((Pair("akf", "mdkf-printed"), 2), (Pair("akf", "mdkf-printed", "filtered"), 1)):
        found = comparisons.ratio(seen, pair, "deg", "fault", "theta")
        logs = np.log(numerator * LEVELS["akf"][0, :, 3] / LEVELS["mdkf-printed"][0, :, 3])
        assert found.estimate == pytest.approx(np.exp(logs.mean()))
        assert found.n == RUNS
    assert Pair("akf", "mdkf-printed", "filtered").kinds == ("filtered", "delayed")


def test_a_ratio_is_computed_once_for_a_results_and_is_the_same_in_another():
    first, second = results(), results()
    one = comparisons.ratio(first, ADAPTED, "deg", "fault", "u")
    assert comparisons.ratio(first, ADAPTED, "deg", "fault", "u") is one
    again = comparisons.ratio(second, ADAPTED, "deg", "fault", "u")
    assert again is not one and again == one


def test_each_comparison_has_a_bootstrap_stream_of_its_own(monkeypatch):
    names = []

    def stream(seed, name):
        names.append(name)
        return np.random.default_rng(0)

    monkeypatch.setattr(comparisons, "stream", stream)
    seen = results()
    for state in STATES:
        for condition in ("fault", "healthy"):
            for pair in (ADAPTED, Pair("akf", "mdkf-printed"), Pair("akf", "mdkf-printed", "filtered")):
                comparisons.ratio(seen, pair, "deg", condition, state)
        comparisons.fault_ratio(seen, "mdkf-printed", "rmse", "deg", state)
        comparisons.fault_ratio(seen, "mdkf-printed", "scale", "deg", state)
        comparisons.harm_ratio(seen, ADAPTED, "deg", state)
    assert len(names) == len(set(names)) == 8 * (6 + 3)
    assert all(name.split("/")[:2] == ["hajiyev2023", "bootstrap"] and name.split("/")[2].isdigit() for name in names)


def test_harm_is_the_ratio_of_what_the_fault_does_to_both():
    seen = results()
    above, below = (comparisons.fault_ratio(seen, name, "rmse", "deg", "q").estimate for name in ADAPTED.needs)
    assert comparisons.harm_ratio(seen, ADAPTED, "deg", "q").estimate == pytest.approx(above / below)


def test_angles_are_labelled_by_branch_and_velocities_are_not():
    assert [comparisons.unit(state, "deg") for state in STATES] == ["m/s", "m/s", "deg/s", "deg", "deg", "deg/s", "deg/s", "deg"]
    assert comparisons.unit("q", "rad") == "rad/s"
    assert comparisons.labelled(np.pi, "theta", "deg") == pytest.approx(180)
    assert comparisons.labelled(np.pi, "theta", "rad") == comparisons.labelled(np.pi, "u", "deg") == np.pi


def test_published_ratios_are_those_of_the_brief(repository):
    """Section 2.3 of the brief prints them to three digits."""
    published = read_published(repository / "data" / "published" / "hajiyev2023.csv")
    found = [comparisons.published_ratio(results(published), state) for state in STATES]
    assert found == pytest.approx([0.540, 0.968, 0.813, 0.650, 1.136, 1.689, 1.056, 1.161], abs=6e-4)


def test_expected_scale_factors_are_those_of_check_t12():
    settings = Settings("smoke", 1, {}, {"plant": "f4c"})
    for branch in ("deg", "rad"):
        found = comparisons.expected_scale(Results(settings, None, None), branch)
        assert found == pytest.approx({"q": 55.9, "theta": 13.6}, rel=0.005)


@pytest.mark.parametrize(
    ("centre", "side", "expected"),
    [
        (0.8, "better", Verdict.DIRECTION_ONLY),
        (0.8, "worse", Verdict.NOT_REPLICATED),
        (1.25, "worse", Verdict.DIRECTION_ONLY),
        (1.25, "better", Verdict.NOT_REPLICATED),
        (1.0, "better", Verdict.INCONCLUSIVE),
    ],
)
def test_without_a_published_number_only_the_side_of_one_counts(centre, side, expected):
    spread = np.exp(0.1 * np.linspace(-1, 1, 200))
    summary = paired_ratio(centre * spread, np.ones(200), np.random.default_rng(1), 50)
    verdict, reason = direction_rule(summary, side, 200)
    assert verdict == expected
    assert "below 1" in reason if side == "better" else "above 1" in reason
    assert direction_rule(summary, side, 201)[0] == Verdict.TOO_SMALL
    best = direction_rule(summary, side, 200, Verdict.REPLICATED)[0]
    assert best == (Verdict.REPLICATED if expected == Verdict.DIRECTION_ONLY else expected)


def test_failures_keep_a_direction_from_its_best_word():
    failed = np.arange(200) < 11
    summary = paired_ratio(np.full(200, 0.5), np.ones(200), np.random.default_rng(1), 50, failed)
    assert direction_rule(summary, "better", 200, Verdict.REPLICATED)[0] == Verdict.DIRECTION_ONLY
    nothing = paired_ratio(np.ones(9), np.ones(9), np.random.default_rng(1), 50, np.ones(9, bool))
    assert direction_rule(nothing, "better", 9)[0] == Verdict.NOT_REPLICATED
