"""An ensemble's scores: right by their definition, paired, independent of its size, and honest about failed runs."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.ensemble import autocorrelation, diverged, epoch_mean, scenario, scores, summaries, surviving, variant
from robins.papers.hajiyev2023.estimators import augmented, corrected, printed
from robins.papers.hajiyev2023.scenario import BRANCHES, CONDITIONS
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Settings

LATERAL = list(STATES[4:])


def settings(runs):
    return Settings("smoke", 1, {"runs": runs}, {"plant": "f4c"})


@pytest.fixture(scope="module")
def tables():
    """The tables of four variants over four runs."""
    return {name: variant(settings(4), VARIANTS[name].composition).table for name in ("mdkf-printed", "amdkf-printed", "akf", "aakf")}


def rmse(table, estimate, **where):
    kept = table[table["estimate"] == estimate]
    for column, value in where.items():
        kept = kept[kept[column] == value]
    return kept.set_index(["run", "state"])["rmse"].unstack("state")


@pytest.mark.parametrize(("adaptive", "plain", "estimate"), [("amdkf-printed", "mdkf-printed", "delayed"), ("aakf", "akf", "filtered")])
def test_lateral_ratios_are_equal_in_both_branches(tables, adaptive, plain, estimate):
    """The lateral block stands alone and is linear: its ratios do not know the unit."""
    degrees, radians = (
        (rmse(tables[adaptive], estimate, branch=b, condition="fault") / rmse(tables[plain], estimate, branch=b, condition="fault"))[
            LATERAL
        ]
        for b in BRANCHES
    )
    np.testing.assert_allclose(degrees, radians, rtol=1e-9)


def test_lateral_levels_of_the_branches_differ_by_the_unit(tables):
    degrees, radians = (rmse(tables["mdkf-printed"], "delayed", branch=b, condition="fault")[LATERAL] for b in BRANCHES)
    np.testing.assert_allclose(radians, np.degrees(degrees), rtol=1e-9)


def test_lateral_states_do_not_feel_the_fault_without_adaptation(tables):
    fault, healthy = (rmse(tables["mdkf-printed"], "delayed", branch="deg", condition=c)[LATERAL] for c in CONDITIONS)
    np.testing.assert_allclose(fault, healthy, rtol=1e-12)


def test_a_run_scores_the_same_in_a_larger_ensemble(tables):
    larger = variant(settings(10), VARIANTS["amdkf-printed"].composition).table
    pd.testing.assert_frame_equal(larger[larger["run"] == 3].reset_index(drop=True),
                                  tables["amdkf-printed"][tables["amdkf-printed"]["run"] == 3].reset_index(drop=True))  # fmt: skip


def test_a_variant_has_a_row_for_each_branch_condition_run_estimate_and_state(tables):
    for name, estimates in (("mdkf-printed", ["delayed"]), ("akf", ["filtered", "delayed"])):
        table = tables[name]
        assert len(table) == 2 * 2 * 4 * len(estimates) * 8
        assert not table.duplicated(["branch", "condition", "run", "estimate", "state"]).any()
        assert not table.isna().any().any() and not table["failed"].any()


def test_scores_are_those_of_their_definitions(problem):
    case = problem(3)
    form = printed(case.matrices, case.parameters, "per-channel")
    record = case.run(form, "fault")
    frame = scores(form, record, case.ensemble, case.parameters, range(3))
    row = frame[(frame["run"] == 2) & (frame["state"] == "q")].iloc[0]
    errors = record.posterior[2, :, 2] - case.ensemble.x[2, :, 2]
    assert row["rmse"] == pytest.approx(np.sqrt(sum(errors[k] ** 2 for k in range(80, 151)) / 70), rel=1e-12)
    assert row["scale"] == pytest.approx(np.mean([1 / record.weights[2, k, 2] for k in range(100, 150)]), rel=1e-12)
    assert row["gain_norm"] == pytest.approx(np.mean([record.gain_norm[2, k, 2] for k in range(100, 150)]), rel=1e-12)
    assert row["own_gain"] == pytest.approx(np.mean([abs(record.gain_diagonal[2, k, 2]) for k in range(100, 150)]), rel=1e-12)
    assert row["nis_settled"] == pytest.approx(np.mean([record.nis[2, k] for k in range(30, 200)]), rel=1e-12)
    assert row["nis_window"] == pytest.approx(np.mean([record.nis[2, k] for k in range(80, 150)]), rel=1e-12)


def test_a_filter_on_z_is_scored_filtered_and_delayed(problem):
    case = problem(3)
    form = augmented(case.matrices, case.parameters)
    record = case.run(form)
    frame = scores(form, record, case.ensemble, case.parameters, range(3))
    assert frame["estimate"].unique().tolist() == ["filtered", "delayed"]
    for kind, estimate in (("filtered", record.posterior), ("delayed", record.delayed)):
        expected = np.sqrt(np.sum((estimate - case.ensemble.x)[:, 80:151] ** 2, axis=1) / 70)
        np.testing.assert_allclose(frame.loc[frame["estimate"] == kind, "rmse"], expected.ravel(), rtol=1e-12)


def test_looking_one_step_ahead_helps(problem):
    """For a right filter the delayed estimate is never worse on average: more data, same state."""
    case = problem(100)
    form = augmented(case.matrices, case.parameters)
    frame = scores(form, case.run(form), case.ensemble, case.parameters, range(100))
    means = frame.assign(square=frame["rmse"] ** 2).groupby(["estimate", "state"])["square"].mean().unstack("estimate")
    assert (means["delayed"] < means["filtered"]).all()


def test_a_run_beyond_the_bound_fails_with_its_reason_and_leaves_the_summaries(problem):
    case = problem(6)
    form = printed(case.matrices, case.parameters)
    record = case.run(form)
    worst = np.nanmax(np.abs(record.posterior - case.ensemble.x), axis=(1, 2))
    bound = float(np.sort(worst)[2:4].mean())  # three runs pass it, three do not
    frame = scores(form, record, case.ensemble, replace(case.parameters, divergence=bound), range(6))
    failed = frame["failed"].to_numpy()[::8]
    np.testing.assert_array_equal(failed, worst > bound)
    assert set(frame.loc[frame["failed"], "reason"]) == {f"error beyond {bound:g} or not finite"}
    assert set(frame.loc[~frame["failed"], "reason"]) == {""}
    survivors, truth = surviving(record, case.ensemble, failed)
    assert survivors.posterior.shape[0] == truth.shape[0] == 3
    assert survivors.posterior_variance.shape[0] == 1, "a covariance that all runs share stays"
    np.testing.assert_array_equal(survivors.posterior, record.posterior[~failed])
    arrays = summaries(form, survivors, truth)
    np.testing.assert_array_equal(arrays["truth0"], case.ensemble.x[~failed][0])
    np.testing.assert_allclose(arrays["rms_error"][150], np.sqrt(np.mean((survivors.posterior - truth)[:, 150] ** 2, axis=0)), rtol=1e-12)


@pytest.mark.parametrize("rule", ["per-channel", ""], ids=["adaptive", "gains computed beforehand"])
def test_a_run_that_is_not_finite_fails_with_its_reason(problem, rule):
    case = problem(2)
    form = printed(case.matrices, case.parameters, rule)
    broken = case.ensemble.z["healthy"].copy()
    broken[1, 60, 0] = np.nan
    spoilt = case._replace(ensemble=case.ensemble._replace(z={"healthy": broken}))
    record = spoilt.run(form)
    frame = scores(form, record, spoilt.ensemble, case.parameters, range(2))
    assert frame["failed"].tolist() == [False] * 8 + [True] * 8
    assert frame.loc[frame["failed"], "reason"].str.contains("not finite").all()
    kept, truth = surviving(record, spoilt.ensemble, frame["failed"].to_numpy()[::8])
    assert len(kept.posterior) == len(truth) == 1
    np.testing.assert_array_equal(kept.posterior[0], record.posterior[0])


def test_a_score_that_is_not_finite_is_a_failure_even_if_the_filter_saw_none(problem):
    case = problem(3)
    record = case.run(printed(case.matrices, case.parameters))
    score = np.zeros((3, 8))
    score[1, 4], score[2, 0] = np.nan, np.inf
    errors = record.posterior - case.ensemble.x
    assert diverged(record, errors, score, case.parameters.divergence).tolist() == [False, True, True]


def test_nothing_is_removed_when_nothing_failed(problem):
    case = problem(3)
    record = case.run(printed(case.matrices, case.parameters))
    errors = record.posterior - case.ensemble.x
    assert not diverged(record, errors, np.zeros((3, 8)), case.parameters.divergence).any()
    kept, truth = surviving(record, case.ensemble, np.zeros(3, bool))
    assert kept is record and truth is case.ensemble.x


def test_epoch_mean_counts_only_epochs_with_a_value():
    values = np.array([[np.nan, 1.0, 3.0], [2.0, np.nan, np.nan], [np.nan, np.nan, np.nan]])
    np.testing.assert_array_equal(epoch_mean(values), [2.0, 2.0, np.nan])


def test_autocorrelation_of_a_moving_average_is_the_known_one():
    white = np.random.default_rng(11).standard_normal((200, 201, 1))
    average = white[:, 1:] - 0.5 * white[:, :-1]
    lags, count = autocorrelation(average, np.ones((1, 200, 1)))
    assert count.tolist() == [200 * (170 - lag) for lag in range(21)], "170 settled epochs; lag l leaves l of them without a partner"
    assert lags[0, 0] == 1.0 and lags[1, 0] == pytest.approx(-0.4, abs=0.02)
    np.testing.assert_allclose(lags[2:], 0.0, rtol=0, atol=0.03)


def test_summaries_of_a_right_filter_agree_with_its_own_variance(problem):
    case = problem(400, sigma_v=(0.0,) * 8)
    form = corrected(case.matrices, case.parameters)
    arrays = summaries(form, case.run(form), case.ensemble.x)
    np.testing.assert_allclose(arrays["innovation_variance_ratio"], 1.0, rtol=0, atol=0.03)
    np.testing.assert_allclose(np.mean(arrays["rms_error"][100:150] / arrays["sd_mean"][100:150], axis=0), 1.0, rtol=0, atol=0.1)
    low, _, _, _, high = arrays["error_quantiles"][:, 120]
    np.testing.assert_allclose((high - low) / (2 * 1.96 * arrays["sd_mean"][120]), 1.0, rtol=0, atol=0.2)
    assert np.mean(arrays["nis_mean"][30:200]) == pytest.approx(8.0, abs=0.1)


@pytest.mark.parametrize("branch", BRANCHES)
def test_scenario_output_is_run_0_of_the_ensemble(branch):
    output = scenario(settings(1), branch)
    assert output.table["state"].tolist() == list(STATES)
    arrays = output.arrays
    assert arrays["truth"].shape == arrays["z.fault"].shape == (201, 8)
    np.testing.assert_array_equal(arrays["truth"], variant(settings(1), VARIANTS["akf"].composition).arrays[f"{branch}.fault.truth0"])
    matrices = {name.removeprefix("matrix."): value for name, value in arrays.items() if name.startswith("matrix.")}
    xi = arrays["residual.differenced-noise"]
    mu = arrays["z.healthy"][1:] - arrays["z.healthy"][:-1] @ matrices["A_n"].T
    H_d = matrices["H"] @ matrices["A"] - matrices["A_n"] @ matrices["H"]
    expected = mu - arrays["truth"][:-1] @ H_d.T - arrays["controls"][:-1] @ (matrices["H"] @ matrices["B"]).T
    np.testing.assert_allclose(xi, expected, rtol=0, atol=1e-12)
