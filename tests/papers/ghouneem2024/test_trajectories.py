"""Trajectories: the drives come near to what the design asks for, and the truth is consistent with itself and with its frames."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robins.foundation import earth
from robins.foundation.errors import InputError
from robins.navigation import riss
from robins.papers.ghouneem2024 import trajectories
from robins.papers.ghouneem2024.trajectories import (
    DEGREE,
    GRAVITY,
    PLANS,
    RATE_HZ,
    START_HEIGHT,
    TRAJECTORIES,
    Segment,
    append_stretch,
    draw_grade,
    draw_segments,
    drive,
    gauss_markov,
    raised_cosine,
    trajectory,
)

STREAM = np.random.default_rng


@pytest.fixture(scope="module", params=TRAJECTORIES)
def driven(request):
    return trajectory(request.param)


def stretches(flags):
    """First and last (excluded) index of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return edges.reshape(-1, 2)


@pytest.mark.parametrize(
    "name, latitude, azimuth, seconds, distance, mean_speed", [("t1", 44.23, 40, 1800, 22_400, 12.5), ("t2", 51.05, 350, 1500, 9_900, 6.6)]
)
def test_a_drive_has_the_length_the_distance_and_the_mean_speed_of_the_design(name, latitude, azimuth, seconds, distance, mean_speed):
    driven = trajectory(name)
    np.testing.assert_array_equal(driven.time, np.arange(seconds * RATE_HZ + 1) / RATE_HZ)
    assert np.trapezoid(driven.speed, driven.time) == pytest.approx(distance, rel=0.1)
    assert driven.speed.mean() == pytest.approx(mean_speed, rel=0.1)
    assert np.degrees(driven.latitude) == pytest.approx(latitude) and np.degrees(driven.azimuth[0]) == pytest.approx(azimuth)
    np.testing.assert_array_equal(driven.position[0], [0.0, 0.0, 100.0])


def test_the_truth_is_drawn_from_one_stream_that_knows_no_configuration(monkeypatch):
    asked = []
    own = trajectories.stream
    monkeypatch.setattr(trajectories, "stream", lambda seed, name: asked.append((seed, name)) or own(seed, name))
    for name in TRAJECTORIES:
        again = drive(name, PLANS[name])
        for one, other in zip(again[2:], trajectory(name)[2:], strict=True):
            np.testing.assert_array_equal(one, other)
    assert asked == [(0, "ghouneem2024/t1/101/truth"), (0, "ghouneem2024/t2/202/truth")]


def test_an_unknown_drive_is_refused_in_one_line():
    with pytest.raises(InputError, match="^ghouneem2024: trajectory: found 't3', expected 't1' or 't2'$"):
        trajectory("t3")


def test_it_stands_still_for_a_minute_and_again_before_the_end(driven):
    standing = stretches(driven.speed == 0.0)
    assert standing[0][0] == 0 and standing[0][1] - 1 >= 60 * RATE_HZ
    assert standing[-1][1] == driven.time.size and np.diff(standing[-1])[0] > 10 * RATE_HZ
    assert driven.speed.min() == 0.0


def test_standing_is_exact(driven):
    stops = stretches(driven.speed == 0.0)
    assert len(stops) > 5
    for first, last in stops:
        for still in (driven.position, driven.azimuth):
            np.testing.assert_array_equal(still[first:last], np.broadcast_to(still[first], still[first:last].shape))
        for still in (driven.pitch, driven.roll):  # the last elements of an array may have another last digit of the sine
            np.testing.assert_allclose(still[first:last], still[first], rtol=0.0, atol=1e-16)
        np.testing.assert_array_equal(driven.velocity[first:last], 0.0)
        inside = slice(first + 1, last - 1)
        np.testing.assert_array_equal(driven.acceleration[inside], 0.0)
        np.testing.assert_allclose(np.linalg.norm(driven.force[inside], axis=1), GRAVITY, rtol=1e-14)


def test_velocity_points_along_azimuth_and_pitch(driven):
    east, north, up = driven.velocity.T
    np.testing.assert_allclose(np.linalg.norm(driven.velocity, axis=1), driven.speed, atol=1e-12)
    np.testing.assert_allclose(up, driven.speed * np.sin(driven.pitch), atol=1e-14)
    moving = driven.speed > 0.0
    turned = np.angle(np.exp(1j * (np.arctan2(east, north) - driven.azimuth)))
    np.testing.assert_allclose(turned[moving], 0.0, atol=1e-9)


def test_position_is_the_trapezoidal_integral_of_velocity(driven):
    np.testing.assert_allclose(
        driven.position[-1, [1, 0, 2]] - (0, 0, START_HEIGHT), np.trapezoid(driven.velocity, dx=0.05, axis=0), rtol=1e-9
    )
    steps = np.diff(driven.position[:, [1, 0, 2]], axis=0) * RATE_HZ
    np.testing.assert_allclose(steps, 0.5 * (driven.velocity[1:] + driven.velocity[:-1]), atol=1e-9)


def test_acceleration_is_the_central_difference_of_speed_and_stays_within_what_a_car_does(driven):
    np.testing.assert_allclose(driven.acceleration[1:-1], (driven.speed[2:] - driven.speed[:-2]) * RATE_HZ / 2.0, atol=1e-12)
    assert driven.acceleration.max() <= 1.3 * 1.2 + 1e-9 and driven.acceleration.min() >= -1.6 * 1.2 - 1e-9
    assert np.sqrt(np.mean(driven.acceleration**2)) == pytest.approx(0.675, rel=0.1)


def test_the_corrected_tilt_formulas_give_pitch_and_roll_back(driven):
    turn = np.gradient(driven.azimuth, 1.0 / RATE_HZ)
    pitch = np.arcsin((driven.force[:, 1] - driven.acceleration) / GRAVITY)
    np.testing.assert_allclose(pitch, driven.pitch, atol=1e-14)
    np.testing.assert_allclose(driven.force[:, 2], GRAVITY * np.cos(driven.pitch) * np.cos(driven.roll), rtol=1e-14)
    roll = -np.arcsin((driven.force[:, 0] - driven.speed * turn) / (GRAVITY * np.cos(pitch)))
    # The derivative of the azimuth is only a difference here, and the lane's curvature is a diffusion.
    assert np.sqrt(np.mean((roll - driven.roll) ** 2)) < 0.05 * np.std(driven.force[:, 0]) / GRAVITY


def test_the_rate_is_that_of_the_body_against_inertial_space(driven):
    """Attitudes two epochs apart, by rotation matrices, with all three components of earth and transport rate."""
    body = Rotation.from_euler("ZXY", np.stack([-driven.azimuth, driven.pitch, driven.roll], axis=1))
    turned = (body[:-2].inv() * body[2:]).as_rotvec()[:, 2] * RATE_HZ / 2.0
    east, north, _ = driven.velocity.T
    meridian = earth.meridian_radius(driven.latitude) + START_HEIGHT
    transverse = earth.transverse_radius(driven.latitude) + START_HEIGHT
    here = driven.latitude + driven.position[:, 0] / meridian
    up = earth.EARTH_RATE * np.sin(here) + east * np.tan(here) / transverse
    frame = body.inv().apply(np.stack([-north / meridian, earth.EARTH_RATE * np.cos(here) + east / transverse, up], axis=1))[:, 2]
    averaged = (driven.rate[:-2] + 2.0 * driven.rate[1:-1] + driven.rate[2:]) / 4.0
    # What is left out is the horizontal rate, up to 6e-5 rad/s, times the tilt; the wrong sign of p' sin r would be 3e-4.
    np.testing.assert_allclose(averaged, turned + frame[1:-1], atol=4e-6)


def test_the_truth_and_the_mechanisation_have_one_gravity():
    assert GRAVITY == riss.GRAVITY


def test_a_standing_vehicle_feels_the_earth_turn(driven):
    expected = earth.EARTH_RATE * np.sin(driven.latitude) * np.cos(driven.pitch[0]) * np.cos(driven.roll[0])
    np.testing.assert_allclose(driven.rate[: 60 * RATE_HZ], expected, rtol=1e-14)


def test_a_turn_has_its_angle_and_a_raised_cosines_peak():
    segment = Segment(14.0, 200.0, 1.3, 1.6, 0.0, -90 * DEGREE, 6.0, 15.0)
    samples = raised_cosine(segment)
    assert np.trapezoid(samples, dx=1.0 / RATE_HZ) == pytest.approx(segment.turn, rel=1e-12)
    assert samples[0] == samples[-1] == 0.0
    assert np.abs(samples).max() == pytest.approx(2.0 * 6.0 / (1.6 * 15.0), rel=0.01)  # twice speed over 1.6 radius


def test_the_fastest_turn_is_as_fast_as_the_design_says(driven):
    assert 36.0 < np.degrees(np.abs(np.diff(driven.azimuth)).max() * RATE_HZ) < 42.0


@pytest.mark.parametrize("stop, turn, leave", [(10.0, 0.0, 0.0), (10.0, 1.0, 0.0), (0.0, 1.0, 6.0), (0.0, 0.0, 20.0)])
def test_a_segment_ends_at_its_length_with_the_speed_that_comes_next(stop, turn, leave):
    speeds = [0.0]
    append_stretch(speeds, Segment(20.0, 800.0, 1.3, 1.6, stop, turn, 6.0, 15.0))
    assert speeds[-1] == pytest.approx(leave, abs=0.1)
    assert sum(speeds) / RATE_HZ == pytest.approx(800.0, abs=2.0)
    assert max(speeds) <= 20.0 and np.diff(speeds).max() <= 1.3 / RATE_HZ + 1e-12 and np.diff(speeds).min() >= -1.6 / RATE_HZ - 1e-12


def test_a_segment_too_short_to_stop_in_is_as_long_as_braking_takes():
    speeds = [25.0]
    append_stretch(speeds, Segment(14.0, 100.0, 1.3, 1.6, 10.0, 0.0, 6.0, 15.0))
    assert sum(speeds) / RATE_HZ == pytest.approx(25.0**2 / (2.0 * 1.6), rel=0.01)
    np.testing.assert_allclose(np.diff(speeds[:-1]), -1.6 / RATE_HZ, rtol=1e-9)


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_there_are_more_segments_than_time_and_their_shares_are_the_designs(name):
    plan = PLANS[name]
    segments = [segment for seed in range(8) for segment in draw_segments(STREAM(seed), plan)]
    n = len(segments)
    assert n / 8 * plan.segment_length[0] / (1.05 * max(plan.target_speeds)) >= plan.seconds
    for share, wanted in (
        (np.mean([segment.stop > 0 for segment in segments]), plan.stop_probability),
        (np.mean([segment.turn != 0 for segment in segments]), plan.turn_probability),
    ):
        assert share == pytest.approx(wanted, abs=4 * np.sqrt(wanted * (1 - wanted) / n))
    for number, bounds in (
        ("length", plan.segment_length), ("acceleration", (0.91, 1.56)), ("braking", (1.12, 1.92)),
        ("turn_speed", (5, 7)), ("turn_radius", (12, 18)),
    ):  # fmt: skip
        drawn = np.array([getattr(segment, number) for segment in segments])
        assert bounds[0] <= drawn.min() and drawn.max() <= bounds[1]
        assert drawn.mean() == pytest.approx(np.mean(bounds), abs=4 * (bounds[1] - bounds[0]) / np.sqrt(12 * n))


def test_the_grade_has_its_rms_along_the_road_and_its_rate_is_its_derivative():
    distance = np.arange(0.0, 3e6, 5.0)
    pitch, rate = draw_grade(STREAM(3), 0.022, distance, np.full(distance.size, 5.0))
    assert np.sqrt(np.mean(np.tan(pitch) ** 2)) == pytest.approx(0.022, rel=0.01)
    np.testing.assert_allclose(rate[1:-1], (pitch[2:] - pitch[:-2]) / 2.0, atol=2e-6)  # two seconds apart


def test_gauss_markov_noise_is_stationary_and_forgets_exponentially():
    noise = gauss_markov(STREAM(4).standard_normal((60, 20_000)), sd=3.0, correlation_samples=20.0)
    np.testing.assert_allclose(noise.var(axis=1), 9.0, rtol=5 * np.sqrt(2 / 20_000))
    for lag in (1, 20, 50):
        assert np.mean(noise[0] * noise[lag]) / 9.0 == pytest.approx(np.exp(-lag / 20.0), abs=5 / np.sqrt(20_000))
