"""Scenarios and variants: the tables and arrays that they promise, paired, whatever else runs."""

import numpy as np
import pytest

from robins.papers.ghouneem2024 import ensemble, sensors
from robins.papers.ghouneem2024.ensemble import FIRST_RUN, designs, variant
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.gps import ENVIRONMENTS
from robins.papers.ghouneem2024.runs import COLUMNS, MEASURES, headline, score_held
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES, trajectory
from robins.papers.ghouneem2024.tune import frozen_setting
from robins.papers.ghouneem2024.variants import VARIANTS


def is_tuned(name):
    return VARIANTS[name].composition.get("cell", "none") != "none"


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIANTS)
def test_a_variant_has_a_row_for_each_trajectory_setting_and_run(results, settings, name):
    table = results.table(name)
    assert list(table.columns) == ["trajectory", "frozen", *COLUMNS]
    sources = TRAJECTORIES if is_tuned(name) else ("none",)
    expected = {(place, source, FIRST_RUN + i) for place in TRAJECTORIES for source in sources for i in range(settings().sizes["runs"])}
    assert set(table[["trajectory", "frozen", "run"]].itertuples(index=False, name=None)) == expected and len(table) == len(expected)
    kept = table[~table["failed"]]
    assert (kept["reason"] == "").all() and (kept[list(MEASURES[:-1])] > 0).all().all()
    assert (table["rejected"] <= table["fixes"]).all() and (table["longest_rejection"] <= table["rejected"]).all()
    assert VARIANTS[name].composition.get("gate") or name.endswith("gate") or (table["rejected"] == 0).all()


@pytest.mark.slow
def test_all_variants_have_the_same_fixes_in_a_run(results):
    counts = [results.table(name).groupby(["trajectory", "run"])["fixes"].first() for name in VARIANTS]
    assert all(count.equals(counts[0]) for count in counts)


def test_a_run_scores_the_same_in_a_larger_ensemble(settings, results):
    larger = variant(settings(runs=4), composition=VARIANTS["ekf-pm"].composition).table
    small = results.table("ekf-pm")
    assert larger[larger["run"] < FIRST_RUN + 3].reset_index(drop=True).equals(small.reset_index(drop=True))


def test_another_seed_has_other_noise(settings):
    small = settings(runs=1)
    tables = [variant(type(small)(small.ensemble, seed, small.sizes, small.options), composition={"held": True}).table for seed in (1, 2)]
    assert (tables[0]["horizontal"] != tables[1]["horizontal"]).all()


def test_settings_that_are_frozen_on_either_trajectory_run_on_both(results, settings):
    for name in ("ukf-st-gate", "ekf-pi-gate"):
        composition = VARIANTS[name].composition
        made = designs(composition, settings(), results)
        assert set(made) == {(place,) for place in TRAJECTORIES}
        for (place,), each in made.items():
            setting = frozen_setting(results, composition["filter"], place, composition["cell"])
            assert each.multiple == setting.multiple and each.gate == "integrity"
            assert each.filter == composition["filter"] in FILTERS


def test_fixes_that_are_held_are_a_variant_without_a_filter(results, prepared):
    table = results.table("gps-only")
    row = table[(table["trajectory"] == "t1") & (table["run"] == 101)].iloc[0]
    expected = score_held(prepared("t1", 101))
    assert row["horizontal"] == expected["horizontal"] and np.isnan(row["nis"]) and row["rejected"] == 0


def test_the_mechanisation_alone_drifts_and_every_filter_with_fixes_does_better(results):
    alone = results.table("riss-only")["horizontal"].to_numpy()
    for name in ("ekf-f", "ukf"):
        assert (results.table(name)["horizontal"].to_numpy() < alone).all()


@pytest.mark.parametrize("place", TRAJECTORIES)
def test_a_scenario_is_the_drive_with_the_noise_of_its_first_reporting_run(results, prepared, place):
    output, driven, samples = results.output(place), trajectory(place), prepared(place, FIRST_RUN)
    for name in ("time", "position", "velocity", "azimuth", "pitch", "roll", "speed"):
        np.testing.assert_array_equal(output.arrays[name], getattr(driven, name))
    noise = samples.sensed.rate - samples.sensed.bias - driven.rate
    np.testing.assert_allclose(output.arrays["residual.gyroscope"], noise[1:], atol=1e-15)
    standing = noise[: 60 * 20]
    assert standing.std() == pytest.approx(np.hypot(sensors.GYROSCOPE_WHITE, sensors.GYROSCOPE_DIGIT / np.sqrt(12)), rel=0.1)
    clear = output.arrays["fix_cause"] == 0
    np.testing.assert_array_equal(output.arrays["residual.gps_position"], output.arrays["fix_error"][clear, :3])
    np.testing.assert_array_equal(output.arrays["residual.gps_velocity"], output.arrays["fix_error"][clear, 3:])
    assert output.arrays["rate_hz.gyroscope"] == 20.0 and output.arrays["rate_hz.gps_position"] == 1.0


@pytest.mark.parametrize("place", TRAJECTORIES)
def test_the_table_of_a_scenario_has_every_parameter_with_unit_and_source(results, place):
    table = results.table(place)
    assert list(table.columns) == ["parameter", "symbol", "value", "unit", "source"]
    assert table["parameter"].is_unique and not table.isna().any().any()
    assert set(table["source"]) <= {"ours", "paper", "assumed", "maker"}
    value = table.set_index("parameter")["value"]
    assert value["length of the road"] == pytest.approx(22.4e3 if place == "t1" else 9.9e3, rel=0.1)
    assert value["mean speed"] == pytest.approx(12.5 if place == "t1" else 6.6, rel=0.1)
    assert value["misleading fixes a run, mean"] == ENVIRONMENTS[place].misleading
    assert {row[2] for row in ensemble.SENSOR_ROWS} <= set(table["value"])


def test_the_headline_has_the_frozen_environment():
    for place in TRAJECTORIES:
        case = headline(1, place)
        assert (case.environment, case.hold, case.azimuth_error, case.outage) == (ENVIRONMENTS[place], False, None, None)
