"""Every table of the wing is what it promises: its columns, its numbers against independent arithmetic, and failures as words."""

import re

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.intervals import proportion_interval
from robins.evaluate.ledger import build_ledger
from robins.evaluate.published import published_value, read_published
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023 import PAPER, questions, tables_errors, tables_study
from robins.papers.hajiyev2023.scenario import baseline, differenced, system
from robins.papers.hajiyev2023.table_parts import geometric, patterns
from robins.papers.hajiyev2023.tables import TABLES
from robins.papers.protocol import Output, Results, Settings
from robins.publish import tables as writer
from robins.publish.tolerances import refuse_columns, refuse_tolerances

SETTINGS = Settings(
    "smoke", 1, {"runs": 8, "sweep_runs": 8, "specification_sets": 8, "specification_runs": 4, "bootstrap": 20}, {"plant": "f4c"}
)
BY_NAME = {table.name: table for table in TABLES}


@pytest.fixture(scope="module")
def published(repository):
    return read_published(repository / "data" / "published" / "hajiyev2023.csv")


@pytest.fixture(scope="module")
def outputs() -> dict[str, Output]:
    """The outputs of the jobs, each computed once."""
    return {}


@pytest.fixture(scope="module")
def load(outputs):
    def load(name):
        if name not in outputs:
            outputs[name] = PAPER.jobs[name].compute(SETTINGS)
        return outputs[name]

    return load


@pytest.fixture(scope="module")
def results_for(load, published):
    """``results_for(name)``: what the table may read, which is what it says that it needs and nothing else."""

    def results(name, load=load) -> Results:
        needs = BY_NAME[name].needs

        def allowed(job):
            assert job in needs
            return load(job)

        ledger = None
        if "claims" in needs:
            rows = [row for claim in PAPER.claims for row in claim.judge(Results(SETTINGS, published, load))]
            ledger = build_ledger(PAPER.key, rows, published)
        return Results(SETTINGS, published, allowed, ledger)

    return results


@pytest.fixture(scope="module")
def frame_of(results_for):
    """``frame_of(name)``: a table, built once for all tests that look at it."""
    built = {}

    def frame(name) -> pd.DataFrame:
        if name not in built:
            built[name] = BY_NAME[name].build(results_for(name))
        return built[name].copy()

    return frame


def rmse(load, variant, branch, condition="fault", estimate="delayed") -> np.ndarray:
    """RMSE (runs, 8), read from the job's table by pivoting."""
    table = load(variant).table
    chosen = table[(table["branch"] == branch) & (table["condition"] == condition) & (table["estimate"] == estimate)]
    return chosen.pivot(index="run", columns="state", values="rmse")[list(STATES)].to_numpy()


@pytest.mark.parametrize("name", BY_NAME)
def test_a_table_reads_what_it_needs_keeps_its_promises_and_survives_the_disk(name, frame_of, tmp_path):
    table, frame = BY_NAME[name], frame_of(name)
    writer.write(frame, table, tmp_path / "table.csv", 8)  # refuses NaN, wrong columns and double keys
    back = writer.read(tmp_path / "table.csv", table)
    assert refuse_columns(table) == [] and refuse_tolerances(table, back) == []
    assert not frame.astype(str).isin(["failed"]).any().any()  # no filter fails in the baseline
    assert table.size in ("", *SETTINGS.sizes)
    assert table.title and (table.caption or not table.size)


def test_the_registry_holds_every_table_once_and_all_say_that_the_aircraft_is_a_substitute():
    assert len(BY_NAME) == len(TABLES)
    assert set(TABLES) <= set(PAPER.tables)
    assert all("ubstitute" in table.caption for table in TABLES if table.name != "extra-equations")


def test_table_1_stands_beside_the_published_cells_in_the_branchs_unit(frame_of, load, published):
    frame = frame_of("table-1").set_index(["branch", "state"])
    assert len(frame) == 16
    for branch in ("deg", "rad"):
        values = rmse(load, "amdkf-printed", branch)
        for i, state in enumerate(STATES):
            row = frame.loc[branch, state]
            assert row["published_amdkf"] == published_value(published, f"C{i + 1}", f"RMSE {state} AMDKF")
            factor = 180 / np.pi if branch == "deg" and i >= 2 else 1.0
            assert row["amdkf_mean"] == pytest.approx(factor * values[:, i].mean())
            assert row["amdkf_median"] == pytest.approx(factor * np.median(values[:, i]))
            assert row["misfit"] == row["mdkf_mean"] / row["published_mdkf"]
            assert row["unit"] == ("m/s" if i < 2 else branch + "/s" * (state in "qpr"))


def test_every_filter_but_the_late_ones_has_a_row_for_each_kind_of_estimate(frame_of):
    frame = frame_of("extra-filters")
    found = set(frame[["filter", "estimate"]].itertuples(index=False, name=None))
    filters = {job.name for job in PAPER.variants if not job.name.endswith("lagged")}
    assert {name for name, _ in found} == filters
    assert {name for name, kind in found if kind == "filtered"} == {name for name in filters if "mdkf" not in name}
    assert len(frame) == 32 * len(found)


def test_ratios_chain_for_the_geometric_mean_of_products_is_the_product(frame_of):
    frame = frame_of("extra-ratios")
    frame = frame[(frame["numerator_estimate"] == "delayed") & (frame["denominator_estimate"] == "delayed")]
    pairs = {key: group["ratio"].to_numpy() for key, group in frame.groupby(["numerator", "denominator"])}
    product = pairs["amdkf-printed", "mdkf-printed"] * pairs["mdkf-printed", "ckf"]
    assert pairs["amdkf-printed", "ckf"] == pytest.approx(product)
    chained = pairs["abh", "bh"] * pairs["bh", "mdkf-printed"]
    assert chained == pytest.approx(pairs["abh", "amdkf-printed"] * pairs["amdkf-printed", "mdkf-printed"])


def test_lateral_ratios_depend_neither_on_the_branch_nor_on_the_fault(frame_of):
    frame = frame_of("extra-ratios")
    lateral = frame[frame["state"].isin(STATES[4:]) & (frame["numerator"] == "amdkf-printed") & (frame["denominator"] == "mdkf-printed")]
    for _, group in lateral.groupby("state"):
        assert np.ptp(group["ratio"]) < 1e-9 * group["ratio"].mean()


def test_sign_patterns_count_runs_and_a_failed_run_is_worse(frame_of, load, results_for):
    frame = frame_of("extra-sign-patterns").set_index(["pair", "branch", "condition", "pattern"])
    for branch in ("deg", "rad"):
        logs = np.log(rmse(load, "abh", branch) / rmse(load, "bh", branch))
        count = int(np.sum(np.all(logs[:, 4:] > 0, axis=1)))
        row = frame.loc["abh/bh", branch, "fault", "four lateral worse"]
        assert (row["runs"], row["share"]) == (count, count / 8)
        assert [row["share_low"], row["share_high"]] == pytest.approx(list(proportion_interval(count, 8)[1:3]))

    def with_failures(name):
        table = load(name).table.copy()
        lost = (table["run"] < 3) & (name == "abh") | (table["run"].between(2, 4)) & (name == "bh")
        table.loc[lost, "failed"] = True
        table.loc[lost, "rmse"] = np.nan
        return Output(table)

    found = tables_errors.signs(results_for("extra-sign-patterns", with_failures), tables_errors.Pair("abh", "bh"), "deg", "fault")
    assert np.all(found[:2] == 1) and np.all(found[2] == 0) and np.all(found[3:5] == -1)


def test_the_published_pattern_is_both_halves_at_once():
    signs = np.array([[-1] * 4 + [1] * 4, [-1] * 4 + [1, 1, 1, -1], [1] * 8, [-1] * 8, [-1, -1, -1, 0] + [1] * 4])
    found = patterns(signs)
    assert [shown.tolist() for shown in found.values()] == [
        [True, True, False, True, False],
        [True, False, True, False, True],
        [True, False, False, False, False],
    ]


def failing(load, share):
    """The jobs with the first `share` of the runs of the MDKF failed, whatever NaN that leaves."""

    def changed(name):
        output = load(name)
        if name != "mdkf-printed":
            return output
        table = output.table.copy()
        lost = table["run"] < share * SETTINGS.sizes["runs"]
        table.loc[lost, ["rmse", "scale", "gain_norm", "own_gain", "nis_settled", "nis_window"]] = np.nan
        table.loc[lost, "failed"] = True
        return Output(table, output.arrays)

    return changed


@pytest.mark.parametrize("name", ["table-1", "extra-filters", "extra-ratios", "extra-sign-patterns", "extra-lagged", "extra-consistency"])
@pytest.mark.parametrize("share", [0.25, 0.9, 1.0])
def test_a_filter_that_fails_leaves_words_and_counts_and_no_nan(name, share, results_for, load):
    table = BY_NAME[name]
    frame = table.build(results_for(name, failing(load, share)))
    writer.validate(frame, table)
    words = frame.astype(str).isin(["failed"]).any().any()
    assert words == (share > 0.5 and name != "extra-sign-patterns")


def test_the_median_counts_a_failed_run_as_infinite(results_for, load):
    frame = tables_errors.table_1(results_for("table-1", failing(load, 0.25)))
    row = frame[(frame["branch"] == "deg") & (frame["state"] == "u")].iloc[0]
    values = np.sort(rmse(load, "mdkf-printed", "deg")[2:, 0])
    assert row["mdkf_median"] == pytest.approx((values[3] + values[4]) / 2)
    assert row["mdkf_mean"] == pytest.approx(values.mean())
    assert (row["n"], row["mdkf_failed"], row["amdkf_failed"]) == (8, 2, 0)


def test_the_baseline_is_one_point_of_every_sweep(frame_of):
    frame = frame_of("extra-sweeps")
    points = {"window": "20", "multiplier": "8, 5", "duration": "70", "tau": "100", "dt": "0.1", "sigma-v": "1", "sigma-w": "1"}
    base = frame[[points.get(sweep) == setting for sweep, setting in zip(frame["sweep"], frame["setting"], strict=True)]]
    for _, group in base.groupby(["branch", "pair", "state"]):
        assert len(group) == len(points)
        assert np.ptp(group["ratio"]) < 1e-9 * group["ratio"].mean()


def test_geometric_means_of_ratios_have_a_normal_interval_on_the_logarithm():
    found = geometric(np.array([1.0, 2.0, 4.0]), np.array([1.0, 1.0, 1.0]))
    half = 1.959964 * np.log(2) / np.sqrt(3)
    assert found == pytest.approx({"ratio": 2.0, "ci_low": 2 * np.exp(-half), "ci_high": 2 * np.exp(half)}, rel=1e-6)
    assert geometric(np.array([]), np.array([])) == dict.fromkeys(("ratio", "ci_low", "ci_high"), "failed")
    assert geometric(np.array([2.0]), np.array([1.0])) == {"ratio": pytest.approx(2.0), "ci_low": "failed", "ci_high": "failed"}


def test_specification_shares_come_from_the_sets(frame_of, load):
    table, frame = load("specification-rad").table, frame_of("extra-specification")
    chosen = table[(table["pair"] == "aakf/akf") & (table["state"] == "w")]["ratio"]
    row = frame[(frame["branch"] == "rad") & (frame["pair"] == "aakf/akf") & (frame["state"] == "w")].iloc[0]
    assert row["below_1"] == np.mean(chosen < 1) and row["above_1.05"] == np.mean(chosen > 1.05)
    assert row["q50"] == pytest.approx(np.median(chosen))
    assert (frame["below_0.95"] <= frame["below_1"]).all()
    assert set(frame["n"]) == {8}


def test_healthy_scale_factors_follow_from_the_innovation_covariance_18(results_for):
    """An independent recursion of (14)-(16), by inverses."""
    parameters = baseline("deg")
    m = system(parameters)
    d = differenced(m)
    R, P, sigma = d.R_process + d.R_sensor, m.P0, []
    for k in range(1, parameters.steps):
        P = m.A @ P @ m.A.T + m.Q
        S = d.H_d @ P @ d.H_d.T + R + d.H_d @ d.C + d.C.T @ d.H_d.T
        K = (P @ d.H_d.T + d.C) @ np.linalg.inv(S)
        P = P - K @ S @ K.T
        sigma += [np.diag(S)] if 100 <= k < 150 else []
    expected = 1 + 0.564 * np.mean(sigma, axis=0) / np.diag(R) / np.sqrt(20)
    assert tables_study.healthy_scale(results_for("extra-scale-factors"), "deg") == pytest.approx(expected, rel=1e-9)


def test_theory_of_scale_factors_stands_beside_the_printed_filter_only(frame_of):
    frame = frame_of("extra-scale-factors")
    printed = frame[frame["filter"] == "amdkf-printed"]
    assert set(printed.loc[printed["fault_theory"] != "", "channel"]) == {"q", "theta"}
    assert (printed["healthy_theory"].astype(float) > 1).all()
    assert set(frame.loc[frame["filter"] != "amdkf-printed", "healthy_theory"]) == {""}


def test_published_parameters_are_those_of_the_published_table_and_no_others(frame_of, published):
    frame = frame_of("extra-parameters").set_index("symbol")
    known = {
        "multiplier of v_q": ("A14", "pitch-rate measurement noise multiplier"),
        "multiplier of v_theta": ("A14", "pitch-angle measurement noise multiplier"),
        "fault start": ("A15", "fault interval"),
        "RMSE divisor": ("A16", "RMSE divisor"),
        "lower bound of s_i": ("A8", "lower bound of the scale factors s_i"),
    }
    for symbol, key in known.items():
        assert frame.loc[symbol, "value"] == published_value(published, *key)
    assert frame.loc["fault end", "value"] == float(published.loc[published["quantity"] == "fault interval", "value_high"].iloc[0])
    assert set(frame.index[frame["published"] == "Y"]) == {*known, "fault end"}
    assert set(frame["origin"]) == {"published", "calibrated", "assumed", "substitute"}
    both = frame.loc["sigma_w"].set_index(["channel", "branch"])
    assert both.loc[("q", "deg"), "value"] == both.loc[("q", "rad"), "value"] == 0.01
    assert (both.loc[("q", "deg"), "unit"], both.loc[("q", "rad"), "unit"]) == ("deg/s", "rad/s")


def test_equations_1_to_29_are_audited(frame_of):
    numbers = frame_of("extra-equations")["number"]
    assert {int(text) for cell in numbers for text in re.findall(r"\d+", cell)} >= set(range(1, 30))


def test_claims_in_short_repeat_the_ledger(frame_of, results_for):
    frame, ledger = frame_of("extra-claims"), results_for("extra-claims").ledger
    overall = ledger[ledger["condition"] == "overall"].set_index("claim_id")
    assert frame["claim_id"].tolist() == [f"C{number}" for number in range(1, 17)]
    assert (frame["verdict"].to_numpy() == overall.loc[frame["claim_id"], "verdict"].to_numpy()).all()
    row = ledger[(ledger["claim_id"] == "C4") & (ledger["condition"] == "rad, fault") & (ledger["variant"] == "amdkf-printed/mdkf-printed")]
    assert frame.set_index("claim_id").loc["C4", "rad"] == float(row["ours"].iloc[0])


def test_every_question_is_answered(frame_of):
    frame = frame_of("extra-questions")
    assert frame["question"].tolist() == [*(f"Q{number}" for number in range(1, 8)), "A2"]
    assert (frame["answer"].str.len() > 40).all() and frame["answer"].str.endswith(".").all()
    for name in ", ".join(frame["evidence"]).split(", "):
        assert name in BY_NAME


def test_the_answer_about_a_late_program_counts_the_states_in_which_late_is_nearer(frame_of):
    answer = frame_of("extra-questions").set_index("question").loc["A2", "answer"]
    table = frame_of("extra-lagged")
    for kind in ("MDKF", "AMDKF"):
        for branch in ("deg", "rad"):
            late = table[(table["filter"] == kind) & (table["branch"] == branch) & (table["nearer"] == "late")]["state"].tolist()
            assert f"{kind}, {branch}: the late form is nearer in {len(late)} of 8 states" + f" ({' '.join(late)})" * bool(late) in answer


@pytest.mark.parametrize(
    ("sides", "words"),
    [
        ({"q": "better", "theta": "better"}, "helps in both"),
        ({"q": "worse", "theta": "better"}, "helps in theta only"),
        ({"q": "worse", "theta": "neither"}, "helps in neither"),
    ],
)
def test_the_answer_about_the_faulty_channels_is_chosen_by_the_intervals(monkeypatch, sides, words):
    monkeypatch.setattr(questions, "side", lambda results, pair, branch, condition, state: sides[state])
    monkeypatch.setattr(questions, "estimate", lambda *_: "1.000")
    assert questions.faulty_channels(None).count(words) == 2


def test_the_answer_about_units_is_chosen_by_the_intervals(monkeypatch, results_for):
    results = results_for("extra-questions")
    monkeypatch.setattr(questions, "side", lambda *_: "better")
    assert questions.units(results).startswith("No: every state")
    monkeypatch.setattr(questions, "side", lambda results, pair, branch, *_: "better" if branch == "deg" else "worse")
    assert questions.units(results).startswith("Yes, in u (deg: better; rad: worse), w")


def test_the_answer_about_other_filters_says_where_they_answer_otherwise(monkeypatch):
    def side(results, pair, branch, condition, state):
        return "worse" if pair.numerator == "aakf" and state == "phi" else "better"

    monkeypatch.setattr(questions, "side", side)
    monkeypatch.setattr(questions, "estimate", lambda *_: "1.000")
    answer = questions.corrected_filters(None)
    assert answer.count("another answer than AMDKF over MDKF in phi") == 2
    assert answer.count("the answer of AMDKF over MDKF in all eight states") == 2
