"""What an inertial sensor measures: at rest, in a turn, and its Jacobians."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robins.foundation.earth import EARTH_RATE
from robins.kalman.model import linearise_observation, observe, retract
from robins.navigation.inertial_sensor import AUGMENTED, CHANNELS, DIFFERENCE, QUASI_STATIC, inertial_sensor
from robins.navigation.strapdown import (
    ACCELEROMETER_BIAS,
    AUGMENTED_ERRORS,
    BA,
    BG,
    ERRORS,
    FORCE,
    GYRO_BIAS,
    Q0,
    RATE,
    THETA,
    XF,
    XW,
    R,
    V,
    local_earth,
    strapdown,
)

LATITUDE, GRAVITY, DT = np.radians(38.06), 9.80, 0.1
EARTH = local_earth(LATITUDE, GRAVITY)
SEEDS = st.integers(0, 2**32 - 1)
FORMS = {"quasi-static": QUASI_STATIC, "augmented": AUGMENTED, "difference": DIFFERENCE}
NOISE = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])


def errors_of(form):
    return AUGMENTED_ERRORS if form == AUGMENTED else ERRORS


def state(form, seed=None):
    """A random state, or the level one at rest."""
    x = np.zeros(errors_of(form) + 1)
    x[Q0] = 1.0
    if seed is not None:
        rng = np.random.default_rng(seed)
        x[:] = rng.normal(size=x.size)
        x[Q0 : Q0 + 4] = Rotation.random(rng=rng).as_quat(scalar_first=True)
    return x


def attitude(x):
    return Rotation.from_quat(x[Q0 : Q0 + 4], scalar_first=True)


def reading(form, x, u=None, dt=DT):
    z = np.full(CHANNELS, np.nan)
    observe(inertial_sensor(form, dt, EARTH, NOISE), x, np.zeros(12) if u is None else u, z)
    return z


def jacobian(form, x):
    H = np.full((CHANNELS, errors_of(form)), np.nan)
    linearise_observation(inertial_sensor(form, DT, EARTH, NOISE), x, np.zeros(12), H)
    return H


@pytest.mark.parametrize("form", [QUASI_STATIC, AUGMENTED])
def test_a_level_sensor_at_rest_reads_gravity_upwards_and_the_earths_rate(form):
    """Forward is east, so left is north: equation (17) with nothing but reactions."""
    expected = [0.0, 0.0, GRAVITY, 0.0, EARTH_RATE * np.cos(LATITUDE), EARTH_RATE * np.sin(LATITUDE)]
    np.testing.assert_allclose(reading(form, state(form)), expected, rtol=0, atol=1e-15)


def test_a_raised_nose_feels_gravity_forwards():
    x = state(QUASI_STATIC)
    x[Q0 : Q0 + 4] = Rotation.from_euler("y", -0.1).as_quat(scalar_first=True)
    np.testing.assert_allclose(reading(QUASI_STATIC, x)[:3], [GRAVITY * np.sin(0.1), 0.0, GRAVITY * np.cos(0.1)], rtol=0, atol=1e-14)


@given(SEEDS)
def test_the_quasi_static_reading_is_reaction_frame_rate_and_bias(seed):
    """Independent: scipy's rotations."""
    x = state(QUASI_STATIC, seed)
    turned = [attitude(x).inv().apply(v) for v in (-EARTH.gravity, EARTH.rate + EARTH.transport @ x[V : V + 3])]
    np.testing.assert_allclose(reading(QUASI_STATIC, x), np.concatenate(turned) + x[ACCELEROMETER_BIAS:], rtol=0, atol=1e-14)


@given(SEEDS)
def test_transients_add_to_the_reading(seed):
    """Equations (8), (9): the attitude of the force is the one in the middle of the step."""
    x = state(AUGMENTED, seed)
    middle = attitude(x) * Rotation.from_rotvec(-0.5 * DT * x[RATE:])
    force = middle.inv().apply(-EARTH.gravity) + x[FORCE:RATE] + x[ACCELEROMETER_BIAS:GYRO_BIAS]
    rate = attitude(x).inv().apply(EARTH.rate + EARTH.transport @ x[V : V + 3]) + x[RATE:] + x[GYRO_BIAS:FORCE]
    np.testing.assert_allclose(reading(AUGMENTED, x), np.concatenate([force, rate]), rtol=0, atol=2e-14)


@given(SEEDS, st.floats(0.1, 1.0))
def test_in_a_turn_the_augmented_reading_is_the_average_over_the_step(seed, turn):
    """The sample averages; the attitude at the step's end alone would be half a rotation off."""
    x, axis = state(AUGMENTED), np.random.default_rng(seed).normal(size=3)
    x[Q0 : Q0 + 4] = attitude(state(AUGMENTED, seed)).as_quat(scalar_first=True)
    x[RATE:] = turn * axis / np.linalg.norm(axis)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    average = sum(
        0.5 * w * (attitude(x) * Rotation.from_rotvec(-0.5 * DT * (1.0 - node) * x[RATE:])).inv().apply(-EARTH.gravity)
        for node, w in zip(nodes, weights, strict=True)
    )
    angle = turn * DT
    assert np.linalg.norm(reading(AUGMENTED, x)[:3] - average) <= GRAVITY * angle**2 / 24.0 + 1e-14
    across = np.linalg.norm(np.cross(x[RATE:] / turn, attitude(x).inv().apply([0.0, 0.0, 1.0])))
    at_the_end = np.linalg.norm(attitude(x).inv().apply(-EARTH.gravity) - average)
    assert at_the_end == pytest.approx(GRAVITY * across * angle / 2.0, rel=angle)


def test_a_car_in_a_left_turn_feels_a_force_to_the_left():
    """4 m/s, 0.3 rad/s, level: the transients are the centripetal acceleration and the turn."""
    x = state(AUGMENTED)
    x[V], x[FORCE + 1], x[RATE + 2] = 4.0, 1.2, 0.3
    z = reading(AUGMENTED, x)
    np.testing.assert_allclose(z[:3], [0.0, 1.2, GRAVITY], rtol=0, atol=1e-14)
    np.testing.assert_allclose(z[3:], [0.0, 0.0, 0.3], rtol=0, atol=1e-4)


@given(SEEDS)
def test_a_second_sensor_reads_the_driving_one_without_its_bias(seed):
    x, u = state(DIFFERENCE, seed), np.random.default_rng(seed + 1).normal(size=12)
    np.testing.assert_array_equal(reading(DIFFERENCE, x, u), u[6:] - x[ACCELEROMETER_BIAS:])


@pytest.mark.parametrize("name", FORMS)
@given(seed=SEEDS)
def test_h_is_the_jacobian_of_the_reading_on_the_errors(name, seed):
    """A17: central differences on the retraction, but for the velocity, which H leaves out."""
    form = FORMS[name]
    n, x, step = errors_of(form), state(FORMS[name], seed), 1e-6
    model = strapdown(DT, EARTH, np.zeros(n), np.ones(6) if form == AUGMENTED else None)
    H, expected = jacobian(form, x), np.empty((CHANNELS, n))
    for i in range(n):
        ends = []
        for sign in (1.0, -1.0):
            moved = x.copy()
            retract(model, moved, sign * step * np.eye(n)[i])
            ends.append(reading(form, moved))
        expected[:, i] = (ends[0] - ends[1]) / (2.0 * step)
    expected[:, V : V + 3] = 0.0
    np.testing.assert_allclose(H, expected, rtol=1e-6, atol=1e-8)
    if form != DIFFERENCE:  # of the size of the earth's rate: by itself, or it would not be seen
        rate = attitude(x).inv().apply(EARTH.rate + EARTH.transport @ x[V : V + 3])
        np.testing.assert_allclose(H[3:, THETA : THETA + 3], np.cross(np.eye(3), rate), rtol=1e-11, atol=1e-18)


def test_what_h_leaves_out_is_the_transport_rate():
    """1.6e-7 rad/s for each m/s: a thousandth of the gyroscope's noise at the speed of a car."""
    x = state(QUASI_STATIC)
    slow, fast = reading(QUASI_STATIC, x), None
    x[V : V + 3] = [0.0, 10.0, 0.0]
    fast = reading(QUASI_STATIC, x)
    np.testing.assert_array_equal(fast[:3], slow[:3])
    assert 1e-6 < np.abs(fast - slow).max() < 2e-6


@given(SEEDS)
def test_h_has_the_printed_sparsity(seed):
    """Equation (26): ``[0 0 H_aq I 0; 0 0 H_wq 0 I]``; augmented with the same for the transients."""
    eye, zero = np.eye(3), np.zeros((3, 3))
    H = jacobian(QUASI_STATIC, state(QUASI_STATIC, seed))
    assert not H[:, R : V + 3].any() and H[:3, THETA:BA].any() and H[3:, THETA:BA].any()
    np.testing.assert_array_equal(H[:, BA:], np.block([[eye, zero], [zero, eye]]))
    H = jacobian(AUGMENTED, state(AUGMENTED, seed))
    assert not H[:, R : V + 3].any()
    np.testing.assert_array_equal(H[:, BA:XF], np.block([[eye, zero], [zero, eye]]))
    np.testing.assert_array_equal(H[:, XF:XW], np.vstack([eye, zero]))
    np.testing.assert_array_equal(H[3:, XW:], eye)
    H = jacobian(DIFFERENCE, state(DIFFERENCE, seed))
    assert not H[:, :BA].any() and BG == BA + 3
    np.testing.assert_array_equal(H[:, BA:], -np.eye(6))


@pytest.mark.parametrize("name", FORMS)
def test_the_noise_is_independent_and_nothing_else_is_correlated(name):
    sensor = inertial_sensor(FORMS[name], DT, EARTH, NOISE)
    np.testing.assert_array_equal(sensor.R, np.diag(NOISE))
    for correlation in (sensor.C_update, sensor.C_predict):
        assert correlation.shape == (errors_of(FORMS[name]), CHANNELS) and not correlation.any()
    assert sensor.R_fixed.shape == (CHANNELS, CHANNELS) and not sensor.R_fixed.any()
