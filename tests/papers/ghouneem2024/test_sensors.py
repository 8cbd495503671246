"""Sensors: how large every error is, what the digits and the latency do, and that no sensor's noise depends on another's."""

import numpy as np
import pytest

from robins.papers.ghouneem2024 import sensors
from robins.papers.ghouneem2024.sensors import (
    ACCELEROMETER_DIGIT,
    DEGREE,
    GYROSCOPE_DIGIT,
    ODOMETER_DIGIT,
    initial_error,
    quantise,
    sense,
    sense_force,
    sense_rate,
    sense_speed,
    smoothed_derivative,
)
from robins.papers.ghouneem2024.trajectories import GRAVITY, RATE_HZ, TRAJECTORIES, trajectory

MILLI_G = 1e-3 * GRAVITY


def cut(driven, first, last):
    """The truth between two times (s), with its own clock."""
    part = slice(first * RATE_HZ, last * RATE_HZ + 1)
    arrays = [value[part] for value in driven[2:]]
    return type(driven)(driven.name, driven.latitude, arrays[0] - arrays[0][0], *arrays[1:])


def moving(seconds, speed_at):
    """A drive of this length whose speed is a function of time; nothing else moves."""
    still = cut(trajectory("t1"), 0, 1)
    time = np.arange(seconds * RATE_HZ + 1) / RATE_HZ
    zero = np.zeros(time.size)
    return still._replace(
        time=time, speed=speed_at(time), rate=zero, force=np.zeros((time.size, 3)), position=np.zeros((time.size, 3)),
        velocity=np.zeros((time.size, 3)), azimuth=zero, pitch=zero, roll=zero, acceleration=zero,
    )  # fmt: skip


@pytest.fixture
def without(monkeypatch):
    """Switches errors off; digits become so fine that they are not seen."""

    def switch(*names):
        for name in names:
            monkeypatch.setattr(sensors, name, 1e-12 if name.endswith("DIGIT") else 0.0)

    return switch


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_shapes_and_types(name):
    driven = trajectory(name)
    seen = sense(1, driven, 3)
    n = driven.time.size
    assert seen.force.shape == (n, 3)
    assert all(field.shape == (n,) for field in seen[1:])
    assert all(field.dtype == float and field.flags.c_contiguous and np.isfinite(field).all() for field in seen)


def test_a_run_is_the_same_again_and_other_runs_drives_and_seeds_are_not():
    driven = cut(trajectory("t1"), 50, 90)
    one = sense(1, driven, 3)
    for field, again in zip(one, sense(1, driven, 3), strict=True):
        np.testing.assert_array_equal(field, again)
    for other in (sense(1, driven, 4), sense(2, driven, 3), sense(1, driven._replace(name="t2"), 3)):
        assert not np.isclose(one.bias, other.bias).any()
        assert (one.force != other.force).any() and (one.speed != other.speed).any()


def test_every_sensor_has_a_stream_of_its_own(monkeypatch):
    names = []
    own = sensors.stream
    monkeypatch.setattr(sensors, "stream", lambda seed, name: names.append(name) or own(seed, name))
    driven = cut(trajectory("t2"), 0, 30)
    sense(1, driven, 7)
    initial_error(1, driven, 7)
    assert names == [f"ghouneem2024/t2/7/{sensor}" for sensor in ("gyroscope", "accelerometer", "odometer", "initial")]


def test_noises_of_the_sensors_are_uncorrelated(without):
    without("GYROSCOPE_DIGIT", "ACCELEROMETER_DIGIT")
    driven = trajectory("t1")
    seen = sense(1, driven, 5)
    samples = np.column_stack([seen.rate - driven.rate - seen.bias, np.diff(seen.force - driven.force, axis=0, prepend=0.0)])
    white = samples[RATE_HZ * 200 : RATE_HZ * 1700]
    assert np.abs(np.corrcoef(white.T) - np.eye(4)).max() < 5 * np.sqrt(1.5 / len(white))


def test_white_noise_of_the_gyroscope(without):
    without("GYROSCOPE_SCALE", "GYROSCOPE_DIGIT")
    driven = trajectory("t1")
    rate, bias = sense_rate(np.random.default_rng(1), driven)
    noise = rate - driven.rate - bias
    assert noise.std() == pytest.approx(0.0237 * DEGREE, rel=4 / np.sqrt(2 * noise.size))
    assert 60.0 * np.degrees(noise.std()) / np.sqrt(RATE_HZ) == pytest.approx(0.32, rel=0.02)  # degrees per square root of an hour


def test_bias_of_the_gyroscope_is_a_constant_and_a_slow_drift():
    driven = cut(trajectory("t1"), 0, 300)
    runs = 400
    bias = np.array([sense(1, driven, run).bias for run in range(runs)])
    drift = 10.0 * DEGREE / 3600.0
    turn_on = 0.03 * DEGREE
    margin = 4 / np.sqrt(2 * runs)
    np.testing.assert_allclose(bias[:, [0, -1]].std(axis=0), np.hypot(turn_on, drift), rtol=margin)
    change = bias[:, -1] - bias[:, 0]
    assert change.std() == pytest.approx(drift * np.sqrt(2.0 * (1.0 - np.exp(-1.0))), rel=margin)  # after one time constant
    assert np.diff(bias, axis=1).std() == pytest.approx(drift * np.sqrt(2.0 * (1.0 - np.exp(-1.0 / 6000.0))), rel=0.01)


def test_scale_of_the_gyroscope(without):
    without("GYROSCOPE_WHITE", "GYROSCOPE_DIGIT")
    driven = moving(1, np.zeros_like)._replace(rate=np.full(21, 0.5))
    runs = 1000
    scales = []
    for seed in range(runs):
        rate, bias = sense_rate(np.random.default_rng(seed), driven)
        np.testing.assert_allclose((rate - bias) / 0.5, (rate - bias)[0] / 0.5, atol=1e-10)
        scales.append((rate - bias)[0] / 0.5 - 1.0)
    assert np.std(scales) == pytest.approx(0.003, rel=4 / np.sqrt(2 * runs))


def test_digits_of_the_gyroscope_add_the_variance_of_a_uniform_law(without):
    """Exact when the value before rounding falls anywhere between two digits, as on this truth of many turns."""
    without("GYROSCOPE_SCALE")
    driven = moving(2000, np.zeros_like)
    driven = driven._replace(rate=np.linspace(-0.5, 0.5, driven.time.size))
    rate, bias = sense_rate(np.random.default_rng(2), driven)
    variance = np.var(rate - driven.rate - bias)
    assert variance == pytest.approx((0.0237 * DEGREE) ** 2 + (DEGREE / 18.0) ** 2 / 12.0, rel=0.03)


def test_noise_of_the_accelerometers_is_small_when_it_stands(without):
    without("ACCELEROMETER_BIAS", "ACCELEROMETER_DRIFT", "ACCELEROMETER_DIGIT")
    driven = trajectory("t2")
    noise = sense_force(np.random.default_rng(3), driven) - driven.force
    for flags, sd in ((driven.speed <= 0.2, 0.03), (driven.speed > 0.2, 0.1)):
        np.testing.assert_allclose(noise[flags].std(axis=0), sd, rtol=4 / np.sqrt(2 * flags.sum()))
        np.testing.assert_allclose(noise[flags].mean(axis=0), 0.0, atol=4 * sd / np.sqrt(flags.sum()))


def test_biases_of_the_accelerometers(without):
    without("VIBRATION", "STANDING_VIBRATION", "ACCELEROMETER_DIGIT")
    driven = moving(600, np.zeros_like)
    runs = 200
    bias = np.array([sense_force(np.random.default_rng(run), driven)[[0, -1]] for run in range(runs)])
    margin = 4 / np.sqrt(2 * runs * 3)
    assert bias[:, 0].std() == pytest.approx(np.hypot(8.0, 2.0) * MILLI_G, rel=margin)
    assert (bias[:, 1] - bias[:, 0]).std() == pytest.approx(2.0 * MILLI_G * np.sqrt(2.0 * (1.0 - np.exp(-1.0))), rel=margin)
    assert np.abs(np.corrcoef(bias[:, 0].T) - np.eye(3)).max() < 4 / np.sqrt(runs)


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_readings_lie_on_the_lattice_of_their_digits(name):
    seen = sense(1, trajectory(name), 2, hold=True)
    for reading, digit in ((seen.rate, DEGREE / 18.0), (seen.force, GRAVITY / 650.0), (seen.speed, 1.0 / 3.6)):
        counts = reading / digit
        np.testing.assert_allclose(counts, np.rint(counts), atol=1e-9)
    assert (GYROSCOPE_DIGIT, ACCELEROMETER_DIGIT, ODOMETER_DIGIT) == (DEGREE / 18.0, GRAVITY / 650.0, 1.0 / 3.6)


def test_quantising_is_to_the_nearest_digit():
    value = np.random.default_rng(4).normal(size=1000)
    assert np.abs(quantise(value, 0.25) - value).max() <= 0.125
    np.testing.assert_array_equal(quantise(np.array([0.1, 0.13, -0.2, 0.0]), 0.25), [0.0, 0.25, -0.25, 0.0])


def test_the_odometers_speed_arrives_once_a_second_and_is_four_tenths_old(without):
    without("ODOMETER_SCALE", "ODOMETER_DIGIT")
    driven = trajectory("t1")
    arrival, value = sense_speed(np.random.default_rng(5), driven)
    np.testing.assert_allclose(np.diff(arrival), 1.0, rtol=1e-9)
    assert 0.0 <= arrival[0] < 1.0 and driven.time[-1] - 1.0 <= arrival[-1] < driven.time[-1]
    np.testing.assert_allclose(value, np.interp(arrival - 0.4, driven.time, driven.speed), atol=1e-11)


def test_the_odometers_phase_is_uniform_and_its_scale_normal(without):
    without("ODOMETER_DIGIT")
    driven = moving(5, lambda time: np.full(time.size, 10.0))
    runs = 2000
    seen = [sense_speed(np.random.default_rng(run), driven) for run in range(runs)]
    phases = np.array([arrival[0] for arrival, _ in seen])
    assert phases.mean() == pytest.approx(0.5, abs=4 / np.sqrt(12 * runs)) and phases.var() == pytest.approx(1 / 12, rel=0.1)
    assert np.std([value[0] for _, value in seen]) == pytest.approx(0.12, rel=4 / np.sqrt(2 * runs))


def test_on_a_ramp_the_interpolated_speed_is_late_by_the_latency_and_its_derivative_is_exact(without):
    without("ODOMETER_SCALE", "ODOMETER_DIGIT")
    driven = moving(60, lambda time: 0.7 * time)
    seen = sense(1, driven, 0)
    inside = slice(5 * RATE_HZ, -5 * RATE_HZ)
    np.testing.assert_allclose((driven.speed - seen.speed)[inside], 0.7 * 0.4, atol=1e-9)
    np.testing.assert_allclose(seen.acceleration[inside], 0.7, atol=1e-9)


def test_on_a_ramp_the_held_speed_is_late_by_latency_and_age(without):
    without("ODOMETER_SCALE", "ODOMETER_DIGIT")
    driven = moving(60, lambda time: 0.7 * time)
    lateness = ((driven.speed - sense(1, driven, 0, hold=True).speed) / 0.7)[5 * RATE_HZ : 55 * RATE_HZ]
    assert 0.4 - 1e-9 <= lateness.min() < 0.45 and 1.35 - 1e-9 < lateness.max() < 1.4 + 1e-9
    assert lateness.mean() == pytest.approx(0.4 + 0.5, abs=0.5 / RATE_HZ)


@pytest.mark.parametrize("hold", [True, False])
def test_holding_is_causal_and_interpolating_is_not(hold):
    driven = trajectory("t2")
    now = 700 * RATE_HZ
    later = driven._replace(speed=np.where(driven.time > driven.time[now], 30.0, driven.speed))
    first, second = sense(1, driven, 0, hold), sense(1, later, 0, hold)
    same = np.array_equal(first.speed[: now + 1], second.speed[: now + 1])
    same_derivative = np.array_equal(first.acceleration[: now + 1], second.acceleration[: now + 1])
    assert (same, same_derivative) == (hold, hold)


def test_holding_changes_the_odometer_only():
    driven = trajectory("t1")
    first, second = sense(1, driven, 0, hold=True), sense(1, driven, 0)
    for name in ("force", "rate", "bias"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))
    assert (first.speed != second.speed).any()


@pytest.mark.parametrize("hold", [True, False])
@pytest.mark.parametrize("name", TRAJECTORIES)
def test_a_standing_vehicle_has_no_speed(name, hold):
    driven = trajectory(name)
    seen = sense(1, driven, 1, hold)
    standing = slice(0, 59 * RATE_HZ)
    np.testing.assert_array_equal(seen.speed[standing], 0.0)
    np.testing.assert_array_equal(seen.acceleration[standing], 0.0)
    assert seen.speed[-1] == seen.acceleration[-1] == 0.0


def test_the_smoothed_derivative_is_the_mean_of_21_differences():
    speed = np.random.default_rng(6).normal(size=200).cumsum()
    centred = np.convolve(np.gradient(speed, 1 / RATE_HZ), np.full(21, 1 / 21), mode="valid")
    np.testing.assert_allclose(smoothed_derivative(speed, causal=False)[11:-11], centred[1:-1], atol=1e-11)
    backward = np.convolve(np.diff(speed) * RATE_HZ, np.full(21, 1 / 21), mode="valid")
    np.testing.assert_allclose(smoothed_derivative(speed, causal=True)[21:], backward, atol=1e-11)


def test_the_centred_derivative_of_a_parabola_is_exact_and_the_backward_one_is_late():
    time = np.arange(400) / RATE_HZ
    inside = slice(30, -30)
    np.testing.assert_allclose(smoothed_derivative(time**2, causal=False)[inside], 2 * time[inside], atol=1e-9)
    np.testing.assert_allclose(smoothed_derivative(time**2, causal=True)[inside], 2 * (time[inside] - 10.5 / RATE_HZ), atol=1e-9)


def test_initial_errors_have_the_stated_deviations():
    driven = trajectory("t1")
    runs = 1000
    errors = np.array([initial_error(1, driven, run) for run in range(runs)])
    np.testing.assert_allclose(errors.std(axis=0), [2.5, 2.5, 4.0, np.radians(5.0)], rtol=4 / np.sqrt(2 * runs))
    assert np.abs(np.corrcoef(errors.T) - np.eye(4)).max() < 5 / np.sqrt(runs)
