"""An ensemble's jobs: the tables and arrays that they promise, paired and independent of their size, and honest about failed runs."""

import numpy as np
import pandas as pd
import pytest

from robins.papers.imani2026 import drive as driving
from robins.papers.imani2026 import ensemble, reference, scoring
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.ensemble import (
    Case,
    batches,
    epoch_means,
    frozen,
    gather,
    headline,
    method_of,
    quantiles,
    scenario,
    scores,
    variant,
)
from robins.papers.imani2026.formulations import FORMULATIONS, formulation
from robins.papers.imani2026.methods import Setting
from robins.papers.imani2026.sensors import Sensors, measure
from robins.papers.imani2026.variants import VARIANTS

RUNS = 3
MEASURES = ["rmse", "mean", "sd", "drift", "drift_integral"]


def composed(name, settings, results=None):
    return variant(settings, results, composition=VARIANTS[name].composition)


@pytest.fixture(scope="module")
def increments(settings):
    """The job of the chi-square filter over three runs."""
    return composed("ci-seq-nominal", settings(runs=RUNS))


@pytest.fixture(scope="module")
def methods(settings):
    """Three filters of the registry."""
    small = settings()
    return {
        name: method_of(VARIANTS[name].composition, small, None, headline(small)) for name in ("ekf", "gate-nominal", "mk-norm-nominal")
    }


def one(table, **where):
    for column, value in where.items():
        table = table[table[column] == value]
    assert len(table) == 1
    return table.iloc[0]


# The scenario.


def test_the_scenario_is_the_drive_with_the_reference_and_the_noise_of_run_0(settings):
    output = scenario(settings())
    driven, arrays = driving.drive(10), output.arrays
    np.testing.assert_array_equal(arrays["time"], np.arange(3301) / 10.0)
    np.testing.assert_array_equal(arrays["truth"], driving.truth(driven))
    np.testing.assert_array_equal(arrays["truth_interval"], driving.truth_interval(driven))
    np.testing.assert_array_equal(arrays["position"], driven.position)
    np.testing.assert_allclose(arrays["speed"], np.sqrt((driven.velocity_n**2).sum(axis=1)), rtol=1e-12)
    seen = reference.observe(1, "drive-10hz", 0, driven)
    np.testing.assert_array_equal(arrays["reference"], seen.channels)
    np.testing.assert_array_equal(arrays["reference_position"], seen.position)
    noise = measure(1, "drive-10hz", range(1), driven, Sensors()).noise[0]
    np.testing.assert_array_equal(np.hstack([arrays["residual.accelerometer"], arrays["residual.gyroscope"]]), noise)
    assert arrays["rate_hz.accelerometer"] == arrays["rate_hz.gyroscope"] == 10.0
    np.testing.assert_array_equal(arrays["way_point_times"], [0, 58, 108, 177, 233, 312])
    np.testing.assert_array_equal(arrays["way_points"], driven.position[[0, 580, 1080, 1770, 2330, 3120]])


def test_table_4_has_every_parameter_with_its_unit_and_its_source(settings):
    table = scenario(settings()).table
    assert list(table.columns) == ["parameter", "symbol", "value", "unit", "source"]
    assert not table.isna().any().any() and table["parameter"].is_unique
    for field, value in vars(Sensors()).items():
        if isinstance(value, float):
            assert value in table["value"].to_numpy(), field


# A variant.


def test_a_variant_has_a_row_for_each_formulation_run_comparison_and_channel(increments):
    table = increments.table
    assert list(table.columns) == ["formulation", "run", "against", "channel", *MEASURES, "failed", "reason"]
    assert len(table) == len(FORMULATIONS) * RUNS * (12 + 6 + 12)
    assert not table.duplicated(["formulation", "run", "against", "channel"]).any()
    assert set(table.loc[table["against"] == "interval", "channel"]) == set(CHANNELS[3:9])
    assert not table.isna().any().any() and not table["failed"].any() and set(table["reason"]) == {""}
    np.testing.assert_allclose(table["rmse"] ** 2, table["mean"] ** 2 + table["sd"] ** 2, rtol=1e-12)


def test_a_variant_has_the_promised_arrays(increments):
    shapes = {
        "estimate0": (3301, 12), "error_quantiles": (3, 331, 12), "nis": (RUNS,), "nis_mean": (331,), "nees_attitude": (RUNS, 11),
        "nees_bias": (RUNS, 11), "marks": (11,), "position_rms": (RUNS, 3), "position_final": (RUNS, 3), "share_reduced": (RUNS, 6),
        "failed": (RUNS,),
    }  # fmt: skip
    assert {key: array.shape for key, array in increments.arrays.items()} == {
        f"{name}.{key}": shape for name in FORMULATIONS for key, shape in shapes.items()
    }
    for name in FORMULATIONS:
        np.testing.assert_array_equal(increments.arrays[f"{name}.marks"], np.arange(300, 3301, 300))
        assert np.isnan(increments.arrays[f"{name}.error_quantiles"][:, 0]).all(), "epoch 0 has no error"
        assert np.isnan(increments.arrays[f"{name}.nis_mean"][0]), "nor a measurement"
        assert increments.arrays[f"{name}.failed"].dtype == bool


@pytest.mark.parametrize("name", FORMULATIONS)
def test_the_numbers_of_a_variant_are_those_of_their_definitions(settings, increments, journey, name):
    """Run 2, channel by channel, from the record of a filter that was run apart."""
    small = settings()
    method = method_of(VARIANTS["ci-seq-nominal"].composition, small, None, headline(small))
    trip = journey(RUNS)
    followed, driven, table = trip.follow(name, method), trip.case.driven, increments.table
    truths = {
        "truth": driving.truth(driven),
        "interval": driving.truth_interval(driven),
        "reference": reference.observe(1, "drive-10hz", 2, driven).channels,
    }
    for against, true in truths.items():
        for i in range(3, 9) if against == "interval" else range(12):
            error = followed.estimate[2, 1:, i] - true[1:, i]
            if i > 8:
                error = np.angle(np.exp(1j * error))
            row = one(table, formulation=name, run=2, against=against, channel=CHANNELS[i])
            assert row["rmse"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-9)
            assert row["mean"] == pytest.approx(np.mean(error), rel=1e-6, abs=1e-12)
            assert row["drift"] == pytest.approx(error[-1], rel=1e-6, abs=1e-12)
            assert row["drift_integral"] == pytest.approx(np.sum(error) * 0.1, rel=1e-6, abs=1e-9)
    arrays, record = increments.arrays, followed.record
    np.testing.assert_array_equal(arrays[f"{name}.estimate0"], followed.estimate[0])
    np.testing.assert_allclose(arrays[f"{name}.nis"], np.mean(record.nis[:, 1:], axis=1), rtol=1e-12)
    np.testing.assert_allclose(arrays[f"{name}.nis_mean"][1:], np.mean(record.nis[:, 10::10], axis=0), rtol=1e-12)
    np.testing.assert_allclose(arrays[f"{name}.share_reduced"], np.mean(record.weights[:, 1:] < 1.0, axis=1), rtol=1e-12)
    np.testing.assert_allclose(
        arrays[f"{name}.error_quantiles"][:, 1:], np.quantile(followed.error[:, 9::10], [0.05, 0.5, 0.95], axis=0), rtol=1e-9, atol=1e-15
    )
    np.testing.assert_allclose(arrays[f"{name}.position_final"], record.posterior[:, -1, :3] - driven.position[-1], rtol=1e-12)


def test_without_updates_there_is_no_nis_and_no_weight(settings):
    arrays = composed("no-update", settings(runs=1)).arrays
    for name in FORMULATIONS:
        for key in ("nis", "nis_mean", "share_reduced"):
            assert np.isnan(arrays[f"{name}.{key}"]).all()
        assert np.isfinite(arrays[f"{name}.nees_bias"]).all() and not arrays[f"{name}.failed"].any()


# Pairing.


def test_a_run_does_not_depend_on_how_many_there_are_and_how_they_are_batched(settings, increments, monkeypatch):
    monkeypatch.setattr(ensemble, "BATCH", 3300)
    alone = composed("ci-seq-nominal", settings(runs=RUNS))
    pd.testing.assert_frame_equal(sort(alone.table), sort(increments.table))
    for key, array in increments.arrays.items():
        np.testing.assert_array_equal(alone.arrays[key], array, err_msg=key)
    fewer = composed("ci-seq-nominal", settings(runs=2)).table
    pd.testing.assert_frame_equal(sort(fewer), sort(increments.table[increments.table["run"] < 2]))


def sort(table):
    return table.sort_values(["formulation", "run", "against", "channel"], ignore_index=True)


def test_batches_hold_every_run_once_and_in_order(monkeypatch):
    case = Case(1, 1, Sensors())
    monkeypatch.setattr(ensemble, "BATCH", 2 * 330 + 50)
    found = [(list(runs), measured) for runs, measured in batches(case, range(1000, 1005))]
    assert [runs for runs, _ in found] == [[1000, 1001], [1002, 1003], [1004]]
    for runs, measured in found:
        np.testing.assert_array_equal(measured.atomic, measure(1, "drive-1hz", runs, case.driven, Sensors()).atomic)


def test_a_filter_scores_the_same_beside_others_and_in_its_variant(settings, methods):
    case = headline(settings())
    together = scores(case, range(2), methods)
    assert list(together.columns) == ["filter", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]
    assert len(together) == 3 * 2 * 12 and not together.duplicated(["filter", "run", "channel"]).any()
    for name, method in methods.items():
        alone = scores(case, range(2), {name: method})
        pd.testing.assert_frame_equal(together[together["filter"] == name].reset_index(drop=True), alone)
        table, _ = gather(ensemble.build("F1", method, case), method, case, range(2))
        table = table[table["against"] == "truth"].reset_index(drop=True)
        pd.testing.assert_frame_equal(
            alone[["run", "channel", "rmse", "mean", "drift"]], table[["run", "channel", "rmse", "mean", "drift"]]
        )


def test_streams_carry_the_rate_because_another_rate_has_another_number_of_samples():
    assert Case(1, 10, Sensors()).scenario == "drive-10hz" and Case(1, 50, Sensors()).scenario == "drive-50hz"


def test_runs_that_settings_are_tuned_on_are_no_reporting_runs(settings):
    runs = ensemble.tuning_runs(settings(tuning_runs=20))
    assert list(runs) == list(range(1000, 1020))
    assert not set(runs) & set(range(500))  # the largest ensemble


# Failures.


def test_a_failed_run_is_counted_and_has_no_numbers(settings, increments, monkeypatch):
    """The bound lies between the largest velocity errors of the runs: some pass it, the others stay as they are."""
    case = headline(settings())
    method = method_of(VARIANTS["ci-seq-nominal"].composition, settings(), None, case)
    ((_, measured),) = batches(case, range(RUNS))
    form = ensemble.build("F1", method, case)
    error = scoring.errors(scoring.estimates(form, ensemble.run(form, method, case, measured), measured), driving.truth(case.driven))
    worst = np.abs(error[..., :3]).max(axis=(1, 2))
    monkeypatch.setattr(scoring, "BOUND", float(np.sort(worst)[:2].mean()))
    table, arrays = gather(form, method, case, range(RUNS))
    assert arrays["failed"].tolist() == (worst > scoring.BOUND).tolist() and arrays["failed"].sum() == 2
    failed = table[table["failed"]]
    assert failed[MEASURES].isna().all().all() and failed["reason"].str.startswith("velocity error beyond").all()
    assert len(failed) == 2 * 30
    kept = table[~table["failed"]].reset_index(drop=True)
    before = increments.table[(increments.table["formulation"] == "F1") & increments.table["run"].isin(kept["run"])]
    pd.testing.assert_frame_equal(kept, before.drop(columns="formulation").reset_index(drop=True))
    (survivor,) = np.flatnonzero(~arrays["failed"])
    np.testing.assert_allclose(arrays["error_quantiles"][:, 1:], np.broadcast_to(error[survivor, 9::10], (3, 330, 12)), rtol=1e-12)


def test_a_variant_that_always_fails_has_its_rows_all_the_same(settings):
    output = composed("mk-raw", settings(runs=2))
    table = output.table
    assert len(table) == 3 * 2 * 30 and table["failed"].all() and table[MEASURES].isna().all().all()
    assert set(table["reason"]) == {"no Cholesky factor or not finite at epoch 2"}
    for name in FORMULATIONS:
        assert output.arrays[f"{name}.failed"].all()
        assert np.isnan(output.arrays[f"{name}.error_quantiles"]).all() and np.isnan(output.arrays[f"{name}.nis_mean"]).all()
        assert np.isnan(output.arrays[f"{name}.nees_bias"]).all()


def test_quantiles_and_means_are_those_of_the_runs_that_survive():
    values = np.random.default_rng(3).normal(size=(50, 4, 2))
    found = quantiles(values)
    assert np.isnan(found[:, 0]).all()
    np.testing.assert_allclose(found[1, 1:], np.median(values, axis=0)[1:], rtol=1e-12)
    assert np.isnan(quantiles(values[:0])).all() and quantiles(values[:0]).shape == (3, 4, 2)
    np.testing.assert_array_equal(epoch_means(np.array([[np.nan, 1.0], [np.nan, 3.0]])), [np.nan, 2.0])
    assert np.isnan(epoch_means(np.empty((0, 3)))).all()


# Tuned variants.


def test_a_tuned_variant_has_the_frozen_knobs_of_the_headline_condition(settings, tuned_results):
    small = settings(runs=1)
    chosen = {("gate", "headline"): (10.0, 4.5), ("gate", "outliers"): (0.1, 3.0), ("ekf", "headline"): (0.1, 10.0)}
    results, case = tuned_results(small, chosen), headline(small)
    assert frozen(results, "gate") == Setting(10.0, 4.5) and frozen(results, "gate", "outliers") == Setting(0.1, 3.0)
    gate = method_of(VARIANTS["gate"].composition, small, results, case)
    assert gate.noise_scale == 10.0 and gate.weighting.parameters[0] == 4.5
    assert method_of(VARIANTS["gate"].composition, small, results, case, "outliers").noise_scale == 0.1
    ekf = method_of(VARIANTS["ekf-tuned"].composition, small, results, case)
    form, plain = ensemble.build("F1", ekf, case), formulation("F1", 10, Sensors())
    np.testing.assert_allclose(form.sensor.R, 0.1 * plain.sensor.R, rtol=1e-12)
    np.testing.assert_allclose(form.model.noise, 10.0 * plain.model.noise, rtol=1e-12)


def test_a_warm_start_is_the_only_thing_that_the_warm_variant_changes(settings, tuned_results):
    small = settings()
    cold, warm = (method_of(VARIANTS[name].composition, small, tuned_results(small), headline(small)) for name in ("mk-li", "mk-li-warm"))
    assert not cold.weighting.iteration.warm and warm.weighting.iteration.warm
    assert warm._replace(weighting=None) == cold._replace(weighting=None)
    assert warm.weighting.iteration._replace(warm=False, prior=None) == cold.weighting.iteration._replace(prior=None)


def test_a_tuned_variant_is_scored_as_any_other(settings, tuned_results):
    small = settings(runs=1)
    usual, nominal = composed("ci-seq", small, tuned_results(small)).table, composed("ci-seq-nominal", small).table
    pd.testing.assert_frame_equal(usual, nominal)
