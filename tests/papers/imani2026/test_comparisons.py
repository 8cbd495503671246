"""Scores, levels and improvements come out of the jobs' tables as the brief defines them, failures and sweeps included."""

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.ensembles import SWAPS, holm
from robins.papers.imani2026.comparisons import (
    METRICS,
    adjusted,
    improvement,
    improvements,
    level,
    scores,
    sweep_improvement,
    sweep_level,
    sweep_scores,
)
from robins.papers.imani2026.drive import CHANNELS, DURATION
from robins.papers.protocol import Output, Results, Settings

RUNS = 40


def long_table(rmse, mean=0.0, drift=0.1, failed=(), channels=CHANNELS, **labels) -> pd.DataFrame:
    """Rows of a job: `rmse`, `mean` and `drift` broadcast to (runs, 12)."""
    wanted = [CHANNELS.index(name) for name in channels]
    rmse, mean, drift = (np.broadcast_to(value, (RUNS, 12))[:, wanted].ravel().astype(float) for value in (rmse, mean, drift))
    lost = np.repeat(np.isin(np.arange(RUNS), failed), len(channels))
    sd = np.sqrt(rmse**2 - mean**2)
    columns = {"rmse": rmse, "mean": mean, "sd": sd, "drift": drift, "drift_integral": mean * DURATION}
    return pd.DataFrame({
        **labels, "run": np.repeat(np.arange(RUNS), len(channels)), "channel": np.tile(channels, RUNS),
        **{name: np.where(lost, np.nan, value) for name, value in columns.items()},
        "failed": lost, "reason": np.where(lost, "lost", ""),
    })  # fmt: skip


def results_of(bootstrap=200, **tables) -> Results:
    settings = Settings("standard", 1, {"runs": RUNS, "bootstrap": bootstrap})
    named = {name.replace("_", "-"): table for name, table in tables.items()}
    return Results(settings, pd.DataFrame(), lambda name: Output(named[name]))


def variant(rmse, interval=None, **more) -> pd.DataFrame:
    table = long_table(rmse, formulation="F1", against="truth", **more)
    averaged = long_table(rmse if interval is None else interval, formulation="F1", against="interval", channels=CHANNELS[3:9], **more)
    return pd.concat([table, averaged], ignore_index=True)


RUN_RMSE = 1.0 + 0.1 * np.arange(RUNS)[:, None] + np.arange(12)


def test_scores_are_runs_by_channels_in_whatever_order_the_rows_stand():
    shuffled = variant(RUN_RMSE).sample(frac=1.0, random_state=1)
    shuffled = shuffled.sort_values("channel", key=lambda names: names.map(CHANNELS.index), kind="stable")
    assert np.array_equal(scores(results_of(a=shuffled), "a", "F1").rmse, RUN_RMSE)


def test_a_channel_that_is_missing_in_a_run_is_refused():
    with pytest.raises(ValueError, match="not one row for each run and channel"):
        scores(results_of(a=variant(RUN_RMSE).drop(index=5)), "a", "F1")


def test_channels_without_an_interval_average_are_those_against_the_truth():
    found = scores(results_of(a=variant(1.0, interval=2.0)), "a", "F1", "interval")
    assert found.rmse[0].tolist() == [1.0] * 3 + [2.0] * 6 + [1.0] * 3


def test_levels_are_root_mean_squares_of_rmse_and_means_of_absolute_drifts():
    results = results_of(a=variant(RUN_RMSE, drift=(-1.0) ** np.arange(RUNS)[:, None] * RUN_RMSE))
    found = level(results, "a", "F1", "truth", "rmse", "v_u")
    assert found.estimate == pytest.approx(np.sqrt(np.mean(RUN_RMSE[:, 2] ** 2)))
    assert found.low < found.estimate < found.high and (found.n, found.failed) == (RUNS, 0)
    assert found.median == pytest.approx(np.median(RUN_RMSE[:, 2]))
    assert level(results, "a", "F1", "truth", "drift", "v_u").estimate == pytest.approx(np.mean(RUN_RMSE[:, 2]))


@pytest.mark.parametrize("metric", METRICS)
def test_a_filter_with_half_the_error_in_every_run_improves_by_a_half_without_doubt(metric):
    tables = {"a": variant(0.5 * RUN_RMSE, mean=0.25, drift=0.5), "b": variant(RUN_RMSE, mean=0.5, drift=1.0)}
    found = improvement(results_of(**tables), "a", "b", "F1", "truth", metric, "yaw")
    assert (found.estimate, found.low, found.high) == pytest.approx((0.5, 0.5, 0.5))
    assert 0.0 < found.p <= 2 / SWAPS  # fewer than fifty runs: by exchanges
    assert (found.n, found.survivors) == (RUNS, RUNS)


def test_swapping_the_filters_turns_the_interval_round():
    noisy = np.exp(0.3 * np.random.default_rng(3).standard_normal((RUNS, 12)))
    results = results_of(a=variant(noisy), b=variant(np.ones(12)))
    forward, back = (improvement(results, *pair, "F1", "truth", "rmse", "v_e") for pair in (("a", "b"), ("b", "a")))
    assert 1 - forward.estimate == pytest.approx(1 / (1 - back.estimate))
    assert forward.low < forward.estimate < forward.high


def test_a_failed_run_is_a_loss_of_its_filter():
    noisy = np.exp(0.3 * np.random.default_rng(3).standard_normal((RUNS, 12)))
    noisy[3] = 1.0
    sound = improvement(results_of(a=variant(noisy), b=variant(1.0)), "a", "b", "F1", "truth", "rmse", "v_e")
    for failing, sign in (("a", -1), ("b", 1)):
        tables = {name: variant(values, failed=[3] if name == failing else ()) for name, values in (("a", noisy), ("b", 1.0))}
        found = improvement(results_of(**tables), "a", "b", "F1", "truth", "rmse", "v_e")
        assert sign * (found.estimate - sound.estimate) > 0
        assert (found.numerator_failed, found.denominator_failed, found.survivors) == (int(sign < 0), int(sign > 0), RUNS - 1)


def test_a_variant_whose_runs_all_fail_has_no_numbers_and_no_finite_interval():
    results = results_of(a=variant(1.0, failed=range(RUNS)), b=variant(1.0))
    found = improvement(results, "a", "b", "F1", "truth", "rmse", "v_e")
    assert np.isnan(found.estimate) and (found.low, found.high, found.p) == (-np.inf, np.inf, 1.0)
    assert (found.n, found.numerator_failed, found.survivors) == (RUNS, RUNS, 0)
    lost = level(results, "a", "F1", "truth", "rmse", "v_e")
    assert np.isnan(lost.estimate) and lost.median == np.inf and lost.failed == RUNS


def test_adjusted_p_values_are_holms_of_the_twelve_channels():
    results = results_of(a=variant(np.exp(0.1 * np.random.default_rng(5).standard_normal((RUNS, 12)))), b=variant(1.0))
    found = improvements(results, "a", "b", "F1", "truth", "rmse")
    assert np.array_equal(adjusted(found), holm(found.p)) and found.p.shape == (12,)


def sweep() -> pd.DataFrame:
    frames = [
        long_table(value * RUN_RMSE, mean=0.1 * value, rate=rate, noise="equal-psd", filter=name)
        for rate in (0.0, 0.02)
        for name, value in (("a", 0.5 + rate), ("b", 1.0))
    ]
    return pd.concat(frames, ignore_index=True).drop(columns=["sd", "drift_integral"])


def test_a_sweeps_rows_are_found_by_their_labels():
    results = results_of(outliers=sweep())
    where = {"noise": "equal-psd", "rate": 0.02}
    assert sweep_improvement(results, "outliers", where, "a", "b", "rmse", "a_e").estimate == pytest.approx(0.48)
    assert sweep_level(results, "outliers", where, "b", "mean", "a_e").estimate == pytest.approx(0.1)
    found = sweep_scores(results, "outliers", where, "a")
    assert found.rmse**2 == pytest.approx(found.mean**2 + found.sd**2)
    assert found.drift_integral == pytest.approx(0.052 * DURATION)
    with pytest.raises(LookupError, match="no row"):
        sweep_scores(results, "outliers", {"noise": "equal-psd"}, "a")


def test_filters_of_a_study_without_a_filter_column_are_named_by_their_labels():
    frames = [long_table(value, formulation="F0", rate=0.0, method="mk-norm", scale=scale) for value, scale in ((0.5, np.inf), (1.0, 0.1))]
    results = results_of(scale=pd.concat(frames))
    sides = ({"method": "mk-norm", "scale": scale} for scale in (np.inf, 0.1))
    found = sweep_improvement(results, "scale", {"formulation": "F0", "rate": 0.0}, *sides, "rmse", "v_e")
    assert found.estimate == pytest.approx(0.5)


def test_an_interval_does_not_depend_on_what_was_asked_before_or_on_the_order_of_the_labels():
    noisy = np.exp(0.3 * np.random.default_rng(3).standard_normal((RUNS, 12)))
    first, second = (results_of(a=variant(noisy), b=variant(1.0)) for _ in range(2))
    improvement(first, "a", "b", "F1", "truth", "drift", "yaw")
    assert improvement(first, "a", "b", "F1", "truth", "rmse", "v_e") == improvement(second, "a", "b", "F1", "truth", "rmse", "v_e")
    first, second = results_of(outliers=sweep()), results_of(outliers=sweep())
    found = [
        sweep_improvement(results, "outliers", where, "a", "b", "rmse", "v_e")
        for results, where in ((first, {"noise": "equal-psd", "rate": 0.0}), (second, {"rate": 0.0, "noise": "equal-psd"}))
    ]
    assert found[0] == found[1]
