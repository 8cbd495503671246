"""Every claim is judged by its rule: fabricated runs with a known answer, and a small ensemble that is too small for any."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from robins.evaluate.ledger import Row, build_ledger
from robins.evaluate.published import claim_ids, read_published
from robins.evaluate.verdicts import Verdict
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023 import PAPER, claims_theory
from robins.papers.hajiyev2023.claims import CLAIMS, RATIO_CLAIMS, SUPPORTING, together
from robins.papers.hajiyev2023.comparisons import PRINTED
from robins.papers.hajiyev2023.ensemble import LAGS, SETTLED, autocorrelation
from robins.papers.hajiyev2023.scenario import BRANCHES, CONDITIONS
from robins.papers.protocol import Output, Results, Settings

BY_ID = {claim.claim_id: claim for claim in CLAIMS}
RUNS = 1000
QUANTILES = norm.ppf((np.arange(RUNS) + 0.5) / RUNS)
"""Errors of a thousand runs whose mean is exactly zero and whose spread is known."""


@pytest.fixture(scope="module")
def published(repository):
    return read_published(repository / "data" / "published" / "hajiyev2023.csv")


def variant_table(values, kinds, failed=()) -> pd.DataFrame:
    """A variant's table: ``values(branch, condition)`` gives a dict of arrays that broadcast to (runs, 8)."""
    runs = np.arange(RUNS)
    frames = []
    for branch in BRANCHES:
        for condition in CONDITIONS:
            for kind in kinds:
                columns = {"rmse": 1.0, "scale": 1.0, "gain_norm": 1.0, "own_gain": 1.0} | values(branch, condition)
                columns = {"nis_settled": 8.0, "nis_window": 8.0} | columns
                if kind == "filtered":  # nobody may take it for a delayed one
                    columns["rmse"] = columns["rmse"] * 0.01
                frames.append(pd.DataFrame({
                    "branch": branch, "condition": condition, "estimate": kind, "run": np.repeat(runs, 8), "state": np.tile(STATES, RUNS),
                    **{name: np.broadcast_to(value, (RUNS, 8)).ravel() for name, value in columns.items()},
                    "failed": np.repeat(np.isin(runs, failed), 8),
                }))  # fmt: skip
    return pd.concat(frames, ignore_index=True)


def fabricate(published, arrays=None, failed=None, tables=None, runs=RUNS, **values) -> Results:
    """Results whose variants all have an error of 1, but for `values`: ``{name: values(branch, condition)}``, dashes as underscores."""
    given = {name.replace("_", "-"): value for name, value in values.items()}

    def load(name):
        if tables and name in tables:
            return Output(tables[name], (arrays or {}).get(name, {}))
        kinds = ["delayed"] if name in PRINTED else ["filtered", "delayed"]
        table = variant_table(given.get(name, lambda branch, condition: {}), kinds, (failed or {}).get(name, ()))
        return Output(table[table["run"] < runs], (arrays or {}).get(name, {}))

    return Results(Settings("standard", 1, {"runs": runs, "bootstrap": 50}, {"plant": "f4c"}), published, load)


def errors(logs: dict, spread=0.0):
    """RMSE with the fault: ``exp(logs[branch, state] + spread z)``; states that are not named have 1."""

    def values(branch, condition):
        means = np.array([logs.get((branch, state), 0.0) if condition == "fault" else 0.0 for state in STATES])
        return {"rmse": np.exp(means + spread * QUANTILES[:, None] * (means != 0))}

    return values


def both(state: str, log: float) -> dict:
    return {(branch, state): log for branch in BRANCHES}


def overall(rows: list[Row]) -> Row:
    (row,) = [row for row in rows if row.condition == "overall"]
    return row


def test_every_claim_of_the_published_table_has_a_rule_and_c14_has_one_though_it_has_no_row(published):
    assert set(BY_ID) == {*claim_ids(published), "C14"}
    assert [claim.claim_id for claim in CLAIMS] == [f"C{number}" for number in range(1, 17)]
    assert PAPER.claims is CLAIMS
    assert all(claim.minimum == (0 if claim.claim_id in ("C14", "C15") else 1000) for claim in CLAIMS)


def test_a_small_ensemble_fills_the_ledger_and_says_of_every_testable_claim_that_n_is_too_small(published):
    settings = Settings("smoke", 1, {"runs": 8, "bootstrap": 20}, {"plant": "f4c"})
    outputs, rows = {}, []
    for claim in CLAIMS:

        def load(name, claim=claim):
            assert name in claim.needs
            if name not in outputs:
                outputs[name] = PAPER.jobs[name].compute(settings)
            return outputs[name]

        rows += claim.judge(Results(settings, published, load))
    ledger = build_ledger(PAPER.key, rows, published)  # validates every row
    untestable = ledger["claim_id"].isin(["C14", "C15"]) | (ledger["quantity"] == "state estimate errors relatively minimal")
    assert set(ledger.loc[untestable, "verdict"]) == {Verdict.UNTESTABLE}
    assert set(ledger.loc[~untestable, "verdict"]) == {Verdict.TOO_SMALL}
    assert not ledger["reason"].str.contains(r"\bnan\b|\binf\b").any()
    assert (ledger["location"] != "").all()


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("kind", ["published size", "another size", "nothing", "other side"])
def test_the_rule_of_a_ratio_claim_is_the_briefs(published, state, kind):
    claim_id, side = RATIO_CLAIMS[state]
    sign = -1 if side == "better" else 1
    log, spread, expected = {
        "published size": (0.3 * sign, 0.6, Verdict.REPLICATED),
        "another size": (1.5 * sign, 0.1, Verdict.DIRECTION_ONLY),
        "nothing": (1e-4 * sign, 0.5, Verdict.INCONCLUSIVE),
        "other side": (-0.3 * sign, 0.5, Verdict.NOT_REPLICATED),
    }[kind]
    rows = BY_ID[claim_id].judge(fabricate(published, amdkf_printed=errors(both(state, log), spread)))
    assert overall(rows).verdict == expected
    headline = [row for row in rows if row.condition in ("deg, fault", "rad, fault") and row.variant == "amdkf-printed/mdkf-printed"]
    assert [row.verdict for row in headline] == [expected, expected]
    assert [row.ours for row in headline] == pytest.approx([np.exp(log)] * 2)
    for row in headline:
        half = norm.ppf(0.975) * spread * np.std(QUANTILES, ddof=1) / np.sqrt(RUNS)
        assert [row.ci_low, row.ci_high] == pytest.approx([np.exp(log - half), np.exp(log + half)])


def test_the_published_ratio_comes_from_the_two_cells_of_table_1(published):
    rows = BY_ID["C6"].judge(fabricate(published))
    assert {row.published for row in rows if row.location == "Table 1"} == {0.0608 / 0.0360}


def test_fewer_than_a_thousand_runs_are_too_few(published):
    rows = BY_ID["C1"].judge(fabricate(published, runs=999, amdkf_printed=errors(both("u", -0.3), 0.5)))
    assert {row.verdict for row in rows} == {Verdict.TOO_SMALL}


def test_branches_that_disagree_make_the_verdict_depend_on_the_units(published):
    row = overall(BY_ID["C3"].judge(fabricate(published, amdkf_printed=errors({("deg", "q"): 0.3, ("rad", "q"): -0.3}, 0.5))))
    assert row.verdict == Verdict.DEPENDS
    assert not row.reason.startswith("Partly"), "each branch is of one mind"
    assert "units" in row.reason and "deg: not replicated" in row.reason and "rad: replicated" in row.reason


def test_a_filter_that_fails_in_more_than_five_per_cent_of_the_runs_is_never_replicated(published):
    logs = errors(both("u", -0.3), 0.6)
    assert overall(BY_ID["C1"].judge(fabricate(published, amdkf_printed=logs, failed={"amdkf-printed": range(50)}))).verdict == "replicated"
    assert (
        overall(BY_ID["C1"].judge(fabricate(published, amdkf_printed=logs, failed={"amdkf-printed": range(51)}))).verdict
        == "direction only"
    )


def test_supporting_cases_are_never_called_replicated_and_do_not_enter_the_overall_verdict(published):
    better = {"rmse": np.full((RUNS, 8), 0.5) * np.exp(0.1 * QUANTILES[:, None])}
    results = fabricate(published, amdkf_gated=lambda *_: better, abh=lambda *_: better, aakf=lambda *_: better)
    rows = BY_ID["C1"].judge(results)
    supporting = [row for row in rows if row.variant in ("amdkf-gated/mdkf-printed", "abh/bh", "aakf/akf")]
    assert {row.verdict for row in supporting} == {Verdict.DIRECTION_ONLY}
    assert len(rows) == 2 + 2 * sum(len(conditions) for _, conditions, _ in SUPPORTING) + 1
    assert overall(rows).verdict == Verdict.INCONCLUSIVE


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("replicated", "replicated"), Verdict.REPLICATED),
        (("replicated", "direction only"), Verdict.DIRECTION_ONLY),
        (("replicated", "not replicated"), Verdict.DEPENDS),
        (("direction only", "inconclusive"), Verdict.DEPENDS),
        (("not replicated", "inconclusive"), Verdict.NOT_REPLICATED),
        (("inconclusive", "inconclusive"), Verdict.INCONCLUSIVE),
        (("replicated", "n too small"), Verdict.TOO_SMALL),
    ],
)
def test_a_claim_about_several_states_is_partly_true_when_they_disagree(words, expected):
    assert together(words) == expected


def test_the_faulty_channels_are_judged_together_and_with_them_the_affected_states(published):
    better = {(branch, state): -0.25 for branch in BRANCHES for state in ("u", "w", "q", "theta")}
    assert overall(BY_ID["C12"].judge(fabricate(published, amdkf_printed=errors(better, 0.5)))).verdict == Verdict.REPLICATED
    mixed = better | both("theta", 0.25)
    rows = BY_ID["C12"].judge(fabricate(published, amdkf_printed=errors(mixed, 0.5)))
    assert overall(rows).verdict == Verdict.DEPENDS
    assert {row.verdict for row in rows if row.quantity == "faulty channels q and theta"} == {Verdict.DEPENDS}
    parts = [row.reason for row in rows if row.quantity in ("faulty channels q and theta", "affected states u and w")]
    assert [reason.startswith("Partly: ") for reason in parts] == [True, False, True, False]
    assert overall(rows).reason.startswith("Partly: ")
    assert {row.verdict for row in rows if row.quantity == "affected states u and w"} == {Verdict.REPLICATED}
    harm = {(row.quantity, row.condition): row for row in rows if row.quantity.startswith("harm")}
    assert harm["harm by the fault, theta", "deg"].ours == pytest.approx(np.exp(0.25))
    assert harm["harm by the fault, q", "rad"].verdict == Verdict.REPLICATED


def whiteness(centre: dict, runs=RUNS) -> pd.DataFrame:
    rows = []
    for branch in BRANCHES:
        for state in STATES:
            value = centre.get(state, -0.3)
            rows.append((branch, "lag-one autocorrelation of xi", state, value, -0.3, value - 0.01, value + 0.01, runs))
    return pd.DataFrame(rows, columns=["branch", "quantity", "channel", "value", "theory", "low", "high", "n"])


@pytest.mark.parametrize(
    ("centre", "expected"),
    [({}, Verdict.REFUTED), (dict.fromkeys(STATES, 0.001), Verdict.REPLICATED), ({"q": 0.001}, Verdict.DEPENDS)],
)
def test_whiteness_is_refuted_by_intervals_that_leave_out_zero(published, centre, expected):
    rows = BY_ID["C9"].judge(fabricate(published, tables={"theory": whiteness(centre)}))
    assert overall(rows).verdict == expected
    assert len(rows) == 17
    assert "counts twice" in overall(rows).reason
    assert "within 0.01" in rows[0].reason


def innovations(correlation: float, scale: float = 1.0, runs=400, epochs=200) -> dict[str, np.ndarray]:
    """Arrays of a job whose innovations are an MA(1) process of unit variance times `scale`."""
    theta = 0.0 if correlation == 0 else (1 - np.sqrt(1 - 4 * correlation**2)) / (2 * correlation)
    noise = np.random.default_rng(5).standard_normal((runs, epochs + 1, 8))
    series = scale * (noise[:, 1:] + theta * noise[:, :-1]) / np.sqrt(1 + theta**2)
    correlations, count = autocorrelation(series, np.ones((1, epochs, 8)))
    return {
        "innovation_autocorrelation": correlations,
        "innovation_count": count,
        "innovation_variance_ratio": np.mean(series[:, SETTLED:] ** 2, axis=(0, 1)),
        "nis_mean": np.mean(np.sum(series**2, axis=2), axis=0),
        "nis_runs": np.mean(np.sum(series[:, SETTLED:] ** 2, axis=2), axis=1),
    }


@pytest.mark.parametrize("correlation", [0.0, -0.45])
def test_intervals_of_mean_squares_allow_for_the_autocorrelation_of_the_innovations(correlation):
    arrays = {f"x.{name}": value for name, value in innovations(correlation).items()}
    found, by_runs = claims_theory.moments(arrays, "x"), claims_theory.moments(arrays, "x", arrays["x.nis_runs"])
    assert found.nis.low < 8 < found.nis.high
    assert found.nis.high - found.nis.low == pytest.approx(by_runs.nis.high - by_runs.nis.low, rel=0.15)
    assert np.all(np.abs(found.variance - 1) < found.variance_half)
    assert np.abs(found.correlation).max() == pytest.approx(abs(correlation), abs=0.02)
    assert np.any(np.abs(found.correlation) > found.correlation_half) == (correlation != 0)
    assert found.correlation.shape == (LAGS, 8)


def test_each_lag_of_white_innovations_has_the_spread_that_its_own_products_give():
    """Short series, where lag 20 has a third of the products of lag 0."""
    series = np.random.default_rng(7).standard_normal((2000, SETTLED + 30, 8))
    correlations, count = autocorrelation(series, np.ones((1, SETTLED + 30, 8)))
    arrays = {"x.innovation_autocorrelation": correlations, "x.innovation_count": count, "x.innovation_variance_ratio": np.ones(8),
              "x.nis_mean": np.full(SETTLED + 30, 8.0)}  # fmt: skip
    found = claims_theory.moments(arrays, "x")
    standard = found.correlation / found.correlation_half * claims_theory.family_quantile(8 * LAGS)
    assert np.sqrt(np.mean(standard[-6:] ** 2)) == pytest.approx(1.0, abs=0.25)
    assert found.correlation_half[:, 0] == pytest.approx(claims_theory.family_quantile(160) / np.sqrt(2000 * (30 - np.arange(1, 21))))


def test_the_autocorrelation_that_is_judged_is_the_largest_over_its_own_half_width():
    correlation = np.zeros((LAGS, 8))
    correlation[2, 1], correlation[19, 4] = 0.031, 0.034
    half = np.linspace(0.02, 0.06, LAGS)[:, None]
    nis = claims_theory.Interval(8.0, 7.9, 8.1, RUNS)
    found = claims_theory.Moments(nis, np.ones(8), np.full(8, 0.1), correlation, half)
    row = claims_theory.innovation_rows(found, "bh", "deg, healthy", RUNS)[2]
    assert (row.ours, row.ci_high - row.ours) == pytest.approx((0.031, half[2, 0]))
    assert "lag 3 of w" in row.reason and row.verdict == Verdict.REFUTED


@pytest.mark.parametrize(
    ("scale", "correlation", "expected"), [(1.0, 0.0, Verdict.REPLICATED), (1.05, 0.0, Verdict.REFUTED), (1.0, -0.4, Verdict.REPLICATED)]
)
def test_statement_1_is_refuted_by_a_wrong_covariance_and_not_by_correlation_alone(published, scale, correlation, expected):
    right, tested = innovations(0.0), innovations(correlation, scale)
    arrays = {"mdkf-printed": {}, "akf": {}, "theory": {}}
    for branch in BRANCHES:
        arrays["mdkf-printed"] |= {f"{branch}.healthy.{name}": value for name, value in tested.items()}
        arrays["akf"] |= {f"{branch}.healthy.{name}": value for name, value in right.items()}
        arrays["theory"] |= {f"{branch}.mdkf-printed.no-v.{name}": value for name, value in tested.items()}
        arrays["theory"] |= {f"{branch}.bh.no-v.{name}": value for name, value in right.items()}
    spread = {"nis_settled": 8 * scale**2 + QUANTILES[:, None]}
    results = fabricate(published, arrays, mdkf_printed=lambda *_: spread, akf=lambda *_: {"nis_settled": 8 + QUANTILES[:, None]})
    rows = BY_ID["C10"].judge(results)
    assert overall(rows).verdict == expected
    assert "12 of 12 tests are passed" in overall(rows).reason
    whole = {row.verdict for row in rows if row.quantity == "largest autocorrelation" and row.variant == "mdkf-printed"}
    assert whole == {Verdict.REFUTED if correlation else Verdict.REPLICATED}


def rising(gain_theta: float, other: float = 1.0):
    scales = {"q": 55.0, "theta": 13.0, "w": other}

    def values(branch, condition):
        if condition == "healthy":
            return {}
        gains = np.array([0.2 if state == "q" else gain_theta if state == "theta" else 1.0 for state in STATES])
        wobble = np.exp(0.1 * QUANTILES[:, None])
        return {"scale": np.array([scales.get(state, 1.0) for state in STATES]) * wobble, "gain_norm": gains * wobble,
                "own_gain": 0.5 * wobble}  # fmt: skip

    return values


def test_a_fault_must_raise_the_matching_scale_factors_and_no_other_and_lower_their_gains(published):
    assert overall(BY_ID["C11"].judge(fabricate(published, amdkf_printed=rising(0.5)))).verdict == Verdict.REPLICATED
    row = overall(BY_ID["C11"].judge(fabricate(published, amdkf_printed=rising(1.5))))
    assert row.verdict == Verdict.DEPENDS and "gain of channel theta" in row.reason and row.reason.startswith("Partly: ")
    row = overall(BY_ID["C11"].judge(fabricate(published, amdkf_printed=rising(0.5, other=20.0))))
    assert row.verdict == Verdict.DEPENDS and "largest growth among the other channels" in row.reason


def test_the_own_element_of_a_gain_stands_beside_its_norm_and_does_not_enter_the_verdict(published):
    rows = BY_ID["C11"].judge(fabricate(published, amdkf_printed=rising(1.5)))
    found = {(row.quantity, row.condition): row for row in rows}
    own, norm_row = (found[f"{words} of channel theta, fault over healthy", "deg"] for words in ("own gain", "gain"))
    assert own.ours == pytest.approx(0.5) and own.verdict == Verdict.DIRECTION_ONLY
    assert norm_row.verdict == Verdict.NOT_REPLICATED and "own element has 0.5 (direction only)" in norm_row.reason
    assert "own gain" not in overall(rows).reason


def test_scale_factors_near_theory_are_replicated_and_others_are_not(published):
    rows = BY_ID["C11"].judge(fabricate(published, amdkf_printed=rising(0.5)))
    assert {row.quantity: row.verdict for row in rows if row.condition == "rad, fault"} == {
        "scale factor of q, k = 100..149": Verdict.REPLICATED,
        "scale factor of theta, k = 100..149": Verdict.REPLICATED,
    }

    def forty(branch, condition):
        return {"scale": 40.0 + QUANTILES[:, None] if condition == "fault" else 1.0}

    rows = BY_ID["C11"].judge(fabricate(published, amdkf_printed=forty))
    assert {row.verdict for row in rows if row.quantity.startswith("scale factor of")} == {Verdict.DIRECTION_ONLY}


@pytest.mark.parametrize("scale", [1.0, 40.0, 55.9])
def test_a_scale_factor_that_the_fault_does_not_raise_is_not_replicated(published, scale):
    rows = BY_ID["C11"].judge(fabricate(published, amdkf_printed=lambda *_: {"scale": scale + 0.1 * QUANTILES[:, None]}))
    assert {row.verdict for row in rows if row.quantity.startswith("scale factor of")} == {Verdict.NOT_REPLICATED}


def test_compensation_is_judged_on_delayed_estimates_with_the_fault_against_the_plain_and_the_inflated_filter(published):
    def half(branch, condition):
        return {"rmse": (0.5 if condition == "fault" else 2.0) * np.exp(0.1 * QUANTILES[:, None])}

    rows = BY_ID["C13"].judge(
        fabricate(published, mdkf_printed=half, amdkf_printed=half, ckf=lambda *_: {"nis_settled": 90 + QUANTILES[:, None]})
    )
    assert overall(rows).verdict == Verdict.REPLICATED
    assert "64 of 64" in overall(rows).reason and "counts twice" in overall(rows).reason
    assert {row.verdict for row in rows if row.variant == "ckf"} == {Verdict.REPLICATED}
    assert {row.verdict for row in rows if row.condition == "deg, healthy" and row.variant == "mdkf-printed/ckf"} == {
        Verdict.NOT_REPLICATED
    }
    unaffected = [row for row in rows if row.quantity.startswith("RMSE with the fault over without")]
    assert len(unaffected) == 8 and {row.verdict for row in unaffected} == {Verdict.NOT_REPLICATED}


def test_one_state_that_is_not_compensated_is_named(published):
    def values(branch, condition):
        return {"rmse": np.where(np.array(STATES) == "phi", 2.0, 0.5) * np.exp(0.1 * QUANTILES[:, None])}

    row = overall(BY_ID["C13"].judge(fabricate(published, mdkf_printed=values, amdkf_printed=values)))
    assert row.verdict == Verdict.DEPENDS
    assert "deg, mdkf-printed/ckf: phi" in row.reason and row.reason.startswith("Partly: ")


def test_levels_stand_in_the_unit_in_which_the_branch_reads_them(published):
    rows = BY_ID["C14"].judge(fabricate(published, mdkf_printed=lambda *_: {"rmse": np.pi / 180 * np.exp(0.01 * QUANTILES[:, None])}))
    found = {(row.quantity, row.condition): row for row in rows}
    assert found["RMSE q MDKF", "deg, fault"].ours == pytest.approx(1.0, rel=1e-3)
    assert found["RMSE q MDKF", "deg, fault"].unit == "deg/s"
    assert found["RMSE phi MDKF", "rad, fault"].ours == pytest.approx(np.pi / 180, rel=1e-3)
    assert found["RMSE phi MDKF", "rad, fault"].unit == "rad"
    assert found["RMSE u MDKF", "deg, fault"].ours == found["RMSE u MDKF", "rad, fault"].ours
    assert {row.verdict for row in rows} == {Verdict.UNTESTABLE}


def test_long_flights_are_untestable_and_each_row_names_what_is_missing(published):
    rows = BY_ID["C15"].judge(fabricate(published))
    assert {row.verdict for row in rows} == {Verdict.UNTESTABLE}
    assert all("missing" in row.reason.lower() for row in rows)
    quantities = set(published.loc[published["claim_id"] == "C15", "quantity"])
    assert {row.quantity for row in rows if row.condition != "overall"} == quantities


@pytest.mark.parametrize(("late", "expected"), [(1.0, Verdict.REPLICATED), (2.0, Verdict.DEPENDS)])
def test_a_state_whose_deviation_still_changes_after_80_has_not_converged(published, late, expected):
    values = np.ones((201, 8))
    values[150:, STATES.index("u")] = late
    values[200] = np.nan  # no estimate at the last epoch
    arrays = {f"{branch}.healthy.{what}": values for branch in BRANCHES for what in ("sd_mean", "rms_error")}
    rows = BY_ID["C16"].judge(fabricate(published, {"mdkf-printed": arrays}))
    assert overall(rows).verdict == expected
    assert ("deg, u" in overall(rows).reason) == (late != 1.0)
    assert {row.ours for row in rows if row.quantity == "own deviation of u"} == {1 / late}
