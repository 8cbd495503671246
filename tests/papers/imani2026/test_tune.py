"""Tuning: one budget for all, an extension towards the optimum, runs of its own, and nothing chosen that fails."""

import numpy as np
import pandas as pd
import pytest

from robins.papers.imani2026 import sensors, tune
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.ensemble import frozen, headline, scores
from robins.papers.imani2026.methods import FAMILIES, NORMAL_GATE, Setting, tuned
from robins.papers.imani2026.tune import (
    CONDITIONS,
    NOISE_ABOVE,
    NOISE_BELOW,
    NOISE_SCALES,
    budget,
    case_of,
    evaluate,
    objective,
    outward,
    search,
)
from robins.papers.protocol import Output, Results

COLUMNS = ["condition", "noise_scale", "parameter", "value", "stage", "objective", "failed", "chosen"]


@pytest.fixture(scope="module")
def slow(settings):
    """Settings of a drive with one sample a second: 330 updates a run."""
    return settings(rate_hz=1)


@pytest.fixture(scope="module")
def tables(slow):
    """The tuning tables of every family."""
    return {family: tune.tune(slow, family).table for family in FAMILIES}


@pytest.fixture
def losses(monkeypatch):
    """``losses(function of noise_scale and value)`` takes the place of running filters; infinite where a run fails."""

    def take(loss):
        def found(family, settings, case, wanted):
            values = [float(loss(setting.noise_scale, setting.value)) for setting in wanted]
            return values, [int(not np.isfinite(value)) for value in values]

        monkeypatch.setattr(tune, "evaluate", found)

    return take


def chosen(table):
    (row,) = table[table["chosen"]].itertuples()
    return row


# Budget.


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_has_sixteen_settings_under_each_condition(tables, family):
    table = tables[family]
    assert list(table.columns) == COLUMNS
    for condition in CONDITIONS:
        part = table[table["condition"] == condition]
        assert len(part) == 16 and not part.duplicated(["noise_scale", "value"]).any()
        assert part["stage"].tolist() == ["grid"] * 9 + ["extension"] * 7
        assert part["chosen"].sum() == 1 and np.isfinite(chosen(part).objective)
        assert chosen(part).objective == part["objective"].min()
    assert set(table["parameter"]) == {FAMILIES[family].parameter}


def test_the_budget_is_the_same_for_all(tables):
    assert budget(tables) == {family: 16 for family in FAMILIES}


@pytest.mark.parametrize("family", FAMILIES)
def test_a_grid_is_extended_by_one_row_and_one_column(tables, family):
    knob = FAMILIES[family]
    for condition in CONDITIONS:
        part = tables[family][tables[family]["condition"] == condition]
        scales, values = set(part["noise_scale"]), set(part["value"])
        assert scales in ({*NOISE_SCALES, NOISE_BELOW}, {*NOISE_SCALES, NOISE_ABOVE})
        assert values in ({*knob.grid, knob.values[0]}, {*knob.grid, knob.values[-1]})


@pytest.mark.parametrize("best", [(0.001, 0.001), (0.001, 50.0), (1000.0, 0.001), (1000.0, 50.0)])
def test_the_extension_lies_on_the_side_of_an_optimum_at_the_edge(settings, losses, best):
    losses(lambda scale, value: abs(np.log(scale / best[0])) + abs(np.log(value / best[1])))
    table, knob = search("gate", settings(), "headline"), FAMILIES["gate"]
    low, small = best[0] < 1.0, best[1] < 1.0
    assert chosen(table)[1:3] == (NOISE_BELOW if low else NOISE_ABOVE, knob.values[0] if small else knob.values[-1])
    assert chosen(table).stage == "extension"


@pytest.mark.parametrize("better", [NOISE_BELOW, NOISE_ABOVE])
def test_with_an_optimum_in_the_middle_the_better_neighbour_decides(settings, losses, better):
    losses(lambda scale, value: abs(np.log10(scale) - 0.1 * np.sign(np.log(better))) + abs(value - NORMAL_GATE))
    table = search("gate", settings(), "headline")
    assert better in table["noise_scale"].tolist()
    assert chosen(table)[1:3] == (1.0, NORMAL_GATE) and chosen(table).stage == "grid"


def test_outward_is_below_or_above():
    assert outward((1.0, 2.0, 3.0), np.array([1.0, 2.0, 3.0]), 0.5, 4.0) == 0.5
    assert outward((1.0, 2.0, 3.0), np.array([3.0, 2.0, 1.0]), 0.5, 4.0) == 4.0
    assert outward((1.0, 2.0, 3.0), np.array([3.0, 1.0, 2.0]), 0.5, 4.0) == 4.0
    assert outward((1.0, 2.0, 3.0), np.array([2.0, 1.0, 3.0]), 0.5, 4.0) == 0.5


# Objective.


def test_the_objective_is_the_mean_log_of_the_ensemble_rmse():
    rng = np.random.default_rng(5)
    rmse = rng.uniform(0.1, 3.0, (4, 12))
    table = pd.DataFrame({"run": np.repeat(range(4), 12), "channel": list(CHANNELS) * 4, "rmse": rmse.ravel(), "failed": False})
    by_hand = sum(np.log(np.sqrt(sum(rmse[:, i] ** 2) / 4)) for i in range(12)) / 12
    assert objective(table) == pytest.approx(by_hand, rel=1e-12)
    table.loc[table["run"] == 2, ["rmse", "failed"]] = np.nan, True
    assert objective(table) == np.inf


def test_the_tabled_objective_is_that_of_the_filter_in_f1(slow, tables):
    for condition in CONDITIONS:
        row = chosen(tables["huber"][tables["huber"]["condition"] == condition])
        method = tuned("huber", slow.options, Setting(row.noise_scale, row.value))
        table = scores(case_of(slow, condition), range(1000, 1001), {"huber": method}, "F1")
        assert row.objective == pytest.approx(np.mean(np.log(table["rmse"])), rel=1e-9)


def test_a_setting_does_not_depend_on_those_beside_it(slow):
    case, wanted = headline(slow), [Setting(1.0, 3.0), Setting(10.0, 1.5), Setting(0.1, 6.0)]
    together, failed = evaluate("mk-li", slow, case, wanted)
    alone = [evaluate("mk-li", slow, case, [setting])[0][0] for setting in wanted]
    assert together == alone and failed == [0, 0, 0]


def test_conditions_differ_in_the_outliers_only(slow):
    plain, outliers = (case_of(slow, condition) for condition in CONDITIONS)
    assert plain == headline(slow)
    assert (outliers.sensors.outliers.rate, outliers.sensors.outliers.one_sided) == (0.02, False)
    assert vars(outliers.sensors) | {"outliers": plain.sensors.outliers} == vars(plain.sensors)


# Runs and failures.


def test_only_tuning_runs_are_read(settings, monkeypatch):
    """The names of all streams: runs 1000 to 1002, and no reference, which is not what settings are tuned against."""
    names, drawn = set(), sensors.stream

    def listen(seed, name):
        names.add(name)
        return drawn(seed, name)

    monkeypatch.setattr(sensors, "stream", listen)
    tune.tune(settings(rate_hz=1, tuning_runs=3), "ekf")
    assert {name.split("/")[2] for name in names} == {"1000", "1001", "1002"}
    assert {name.split("/")[1] for name in names} == {"drive-1hz"}
    assert "outliers" in {name.split("/")[3] for name in names}


def test_a_setting_under_which_a_run_fails_is_never_chosen(settings, losses):
    """The best loss is where runs fail."""
    losses(lambda scale, value: np.inf if scale <= 0.1 else scale)
    table = search("gate", settings(), "headline")
    assert chosen(table).noise_scale == 1.0 and chosen(table).failed == 0
    assert (table["failed"] > 0).sum() == 4 and np.isinf(table.loc[table["failed"] > 0, "objective"]).all()


def test_a_failing_run_is_counted_once_and_not_for_each_channel(slow, monkeypatch):
    monkeypatch.setattr("robins.papers.imani2026.scoring.BOUND", 1e-3)
    found, failed = evaluate("ekf", slow, headline(slow), [Setting(1.0, 1.0)])
    assert found == [np.inf] and failed == [1]


def test_where_every_setting_fails_there_is_nothing_to_choose(settings, losses):
    losses(lambda scale, value: np.inf)
    with pytest.raises(ArithmeticError, match="^huber, headline: a run fails under every setting$"):
        search("huber", settings(), "headline")


def test_the_chosen_setting_is_what_a_variant_reads(slow, tables):
    results = Results(slow, pd.DataFrame(), lambda job: Output(tables[job.removeprefix("tuning-")]))
    for condition in CONDITIONS:
        row = chosen(tables["mcc1"][tables["mcc1"]["condition"] == condition])
        assert frozen(results, "mcc1", condition) == Setting(row.noise_scale, row.value)
