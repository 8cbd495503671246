"""The experiment on the laser-gyro recording: it finds gravity, the earth's rotation and its own heading."""

import numpy as np
import pytest
from scipy import stats

from robins.field import lasergyro, psins
from robins.publish import style


@pytest.fixture(scope="module")
def tables(recording_path):
    return lasergyro.tables(recording_path, np.random.default_rng(5))


@pytest.fixture(scope="module")
def alignment(tables):
    return tables["extra-alignment"].set_index("quantity")


def row(alignment, beginning, end="900 to 1650 s"):
    (name,) = [name for name in alignment.index if name.startswith(beginning) and name.endswith(end)]
    return alignment.loc[name]


def test_mean_specific_force_is_normal_gravity(alignment):
    found = row(alignment, "magnitude of the mean specific force", "whole record")
    assert found.ours == pytest.approx(9.79548, abs=5e-6)
    assert found.expected == pytest.approx(9.79553, abs=5e-6)
    assert abs(found.difference) < 1e-4  # 10 ug, the bias of a good accelerometer


def test_rate_of_the_quiet_part_is_the_earths(alignment):
    up, horizontal = row(alignment, "rate along up"), row(alignment, "horizontal rate")
    assert up.ours == pytest.approx(8.452, abs=0.002)
    assert up.expected == pytest.approx(8.464, abs=5e-4)
    assert up.ours == pytest.approx(up.expected, abs=0.05)
    assert horizontal.ours == pytest.approx(12.09, abs=0.005)
    assert horizontal.expected == pytest.approx(12.43, abs=0.005)


def test_a_negated_earth_rate_is_far_from_what_the_gyros_sense(alignment):
    up = row(alignment, "rate along up")
    assert not np.isclose(up.ours, -up.expected, atol=0.05)


def test_heading_of_the_quiet_part_is_that_of_the_header(alignment):
    found = row(alignment, "heading of forward")
    assert found.ours == pytest.approx(90.65, abs=0.01)
    assert found.expected == pytest.approx(90.6)


def test_every_row_of_the_alignment_says_that_there_is_one_recording(alignment):
    assert alignment.note.str.startswith("one recording").all()
    np.testing.assert_allclose(alignment.difference, alignment.ours - alignment.expected)


def test_excess_kurtosis_of_the_gyros_is_the_known_one(tables):
    table = tables["extra-diagnostics"].query("series == 'gyro (deg/h)' and test == 'excess kurtosis'")
    assert tuple(table.channel) == lasergyro.CHANNELS
    np.testing.assert_allclose(table.statistic, [27, 197, 19], atol=0.5)
    assert (table.ci_low.astype(float) > 10).all()  # heavy tails beyond doubt


def test_allan_deviation_at_100_s_is_the_known_one_for_disjoint_averages_only(tables):
    table = tables["extra-allan"]
    at_100 = table[np.isclose(table.tau, 100)].set_index(["estimator", "channel"]).deviation
    np.testing.assert_allclose(at_100["disjoint"][list(lasergyro.CHANNELS)], [2.8, 3.9, 0.37], rtol=0.02)
    assert (at_100["overlapping"] < 0.5 * at_100["disjoint"]).all()


def test_allan_deviation_is_that_of_plain_averages(tables, recording_path):
    """Independent: block means and their differences, straight from the counts."""
    quiet = psins.read(recording_path).between(*lasergyro.QUIET)
    degrees_per_hour = np.degrees(quiet.rate_b) * 3600
    means = degrees_per_hour[:70_000].reshape(7, 10_000, 3).mean(axis=1)
    expected = np.sqrt(0.5 * np.mean(np.diff(means, axis=0) ** 2, axis=0))
    table = tables["extra-allan"]
    np.testing.assert_allclose(table[table.estimator == "disjoint"].deviation, expected, rtol=1e-9)


def test_tables_have_unique_keys_and_no_missing_cell(tables):
    keys = {
        "extra-alignment": ["quantity"],
        "extra-diagnostics": ["series", "channel", "test"],
        "extra-allan": ["estimator", "channel", "tau"],
    }
    assert set(tables) == set(keys)
    for name, table in tables.items():
        assert not table.isna().any().any(), name
        assert not table.duplicated(keys[name]).any(), name
    allan = tables["extra-allan"]
    assert ((allan.low < allan.deviation) & (allan.deviation < allan.high)).all()


def test_figures_can_be_saved_and_label_their_axes(recording_path, tmp_path):
    drawn = lasergyro.figures(recording_path)
    assert set(drawn) == {"extra-residuals", "extra-allan"}
    (allan,) = drawn["extra-allan"].axes
    assert (allan.get_xlabel(), allan.get_ylabel()) == ("averaging time (s)", "Allan deviation (deg/h)")
    assert len(drawn["extra-residuals"].axes) == 9
    for name, figure in drawn.items():
        style.save(figure, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000


def synthetic(n=20_000, heading=0.5, latitude=0.6):
    """A recording of white noise about the rate and force of a level unit of known heading."""
    rng = np.random.default_rng(2)
    spin = 7.292115e-5
    rate = spin * np.array([-np.sin(heading) * np.cos(latitude), np.cos(heading) * np.cos(latitude), np.sin(latitude)])
    noise = rng.standard_normal((2, n, 3))
    return psins.Recording(
        time=900 + 0.01 * np.arange(1, n + 1),
        angle_increments=0.01 * (rate + 1e-6 * noise[0]),
        velocity_increments=0.01 * (np.array([0, 0, 9.7965]) + 1e-4 * noise[1]),
        interval=0.01,
        latitude=latitude,
        longitude=0.0,
        height=0.0,
        yaw=-heading,
    )


def test_a_made_recording_of_known_heading_is_aligned_to_it():
    recording = synthetic()
    table = lasergyro.alignment_table(recording, recording).set_index("quantity")
    spread = np.degrees(1e-6 / np.sqrt(20_000) / (7.292115e-5 * np.cos(0.6)))
    assert abs(row(table, "heading of forward").difference) < 4 * spread
    assert abs(row(table, "rate along up").difference) < 4 * np.degrees(1e-6) * 3600 / np.sqrt(20_000)


def test_a_made_recording_of_white_noise_is_diagnosed_as_that():
    table = lasergyro.diagnostics_table(synthetic(), np.random.default_rng(0)).set_index(["series", "channel", "test"])
    p_values = table.xs("lilliefors", level="test").p_value
    assert stats.combine_pvalues(p_values).pvalue > 1e-4
    assert (table.xs("ljung-box", level="test").p_value > 1e-5).all()
