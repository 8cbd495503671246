"""The three formulations: their states and noises, what drives and what is compared, and what comparing a sample with itself does."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import njit
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from robins.foundation.earth import EARTH_RATE
from robins.kalman import extension
from robins.kalman.model import linearise, linearise_observation, observe, propagate, retract
from robins.kalman.update import update_error, workspace
from robins.navigation.strapdown import ACCELEROMETER_BIAS, BA, BG, FORCE, GYRO_BIAS, Q0, RATE, THETA, XF, R, V
from robins.papers.imani2026.as_printed import printed_jacobian
from robins.papers.imani2026.drive import GRAVITY, LATITUDE
from robins.papers.imani2026.formulations import (
    DEFAULT_PROCESS,
    FORMULATIONS,
    PROCESSES,
    TIME_CONSTANT,
    TRANSIENT_STEP,
    controls,
    formulation,
    initial_states,
    process_noise,
    readings,
    transient_noise,
    true_bias,
)
from robins.papers.imani2026.sensors import Sensors

EARTH_N = EARTH_RATE * np.array([0.0, np.cos(LATITUDE), np.sin(LATITUDE)])
GRAVITY_N = np.array([0.0, 0.0, -GRAVITY])
DT = 0.1
IN_MOTION = (30, 560, 1050, 1400, 1760, 2370)
"""Epochs of the drive: at rest, in curves and on slopes."""


def size(name):
    return 21 if name == "F1" else 15


def cross_matrix(a):
    return np.cross(np.eye(3), a)


def attitude(x):
    return Rotation.from_quat(x[Q0 : Q0 + 4], scalar_first=True)


def true_state(name, driven, k):
    """The truth at epoch k as a state; in F1 with the transients of the interval that ends there."""
    x = np.concatenate([driven.position[k], driven.velocity_n[k], driven.quaternion[k], np.zeros(6)])
    if name != "F1":
        return x
    before = Rotation.from_quat(driven.quaternion[k - 1], scalar_first=True)
    turned = (before.inv() * attitude(x)).as_rotvec() / DT
    pushed = (before * Rotation.from_rotvec(0.5 * DT * turned)).inv().apply(driven.acceleration_n_interval[k - 1])
    return np.concatenate([x, pushed, turned])


def jacobians(form, x, u):
    n = len(form.P0)
    F, Q, H = np.empty((n, n)), np.empty((n, n)), np.empty((6, n))
    linearise(form.model, x, u, F, Q)
    linearise_observation(form.sensor, x, u, H)
    return F, Q, H


# States and noises.


@pytest.mark.parametrize("name", FORMULATIONS)
def test_each_formulation_has_the_states_that_it_says(journey, name):
    """(15): fifteen errors and sixteen numbers; F1 has transient force and rate beside them, which start at zero."""
    trip = journey(2)
    form, x0 = formulation(name, 10, Sensors()), initial_states(name, trip.case.driven, trip.measured)
    assert form.P0.shape == (size(name), size(name)) and x0.shape == (2, size(name) + 1)
    np.testing.assert_array_equal(np.delete(x0, np.s_[Q0 : Q0 + 4], axis=1), 0.0)
    tilt, yaw = np.radians(0.05), np.radians(0.6)
    bias = [0.03] * 3 + [0.003] * 3 if name == "F2" else [2e-3] * 3 + [4e-5] * 3
    sd = [0.01] * 6 + [tilt, tilt, yaw, *bias] + ([0.01] * 3 + [0.001] * 3 if name == "F1" else [])
    np.testing.assert_allclose(form.P0, np.diag(np.square(sd)), rtol=1e-12)
    for run in range(2):  # true C = estimated C exp([d x])
        true = attitude(x0[run]) * Rotation.from_rotvec(trip.measured.attitude_error[run])
        np.testing.assert_allclose(true.as_quat(scalar_first=True), trip.case.driven.quaternion[0], rtol=0, atol=1e-15)


@pytest.mark.parametrize("name", FORMULATIONS)
def test_process_noise_enters_the_states_that_q_gives_it(journey, name):
    """(10), (11): none enters the position by itself; in F1 the transients' noise moves velocity and attitude with them."""
    driven = journey().case.driven
    form = formulation(name, 10, Sensors())
    x = true_state(name, driven, IN_MOTION[2])
    F, Q, _ = jacobians(form, x, readings(name, journey().measured)[0, IN_MOTION[2] + 1])
    own = np.concatenate([process_noise(DEFAULT_PROCESS[name], DT), np.zeros(size(name) - 15)])
    assert not own[R:V].any() and own[V:15].all()
    if name != "F1":
        np.testing.assert_array_equal(Q, np.diag(own))
        return
    C = attitude(x) * Rotation.from_rotvec(0.5 * DT * form.model.decay * x[RATE:])  # mid-step
    q = transient_noise(DT)
    coupled = Q - np.diag(own)
    np.testing.assert_allclose(coupled[XF:, XF:], np.diag(q), rtol=1e-12)
    np.testing.assert_allclose(coupled[V:THETA, XF : XF + 3], C.as_matrix() * q[:3] * DT, rtol=0, atol=1e-9 * q[0])
    np.testing.assert_allclose(coupled[V:THETA, V:THETA], C.as_matrix() * q[:3] @ C.as_matrix().T * DT**2, rtol=0, atol=1e-3 * q[0] * DT**2)
    np.testing.assert_allclose(np.diag(coupled[THETA:BA, XF + 3 :]), q[3:] * DT, rtol=1e-3)
    np.testing.assert_allclose(np.diag(coupled[THETA:BA, THETA:BA]), q[3:] * DT**2, rtol=0.05)
    assert not coupled[BA:XF].any()


def test_the_transients_noise_keeps_their_stationary_spread_at_any_rate():
    """With ``x(k+1) = phi x(k) + w(k)``: 2.5, 2.5, .6 m/s^2 and .1, .1, .47 rad/s, and the sd of a 10 Hz step is the stated one."""
    np.testing.assert_allclose(np.sqrt(transient_noise(0.1)), TRANSIENT_STEP, rtol=1e-12)
    for dt in (1.0, 0.1, 0.01):
        stationary = np.sqrt(transient_noise(dt) / (1.0 - np.exp(-2.0 * dt / TIME_CONSTANT)))
        np.testing.assert_allclose(stationary, [2.5, 2.5, 0.6, 0.1, 0.1, 0.47], rtol=0.02)


def test_the_three_readings_of_the_process_noise():
    """(22): .1 m/s^2, .01, 1e-3 m/s^2, 1e-4 rad/s, of a step or of a second; an angle's deviation is twice that of a quaternion."""
    np.testing.assert_allclose(process_noise("printed", 0.1)[::3], [0.0, 1e-2, 4e-4, 1e-6, 1e-8], rtol=1e-12)
    np.testing.assert_allclose(process_noise("printed-dt", 0.1)[::3], [0.0, 1e-4, 4e-5, 1e-7, 1e-9], rtol=1e-12)
    np.testing.assert_allclose(process_noise("tuned", 0.1)[::3], [0.0, 1e-6, 1e-9, 1e-11, 1e-13], rtol=1e-12)
    at_ten, at_hundred = ({p: np.sqrt(330 * hz * process_noise(p, 1.0 / hz)[BG]) for p in PROCESSES} for hz in (10, 100))
    assert at_ten["printed"] == pytest.approx(5.7e-3, rel=0.01), "the bias of a drift-free gyroscope wanders this far, rad/s"
    assert at_hundred["printed"] == pytest.approx(np.sqrt(10.0) * at_ten["printed"], rel=1e-12)
    for process in ("printed-dt", "tuned"):
        assert at_hundred[process] == pytest.approx(at_ten[process], rel=1e-12)
    assert DEFAULT_PROCESS == {"F0": "printed-dt", "F1": "tuned", "F2": "tuned"}


@pytest.mark.parametrize("name", FORMULATIONS)
def test_multipliers_scale_r_and_q_and_leave_the_rest(name):
    plain, scaled = formulation(name, 10, Sensors()), formulation(name, 10, Sensors(), noise_scale=100.0, process_scale=3.0)
    variance = np.square([0.05] * 3 + [0.002] * 3) + (np.square([0.02] * 3 + [0.002] * 3) if name == "F2" else 0.0)
    np.testing.assert_allclose(plain.sensor.R, np.diag(variance), rtol=1e-12)
    np.testing.assert_allclose(scaled.sensor.R, 100.0 * plain.sensor.R, rtol=1e-12)
    np.testing.assert_allclose(scaled.model.noise, 3.0 * plain.model.noise, rtol=1e-12)
    np.testing.assert_allclose(scaled.model.transient, 3.0 * plain.model.transient, rtol=1e-12)
    np.testing.assert_array_equal(scaled.P0, plain.P0)


# What drives and what is compared.


def test_the_sample_of_an_interval_drives_its_step_and_is_compared_at_its_end(journey):
    measured = journey(2).measured
    for name, driving in (("F0", measured.atomic), ("F2", measured.classical)):
        u = controls(name, measured)
        np.testing.assert_array_equal(u[:, :-1, :6], driving)
        np.testing.assert_array_equal(u[:, 1:, 6:], driving)
        np.testing.assert_array_equal(readings(name, measured)[:, 1:], measured.atomic)
    assert not controls("F1", measured).any()
    np.testing.assert_array_equal(true_bias("F2", measured), measured.classical_bias - measured.bias)
    np.testing.assert_array_equal(true_bias("F1", measured), measured.bias)


@pytest.mark.parametrize("name", FORMULATIONS)
def test_a_step_of_the_truth_is_a_step_of_the_model(journey, silent, name):
    """(18), (19): from the true state of one epoch, the perfect sample of the interval (in F1 its transients) leads to the next."""
    trip = journey(1, silent)
    driven, u = trip.case.driven, controls(name, trip.measured)[0]
    form = formulation(name, 10, Sensors())
    for k in IN_MOTION:
        x, after = true_state(name, driven, k), true_state(name, driven, k + 1)
        if name == "F1":
            x[FORCE:] = after[FORCE:] / form.model.decay
        propagate(form.model, x, u[k])
        np.testing.assert_allclose(x[V:Q0], after[V:Q0], rtol=0, atol=2e-4)
        np.testing.assert_allclose(x[:V], after[:V], rtol=0, atol=2e-3)  # a step takes the acceleration as constant
        assert (attitude(x).inv() * attitude(after)).magnitude() < 2e-6


def test_the_quasi_static_measurement_is_gravity_and_frame_rate_in_body_axes(journey):
    """(17) in F0: the reaction to gravity, not a force without gravity, and the rate of a vehicle that stands."""
    driven, form = journey().case.driven, formulation("F0", 10, Sensors())
    bias = np.array([0.3, -0.2, 0.1, 0.03, -0.02, 0.01])
    for k in IN_MOTION:
        x, z = true_state("F0", driven, k), np.empty(6)
        x[ACCELEROMETER_BIAS:] = bias
        observe(form.sensor, x, np.zeros(12), z)
        to_body = attitude(x).inv()
        np.testing.assert_allclose(z[:3], to_body.apply(-GRAVITY_N) + bias[:3], rtol=0, atol=1e-13)
        np.testing.assert_allclose(z[3:], to_body.apply(EARTH_N) + bias[3:], rtol=0, atol=5e-6)  # transport rate aside
    at_rest = true_state("F0", driven, 0)
    observe(form.sensor, at_rest, np.zeros(12), z)
    np.testing.assert_allclose(z, [0.0, 0.0, GRAVITY, *EARTH_N], rtol=0, atol=1e-15)


# A sample that is compared with itself or with the one before it.


class Comparison(NamedTuple):
    """``h(x) = (u - b_hat) + b``, where the input u is a sample and b_hat the bias that the prediction corrected it by."""

    bias: np.ndarray


@pytest.fixture
def comparison(monkeypatch):
    """The sensor type, registered for one test."""
    monkeypatch.setattr(extension, "_kernels", dict(extension._kernels))
    monkeypatch.setattr(extension, "_loose_ends", set(extension._loose_ends))

    @extension.implements(observe, Comparison)
    @njit
    def observe_again(sensor, x, u, z):
        for i in range(6):
            z[i] = (u[i] - sensor.bias[i]) + x[10 + i]

    @extension.implements(linearise_observation, Comparison)
    @njit
    def linearise_again(sensor, x, u, H):
        H[:] = 0.0
        for i in range(6):
            H[i, 9 + i] = 1.0

    return Comparison(np.zeros(6))


def compare(form, sensor, x, P, z, u, weights, R):
    """One update of state and covariance, in place, with a comparing sensor; returns innovation and gain."""
    work, predicted = workspace(15, 6), np.empty(6)
    linearise_observation(sensor, x, u, work.H)
    observe(sensor, x, u, predicted)
    work.innovation[:] = z - predicted
    assert update_error(P, work.innovation, work.H, R, np.zeros((6, 6)), np.zeros((15, 6)), False, weights, work) >= 0.0
    retract(form.model, x, work.shift)
    return work.innovation.copy(), work.K.copy()


@pytest.mark.parametrize("weight", [1.0, 0.3, 73.0])
def test_the_innovation_of_a_sample_that_predicts_itself_is_exactly_zero(journey, comparison, weight):
    """(16), Proposition 1, A18: dead reckoning for any gain and weight, with a covariance that shrinks as if something had been learnt."""
    trip, epochs = journey(1), 200
    form, u = formulation("F0", 10, Sensors(), process_scale=0.0), controls("F0", trip.measured)[0]
    x = initial_states("F0", trip.case.driven, trip.measured)[0]
    reckoned, P, R_of = x.copy(), form.P0.copy(), form.sensor.R
    F, Q = np.empty((15, 15)), np.empty((15, 15))
    for k in range(epochs):
        linearise(form.model, x, u[k], F, Q)
        used = x[ACCELEROMETER_BIAS:].copy()
        for state in (x, reckoned):
            propagate(form.model, state, u[k])
        P[:] = F @ P @ F.T + Q
        innovation, _ = compare(form, comparison._replace(bias=used), x, P, trip.measured.atomic[0, k], u[k], np.full(6, weight), R_of)
        assert not innovation.any()
    np.testing.assert_allclose(x, reckoned, rtol=0, atol=1e-15 * np.abs(x).max())
    information = np.linalg.inv(P[BA:, BA:])
    claimed = np.linalg.inv(form.P0[BA:, BA:]) + epochs * weight * np.linalg.inv(R_of)
    np.testing.assert_allclose(np.diag(information), np.diag(claimed), rtol=1e-9)
    assert np.all(np.diag(P)[BA:] < np.diag(form.P0)[BA:])


def test_a_bias_that_is_learnt_from_the_sample_before_follows_the_signal(journey, comparison):
    """``h = z(k-1) - b_hat(k-1) + b(k)``: with a constant gain the bias is ``K (z(N) - z(0))``, whatever was measured in between."""
    trip = journey(1)
    form, z = formulation("F0", 10, Sensors()), trip.measured.atomic[0, 500:700]
    x, R_of = true_state("F0", trip.case.driven, 0), form.sensor.R
    q = 1e-4 * np.diag(R_of)
    stationary = 0.5 * (q + np.sqrt(q * q + 4.0 * q * np.diag(R_of)))  # P = P R / (P + R) + q
    gain = stationary / (stationary + np.diag(R_of))
    for before, sample in zip(z[:-1], z[1:], strict=True):
        P = np.diag([1e-6] * BA + list(stationary))
        _, K = compare(form, comparison._replace(bias=x[ACCELEROMETER_BIAS:].copy()), x, P, sample, before, np.ones(6), R_of)
        np.testing.assert_allclose(np.diag(K[BA:]), gain, rtol=1e-12)
        np.testing.assert_allclose(np.diag(P)[BA:] + q, stationary, rtol=1e-9)  # the gain stays what it is
    np.testing.assert_allclose(x[ACCELEROMETER_BIAS:], gain * (z[-1] - z[0]), rtol=0, atol=1e-13)


# Jacobians.


def rate_jacobian(x, u):
    """The continuous-time Jacobian of the fifteen errors, with Coriolis' term of the earth's rate and without transport rate."""
    C, f, omega = attitude(x).as_matrix(), u[:3] - x[ACCELEROMETER_BIAS:GYRO_BIAS], u[3:6] - x[GYRO_BIAS : GYRO_BIAS + 3]
    A = np.zeros((15, 15))
    A[R:V, V:THETA] = np.eye(3)
    A[V:THETA, V:THETA], A[V:THETA, THETA:BA], A[V:THETA, BA:BG] = -cross_matrix(2.0 * EARTH_N), -C @ cross_matrix(f), -C
    A[THETA:BA, THETA:BA], A[THETA:BA, BG:] = -cross_matrix(omega), -np.eye(3)
    return A


def test_the_printed_jacobian_used_as_a_transition_forgets_the_covariance(journey):
    """(20), (21): what was known of position, velocity and biases is gone after one step; as a rate it belongs into ``exp(A dt)``."""
    trip, k = journey(1), 1400  # straight on
    form = formulation("F0", 10, Sensors())
    x, u = true_state("F0", trip.case.driven, k), controls("F0", trip.measured)[0, k]
    A, P = printed_jacobian(x, u[:3], u[3:6]), np.diag(np.repeat([1e-4, 1e-4, 1e-6, 1e-6, 1e-8], [3, 3, 4, 3, 3]))
    Q = np.diag(np.repeat(np.square([0.0, 0.1, 0.01, 1e-3, 1e-4]), [3, 3, 4, 3, 3]))
    velocity, biases = np.s_[V:Q0, V:Q0], np.s_[ACCELEROMETER_BIAS:, ACCELEROMETER_BIAS:]
    printed, spread = A @ P @ A.T + Q, P.copy()
    np.testing.assert_array_equal(printed[R:V, R:V], P[velocity])  # the velocity's variance, in m^2
    np.testing.assert_array_equal(printed[biases], Q[biases])
    spread[R:V, R:V] *= 1e6
    np.testing.assert_array_equal(A @ spread @ A.T + Q, printed)
    spread[velocity] = 100.0 * np.eye(3)
    turning = 4.0 * u[3:6] @ u[3:6]
    assert np.diag(A @ spread @ A.T)[V:Q0].max() < 100.0 * turning + 0.01, "all that is left of it comes through the Coriolis term"
    F, Q, _ = jacobians(form, x, u)
    right = F @ form.P0 @ F.T + Q
    np.testing.assert_array_equal(right[BA:, BA:], (form.P0 + Q)[BA:, BA:])
    assert np.all(np.diag(right) > np.diag(form.P0) - 1e-12)
    np.testing.assert_allclose(F, expm(rate_jacobian(x, u) * DT), rtol=0, atol=2e-3)


def test_the_printed_coriolis_term_is_wrong_by_metres_per_second_squared():
    """Its rate is the body's instead of the earth's: 2.4 m/s^2 in a turn of .3 rad/s at 4 m/s."""
    x, u = np.zeros(16), np.array([0.0, 0.0, GRAVITY, 0.0, 0.0, 0.3])
    x[Q0], x[V] = 1.0, 4.0
    printed, right = printed_jacobian(x, u[:3], u[3:])[V:Q0, V:Q0], rate_jacobian(x, u)[V:THETA, V:THETA]
    assert np.linalg.norm(printed @ x[V:Q0]) == pytest.approx(2.4, rel=1e-12)
    assert np.linalg.norm(right @ x[V:Q0]) < 1e-3


def differences(move, model, x, n, difference):
    """Jacobian of `move` at `x` by central differences of 1e-6 along the error's axes."""
    columns = []
    for i in range(n):
        ends = []
        for sign in (1.0, -1.0):
            moved = x.copy()
            retract(model, moved, sign * 1e-6 * np.eye(n)[i])
            ends.append(move(moved))
        columns.append(difference(*ends) / 2e-6)
    return np.array(columns).T


def error_between(x, reference):
    turn = (attitude(reference).inv() * attitude(x)).as_rotvec()
    return np.concatenate([(x - reference)[:Q0], turn, (x - reference)[ACCELEROMETER_BIAS:]])


@pytest.mark.parametrize("name", FORMULATIONS)
def test_jacobians_agree_with_central_differences(journey, name):
    """(26), A17: F and H along the drive, relative to the largest element of their row."""
    trip, form, n = journey(1), formulation(name, 10, Sensors()), size(name)
    for k in IN_MOTION:
        x, u = true_state(name, trip.case.driven, k), controls(name, trip.measured)[0, k]

        def stepped(y, u=u):
            y = y.copy()
            propagate(form.model, y, u)
            return y

        def seen(y, u=u):
            z = np.empty(6)
            observe(form.sensor, y, u, z)
            return z

        F, _, H = jacobians(form, x, u)
        for analytic, found in (
            (F, differences(stepped, form.model, x, n, error_between)),
            (H, differences(seen, form.model, x, n, np.subtract)),
        ):
            scale = np.abs(found).max(axis=1, keepdims=True)
            np.testing.assert_allclose(analytic / scale, found / scale, rtol=0, atol=1e-6)
