"""Verdicts: the closed list, the translation of the papers' words, and the decision tables."""

import itertools

import numpy as np
import pytest

from robins.evaluate.intervals import Interval, RatioSummary, paired_ratio
from robins.evaluate.verdicts import HOUSE_WORD, Verdict, combine, ratio_rule
from robins.foundation.randomness import stream

HOUSE_LIST = {
    "replicated", "direction only", "not replicated", "inconclusive", "compatible but uninformative",
    "depends on assumption", "refuted", "untestable", "n too small",
}  # fmt: skip
BELOW, ABOVE, ACROSS = (0.8, 0.9), (1.1, 1.2), (0.9, 1.1)


def summary(interval, central=(0.5, 1.5), n=1000, numerator_failed=0, denominator_failed=0, bca=None, survivors=None):
    low, high = interval
    bca_low, bca_high = bca or interval
    survivors = n - max(numerator_failed, denominator_failed) if survivors is None else survivors
    share = Interval(0.5, 0.4, 0.6, n)
    middle = float(np.sqrt(low * high))
    return RatioSummary(
        middle, low, high, bca_low, bca_high, low, high, share, *central, middle, n, survivors, numerator_failed, denominator_failed
    )


def test_the_list_of_verdicts_is_closed():
    assert {str(word) for word in Verdict} == HOUSE_LIST


def test_every_word_of_the_papers_plans_maps_to_a_house_word():
    assert set(HOUSE_WORD.values()) <= set(Verdict)
    assert {str(word) for word in HOUSE_WORD.values()} <= HOUSE_LIST


@pytest.mark.parametrize(
    "word, verdict",
    [
        ("direction-only", "direction only"),
        ("depends on units", "depends on assumption"),
        ("depends on baseline", "depends on assumption"),
        ("baseline-dependent", "depends on assumption"),
        ("partly", "depends on assumption"),
        ("compatible/uninformative", "compatible but uninformative"),
        ("not reproduced", "not replicated"),
        ("not supported", "not replicated"),
    ],
)
def test_words_that_differ_from_the_house_are_translated(word, verdict):
    assert HOUSE_WORD[word] == verdict


def test_a_word_that_is_also_a_house_word_keeps_its_meaning():
    for word, verdict in HOUSE_WORD.items():
        assert word not in HOUSE_LIST or word == verdict


DECISIONS = {
    # (where the interval lies, published ratio inside the central range): verdict when claimed better, when claimed worse
    (BELOW, True): ("replicated", "not replicated"),
    (BELOW, False): ("direction only", "not replicated"),
    (ABOVE, True): ("not replicated", "replicated"),
    (ABOVE, False): ("not replicated", "direction only"),
    (ACROSS, True): ("inconclusive", "inconclusive"),
    (ACROSS, False): ("inconclusive", "inconclusive"),
}


@pytest.mark.parametrize("interval, inside", DECISIONS)
@pytest.mark.parametrize("side", ["better", "worse"])
@pytest.mark.parametrize("failed", ["none", "few", "numerator", "denominator"])
def test_decision_table_of_the_ratio_rule(interval, inside, side, failed):
    counts = {"none": (0, 0), "few": (50, 50), "numerator": (51, 0), "denominator": (0, 51)}[failed]
    case = summary(interval, numerator_failed=counts[0], denominator_failed=counts[1])
    expected = DECISIONS[interval, inside][side == "worse"]
    if expected == "replicated" and failed in ("numerator", "denominator"):
        expected = "direction only"
    verdict, reason = ratio_rule(case, side, 0.7 if inside else 0.2, 1000)
    assert verdict == expected
    assert ("failed in" in reason) == (failed != "none")


@pytest.mark.parametrize("interval", [(0.8, 1.0), (1.0, 1.2), (1.0, 1.0)])
def test_an_interval_that_touches_one_contains_it(interval):
    assert ratio_rule(summary(interval), "better", 0.7, 1)[0] == "inconclusive"


@pytest.mark.parametrize("published", [0.5, 1.5])
def test_the_ends_of_the_central_range_belong_to_it(published):
    assert ratio_rule(summary(BELOW), "better", published, 1)[0] == "replicated"


def test_too_few_runs_go_before_everything_else():
    verdict, reason = ratio_rule(summary(BELOW, n=999), "better", 0.7, 1000)
    assert verdict == "n too small" and "999" in reason and "1000" in reason


def test_without_survivors_nothing_is_replicated():
    for side in ("better", "worse"):
        verdict, reason = ratio_rule(summary(BELOW, n=10, numerator_failed=10), side, 0.7, 10)
        assert verdict == "not replicated" and "failed in 10" in reason and "  " not in reason


def test_losses_can_take_an_advantage_away():
    errors = np.array([0.94, 0.95, 0.96] * 13 + [1.5])
    generators = (stream(0, f"test/verdicts/{run}/losses") for run in range(2))
    lost = np.zeros(42, dtype=bool)
    lost[-2:] = True  # 2 of 42 is below the limit
    survivors = paired_ratio(errors, np.ones(40), next(generators))
    everyone = paired_ratio(np.append(errors, [np.nan] * 2), np.ones(42), next(generators), numerator_failed=lost)
    assert (everyone.estimate, everyone.high) == (survivors.estimate, survivors.high)
    assert ratio_rule(survivors, "better", 0.95, 1)[0] == "replicated"
    assert ratio_rule(everyone, "better", 0.95, 1)[0] == "inconclusive"


def test_the_reason_carries_the_numbers():
    _, reason = ratio_rule(summary((0.8123, 0.8456), central=(0.4321, 1.2345)), "better", 0.54, 1000)
    for text in ("0.829", "0.812", "0.846", "1000 runs", "0.54", "0.432", "1.23", "inside"):
        assert text in reason


def test_the_reason_says_when_the_bootstrap_disagrees():
    assert "would decide otherwise" in ratio_rule(summary(BELOW, bca=ACROSS), "better", 0.7, 1)[1]
    assert "would decide otherwise" not in ratio_rule(summary(BELOW), "better", 0.7, 1)[1]


def test_identical_filters_are_inconclusive_and_the_reason_says_so():
    errors = np.array([1.0, 2.0, 3.0])
    verdict, reason = ratio_rule(paired_ratio(errors, errors, stream(0, "test/verdicts/0/same")), "better", 0.9, 1)
    assert verdict == "inconclusive" and "same error in every run" in reason


def test_an_unknown_side_is_refused():
    with pytest.raises(ValueError, match="claimed side"):
        ratio_rule(summary(BELOW), "smaller", 0.7, 1)


@pytest.mark.parametrize("word", sorted(HOUSE_LIST))
def test_branches_that_agree_give_their_verdict(word):
    verdict, reason = combine({"deg": word, "rad": word})
    assert verdict == word and "deg" in reason and "rad" in reason


@pytest.mark.parametrize("first, second", list(itertools.combinations(sorted(HOUSE_LIST - {"n too small"}), 2)))
def test_branches_that_differ_depend_on_the_assumption_and_are_named(first, second):
    verdict, reason = combine({"deg": first, "rad": second})
    assert verdict == "depends on assumption"
    assert f"deg: {first}" in reason and f"rad: {second}" in reason


def test_replicated_and_direction_only_agree_on_the_direction_alone():
    verdict, reason = combine({"deg": "replicated", "rad": "direction only"})
    assert verdict == "depends on assumption" and "direction is the claimed one throughout" in reason
    assert "direction is" not in combine({"deg": "replicated", "rad": "not replicated"})[1]


@pytest.mark.parametrize("second", ["inconclusive", "replicated", "direction only", "depends on assumption"])
def test_a_direction_that_no_branch_shows_is_said_to_be_missing(second):
    reason = combine({"deg": "not replicated", "rad": second})[1]
    assert ("claimed direction is found in none" in reason) == (second == "inconclusive")


def test_one_branch_with_too_few_runs_makes_the_whole_too_small():
    assert combine({"deg": "replicated", "rad": "n too small"})[0] == "n too small"


def test_nothing_to_combine_and_unknown_words_are_refused():
    with pytest.raises(ValueError, match="no verdict"):
        combine({})
    with pytest.raises(ValueError, match="maybe"):
        combine({"deg": "maybe"})
