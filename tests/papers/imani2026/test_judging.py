"""The rule for an improvement reaches every verdict, and the words for several of them follow from theirs."""

from types import SimpleNamespace

import numpy as np
import pytest

from robins.evaluate.ensembles import Improvement
from robins.evaluate.verdicts import Verdict
from robins.papers.imani2026.judging import (
    HEADLINE,
    MINIMUM,
    OTHERS,
    Cell,
    cells_of,
    cells_row,
    combine_many,
    conjunction,
    improvement_row,
    improvement_rule,
    majority,
    side_of_zero,
    sweep_cases,
    tally,
)

ABOVE, WITHIN, BELOW = (Verdict.DIRECTION_ONLY, Verdict.INCONCLUSIVE, Verdict.NOT_REPLICATED)


def found(low, high, n=100, lost=0, won=0, survivors=None, p=0.001) -> Improvement:
    return Improvement((low + high) / 2, low, high, p, n, lost, won, n - lost - won if survivors is None else survivors)


@pytest.mark.parametrize(
    ("improvement", "p", "verdict", "words"),
    [
        (found(0.3, 0.5), 0.01, Verdict.REPLICATED, "reaches 37 %"),
        (found(0.4, 0.5), 0.01, Verdict.REPLICATED, "reaches 37 %"),
        (found(0.1, 0.3), 0.01, Verdict.DIRECTION_ONLY, "ends below 37 %"),
        (found(-0.1, 0.6), 0.01, Verdict.INCONCLUSIVE, "the interval contains 0"),
        (found(0.1, 0.6), 0.06, Verdict.INCONCLUSIVE, "counts as containing 0"),
        (found(-0.6, -0.1), 0.01, Verdict.NOT_REPLICATED, "lies below 0"),
        (found(-0.6, -0.1), 0.06, Verdict.INCONCLUSIVE, "counts as containing 0"),
        (found(0.3, 0.5, n=99), 0.01, Verdict.TOO_SMALL, "at least 100"),
        (found(0.3, 0.5, lost=6), 0.01, Verdict.DIRECTION_ONLY, "never replicated"),
        (found(0.3, 0.5, won=6), 0.01, Verdict.DIRECTION_ONLY, "denominator's in 6 of 100"),
        (found(0.3, 0.5, lost=5), 0.01, Verdict.REPLICATED, "numerator's filter failed in 5"),
        (found(-np.inf, np.inf, lost=100), 1.0, Verdict.NOT_REPLICATED, "Fewer than two runs survive"),
        (found(-np.inf, np.inf, lost=99), 1.0, Verdict.NOT_REPLICATED, "Fewer than two runs survive"),
    ],
)
def test_the_numeric_rule(improvement, p, verdict, words):
    given = improvement_rule(improvement, p, 100, 0.37)
    assert given[0] == verdict and words in given[1]
    assert "inf" not in given[1] and "nan" not in given[1]


def test_without_a_published_number_the_best_word_is_the_claim_s():
    assert improvement_rule(found(0.1, 0.2), 0.01, 100)[0] == Verdict.REPLICATED
    assert improvement_rule(found(0.1, 0.2), 0.01, 100, best=Verdict.DIRECTION_ONLY)[0] == Verdict.DIRECTION_ONLY
    assert improvement_rule(found(0.1, 0.2, lost=6), 0.01, 100)[0] == Verdict.DIRECTION_ONLY


def test_an_interval_that_ends_at_zero_contains_it():
    assert [side_of_zero(found(*ends), 0.01) for ends in ((0.0, 0.1), (-0.1, 0.0), (0.01, 0.1), (-0.1, -0.01))] == [
        "neither", "neither", "above", "below",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("verdicts", "everywhere", "mostly"),
    [
        ([ABOVE] * 12, ABOVE, ABOVE),
        ([Verdict.REPLICATED] * 12, Verdict.REPLICATED, ABOVE),
        ([ABOVE] * 7 + [BELOW] * 5, BELOW, ABOVE),
        ([ABOVE] * 6 + [BELOW] * 6, BELOW, BELOW),
        ([ABOVE] * 6 + [WITHIN] * 6, WITHIN, WITHIN),
        ([ABOVE] * 6 + [WITHIN] + [BELOW] * 5, BELOW, WITHIN),
        ([WITHIN] * 6 + [BELOW] * 6, BELOW, BELOW),
        ([ABOVE] * 11 + [Verdict.TOO_SMALL], Verdict.TOO_SMALL, Verdict.TOO_SMALL),
    ],
)
def test_words_for_all_and_for_most(verdicts, everywhere, mostly):
    assert (conjunction(verdicts), majority(verdicts)) == (everywhere, mostly)


def cell(channel, verdict, improvement=None):
    return Cell(channel, "rmse", improvement or found(0.1, 0.2), verdict, "Because.")


def test_a_tally_names_all_but_the_commonest_kind():
    told = tally([cell("v_e", ABOVE), cell("v_n", ABOVE), cell("w_u", BELOW)])
    assert (
        told == "Of 3 intervals 2 above 0, 0 containing 0 or off it only before Holm, 1 below 0 or without surviving runs (omega_u rmse)."
    )


def test_a_row_of_one_cell_has_its_numbers_and_one_of_several_has_a_count():
    one = cells_row("C4", "q", HEADLINE, [cell("v_e", ABOVE)])
    assert [one.ours, one.ci_low, one.ci_high] == pytest.approx([15.0, 10.0, 20.0]) and one.unit == "%"
    several = cells_row("C4", "q", HEADLINE, [cell("v_e", ABOVE), cell("v_n", WITHIN)])
    assert (several.ours, several.ci_low, several.verdict) == ("1 of 2 improve", "", WITHIN)


def test_a_row_without_an_interval_says_failed():
    lost = found(-np.inf, np.inf, lost=99)
    row = improvement_row("C1", "q", "F1", HEADLINE, cell("v_e", BELOW, lost))
    assert (row.ours, row.ci_low, row.ci_high) == ("failed", "", "")


def test_channels_that_disagree_depend_and_are_named():
    verdict, reason = combine_many({"V_e": ABOVE, "V_n": ABOVE, "V_u": BELOW})
    assert verdict == Verdict.DEPENDS and reason == "2 of 3 direction only, 1 not replicated (V_u)."


def test_holm_is_taken_over_twelve_channels_whichever_are_asked_for():
    p_values = np.full(12, 0.9)
    p_values[0] = 0.01  # times twelve: 0.12
    many = Improvement(np.full(12, 0.2), np.full(12, 0.1), np.full(12, 0.3), p_values, 100, 0, 0, 100)
    case = SimpleNamespace(compare=lambda results, metric: many, size="runs")
    (only,) = cells_of(None, case, ("v_e",))
    assert only.verdict == Verdict.INCONCLUSIVE and "Holm p 0.12" in only.reason


def test_conditions_have_names_of_their_own_and_the_least_runs_of_their_kind():
    results = SimpleNamespace(settings=SimpleNamespace(options={"rates_hz": [1, 10, 50]}))
    cases = [HEADLINE, *OTHERS, *sweep_cases(results)]
    assert len({case.words for case in cases}) == len(cases)
    assert {case.words: MINIMUM[case.size] for case in cases if "Hz" in case.words} == {
        f"F1, {rate} Hz, {noise}": 5 if rate > 10 else 20 for rate in (1, 10, 50) for noise in ("equal sample", "equal psd")
    }
    assert {MINIMUM[case.size] for case in cases if not case.study} == {100}
