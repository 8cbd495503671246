"""Rules for claims that name a value, and the rows of the ledger."""

import numpy as np
import pytest

from robins.evaluate.intervals import paired_ratio
from robins.evaluate.verdicts import Verdict
from robins.papers.hajiyev2023.judging import MINIMUM, combine_many, ends, equality_rule, no_change_rule, ratio_row, without_interval


@pytest.mark.parametrize(
    ("low", "high", "n", "expected"),
    [
        (7.9, 8.1, MINIMUM, Verdict.REPLICATED),
        (8.0, 8.1, MINIMUM, Verdict.REPLICATED),
        (8.01, 8.1, MINIMUM, Verdict.REFUTED),
        (7.8, 7.99, MINIMUM, Verdict.REFUTED),
        (8.01, 8.1, MINIMUM - 1, Verdict.TOO_SMALL),
    ],
)
def test_an_identity_is_refuted_by_an_interval_that_leaves_its_value_out(low, high, n, expected):
    assert equality_rule(low, high, 8.0, n)[0] == expected


@pytest.mark.parametrize(
    ("low", "high", "n", "expected"),
    [
        (0.96, 1.04, MINIMUM, Verdict.REPLICATED),
        (0.94, 1.04, MINIMUM, Verdict.INCONCLUSIVE),
        (0.5, 2.0, MINIMUM, Verdict.INCONCLUSIVE),
        (1.06, 1.2, MINIMUM, Verdict.NOT_REPLICATED),
        (0.8, 0.94, MINIMUM, Verdict.NOT_REPLICATED),
        (0.96, 1.04, MINIMUM - 1, Verdict.TOO_SMALL),
    ],
)
def test_no_change_means_an_interval_within_five_per_cent_of_one(low, high, n, expected):
    assert no_change_rule(low, high, n)[0] == expected


def test_many_verdicts_are_counted_and_the_exceptions_named():
    verdict, reason = combine_many({"u": "replicated", "w": "not replicated", "q": "replicated"})
    assert verdict == Verdict.DEPENDS
    assert reason == "2 of 3 replicated, 1 not replicated (w)."
    assert combine_many(dict.fromkeys("uwq", "refuted")) == (Verdict.REFUTED, "3 of 3 refuted.")


@pytest.mark.parametrize(
    ("verdicts", "begins"),
    [
        ({"deg, u": "replicated", "deg, w": "refuted", "rad, u": "replicated"}, True),
        ({"deg, u": "replicated", "deg, w": "replicated", "rad, u": "refuted"}, False),
        ({"deg, u": "replicated", "deg, w": "n too small"}, False),
    ],
)
def test_partly_is_said_where_parts_of_one_branch_disagree_and_not_where_only_branches_do(verdicts, begins):
    assert combine_many(verdicts)[1].startswith("Partly: ") == begins


def test_a_row_without_a_surviving_run_says_so_and_has_no_interval():
    failed = np.ones(5, bool)
    summary = paired_ratio(np.ones(5), np.ones(5), np.random.default_rng(1), 50, failed)
    row = ratio_row("C1", "ratio", "deg, fault", summary, "a/b", Verdict.NOT_REPLICATED, "Reason.")
    assert (row.ours, row.ci_low, row.ci_high) == ("failed", "", "")
    assert ends(0.0, np.inf) == ("", "")
    assert without_interval("C1", "ratio", 5, "a/b", "untestable", "Reason.").condition == "overall"
