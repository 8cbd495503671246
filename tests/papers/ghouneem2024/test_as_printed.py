"""The printed weight (18) and the update with propagated points (25)-(31), against the equations written out in numpy."""

import numpy as np
import pytest

from robins.kalman.filter import run_filter
from robins.kalman.model import LinearModel, linear_sensor
from robins.kalman.predict import Ekf, unscented
from robins.kalman.weights import weighting
from robins.papers.ghouneem2024.as_printed import printed_centre, reused
from robins.papers.ghouneem2024.filters import design, predictor
from robins.papers.ghouneem2024.options import OPTIONS

N, M, EPOCHS = 9, 6, 200
UNIT = weighting("unit")


@pytest.fixture(scope="module")
def linear():
    """The brief's linear system: model, sensor, measurements (1, 200, 6)."""
    rng = np.random.default_rng(1)
    F = np.eye(N) + 0.1 * rng.normal(size=(N, N))
    F /= max(1.0, np.abs(np.linalg.eigvals(F)).max())
    model = LinearModel(F, np.zeros((N, 1)), np.diag(rng.uniform(0.1, 1.0, N)))
    return model, linear_sensor(np.eye(M, N), np.diag(rng.uniform(0.1, 1.0, M))), rng.normal(size=(1, EPOCHS, M))


def filtered(linear, points, method=UNIT):
    model, sensor, z = linear
    every = np.ones(EPOCHS, bool)
    return run_filter(points, model, sensor, method, np.zeros((1, N)), np.eye(N), np.zeros((EPOCHS, 1)), z, every, N, False, range(EPOCHS))


def literal(linear, alpha, redrawn):
    """(14)-(31) for the linear system, with the points of (22) in (25) or with points drawn again: states and covariances."""
    model, sensor, z = linear
    x, P, points = np.zeros(N), np.eye(N), None
    lam = alpha**2 * N - N
    means = np.full(2 * N + 1, 0.5 / (N + lam))
    weights = means.copy()
    means[0] = lam / (N + lam)
    weights[0] = means[0] + 1 - alpha**2 + 2.0
    states, covariances = [], []

    def draw(x, P):
        root = np.sqrt(N + lam) * np.linalg.cholesky(P)
        return np.vstack([x, x + root.T, x - root.T])

    for k in range(EPOCHS):
        if points is None or redrawn:
            points = draw(x, P)
        Y = points[:, :M]  # (25)
        y = means @ Y  # (26)
        Pyy = sensor.R + (weights[:, None] * (Y - y)).T @ (Y - y)  # (27)
        Pxy = (weights[:, None] * (points - x)).T @ (Y - y)  # (28)
        K = Pxy @ np.linalg.inv(Pyy)  # (29)
        x, P = x + K @ (z[0, k] - y), P - K @ Pyy @ K.T  # (30), (31)
        states.append(x)
        covariances.append((P + P.T) / 2)
        points = draw(x, covariances[-1]) @ model.A.T
        x = means @ points  # (22)
        P = model.Q + (weights[:, None] * (points - x)).T @ (points - x)  # (23)
    return np.array(states), np.array(covariances)


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [0.1, 1.0])
def test_with_points_drawn_again_the_update_is_the_kalman_filters(linear, alpha):
    kalman, found = filtered(linear, Ekf()), filtered(linear, unscented(N, alpha))
    states, covariances = literal(linear, alpha, redrawn=True)
    for field in ("posterior", "covariance", "innovation", "nis"):
        np.testing.assert_allclose(getattr(found, field), getattr(kalman, field), rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.posterior[0], states, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.covariance[0], covariances, rtol=0, atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [0.1, 1.0])
def test_points_that_are_not_drawn_again_are_no_kalman_filter(linear, alpha):
    """Check 3 of the brief."""
    kalman, printed = filtered(linear, Ekf()), filtered(linear, unscented(N, alpha), reused(UNIT))
    assert printed.failed[0] == -1
    assert np.abs(printed.posterior - kalman.posterior).max() > 0.1
    assert np.abs(printed.covariance - kalman.covariance).max() > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("alpha", [0.1, 1.0])
def test_the_printed_update_is_the_equations_letter_by_letter(linear, alpha):
    printed = filtered(linear, unscented(N, alpha), reused(UNIT))
    states, covariances = literal(linear, alpha, redrawn=False)
    np.testing.assert_allclose(printed.posterior[0], states, rtol=0, atol=1e-8)
    np.testing.assert_allclose(printed.covariance[0], covariances, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_a_measurement_of_weight_zero_changes_nothing_under_the_printed_update(linear):
    """Weights given beforehand; the first update has no propagated points behind it and is the Kalman filter's."""
    weights = np.ones((EPOCHS, M))
    weights[50] = 0.0
    printed = filtered(linear, unscented(N, 0.1), reused(weighting("known", memory=weights)))
    whole = filtered(linear, unscented(N, 0.1), reused(UNIT))
    np.testing.assert_array_equal(printed.posterior[0, 50], printed.prior[0, 50])
    np.testing.assert_array_equal(printed.posterior_variance[0, 50], printed.prior_variance[0, 50])
    np.testing.assert_array_equal(printed.posterior[0, :50], whole.posterior[0, :50])
    assert printed.nis[0, 50] == 0.0 and np.isinf(printed.innovation_variance[0, 50]).all()
    np.testing.assert_allclose(whole.posterior[0, 0], filtered(linear, Ekf()).posterior[0, 0], rtol=0, atol=1e-12)


# The weight.


@pytest.mark.parametrize(("alpha", "mean", "product", "total"), [(0.1, -99.0, -296.01, -96.01), (1.0, 0.0, 0.0, 2.0)])
def test_the_printed_weight_is_a_product_where_a_sum_belongs(alpha, mean, product, total):
    points = unscented(N, alpha, 2.0, 0.0)
    assert points.mean_centre == pytest.approx(mean, abs=1e-9)
    assert points.covariance_centre == pytest.approx(total, abs=1e-9)
    assert printed_centre(points, alpha, 2.0) == pytest.approx(product, abs=1e-9)


def test_only_a_design_with_printed_weights_has_them():
    plain, printed = (predictor(design("ukf", OPTIONS, printed_weights=flag)) for flag in (False, True))
    assert printed.covariance_centre == pytest.approx(-296.01)
    assert printed._replace(covariance_centre=plain.covariance_centre) == plain


@pytest.mark.slow
def test_on_a_linear_problem_the_printed_weight_does_no_harm(linear):
    points = unscented(N, 0.1)
    printed = points._replace(covariance_centre=printed_centre(points, 0.1, 2.0))
    found, kalman = filtered(linear, printed), filtered(linear, Ekf())
    np.testing.assert_allclose(found.covariance, kalman.covariance, rtol=0, atol=1e-10)
