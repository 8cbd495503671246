"""The table of the noise: what the diagnostics say of the first reporting run's residuals on both trajectories."""

import numpy as np
import pandas as pd
import pytest

from robins.diagnostics.summary import diagnose
from robins.papers.ghouneem2024 import ensemble, noise, sensors
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.protocol import Output, Results, Settings
from robins.publish import tables
from robins.publish.tolerances import refuse_columns, refuse_tolerances

SETTINGS = Settings("smoke", 1, {"runs": 2, "bootstrap": 20}, OPTIONS)
RESIDUAL = "residual."


@pytest.fixture(scope="module")
def scenarios() -> dict[str, Output]:
    return {place: ensemble.scenario(SETTINGS, place) for place in TRAJECTORIES}


@pytest.fixture(scope="module")
def frame(scenarios) -> pd.DataFrame:
    """The table from the scenarios' residuals, diagnosed as the workflow does."""
    outputs = {}
    for place, output in scenarios.items():
        names = sorted(key.removeprefix(RESIDUAL) for key in output.arrays if key.startswith(RESIDUAL))
        tested = [
            diagnose(name, output.arrays[RESIDUAL + name], float(output.arrays[f"rate_hz.{name}"]), generator=np.random.default_rng(1))
            for name in names
        ]
        outputs[f"diagnose/{place}"] = Output(pd.concat(tested, ignore_index=True))
    assert set(noise.DIAGNOSTICS_TABLE.needs) == set(outputs)
    return noise.DIAGNOSTICS_TABLE.build(Results(SETTINGS, pd.DataFrame(), outputs.__getitem__))


def test_the_table_keeps_its_promises_and_survives_the_disk(frame, tmp_path):
    table = noise.DIAGNOSTICS_TABLE
    tables.write(frame, table, tmp_path / "noise.csv")
    back = tables.read(tmp_path / "noise.csv", table)
    assert refuse_columns(table) == [] and refuse_tolerances(table, back) == []


def test_every_channel_of_every_series_is_tested_on_both_trajectories(frame):
    for place in TRAJECTORIES:
        own = frame[frame["trajectory"] == place]
        found = {series: set(rows["channel"]) for series, rows in own.groupby("series")}
        assert found == {"gyroscope": {"z"}, "gps_position": {"north", "east", "up"}, "gps_velocity": {"north", "east", "up"}}


def test_the_residual_of_the_gyroscope_is_white_noise_and_digits(scenarios):
    for place, output in scenarios.items():
        expected = np.hypot(sensors.GYROSCOPE_WHITE, sensors.GYROSCOPE_DIGIT / np.sqrt(12.0))
        assert np.std(output.arrays["residual.gyroscope"]) == pytest.approx(expected, rel=0.2), place


def test_errors_of_clean_fixes_are_correlated_as_they_were_made(frame):
    lags = frame[(frame["series"] == "gps_position") & (frame["test"].str.contains("autocorrelation"))]
    assert len(lags) == 6 and (lags["statistic"].astype(float) > 0.5).all()


def test_a_tail_probability_that_round_off_decides_is_shown_as_zero(frame):
    shown = pd.to_numeric(frame["p_value"], errors="coerce").dropna()
    assert len(shown) and ((shown == 0.0) | (shown > noise.SMALLEST)).all()
