"""Scores by their definitions, channels by an independent rotation library, and what a run that fails is called."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robins.foundation.earth import EARTH_RATE, meridian_radius, transverse_radius
from robins.kalman.weights import weighting
from robins.papers.imani2026.drive import GRAVITY, LATITUDE, truth, truth_interval
from robins.papers.imani2026.formulations import FORMULATIONS
from robins.papers.imani2026.methods import Method
from robins.papers.imani2026.scoring import (
    ANGLES,
    AVERAGED,
    attitude_errors,
    errors,
    failures,
    measure_errors,
    nees,
    position_errors,
    squared_length,
)

EKF, RECKONED = Method(weighting("unit")), Method(weighting("unit"), updates=False)
SEEDS = st.integers(0, 2**32 - 1)


def random_errors(seed, runs=3, epochs=40, channels=12):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(runs, epochs, channels)) * 10.0 ** rng.uniform(-6.0, 3.0, channels) + rng.normal(size=channels)


# Measures.


@given(SEEDS)
def test_rmse_has_a_root(seed):
    """(44): in the unit of the error; as printed, without the root, it would grow with the square of a unit."""
    error = random_errors(seed)
    found, thousandths = measure_errors(error, 0.1), measure_errors(1000.0 * error, 0.1)
    for run in range(3):
        by_hand = [sum(e * e for e in error[run, :, i]) / 40 for i in range(12)]
        np.testing.assert_allclose(found.rmse[run] ** 2, by_hand, rtol=1e-12)
    np.testing.assert_allclose(thousandths.rmse, 1000.0 * found.rmse, rtol=1e-12)


@given(SEEDS)
def test_mean_error_keeps_its_sign(seed):
    """(45)"""
    error = random_errors(seed)
    found, mirrored = measure_errors(error, 0.1).mean, measure_errors(-error, 0.1).mean
    np.testing.assert_allclose(found, error.sum(axis=1) / 40, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(mirrored, -found)
    assert np.any(found < 0.0) and np.any(found > 0.0)


@given(SEEDS)
def test_squared_rmse_is_squared_mean_plus_squared_deviation(seed):
    """(46), A18."""
    found = measure_errors(random_errors(seed), 0.1)
    np.testing.assert_allclose(found.rmse**2, found.mean**2 + found.sd**2, rtol=1e-12)


@given(SEEDS)
def test_drift_is_the_last_error_and_its_other_reading_an_integral(seed):
    error = random_errors(seed)
    found = measure_errors(error, 0.25)
    np.testing.assert_array_equal(found.drift, error[:, -1])
    np.testing.assert_allclose(found.drift_integral, 40 * 0.25 * found.mean, rtol=1e-9, atol=1e-9)


def test_errors_begin_at_epoch_one_and_angles_are_wrapped():
    estimate, true = np.zeros((2, 4, 12)), np.zeros((4, 12))
    estimate[:, 0] = 99.0
    estimate[..., 11], true[:, 11] = np.pi - 0.01, -np.pi + 0.02 - 4.0 * np.pi
    estimate[..., 9], estimate[..., 2] = 0.1, 7.0
    error = errors(estimate, true)
    assert error.shape == (2, 3, 12)
    np.testing.assert_allclose(error[..., 11], -0.03, rtol=0, atol=1e-12)
    np.testing.assert_allclose(error[..., 9], 0.1, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(error[..., 2], 7.0)  # of a velocity nothing is wrapped
    np.testing.assert_array_equal(errors(estimate, np.broadcast_to(true, (2, 4, 12))), error)


@pytest.mark.parametrize("name", FORMULATIONS)
def test_no_angle_error_of_a_drive_with_turns_exceeds_half_a_turn(journey, name):
    trip = journey(2)
    assert np.ptp(truth(trip.case.driven)[:, 11]) > 2.0 * np.pi
    assert np.abs(trip.follow(name, EKF).error[..., ANGLES]).max() <= np.pi


# Channels.


def channels_by_hand(name, driven, state, sample):
    """The twelve channels from a state and the sample that they are taken from, with scipy's rotations."""
    turn, v = Rotation.from_quat(state[6:10], scalar_first=True), state[3:6]
    earth = EARTH_RATE * np.array([0.0, np.cos(LATITUDE), np.sin(LATITUDE)])
    east = transverse_radius(LATITUDE)
    transport = np.array([-v[1] / meridian_radius(LATITUDE), v[0] / east, v[0] * np.tan(LATITUDE) / east])
    coriolis = np.cross(2.0 * earth + transport, v)
    if name == "F1":
        acceleration, rate = turn.apply(state[16:19]) - coriolis, turn.apply(state[19:22])
    else:
        acceleration = turn.apply(sample[:3] - state[10:13]) - coriolis - [0.0, 0.0, GRAVITY]
        rate = turn.apply(sample[3:] - state[13:16]) - earth - transport
    yaw, pitch, roll = turn.as_euler("ZYX")
    return np.concatenate([v, acceleration, rate, [roll, pitch, yaw]])


@pytest.mark.parametrize("name", FORMULATIONS)
def test_channels_are_velocity_compensated_sample_or_transient_and_euler_angles(journey, name):
    """In F2 the sample is the driving sensor's, which the estimated bias belongs to."""
    trip = journey(2)
    followed = trip.follow(name, EKF)
    samples = trip.measured.classical if name == "F2" else trip.measured.atomic
    for k in (1, 300, 1080, 1760, 3300):
        expected = channels_by_hand(name, trip.case.driven, followed.record.posterior[1, k], samples[1, k - 1])
        np.testing.assert_allclose(followed.estimate[1, k], expected, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(followed.estimate[:, 0, AVERAGED], followed.estimate[:, 1, AVERAGED])


def test_without_errors_the_channels_of_the_samples_are_the_averaged_truth(journey, silent):
    """No update, perfect sensors: what is left is the attitude's turn within an interval."""
    trip = journey(1, silent)
    followed = trip.follow("F0", RECKONED)
    against = errors(followed.estimate, truth_interval(trip.case.driven))
    assert np.abs(against[..., 3:6]).max() < 0.1 and np.abs(against[..., 6:9]).max() < 2e-3
    standing = against[:, :190]
    assert np.abs(standing).max() < 1e-9


# Consistency.


def test_squared_length_is_that_of_the_whitened_error():
    rng = np.random.default_rng(1)
    root, error = rng.normal(size=(2, 3, 4, 4)), rng.normal(size=(2, 3, 4))
    covariance = root @ np.swapaxes(root, -1, -2) + np.eye(4)
    covariance[0, 1, 2, 2] = np.nan
    error[1, 2, 0] = np.inf
    found = squared_length(error, covariance)
    assert np.isnan(found[0, 1]) and np.isnan(found[1, 2])
    white = np.linalg.solve(np.linalg.cholesky(covariance[1, 0]), error[1, 0])
    assert found[1, 0] == pytest.approx(white @ white, rel=1e-12)
    assert np.isnan(squared_length(np.full((1, 2), np.nan), np.ones((1, 2, 2)))).all()


def test_attitude_errors_lead_from_the_estimate_to_the_truth_in_body_axes():
    rng = np.random.default_rng(2)
    estimated, d = Rotation.random(5, rng=rng), rng.uniform(-0.5, 0.5, (5, 3))
    true = (estimated * Rotation.from_rotvec(d)).as_quat(scalar_first=True)
    quaternions = np.stack([estimated.as_quat(scalar_first=True), -estimated.as_quat(scalar_first=True)])
    quaternions[1, 3, 0] = np.nan
    found = attitude_errors(quaternions, true)
    np.testing.assert_allclose(found[0], d, rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.delete(found[1], 3, axis=0), np.delete(d, 3, axis=0), rtol=0, atol=1e-12)
    assert np.isnan(found[1, 3]).all()


@pytest.mark.parametrize("name", FORMULATIONS)
def test_nees_is_that_of_errors_and_covariances_at_the_marks(journey, name):
    trip, marks = journey(2), np.array([10, 300, 2000])
    followed = trip.follow(name, EKF, marks)
    record = followed.record
    found = nees(followed.form, record, trip.measured, trip.case.driven.quaternion, marks)
    assert found["nees_attitude"].shape == found["nees_bias"].shape == (2, 3)
    bias = trip.measured.classical_bias - trip.measured.bias if name == "F2" else trip.measured.bias
    for run, mark in ((0, 0), (1, 2)):
        error, P = bias[run] - record.posterior[run, marks[mark], 10:16], record.covariance[run, mark]
        assert found["nees_bias"][run, mark] == pytest.approx(error @ np.linalg.inv(P[9:15, 9:15]) @ error, rel=1e-9)
        estimated = Rotation.from_quat(record.posterior[run, marks[mark], 6:10], scalar_first=True)
        d = (estimated.inv() * Rotation.from_quat(trip.case.driven.quaternion[marks[mark]], scalar_first=True)).as_rotvec()
        assert found["nees_attitude"][run, mark] == pytest.approx(d @ np.linalg.inv(P[6:9, 6:9]) @ d, rel=1e-8)


def test_position_errors_are_root_mean_square_and_last(journey):
    trip = journey(2)
    followed = trip.follow("F1", EKF)
    found = position_errors(followed.record, trip.case.driven.position)
    error = followed.record.posterior[1, 1:, :3] - trip.case.driven.position[1:]
    np.testing.assert_allclose(found["position_rms"][1], np.sqrt((error**2).sum(axis=0) / 3300), rtol=1e-12)
    np.testing.assert_array_equal(found["position_final"][1], error[-1])


# Failures.


def test_a_run_fails_by_its_filter_or_by_a_car_that_is_too_fast(journey):
    followed = journey(2).follow("F1", EKF)
    failed = np.array([-1, -1, -1, 17, -1])
    error = np.zeros((5, 10, 12))
    error[1, 4, 1], error[2, 9, 0], error[3, 5:], error[4, 0, 8] = -1000.5, np.nan, np.nan, 1e9
    reasons = failures(followed.record._replace(failed=failed), error)
    assert reasons.tolist() == [
        "",
        "velocity error beyond 1000 m/s",
        "velocity error beyond 1000 m/s",
        "no Cholesky factor or not finite at epoch 17",
        "",  # only the velocity decides
    ]
