"""Prediction: extended and unscented, on linear models where they must agree and on a nonlinear one against filterpy."""

from typing import NamedTuple

import numpy as np
import pytest
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
from numba import njit
from numba.core.errors import TypingError

from robins.foundation.smallmat import assign
from robins.kalman.extension import implements
from robins.kalman.model import linearise, process_noise, propagate
from robins.kalman.predict import Ekf, predict, sigma_points, unscented
from robins.kalman.update import workspace

DT = 0.1


@njit
def step(predictor, model, x, P, u, work):
    """One prediction: `predict` exists in compiled code only."""
    return predict(predictor, model, x, P, u, work)


class Walker(NamedTuple):
    """Position in a plane and heading: half a step ahead, then a turn."""

    Q: np.ndarray


def walk(x):
    """The walker's step in numpy."""
    return np.array([x[0] + 0.5 * np.cos(x[2]), x[1] + 0.5 * np.sin(x[2]), x[2] + 0.1])


class Square(NamedTuple):
    """A number that is squared, without a Jacobian."""

    q: float


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
        for i in range(3):
            for j in range(3):
                F[i, j] = 1.0 if i == j else 0.0
        F[0, 1] = model.dt
        F[1, 0], F[1, 2] = -model.dt * x[2] * np.cos(x[0]), -model.dt * np.sin(x[0])
        assign(model.Q, Q)

    @implements(propagate, Walker)
    @njit
    def propagate_walker(model, x, u):
        x[0] += 0.5 * np.cos(x[2])
        x[1] += 0.5 * np.sin(x[2])
        x[2] += 0.1

    @implements(process_noise, Walker)
    @njit
    def noise_of_walker(model, x, u, Q):
        assign(model.Q, Q)

    @implements(propagate, Square)
    @njit
    def propagate_square(model, x, u):
        x[0] *= x[0]

    @implements(process_noise, Square)
    @njit
    def noise_of_square(model, x, u, Q):
        Q[0, 0] = model.q


@pytest.fixture
def prior(random_covariance):
    rng = np.random.default_rng(5)
    return rng.normal(size=3), 0.1 * random_covariance(rng, 3), Pendulum(DT, 0.01 * random_covariance(rng, 3))


@pytest.mark.parametrize("predictor", [Ekf(), unscented(4, 1e-3), unscented(4, 1.0), unscented(4, 0.5, 0.0, 1.0)], ids=str)
def test_every_prediction_of_a_linear_model_is_the_kalman_filters(problem, predictor):
    case = problem(1)
    x, P, u, work = case.x0[0].copy(), case.P0.copy(), case.controls[0], workspace(4, 3)
    assert step(predictor, case.model, x, P, u, work)
    A, B, Q = case.model
    np.testing.assert_allclose(x, A @ case.x0[0] + B @ u, rtol=0, atol=1e-10)
    np.testing.assert_allclose(P, A @ case.P0 @ A.T + Q, rtol=0, atol=1e-10)
    np.testing.assert_allclose(work.FP, A @ case.P0, rtol=0, atol=1e-10)
    np.testing.assert_array_equal(work.Q, Q)
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


@pytest.mark.parametrize(("alpha", "beta", "kappa"), [(1.0, 2.0, 0.0), (0.3, 2.0, 1.0), (0.1, 0.0, 0.0)])
def test_the_unscented_filter_is_filterpys(prior, alpha, beta, kappa):
    """Independent implementation: filterpy, ten steps of a nonlinear model with a linear measurement of the angle."""
    x0, P0, model = prior
    points, predictor = MerweScaledSigmaPoints(3, alpha, beta, kappa), unscented(3, alpha, beta, kappa)
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


def unscented_update(points, x, P, z, R):
    """`x` and `P` after a measurement of distance and second coordinate, by new sigma points and the weights of `points`."""
    columns = np.linalg.cholesky(points.spread * P).T
    drawn = np.vstack([x, x + columns, x - columns])
    seen = np.stack([np.hypot(drawn[:, 0], drawn[:, 1]), drawn[:, 1]], axis=1)
    weights = np.full(len(drawn), points.other)
    expected = seen[0] + weights[1:] @ (seen[1:] - seen[0])
    weights[0] = points.covariance_centre
    S, C = (weights * (seen - expected).T) @ (seen - expected) + R, (weights * (drawn - x).T) @ (seen - expected)
    return x + C @ np.linalg.solve(S, z - expected), P - C @ np.linalg.solve(S, C.T)


def test_the_unscented_filter_is_filterpys_where_the_measurement_is_nonlinear_too():
    """Acceptance check 2 of ghouneem2024: 50 steps. Prediction and weights are ours; the update with new points is written out."""
    model, z_noise, rng = Walker(0.01 * np.eye(3)), 0.05 * np.eye(2), np.random.default_rng(7)
    reference = UnscentedKalmanFilter(
        3,
        2,
        1.0,
        hx=lambda x: np.array([np.hypot(x[0], x[1]), x[1]]),
        fx=lambda x, dt: walk(x),
        points=MerweScaledSigmaPoints(3, 0.1, 2.0, 0.0),
    )
    x, P, work, points = np.array([1.0, 2.0, 0.3]), 0.1 * np.eye(3), workspace(3, 2), unscented(3)
    reference.x, reference.P, reference.Q, reference.R = x.copy(), P.copy(), model.Q, z_noise
    for z in np.array([3.0, 2.0]) + 0.1 * rng.normal(size=(50, 2)):
        assert step(points, model, x, P, np.zeros(1), work)
        reference.predict()
        reference.sigmas_f = reference.points_fn.sigma_points(reference.x, reference.P)
        np.testing.assert_allclose(P, reference.P, rtol=0, atol=1e-10)
        x, P = unscented_update(points, x, P, z, z_noise)
        reference.update(z)
        np.testing.assert_allclose(x, reference.x, rtol=0, atol=1e-10)
        np.testing.assert_allclose(P, reference.P, rtol=0, atol=1e-10)


@pytest.mark.parametrize("alpha", [1.0, 0.3, 0.1])
@pytest.mark.parametrize("start", [0.0, 3.0])
def test_mean_and_variance_of_a_square_are_exact_with_beta_two_and_not_with_the_printed_weight(alpha, start):
    """Of a normal x: ``E x^2 = m^2 + P``, ``var x^2 = 4 m^2 P + 2 P^2``; with (18) of ghouneem2024, ``(2 - 2 / alpha^2) P^2``."""
    points, variance, noise = unscented(1, alpha), 0.7, 0.25
    for centre, last in (
        (points.covariance_centre, 2.0),
        (points.mean_centre * (3.0 - alpha**2), 2.0 - 2.0 / alpha**2),
    ):
        x, P = np.array([start]), np.array([[variance]])
        assert step(points._replace(covariance_centre=centre), Square(noise), x, P, np.zeros(1), workspace(1, 1))
        assert x[0] == pytest.approx(start**2 + variance, rel=1e-13)
        assert P[0, 0] == pytest.approx(4.0 * start**2 * variance + last * variance**2 + noise, rel=1e-11)


def test_the_weights_are_those_of_the_equations():
    """ghouneem2024 (17)-(21) for nine states, and filterpy's."""
    points = unscented(9, 0.1)
    assert points == pytest.approx((0.09, -99.0, -96.01, 1.0 / 0.18), rel=1e-12)
    assert unscented(9, 1.0) == pytest.approx((9.0, 0.0, 2.0, 1.0 / 18.0), rel=1e-12)
    reference = MerweScaledSigmaPoints(9, 0.3, 1.5, 2.0)
    made = unscented(9, 0.3, 1.5, 2.0)
    assert (made.mean_centre, made.covariance_centre, made.other) == pytest.approx(
        (reference.Wm[0], reference.Wc[0], reference.Wm[1]), rel=1e-12
    )


def drawn(P, alpha=0.3):
    """Mean and covariance by the weights of the points that are drawn from a covariance, and the points."""
    n, made = len(P), unscented(len(P), alpha)
    points, root = np.empty((2 * n + 1, n)), np.zeros((n, n))
    x = np.arange(1.0, n + 1.0)
    assert sigma_points(x, P, made.spread, root, points)
    mean = made.mean_centre * points[0] + made.other * points[1:].sum(axis=0)
    around = points - mean
    spread = made.covariance_centre * np.outer(around[0], around[0]) + made.other * around[1:].T @ around[1:]
    return mean - x, spread, points


COUPLED = np.array([[2.0, 0.6, -0.4], [0.6, 1.0, 0.3], [-0.4, 0.3, 0.5]])


def test_sigma_points_have_the_mean_and_the_covariance_that_they_are_drawn_from():
    """ghouneem2024 (14)-(16), with columns of the lower factor and column i - n in (16)."""
    off, spread, points = drawn(COUPLED)
    np.testing.assert_allclose(off, 0.0, atol=1e-12)
    np.testing.assert_allclose(spread, COUPLED, rtol=0, atol=1e-13)
    np.testing.assert_allclose(points[1:4] - points[0], points[0] - points[4:], rtol=0, atol=1e-13)


def test_rows_of_the_lower_factor_are_sigma_points_of_another_covariance():
    """ghouneem2024 (15) says row: right for an upper factor alone."""
    lower = np.linalg.cholesky(COUPLED)
    by_rows, by_columns = (sum(np.outer(step, step) for step in steps) for steps in (lower, lower.T))
    np.testing.assert_allclose(by_columns, COUPLED, rtol=0, atol=1e-14)
    assert np.abs(by_rows - COUPLED).max() > 0.1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [({"alpha": a}, r"^alpha: .* is not in \(0, 1\]$") for a in (0.0, -0.1, 1.01, np.nan, np.inf)]
    + [({"beta": b}, "^beta: .* is not finite$") for b in (np.nan, np.inf)]
    + [({"kappa": k}, "^kappa: .* is not a finite number above -3$") for k in (-3.0, -4.0, np.nan, np.inf)],
)
def test_sigma_points_that_do_not_exist_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        unscented(3, **arguments)


def test_the_noise_of_a_model_that_says_it_alone_is_taken_without_a_jacobian():
    """`Square` has none, and the linearised prediction says so."""
    x, P, work = np.array([2.0]), np.array([[0.1]]), workspace(1, 1)
    assert step(unscented(1), Square(0.5), x, P, np.zeros(1), work) and work.Q[0, 0] == 0.5
    with pytest.raises(TypingError, match="Square has no kernel for linearise"):
        step(Ekf(), Square(0.5), x, P, np.zeros(1), work)


def test_the_unscented_cross_covariance_is_that_of_many_samples(prior):
    x0, P0, model = prior
    x, P, work = x0.copy(), P0.copy(), workspace(3, 1)
    assert step(unscented(3, 1.0), model, x, P, np.zeros(1), work)
    samples = np.random.default_rng(1).multivariate_normal(x0, P0, 200_000)
    moved = swing(samples.T).T
    sampled = (moved - moved.mean(axis=0)).T @ (samples - x0) / len(samples)
    np.testing.assert_allclose(work.FP, sampled, rtol=0, atol=0.003)


def test_sigma_points_of_a_covariance_without_a_root_are_refused(prior):
    x0, _, model = prior
    x, P = x0.copy(), np.diag([1.0, -1.0, 1.0])
    assert not step(unscented(3), model, x, P, np.zeros(1), workspace(3, 1))
    np.testing.assert_array_equal(x, x0)
    np.testing.assert_array_equal(P, np.diag([1.0, -1.0, 1.0]))
    assert step(Ekf(), model, x, P, np.zeros(1), workspace(3, 1))


def test_prediction_outside_compiled_code_says_why_not(prior):
    with pytest.raises(NotImplementedError, match="compiled"):
        predict(Ekf(), prior[2], prior[0], prior[1], np.zeros(1), workspace(3, 1))
