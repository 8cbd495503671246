"""Tuning: one budget for every filter, runs of its own, the best of each cell, and nothing chosen that fails while another is left."""

import numpy as np
import pandas as pd
import pytest

from robins.papers.ghouneem2024 import ensemble, runs, studies, tune
from robins.papers.ghouneem2024.filters import FILTERS, datasheet
from robins.papers.ghouneem2024.runs import CHANNELS, controls, headline, prepare, score
from robins.papers.ghouneem2024.self_tuning import SCALES, Statistics, self_tuned
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import (
    CELLS,
    COLUMNS,
    FIRST_TUNING_RUN,
    MULTIPLES,
    SETTINGS,
    Learned,
    belongs,
    chosen,
    frozen,
    frozen_setting,
    job_name,
    learn,
    learned_from,
    log_error,
    tuned_design,
)
from robins.papers.protocol import Output, Results

SIZES = {"gate": len(MULTIPLES), "st": len(SCALES), "st-gate": len(SCALES) * len(MULTIPLES)}


# Budget.


def test_forty_two_settings_are_every_threshold_with_and_without_every_scale():
    assert len(SETTINGS) == 42 and MULTIPLES == (0.5, 1.0, 2.0, 4.0, 8.0, np.inf)
    for cell, size in SIZES.items():
        own = [setting for setting in SETTINGS if belongs(setting, cell)]
        assert len(own) == len(set(map(str, own))) == size
        assert all(np.isnan(setting.scale) == (cell == "gate") for setting in own)
        assert cell != "st" or all(np.isinf(setting.multiple) for setting in own)


def test_every_filter_and_trajectory_has_the_same_settings_in_its_cells(results):
    tables = [results.table(job_name(name)) for name in FILTERS]
    for table in tables:
        assert list(table.columns) == list(COLUMNS)
        assert len(table) == 2 * sum(SIZES.values())
        pd.testing.assert_frame_equal(
            table[["trajectory", "cell", "scale", "multiple"]], tables[0][["trajectory", "cell", "scale", "multiple"]]
        )
        picked = table[table["chosen"]].set_index(["trajectory", "cell"])["objective"]
        assert len(picked) == 2 * len(CELLS)
        for key, part in table.groupby(["trajectory", "cell"]):
            assert picked[key] == part["objective"].min()


def test_a_setting_is_worth_the_same_in_both_cells_that_hold_it(results):
    for name in FILTERS:
        table = results.table(job_name(name))
        without = table[np.isinf(table["multiple"])]
        both = without.pivot_table(index=["trajectory", "scale"], columns="cell", values="objective", dropna=False)
        np.testing.assert_array_equal(both["st"], both["st-gate"])


# Runs.


def test_tuning_reads_its_own_runs_only_and_no_result_is_reported_from_them(settings, monkeypatch):
    read = []

    def noted(case, number, *rest):
        read.append((case.place, number))
        return prepare(case, number, *rest)

    monkeypatch.setattr(tune, "prepare", noted)
    monkeypatch.setattr(tune, "SETTINGS", SETTINGS[:1] + SETTINGS[-1:])
    small = settings(tuning_runs=2)
    tune.tune(small, "ekf-pi")
    assert set(read) == {(place, FIRST_TUNING_RUN + i) for place in TRAJECTORIES for i in range(2)}
    full = settings(runs=200, side_runs=50, in_sample_runs=50, tuning_runs=8, calibration_runs=12)
    others = [ensemble.reporting_runs(full), ensemble.reporting_runs(full, "in_sample_runs"), studies.side_runs(full), range(12)]
    tuning = range(FIRST_TUNING_RUN, FIRST_TUNING_RUN + 8)
    assert all(set(tuning).isdisjoint(other) for other in others)
    assert set(others[0]).isdisjoint(others[2]) and set(others[3]).isdisjoint(others[0])


def test_the_statistics_are_those_of_the_mechanisation_and_of_the_same_filter_without_gate(prepared, fly):
    samples = prepared("t1", 1000)
    for name in ("ekf-pi", "ukf"):
        (mechanisation,), (filtered,) = learn(name, {"alpha": 0.1, "beta": 2.0, "kappa": 0.0}, [samples])
        for found, flown in ((mechanisation, fly("ekf-f", samples, updates=False)), (filtered, fly(name, samples))):
            np.testing.assert_allclose(found.mean_square, np.mean(flown.error**2, axis=0), rtol=1e-9)
            np.testing.assert_allclose(found.mean, np.mean(flown.error, axis=0), rtol=1e-9)


# Objective and choice.


def test_the_objective_is_the_mean_log_error_over_the_seven_channels():
    rng = np.random.default_rng(1)
    row = {"failed": False, **{channel: rng.uniform(0.1, 9.0) for channel in CHANNELS}}
    assert log_error(row | {"horizontal": 1e9}) == pytest.approx(np.log(np.prod([row[channel] for channel in CHANNELS])) / 7)
    assert log_error(row | {"failed": True}) == np.inf


@pytest.mark.parametrize("cell", CELLS)
def test_the_best_of_a_cell_is_its_own_and_a_failure_is_chosen_only_where_nothing_is_left(cell):
    own = [i for i, setting in enumerate(SETTINGS) if belongs(setting, cell)]
    objectives = np.linspace(0.0, 1.0, len(SETTINGS))
    assert chosen(objectives, cell) == own[0]
    failing = np.full(len(SETTINGS), np.inf)
    assert chosen(failing, cell) == own[0]
    failing[own[2]] = 5.0
    assert chosen(failing, cell) == own[2]
    failing[[i for i in range(len(SETTINGS)) if i not in own]] = -1.0
    assert chosen(failing, cell) == own[2]


def test_a_row_of_the_table_is_the_mean_over_the_tuning_runs(settings, results):
    table = results.table("tuning-ekf-f")
    row = table[(table["trajectory"] == "t2") & (table["cell"] == "st-gate") & (table["scale"] == 1e-4) & (table["multiple"] == 4.0)].iloc[
        0
    ]
    samples = prepare(headline(1, "t2"), FIRST_TUNING_RUN)
    made = tuned_design("ekf-f", settings().options, tune.Setting(1e-4, 4.0), learned_from(results, "ekf-f", "t2"))
    assert row["objective"] == pytest.approx(log_error(score(made, samples, controls(samples, made.tilt))), rel=1e-12)


# Frozen settings.


@pytest.fixture
def learned():
    rng = np.random.default_rng(3)
    return Learned("t2", *(Statistics(rng.normal(size=7), *rng.uniform(0.1, 2.0, (2, 7))) for _ in range(2)))


def test_a_tuned_design_has_the_variances_and_the_gate_of_its_setting(settings, learned):
    options = settings().options
    plain = tuned_design("ukf", options, tune.Setting(np.nan, 2.0), learned)
    assert (plain.gate, plain.multiple) == ("integrity", 2.0)
    np.testing.assert_array_equal(plain.variances.process, datasheet("ukf").process)
    tuned = tuned_design("ukf", options, tune.Setting(1e-4, np.inf), learned)
    expected = self_tuned("ukf", "st-ms", learned.mechanisation, learned.filtered, "t2", 1e-4)
    for one, other in zip(tuned.variances, expected, strict=True):
        np.testing.assert_array_equal(one, other)


def test_frozen_settings_and_statistics_are_those_of_one_trajectory(settings):
    rows = [(place, cell, 1e-2, 1.0, 1.0, 0, False) for place in TRAJECTORIES for cell in CELLS]
    rows += [("t1", "st-gate", 1e-4, 4.0, 0.5, 0, True), ("t2", "st-gate", 1e-8, np.inf, 0.7, 0, True)]
    arrays = {
        f"{place}.{source}.{field}": np.full((2, 7), value) + [[0.0], [2.0]]
        for place, value in (("t1", 1.0), ("t2", 5.0))
        for source in ("mechanisation", "filtered")
        for field in Statistics._fields
    }
    results = Results(settings(), pd.DataFrame(), lambda name: Output(pd.DataFrame(rows, columns=list(COLUMNS)), arrays))
    assert frozen_setting(results, "ukf", "t1", "st-gate") == (1e-4, 4.0)
    made = frozen(results, settings(), "ukf", "t2", "st-gate")
    assert made.multiple == np.inf and made.variances.process[0] == pytest.approx(6.0 * 1e-8)
    assert frozen(results, settings(), "ukf", "t1", "st-gate").variances.initial[0] == pytest.approx(2.0)


def test_a_run_that_is_reported_is_not_learned_from(settings, results):
    """Statistics of a tuning job have one row for each tuning run, and are not those of the reporting runs."""
    arrays = results.arrays("tuning-ukf")
    assert all(values.shape == (settings().sizes["tuning_runs"], 7) for values in arrays.values())
    samples = prepare(headline(1, "t1"), FIRST_TUNING_RUN)
    assert samples.run >= 1000 and runs.truth("t1").shape == (36001, 7)
    (mechanisation,), _ = learn("ukf", settings().options, [samples])
    np.testing.assert_array_equal(arrays["t1.mechanisation.mean_square"][0], mechanisation.mean_square)
