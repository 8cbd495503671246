"""How weights enter the update: on the noise or on the gain, in a whole run."""

import numpy as np
import pytest

from robins.kalman.filter import run_filter
from robins.kalman.m_estimators import huber
from robins.kalman.predict import Ekf
from robins.kalman.weights import weighting

EPOCHS, CHANNELS = 30, 3


def run(case, method):
    return run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)


def on_gain(weights):
    return weighting("known", memory=weights, on_gain=True)


def textbook(case, run, weights):
    """States and variances of one record with the gain ``K W`` and the long form of the covariance."""
    (A, B, Q), H, D, R = case.model, case.sensor.H, case.sensor.D, case.sensor.R
    x, P, rows, update = case.x0[run], case.P0, [], 0
    for k, u in enumerate(case.controls):
        nis = np.nan
        if case.valid[k]:
            innovation, S = case.measurements[run, k] - H @ x - D @ u, H @ P @ H.T + R
            nis = innovation @ np.linalg.inv(S) @ innovation
            K = P @ H.T @ np.linalg.inv(S) @ np.diag(weights[update])
            x, keep, update = x + K @ innovation, np.eye(4) - K @ H, update + 1
            P = keep @ P @ keep.T + K @ R @ K.T
        rows.append((x, np.diag(P), nis))
        x, P = A @ x + B @ u, A @ P @ A.T + Q
    return [np.array(column) for column in zip(*rows, strict=True)]


def test_weights_on_the_gain_multiply_its_columns_in_every_update(problem):
    case, weights = problem(20), np.random.default_rng(20).uniform(0.0, 1.5, (EPOCHS, CHANNELS))
    record = run(case, on_gain(weights))
    for k in range(2):
        for name, expected in zip(("posterior", "posterior_variance", "nis"), textbook(case, k, weights), strict=True):
            np.testing.assert_allclose(getattr(record, name)[k], expected, rtol=1e-9, atol=1e-9, err_msg=name)
    np.testing.assert_array_equal(record.weights[0, case.valid], weights[: case.valid.sum()])


def test_weights_of_one_are_the_plain_filter_wherever_they_act(problem):
    case = problem(21)
    plain = run(case, weighting("unit"))
    for method in (on_gain(np.ones((EPOCHS, CHANNELS))), huber(np.inf)._replace(on_gain=True)):
        weighted = run(case, method)
        for name, a, b in zip(plain._fields, plain, weighted, strict=True):
            np.testing.assert_array_equal(a, b, err_msg=name)


def test_a_weight_on_the_gain_is_another_filter_than_the_same_on_the_noise(problem):
    case, weights = problem(22), np.full((EPOCHS, CHANNELS), 0.3)
    assert np.abs(run(case, on_gain(weights)).posterior - run(case, weighting("known", memory=weights)).posterior).max() > 0.1


def test_no_weight_on_the_gain_is_no_update(problem):
    case = problem(23)
    record = run(case, on_gain(np.zeros((EPOCHS, CHANNELS))))
    np.testing.assert_array_equal(record.posterior, record.prior)
    np.testing.assert_allclose(record.posterior_variance, record.prior_variance, rtol=1e-14)
    assert np.all(record.nis[:, case.valid] > 0.0)


@pytest.mark.parametrize("false", [-0.1, np.nan, np.inf])
def test_a_false_weight_on_the_gain_fails_the_run(problem, false):
    case, weights = problem(24), np.ones((EPOCHS, CHANNELS))
    weights[3, 1] = false
    record = run(case, on_gain(weights))
    assert case.valid[:4].all() and record.failed.tolist() == [3, 3]
    assert np.isfinite(record.posterior[:, :3]).all() and np.isnan(record.posterior[:, 3:]).all()
