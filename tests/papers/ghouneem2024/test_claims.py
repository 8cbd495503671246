"""Every claim is judged by its rule: fabricated runs with a known answer, and a small ensemble that is too small for any."""

import zlib
from collections.abc import Mapping
from functools import cache

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.ledger import Row, build_ledger, filled
from robins.evaluate.published import claim_ids, read_published
from robins.evaluate.verdicts import Verdict
from robins.papers.ghouneem2024.claims import CLAIMS
from robins.papers.ghouneem2024.claims_ratios import RATIO_CLAIMS
from robins.papers.ghouneem2024.claims_settings import printed_ratio
from robins.papers.ghouneem2024.claims_sigma_points import large_differences
from robins.papers.ghouneem2024.cost import cost
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.runs import COLUMNS, COUNTS, MEASURES
from robins.papers.ghouneem2024.studies import AZIMUTH_ERRORS, CAUSES, PRIOR_ERROR, PRIOR_SCALES, PRIORS, SEVERITIES
from robins.papers.ghouneem2024.theory import theory
from robins.papers.ghouneem2024.trajectories import KEY, TRAJECTORIES
from robins.papers.ghouneem2024.variants import BASELINES, NEW, VARIANTS
from robins.papers.protocol import Output, Results, Settings

BY_ID = {claim.claim_id: claim for claim in CLAIMS}
SIZES = {"runs": 50, "side_runs": 12, "in_sample_runs": 12, "tuning_runs": 8, "calibration_runs": 12, "bootstrap": 300}
SPREAD = 0.02
"""Standard deviation of the logarithm of a run's error, of its own for each filter and with mean zero over the runs."""


@pytest.fixture(scope="module")
def published(repository):
    return read_published(repository / "data" / "published" / f"{KEY}.csv")


def run_scores(name: str, runs: int, first: int, factors: Mapping, place: str) -> pd.DataFrame:
    """Rows of runs with errors near 1 times a factor: by (trajectory, measure), measure, trajectory or ``all``; ``failed`` names runs."""
    noise = np.random.default_rng(zlib.crc32(f"{name}{place}".encode())).standard_normal(runs)
    wobble = np.exp(SPREAD * (noise - noise.mean()))
    lost = np.isin(np.arange(runs), list(factors.get("failed", ())))
    columns = {"run": first + np.arange(runs)}
    for measure in (*MEASURES[:-1], *COUNTS[:3]):
        factor = next((factors[key] for key in ((place, measure), measure, place, "all") if key in factors), 1.0)
        columns[measure] = np.where(lost, np.nan, factor * wobble)
    columns |= {"settled": np.where(lost, np.nan, factors.get("settled", 100.0)), "fixes": 1000, "rejected": 0}
    columns |= {"longest_rejection": 0, "failed": lost, "reason": np.where(lost, "lost", "")}
    return pd.DataFrame(columns)[list(COLUMNS)]


def study_labels(name: str) -> list[dict]:
    """Labels of the rows of a study, without the trajectory."""
    alpha = OPTIONS["alpha"]
    if name == "in-sample":
        return [{"filter": key, "cell": cell} for key in ("ekf-pi", "ukf") for cell in ("none", "gate", "st", "st-gate")]
    if name == "severity":
        return [{"severity": value, "filter": key} for value in SEVERITIES for key in (*FILTERS, NEW)]
    if name == "cause":
        gates = [(key, "integrity", multiple) for key in FILTERS for multiple in (0.5, 2.0, 8.0, np.inf)]
        gates += [("physical", gate, np.inf) for gate in ("none", "nis", "nis-recovery")]
        return [dict(zip(("cause", "filter", "gate", "multiple"), (why, *gate), strict=True)) for why in CAUSES for gate in gates]
    if name == "initialisation":
        filters = [*((key, alpha) for key in FILTERS), ("ukf", 1.0)]
        return [
            {"azimuth_error": error, "prior": prior, "filter": key, "alpha": value}
            for error in AZIMUTH_ERRORS
            for prior in PRIORS
            for key, value in filters
        ]
    if name == "prior":
        return [{"azimuth_error": PRIOR_ERROR, "prior_scale": scale, "filter": key} for scale in PRIOR_SCALES for key in FILTERS]
    if name == "ablations":
        return [{"ablation": tilt, "filter": key} for tilt in ("as run", "tilt corrected") for key in FILTERS]
    levels = [(level, key, value) for level in ("st-printed", "st-ms") for key, value in (("ekf-f", alpha), ("ukf", alpha), ("ukf", 1.0))]
    levels += [("ds", key, alpha) for key in FILTERS]
    return [dict(zip(("level", "filter", "alpha"), row, strict=True)) for row in levels]


def study(name: str, sizes: Mapping, factors: Mapping) -> Output:
    """A study whose factors are by filter, or by a function of the labels."""
    runs, first = (sizes["in_sample_runs"], 100) if name == "in-sample" else (sizes["side_runs"], 400)
    frames = []
    for place in TRAJECTORIES:
        for labels in study_labels(name):
            given = factors(labels) if callable(factors) else factors.get(labels["filter"], {})
            table = run_scores(labels["filter"], runs, first, given, place)
            frames.append(table.assign(trajectory=place, **labels))
    return Output(pd.concat(frames, ignore_index=True))


def variant_output(name: str, runs: int, factors: Mapping) -> Output:
    frozen = ("none",) if VARIANTS[name].composition.get("cell", "none") == "none" else TRAJECTORIES
    frames = [
        run_scores(name, runs, 100, factors, place).assign(trajectory=place, frozen=one) for place in TRAJECTORIES for one in frozen
    ]  # fmt: skip
    return Output(pd.concat(frames, ignore_index=True))


@cache
def plain_study(name: str, side_runs: int, in_sample_runs: int) -> Output:
    """A study in which all filters have errors near 1."""
    return study(name, {"side_runs": side_runs, "in_sample_runs": in_sample_runs}, {})


@cache
def plain_variant(name: str, runs: int) -> Output:
    """A variant whose errors are near 1."""
    return variant_output(name, runs, {})


def tuning_output(mean: float) -> Output:
    arrays = {
        f"{place}.{source}.{field}": np.full((8, 7), mean)
        for place in TRAJECTORIES
        for source in ("mechanisation", "filtered")
        for field in ("mean", "mean_square", "increment")
    }
    return Output(pd.DataFrame(), arrays)


def fabricate(published, sizes: Mapping | None = None, studies: Mapping | None = None, **factors) -> Results:
    """Results whose filters all have errors near 1, but for `factors`, by variant (dashes as underscores), and those of `studies`.

    ``studies`` may hold the table of ``cost`` and ``theory``, and the mean error behind ``tuning-ukf``.
    """
    given = {name.replace("_", "-"): value for name, value in factors.items()}
    more, sizes = studies or {}, SIZES | (sizes or {})
    settings = Settings("standard", 1, sizes, OPTIONS)

    def load(name: str) -> Output:
        if name in VARIANTS:
            return variant_output(name, sizes["runs"], given[name]) if name in given else plain_variant(name, sizes["runs"])
        if name == "theory":
            return theory(settings)
        if name == "cost":
            return cost(settings, recorded=more.get("cost", {}))
        if name == "tuning-ukf":
            return tuning_output(more.get(name, -1.0))
        return study(name, sizes, more[name]) if name in more else plain_study(name, sizes["side_runs"], sizes["in_sample_runs"])

    return Results(settings, published, load)


def overall(rows: list[Row]) -> Row:
    (row,) = [row for row in rows if row.condition == "overall"]
    return row


def row_at(rows: list[Row], condition: str, name: str) -> Row:
    (row,) = [row for row in rows if row.condition == condition and row.variant == name]
    return row


def test_every_claim_of_the_published_table_has_a_rule_and_a_minimum(published):
    assert list(BY_ID) == [f"C{number}" for number in range(1, 8)] + ["C8a", "C8b", "C8c"] + [f"C{number}" for number in range(9, 20)]
    assert set(BY_ID) == set(claim_ids(published))
    least = {claim.claim_id: claim.minimum for claim in CLAIMS if claim.minimum != 50}
    assert least == {"C1": 0, "C2": 0, "C12": 0, "C14": 12, "C15": 0, "C17": 0, "C18": 12}


@pytest.fixture(scope="module")
def small(published) -> pd.DataFrame:
    """The ledger of a small ensemble, each claim made from what it says that it needs; one filter fails in all runs."""
    results = fabricate(published, {"runs": 8, "side_runs": 2, "in_sample_runs": 2}, ekf_pm={"failed": range(8)})
    outputs, rows = {}, []
    for claim in CLAIMS:

        def load(name, claim=claim):
            assert name in claim.needs, f"{claim.claim_id} reads {name}"
            return outputs.setdefault(name, results.output(name))

        limited = Results(results.settings, published, load)
        rows += claim.judge(limited)
        assert set(limited._loaded) == set(claim.needs), f"{claim.claim_id} does not read all that it needs"
    return build_ledger(KEY, rows, published)  # validates every row


def test_a_small_ensemble_is_too_small_for_any_verdict_that_runs_decide(small):
    free = small["claim_id"].isin(["C1", "C2", "C12", "C15", "C17"])
    by_other_means = small["condition"].str.contains("arithmetic|signed means|pitch as printed|pitch corrected|P0 x 0, settles")
    assert set(small.loc[~free & ~by_other_means, "verdict"]) == {Verdict.TOO_SMALL}
    assert set(small.loc[small["claim_id"].isin(["C1", "C2"]), "verdict"]) == {Verdict.UNTESTABLE}


def test_every_row_says_where_and_why_in_words_without_broken_numbers(small):
    assert (small["location"] != "").all() and (small["reason"].str.endswith(".")).all()
    assert not small["reason"].str.contains(r"\b(?:nan|inf|None)\b").any()
    assert set(small.loc[small["variant"] == "ekf-pm", "ours"]) >= {"failed"}


def test_levels_stand_beside_the_published_ones_in_their_units(published):
    rows = BY_ID["C2"].judge(fabricate(published, ekf_pi={"azimuth": 2.0}))
    found = {(row.quantity, row.variant, row.condition): filled(KEY, row, published) for row in rows}
    azimuth = found["T2 Azimuth RMSE, EKF", "ekf-pi", "data sheet's variances"]
    assert float(azimuth["ours"]) == pytest.approx(np.degrees(2.0)) and (azimuth["published"], azimuth["unit"]) == ("103.3814", "deg")
    new = {condition for quantity, name, condition in found if quantity == "T2 Altitude RMSE, New-Algorithm" and name == NEW}
    assert new == {"T1-frozen", "T2-frozen", "in sample"}


def published_factor(published, claim_id: str, scale: float = 1.0) -> dict:
    place, channels = RATIO_CLAIMS[claim_id]
    results = Results(Settings("standard", 1, SIZES), published, lambda name: None)
    return {(place, channel): scale * printed_ratio(results, place, channel) for channel in channels}


@pytest.mark.parametrize("claim_id", RATIO_CLAIMS)
def test_the_published_ratios_replicate_themselves(published, claim_id):
    rows = BY_ID[claim_id].judge(fabricate(published, ukf_st_gate=published_factor(published, claim_id)))
    row = overall(rows)
    assert row.verdict == Verdict.REPLICATED and row.ci_low < row.published < row.ci_high
    assert {one.verdict for one in rows if one.condition in ("T1-frozen", "T2-frozen")} == {Verdict.REPLICATED}
    assert {one.verdict for one in rows if one.condition.startswith("T1-frozen, severity")} == {Verdict.INCONCLUSIVE}


@pytest.mark.parametrize(
    ("new", "memoryless", "expected"),
    [
        ({"all": 0.279}, {}, "replicated"),
        ({"all": 0.6}, {}, "direction only"),
        ({"all": 0.279}, {"all": 0.2}, "depends on assumption"),
        ({"all": 0.279}, {"all": 0.279}, "depends on assumption"),
        ({}, {}, "inconclusive"),
        ({}, {"all": 0.9}, "not replicated"),
        ({"all": 1.5}, {}, "not replicated"),
        ({"all": 0.279, "failed": range(3)}, {}, "direction only"),
        ({"failed": range(50)}, {}, "not replicated"),
    ],
)
def test_a_ratio_has_to_hold_against_both_readings_of_the_ekf(published, new, memoryless, expected):
    row = overall(BY_ID["C3"].judge(fabricate(published, ukf_st_gate=new, ekf_pm=memoryless)))
    assert row.verdict == expected
    assert all(f"Against {name}:" in row.reason for name in BASELINES)


def test_the_weakest_channel_decides_and_the_others_are_told(published):
    factors = published_factor(published, "C8b") | {("t2", "v_east"): 1.0}
    row = overall(BY_ID["C8b"].judge(fabricate(published, ukf_st_gate=factors)))
    assert row.verdict == Verdict.INCONCLUSIVE and row.ours == pytest.approx(1.0)
    assert "east velocity inconclusive" in row.reason and "altitude replicated" in row.reason


def test_the_other_trajectory_has_no_say(published):
    factors = published_factor(published, "C6") | {"t2": 5.0}
    assert overall(BY_ID["C6"].judge(fabricate(published, ukf_st_gate=factors))).verdict == Verdict.REPLICATED


@pytest.mark.parametrize(
    ("new", "memoryless", "expected"),
    [(1.0, 1.0, "replicated"), (0.8, 1.0, "not replicated"), (0.95, 0.95, "depends on assumption"), (0.95, 1.0, "inconclusive")],
)
def test_the_up_velocity_is_unchanged_where_both_intervals_are_near_one(published, new, memoryless, expected):
    rows = BY_ID["C5"].judge(fabricate(published, ukf_st_gate={"v_up": new}, ekf_pm={"v_up": memoryless}))
    assert overall(rows).verdict == expected
    assert {row.condition for row in rows if row.variant == "ukf"} == {"pitch as printed", "pitch corrected"}


def test_the_level_of_the_azimuth_is_set_against_both_metrics_and_arithmetic(published):
    levels = {"azimuth": np.radians(50.0), "azimuth_unwrapped": np.radians(103.0)}
    rows = BY_ID["C9"].judge(fabricate(published, ekf_pi=levels, ekf_pm=levels, ukf_st_gate={"azimuth": 0.444 * np.radians(50.0)}))
    assert overall(rows).verdict == Verdict.REPLICATED
    for name in BASELINES:
        assert row_at(rows, "difference wrapped", name).verdict == Verdict.NOT_REPLICATED
        assert row_at(rows, "difference not wrapped", name).verdict == Verdict.COMPATIBLE
    arithmetic = [row for row in rows if row.condition.startswith("arithmetic")]
    assert [row.ours for row in arithmetic] == ["8.25%", "103.92 deg", "1.62%", "103.92 deg"]
    assert [row.verdict for row in arithmetic] == [Verdict.COMPATIBLE] * 3 + [Verdict.NOT_REPLICATED]


@pytest.mark.parametrize(
    ("factors", "expected"),
    [
        ({"all": 0.8}, "replicated"),
        ({}, "not replicated"),
        ({"all": 0.97}, "not replicated"),
        ({"t1": 0.8}, "depends on assumption"),
        ({"all": 1.2}, "not replicated"),
    ],
)
def test_sigma_points_have_to_beat_the_ekf_with_their_own_model(published, factors, expected):
    row = overall(BY_ID["C10"].judge(fabricate(published, ukf=factors)))
    assert row.verdict == expected and "Largest relative difference in a run" in row.reason


def test_channels_that_differ_in_some_run_are_named_with_the_largest_difference(published):
    plain = plain_variant("ekf-f", 50).table

    def load(name: str) -> Output:
        moved = plain.assign(height=plain["height"] * np.where((plain["run"] == 107) & (plain["trajectory"] == "t2"), 1.07, 1.0))
        return Output(moved if name == "ukf" else plain)

    settings = Settings("standard", 1, SIZES, OPTIONS)
    assert "difference: T2 altitude 0.07." in large_differences(Results(settings, published, load))
    same = large_differences(Results(settings, published, lambda name: Output(plain)))
    assert same == "No channel differs by more than 5% in any run."


def test_an_equal_ukf_is_told_from_an_uncertain_one(published):
    noisy = {"horizontal": np.exp(np.random.default_rng(1).standard_normal(50))}
    assert overall(BY_ID["C10"].judge(fabricate(published, ukf=noisy))).verdict in (Verdict.INCONCLUSIVE, Verdict.DEPENDS)


def cells(part: str, factor: float, height: float = 1.0) -> dict:
    """Factors of every variant of the factorial that has a part."""
    named = [name for name, row in VARIANTS.items() if part in row.composition.get("cell", "none").split("-")]
    return {name: {"all": factor, "height": height} for name in named}


@pytest.mark.parametrize(("claim_id", "part"), [("C11", "st"), ("C13", "gate")])
@pytest.mark.parametrize(("factor", "expected"), [(0.8, "replicated"), (1.0, "inconclusive"), (1.2, "not replicated")])
def test_a_part_is_judged_by_its_shapley_value_of_the_horizontal_error(published, claim_id, part, factor, expected):
    rows = BY_ID[claim_id].judge(fabricate(published, **cells(part, factor, height=2.0)))
    assert overall(rows).verdict == expected
    assert overall(rows).ours == pytest.approx(np.log(factor), abs=0.01)
    decisive = [row for row in rows if "T1-frozen, Shapley" in row.condition and "horizontal" in row.condition]
    assert [(row.condition[:2], row.variant.split("/")[1]) for row in decisive] == [(t, b) for t in ("T1", "T2") for b in BASELINES]
    if claim_id == "C11":
        assert "Altitude: not replicated" in overall(rows).reason


def test_a_part_that_helps_on_one_trajectory_depends(published):
    factors = {name: {"t1": 0.8} for name in cells("gate", 0.8)}
    assert overall(BY_ID["C13"].judge(fabricate(published, **factors))).verdict == Verdict.DEPENDS


def test_literal_levels_that_diverge_are_counted_with_failures(published):
    def factors(labels):
        if labels["level"] == "st-printed":
            return {"horizontal": 40.0, "failed": range(2)} if labels["filter"] == "ukf" else {"horizontal": 29.0}
        return {}

    rows = BY_ID["C11"].judge(fabricate(published, studies={"literal": factors}))
    row = row_at(rows, "T1, st-printed, ukf, alpha 0.1", "literal")
    assert (row.ours, row.verdict) == ("every run", Verdict.NOT_REPLICATED)
    assert row_at(rows, "T1, st-printed, ekf-f, alpha 0.1", "literal").verdict == Verdict.COMPATIBLE


@pytest.mark.parametrize(("mean", "expected"), [(1.0, Verdict.REFUTED), (-1.0, Verdict.COMPATIBLE)])
def test_a_negative_signed_mean_is_no_variance(published, mean, expected):
    """An estimate above the reference has ``S_ref - S_RISS`` below zero."""
    rows = BY_ID["C11"].judge(fabricate(published, studies={"tuning-ukf": mean}))
    found = [row for row in rows if row.condition.endswith("signed means")]
    assert {row.verdict for row in found} == {expected} and found[0].ours == f"{7 if mean > 0 else 0} of 7 negative"


@pytest.mark.parametrize(("tuned", "expected"), [(50.0, "replicated"), (100.5, "not replicated"), (200.0, "not replicated")])
def test_self_tuning_convergence_is_a_share_of_runs_that_settle_sooner(published, tuned, expected):
    rows = BY_ID["C11"].judge(fabricate(published, ukf_st={"settled": tuned}))
    assert row_at(rows, "T1, T1-frozen, frozen environment, share of runs that settle sooner", "ukf-st/ukf").verdict == expected


def test_the_gate_is_judged_by_filter_and_by_cause_with_its_lockouts(published):
    def factors(labels):
        helped = labels["cause"] == "misleading" and labels["gate"] == "integrity" and np.isfinite(labels["multiple"])
        return {"horizontal": 0.3} if helped else {}

    rows = BY_ID["C13"].judge(fabricate(published, ukf_gate={"horizontal": 3.0}, studies={"cause": factors}))
    assert row_at(rows, "T1, T1-frozen, gate alone", "ukf-gate/ukf").verdict == Verdict.NOT_REPLICATED
    assert "More than 2 times worse in 50 of 50 runs" in row_at(rows, "T1, T2-frozen, gate alone", "ukf-gate/ukf").reason
    assert row_at(rows, "T2, only misleading, m = 8", "ukf/ukf").verdict == Verdict.REPLICATED
    assert row_at(rows, "T2, only outages, nis", "physical/physical").verdict == Verdict.INCONCLUSIVE
    assert "misleading 24 and 0 of 24, multipath 0 and 0 of 24, outages 0 and 0 of 24" in overall(rows).reason


def test_tuning_that_needs_a_reference_and_a_constant_q_is_not_in_real_time(published):
    rows = BY_ID["C12"].judge(fabricate(published))
    row = overall(rows)
    assert row.verdict == Verdict.REFUTED and "The Q matrix remains constant during operation." in row.reason
    silent = published[~published["quantity"].isin(["Q constant", "reference needed"])]
    assert overall(BY_ID["C12"].judge(fabricate(silent))).verdict == Verdict.UNTESTABLE
    assert {one.verdict for one in rows if "in sample over" in one.condition} == {Verdict.COMPATIBLE}


@pytest.mark.parametrize(
    ("seconds", "expected"),
    [
        ({"ukf": 50.0}, "replicated"),
        ({}, "not replicated"),
        ({"ukf": 200.0}, "not replicated"),
        ({"ukf": 50.0, "ekf-f": 50.5}, "depends on assumption"),
        ({"ukf": np.r_[np.full(6, 50.0), np.full(6, 200.0)]}, "inconclusive"),
    ],
)
def test_convergence_is_compared_with_all_three_linearised_filters(published, seconds, expected):
    factors = {name: {"settled": value} for name, value in seconds.items()}
    rows = BY_ID["C14"].judge(fabricate(published, studies={"initialisation": factors}))
    assert overall(rows).verdict == expected


@pytest.mark.parametrize(
    ("linearised", "ukf", "expected"),
    [(np.inf, 100.0, "direction only"), (np.inf, np.inf, "not replicated"), (100.0, 100.0, "compatible but uninformative")],
)
def test_divergence_counts_against_linearisation_only_where_the_ukf_settles(published, linearised, ukf, expected):
    factors = {name: {"settled": ukf if name == "ukf" else linearised} for name in FILTERS}
    rows = BY_ID["C14"].judge(fabricate(published, studies={"initialisation": factors}))
    assert {row.verdict for row in rows if row.condition.endswith("never settled")} == {expected}


@pytest.mark.parametrize(
    ("least", "greatest", "expected"), [(1.6, 1.9, "replicated"), (0.9, 1.2, "inconclusive"), (0.7, 0.9, "not replicated")]
)  # fmt: skip
def test_the_whole_range_of_the_cost_decides(published, least, greatest, expected):
    recorded = {"ratio": (least + greatest) / 2, "least": least, "greatest": greatest, "rounds": 5, "ekf_us": 1.0, "ukf_us": 1.7}
    (row,) = BY_ID["C15"].judge(fabricate(published, studies={"cost": recorded | {"machine": {"cores": 2}}}))
    assert (row.verdict, row.n, row.ci_low, row.ci_high) == (expected, 5, least, greatest) and "cores 2" in row.reason


def test_without_a_record_the_cost_is_untestable_and_the_record_is_named(published):
    (row,) = BY_ID["C15"].judge(fabricate(published))
    assert row.verdict == Verdict.UNTESTABLE and "benchmarks/records/ghouneem2024.json" in row.reason


@pytest.mark.parametrize(
    ("factors", "expected"),
    [
        ({"roughness": 0.5, "horizontal": 2.0}, "replicated"),
        ({}, "inconclusive"),
        ({"roughness": 2.0}, "not replicated"),
        ({("t1", "roughness"): 0.5}, "depends on assumption"),
    ],
)
def test_smoothness_is_judged_on_both_trajectories_and_accuracy_is_told(published, factors, expected):
    row = overall(BY_ID["C16"].judge(fabricate(published, ukf_st_gate=factors)))
    assert row.verdict == expected
    accurate = "not replicated" if "horizontal" in factors else "inconclusive"
    assert f"More accurate (horizontal, both EKFs): T1 {accurate}; T2 {accurate}." in row.reason


def test_moments_are_exact_for_a_normal_law_up_to_the_mean_of_a_cube(published):
    rows = BY_ID["C17"].judge(fabricate(published))
    row = overall(rows)
    assert row.verdict == Verdict.DEPENDS
    parts = ("mean, normal law replicated", "variance, normal law depends on assumption")
    parts += ("mean, exponential law depends on assumption", "variance, exponential law refuted")
    assert all(words in row.reason for words in parts)
    own = [one for one in rows if one.variant == "unscented, alpha 0.1"]
    assert len(own) == 8 and sum(one.verdict == Verdict.REPLICATED for one in own) == 4


@pytest.mark.parametrize(
    ("small", "expected"),
    [
        ({"settled": 500.0}, "replicated"),
        ({"failed": range(12)}, "replicated"),
        ({}, "not replicated"),
        ({"settled": np.r_[np.full(6, 50.0), np.full(6, 500.0)]}, "inconclusive"),
    ],
)
def test_small_initial_covariance_impedes_where_most_runs_settle_later(published, small, expected):
    rows = BY_ID["C18"].judge(fabricate(published, studies={"prior": lambda labels: small if labels["prior_scale"] <= 1e-4 else {}}))
    assert overall(rows).verdict == expected
    assert row_at(rows, "T1, P0 x 0.01, settles later", "ukf").verdict == Verdict.NOT_REPLICATED


def test_small_initial_covariance_that_impedes_one_filter_depends(published):
    def factors(labels):
        return {"settled": 500.0} if labels["prior_scale"] == 1e-4 and labels["filter"] == "ukf" else {}

    assert overall(BY_ID["C18"].judge(fabricate(published, studies={"prior": factors}))).verdict == Verdict.DEPENDS


def joint(filter_factor: float, tuning: float, gate: float) -> dict:
    """Factors of a factorial in which the logarithms of the three effects add."""
    made = {}
    for name, row in VARIANTS.items():
        if "cell" in row.composition:
            cell = row.composition["cell"].split("-")
            factor = (filter_factor if row.family == "ukf" else 1.0) * (tuning if "st" in cell else 1.0) * (gate if "gate" in cell else 1.0)
            made[name] = {"all": factor}
    return made


@pytest.mark.parametrize(
    ("effects", "expected", "count"),
    [
        ((0.8, 0.8, 0.85), "replicated", 3),
        ((0.5, 1.0, 0.8), "inconclusive", 2),
        ((0.3, 1.2, 1.0), "not replicated", 1),
    ],
)
def test_all_three_parts_have_to_contribute(published, effects, expected, count):
    rows = BY_ID["C19"].judge(fabricate(published, **joint(*effects)))
    row = overall(rows)
    assert (row.verdict, row.ours) == (expected, f"{count} of 3 contribute")
    for part, effect in zip(("filter", "self-tuning", "gate"), effects, strict=True):
        words = f"T1, T1-frozen, Shapley value of {part}, log of the horizontal error"
        assert row_at(rows, words, f"{NEW}/ekf-pi").ours == pytest.approx(np.log(effect), abs=0.01)
    gain = row_at(rows, "T1, horizontal, T1-frozen", f"{NEW}/ekf-pi")
    assert gain.ours == pytest.approx(np.prod(effects)) and gain.published == pytest.approx(0.544, abs=1e-3)


def test_parts_that_differ_between_the_baselines_depend(published):
    factors = joint(0.5, 0.8, 0.8)
    for name in factors:
        if name.startswith("ekf-pm"):
            factors[name] = {"all": 0.2 * factors[name]["all"]}
    row = overall(BY_ID["C19"].judge(fabricate(published, **factors)))
    assert row.verdict == Verdict.DEPENDS and "filter depends on assumption" in row.reason


def test_runs_that_fail_in_a_cell_keep_an_attribution_from_being_replicated(published):
    factors = cells("gate", 0.8)
    factors["ukf-gate"] = factors["ukf-gate"] | {"failed": range(3)}
    row = overall(BY_ID["C13"].judge(fabricate(published, **factors)))
    assert row.verdict == Verdict.DIRECTION_ONLY
