"""Chi-square increments: what they are, how they are distributed, and the weights made of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.stats import chi2

from robins.kalman.chi_square import LINEAR, MARGINAL, REJECT, ROOT, SEQUENTIAL, TEMPORAL, chi_square, chi_square_weights
from robins.kalman.filter import run_filter
from robins.kalman.predict import Ekf
from robins.kalman.update import update, workspace
from robins.kalman.weights import weighting

SEEDS = st.integers(0, 2**32 - 1)
INCREMENTS = {"sequential": SEQUENTIAL, "marginal": MARGINAL, "temporal": TEMPORAL}
SHAPES = {"lin/lin": LINEAR, "sqrt/lin": ROOT, "lin/reject": REJECT}
QUANTILE = chi2.ppf(0.95, 1)


def weights_of(method, innovation, predicted, R, memory=None, epoch=0):
    weights = np.ones(len(innovation))
    memory = method.memory.copy() if memory is None else memory
    chi_square_weights(np.asarray(innovation, float), predicted, R, method.parameters, memory, epoch, weights)
    return weights


def increments_of(increment, innovation, predicted, R):
    """The increments themselves: with a lower bound next to zero the weight is quantile over increment."""
    m = len(innovation)
    return QUANTILE / weights_of(chi_square(m, increment, LINEAR, 0.95, 1e-300, np.inf), innovation, predicted, R)


def make(seed, random_covariance, m=6, diagonal=False):
    """Innovation, predicted and R of a random update."""
    rng = np.random.default_rng(seed)
    predicted, R = random_covariance(rng, m), random_covariance(rng, m)
    if diagonal:
        predicted, R = np.diag(np.diag(predicted)), np.diag(np.diag(R))
    return 2.0 * rng.normal(size=m), predicted, R


@given(SEEDS, st.integers(1, 8))
def test_sequential_increments_sum_to_the_chi_square_of_the_innovation(random_covariance, seed, m):
    innovation, predicted, R = make(seed, random_covariance, m)
    expected = innovation @ np.linalg.solve(predicted + R, innovation)
    assert np.sum(increments_of(SEQUENTIAL, innovation, predicted, R)) == pytest.approx(expected, rel=1e-13)


@given(SEEDS, st.integers(1, 6))
def test_sequential_increments_are_those_of_a_filter_that_takes_one_channel_after_the_other(random_covariance, seed, m):
    """Scalar updates with a diagonal R: ``(y_i - h_i x_{i-1})^2 / (h_i P_{i-1} h_i^T + r_i)``."""
    rng = np.random.default_rng(seed)
    H, P, r, x = rng.normal(size=(m, 4)), random_covariance(rng, 4), rng.uniform(0.5, 2.0, m), np.zeros(4)
    innovation = 2.0 * rng.normal(size=m)
    whole, expected = H @ P @ H.T, []
    for h, y, noise in zip(H, innovation, r, strict=True):
        S = h @ P @ h + noise
        gain, residual = P @ h / S, y - h @ x
        expected.append(residual**2 / S)
        x, P = x + gain * residual, P - np.outer(gain, gain) * S
    actual = increments_of(SEQUENTIAL, innovation, whole, np.diag(r))
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-14 * np.sum(expected))


def test_sequential_increments_follow_chi_square_of_one_degree_and_are_independent(random_covariance):
    _, predicted, R = make(7, random_covariance)
    rng, draws = np.random.default_rng(1), 33_334
    y = rng.standard_normal((draws, 6)) @ np.linalg.cholesky(predicted + R).T
    increments = np.array([increments_of(SEQUENTIAL, row, predicted, R) for row in y])
    assert increments.size > 2e5
    assert np.mean(increments > 3.841) == pytest.approx(0.050, abs=0.002)
    correlation = np.corrcoef(increments.T) - np.eye(6)
    assert np.abs(correlation).max() < 5 / np.sqrt(draws)


@given(SEEDS)
def test_marginal_increments_are_squares_in_units_of_the_variance(random_covariance, seed):
    innovation, predicted, R = make(seed, random_covariance)
    expected = innovation**2 / np.diag(predicted + R)
    np.testing.assert_allclose(increments_of(MARGINAL, innovation, predicted, R), expected, rtol=1e-14)


@given(SEEDS)
def test_marginal_and_sequential_increments_are_the_same_without_correlation(random_covariance, seed):
    case = make(seed, random_covariance, diagonal=True)
    np.testing.assert_allclose(increments_of(SEQUENTIAL, *case), increments_of(MARGINAL, *case), rtol=1e-14)


def test_sequential_increments_depend_on_the_order_of_correlated_channels_and_marginal_ones_do_not():
    """An innovation of (3, 1) with correlation 0.8: the sum stays, who comes first explains a part of the other."""
    S, order = np.array([[1.0, 0.8], [0.8, 1.0]]), [1, 0]
    y, zero = np.array([3.0, 1.0]), np.zeros((2, 2))
    np.testing.assert_allclose(increments_of(SEQUENTIAL, y, zero, S), [9.0, (1.0 - 2.4) ** 2 / 0.36], rtol=1e-13)
    np.testing.assert_allclose(increments_of(SEQUENTIAL, y[order], zero, S), [1.0, (3.0 - 0.8) ** 2 / 0.36], rtol=1e-13)
    np.testing.assert_allclose(increments_of(MARGINAL, y, zero, S), [9.0, 1.0], rtol=1e-14)
    np.testing.assert_allclose(increments_of(MARGINAL, y[order], zero, S), [1.0, 9.0], rtol=1e-14)


@pytest.mark.parametrize("name", ["sequential", "marginal"])
@given(seed=SEEDS)
def test_units_and_signs_do_not_matter(random_covariance, name, seed):
    innovation, predicted, R = make(seed, random_covariance)
    D = np.diag(np.random.default_rng(seed).choice([-1.0, 1.0], 6) * 2.0 ** np.arange(-9, 9, 3))
    scaled = increments_of(INCREMENTS[name], D @ innovation, D @ predicted @ D, D @ R @ D)
    np.testing.assert_allclose(scaled, increments_of(INCREMENTS[name], innovation, predicted, R), rtol=1e-9)


def test_temporal_increments_are_the_change_of_the_statistic_for_all_channels_and_zero_where_it_falls():
    method = chi_square(2, TEMPORAL, LINEAR, 0.95, 1.0, np.inf)
    memory, eye, zero = method.memory.copy(), np.eye(2), np.zeros((2, 2))
    expected = [1.0, (41.0 - 8.0) / QUANTILE, 1.0, (50.0 - 2.0) / QUANTILE]  # statistics 8, 41, 2, 50; the first has nothing before it
    for epoch, (y, alpha) in enumerate(zip([(2.0, 2.0), (4.0, 5.0), (1.0, 1.0), (5.0, 5.0)], expected, strict=True)):
        np.testing.assert_allclose(weights_of(method, y, zero, eye, memory, epoch), 1 / alpha, rtol=1e-14)


@pytest.mark.parametrize(("n", "expected", "tolerance"), [(6, 0.195, 0.002), (1, 0.0338, 0.001)])
def test_temporal_increments_do_not_follow_chi_square_of_one_degree(n, expected, tolerance):
    """imani2026 equation (34) has 0.05 for (30): exceedance of 3.841 by the difference of two chi^2(n), analytic and drawn."""
    analytic = quad(lambda u: chi2.sf(chi2.ppf(u, n) + 3.841, n), 0.0, 1.0)[0]
    assert analytic == pytest.approx(expected, abs=5e-4)
    method = chi_square(n, TEMPORAL, LINEAR, chi2.cdf(3.841, 1), 1.0, np.inf)
    memory, weights, zero, eye = method.memory.copy(), np.ones(n), np.zeros((n, n)), np.eye(n)
    exceeded, draws = 0, 200_000
    for epoch, y in enumerate(np.random.default_rng(2).standard_normal((draws, n))):
        chi_square_weights(y, zero, eye, method.parameters, memory, epoch, weights)
        exceeded += weights[0] < 1.0
    assert exceeded / draws == pytest.approx(expected, abs=tolerance)


def factors(shape, ratios, lower, upper, correct=False, S=2.0, R=0.5):
    """alpha at the given ratios; one channel each, through the marginal increment."""
    m = len(ratios)
    method = chi_square(m, MARGINAL, shape, 0.95, lower, upper, correct)
    weights = weights_of(method, np.sqrt(np.asarray(ratios) * QUANTILE * S), (S - R) * np.eye(m), R * np.eye(m))
    with np.errstate(divide="ignore"):
        return 1 / weights


def test_the_three_shapes_of_the_factor():
    """imani2026 equation (35) with c_0 = 1.5, c_1 = 3."""
    ratios = [0.0, 1.0, 1.49, 2.0, 2.99, 4.0, 100.0]
    np.testing.assert_allclose(factors(LINEAR, ratios, 1.5, 3.0), [1, 1, 1, 2, 2.99, 4, 100], rtol=1e-13)
    np.testing.assert_allclose(factors(ROOT, ratios, 1.5, 3.0), [1, 1, 1, np.sqrt(2), np.sqrt(2.99), 4, 100], rtol=1e-13)
    np.testing.assert_allclose(factors(REJECT, ratios, 1.5, 3.0), [1, 1, 1, 2, 2.99, np.inf, np.inf], rtol=1e-13)


@pytest.mark.parametrize("probability", [0.90, 0.95, 0.99])
def test_the_ratio_is_to_the_quantile_of_one_degree_of_freedom(probability):
    assert chi_square(6, SEQUENTIAL, LINEAR, probability, 1.0, 3.0).parameters[2] == pytest.approx(chi2.ppf(probability, 1), rel=1e-12)


def test_a_lower_bound_under_one_gives_weights_above_one_as_printed():
    np.testing.assert_allclose(factors(LINEAR, [0.4, 0.8], 0.5, 3.0), [1.0, 0.8], rtol=1e-13)
    np.testing.assert_allclose(factors(ROOT, [0.4, 0.64], 0.5, 3.0), [1.0, 0.8], rtol=1e-13)


def test_the_corrected_factor_inflates_the_innovation_variance_by_the_printed_one():
    ratios = np.array([0.8, 1.0, 2.0, 5.0])
    alpha = factors(LINEAR, ratios, 0.5, 3.0, correct=True, S=2.0, R=0.5)
    np.testing.assert_allclose(alpha, [1.0, 1.0, 1 + 1 * 4, 1 + 4 * 4], rtol=1e-12)
    assert factors(REJECT, [5.0], 1.0, 3.0, correct=True)[0] == np.inf


@given(SEEDS, st.sampled_from([SEQUENTIAL, MARGINAL]))
def test_after_the_correction_the_statistic_is_at_its_threshold_and_as_printed_above_it(random_covariance, seed, increment):
    """Proposition 5: ``y^2 / (P + alpha R)`` with a diagonal S."""
    innovation, predicted, R = make(seed, random_covariance, diagonal=True)
    P, r = np.diag(predicted), np.diag(R)
    printed, right = (1 / weights_of(chi_square(6, increment, LINEAR, 0.95, 1.0, 3.0, c), innovation, predicted, R) for c in (False, True))
    outlying = innovation**2 / (P + r) > QUANTILE
    np.testing.assert_allclose((innovation**2 / (P + right * r))[outlying], QUANTILE, rtol=1e-12)
    assert np.all((innovation**2 / (P + printed * r))[outlying] > QUANTILE)
    np.testing.assert_array_equal(right[~outlying], 1.0)


@given(SEEDS)
def test_with_correlated_channels_the_correction_of_one_sequential_channel_leaves_it_below_the_threshold(random_covariance, seed):
    """The last channel re-weighted alone: of the threshold it has ``L_ii^2 rho / (L_ii^2 + (rho - 1) S_ii)``, at most one."""
    innovation, predicted, R = make(seed, random_covariance, 3)
    R = np.diag(np.diag(R))
    innovation[2] += 30.0
    weights = weights_of(chi_square(3, SEQUENTIAL, LINEAR, 0.95, 1.0, 3.0, True), innovation, predicted, R)
    inflated = R.copy()
    inflated[2, 2] /= weights[2]
    assert 0.0 < increments_of(SEQUENTIAL, innovation, predicted, inflated)[2] <= QUANTILE * (1 + 1e-12)


def test_a_channel_without_noise_has_none_to_correct():
    method = chi_square(2, MARGINAL, LINEAR, 0.95, 1.0, 3.0, True)
    np.testing.assert_array_equal(weights_of(method, [9.0, 0.1], np.eye(2), np.diag([0.0, 1.0])), 1.0)


def scalar_update(method, y, P, R=1.0):
    """Gain and state correction of one weighted update of one state."""
    x, covariance, work, zero = np.zeros(1), np.array([[P]]), workspace(1, 1), np.zeros((1, 1))
    innovation, noise = np.array([y]), np.array([[R]])
    weights = weights_of(method, innovation, covariance, noise)
    update(x, covariance, innovation, np.eye(1), noise, zero, zero, False, weights, work)
    return work.K[0, 0], x[0]


@pytest.mark.parametrize(
    ("ratio", "expected"), [(17.6, [0.946, 0.514, 0.057]), (1.0, [0.500, 0.057, 0.030]), (0.04, [0.0385, 0.0024, 0.0023])]
)
def test_the_printed_factor_hardly_lowers_the_gain_where_the_prediction_is_uncertain(ratio, expected):
    """Proposition 5 and A10 of the wing: an innovation of 8 standard deviations, beta = 0.95, ``ratio`` = P / R.

    Gains of the plain filter, with the printed factor, with the corrected one.
    """
    y = 8.0 * np.sqrt(ratio + 1.0)
    methods = [
        chi_square(1, SEQUENTIAL, LINEAR, 0.95, lower, np.inf, correct) for lower, correct in ((np.inf, False), (1, False), (1, True))
    ]
    gains = [scalar_update(method, y, ratio)[0] for method in methods]
    np.testing.assert_allclose(gains, expected, rtol=0, atol=5e-4 if ratio >= 1.0 else 5e-5)
    rho = 64.0 / QUANTILE
    assert rho == pytest.approx(16.66, abs=0.005)
    analytic = ratio / np.array([ratio + 1.0, ratio + rho, (ratio + 1.0) * rho])
    np.testing.assert_allclose(gains, analytic, rtol=1e-12)


def test_the_influence_of_an_outlier_falls_stays_or_ends_with_the_shape():
    """Proposition 6, a channel dominated by R: as 1/y (Cauchy) for lin, constant (Huber) for sqrt, none for reject."""
    P, y = 1e-9, np.array([2.5, 5.0, 10.0])
    moved = {
        shape: np.array([scalar_update(chi_square(1, SEQUENTIAL, shape, 0.95, 1.0, upper), value, P)[1] for value in y]) / P
        for shape, upper in ((LINEAR, 3.0), (ROOT, np.inf), (REJECT, 1.0))
    }
    np.testing.assert_allclose(moved[LINEAR], QUANTILE / y, rtol=1e-7)
    np.testing.assert_allclose(moved[ROOT], np.sqrt(QUANTILE), rtol=1e-7)
    np.testing.assert_array_equal(moved[REJECT], 0.0)


@given(SEEDS, st.sampled_from(sorted(INCREMENTS)), st.sampled_from(sorted(SHAPES)), st.booleans(), st.floats(1.0, 3.0))
def test_weights_lie_between_zero_and_one_with_a_lower_bound_from_one_on(random_covariance, seed, increment, shape, correct, lower):
    method = chi_square(6, INCREMENTS[increment], SHAPES[shape], 0.95, lower, 3.0, correct)
    memory = method.memory.copy()
    for epoch in range(3):
        weights = weights_of(method, *make(seed + epoch, random_covariance), memory, epoch)
        assert np.all((weights >= 0.0) & (weights <= 1.0))


@pytest.mark.parametrize("correct", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("increment", INCREMENTS)
def test_a_lower_bound_out_of_reach_is_the_plain_filter_to_the_last_bit(problem, increment, shape, correct):
    case = problem(5)
    plain, limited, endless, active = (
        run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)
        for method in (
            weighting("unit"),
            chi_square(3, INCREMENTS[increment], SHAPES[shape], 0.95, 1e12, np.inf, correct),
            chi_square(3, INCREMENTS[increment], SHAPES[shape], 0.95, np.inf, np.inf, correct),
            chi_square(3, INCREMENTS[increment], SHAPES[shape], 0.95, 1.0, 3.0, correct),
        )
    )
    for limit in (limited, endless):
        np.testing.assert_array_equal(limit.posterior, plain.posterior)
        np.testing.assert_array_equal(limit.posterior_variance, plain.posterior_variance)
    assert np.abs(active.posterior - plain.posterior).max() > 0.01
    assert np.all(active.failed == -1)


def test_a_run_starts_without_the_memory_of_the_one_before(problem):
    """The temporal increment remembers a statistic; two runs of the same measurements are the same."""
    case = problem(6)
    twice = case._replace(x0=case.x0[[0, 0]], measurements=case.measurements[[0, 0]])
    record = run_filter(Ekf(), case.model, case.sensor, chi_square(3, TEMPORAL, LINEAR, 0.95, 1.0, 3.0), *twice.arguments, 4, False)
    np.testing.assert_array_equal(record.weights[0], record.weights[1])
    assert np.nanmin(record.weights) < 1.0


def test_without_a_definite_covariance_the_weights_stay_and_the_update_fails():
    y, predicted, R = np.ones(2), np.array([[0.0, 3.0], [3.0, 0.0]]), np.eye(2)
    weights = weights_of(chi_square(2, SEQUENTIAL, LINEAR, 0.95, 1.0, 3.0), y, predicted, R)
    np.testing.assert_array_equal(weights, 1.0)
    zero = np.zeros((2, 2))
    assert np.isnan(update(np.zeros(2), predicted, y, np.eye(2), R, zero, zero, False, weights, workspace(2, 2)))


def test_a_filter_with_other_channels_is_refused(problem):
    case = problem(7)
    with pytest.raises(ValueError, match="channels: the filter's number of measurements"):
        run_filter(Ekf(), case.model, case.sensor, chi_square(2, SEQUENTIAL, LINEAR, 0.95, 1.0, 3.0), *case.arguments, 4, False)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"increment": 3}, "^increment: 3 is none of SEQUENTIAL, MARGINAL, TEMPORAL$"),
        ({"shape": -1}, "^shape: -1 is none of LINEAR, ROOT, REJECT$"),
        ({"probability": 0.0}, "^probability: 0 is not between 0 and 1$"),
        ({"probability": 1.0}, "^probability: "),
        ({"probability": np.nan}, "^probability: "),
        ({"lower": 0.0}, "^lower: 0 is not positive$"),
        ({"lower": -1.0}, "^lower: "),
        ({"lower": np.nan}, "^lower: "),
        ({"upper": np.nan}, "^upper: nan is not positive$"),
        ({"lower": 4.0}, "^lower: 4 exceeds upper, 3$"),
    ],
)
def test_constants_without_meaning_are_refused(changed, message):
    constants = {"channels": 6, "increment": SEQUENTIAL, "shape": LINEAR, "probability": 0.95, "lower": 1.0, "upper": 3.0}
    with pytest.raises(ValueError, match=message):
        chi_square(**{**constants, **changed})
