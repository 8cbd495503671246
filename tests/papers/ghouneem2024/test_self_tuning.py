"""Self-tuning: averages as (12) and (13) have them, the unit in which a printed mean acts, and what has no reference."""

import numpy as np
import pytest

from robins.foundation.earth import meridian_radius, transverse_radius
from robins.navigation.riss import AZIMUTH, EAST, GYRO_BIAS, HEIGHT, NORTH, ODOMETER, V_UP
from robins.papers.ghouneem2024.filters import FILTERS, datasheet
from robins.papers.ghouneem2024.runs import truth
from robins.papers.ghouneem2024.self_tuning import LEVELS, SCALES, Statistics, pooled, printed_variances, radii, self_tuned, statistics
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES, trajectory


def wrong_by(error, place="t1"):
    """An estimate (N+1, 9) with this error (N+1, 7)."""
    return np.column_stack([truth(place) + error, np.zeros((len(error), 2))])


@pytest.fixture
def errors():
    """Errors that drift and change their sign, but for the azimuth's."""
    rng = np.random.default_rng(2)
    return 0.01 * np.cumsum(rng.normal(size=(len(truth("t1")), 7)), axis=0)


@pytest.fixture
def learned():
    """Statistics of a mechanisation and of a filter, every number another."""
    rng = np.random.default_rng(5)
    return [Statistics(rng.normal(size=7), *rng.uniform(0.1, 2.0, (2, 7))) for _ in range(2)]


# Averages.


def test_averages_are_over_the_epochs_and_increments_over_a_second(errors):
    found = statistics(wrong_by(errors), "t1")
    for i in range(7):
        column = errors[:, i]
        assert found.mean[i] == pytest.approx(sum(column) / len(column), rel=1e-6)
        assert found.mean_square[i] == pytest.approx(sum(column**2) / len(column), rel=1e-6)
        steps = [column[k + 20] - column[k] for k in range(len(column) - 20)]
        assert found.increment[i] == pytest.approx(np.mean(np.square(steps)), rel=1e-6)


def test_a_turn_too_much_is_no_error_of_the_azimuth():
    rng, error = np.random.default_rng(4), np.zeros((len(truth("t1")), 7))
    error[:, AZIMUTH] = 0.02 + 2 * np.pi * rng.integers(-3, 4, len(error))
    found = statistics(wrong_by(error), "t1")
    assert found.mean[AZIMUTH] == pytest.approx(0.02, rel=1e-9)
    assert found.mean_square[AZIMUTH] == pytest.approx(4e-4, rel=1e-9)
    assert found.increment[AZIMUTH] == pytest.approx(0.0, abs=1e-18)


def test_the_signed_mean_of_an_error_is_no_variance(results):
    """It may be negative, or cancel where the error is large; half of the entries of the tuning runs are negative, more or less."""
    error = np.zeros((len(truth("t1")), 7))
    error[:, NORTH] = 100.0 * np.where(np.arange(len(error)) % 2, 1, -1)
    error[:, EAST] = 100.0
    found = statistics(wrong_by(error), "t1")
    assert abs(found.mean[NORTH]) < 0.01 and found.mean_square[NORTH] == pytest.approx(1e4)
    arrays = results.arrays("tuning-ukf")
    entries = np.concatenate([-arrays[f"{place}.{source}.mean"] for place in TRAJECTORIES for source in ("mechanisation", "filtered")])
    assert (entries < 0).any() and (entries > 0).any()


def test_runs_are_pooled_by_their_mean():
    each = [Statistics(np.full(7, a), np.full(7, b), np.full(7, c)) for a, b, c in ((1.0, 2.0, 3.0), (-3.0, 4.0, 9.0))]
    for found, expected in zip(pooled(each), (-1.0, 3.0, 6.0), strict=True):
        np.testing.assert_allclose(found, expected)


# Units of the printed means.


@pytest.mark.parametrize("place", TRAJECTORIES)
def test_a_printed_mean_of_latitude_acts_as_the_radius_times_the_root_of_radians(place):
    latitude = trajectory(place).latitude
    across = (transverse_radius(latitude) + 100.0) * np.cos(latitude)
    mean = np.array([-100.0, 50.0, -3.0, 0.1, -0.2, 0.3, -0.01])
    deviation = np.sqrt(printed_variances(mean, place))
    assert deviation[NORTH] == pytest.approx((meridian_radius(latitude) + 100.0) * np.sqrt(100.0 / (meridian_radius(latitude) + 100.0)))
    assert deviation[EAST] == pytest.approx(across * np.sqrt(50.0 / across))
    np.testing.assert_allclose(deviation[HEIGHT:] ** 2, np.abs(mean[HEIGHT:]))
    np.testing.assert_allclose(radii(place), [meridian_radius(latitude) + 100.0, across], rtol=1e-12)


def test_a_mean_of_a_hundred_metres_of_latitude_is_a_deviation_of_25_km():
    mean = np.zeros(7)
    mean[NORTH] = 100.0
    assert np.sqrt(printed_variances(mean, "t1"))[NORTH] == pytest.approx(25e3, rel=0.02)
    assert 100.0 / radii("t1")[0] == pytest.approx(1.57e-5, rel=0.005)


# Variances.


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("level", LEVELS)
def test_states_without_a_reference_keep_the_variance_of_the_data_sheet(name, level, learned):
    found, sheet = self_tuned(name, level, *learned, "t1", scale=1e-4), datasheet(name)
    for got, kept in zip(found, sheet, strict=True):
        np.testing.assert_array_equal(got[[GYRO_BIAS, ODOMETER]], kept[[GYRO_BIAS, ODOMETER]])
        assert (got[:GYRO_BIAS] != kept[:GYRO_BIAS]).all()


def test_q_is_of_the_mechanisation_and_p0_of_the_filter(learned):
    mechanisation, filtered = learned
    found = self_tuned("ukf", "st-ms", mechanisation, filtered, "t1")
    np.testing.assert_array_equal(found.process[:7], mechanisation.mean_square)
    np.testing.assert_array_equal(found.initial[:7], filtered.mean_square)
    found = self_tuned("ukf", "st-inc", mechanisation, filtered, "t1")
    np.testing.assert_allclose(found.process[:7], mechanisation.increment / 20)
    np.testing.assert_array_equal(found.initial[:7], filtered.mean_square)
    found = self_tuned("ukf", "st-printed", mechanisation, filtered, "t2")
    np.testing.assert_array_equal(found.process[:7], printed_variances(mechanisation.mean, "t2"))
    np.testing.assert_array_equal(found.initial[:7], printed_variances(filtered.mean, "t2"))
    assert (found.process[:7] > 0).all()


@pytest.mark.parametrize("level", LEVELS)
def test_the_scale_multiplies_q_and_not_p0(level, learned):
    whole, scaled = (self_tuned("ekf-pi", level, *learned, "t1", scale) for scale in (1.0, 1e-6))
    np.testing.assert_allclose(scaled.process[:7], 1e-6 * whole.process[:7], rtol=1e-14)
    np.testing.assert_array_equal(scaled.initial, whole.initial)


def test_the_scales_are_powers_of_a_hundredth_from_one_on():
    np.testing.assert_allclose(SCALES, 10.0 ** -np.arange(0, 12, 2))


def test_what_is_learned_is_not_written_to(learned):
    before = [values.copy() for each in learned for values in each]
    for level in LEVELS:
        self_tuned("ukf", level, *learned, "t1", 0.01)
    for values, kept in zip((values for each in learned for values in each), before, strict=True):
        np.testing.assert_array_equal(values, kept)
    assert datasheet("ukf").process[V_UP] == 0.0


@pytest.mark.parametrize("scale", [0.0, -1.0, np.nan])
def test_a_scale_that_is_not_positive_is_refused(scale, learned):
    with pytest.raises(ValueError, match="scale: found"):
        self_tuned("ukf", "st-ms", *learned, "t1", scale)


def test_a_level_that_there_is_not_is_refused(learned):
    with pytest.raises(ValueError, match="level: found 'ds'"):
        self_tuned("ukf", "ds", *learned, "t1")
