"""Rotations, against scipy's and against series and finite differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from robins.foundation.rotation import (
    SMALL_ANGLE,
    body_rates,
    conjugate,
    dcm,
    dcm_exponential,
    euler_of_quaternion,
    euler_rates,
    normalise,
    quaternion_exponential,
    quaternion_of_euler,
    quaternion_product,
    right_jacobian,
    rotate,
    wrapped,
)

SEEDS = st.integers(0, 2**32 - 1)
ANGLES = st.one_of(st.floats(0.0, 3.1), st.floats(-12.0, -2.0).map(lambda power: 10.0**power), st.sampled_from([0.0, SMALL_ANGLE]))
"""Rotation angles: of any size, very small ones, and where a series takes over."""
ROUNDING = {"rtol": 0, "atol": 4e-16}


def direction(rng):
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


def random_quaternion(seed):
    return Rotation.random(rng=np.random.default_rng(seed)).as_quat(scalar_first=True)


def filled(kernel, *arguments, shape):
    """What `kernel` writes into an array of `shape`."""
    out = np.full(shape, np.nan)
    kernel(*arguments, out)
    return out


def cross_matrix(a):
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def euler_angles(seed):
    """Roll, pitch, yaw; the pitch stays 6 degrees away from where roll and yaw are one."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, 3) * [3.1, 1.46, 3.1]


@given(SEEDS, SEEDS)
def test_the_product_of_quaternions_is_the_product_of_their_rotations(one, other):
    p, q = random_quaternion(one), random_quaternion(other)
    product = filled(quaternion_product, p, q, shape=4)
    expected = Rotation.from_quat(p, scalar_first=True) * Rotation.from_quat(q, scalar_first=True)
    np.testing.assert_allclose(filled(dcm, product, shape=(3, 3)), expected.as_matrix(), rtol=0, atol=2e-15)
    for factor in (p, q):  # the result may take the place of either factor
        p_again, q_again = p.copy(), q.copy()
        target = p_again if factor is p else q_again
        quaternion_product(p_again, q_again, target)
        np.testing.assert_array_equal(target, product)


@given(SEEDS)
def test_the_matrix_of_a_quaternion_is_that_of_scipy(seed):
    q = random_quaternion(seed)
    np.testing.assert_allclose(filled(dcm, q, shape=(3, 3)), Rotation.from_quat(q, scalar_first=True).as_matrix(), rtol=0, atol=1e-15)


@given(SEEDS, ANGLES, st.sampled_from([1.0, -1.0, 0.25, -3.0]))
def test_exponentials_are_those_of_scipy_for_any_angle_however_small(seed, angle, scale):
    vector = angle * direction(np.random.default_rng(seed))
    expected = Rotation.from_rotvec(scale * vector)
    matrix, q = filled(dcm_exponential, vector, scale, shape=(3, 3)), filled(quaternion_exponential, vector, scale, shape=4)
    np.testing.assert_allclose(matrix, expected.as_matrix(), rtol=0, atol=2e-15)
    np.testing.assert_allclose(filled(dcm, q, shape=(3, 3)), expected.as_matrix(), rtol=0, atol=2e-15)
    assert abs(np.linalg.norm(q) - 1.0) < 4e-16


@given(SEEDS, st.floats(-12.0, -3.0))
def test_a_small_rotation_keeps_all_digits_of_its_vector(seed, power):
    """Twice the vector part of the quaternion and the skew part of the matrix, to third order."""
    vector = 10.0**power * direction(np.random.default_rng(seed))
    third_order = 1.0 - vector @ vector / 24.0, 1.0 - vector @ vector / 6.0
    q, C = filled(quaternion_exponential, vector, 1.0, shape=4), filled(dcm_exponential, vector, 1.0, shape=(3, 3))
    size = np.linalg.norm(vector)
    np.testing.assert_allclose(2.0 * q[1:], third_order[0] * vector, rtol=0, atol=1e-13 * size)
    skew = 0.5 * np.array([C[2, 1] - C[1, 2], C[0, 2] - C[2, 0], C[1, 0] - C[0, 1]])
    np.testing.assert_allclose(skew, third_order[1] * vector, rtol=0, atol=1e-13 * size)


@given(SEEDS, ANGLES)
def test_the_right_jacobian_is_its_power_series(seed, angle):
    """``sum (-[a x])^k / (k + 1)!``, to rounding at every angle: also next to where the kernel changes its formula."""
    vector = angle * direction(np.random.default_rng(seed))
    for factor in (1.0, 0.999, 1.001, -0.5):
        term, expected = np.eye(3), np.eye(3)
        for k in range(1, 40):
            term = term @ -cross_matrix(factor * vector) / (k + 1)
            expected = expected + term
        np.testing.assert_allclose(filled(right_jacobian, vector, factor, shape=(3, 3)), expected, rtol=0, atol=4e-15)


@given(SEEDS, st.sampled_from([1e-9, 5e-5, 1.5e-4, 0.1, 1.0, 3.0]))
def test_the_right_jacobian_is_the_finite_difference_of_the_exponential(seed, angle):
    vector, step = angle * direction(np.random.default_rng(seed)), 1e-5
    back = Rotation.from_rotvec(vector).inv()
    moved = [
        (back * Rotation.from_rotvec(vector + step * e)).as_rotvec() - (back * Rotation.from_rotvec(vector - step * e)).as_rotvec()
        for e in np.eye(3)
    ]
    np.testing.assert_allclose(filled(right_jacobian, vector, 1.0, shape=(3, 3)), np.array(moved).T / (2 * step), rtol=0, atol=1e-9)


def test_normalising_changes_the_length_only():
    q = np.array([3.0, -1.0, 2.0, 0.5])
    expected = q / np.linalg.norm(q)
    normalise(q)
    np.testing.assert_allclose(q, expected, **ROUNDING)
    assert abs(q @ q - 1.0) < 4e-16


@given(SEEDS)
def test_euler_angles_make_the_matrix_of_yaw_pitch_and_roll_in_turn(seed):
    roll, pitch, yaw = euler = euler_angles(seed)
    about = [Rotation.from_rotvec(angle * axis).as_matrix() for angle, axis in zip(euler, np.eye(3), strict=True)]
    matrix = filled(dcm, quaternion_of_euler(euler), shape=(3, 3))
    np.testing.assert_allclose(matrix, about[2] @ about[1] @ about[0], rtol=0, atol=2e-15)


@given(SEEDS)
def test_euler_angles_come_back_from_their_quaternion(seed):
    """Of either sign: q and -q are one rotation."""
    euler = euler_angles(seed)
    q = quaternion_of_euler(euler)
    for sign in (1.0, -1.0):
        np.testing.assert_allclose(euler_of_quaternion(sign * q), euler, rtol=0, atol=5e-14)


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2])
def test_a_vertical_nose_has_its_pitch_and_no_complaint(pitch):
    assert euler_of_quaternion(quaternion_of_euler(np.array([0.0, pitch, 0.3])))[1] == pytest.approx(pitch, abs=1e-7)


def test_signs_of_the_angles_in_forward_left_up_axes():
    """A raised nose is a negative pitch, a car that turns left yaws positively, a right side that goes down is a positive roll."""
    nose, left, up = np.eye(3)
    assert rotate(quaternion_of_euler(np.array([0.0, -0.1, 0.0])), nose)[2] > 0.0
    assert rotate(quaternion_of_euler(np.array([0.0, 0.0, 0.1])), nose)[1] > 0.0
    assert rotate(quaternion_of_euler(np.array([0.1, 0.0, 0.0])), -left)[2] < 0.0
    np.testing.assert_allclose(rotate(quaternion_of_euler(np.zeros(3)), up), up, **ROUNDING)


@given(SEEDS)
def test_vectors_turn_as_by_the_matrix_and_back_by_the_conjugate(seed):
    q, v = random_quaternion(seed), np.random.default_rng(seed).normal(size=3)
    turned = rotate(q, v)
    np.testing.assert_allclose(turned, Rotation.from_quat(q, scalar_first=True).apply(v), rtol=0, atol=4e-15)
    np.testing.assert_allclose(rotate(conjugate(q), turned), v, rtol=0, atol=4e-15)


def test_records_of_any_shape_are_turned_element_by_element():
    rng = np.random.default_rng(3)
    euler, vectors = rng.uniform(-1.4, 1.4, (2, 5, 3)), rng.normal(size=(2, 5, 3))
    q = quaternion_of_euler(euler)
    assert q.shape == (2, 5, 4) and euler_of_quaternion(q).shape == (2, 5, 3)
    np.testing.assert_allclose(euler_of_quaternion(q), euler, rtol=0, atol=1e-14)
    for run in range(2):
        for k in range(5):
            np.testing.assert_allclose(q[run, k], quaternion_of_euler(euler[run, k]), **ROUNDING)
            np.testing.assert_allclose(rotate(q, vectors)[run, k], rotate(q[run, k], vectors[run, k]), rtol=0, atol=1e-15)
            rates = euler_rates(euler[run, k], vectors[run, k])
            np.testing.assert_allclose(euler_rates(euler, vectors)[run, k], rates, rtol=1e-15)


@given(SEEDS)
def test_euler_rates_and_body_rates_are_inverse_to_each_other(seed):
    euler, rates = euler_angles(seed), np.random.default_rng(seed + 1).normal(size=3)
    np.testing.assert_allclose(euler_rates(euler, body_rates(euler, rates)), rates, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(body_rates(euler, euler_rates(euler, rates)), rates, rtol=1e-13, atol=1e-13)


@given(SEEDS)
def test_body_rates_are_those_of_the_turning_matrix(seed):
    """``C^T C' = [omega x]``, by central differences."""
    euler, rates, step = euler_angles(seed), np.random.default_rng(seed + 1).normal(size=3), 1e-6
    before, now, after = (Rotation.from_quat(quaternion_of_euler(euler + k * step * rates), scalar_first=True) for k in (-1, 0, 1))
    omega = ((now.inv() * after).as_rotvec() - (now.inv() * before).as_rotvec()) / (2 * step)
    np.testing.assert_allclose(body_rates(euler, rates), omega, rtol=0, atol=1e-8)


def test_quaternion_kinematics_and_euler_rates_describe_one_motion():
    """``q' = q [0 omega] / 2`` beside ``euler' = euler_rates``, integrated side by side over ten seconds."""
    start = np.array([0.2, -0.3, 2.5])

    def omega(t):
        return np.array([0.3 * np.sin(t), 0.2 * np.cos(1.3 * t), 0.5])

    def both(t, state):
        derivative = filled(quaternion_product, state[:4], np.array([0.0, *(0.5 * omega(t))]), shape=4)
        return np.concatenate([derivative, euler_rates(state[4:], omega(t))])

    y0 = np.concatenate([quaternion_of_euler(start), start])
    end = solve_ivp(both, (0.0, 10.0), y0, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    assert np.abs(end[5]) < 1.2  # away from the vertical
    np.testing.assert_allclose(euler_of_quaternion(end[:4]), wrapped(end[4:]), rtol=0, atol=1e-10)


@given(st.floats(-50.0, 50.0))
def test_wrapped_angles_differ_by_whole_turns_and_lie_in_one(angle):
    turned = wrapped(angle)
    assert -np.pi <= turned < np.pi
    assert (angle - turned) / (2 * np.pi) == pytest.approx(round((angle - turned) / (2 * np.pi)), abs=1e-14)


def test_half_a_turn_is_wrapped_to_its_lower_end():
    np.testing.assert_array_equal(wrapped(np.array([np.pi, -np.pi])), -np.pi)
