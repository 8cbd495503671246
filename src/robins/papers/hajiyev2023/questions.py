"""The questions that the study has to answer (brief, section 0), each with an answer built from the numbers.

A sentence is chosen by the data alone: "better" and "worse" where the 95 % interval of the geometric mean ratio lies
wholly below or above 1, "no clear difference" where it contains 1. No outcome is assumed.
"""

from collections.abc import Iterable, Mapping

import numpy as np
import pandas as pd

from robins.evaluate.intervals import TIE, log_interval
from robins.evaluate.verdicts import side_of_one
from robins.navigation.aircraft import STATES
from robins.papers.columns import counts, keys, make, texts
from robins.papers.hajiyev2023.comparisons import ADAPTED, AMDKF, FAULTY, LATERAL, MDKF, Pair, ratio, scores
from robins.papers.hajiyev2023.scenario import BRANCHES
from robins.papers.hajiyev2023.studies import PLAIN
from robins.papers.hajiyev2023.table_parts import SUBSTITUTE
from robins.papers.hajiyev2023.tables_errors import LAGGED, lagged
from robins.papers.hajiyev2023.tables_study import healthy_scale, specification_logs
from robins.papers.protocol import Results, Table

CORRECTED, AUGMENTED = Pair("abh", "bh"), Pair("aakf", "akf")
GATED = Pair("amdkf-gated", MDKF)
SIDES = {"better": "better", "worse": "worse", "neither": "no clear difference"}
ONE_PERCENT = np.log(1.01)


def side(results: Results, pair: Pair, branch: str, condition: str, state: str) -> str:
    """``better``, ``worse`` or ``neither``, by the interval with failed runs as losses."""
    found = ratio(results, pair, branch, condition, state)
    return side_of_one(found.verdict_low, found.verdict_high)


def estimate(results: Results, pair: Pair, branch: str, condition: str, state: str) -> str:
    """The geometric mean to three digits behind the point (it is mostly near 1), or ``failed``."""
    value = ratio(results, pair, branch, condition, state).estimate
    return f"{value:.3f}" if np.isfinite(value) else "failed"


def tally(results: Results, pair: Pair, branch: str, condition: str, states: Iterable[str] = STATES) -> str:
    """``better u 0.972, w 0.483; worse ...`` of a pair."""
    parts = []
    for word, words in SIDES.items():
        named = [state for state in states if side(results, pair, branch, condition, state) == word]
        if named:
            parts.append(f"{words} " + ", ".join(f"{state} {estimate(results, pair, branch, condition, state)}" for state in named))
    return "; ".join(parts)


def by_branch(results: Results, pair: Pair, condition: str, states: Iterable[str] = STATES) -> str:
    """`tally` of every branch as one sentence."""
    return ". ".join(f"{branch}: {tally(results, pair, branch, condition, tuple(states))}" for branch in BRANCHES)


def better_or_worse(results: Results) -> str:
    """Q1."""
    return f"With the fault, {by_branch(results, ADAPTED, 'fault')}. Without, {by_branch(results, ADAPTED, 'healthy')}."


def faulty_channels(results: Results) -> str:
    """Q2."""
    parts = []
    for branch in BRANCHES:
        helped = [state for state in FAULTY if side(results, ADAPTED, branch, "fault", state) == "better"]
        verdict = {0: "it helps in neither", 1: f"it helps in {' '.join(helped)} only", 2: "it helps in both"}[len(helped)]
        parts.append(f"{branch}: {verdict} ({tally(results, ADAPTED, branch, 'fault', FAULTY)})")
    return ". ".join(parts) + "."


def corrected_filters(results: Results) -> str:
    """Q3."""
    parts = []
    for pair, words in ((CORRECTED, "ABH over BH"), (AUGMENTED, "AAKF over AKF")):
        for branch in BRANCHES:
            other = [s for s in STATES if side(results, pair, branch, "fault", s) != side(results, ADAPTED, branch, "fault", s)]
            verdict = (
                f"another answer than AMDKF over MDKF in {' '.join(other)}"
                if other
                else "the answer of AMDKF over MDKF in all eight states"
            )
            parts.append(f"{words}, {branch}: {verdict} ({tally(results, pair, branch, 'fault')})")
    return ". ".join(parts) + "."


def units(results: Results) -> str:
    """Q4."""
    sides = {state: [side(results, ADAPTED, branch, "fault", state) for branch in BRANCHES] for state in STATES}
    differing = [state for state, found in sides.items() if len(set(found)) > 1]
    found = {state: [np.log(ratio(results, ADAPTED, branch, "fault", state).estimate) for branch in BRANCHES] for state in LATERAL}
    same = all(abs(first - second) < TIE for first, second in found.values())
    words = ", ".join(f"{s} ({'; '.join(f'{b}: {SIDES[w]}' for b, w in zip(BRANCHES, sides[s], strict=True))})" for s in differing)
    answer = f"Yes, in {words}" if differing else "No: every state has the same answer in both branches"
    return f"{answer}. The lateral ratios are {'equal' if same else 'not equal'} in both branches."


def sweep_spread(results: Results, branch: str, pair: str) -> Mapping[str, tuple[int, int, float, float]]:
    """By state: settings whose interval lies below 1, all settings, and the least and the largest mean ratio."""
    table = results.table(f"sweep-{branch}")
    table = table[(table["pair"] == pair) & ~table["failed"]]
    spread = {}
    for state, group in table.groupby("state", sort=False):
        logs = np.log(group["numerator"]) - np.log(group["denominator"])
        found = np.exp([log_interval(each.to_numpy()) for _, each in logs.groupby([group["sweep"], group["setting"]], sort=False)])
        spread[state] = int(np.sum(found[:, 2] < 1)), len(found), found[:, 0].min(), found[:, 0].max()
    return spread


def sensitivity(results: Results) -> str:
    """Q5."""
    parts = []
    for branch in BRANCHES:
        for pair, words in ((ADAPTED.name, "AMDKF over MDKF"), (PLAIN, "AAKF over AKF")):
            spread = sweep_spread(results, branch, pair)
            told = ", ".join(f"{state} {low:.3g} to {high:.3g} ({below} of {n})" for state, (below, n, low, high) in spread.items())
            parts.append(f"{words}, {branch}, least to largest ratio of the sweeps (settings clearly below 1): {told}")
        logs = specification_logs(results, branch)[ADAPTED.name]
        shares = 100 * np.mean(np.where(np.isfinite(logs), logs, np.inf) < 0, axis=0)  # a set without survivors is no success
        told = ", ".join(f"{state} {share:.1f}" for state, share in zip(STATES, shares, strict=True))
        parts.append(f"Random sets with AMDKF better, {branch}, in per cent: {told}")
    return ". ".join(parts) + "."


def false_alarm(results: Results) -> str:
    """Q6."""
    branch = BRANCHES[0]
    logs = [[np.log(ratio(results, ADAPTED, branch, condition, state).estimate) for condition in ("fault", "healthy")] for state in LATERAL]
    same = all(abs(fault - healthy) < TIE for fault, healthy in logs)
    found = scores(results, AMDKF, branch, "healthy")
    mean, expected = np.mean(found.scale[~found.failed], axis=0), healthy_scale(results, branch)
    scales = ", ".join(f"{state} {mean[i]:.3g} ({expected[i]:.3g})" for i, state in enumerate(STATES) if state in LATERAL)
    gated = [abs(np.log(ratio(results, GATED, branch, "fault", state).estimate)) for state in LATERAL]
    word = "brings all four within 1 % of 1" if max(gated) < ONE_PERCENT else "does not bring all four within 1 % of 1"
    return (
        f"The lateral ratios with the fault {'equal' if same else 'differ from'} those without "
        f"({tally(results, ADAPTED, branch, 'healthy', LATERAL)}). Healthy scale factors, measured (formula): {scales}. Gating {word} "
        f"({tally(results, GATED, branch, 'fault', LATERAL)})."
    )


def other_filters(results: Results) -> str:
    """Q7."""
    parts = []
    for denominator, words in (("ckf", "MDKF over CKF"), ("ckf-inflated", "MDKF over CKF with inflated R"), ("akf", "MDKF over AKF")):
        pair = Pair(MDKF, denominator)
        parts += [f"{words}, {branch}: {tally(results, pair, branch, 'fault')}" for branch in BRANCHES]
    return "Delayed estimates, with the fault. " + ". ".join(parts) + "."


def one_step_late(results: Results) -> str:
    """A2."""
    parts = []
    for (kind, branch), group in lagged(results).groupby(["filter", "branch"], sort=False):
        late = group.loc[group["nearer"] == "late", "state"].tolist()
        parts.append(f"{kind}, {branch}: the late form is nearer in {len(late)} of {len(group)} states{' (' * bool(late)}"
                     f"{' '.join(late)}{')' * bool(late)}")  # fmt: skip
    return f"Mean RMSE beside the published number, late form against the printed one. {'; '.join(parts)}."


ASKED = (
    ("Q1", "Is AMDKF better or worse than MDKF in each state, with the fault and without?", better_or_worse, "extra-ratios"),
    ("Q2", "Does adaptation help in the two faulty channels?", faulty_channels, "extra-ratios"),
    ("Q3", "Does the same adaptation act differently on a corrected or an augmented filter?", corrected_filters, "extra-ratios"),
    ("Q4", "Does the answer depend on the units of Table 1?", units, "extra-ratios"),
    ("Q5", "How much does it depend on everything else?", sensitivity, "extra-sweeps, extra-specification"),
    ("Q6", "Do the lateral changes come from max(1, .) of equation (23)?", false_alarm, "extra-scale-factors, extra-ratios"),
    ("Q7", "How does MDKF compare with CKF and AKF?", other_filters, "extra-ratios"),
    ("A2", "Could the authors' program have been one step late?", one_step_late, "extra-lagged"),
)


def questions(results: Results) -> pd.DataFrame:
    """Every question with its answer and the tables that hold the evidence."""
    rows = [(key, question, answer(results), evidence) for key, question, answer, evidence in ASKED]
    frame = pd.DataFrame(rows, columns=["question", "asked", "answer", "evidence"])
    return frame.assign(n=results.settings.sizes["runs"])[["question", "asked", "answer", "evidence", "n"]]


QUESTIONS: tuple[Table, ...] = (
    make(
        "extra-questions", "The study's questions and their answers", questions,
        (keys("question"), texts("asked"), texts("answer", kind="prose"), texts("evidence"), counts("n")),
        (
            MDKF, AMDKF, *LAGGED.values(), "amdkf-gated", "bh", "abh", "akf", "aakf", "ckf", "ckf-inflated",
            *(f"{study}-{branch}" for study in ("sweep", "specification") for branch in BRANCHES),
        ),
        f"{SUBSTITUTE} better, worse: the 95 % interval of the geometric mean ratio lies below, above 1; the number is the mean."
        " Estimates of x(k) use z(0..k+1).",
    ),
)  # fmt: skip
"""The table of questions."""
