"""Every claim is judged by its rule: fabricated runs with a known answer, and a small ensemble that is too small for any."""

import zlib
from functools import cache

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.ledger import Row, build_ledger, filled
from robins.evaluate.published import claim_ids, read_published
from robins.evaluate.verdicts import Verdict
from robins.papers.imani2026.claims import CLAIMS
from robins.papers.imani2026.comparisons import GROUPS
from robins.papers.imani2026.drive import CHANNELS, DURATION, KEY
from robins.papers.imani2026.judging import OTHERS, STUDIES
from robins.papers.imani2026.studies import outlier_cases
from robins.papers.protocol import Output, Results, Settings

BY_ID = {claim.claim_id: claim for claim in CLAIMS}
RUNS = 100
RATES = (1, 2, 5, 10, 50)
SWEPT = ("ekf-tuned", "ci-seq", "ci-corr", "gate", "single-kernel", "mk-norm", "mk-norm-gain", "mk-li")
MKMC, CI = "mk-norm-gain", "ci-seq"
SPREAD = 0.02
"""Standard deviation of the logarithm of a run's error, of its own for each filter."""


@pytest.fixture(scope="module")
def published(repository):
    return read_published(repository / "data" / "published" / f"{KEY}.csv")


def run_scores(name: str, runs: int, factors: dict, failed=(), mean=0.1, drift=0.1) -> pd.DataFrame:
    """Rows (run, channel) of errors near 1 times the factor of the filter's channel, or channel and metric."""
    wobble = np.exp(SPREAD * np.random.default_rng(zlib.crc32(name.encode())).standard_normal((runs, 1)))

    def values(metric):
        scale = [factors.get((channel, metric), factors.get(channel, factors.get("all", 1.0))) for channel in CHANNELS]
        return np.array(scale) * wobble

    sd, mean = values("rmse"), mean * values("mean")
    columns = {"rmse": np.hypot(sd, mean), "mean": mean, "sd": sd, "drift": drift * values("drift"), "drift_integral": mean * DURATION}
    lost = np.repeat(np.isin(np.arange(runs), failed), 12)
    return pd.DataFrame({
        "run": np.repeat(np.arange(runs), 12), "channel": np.tile(CHANNELS, runs),
        **{key: np.where(lost, np.nan, value.ravel()) for key, value in columns.items()},
        "failed": lost, "reason": np.where(lost, "lost", ""),
    })  # fmt: skip


def variant_output(name: str, runs: int, by_formulation: dict, failed, **more) -> Output:
    frames, arrays = [], {}
    for formulation in ("F0", "F1", "F2"):
        factors = by_formulation.get(formulation, by_formulation)
        table = run_scores(name, runs, factors, failed, **more).assign(formulation=formulation)
        averaged = table[table["channel"].isin(CHANNELS[3:9])]
        frames += [table.assign(against="truth"), averaged.assign(against="interval"), table.assign(against="reference")]
        arrays |= {f"{formulation}.{what}": np.full((runs, 3), 100.0) for what in ("position_final", "position_rms")}
        arrays[f"{formulation}.failed"] = np.isin(np.arange(runs), failed)
    return Output(pd.concat(frames, ignore_index=True), arrays)


def study_output(labels: list[dict], runs: int, by_filter: dict) -> Output:
    """A study of `SWEPT`, with the same scores under all labels."""
    tables = {name: run_scores(name, runs, by_filter.get(name, {})).drop(columns=["sd", "drift_integral"]) for name in SWEPT}
    front = [{**label, "filter": name} for label in labels for name in SWEPT]
    columns = {key: np.repeat([row[key] for row in front], 12 * runs) for key in front[0]}
    stacked = pd.concat([tables[row["filter"]] for row in front], ignore_index=True)
    return Output(pd.concat([pd.DataFrame(columns), stacked], axis=1))


def study(name: str, sweep_runs: int, fast_runs: int, swept: dict) -> Output:
    """A study of the wing, by name."""
    if name == "outliers":
        labels = [{**case, "tuned": "headline"} for case in outlier_cases()]
        labels.append({"law": "nig-zero-mean", "sided": "two-sided", "rate": 0.02, "tuned": "outliers"})
        return study_output(labels, sweep_runs, swept)
    if name == "grades":
        return study_output([{"grade": grade} for grade in ("vehicle", "atomic-ideal")], sweep_runs, swept)
    labels = [{"rate_hz": rate, "noise": noise} for rate in RATES for noise in ("equal-sample", "equal-psd")]
    slow, fast = ([row for row in labels if (row["rate_hz"] > 10) == above] for above in (False, True))
    parts = [study_output(rows, count, swept).table for rows, count in ((slow, sweep_runs), (fast, fast_runs))]
    return Output(pd.concat(parts, ignore_index=True))


@cache
def plain_study(name: str, sweep_runs: int, fast_runs: int) -> Output:
    """A study in which all filters have errors near 1."""
    return study(name, sweep_runs, fast_runs, {})


@cache
def plain_variant(name: str, runs: int) -> Output:
    """A variant whose errors are near 1."""
    return variant_output(name, runs, {}, ())


def theory_table(runs: int, **changed) -> pd.DataFrame:
    """The rows that claims read, at what theory expects; `changed` values by a part of the quantity."""
    rows = []
    for m in (6, 1):
        for nominal, threshold, temporal in ((0.05, "3.841", (0.195, 0.0339)), (0.01, "6.635", (0.0806, 0.00688))):
            rows.append((f"exceedance of {threshold}, sequential increment, n = {m}", nominal, 200_000))
            rows.append((f"exceedance of {threshold}, difference in time, n = {m}", temporal[m == 1], 200_000))
    for test in ("Shapiro-Wilk", "Lilliefors"):
        rows += [(f"share of runs rejected, {test}, {name}", 0.97, runs) for name in ("gyroscope", "accelerometer")]
        rows.append((f"share of runs rejected, {test}, normal noise", 0.05, runs))
    rows += [("sample skewness, 3300 samples", 2.5, 2000), ("sample excess kurtosis, 3300 samples", 17.0, 2000)]
    rows += [("RMSE needed for an improvement of 99 %, 0.1 deg of white noise", 1.234, 1000)]
    rows += [("RMSE needed for an improvement of 99 %, this study's reference, w_u", 0.39, 20)]
    table = pd.DataFrame(rows, columns=["quantity", "value", "n"])
    for part, value in changed.items():
        table.loc[table["quantity"].str.contains(part.replace("_", " ")), "value"] = value
    return table.assign(expected=table["value"], low=0.98 * table["value"], high=1.02 * table["value"])


def fabricate(published, runs=RUNS, sweep_runs=20, fast_runs=5, failed=None, swept=None, theory=None, level=None, **factors) -> Results:
    """Results whose filters all have errors near 1, but for `factors`, by variant (dashes as underscores).

    Factors are by channel, (channel, metric) or ``all``, or such mappings by formulation.
    """
    given = {name.replace("_", "-"): value for name, value in factors.items()}
    more = level or {}

    def load(name):
        if name in STUDIES:
            return study(name, sweep_runs, fast_runs, swept) if swept else plain_study(name, sweep_runs, fast_runs)
        if name == "theory":
            return Output(theory_table(runs) if theory is None else theory)
        if name == "drive":
            noise = np.random.default_rng(1).standard_normal((3300, 3)) ** 2
            return Output(pd.DataFrame(), {"residual.gyroscope": noise, "truth": np.full((3301, 12), 2.0)})
        if name not in {*given, *(failed or {}), *more}:
            return plain_variant(name, runs)
        return variant_output(name, runs, given.get(name, {}), (failed or {}).get(name, ()), **more.get(name, {}))

    settings = Settings("standard", 1, {"runs": runs, "sweep_runs": sweep_runs, "fast_runs": fast_runs, "bootstrap": 600},
                        {"rate_hz": 10, "rates_hz": list(RATES)})  # fmt: skip
    return Results(settings, published, load)


def overall(rows: list[Row]) -> Row:
    (row,) = [row for row in rows if row.condition == "overall"]
    return row


def row_at(rows: list[Row], condition: str) -> Row:
    (row,) = [row for row in rows if row.condition == condition]
    return row


def without_bootstrap(results: Results, resamples=200) -> Results:
    """The same with so few resamples that judging takes no time: Holm's smallest p is then 0.12, and nothing is off 0."""
    results.settings.sizes["bootstrap"] = resamples
    return results


def test_every_claim_of_the_published_table_has_a_rule_and_a_minimum(published):
    assert [claim.claim_id for claim in CLAIMS] == [f"C{number}" for number in range(1, 15)]
    assert set(BY_ID) == set(claim_ids(published))
    assert {claim.claim_id: claim.minimum for claim in CLAIMS if claim.minimum != 100} == {"C5": 0, "C12": 0, "C13": 20, "C14": 0}


def test_a_small_ensemble_fills_the_ledger_from_what_each_claim_needs_and_is_too_small_for_any_verdict(published):
    small = without_bootstrap(fabricate(published, runs=8, sweep_runs=2, fast_runs=1, failed={"mk-raw": range(8)}))
    outputs, rows = {}, []
    for claim in CLAIMS:

        def load(name, claim=claim):
            assert name in claim.needs, f"{claim.claim_id} reads {name}"
            return outputs.setdefault(name, small.output(name))

        rows += claim.judge(Results(small.settings, published, load))
    ledger = build_ledger(KEY, rows, published)  # validates every row
    free = ledger["claim_id"].isin(["C5", "C12", "C14"]) | ledger["condition"].isin(["set-up", "one run"])
    assert set(ledger.loc[~free, "verdict"]) == {Verdict.TOO_SMALL}
    assert not ledger["reason"].str.contains(r"\b(?:nan|inf|None)\b").any()
    assert (ledger["location"] != "").all()
    assert set(ledger.loc[ledger["variant"] == "mk-raw", "ours"]) == {"failed"}


def test_published_ends_stand_beside_the_rows_that_judge_them(published):
    rows = BY_ID["C1"].judge(without_bootstrap(fabricate(published))) + BY_ID["C2"].judge(without_bootstrap(fabricate(published)))
    found = {(row.claim_id, row.condition): filled(KEY, row, published) for row in rows}
    ends = {key: (record["published"], record["published_high"]) for key, record in found.items()}
    assert ends["C1", "F1, V_e, at least 37 %"] == ("37", "")
    assert ends["C1", "F1, largest, over 99 %"] == ("", "99")
    assert ends["C1", "overall"] == ("37", "99")
    assert ends["C2", "F1, largest"] == ("", "99")
    assert {record["unit"] for record in found.values()} == {"%"}


@pytest.mark.parametrize(
    ("factors", "lower", "upper", "together"),
    [
        ({"all": 0.5, "v_u": 0.005}, "replicated", "replicated", "replicated"),
        ({"all": 0.5}, "replicated", "direction only", "depends on assumption"),
        ({"all": 0.8}, "direction only", "direction only", "direction only"),
        ({"all": 1.3}, "not replicated", "not replicated", "not replicated"),
        ({}, "inconclusive", "inconclusive", "inconclusive"),
    ],
)
def test_both_ends_of_the_velocity_range_are_judged_apart(published, factors, lower, upper, together):
    rows = BY_ID["C1"].judge(fabricate(published, mk_norm_gain=factors))
    assert [row_at(rows, f"F1, {name}, at least 37 %").verdict for name in ("V_e", "V_n")] == [lower, lower]
    assert row_at(rows, "F1, largest, over 99 %").verdict == upper
    assert overall(rows).verdict == together
    assert row_at(rows, "F1, V_e, at least 37 %").ours == pytest.approx(100 * (1 - factors.get("all", 1.0)), abs=2)


def test_channels_that_disagree_are_named_in_the_overall_reason(published):
    row = overall(BY_ID["C1"].judge(fabricate(published, mk_norm_gain={"v_e": 0.5, "v_n": 1.5, "v_u": 0.5})))
    assert row.verdict == Verdict.DEPENDS
    assert "1 not replicated (V_n, at least 37 %)" in row.reason


def test_the_overall_verdict_is_that_of_the_headline_and_other_conditions_stand_beside_it(published):
    better, worse = {"all": 0.005}, {"all": 2.0}
    results = fabricate(published, mk_norm_gain={"F1": better, "F0": worse, "F2": {}}, swept={MKMC: worse})
    rows = BY_ID["C2"].judge(results)
    assert overall(rows).verdict == Verdict.REPLICATED
    assert row_at(rows, "F0, largest").verdict == Verdict.NOT_REPLICATED
    assert row_at(rows, "F1, 5 Hz, equal psd, largest").verdict == Verdict.NOT_REPLICATED
    assert row_at(rows, "F1, 50 Hz, equal psd, largest").verdict == Verdict.INCONCLUSIVE  # five runs cannot exclude chance
    assert row_at(rows, "F1, nig-zero-mean, 2% two-sided outliers, tuned again, largest").n == 20
    conditions = {row.condition.removesuffix(", largest") for row in rows}
    assert {case.words for case in OTHERS} < conditions and len(conditions) == 1 + 3 + 1 + 1 + len(OTHERS) + len(
        outlier_cases()
    ) + 1 + 2 + 2 * len(RATES)


def test_the_largest_improvement_of_a_domain_is_judged_and_all_three_are_told(published):
    rows = BY_ID["C3"].judge(fabricate(published, mk_norm_gain={"w_u": 0.2, "w_n": 0.9}))
    assert overall(rows).verdict == Verdict.DIRECTION_ONLY
    assert "omega_u 79.98 %" in overall(rows).reason and "1.23 rad/s" in overall(rows).reason
    assert row_at(rows, "F1, omega_u").verdict == Verdict.DIRECTION_ONLY


def test_a_filter_whose_runs_all_fail_has_words_and_no_numbers(published):
    rows = BY_ID["C1"].judge(fabricate(published, failed={"mk-raw": range(RUNS)}))
    row = row_at(rows, "F1, as printed, V_e, at least 37 %")
    assert (row.ours, row.ci_low, row.ci_high, row.verdict) == ("failed", "", "", Verdict.NOT_REPLICATED)
    assert "failed in 100" in row.reason and "nan" not in row.reason


def test_euler_angles_need_all_nine_cells(published):
    angles = dict.fromkeys(GROUPS["Euler angles"], 0.5)
    assert overall(BY_ID["C4"].judge(fabricate(published, mk_norm_gain=angles))).verdict == Verdict.DIRECTION_ONLY
    rows = BY_ID["C4"].judge(fabricate(published, mk_norm_gain=angles | {("pitch", "drift"): 2.0}))
    assert overall(rows).verdict == Verdict.NOT_REPLICATED and "1 below 0 or without surviving runs (pitch drift)" in overall(rows).reason
    assert row_at(rows, "F1, pitch drift").verdict == Verdict.NOT_REPLICATED


def test_all_domains_need_all_channels_and_metrics(published):
    assert overall(BY_ID["C7"].judge(fabricate(published, mk_norm_gain={"all": 0.5}))).verdict == Verdict.REPLICATED
    rows = BY_ID["C7"].judge(fabricate(published, mk_norm_gain={"all": 0.5, ("yaw", "mean"): 1.5, "v_u": 0.1}))
    assert overall(rows).verdict == Verdict.NOT_REPLICATED and "(yaw mean)" in overall(rows).reason
    stated = {row.quantity: row for row in rows if row.condition == "F1, as stated"}
    assert stated["velocity: MKMC-EKF superior in all components"].verdict == Verdict.REPLICATED
    assert stated["vertical velocity: gap between the filters larger than horizontally"].verdict == Verdict.REPLICATED


@pytest.mark.parametrize(("up", "expected"), [(0.2, "replicated"), (0.5, "inconclusive"), (0.9, "not replicated")])
def test_the_vertical_gap_is_compared_with_both_horizontal_ones(published, up, expected):
    rows = BY_ID["C7"].judge(fabricate(published, mk_norm_gain={"all": 0.5, "v_u": up}))
    assert {row.verdict for row in rows if row.quantity.startswith("vertical velocity")} == {expected}


def test_mean_errors_are_judged_by_direction_in_all_channels(published):
    assert overall(BY_ID["C9"].judge(fabricate(published, mk_norm_gain={"all": 0.5}))).verdict == Verdict.DIRECTION_ONLY
    row = overall(BY_ID["C9"].judge(fabricate(published, mk_norm_gain={"all": 0.5, "a_u": 2.0})))
    assert row.verdict == Verdict.DEPENDS and "1 not replicated (a_u)" in row.reason and "0.79" in row.reason


@pytest.mark.parametrize(
    ("own", "other", "expected"),
    [(0.1, 0.1, "compatible but uninformative"), (0.1, 3.0, "direction only"), (3.0, 0.1, "not replicated"), (1.0, 1.0, "inconclusive")],
)
def test_a_final_error_is_negligible_only_where_the_other_filter_s_accumulates(published, own, other, expected):
    rows = BY_ID["C8"].judge(fabricate(published, level={MKMC: {"drift": own}, CI: {"drift": other}}))
    assert overall(rows).verdict == expected
    assert {row.verdict for row in rows if row.condition == f"F1, {MKMC}"} == {expected}
    high = {0.1: "not replicated", 3.0: "direction only", 1.0: "inconclusive"}[other]
    assert {row.verdict for row in rows if row.condition == f"F1, {CI}"} == {high}


@pytest.mark.parametrize(
    ("tuned", "nominal", "expected"),
    [(0.8, 0.8, "direction only"), (1.0, 1.0, "inconclusive"), (1.2, 1.2, "not replicated"), (0.8, 1.2, "direction only")],
)
def test_the_tuned_ci_rkf_has_to_improve_on_the_tuned_ekf_in_most_channels(published, tuned, nominal, expected):
    results = fabricate(published, ci_seq={"all": tuned}, ci_seq_nominal={"all": nominal})
    if expected == "inconclusive":
        without_bootstrap(results)
    assert overall(BY_ID["C10"].judge(results)).verdict == expected


def test_five_channels_of_twelve_are_no_majority(published):
    few = dict.fromkeys(CHANNELS[:5], 0.8) | dict.fromkeys(CHANNELS[5:], 1.2)
    row = overall(BY_ID["C10"].judge(fabricate(published, ci_seq=few, ci_seq_nominal=few)))
    assert row.verdict == Verdict.NOT_REPLICATED and "5 above 0" in row.reason


@pytest.mark.parametrize(
    ("rivals", "expected"),
    [
        ({}, "replicated"),
        ({"gate": {"all": 0.2}}, "not replicated"),
        ({"mcc1": {"yaw": 0.2}}, "depends on assumption"),
        ({"huber": {"all": 0.2}}, "replicated"),
    ],
)
def test_several_kernels_are_the_cause_only_if_every_simpler_filter_is_worse(published, rivals, expected):
    row = overall(BY_ID["C11"].judge(fabricate(published, mk_norm_gain={"all": 0.5}, **rivals)))
    assert row.verdict == expected
    assert "single-kernel-gain 12 above 0" in row.reason


def test_an_equal_rival_leaves_the_attribution_open(published):
    row = overall(BY_ID["C11"].judge(fabricate(published, mk_norm_gain={"all": 0.5}, mcc1={"all": 0.5})))
    assert row.verdict == Verdict.INCONCLUSIVE
    assert "mcc1 0 above 0, 0 below" in row.reason


def test_noise_by_construction_is_no_finding(published):
    results = fabricate(published)
    assert {row.verdict for row in BY_ID["C5"].judge(results)} == {Verdict.UNTESTABLE, Verdict.COMPATIBLE}
    assert overall(BY_ID["C5"].judge(results)).verdict == Verdict.UNTESTABLE
    assert overall(BY_ID["C6"].judge(results)).verdict == Verdict.COMPATIBLE


@pytest.mark.parametrize(("value", "expected"), [(0.2, "not replicated"), (0.5, "inconclusive"), (0.9, "compatible but uninformative")])
def test_normality_is_rejected_only_if_it_is_in_most_runs(published, value, expected):
    theory = theory_table(RUNS, gyroscope=value)
    assert overall(BY_ID["C6"].judge(fabricate(published, theory=theory))).verdict == expected


def test_position_stands_without_a_verdict_for_every_filter(published):
    rows = BY_ID["C12"].judge(fabricate(published, failed={"mk-raw": range(RUNS)}))
    assert {row.verdict for row in rows} == {Verdict.UNTESTABLE}
    found = {row.variant: row.ours for row in rows if row.quantity == "final position error"}
    assert found["ekf"] == pytest.approx(100 * np.sqrt(3)) and found["mk-raw"] == "failed"
    assert "mk-norm-gain 173.2 m" in overall(rows).reason


@pytest.mark.parametrize(
    ("factor", "expected"), [(1.0, "replicated"), (2.0, "inconclusive"), (3.0, "not replicated")]
)  # the car's own tilt is 2
def test_attitude_is_bounded_where_it_is_better_than_taking_the_car_for_level(published, factor, expected):
    size = factor / np.hypot(1.0, 0.1)
    rows = BY_ID["C13"].judge(fabricate(published, swept={MKMC: {"all": size}}))
    row = overall(rows)
    assert row.verdict == expected
    assert row_at(rows, "F1, 50 Hz, equal psd, roll").n == 5


def test_a_difference_of_two_chi_square_variables_is_no_chi_square_variable(published):
    rows = BY_ID["C14"].judge(fabricate(published))
    assert overall(rows).verdict == Verdict.REFUTED and "0.195" in overall(rows).reason
    assert {row.verdict for row in rows if "control" in row.condition} == {Verdict.REPLICATED}
    assert {row.verdict for row in rows if row.condition.startswith("(30)")} == {Verdict.REFUTED}
