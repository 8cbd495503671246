"""Rows are found by their labels, ratios are paired by run, and Shapley values share out the whole change."""

from itertools import permutations

import numpy as np
import pandas as pd
import pytest

from robins.papers.ghouneem2024.comparisons import (
    PARTS,
    anova_shares,
    attribution,
    mean_of,
    ratio_of,
    rows,
    shapley,
    values,
    variant,
    where,
)
from robins.papers.ghouneem2024.variants import BASELINES, VARIANTS
from robins.papers.protocol import Output, Results, Settings

RUNS = 60
CELLS = {"none": frozenset(), "gate": frozenset({"gate"}), "st": frozenset({"self-tuning"}), "st-gate": frozenset({"self-tuning", "gate"})}


def noise(name: str, runs: int = RUNS) -> np.ndarray:
    return np.random.default_rng(sum(map(ord, name))).standard_normal(runs)


def table(horizontal, failed=(), first=100, **labels) -> pd.DataFrame:
    """Rows of a job: one measure by run."""
    horizontal = np.broadcast_to(horizontal, RUNS).astype(float)
    lost = np.isin(np.arange(RUNS), failed)
    return pd.DataFrame({**labels, "run": first + np.arange(RUNS), "horizontal": np.where(lost, np.nan, horizontal), "failed": lost})


def results_of(load) -> Results:
    settings = Settings("standard", 1, {"runs": RUNS, "bootstrap": 300})
    return Results(settings, pd.DataFrame(), lambda name: Output(load(name)))


def named(**tables) -> Results:
    by_name = {name.replace("_", "-"): value for name, value in tables.items()}
    return results_of(by_name.__getitem__)


def test_a_tuned_variant_has_the_settings_of_a_trajectory_and_an_untuned_one_has_none():
    assert dict(variant("ukf-st-gate", "t2").labels) == {"trajectory": "t2", "frozen": "t1"}
    assert dict(variant("ukf-st-gate", "t2", "t2").labels) == {"trajectory": "t2", "frozen": "t2"}
    for name in ("ekf-pi", "gps-only", "ekf-f-nis"):
        assert dict(variant(name, "t1", "t2").labels) == {"trajectory": "t1", "frozen": "none"}


def test_rows_are_found_by_labels_in_the_order_of_the_runs():
    both = pd.concat([table(2.0, cause="outages", multiple=np.inf), table(3.0, cause="multipath", multiple=0.5)])
    results = named(cause=both.sample(frac=1.0, random_state=1))
    found = rows(results, where("cause", cause="outages", multiple=np.inf))
    assert found["run"].tolist() == list(range(100, 100 + RUNS)) and set(found["horizontal"]) == {2.0}
    with pytest.raises(LookupError, match="no row"):
        rows(results, where("cause", cause="outages", multiple=0.5))


def test_a_ratio_pairs_equal_runs_and_leaves_out_those_that_only_one_side_has():
    run = np.exp(noise("runs"))
    few = table(0.5 * run, trajectory="t1")[10:22].sample(frac=1.0, random_state=2)
    results = named(few=few, all=table(run, trajectory="t1"))
    found = ratio_of(results, where("few", trajectory="t1"), where("all", trajectory="t1"), "horizontal")
    assert (found.estimate, found.low, found.high) == pytest.approx((0.5, 0.5, 0.5)) and found.n == 12


def test_a_failed_run_counts_on_its_side_only():
    results = named(a=table(0.5, failed=[3], trajectory="t1"), b=table(1.0, failed=[4, 5], trajectory="t1"))
    found = ratio_of(results, where("a", trajectory="t1"), where("b", trajectory="t1"), "horizontal")
    assert (found.numerator_failed, found.denominator_failed, found.survivors) == (1, 2, RUNS - 3)
    assert mean_of(results, where("a", trajectory="t1"), "horizontal").failed == 1
    assert values(results, where("b", trajectory="t1"), "horizontal")[1].nonzero()[0].tolist() == [4, 5]


def test_an_interval_does_not_depend_on_what_was_asked_before():
    def fresh() -> Results:
        return named(a=table(np.exp(noise("a")), trajectory="t1"), b=table(np.exp(noise("b")), trajectory="t1"))

    at = [where(name, trajectory="t1") for name in "ab"]
    first, second = fresh(), fresh()
    ratio_of(first, at[1], at[0], "horizontal")
    mean_of(first, at[0], "horizontal")
    assert ratio_of(first, *at, "horizontal") == ratio_of(second, *at, "horizontal")


def factorial(effects: dict[frozenset, float], spread: float = 0.0, failed: dict[str, list] | None = None) -> Results:
    """A factorial whose log error is the sum of the effects of every subset of parts that a cell has, plus noise of its own."""

    def load(name: str) -> pd.DataFrame:
        composition = VARIANTS[name].composition
        parts = CELLS[composition["cell"]] | ({"filter"} if composition["filter"] == "ukf" else set())
        log = sum(effect for subset, effect in effects.items() if subset <= parts) + spread * noise(name) + noise("run")
        frozen = ("none",) if composition["cell"] == "none" else ("t1", "t2")
        lost = (failed or {}).get(name, ())
        return pd.concat([table(np.exp(log), lost, trajectory=place, frozen=one) for place in ("t1", "t2") for one in frozen])

    return results_of(load)


EFFECTS = {
    frozenset({"filter"}): -1.0, frozenset({"self-tuning"}): 0.2, frozenset({"gate"}): -0.3,
    frozenset({"filter", "gate"}): 0.4, frozenset({"filter", "self-tuning", "gate"}): 0.6,
}  # fmt: skip


def test_shapley_values_share_interactions_equally_among_their_parts():
    found = attribution(factorial(EFFECTS), "ekf-pi", "t1")
    by_hand = {"filter": -1.0 + 0.4 / 2 + 0.6 / 3, "self-tuning": 0.2 + 0.6 / 3, "gate": -0.3 + 0.4 / 2 + 0.6 / 3}
    for part, expected in by_hand.items():
        assert [found.parts[part].estimate, found.parts[part].low, found.parts[part].high] == pytest.approx([expected] * 3, abs=1e-9)


@pytest.mark.parametrize("baseline", BASELINES)
def test_the_parts_add_up_to_the_whole_change(baseline):
    found = attribution(factorial(EFFECTS, spread=0.5), baseline, "t2", "t2")
    assert sum(part.estimate for part in found.parts.values()) == pytest.approx(found.total.estimate)
    for part in (*found.parts.values(), found.total):
        assert part.low < part.estimate < part.high and part.n == RUNS
    new, old = factorial(EFFECTS, spread=0.5), variant(baseline, "t2")
    ratio = ratio_of(new, variant("ukf-st-gate", "t2", "t2"), old, "horizontal")
    assert np.exp(found.total.estimate) == pytest.approx(ratio.estimate)


def test_a_shapley_value_is_the_mean_over_all_orders_of_adding_the_parts():
    cells = {frozenset(parts): np.array([float(number)]) for number, parts in enumerate(subsets())}
    for part in PARTS:
        orders = []
        for order in permutations(PARTS):
            before = frozenset(order[: order.index(part)])
            orders.append(cells[before | {part}] - cells[before])
        assert shapley(cells, part) == pytest.approx(np.mean(orders))


def subsets() -> list[tuple]:
    return [tuple(part for part, chosen in zip(PARTS, bits, strict=True) if chosen) for bits in np.ndindex(2, 2, 2)]


def test_a_run_that_fails_in_one_cell_is_left_out_of_all():
    found = attribution(factorial(EFFECTS, failed={"ekf-pi-gate": [0, 1], "ukf": [1, 2]}), "ekf-pi", "t1")
    assert found.failed == 3 and found.total.n == RUNS
    assert found.total.estimate == pytest.approx(sum(EFFECTS.values()))
    none = attribution(factorial(EFFECTS, failed={"ukf": list(range(RUNS))}), "ekf-pi", "t1")
    assert none.failed == RUNS and np.isnan(none.total.estimate) and np.isinf([none.total.low, none.total.high]).all()


def test_anova_shares_add_up_to_one_and_name_the_only_effect():
    shares = anova_shares(factorial({frozenset({"gate"}): 2.0}, spread=1e-3), "ekf-pi", "t1")
    assert sum(shares.values()) == pytest.approx(1.0)
    runs_share = np.var(noise("run")) / (np.var(noise("run")) + 1.0)  # a factor of two levels, +-1 about its mean
    assert shares["run"] == pytest.approx(runs_share, abs=1e-3) and shares["gate"] == pytest.approx(1 - runs_share, abs=1e-3)
    assert {"filter x self-tuning x gate", "residual"} < set(shares)
