"""The strapdown mechanisation: against one in earth-fixed axes, what is exact, and its Jacobians."""

import numpy as np
import pymap3d
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from robins.foundation.earth import EARTH_RATE, ECCENTRICITY_SQUARED, SEMI_MAJOR_AXIS, SEMI_MINOR_AXIS
from robins.foundation.rotation import body_rates, quaternion_of_euler, rotate
from robins.kalman.model import linearise, propagate, retract
from robins.navigation.strapdown import (
    ACCELEROMETER_BIAS,
    AUGMENTED_ERRORS,
    AUGMENTED_STATES,
    BA,
    BG,
    ERRORS,
    FORCE,
    GYRO_BIAS,
    Q0,
    RATE,
    STATES,
    THETA,
    XF,
    XW,
    R,
    V,
    local_earth,
    mechanise,
    strapdown,
)

LATITUDE, GRAVITY = np.radians(38.06), 9.80
EARTH = local_earth(LATITUDE, GRAVITY)
SEEDS = st.integers(0, 2**32 - 1)
NO_INPUT = np.zeros(0)
TAU = 50.0


def classical(dt, earth=EARTH, noise=None):
    return strapdown(dt, earth, np.zeros(ERRORS) if noise is None else noise)


def augmented(dt, earth=EARTH, tau=TAU, noise=None, transient=None):
    return strapdown(dt, earth, np.zeros(AUGMENTED_ERRORS) if noise is None else noise, np.ones(6) if transient is None else transient, tau)


def state(seed=None, n=STATES):
    """A random state, or the level one at rest."""
    x = np.zeros(n)
    x[Q0] = 1.0
    if seed is not None:
        rng = np.random.default_rng(seed)
        x[:] = rng.normal(size=n)
        x[Q0 : Q0 + 4] = Rotation.random(rng=rng).as_quat(scalar_first=True)
    return x


def attitude(x):
    return Rotation.from_quat(x[Q0 : Q0 + 4], scalar_first=True)


def cross_matrix(a):
    return np.cross(np.eye(3), a)


def with_attitude(x, rotation):
    x[Q0 : Q0 + 4] = rotation.as_quat(scalar_first=True)
    return x


def stepped(model, x, u=NO_INPUT):
    out = x.copy()
    propagate(model, out, u)
    return out


def at_rest(rotation, earth=EARTH):
    """Reading of an ideal sensor that does not move against the earth."""
    return np.concatenate([rotation.inv().apply(-earth.gravity), rotation.inv().apply(earth.rate)])


# The earth at the origin.


def test_rates_and_curvature_of_the_local_earth():
    """Independent: radii of curvature by pymap3d."""
    north, east = pymap3d.rcurve.meridian(np.degrees(LATITUDE)), pymap3d.rcurve.transverse(np.degrees(LATITUDE))
    velocity = np.array([3.0, -7.0, 2.0])
    expected = [7.0 / north, 3.0 / east, 3.0 * np.tan(LATITUDE) / east]
    np.testing.assert_allclose(EARTH.transport @ velocity, expected, rtol=1e-12)
    np.testing.assert_allclose(EARTH.rate, 7.292115e-5 * np.array([0.0, np.cos(LATITUDE), np.sin(LATITUDE)]), rtol=1e-15)
    np.testing.assert_array_equal(EARTH.gravity, [0.0, 0.0, -GRAVITY])


def test_an_earth_that_does_not_turn_has_neither_rate_nor_transport_rate():
    still = local_earth(LATITUDE, GRAVITY, rotating=False)
    assert not still.rate.any() and not still.transport.any()
    np.testing.assert_array_equal(still.gravity, EARTH.gravity)


# Equations of motion, one step.


@given(SEEDS, st.sampled_from([0.001, 0.1, 1.0]))
def test_velocity_follows_specific_force_coriolis_and_gravity(seed, dt):
    """Equation (4), with the attitude half a step on, by scipy."""
    x, u = state(seed), np.random.default_rng(seed + 1).normal(size=6)
    f, omega = u[:3] - x[ACCELEROMETER_BIAS : ACCELEROMETER_BIAS + 3], u[3:] - x[GYRO_BIAS : GYRO_BIAS + 3]
    v = x[V : V + 3]
    transport = EARTH.transport @ v
    middle = Rotation.from_rotvec(-0.5 * dt * (EARTH.rate + transport)) * attitude(x) * Rotation.from_rotvec(0.5 * dt * omega)
    expected = middle.apply(f) - np.cross(2.0 * EARTH.rate + transport, v) + EARTH.gravity
    moved = stepped(classical(dt), x, u)
    np.testing.assert_allclose(moved[V : V + 3], v + dt * expected, rtol=0, atol=1e-14 * (1 + dt * GRAVITY))


@given(SEEDS, st.booleans())
def test_position_is_the_integral_of_velocity(seed, driven):
    """Equation (3): the trapezoid, which is the integral while the acceleration is constant."""
    n, model = (STATES, classical(0.1)) if driven else (AUGMENTED_STATES, augmented(0.1))
    x, u = state(seed, n), np.random.default_rng(seed).normal(size=6)
    moved = stepped(model, x, u if driven else NO_INPUT)
    np.testing.assert_allclose(moved[R : R + 3], x[R : R + 3] + 0.05 * (x[V : V + 3] + moved[V : V + 3]), rtol=0, atol=1e-14)


def test_free_fall_is_a_parabola():
    model, x = classical(0.5, local_earth(LATITUDE, GRAVITY, rotating=False)), state()
    x[V] = 3.0
    states = np.empty((21, STATES))
    mechanise(model, x, np.zeros((20, 6)), states)
    t = 0.5 * np.arange(21)
    np.testing.assert_allclose(states[:, R : R + 3], np.stack([3.0 * t, 0 * t, -0.5 * GRAVITY * t**2], axis=1), rtol=0, atol=1e-11)


@given(SEEDS)
def test_biases_are_subtracted_from_the_input_and_stay(seed):
    x, u = state(seed), np.random.default_rng(seed + 1).normal(size=6)
    clean = x.copy()
    clean[ACCELEROMETER_BIAS:] = 0.0
    moved, expected = stepped(classical(0.1), x, u), stepped(classical(0.1), clean, u - x[ACCELEROMETER_BIAS:])
    np.testing.assert_array_equal(moved[:ACCELEROMETER_BIAS], expected[:ACCELEROMETER_BIAS])
    np.testing.assert_array_equal(moved[ACCELEROMETER_BIAS:], x[ACCELEROMETER_BIAS:])


@given(SEEDS, st.sampled_from([0.01, 0.1, 1.0]))
def test_a_constant_rate_is_integrated_exactly_by_any_step(seed, dt):
    """``exp(-omega_in t) C exp(omega t)``, by scipy, however long the step: neither coning nor drift."""
    earth, steps = EARTH._replace(transport=np.zeros((3, 3))), 40
    x, omega = with_attitude(state(), attitude(state(seed))), np.random.default_rng(seed + 1).normal(size=3)
    states = np.empty((steps + 1, STATES))
    mechanise(classical(dt, earth), x, np.tile([0.0, 0.0, 0.0, *omega], (steps, 1)), states)
    t = steps * dt
    expected = Rotation.from_rotvec(-t * earth.rate) * attitude(x) * Rotation.from_rotvec(t * omega)
    assert (expected.inv() * attitude(states[-1])).magnitude() < 1e-14 * steps


def test_the_quaternion_keeps_its_length_through_a_long_run():
    """A13: 1e5 steps of a violent drive."""
    rng = np.random.default_rng(2)
    states = np.empty((100_001, STATES))
    mechanise(classical(0.1), state(3), rng.normal(size=(100_000, 6)), states)
    lengths = np.linalg.norm(states[:, Q0 : Q0 + 4], axis=1)
    assert np.abs(lengths - 1.0).max() < 1e-15


# At rest.


def drift_at_rest(model, rotation, seconds=20.0, earth=EARTH, n=STATES):
    """Largest speed, and angle at the end, of a mechanisation fed with what a sensor at rest on `earth` reads."""
    steps = round(seconds / model.dt)
    states = np.empty((steps + 1, n))
    mechanise(model, with_attitude(state(n=n), rotation), np.tile(at_rest(rotation, earth), (steps, 1)), states)
    return np.linalg.norm(states[:, V : V + 3], axis=1).max(), (rotation.inv() * attitude(states[-1])).magnitude()


@given(SEEDS, st.sampled_from([1.0, 0.1, 0.01]))
def test_a_vehicle_at_rest_stays_where_it_is(seed, dt):
    """A5, the sensor as input, at any attitude and step: the angle is a dozen units of the last place a step."""
    speed, angle = drift_at_rest(classical(dt), attitude(state(seed)))
    assert speed < 1e-9 and angle < 3e-15 * 20.0 / dt


def test_a_vehicle_at_rest_stays_without_an_input_too():
    """A5, augmented: without transients nothing moves."""
    x = with_attitude(state(n=AUGMENTED_STATES), attitude(state(5)))
    states = np.empty((201, AUGMENTED_STATES))
    mechanise(augmented(0.1), x, np.zeros((200, 0)), states)
    np.testing.assert_allclose(states, np.tile(x, (201, 1)), rtol=0, atol=1e-15)


def test_negating_the_earth_rate_turns_a_vehicle_at_rest_twice_as_fast():
    """What the tests above and below would see: 2 Omega t, and the speed that comes with the tilt."""
    wrong = EARTH._replace(rate=-EARTH.rate)
    speed, angle = drift_at_rest(classical(0.1, wrong), attitude(state(6)))
    assert angle == pytest.approx(2.0 * EARTH_RATE * 20.0, rel=1e-3)
    assert speed > 0.1


def test_leaving_out_the_earth_rate_turns_the_attitude_by_it():
    """Equation (5) as printed: over the 330 s of the drive, 1.4 degrees about the earth's axis."""
    rotation, printed = attitude(state(7)), local_earth(LATITUDE, GRAVITY, rotating=False)
    _, angle = drift_at_rest(classical(0.1, printed), rotation, seconds=330.0)
    assert angle == pytest.approx(7.292115e-5 * 330.0, rel=1e-10)
    assert np.degrees(angle) == pytest.approx(1.379, abs=1e-3)


# A drive, against a mechanisation in earth-fixed axes.

DURATION = 110.0


def euler_of_time(t):
    """Roll, pitch, yaw of the drive and their rates, each ``(..., 3)``."""
    angles = np.stack([0.2 * np.sin(0.7 * t), 0.1 * np.sin(0.9 * t + 1.0), 0.2 * t + 0.3 * np.sin(0.5 * t)], axis=-1)
    rates = np.stack([0.14 * np.cos(0.7 * t), 0.09 * np.cos(0.9 * t + 1.0), 0.2 + 0.15 * np.cos(0.5 * t)], axis=-1)
    return angles, rates


def sensed(t):
    """Specific force and angular rate ``(..., 6)`` of the drive: 8 m/s to and fro, within 200 m of the origin."""
    euler, rates = euler_of_time(t)
    a, b, c = 2 * np.pi / 60.0, 2 * np.pi / 40.0, 2 * np.pi / 30.0
    acceleration = np.stack([8.0 * a * np.cos(a * t), 6.0 * b * np.cos(b * t), c * np.cos(c * t)], axis=-1)
    q = quaternion_of_euler(euler) * np.array([1.0, -1.0, -1.0, -1.0])
    return np.concatenate([rotate(q, acceleration - EARTH.gravity), body_rates(euler, rates) + rotate(q, EARTH.rate + 0 * rates)], axis=-1)


def averages(dt):
    """Averages of `sensed` over the steps, by Gauss-Legendre quadrature with five points."""
    nodes, weights = np.polynomial.legendre.leggauss(5)
    start = dt * np.arange(round(DURATION / dt))
    return sum(0.5 * w * sensed(start + 0.5 * dt * (1.0 + node)) for node, w in zip(nodes, weights, strict=True))


def geodetic(r):
    """Latitude and longitude (rad) of earth-fixed coordinates (Bowring's formula)."""
    p, second = np.hypot(r[0], r[1]), ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED)
    beta = np.arctan2(r[2] * SEMI_MAJOR_AXIS, p * SEMI_MINOR_AXIS)
    top, bottom = r[2] + second * SEMI_MINOR_AXIS * np.sin(beta) ** 3, p - ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS * np.cos(beta) ** 3
    return np.arctan2(top, bottom), np.arctan2(r[1], r[0])


def to_local(latitude, longitude):
    """Matrix ``(3, 3)`` from earth-fixed to east-north-up axes."""
    sin_lat, cos_lat, sin_lon, cos_lon = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    return np.array(
        [[-sin_lon, cos_lon, 0.0], [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat], [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat]]
    )


def earth_fixed_drive():
    """Independent formulation: position, velocity, attitude against the earth in earth-fixed axes; gravity along the local vertical.

    Neither the transport rate nor radii of curvature appear in it; they are in the ellipsoid. Solved by scipy.

    Returns
    -------
    position, velocity : ndarray, shape (3,)
        The integral of the local velocity, and the local velocity.
    rotation : Rotation
        Body to local axes.
    """
    start = np.array(pymap3d.geodetic2ecef(np.degrees(LATITUDE), 0.0, 0.0))
    omega_e = np.array([0.0, 0.0, EARTH_RATE])
    C0 = Rotation.from_matrix(to_local(LATITUDE, 0.0).T) * Rotation.from_quat(quaternion_of_euler(euler_of_time(0.0)[0]), scalar_first=True)

    def derivative(t, y):
        C_en = to_local(*geodetic(start + y[:3]))
        v, q, u = y[3:6], y[6:10] / np.linalg.norm(y[6:10]), sensed(t)
        acceleration = rotate(q, u[:3]) - 2.0 * np.cross(omega_e, v) - GRAVITY * C_en[2]
        p = u[3:] - rotate(q * np.array([1.0, -1.0, -1.0, -1.0]), omega_e)
        turning = 0.5 * np.array([-q[1:] @ p, *(q[0] * p + np.cross(q[1:], p))])
        return np.concatenate([v, acceleration, turning, C_en @ v])

    y0 = np.concatenate([np.zeros(6), C0.as_quat(scalar_first=True), np.zeros(3)])
    y = solve_ivp(derivative, (0.0, DURATION), y0, method="DOP853", rtol=1e-9, atol=1e-11).y[:, -1]
    C_en = to_local(*geodetic(start + y[:3]))
    return y[10:], C_en @ y[3:6], Rotation.from_matrix(C_en) * Rotation.from_quat(y[6:10], scalar_first=True)


@pytest.fixture(scope="module")
def drive():
    return earth_fixed_drive()


def mechanised_drive(dt, earth=EARTH):
    """The state at the end of the drive."""
    u = averages(dt)
    states = np.empty((len(u) + 1, STATES))
    x = state()
    x[Q0 : Q0 + 4] = quaternion_of_euler(euler_of_time(0.0)[0])
    mechanise(classical(dt, earth), x, u, states)
    return states[-1]


def difference(x, drive):
    """Position, velocity and attitude of `x` less those of the drive."""
    position, velocity, rotation = drive
    return np.concatenate([x[R : R + 3] - position, x[V : V + 3] - velocity, (rotation.inv() * attitude(x)).as_rotvec()])


def extrapolated(drive, dt, earth=EARTH):
    """`difference` without the part that falls with the square of the step."""
    return (4.0 * difference(mechanised_drive(dt / 2, earth), drive) - difference(mechanised_drive(dt, earth), drive)) / 3.0


LATITUDE_RANGE = 200.0 / 6.35e6
"""Within 200 m the true latitude differs from the origin's by this; so do, relatively, the earth rate's components."""
TILT = EARTH_RATE * LATITUDE_RANGE * DURATION
BOUNDS = np.repeat([GRAVITY * TILT * DURATION**2 / 6.0, GRAVITY * TILT * DURATION / 2.0, TILT], 3)
"""What the constant latitude of local coordinates can do to position (m), velocity and attitude: millimetres, 1e-4 m/s, 3e-7 rad."""


def test_a_drive_of_minutes_is_that_of_an_earth_fixed_mechanisation(drive):
    assert np.linalg.norm(drive[0]) > 20.0 and np.linalg.norm(drive[1]) > 3.0
    np.testing.assert_array_less(np.abs(extrapolated(drive, 0.004)), BOUNDS)


def test_the_step_of_the_mechanisation_has_second_order(drive):
    coarse, middle, fine = (mechanised_drive(dt) for dt in (0.04, 0.02, 0.01))
    ratio = np.linalg.norm((coarse - middle)[R : R + 6]) / np.linalg.norm((middle - fine)[R : R + 6])
    assert ratio == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("part", ["rate", "transport"])
def test_the_drive_sees_a_wrong_sign_of_the_earths_and_of_the_transport_rate(drive, part):
    wrong = EARTH._replace(**{part: -getattr(EARTH, part)})
    assert np.any(np.abs(extrapolated(drive, 0.004, wrong)) > 10.0 * BOUNDS)


# Transients.


def test_a_transient_decays_with_its_time_constant():
    """Equation (7), with the minus that the text asks for."""
    x = state(8, AUGMENTED_STATES)
    states = np.empty((501, AUGMENTED_STATES))
    mechanise(augmented(0.1), x, np.zeros((500, 0)), states)
    np.testing.assert_allclose(states[-1, FORCE:], x[FORCE:] * np.exp(-1.0), rtol=1e-12)


def test_a_transient_as_printed_grows_without_end():
    """Equation (7) with plus is a negative time constant: e^(t / tau), 735 times in the 330 s of the drive."""
    x = state(8, AUGMENTED_STATES)
    states = np.empty((3301, AUGMENTED_STATES))
    mechanise(augmented(0.1, tau=-TAU), x, np.zeros((3300, 0)), states)
    np.testing.assert_allclose(states[-1, FORCE:], x[FORCE:] * np.exp(330.0 / TAU), rtol=1e-9)
    assert np.exp(330.0 / TAU) > 700.0


def test_transients_without_a_time_constant_stay():
    x = state(9, AUGMENTED_STATES)
    model = strapdown(0.1, EARTH, np.zeros(AUGMENTED_ERRORS), np.ones(6))
    np.testing.assert_array_equal(stepped(model, x)[FORCE:], x[FORCE:])


@given(SEEDS)
def test_transients_add_to_specific_force_and_rate(seed):
    """Equations (8), (9): driven by reaction, frame rate and the new transients, the other form makes the same step."""
    dt = 0.1
    x = state(seed, AUGMENTED_STATES)
    model = augmented(dt)
    force, rate = model.decay * x[FORCE : FORCE + 3], model.decay * x[RATE : RATE + 3]
    omega_in = EARTH.rate + EARTH.transport @ x[V : V + 3]
    omega = attitude(x).inv().apply(omega_in) + rate
    middle = Rotation.from_rotvec(-0.5 * dt * omega_in) * attitude(x) * Rotation.from_rotvec(0.5 * dt * omega)
    driven = x[:STATES].copy()
    driven[ACCELEROMETER_BIAS:] = 0.0
    driven = stepped(classical(dt), driven, np.concatenate([middle.inv().apply(-EARTH.gravity) + force, omega]))
    moved = stepped(model, x)
    both = dt**2 * np.linalg.norm(omega_in) * np.linalg.norm(rate)  # rotations in different axes do not commute
    assert (attitude(driven).inv() * attitude(moved)).magnitude() < both + 1e-15
    np.testing.assert_allclose(moved[: V + 3], driven[: V + 3], rtol=0, atol=dt * both * (1 + np.linalg.norm(force)) + 1e-13)


# Error state.


def error_between(x, reference):
    """The error that leads from `reference` to `x`."""
    turn = (attitude(reference).inv() * attitude(x)).as_rotvec()
    rest = x - reference
    return np.concatenate([rest[: V + 3], turn, rest[ACCELEROMETER_BIAS:]])


@pytest.mark.parametrize("n", [ERRORS, AUGMENTED_ERRORS])
@given(seed=SEEDS)
def test_an_error_is_applied_in_body_axes_and_comes_back(n, seed):
    model = classical(0.1) if n == ERRORS else augmented(0.1)
    x, error = state(seed, n + 1), np.random.default_rng(seed + 1).uniform(-1.0, 1.0, n)
    moved = x.copy()
    retract(model, moved, error)
    np.testing.assert_allclose(error_between(moved, x), error, rtol=0, atol=1e-14)
    assert abs(np.linalg.norm(moved[Q0 : Q0 + 4]) - 1.0) < 4e-16


def differences(move, model, x, steps):
    """Jacobian of `move` at `x` by central differences along the error's axes, with these `steps`."""
    columns, centre = [], move(x)
    for i, step in enumerate(steps):
        ends = []
        for sign in (1.0, -1.0):
            moved = x.copy()
            retract(model, moved, sign * step * np.eye(len(steps))[i])
            ends.append(error_between(move(moved), centre))
        columns.append((ends[0] - ends[1]) / (2.0 * step))
    return np.array(columns).T


@pytest.mark.parametrize("n", [ERRORS, AUGMENTED_ERRORS])
@given(seed=SEEDS)
def test_f_is_the_jacobian_of_the_step_on_the_errors(n, seed):
    """A17. The step in velocity is long because the transport rate is so slow; the dependence on it is quadratic at most."""
    model = classical(0.1) if n == ERRORS else augmented(0.1)
    x, u = state(seed, n + 1), 3.0 * np.random.default_rng(seed + 1).normal(size=6)
    F, Q = np.empty((n, n)), np.empty((n, n))
    linearise(model, x, u, F, Q)
    steps = np.full(n, 1e-6)
    steps[V : V + 3] = 1e3
    expected = differences(lambda y: stepped(model, y, u), model, x, steps)
    np.testing.assert_allclose(F, expected, rtol=1e-6, atol=3e-9 * (1 + np.linalg.norm(u)))
    if n == ERRORS:  # 1e-8: by itself, or it would not be seen
        block = slice(THETA, THETA + 3), slice(V, V + 3)
        np.testing.assert_allclose(F[block], expected[block], rtol=1e-4, atol=1e-13)


def test_without_rotation_f_is_one_plus_the_jacobian_of_the_text_books():
    """First order in dt: A_rv = I, A_vtheta = -C [f x], A_vba = -C, A_thetatheta = -[omega x], A_thetabg = -I."""
    dt, earth = 1e-5, local_earth(LATITUDE, GRAVITY, rotating=False)
    x, u = state(10), np.random.default_rng(10).normal(size=6)
    f, omega = u[:3] - x[ACCELEROMETER_BIAS:GYRO_BIAS], u[3:] - x[GYRO_BIAS:]
    A, C, eye = np.zeros((ERRORS, ERRORS)), attitude(x).as_matrix(), np.eye(3)
    A[R : R + 3, V : V + 3], A[V : V + 3, THETA : THETA + 3], A[V : V + 3, BA : BA + 3] = eye, -C @ cross_matrix(f), -C
    A[THETA : THETA + 3, THETA : THETA + 3], A[THETA : THETA + 3, BG : BG + 3] = -cross_matrix(omega), -eye
    F, Q = np.empty((ERRORS, ERRORS)), np.empty((ERRORS, ERRORS))
    linearise(classical(dt, earth), x, u, F, Q)
    np.testing.assert_allclose((F - np.eye(ERRORS)) / dt, A, rtol=0, atol=1e-4)


def test_independent_noise_is_on_the_diagonal():
    noise = np.arange(1.0, ERRORS + 1)
    F, Q = np.empty((ERRORS, ERRORS)), np.empty((ERRORS, ERRORS))
    linearise(classical(0.1, noise=noise), state(11), np.ones(6), F, Q)
    np.testing.assert_array_equal(Q, np.diag(noise))


@given(SEEDS)
def test_a_transients_noise_enters_what_the_new_transient_moves(seed):
    """Q by central differences of the step with respect to w in ``x(k+1) = phi x(k) + w(k)``."""
    rng = np.random.default_rng(seed)
    noise, variance = rng.uniform(0.0, 1.0, AUGMENTED_ERRORS), rng.uniform(0.1, 2.0, 6)
    model, x = augmented(0.1, noise=noise, transient=variance), state(seed, AUGMENTED_STATES)
    F, Q = np.empty((AUGMENTED_ERRORS, AUGMENTED_ERRORS)), np.empty((AUGMENTED_ERRORS, AUGMENTED_ERRORS))
    linearise(model, x, NO_INPUT, F, Q)
    columns = []
    for i in range(6):
        w = np.zeros(AUGMENTED_STATES)
        w[FORCE + i] = 1e-5
        ends = [stepped(model, x + sign * w / model.decay) for sign in (1.0, -1.0)]
        centre = stepped(model, x)
        columns.append((error_between(ends[0], centre) - error_between(ends[1], centre)) / 2e-5)
    G = np.array(columns).T
    np.testing.assert_allclose(G[XF:], np.eye(6), rtol=0, atol=1e-9)
    np.testing.assert_allclose(Q, np.diag(noise) + G @ np.diag(variance) @ G.T, rtol=0, atol=1e-8)
    np.testing.assert_array_equal(Q, Q.T)


def test_the_coupled_noise_is_the_spread_of_many_steps():
    """Monte-Carlo: velocity and attitude move with the transient's noise, and by as much."""
    variance = np.array([0.158, 0.158, 0.038, 0.0063, 0.0063, 0.03]) ** 2
    model, x = augmented(0.1, transient=variance), state(12, AUGMENTED_STATES)
    F, Q = np.empty((AUGMENTED_ERRORS, AUGMENTED_ERRORS)), np.empty((AUGMENTED_ERRORS, AUGMENTED_ERRORS))
    linearise(model, x, NO_INPUT, F, Q)
    rng, centre, draws = np.random.default_rng(12), stepped(model, x), 10_000
    errors = np.empty((draws, AUGMENTED_ERRORS))
    for error in errors:
        moved = x.copy()
        moved[FORCE:] += np.sqrt(variance) * rng.standard_normal(6) / model.decay
        propagate(model, moved, NO_INPUT)
        error[:] = error_between(moved, centre)
    moving = np.r_[V : THETA + 3, XF : XW + 3]
    scale = np.sqrt(np.diag(Q)[moving])
    seen, expected = (M[np.ix_(moving, moving)] / np.outer(scale, scale) for M in (errors.T @ errors / draws, Q))
    np.testing.assert_allclose(seen, expected, rtol=0, atol=5.0 * np.sqrt(2.0 / draws))
    assert np.abs(expected - np.diag(np.diag(expected))).max() > 0.9  # coupled indeed


# The printed Jacobian.


def quaternion_right(omega):
    """``q' = Omega(omega) q / 2``."""
    a, b, c = omega
    return np.array([[0.0, -a, -b, -c], [a, 0.0, c, -b], [b, -c, 0.0, a], [c, b, -a, 0.0]])


def printed_jacobian(x, u):
    """Equation (21), signs and transposes as it takes to make sense; state [r v q b_a b_g], 16 numbers."""
    A, q = np.zeros((STATES, STATES)), x[Q0 : Q0 + 4]
    a, omega, C = u[:3] - x[ACCELEROMETER_BIAS:GYRO_BIAS], u[3:] - x[GYRO_BIAS:], attitude(x).as_matrix()
    A[:3, V : V + 3] = np.eye(3)
    A[V : V + 3, V : V + 3] = -2.0 * C @ cross_matrix(omega)
    for i in range(4):  # C is homogeneous of degree two in q
        q_plus, q_minus = q + 1e-6 * np.eye(4)[i], q - 1e-6 * np.eye(4)[i]
        turned = [rotate(p / np.linalg.norm(p), a) * (p @ p) for p in (q_plus, q_minus)]
        A[V : V + 3, Q0 + i] = (turned[0] - turned[1]) / 2e-6
    A[V : V + 3, ACCELEROMETER_BIAS:GYRO_BIAS] = -C
    A[V : V + 3, GYRO_BIAS:] = -2.0 * C @ cross_matrix(x[V : V + 3])
    A[Q0 : Q0 + 4, Q0 : Q0 + 4] = 0.5 * quaternion_right(omega)
    A[Q0 : Q0 + 4, GYRO_BIAS:] = -0.5 * np.array([[-q[1], -q[2], -q[3]], [q[0], -q[3], q[2]], [q[3], q[0], -q[1]], [-q[2], q[1], q[0]]])
    return A


def test_the_printed_jacobian_is_a_rate_and_as_a_transition_forgets_state_and_covariance():
    """Equation (21) in (20): r becomes v, and what was known of velocity and biases is gone after one step, whatever dt."""
    x, u = state(13), np.random.default_rng(13).normal(size=6)
    x[GYRO_BIAS:], u[3:] = 0.0, 0.0  # no rate: its Coriolis term vanishes as well
    A, P = printed_jacobian(x, u), np.diag(np.arange(1.0, STATES + 1))
    np.testing.assert_array_equal((A @ x)[:3], x[V : V + 3])
    predicted = A @ P @ A.T
    np.testing.assert_array_equal(predicted[:3, :3], P[V : V + 3, V : V + 3])  # the velocity's, in m^2
    assert not predicted[ACCELEROMETER_BIAS:].any()  # the biases are known perfectly
    other = P.copy()
    other[V : V + 3, V : V + 3] *= 100.0
    np.testing.assert_array_equal((A @ other @ A.T)[V : V + 3, V : V + 3], predicted[V : V + 3, V : V + 3])  # no memory of P_vv
    F, Q, errors = np.empty((ERRORS, ERRORS)), np.empty((ERRORS, ERRORS)), np.diag(np.arange(1.0, ERRORS + 1))
    linearise(classical(0.1), x, u, F, Q)
    right = F @ errors @ F.T
    np.testing.assert_array_equal(right[BA:, BA:], errors[BA:, BA:])
    assert np.all(np.diag(right)[R:THETA] > np.diag(errors)[R:THETA])


# Making a model.


@pytest.mark.parametrize("transient", [None, np.ones(6)])
def test_noise_of_another_length_is_refused(transient):
    right, wrong = (ERRORS, AUGMENTED_ERRORS) if transient is None else (AUGMENTED_ERRORS, ERRORS)
    assert strapdown(0.1, EARTH, np.ones(right), transient, 1.0).augmented == (transient is not None)
    with pytest.raises(ValueError, match=rf"^the process noise has shape \({wrong},\), not \({right},\)$"):
        strapdown(0.1, EARTH, np.ones(wrong), transient, 1.0)


def test_a_model_owns_its_noise():
    noise = np.ones(ERRORS)
    model = classical(0.1, noise=noise)
    noise[:] = 7.0
    np.testing.assert_array_equal(model.noise, 1.0)


def test_a_record_of_states_begins_with_the_initial_one():
    x, states = state(14), np.empty((4, STATES))
    before = x.copy()
    u = np.random.default_rng(14).normal(size=(3, 6))
    mechanise(classical(0.1), x, u, states)
    np.testing.assert_array_equal(states[0], before)
    np.testing.assert_array_equal(x, before)
    for k in range(3):
        np.testing.assert_allclose(states[k + 1], stepped(classical(0.1), states[k], u[k]), rtol=1e-15)
