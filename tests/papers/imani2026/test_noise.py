"""Figure 6 and the table of the noise: what the diagnostics say of run 0, beside the laws that it was drawn from."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from robins.diagnostics.summary import diagnose
from robins.papers.imani2026 import noise, theory
from robins.papers.imani2026.options import OPTIONS
from robins.papers.imani2026.sensors import Sensors
from robins.papers.protocol import Output, Results, Settings
from robins.publish import style, tables
from robins.publish.tolerances import refuse_columns, refuse_tolerances

SETTINGS = Settings("smoke", 1, {"runs": 2, "sweep_runs": 2, "bootstrap": 20}, OPTIONS)


@pytest.fixture(scope="module")
def results() -> Results:
    """A drive of three channels a sensor, its diagnostics, and the facts of the theory job that belong here."""
    generator, sensors = np.random.default_rng(2), Sensors()
    residuals = {
        "accelerometer": sensors.accelerometer_noise * sensors.accelerometer_law.sample(generator, (3300, 3)),
        "gyroscope": sensors.gyroscope_noise * sensors.gyroscope_law.sample(generator, (3300, 3)),
    }
    tested = pd.concat([diagnose(name, values, 10.0, generator=generator) for name, values in residuals.items()], ignore_index=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(theory, "RECORDS", 5)
        patch.setattr(theory, "LONG_RECORDS", 2)
        measured = SimpleNamespace(noise=generator.standard_normal((2, 300, 6)))
        patch.setattr(theory, "batches", lambda case, runs: [(runs, measured)])
        facts = [*theory.moment_facts(SETTINGS), *theory.normality_facts(SETTINGS), *theory.gain_facts(SETTINGS)]
    outputs = {
        "drive": Output(pd.DataFrame(), {f"residual.{name}": values for name, values in residuals.items()}),
        "diagnose/drive": Output(tested),
        "theory": Output(pd.DataFrame(facts, columns=list(theory.Fact._fields))),
    }
    return Results(SETTINGS, pd.DataFrame(), outputs.__getitem__)


def test_the_table_keeps_its_promises_and_survives_the_disk(results, tmp_path):
    table = noise.DIAGNOSTICS_TABLE
    tables.write(table.build(results), table, tmp_path / "noise.csv", 2)
    back = tables.read(tmp_path / "noise.csv", table)
    assert refuse_columns(table) == [] and refuse_tolerances(table, back) == []


def test_every_axis_of_both_sensors_is_tested_and_moments_and_rejections_stand_below(results):
    frame = noise.noise_table(results)
    assert set(frame.loc[frame["series"] == "gyroscope", "channel"]) == set("xyz")
    ensemble = frame[frame["series"] == "ensemble"]
    assert sum("sample " in test for test in ensemble["test"]) == 4  # two moments of two lengths of record
    assert sum("rejected" in test for test in ensemble["test"]) == 6  # two tests of three kinds of noise
    assert not ensemble["test"].str.contains("gain").any()


def test_normality_of_both_sensors_is_rejected_as_it_was_made_to_be(results):
    frame = noise.noise_table(results)
    tested = frame[frame["test"].isin(["shapiro-wilk", "lilliefors"])]
    assert len(tested) == 12 and (tested["p_value"].astype(float) <= 1e-3).all()


@pytest.mark.parametrize("sensor", noise.SENSORS)
def test_the_true_density_has_the_sensors_deviation_in_the_figures_unit(sensor):
    factor = noise.SENSORS[sensor][0]
    sd = factor * {"accelerometer": 0.05, "gyroscope": 0.002}[sensor]
    x = np.linspace(-40 * sd, 60 * sd, 400_001)
    density = noise.true_law(SETTINGS, sensor, factor).pdf(x)
    step = x[1] - x[0]
    assert np.sum(density) * step == pytest.approx(1.0, abs=1e-6)
    assert np.sqrt(np.sum(x**2 * density) * step) == pytest.approx(sd, rel=1e-3)


def test_each_panel_shows_the_tests_and_the_qq_plots_a_red_line(results):
    with style.use():
        figure = noise.DIAGNOSTICS_FIGURE.draw(results)
    assert [ax.get_title(loc="left")[:3] for ax in figure.axes] == ["(a)", "(b)", "(c)", "(d)"]
    for ax in figure.axes:
        (words,) = [text.get_text() for text in ax.texts]
        assert [line.split()[0] for line in words.splitlines()] == ["skewness", "excess", "SW", "KS"]
    for ax in figure.axes[1::2]:
        (line,) = [line for line in ax.lines if line.get_color() == "red"]
        x, y = line.get_data()
        samples = np.concatenate([line.get_ydata() for line in ax.lines if line.get_marker() == "."])
        assert np.polyfit(x, y, 1)[0] > 0 and y.max() < samples.max()  # a straight line; the tail is above it


def test_the_panels_print_what_the_diagnostics_found(results):
    tested = results.table("diagnose/drive")
    row = tested[(tested["series"] == "gyroscope") & (tested["channel"] == "0") & (tested["test"] == "skewness")].iloc[0]
    assert noise.printed_tests(tested, "gyroscope").startswith(f"skewness {row['statistic']:.2f}\n")


def test_a_p_value_that_the_tests_can_tell_is_printed():
    tested = diagnose("gyroscope", np.random.default_rng(0).standard_normal(300), 10.0, generator=np.random.default_rng(1))
    assert "SW 0.9" in noise.printed_tests(tested, "gyroscope") and ", p = 0." in noise.printed_tests(tested, "gyroscope")
