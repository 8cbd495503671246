"""The rules behind the verdicts, one branch at a time; what the paper prints; rows with and without numbers."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.intervals import Interval, proportion_interval
from robins.evaluate.published import read_published
from robins.evaluate.verdicts import Verdict
from robins.papers.ghouneem2024.claims_ratios import level_rule
from robins.papers.ghouneem2024.claims_settings import (
    frozen_setting,
    in_sample_setting,
    other_settings,
    printed_ratio,
)
from robins.papers.ghouneem2024.claims_sigma_points import gain_rule
from robins.papers.ghouneem2024.comparisons import GeometricRatio, where
from robins.papers.ghouneem2024.judging import (
    change_rule,
    closing_row,
    most_rule,
    numeric_row,
    ratio_row,
    ratio_rule,
    sooner,
    times,
    together,
    unchanged_rule,
    weakest,
)
from robins.papers.ghouneem2024.trajectories import KEY
from robins.papers.protocol import Output, Results, Settings

YES, DIRECTION, NO, OPEN = Verdict.REPLICATED, Verdict.DIRECTION_ONLY, Verdict.NOT_REPLICATED, Verdict.INCONCLUSIVE
DEPENDS, SMALL = Verdict.DEPENDS, Verdict.TOO_SMALL


def ratio(low, high, n=50, lost=0, won=0, estimate=None) -> GeometricRatio:
    estimate = np.sqrt(low * high) if estimate is None else estimate
    return GeometricRatio(estimate, low, high, proportion_interval(0, n), n, n - lost - won, lost, won)


NOTHING = ratio(0.0, np.inf, lost=50, estimate=float("nan"))


@pytest.mark.parametrize(
    ("found", "published", "verdict", "words"),
    [
        (ratio(0.4, 0.6), 0.49, YES, "within a factor 1.5"),
        (ratio(0.4, 0.6), 0.74, DIRECTION, "not within a factor 1.5"),
        (ratio(0.4, 0.6), 0.32, DIRECTION, "not within"),
        (ratio(0.4, 0.6), None, YES, "lies below 1"),
        (ratio(0.8, 1.0), 0.9, OPEN, "contains 1"),
        (ratio(1.1, 1.4), 0.9, NO, "lies above 1"),
        (ratio(0.4, 0.6, n=49), 0.49, SMALL, "at least 50"),
        (ratio(0.4, 0.6, lost=3), 0.49, DIRECTION, "never replicated"),
        (ratio(0.4, 0.6, won=3), 0.49, DIRECTION, "denominator's in 3 of 50"),
        (ratio(0.4, 0.6, lost=2), 0.49, YES, "numerator's filter failed in 2"),
        (NOTHING, 0.49, NO, "Fewer than two runs survive"),
        (ratio(0.0, np.inf, lost=49, estimate=0.5), 0.49, NO, "Fewer than two runs survive"),
    ],
)
def test_the_rule_for_one_baseline(found, published, verdict, words):
    given, reason = ratio_rule(found, 50, published)
    assert given == verdict and words in reason
    assert "nan" not in reason and "inf" not in reason


def test_a_factor_of_exactly_one_and_a_half_is_the_same_size():
    found = ratio(0.4, 0.6, estimate=0.5)
    assert [ratio_rule(found, 50, size)[0] for size in (0.75, 0.751)] == [YES, DIRECTION]


@pytest.mark.parametrize(
    ("found", "verdict"),
    [
        (ratio(0.96, 1.04), YES),
        (ratio(0.96, 1.06), OPEN),
        (ratio(0.94, 1.0), OPEN),
        (ratio(0.5, 2.0), OPEN),
        (ratio(0.8, 0.94), NO),
        (ratio(1.06, 1.2), NO),
        (ratio(0.99, 1.01, lost=3), OPEN),
        (ratio(0.99, 1.01, n=49), SMALL),
        (NOTHING, NO),
    ],
)
def test_unchanged_needs_the_whole_interval_within_five_per_cent(found, verdict):
    assert unchanged_rule(found, 50)[0] == verdict


@pytest.mark.parametrize(
    ("found", "verdict"),
    [
        (ratio(0.8, 0.9), YES),
        (ratio(0.92, 0.99, estimate=0.96), NO),  # better, but by less than five per cent
        (ratio(0.9, 0.99, estimate=0.94), YES),
        (ratio(0.97, 1.02), NO),  # excludes a gain of five per cent
        (ratio(0.8, 1.1), OPEN),
        (ratio(1.01, 1.2), NO),
        (ratio(0.8, 0.9, lost=3), DIRECTION),
        (ratio(0.8, 0.9, n=49), SMALL),
        (NOTHING, NO),
    ],
)
def test_a_gain_is_significant_and_material(found, verdict):
    assert gain_rule(found, 50)[0] == verdict


@pytest.mark.parametrize(
    ("low", "high", "failed", "n", "verdict"),
    [
        (-0.4, -0.1, 0, 50, YES),
        (-0.4, -0.1, 2, 50, YES),
        (-0.4, -0.1, 3, 50, DIRECTION),
        (-0.4, 0.0, 0, 50, OPEN),
        (0.1, 0.4, 0, 50, NO),
        (-np.inf, np.inf, 50, 50, NO),
        (-0.4, -0.1, 0, 49, SMALL),
    ],
)
def test_a_part_contributes_where_its_interval_lies_below_zero(low, high, failed, n, verdict):
    given, reason = change_rule(Interval((low + high) / 2 if np.isfinite(low) else np.nan, low, high, n), failed, 50)
    assert given == verdict and "nan" not in reason
    assert not failed or n < 50 or f"{failed} of {n} runs failed" in reason


@pytest.mark.parametrize(("wins", "n", "verdict"), [(12, 12, YES), (10, 12, YES), (8, 12, OPEN), (1, 12, NO), (0, 12, NO), (11, 11, SMALL)])
def test_most_runs_are_counted_with_wilsons_interval(wins, n, verdict):
    given, reason = most_rule(proportion_interval(wins, n), 12, "It holds")
    assert given == verdict and (verdict == SMALL or f"of {n} runs" in reason)


@pytest.mark.parametrize(
    ("verdicts", "expected"),
    [
        ((YES, YES), YES),
        ((YES, DIRECTION), DIRECTION),
        ((DIRECTION, DIRECTION), DIRECTION),
        ((YES, OPEN), DEPENDS),
        ((DIRECTION, NO), DEPENDS),
        ((DEPENDS, NO), DEPENDS),
        ((OPEN, OPEN), OPEN),
        ((OPEN, NO), NO),
        ((NO, NO), NO),
        ((YES, SMALL), SMALL),
    ],
)
def test_both_baselines_have_to_agree(verdicts, expected):
    assert together(verdicts) == together(reversed(verdicts)) == expected


def test_the_weakest_word_decides_for_several_channels():
    order = [SMALL, NO, OPEN, DEPENDS, DIRECTION, YES]
    for place, word in enumerate(order):
        assert weakest(reversed(order[place:])) == word


@pytest.mark.parametrize(
    ("level", "verdict"), [(5.0, Verdict.COMPATIBLE), (500.0, NO), (0.1, NO)]
)  # fmt: skip
def test_a_level_is_compatible_where_single_runs_have_it(level, verdict):
    assert level_rule(np.linspace(1.0, 100.0, 50), level, 50)[0] == verdict
    assert level_rule(np.linspace(1.0, 100.0, 49), level, 50)[0] == SMALL
    lost = level_rule(np.full(50, np.inf), level, 50)
    assert lost == (NO, "All runs fail.")
    half = level_rule(np.r_[np.full(40, 1.0), np.full(10, np.inf)], 500.0, 50)
    assert half[0] == Verdict.COMPATIBLE and "inf" not in half[1]


def test_ratios_of_the_published_tables_are_those_of_the_brief(repository):
    results = SimpleNamespace(published=read_published(repository / "data" / "published" / f"{KEY}.csv"))
    channels = ("azimuth", "v_east", "v_north", "v_up", "north", "east", "height", "horizontal")
    brief = {
        "t1": (0.279, 0.517, 0.452, 0.995, 0.437, 0.651, 0.237, 0.544),
        "t2": (0.444, 0.573, 0.365, 0.754, 0.258, 0.435, 0.267, 0.284),
    }
    for place, expected in brief.items():
        assert [printed_ratio(results, place, channel) for channel in channels] == pytest.approx(expected, abs=5.5e-4)


def test_the_row_that_closes_a_claim_shows_what_speaks_least_for_it():
    rows = [ratio_row("C", "q", "c", ratio(low, high), name, verdict, "r", published=0.3)
            for name, low, high, verdict in (("a", 0.1, 0.2, YES), ("b", 0.8, 1.1, OPEN), ("c", 0.8, 1.2, OPEN))]  # fmt: skip
    closing = closing_row("C", "q", DEPENDS, "because", rows)
    assert (closing.variant, closing.ci_high, closing.published, closing.condition) == ("c", 1.2, 0.3, "overall")
    assert closing_row("C", "q", DEPENDS, "because", rows, larger=True).variant == "b"
    lost = ratio_row("C", "q", "c", NOTHING, "lost", OPEN, "r")
    assert closing_row("C", "q", NO, "because", [*rows, lost]).ours == "failed"


def test_a_row_without_an_interval_says_failed():
    row = ratio_row("C3", "q", "T1-frozen", NOTHING, "a/b", NO, "r")
    assert (row.ours, row.ci_low, row.ci_high) == ("failed", "", "")
    row = numeric_row("C1", "q", "c", Interval(2.0, 1.0, 3.0, 5), 5, "a", YES, "r", factor=10.0)
    assert (row.ours, row.ci_low, row.ci_high) == (20.0, 10.0, 30.0)


def settled(**by_name) -> Results:
    """A job for each name: seconds until settled by run, NaN where it failed."""

    def load(name: str) -> Output:
        seconds = np.array(by_name[name], float)
        return Output(pd.DataFrame({"place": "t1", "run": np.arange(seconds.size), "settled": seconds, "failed": np.isnan(seconds)}))

    return Results(Settings("standard", 1, {}), pd.DataFrame(), load)


def test_a_failed_run_never_settles():
    assert times(settled(a=[1.0, np.nan, np.inf]), where("a", place="t1")).tolist() == [1.0, np.inf, np.inf]


def test_sooner_means_by_more_than_a_second_and_in_more_pairs_than_later():
    results = settled(a=[1.0, 1.0, np.inf, 5.0, 1.0], b=[2.5, 1.9, np.inf, 1.0, np.nan])
    pair = where("a", place="t1"), where("b", place="t1")
    assert sooner(results, [pair]).estimate == pytest.approx(2 / 5)  # the first and the last
    assert sooner(results, [pair[::-1]]).estimate == pytest.approx(1 / 5)
    assert sooner(results, [pair, pair[::-1]]).estimate == 0.0


def test_settings_have_names_of_their_own_and_the_least_runs_of_their_kind():
    for place in ("t1", "t2"):
        found = [frozen_setting(place), *other_settings(place)]
        assert len({setting.words for setting in found}) == len(found)
        assert [setting.size for setting in found] == ["runs", "runs", "in_sample_runs", *["side_runs"] * 4]
    assert dict(in_sample_setting("t2").new.labels) == {"trajectory": "t2", "filter": "ukf", "cell": "st-gate"}
    assert dict(frozen_setting("t1", "t2").baseline("ekf-pm").labels) == {"trajectory": "t1", "frozen": "none"}
