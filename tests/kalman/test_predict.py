"""Prediction: extended and unscented, on linear models where they must agree and on a nonlinear one against filterpy."""

from typing import NamedTuple

import numpy as np
import pytest
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
from numba import njit

from robins.kalman.extension import implements
from robins.kalman.model import linearise, propagate
from robins.kalman.predict import Ekf, Ukf, predict
from robins.kalman.update import workspace

DT = 0.1


@njit
def step(predictor, model, x, P, u, work):
    """One prediction: `predict` exists in compiled code only."""
    return predict(predictor, model, x, P, u, work)


class Pendulum(NamedTuple):
    """Angle, rate and unknown stiffness: ``rate' = -stiffness sin(angle) + u``, one Euler step of `dt`."""

    dt: float
    Q: np.ndarray


def swing(x, u=0.0):
    """The pendulum's step in numpy."""
    return np.array([x[0] + DT * x[1], x[1] + DT * (u - x[2] * np.sin(x[0])), x[2]])


@pytest.fixture(scope="module", autouse=True)
def pendulum(registry):
    @implements(propagate, Pendulum)
    @njit
    def propagate_pendulum(model, x, u):
        angle = x[0]
        x[0] += model.dt * x[1]
        x[1] += model.dt * (u[0] - x[2] * np.sin(angle))

    @implements(linearise, Pendulum)
    @njit
    def linearise_pendulum(model, x, u, F, Q):
        F[:] = np.eye(3)
        F[0, 1] = model.dt
        F[1, 0], F[1, 2] = -model.dt * x[2] * np.cos(x[0]), -model.dt * np.sin(x[0])
        Q[:] = model.Q


@pytest.fixture
def prior(random_covariance):
    rng = np.random.default_rng(5)
    return rng.normal(size=3), 0.1 * random_covariance(rng, 3), Pendulum(DT, 0.01 * random_covariance(rng, 3))


@pytest.mark.parametrize("predictor", [Ekf(), Ukf(), Ukf(1.0, 2.0, 0.0), Ukf(0.5, 0.0, 1.0)], ids=str)
def test_every_prediction_of_a_linear_model_is_the_kalman_filters(problem, predictor):
    case = problem(1)
    x, P, u, work = case.x0[0].copy(), case.P0.copy(), case.controls[0], workspace(4, 3)
    assert step(predictor, case.model, x, P, u, work)
    A, B, Q = case.model
    np.testing.assert_allclose(x, A @ case.x0[0] + B @ u, rtol=0, atol=1e-10)
    np.testing.assert_allclose(P, A @ case.P0 @ A.T + Q, rtol=0, atol=1e-10)
    np.testing.assert_allclose(work.FP, A @ case.P0, rtol=0, atol=1e-10)
    np.testing.assert_array_equal(work.F, A)
    np.testing.assert_array_equal(P, P.T)


def test_the_extended_prediction_uses_the_jacobian_at_the_estimate(prior):
    """Independent: the Jacobian by central differences of the numpy step."""
    x0, P0, model = prior
    h = 1e-6
    F = np.column_stack([(swing(x0 + h * e, 0.3) - swing(x0 - h * e, 0.3)) / (2 * h) for e in np.eye(3)])
    x, P, work = x0.copy(), P0.copy(), workspace(3, 1)
    assert step(Ekf(), model, x, P, np.array([0.3]), work)
    np.testing.assert_allclose(x, swing(x0, 0.3), rtol=1e-15)
    np.testing.assert_allclose(work.F, F, rtol=0, atol=1e-9)
    np.testing.assert_allclose(P, F @ P0 @ F.T + model.Q, rtol=0, atol=1e-9)


@pytest.mark.parametrize("predictor", [Ukf(1.0, 2.0, 0.0), Ukf(0.3, 2.0, 1.0), Ukf(0.1, 0.0, 0.0)], ids=str)
def test_the_unscented_filter_is_filterpys(prior, predictor):
    """Independent implementation: filterpy, ten steps of a nonlinear model with a linear measurement of the angle."""
    x0, P0, model = prior
    points = MerweScaledSigmaPoints(3, predictor.alpha, predictor.beta, predictor.kappa)
    reference = UnscentedKalmanFilter(3, 1, DT, hx=lambda x: x[:1], fx=lambda x, dt: swing(x, 0.3), points=points)
    reference.x, reference.P, reference.Q, reference.R = x0.copy(), P0.copy(), model.Q, np.array([[0.2]])
    x, P, work = x0.copy(), P0.copy(), workspace(3, 1)
    for z in np.sin(np.arange(10.0)):
        assert step(predictor, model, x, P, np.array([0.3]), work)
        reference.predict()
        np.testing.assert_allclose(x, reference.x, rtol=0, atol=1e-10)
        np.testing.assert_allclose(P, reference.P, rtol=0, atol=1e-10)
        gain = P[:, 0] / (P[0, 0] + 0.2)
        x, P = x + gain * (z - x[0]), P - np.outer(gain, P[0])
        reference.update(np.array([z]))


def test_the_unscented_cross_covariance_is_that_of_many_samples(prior):
    x0, P0, model = prior
    x, P, work = x0.copy(), P0.copy(), workspace(3, 1)
    assert step(Ukf(1.0, 2.0, 0.0), model, x, P, np.zeros(1), work)
    samples = np.random.default_rng(1).multivariate_normal(x0, P0, 200_000)
    moved = swing(samples.T).T
    sampled = (moved - moved.mean(axis=0)).T @ (samples - x0) / len(samples)
    np.testing.assert_allclose(work.FP, sampled, rtol=0, atol=0.003)


def test_sigma_points_of_a_covariance_without_a_root_are_refused(prior):
    x0, _, model = prior
    x, P = x0.copy(), np.diag([1.0, -1.0, 1.0])
    assert not step(Ukf(), model, x, P, np.zeros(1), workspace(3, 1))
    np.testing.assert_array_equal(x, x0)
    np.testing.assert_array_equal(P, np.diag([1.0, -1.0, 1.0]))
    assert step(Ekf(), model, x, P, np.zeros(1), workspace(3, 1))


def test_prediction_outside_compiled_code_says_why_not(prior):
    with pytest.raises(NotImplementedError, match="compiled"):
        predict(Ekf(), prior[2], prior[0], prior[1], np.zeros(1), workspace(3, 1))
