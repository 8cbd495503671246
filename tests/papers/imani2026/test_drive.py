"""The drive: its design values, its derivatives, and an independent mechanisation that its perfect sensors have to satisfy."""

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.spatial.transform import Rotation

from robins.foundation.earth import earth_rate_n, meridian_radius, transverse_radius
from robins.foundation.errors import InputError
from robins.papers.imani2026.drive import (
    CHANNELS,
    GRAVITY,
    LATITUDE,
    WAY_POINT_TIMES,
    drive,
    motion,
    route,
    solve_closure,
    truth,
    truth_interval,
)


@pytest.fixture(scope="module")
def driven():
    return drive(10)


@pytest.fixture(scope="module")
def fine():
    return drive(200)


def body_to_n(quaternion):
    return Rotation.from_quat(quaternion, scalar_first=True)


def mechanise(driven, earth=True):
    """Velocity and attitude from the interval averages: the attitude by exact turns, the force turned by the mean attitude."""
    dt = 1.0 / driven.rate_hz
    gravity, of_earth = np.array([0.0, 0.0, -GRAVITY]), earth_rate_n(LATITUDE) * earth
    attitude, velocity = body_to_n(driven.quaternion[0]), np.zeros(3)
    velocities, attitudes = [velocity], [attitude.as_quat()]
    for force, rate in zip(driven.specific_force_interval, driven.rate_interval, strict=True):
        east, north, _ = velocity
        across = transverse_radius(LATITUDE)
        transport = np.array([-north / meridian_radius(LATITUDE), east / across, east * np.tan(LATITUDE) / across]) * earth
        half, half_n = Rotation.from_rotvec(rate * dt / 2), Rotation.from_rotvec(-(of_earth + transport) * dt / 2)
        middle = half_n * attitude * half
        velocity = velocity + dt * (middle.apply(force) - np.cross(2 * of_earth + transport, velocity) + gravity)
        attitude = half_n * middle * half
        velocities.append(velocity)
        attitudes.append(attitude.as_quat())
    return np.array(velocities), Rotation.from_quat(np.array(attitudes))


def test_three_solved_parameters_close_the_drive(driven):
    closure = solve_closure()
    assert closure[:2] == pytest.approx((9.0087, 9.4783), abs=6e-5)
    assert np.degrees(closure.descent) == pytest.approx(5.4739, abs=6e-5)
    np.testing.assert_allclose(driven.position[-1], (3.0, 4.0, 0.0), atol=1e-6)


def test_length_height_and_peaks_are_those_of_the_design(fine):
    speed = np.linalg.norm(fine.velocity_n, axis=1)
    assert np.trapezoid(speed, fine.time) == pytest.approx(1872.0, abs=0.5)
    assert fine.position[:, 2].max() == pytest.approx(27.93, abs=5e-3)
    assert np.linalg.norm(fine.acceleration_n, axis=1).max() == pytest.approx(1.97, abs=5e-3)
    assert np.linalg.norm(fine.rate_n, axis=1).max() == pytest.approx(0.589, abs=5e-4)


def test_the_car_passes_the_way_points(driven):
    passed = {54: (228, 0, 0), 62: (247, 19, 0), 97: (247, 273, 6), 118: (256, 288, 6), 172: (563, 466, 27.9), 233: (272, 309, 3.9)}
    for time, place in passed.items():
        np.testing.assert_allclose(driven.position[10 * time], place, atol=0.6)
    np.testing.assert_array_equal(driven.position[10 * WAY_POINT_TIMES[0]], 0.0)
    np.testing.assert_allclose(driven.position[10 * WAY_POINT_TIMES[-1]], (3.0, 4.0, 0.0), atol=1e-6)


def test_velocity_and_acceleration_are_derivatives_of_the_position(fine):
    dt = 1 / 200
    np.testing.assert_allclose((fine.position[2:] - fine.position[:-2]) / (2 * dt), fine.velocity_n[1:-1], atol=1e-4)
    np.testing.assert_allclose((fine.velocity_n[2:] - fine.velocity_n[:-2]) / (2 * dt), fine.acceleration_n[1:-1], atol=1e-4)


def test_the_rate_turns_the_attitude(fine):
    attitude = body_to_n(fine.quaternion)
    turned = (attitude[2:] * attitude[:-2].inv()).as_rotvec() * 100
    np.testing.assert_allclose(turned, fine.rate_n[1:-1], atol=1e-4)


def test_the_quaternion_is_that_of_the_euler_angles_and_never_changes_sign(driven):
    expected = Rotation.from_euler("ZYX", driven.euler[:, ::-1]).as_matrix()
    np.testing.assert_allclose(body_to_n(driven.quaternion).as_matrix(), expected, atol=1e-14)
    assert np.linalg.norm(np.diff(driven.quaternion, axis=0), axis=1).max() < 0.05
    np.testing.assert_allclose(np.linalg.norm(driven.quaternion, axis=1), 1.0, atol=1e-15)


def test_the_nose_is_up_on_the_way_up_and_the_car_leans_with_its_lateral_acceleration(driven):
    climbing, turning = driven.time == 150, driven.time == 108
    assert np.degrees(driven.euler[climbing, 1]) == pytest.approx(-5.0)
    lateral = (
        driven.velocity_n[turning, 0] * driven.acceleration_n[turning, 1]
        - driven.velocity_n[turning, 1] * driven.acceleration_n[turning, 0]
    ) / 4
    assert driven.euler[turning, 0] == pytest.approx(0.02 * lateral, rel=1e-3)
    assert np.degrees(driven.euler[-1, 2]) == pytest.approx(540.0)


def test_at_rest_the_sensors_feel_gravity_and_the_turning_earth(driven):
    still = driven.time < 20
    np.testing.assert_array_equal(driven.specific_force_b[still], np.broadcast_to([0.0, 0.0, GRAVITY], (200, 3)))
    np.testing.assert_allclose(driven.rate_b[still], np.broadcast_to(earth_rate_n(LATITUDE), (200, 3)), atol=1e-20)
    back = body_to_n(driven.quaternion[-1])
    np.testing.assert_allclose(back.apply(driven.specific_force_b[-1]), (0.0, 0.0, GRAVITY), atol=1e-13)


def test_interval_averages_are_the_integrals_of_the_closed_forms(driven):
    way = route(solve_closure())
    for k in (215, 581, 1000, 1733, 2360, 3050):
        start = driven.time[k - 1]

        def closed(time):
            at = motion(way, np.array([time]))
            return np.hstack([at.specific_force_b, at.rate_b, at.acceleration_n, at.rate_n])[0]

        integral, _ = quad_vec(closed, start, start + 0.1, epsabs=1e-13, epsrel=1e-13)
        found = (driven.specific_force_interval, driven.rate_interval, driven.acceleration_n_interval, driven.rate_n_interval)
        np.testing.assert_allclose(np.hstack([array[k - 1] for array in found]), integral * 10, atol=1e-11)


def test_the_average_acceleration_is_the_increment_of_the_velocity(driven):
    np.testing.assert_allclose(np.diff(driven.velocity_n, axis=0) * 10, driven.acceleration_n_interval, atol=1e-11)


def test_a_mechanisation_of_the_perfect_samples_stays_on_the_truth(driven):
    """At 10 Hz what remains is sculling and coning inside the intervals: below .05 m/s and 5e-5 rad over the whole drive."""
    velocity, attitude = mechanise(driven)
    error = (attitude * body_to_n(driven.quaternion).inv()).as_rotvec()
    assert np.abs(velocity - driven.velocity_n).max() < 0.05
    assert np.abs(error).max() < 5e-5


def test_the_mechanisation_error_falls_with_the_square_of_the_interval(driven):
    rough, smooth = (np.abs(mechanise(d)[0] - d.velocity_n).max() for d in (drive(5), driven))
    assert rough / smooth == pytest.approx(4.0, rel=0.01)


def test_without_the_earth_the_sensors_feel_motion_and_gravity_only(driven):
    flat = drive(10, earth=False)
    np.testing.assert_allclose(body_to_n(flat.quaternion).apply(flat.rate_b), flat.rate_n, atol=1e-15)
    force = body_to_n(flat.quaternion).apply(flat.specific_force_b)
    np.testing.assert_allclose(force, flat.acceleration_n + [0.0, 0.0, GRAVITY], atol=1e-13)
    velocity, _ = mechanise(flat, earth=False)
    assert np.abs(velocity - flat.velocity_n).max() < 0.05
    np.testing.assert_array_equal(flat.position, driven.position)


def test_in_reverse_gear_the_car_comes_back_without_turning_round(driven):
    backing = drive(10, reversing=True)
    np.testing.assert_allclose(backing.position[-1], (3.0, 4.0, 0.0), atol=1e-6)
    np.testing.assert_allclose(backing.position[:1660], driven.position[:1660], atol=1e-12)
    forward = body_to_n(backing.quaternion).inv().apply(backing.velocity_n)[:, 0]
    assert np.all(forward[1900:3119] < 0) and np.all(forward[201:1719] > 0)
    assert np.degrees(backing.euler[-1, 2]) == pytest.approx(360.0)
    velocity, _ = mechanise(backing)
    assert np.abs(velocity - backing.velocity_n).max() < 0.05


@pytest.mark.parametrize("rate", [0, 3, -10, 2.5, 400, np.nan, "10"])
def test_rates_that_do_not_divide_are_refused(rate):
    with pytest.raises(InputError, match="rate_hz.*divides 200"):
        drive(rate)


@pytest.mark.parametrize("rate", [1, 2, 5, 100])
def test_all_rates_see_one_drive(driven, rate):
    other = drive(rate)
    assert other.time.shape == (330 * rate + 1,)
    step, back = (10 // rate, 1) if rate < 10 else (1, rate // 10)
    for name in ("position", "velocity_n", "quaternion", "specific_force_b", "rate_b"):
        np.testing.assert_allclose(getattr(other, name)[::back], getattr(driven, name)[::step], atol=1e-10)


def test_channels_hold_epochs_and_interval_averages(driven):
    at_epochs, averaged = truth(driven), truth_interval(driven)
    assert at_epochs.shape == averaged.shape == (3301, len(CHANNELS))
    same = [CHANNELS.index(name) for name in ("v_e", "v_n", "v_u", "roll", "pitch", "yaw")]
    np.testing.assert_array_equal(at_epochs[:, same], averaged[:, same])
    np.testing.assert_array_equal(averaged[1:, 3:6], driven.acceleration_n_interval)
    np.testing.assert_array_equal(averaged[0, 3:9], averaged[1, 3:9])
    latency = np.abs(at_epochs - averaged)
    assert latency[:, 3:6].max() < 0.049 and latency[:, 6:9].max() == pytest.approx(0.009, abs=2e-4)
