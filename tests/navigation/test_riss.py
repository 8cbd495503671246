"""The reduced inertial sensor system: closed laps, readings of its velocity, Jacobians against derivatives, tilt in numbers."""

import numpy as np
import pytest

from robins.foundation.earth import EARTH_RATE, meridian_radius, transverse_radius
from robins.foundation.errors import InputError
from robins.kalman.model import linearise, process_noise, propagate
from robins.navigation.riss import (
    ACCELERATION,
    AZIMUTH,
    COS_PITCH,
    COS_ROLL,
    EAST,
    GRAVITY,
    GYRO_BIAS,
    HEIGHT,
    INCREMENTAL,
    INPUTS,
    LEVEL,
    MEMORYLESS,
    NORTH,
    ODOMETER,
    PRINTED,
    RATE,
    SIN_PITCH,
    SPEED,
    SPEED_BEFORE,
    STATES,
    TILTS,
    TOTAL,
    V_EAST,
    V_NORTH,
    V_UP,
    geodetic,
    inputs,
    require_regular,
    riss,
    tilt,
    turn_rate,
)

LATITUDE, HEIGHT_THERE = np.radians(44.23), 100.0
DT, BIAS_TIME, ODOMETER_TIME = 0.05, 300.0, 60.0
LOOPS = (TOTAL, INCREMENTAL, MEMORYLESS)
RADIUS, LAP_SPEED = 50.0, 10.0
LAP = round(2 * np.pi * RADIUS / LAP_SPEED / DT)
LAP_DT = 2 * np.pi * RADIUS / LAP_SPEED / LAP
"""Step that divides a lap into a whole number of steps."""


def made(loop=TOTAL, dt=DT, noise=None, **more):
    return riss(loop, dt, LATITUDE, HEIGHT_THERE, np.zeros(STATES) if noise is None else noise, BIAS_TIME, ODOMETER_TIME, **more)


def march(model, x0, u):
    """States at every epoch, the input's last row unused."""
    x, states = np.array(x0, float), [np.array(x0, float)]
    for row in u[:-1]:
        propagate(model, x, row)
        states.append(x.copy())
    return np.array(states)


def lap(rate_of_the_earth, **more):
    """A clockwise lap at 10 m/s that begins northwards; the gyro feels the turn, and earth and transport rate times a factor."""
    azimuth = 2 * np.pi * np.arange(LAP + 1) / LAP
    velocity_east, north = LAP_SPEED * np.sin(azimuth), np.cumsum(np.r_[0.0, LAP_SPEED * np.cos(azimuth[1:]) * LAP_DT])
    latitude = LATITUDE + north / (meridian_radius(LATITUDE) + HEIGHT_THERE)
    vertical = EARTH_RATE * np.sin(latitude) + velocity_east * np.tan(latitude) / (transverse_radius(LATITUDE) + HEIGHT_THERE)
    rate = np.zeros(LAP + 1)
    rate[1:] = -np.diff(azimuth) / LAP_DT + rate_of_the_earth * vertical[:-1]
    still = np.zeros(LAP + 1)
    u = inputs(rate, np.full(LAP + 1, LAP_SPEED), still, still, still)
    return march(made(dt=LAP_DT, **more), [0, 0, HEIGHT_THERE, 0, LAP_SPEED, 0, 0, 0, 0], u)


def drawn(rng, bias=3e-3, odometer=0.3):
    """A state and an input of a car that turns on a slope."""
    x = np.r_[rng.uniform(-5e3, 5e3, 2), rng.uniform(0, 500), rng.uniform(-20, 20, 2), rng.uniform(-1, 1), rng.uniform(-9, 9),
              rng.normal(0, bias), rng.normal(0, odometer)]  # fmt: skip
    pitch, roll, before = rng.uniform(-0.1, 0.1, 3)
    u = np.array([rng.uniform(-0.7, 0.7), rng.uniform(0, 25), rng.uniform(-2, 2), np.sin(pitch), np.cos(pitch), np.cos(roll),
                  rng.uniform(0, 25), np.sin(before), np.cos(before)])  # fmt: skip
    return x, u


def jacobian(model, x, u):
    F, Q = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    linearise(model, x, u, F, Q)
    return F


def differences(model, x, u):
    """Central differences of a step."""
    F = np.empty((STATES, STATES))
    for j, step in enumerate([10.0, 10.0, 10.0, 1e-2, 1e-2, 1e-2, 1e-5, 1e-5, 1e-3]):
        ahead, behind = x.copy(), x.copy()
        ahead[j] += step
        behind[j] -= step
        propagate(model, ahead, u)
        propagate(model, behind, u)
        F[:, j] = (ahead - behind) / (2 * step)
    return F


# Laps (checks 4 to 6 of the brief).


def test_a_lap_closes_when_the_gyro_feels_the_rotation_of_the_earth():
    states = lap(1.0)
    assert np.hypot(states[-1, NORTH], states[-1, EAST]) < 1e-9
    assert abs(states[-1, AZIMUTH] - 2 * np.pi) < 1e-12
    quarter = states[LAP // 4]
    assert quarter[EAST] > 49.0 and quarter[NORTH] > 49.0


def test_without_the_rotation_of_the_earth_in_the_gyro_the_lap_stays_open_by_what_the_earth_turned():
    states = lap(0.0)
    assert np.hypot(states[-1, NORTH], states[-1, EAST]) == pytest.approx(0.080, rel=0.1)
    assert np.degrees(states[-1, AZIMUTH] - 2 * np.pi) == pytest.approx(0.092, rel=0.1)
    seconds = LAP * LAP_DT
    assert states[-1, AZIMUTH] - 2 * np.pi == pytest.approx(EARTH_RATE * np.sin(LATITUDE) * seconds, rel=1e-4)


def test_with_the_printed_sign_a_quarter_of_a_circle_to_the_right_ends_on_the_left():
    quarter = lap(1.0, clockwise=1.0)[LAP // 4]
    assert quarter[NORTH] == pytest.approx(49.7, abs=0.3)
    assert quarter[EAST] == pytest.approx(-50.3, abs=0.3) and quarter[EAST] < 0.0
    assert np.degrees(quarter[AZIMUTH]) == pytest.approx(-90.0, abs=0.1)


# The rate of turn.


@pytest.mark.parametrize("height", [0.0, 100.0, 4000.0])
def test_the_rate_of_turn_lacks_bias_earth_and_transport_rate_at_the_height_and_latitude_of_the_state(height):
    x = np.zeros(STATES)
    x[[NORTH, HEIGHT, V_EAST, GYRO_BIAS]] = 3e5, height, 30.0, 1e-4
    u = np.zeros(INPUTS)
    u[RATE] = 0.2
    latitude = LATITUDE + 3e5 / (meridian_radius(LATITUDE) + HEIGHT_THERE)
    expected = 0.2 - 1e-4 - EARTH_RATE * np.sin(latitude) - 30.0 * np.tan(latitude) / (transverse_radius(LATITUDE) + height)
    assert turn_rate(made(), x, u) == pytest.approx(expected, rel=1e-14, abs=1e-17)


def test_the_azimuth_follows_the_gyro_bias_with_the_sign_of_a_state_that_is_subtracted():
    """(4): the gyro shows too much by b, so the car has turned less to the left."""
    rng = np.random.default_rng(4)
    for loop in LOOPS:
        x, u = drawn(rng)
        biased = x.copy()
        biased[GYRO_BIAS] += 1e-4
        F = jacobian(made(loop), x, u)
        propagate(made(loop), x, u)
        propagate(made(loop), biased, u)
        assert biased[AZIMUTH] - x[AZIMUTH] == pytest.approx(1e-4 * DT, rel=1e-6)
        tilted = 1.0 if loop == TOTAL else u[COS_PITCH] * u[COS_ROLL]
        assert F[AZIMUTH, GYRO_BIAS] == pytest.approx(tilted * DT, rel=1e-12)


# Readings of the velocity.


def random_drive(seed, n=400):
    """Inputs of an arbitrary drive, and the state that begins it."""
    rng = np.random.default_rng(seed)
    speed = np.abs(np.cumsum(rng.normal(0, 0.3, n)))
    u = inputs(rng.normal(0, 0.4, n), speed, np.gradient(speed, DT), rng.normal(0, 0.05, n), rng.normal(0, 0.02, n))
    azimuth, cosine = rng.uniform(-4, 4), u[0, 8]
    east, north, up = speed[0] * np.sin(azimuth) * cosine, speed[0] * np.cos(azimuth) * cosine, speed[0] * u[0, 7]
    return u, np.array([0, 0, HEIGHT_THERE, east, north, up, azimuth, 1e-3, 0])


@pytest.mark.parametrize("seed", range(4))
def test_with_a_perfect_odometer_and_no_correction_the_three_readings_are_the_same_mechanisation(seed):
    u, x0 = random_drive(seed)
    states = [march(made(loop), x0, u) for loop in LOOPS]
    np.testing.assert_allclose(states[1], states[0], rtol=0, atol=1e-9)
    np.testing.assert_array_equal(states[2], states[0])


def test_a_correction_of_the_velocity_persists_in_one_reading_and_is_overwritten_in_the_others():
    u, x0 = random_drive(9)
    corrected = x0.copy()
    corrected[V_EAST : V_UP + 1] += (0.7, -0.4, 0.2)
    moved = {loop: march(made(loop), corrected, u) - march(made(loop), x0, u) for loop in LOOPS}
    np.testing.assert_allclose(moved[INCREMENTAL][1:, V_EAST], 0.7, atol=1e-5)
    np.testing.assert_allclose(moved[INCREMENTAL][1:, V_NORTH : V_UP + 1], [(-0.4, 0.2)] * (len(u) - 1), atol=1e-5)
    np.testing.assert_allclose(moved[INCREMENTAL][-1, :2], np.array([-0.4, 0.7]) * DT * (len(u) - 1), rtol=1e-4)
    for loop in (TOTAL, MEMORYLESS):  # but for the transport rate of one step
        assert np.abs(moved[loop][1:, V_EAST : V_UP + 1]).max() < 1e-6


def test_the_odometer_state_is_a_speed_in_one_reading_an_acceleration_in_another_and_nothing_in_the_third():
    u, x0 = random_drive(3)
    wrong = x0.copy()
    wrong[ODOMETER] = 0.3
    change = {}
    for loop in LOOPS:
        right, other = x0.copy(), wrong.copy()
        propagate(made(loop), right, u[0])
        propagate(made(loop), other, u[0])
        ahead = np.array([np.sin(right[AZIMUTH]) * u[0, COS_PITCH], np.cos(right[AZIMUTH]) * u[0, COS_PITCH], u[0, SIN_PITCH]])
        change[loop] = (other - right)[V_EAST : V_UP + 1] @ ahead
    assert change[TOTAL] == pytest.approx(-0.3)
    assert change[INCREMENTAL] == pytest.approx(-0.3 * DT)
    assert change[MEMORYLESS] == 0.0


def test_the_state_moves_with_the_velocity_at_the_end_of_the_step():
    rng = np.random.default_rng(5)
    for loop in LOOPS:
        x, u = drawn(rng)
        before = x.copy()
        propagate(made(loop), x, u)
        np.testing.assert_allclose((x - before)[:3], x[[V_NORTH, V_EAST, V_UP]] * DT, rtol=1e-7)


# Gauss-Markov states.


@pytest.mark.parametrize(("state", "time", "sigma"), [(GYRO_BIAS, BIAS_TIME, 5e-5), (ODOMETER, ODOMETER_TIME, 0.3)])
@pytest.mark.parametrize("loop", LOOPS)
def test_gauss_markov_states_decay_and_keep_their_variance(loop, state, time, sigma):
    noise = np.zeros(STATES)
    noise[state] = 2 * sigma**2 * DT / time
    model, x, u = made(loop, noise=noise), np.zeros(STATES), np.zeros(INPUTS)
    x[state], variance = 1.0, sigma**2
    F, Q = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    for _ in range(round(time / DT)):
        linearise(model, x, u, F, Q)
        variance = F[state, state] ** 2 * variance + Q[state, state]
        propagate(model, x, u)
    assert x[state] == pytest.approx(np.exp(-1.0), rel=1e-9)
    assert variance == pytest.approx(sigma**2, rel=1e-3)


# Jacobians (check 7 of the brief).


@pytest.mark.parametrize("clockwise", [-1.0, 1.0])
def test_the_exact_jacobian_is_the_central_difference(clockwise):
    rng, model = np.random.default_rng(7), made(clockwise=clockwise)
    for _ in range(50):
        x, u = drawn(rng)
        F = jacobian(model, x, u)
        np.testing.assert_allclose(F, differences(model, x, u), rtol=0, atol=1e-6)
        small = F[AZIMUTH, [NORTH, HEIGHT, V_EAST]]  # far below the tolerance above
        np.testing.assert_allclose(small, differences(model, x, u)[AZIMUTH, [NORTH, HEIGHT, V_EAST]], rtol=1e-3, atol=1e-15)


def velocity_rates(model, x, u, turns):
    """Rates of change (east, north) of ``V (sin A, cos A) cos p``, with a speed that changes by ``a - d``, tilt constant."""
    sine, cosine = np.sin(x[AZIMUTH]), np.cos(x[AZIMUTH])
    gained, turned = u[ACCELERATION] - x[ODOMETER], u[SPEED] * model.clockwise * turn_rate(model, x, u) * turns
    return np.array([gained * sine + turned * cosine, gained * cosine - turned * sine]) * u[COS_PITCH]


def derivatives(function, x, states):
    columns = []
    for j in states:
        ahead, behind = x.copy(), x.copy()
        ahead[j] += 1e-6
        behind[j] -= 1e-6
        columns.append((function(ahead) - function(behind)) / 2e-6)
    return np.array(columns).T


@pytest.mark.parametrize("clockwise", [-1.0, 1.0])
@pytest.mark.parametrize("loop", [INCREMENTAL, MEMORYLESS])
def test_the_printed_velocity_error_leaves_out_the_turn(loop, clockwise):
    """(3) is the derivative of the velocity's rate of a car that does not turn; with the terms of the turn, that of any."""
    rng, states = np.random.default_rng(8), (AZIMUTH, GYRO_BIAS, ODOMETER)
    printed, turning = made(loop, clockwise=clockwise), made(loop, clockwise=clockwise, turning=True)
    for _ in range(20):
        x, u = drawn(rng, odometer=0.0)
        at = np.ix_([V_EAST, V_NORTH], states)
        straight, whole = (derivatives(lambda y, u=u, t=turns: velocity_rates(printed, y, u, t), x, states) for turns in (0.0, 1.0))
        np.testing.assert_allclose(jacobian(printed, x, u)[at] / DT, straight, rtol=0, atol=1e-7)
        np.testing.assert_allclose(jacobian(turning, x, u)[at] / DT, whole, rtol=0, atol=1e-7)
        assert jacobian(printed, x, u)[V_UP, ODOMETER] == -u[SIN_PITCH] * DT


def test_in_a_turn_at_six_metres_a_second_and_forty_degrees_a_second_the_missing_term_exceeds_the_printed_one():
    x, u = np.zeros(STATES), np.zeros(INPUTS)
    u[[RATE, SPEED, ACCELERATION, COS_PITCH, COS_ROLL]] = -np.radians(40.0), 6.0, 1.9, 1.0, 1.0
    printed, whole = jacobian(made(INCREMENTAL), x, u), jacobian(made(INCREMENTAL, turning=True), x, u)
    assert np.abs(printed[V_EAST : V_UP + 1, AZIMUTH]).max() == pytest.approx(1.9 * DT)
    assert np.abs((whole - printed)[V_EAST : V_UP + 1, AZIMUTH]).max() == pytest.approx(6.0 * np.radians(40.0) * DT, rel=1e-3)


@pytest.mark.parametrize("loop", LOOPS)
def test_the_process_noise_is_diagonal_and_the_same_with_and_without_the_jacobian(loop):
    rng = np.random.default_rng(6)
    model = made(loop, noise=rng.uniform(0, 1, STATES))
    x, u = drawn(rng)
    F, Q, alone = (np.full((STATES, STATES), np.nan) for _ in range(3))
    linearise(model, x, u, F, Q)
    process_noise(model, x, u, alone)
    np.testing.assert_array_equal(Q, np.diag(model.noise))
    np.testing.assert_array_equal(alone, Q)


# Tilt.


def attitude(pitch, roll, acceleration=0.0, speed=0.0, azimuth_rate=0.0):
    """Specific force (1, 3) of a car at this tilt."""
    right = speed * azimuth_rate - GRAVITY * np.cos(pitch) * np.sin(roll)
    return np.array([[right, acceleration + GRAVITY * np.sin(pitch), GRAVITY * np.cos(pitch) * np.cos(roll)]])


def one(value):
    return np.array([float(value)])


@pytest.mark.parametrize(("mode", "sign"), [("printed", 1.0), ("literal", -1.0), ("corrected", 1.0)])
def test_a_car_that_stands_knows_its_tilt_but_for_the_literal_sign(mode, sign):
    pitch, roll = tilt(mode, attitude(0.06, -0.03), one(0), one(0), one(0))
    assert pitch[0] == pytest.approx(sign * 0.06, abs=1e-12) and roll[0] == pytest.approx(-0.03, abs=1e-12)


def test_only_the_corrected_tilt_knows_the_accelerations_of_the_car():
    """At 15 m/s, braking at 1.5 m/s^2 and turning right at 20 deg/s, which a gyro that is positive to the left shows as -20 deg/s."""
    turn = np.radians(20.0)
    force = attitude(0.04, 0.02, acceleration=-1.5, speed=15.0, azimuth_rate=turn)
    pitch, roll = tilt("corrected", force, one(15), one(-1.5), one(-turn))
    assert pitch[0] == pytest.approx(0.04, abs=1e-12) and roll[0] == pytest.approx(0.02, abs=1e-12)
    pitch, roll = tilt("printed", force, one(15), one(-1.5), one(-turn))
    assert pitch[0] < -0.08 and roll[0] < -0.4


@pytest.mark.parametrize(("speed", "height"), [(15.0, 11.5), (12.4, 7.8)])
def test_an_acceleration_on_a_level_road_raises_the_printed_height_by_the_square_of_the_speed_over_two_g(speed, height):
    """And braking takes it back."""
    up = np.linspace(0.0, speed, round(speed / 1.3 / DT) + 1)
    v = np.r_[up, up[-2::-1]]
    a = np.r_[np.full(up.size, 1.3), np.full(up.size - 1, -1.3)] * (speed / 1.3 / DT) / (up.size - 1)
    force = np.column_stack([np.zeros_like(v), a, np.full_like(v, GRAVITY)])
    for mode, risen in ((PRINTED, height), ("corrected", 0.0), (LEVEL, 0.0), ("literal", -height)):
        pitch, roll = tilt(mode, force, v, a, np.zeros_like(v))
        states = march(made(), [0, 0, 0, 0, 0, 0, 0, 0, 0], inputs(np.zeros_like(v), v, a, pitch, roll))
        assert states[up.size - 1, HEIGHT] == pytest.approx(risen, rel=0.02, abs=1e-9)
        assert abs(states[-1, HEIGHT]) < 0.02 * height


def test_in_two_dimensions_the_height_stays_and_the_accelerometers_are_not_read():
    rng = np.random.default_rng(2)
    v = rng.uniform(0, 20, 100)
    pitch, roll = tilt(LEVEL, np.full((100, 3), np.nan), v, v, v)
    assert not pitch.any() and not roll.any()
    for loop in LOOPS:
        u = inputs(rng.normal(0, 0.3, 100), v, v, pitch, roll)
        x0 = np.array([0, 0, 55.0, 0, v[0], 0, 0, 0, 0])
        states = march(made(loop), x0, u)
        assert (states[:, HEIGHT] == 55.0).all() and not states[:, V_UP].any()
        np.testing.assert_allclose(np.hypot(states[1:, V_EAST], states[1:, V_NORTH]), v[1:], rtol=1e-9)


def test_a_tilt_that_no_car_has_is_no_error():
    pitch, roll = tilt("corrected", np.array([[30.0, 30.0, 1.0]]), one(0), one(0), one(0))
    assert pitch[0] == pytest.approx(np.pi / 2) and roll[0] == pytest.approx(-np.pi / 2)


def test_there_are_four_tilts_and_no_other():
    assert TILTS == ("printed", "literal", "corrected", "level")
    with pytest.raises(ValueError, match="mode: found 'flat'"):
        tilt("flat", np.ones((1, 3)), one(0), one(0), one(0))


# Inputs and positions.


def test_an_input_holds_the_epoch_that_it_predicts_and_the_one_before():
    rate, speed, acceleration, pitch, roll = np.arange(15.0).reshape(5, 3)
    u = inputs(rate, speed, acceleration, pitch, roll)
    assert u.shape == (3, INPUTS)
    for k in (0, 1):
        ahead = [rate[k + 1], speed[k + 1], acceleration[k + 1], np.sin(pitch[k + 1]), np.cos(pitch[k + 1]), np.cos(roll[k + 1])]
        np.testing.assert_array_equal(u[k], [*ahead, speed[k], np.sin(pitch[k]), np.cos(pitch[k])])
    assert u[0, SPEED_BEFORE] == u[0, SPEED] - 1.0


def test_positions_in_the_plane_leave_the_curved_earth_by_a_second_order_term():
    """Integrating longitude with the running latitude is, in metres at the origin's latitude, east + tan(phi) / R times int N dE."""
    speed, steps, azimuth = 20.0, 12000, np.radians(50.0)
    still = np.zeros(steps + 1)
    x0 = [0, 0, HEIGHT_THERE, speed * np.sin(azimuth), speed * np.cos(azimuth), 0, azimuth, 0, 0]
    u = inputs(still, np.full(steps + 1, speed), still, still, still)
    states = march(made(), x0, u)
    radius = meridian_radius(LATITUDE) + HEIGHT_THERE
    latitude, longitude = LATITUDE, 0.0
    for x in states[1:]:
        latitude += x[V_NORTH] * DT / (meridian_radius(latitude) + HEIGHT_THERE)
        longitude += x[V_EAST] * DT / ((transverse_radius(latitude) + HEIGHT_THERE) * np.cos(latitude))
    plane = geodetic(states[-1], LATITUDE, 0.0, HEIGHT_THERE)
    across = (transverse_radius(LATITUDE) + HEIGHT_THERE) * np.cos(LATITUDE)
    moved = np.sum(states[1:, NORTH] * np.diff(states[:, EAST]))
    assert np.hypot(states[-1, NORTH], states[-1, EAST]) > 11.9e3
    assert (longitude - plane[1]) * across == pytest.approx(np.tan(LATITUDE) / radius * moved, rel=0.01)
    assert abs(latitude - plane[0]) * radius < 0.05


def test_a_metre_is_an_angle_over_the_radius_there():
    latitude, longitude = geodetic(np.array([[100.0, 200.0, 0.0], [0.0, 0.0, 0.0]]), LATITUDE, 1.0, HEIGHT_THERE)
    assert (latitude[1], longitude[1]) == (LATITUDE, 1.0)
    assert (latitude[0] - LATITUDE) * (meridian_radius(LATITUDE) + HEIGHT_THERE) == pytest.approx(100.0, rel=1e-9)
    assert (longitude[0] - 1.0) * (transverse_radius(LATITUDE) + HEIGHT_THERE) * np.cos(LATITUDE) == pytest.approx(200.0, rel=1e-9)


# Bad input.


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
@pytest.mark.parametrize("name", ["dt", "bias_time", "odometer_time"])
def test_a_time_that_is_not_positive_is_refused(name, value):
    given = {"dt": DT, "bias_time": BIAS_TIME, "odometer_time": ODOMETER_TIME} | {name: value}
    with pytest.raises(ValueError, match=f"{name}: found"):
        riss(TOTAL, latitude=LATITUDE, height=0.0, noise=np.zeros(STATES), **given)


@pytest.mark.parametrize("noise", [-np.ones(STATES), np.full(STATES, np.nan), np.full(STATES, np.inf), np.zeros(8), 0.0])
def test_noise_that_is_no_nine_variances_is_refused(noise):
    with pytest.raises(ValueError, match="noise: found"):
        made(noise=noise)


@pytest.mark.parametrize("latitude", [np.pi / 2, 44.23, np.nan])
def test_a_latitude_beyond_the_poles_or_in_degrees_is_refused(latitude):
    with pytest.raises(ValueError, match="latitude: found"):
        riss(TOTAL, DT, latitude, 0.0, np.zeros(STATES), BIAS_TIME, ODOMETER_TIME)


@pytest.mark.parametrize(
    ("time", "row", "found"),
    [
        ([0.0, 0.05, 0.10, 0.25, 0.30], 3, "0.15 s"),
        ([0.0, 0.05, 0.05, 0.10], 2, "0 s"),
        ([0.0, 0.05, 0.10, 0.02], 3, "-0.08 s"),
        ([0.0, np.nan, 0.10], 1, "nan s"),
    ],
)
def test_a_record_with_a_gap_or_a_step_back_is_refused_with_its_row(time, row, found):
    with pytest.raises(InputError, match=rf"drive: time, row {row}: found {found} after the row before, expected 0.05 s"):
        require_regular("drive", np.array(time), 0.05)


def test_a_regular_record_is_taken_whatever_its_rounding():
    require_regular("drive", np.arange(100_000) * 0.05, 0.05)
