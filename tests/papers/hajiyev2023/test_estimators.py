"""The study's filters: independent implementations, limits and rules."""

import numpy as np
import pytest
from scipy.stats import chi2

from robins.kalman.tuning import GATED, covariance_matching, matching
from robins.kalman.weights import weighting
from robins.papers.hajiyev2023.ensemble import without_fault
from robins.papers.hajiyev2023.estimators import (
    augmented,
    classical,
    corrected,
    gate_threshold,
    late,
    measurements,
    oracle,
    printed,
)
from robins.papers.hajiyev2023.scenario import Q_CHANNEL, STEADY, THETA_CHANNEL, controls

RULES = ("per-channel", "gated", "scalar-trace", "scalar-mean")
ADAPTIVE = {"printed": printed, "corrected": corrected, "augmented": augmented, "late": late}


@pytest.mark.parametrize(
    "build",
    [lambda m, p: classical(m, p), lambda m, p: classical(m, p, inflated=True), lambda m, p: augmented(m, p)],
    ids=["ckf", "ckf-inflated", "akf"],
)
def test_filters_on_z_are_the_conditional_mean_of_the_joint_gaussian(problem, joint_gaussian, build):
    """Independent implementation: all states conditioned on all measurements at once (batch)."""
    case = problem(2)
    form, last = build(case.matrices, case.parameters), 10
    record = case.run(form)
    start = np.concatenate([case.ensemble.guess[0], np.zeros(len(form.P0) - 8)])
    z = case.ensemble.z["healthy"][0, : last + 1]
    mean, covariance = joint_gaussian(*form.model, form.sensor.H, form.sensor.R, start, form.P0, controls(case.parameters), z)
    for k, estimate, variance in ((last, record.posterior, record.posterior_variance), (last - 1, record.delayed, record.delayed_variance)):
        np.testing.assert_allclose(estimate[0, k], mean[k, :8], rtol=0, atol=1e-9)
        np.testing.assert_allclose(variance[0, k], np.diag(covariance[k])[:8], rtol=1e-9)


def textbook(form, parameters, z, inputs, start, adaptive=True):
    """Any form of one run in plain numpy: inverses, the short covariance form, the per-channel rule with its own window.

    Independent implementation of the update, of covariance matching and of the correction of the prediction.
    Returns prior, posterior ``(N+1, 8)`` and scale factors ``(N+1, 8)``.
    """
    A, B, Q = form.model
    H, D, R, fixed, at_update, at_prediction = form.sensor
    x, P, window = start.copy(), form.P0.copy(), parameters.window
    seen, prior, posterior, factors = [], [], [], np.full(z.shape, np.nan)
    for k in range(len(z)):
        prior.append(x[:8])
        carried, shift = 0.0, 0.0
        if form.valid[k]:
            innovation = z[k] - H @ x - D @ inputs[k]
            seen.append(innovation**2)
            rest = H @ P @ H.T + fixed + H @ at_update + at_update.T @ H.T
            s = np.ones(8)
            if adaptive and len(seen) >= window:
                s = np.maximum(1.0, (np.mean(seen[-window:], axis=0) - np.diag(rest)) / np.diag(R))
            inverse = np.linalg.inv(rest + s[:, None] * R)
            cross = P @ H.T + at_update
            joint = A @ cross + at_prediction
            carried, shift = joint @ inverse @ joint.T - A @ cross @ inverse @ cross.T @ A.T, at_prediction @ inverse @ innovation
            x, P = x + cross @ inverse @ innovation, P - cross @ inverse @ cross.T
            factors[k] = s
        posterior.append(x[:8])
        P = (P + P.T) / 2
        x, P = A @ x + B @ inputs[k] + shift, A @ P @ A.T + Q - carried
    return np.array(prior), np.array(posterior), factors


@pytest.mark.parametrize("name", ADAPTIVE)
def test_adaptive_filters_are_the_textbook_form(problem, name):
    case = problem(2)
    form = ADAPTIVE[name](case.matrices, case.parameters, "per-channel")
    record = case.run(form, "fault")
    inputs = controls(case.parameters)
    z = measurements(form.reads, case.ensemble, "fault", case.matrices, inputs)[1]
    start = np.concatenate([case.ensemble.guess[1], np.zeros(len(form.P0) - 8)])
    prior, posterior, factors = textbook(form, case.parameters, z, inputs, start)
    scale = np.sqrt(record.posterior_variance[1])
    np.testing.assert_allclose((record.prior[1] - prior) / scale, 0.0, rtol=0, atol=1e-10)
    np.testing.assert_allclose((record.posterior[1] - posterior) / scale, 0.0, rtol=0, atol=1e-10)
    np.testing.assert_allclose(1.0 / record.weights[1], factors, rtol=1e-10)
    assert np.nanmax(factors) > 10


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("name", ADAPTIVE)
def test_an_infinite_window_gives_the_plain_filter(problem, name, rule):
    case = problem(3, window=500)
    adaptive = case.run(ADAPTIVE[name](case.matrices, case.parameters, rule), "fault")
    plain = case.run(ADAPTIVE[name](case.matrices, case.parameters), "fault")
    np.testing.assert_allclose(adaptive.posterior, plain.posterior, rtol=0, atol=1e-10)
    np.testing.assert_allclose(adaptive.posterior_variance, np.broadcast_to(plain.posterior_variance, adaptive.posterior.shape), rtol=1e-10)


def test_oracle_without_a_fault_is_the_augmented_filter(problem):
    case = problem(3)
    told = case.run(oracle(case.matrices, without_fault(case.parameters)))
    plain = case.run(augmented(case.matrices, case.parameters))
    np.testing.assert_array_equal(told.posterior, plain.posterior)


def test_oracle_scales_the_noise_of_two_channels_while_the_fault_lasts(problem):
    weights = oracle(problem(1).matrices, problem(1).parameters).weights
    expected = np.ones((201, 8))
    expected[80:151, Q_CHANNEL], expected[80:151, THETA_CHANNEL] = 1 / 64, 1 / 25
    np.testing.assert_allclose(weights, expected, rtol=1e-15)


def test_oracle_told_through_the_weight_function_is_the_oracle(problem):
    """Two roads: gains computed beforehand, and the weights handed to the filter update by update."""
    case = problem(3)
    form = oracle(case.matrices, case.parameters)
    told = case.run(form._replace(weights=weighting("known", memory=form.weights)), "fault")
    planned = case.run(form, "fault")
    np.testing.assert_allclose(told.posterior, planned.posterior, rtol=0, atol=1e-10)
    np.testing.assert_allclose(told.nis, planned.nis, rtol=1e-10)


@pytest.mark.parametrize(("threshold", "reference"), [(1e12, ""), (0.0, "per-channel")], ids=["never", "always"])
def test_a_gate_that_never_opens_gives_mdkf_and_one_always_open_gives_amdkf(problem, threshold, reference):
    case = problem(3)
    gated = printed(case.matrices, case.parameters, "gated")._replace(weights=matching(20, 8, GATED, threshold))
    expected = case.run(printed(case.matrices, case.parameters, reference), "fault")
    np.testing.assert_allclose(case.run(gated, "fault").posterior, expected.posterior, rtol=0, atol=1e-10)


def test_gate_threshold_lets_one_healthy_window_in_a_thousand_through():
    source = np.random.default_rng(3)
    means = np.mean(source.standard_normal((200_000, 20)) ** 2, axis=1)
    assert np.mean(means > gate_threshold(20)) == pytest.approx(0.001, abs=0.0003)


def test_gate_leaves_healthy_channels_alone_and_opens_for_the_faulty_ones(problem):
    case = problem(20)
    weights = case.run(printed(case.matrices, case.parameters, "gated"), "fault").weights[:, STEADY]
    opened = np.mean(weights < 1.0, axis=(0, 1))
    assert np.all(opened[[Q_CHANNEL, THETA_CHANNEL]] > 0.95)
    assert np.all(np.delete(opened, [Q_CHANNEL, THETA_CHANNEL]) < 0.02)


@pytest.mark.parametrize("rule", ["scalar-trace", "scalar-mean"])
def test_scalar_rules_give_one_factor_to_all_channels(problem, rule):
    """With one factor and a diagonal R, the factor follows from the innovations and the variance S of the record itself."""
    case = problem(2)
    record = case.run(printed(case.matrices, case.parameters, rule), "fault")
    factors = 1.0 / record.weights[:, 1:-1]
    np.testing.assert_array_equal(factors, np.broadcast_to(factors[..., :1], factors.shape))
    R = np.diag(printed(case.matrices, case.parameters).sensor.R)
    k = 120
    predicted = record.innovation_variance[:, k] - R * factors[:, k - 1]
    excess = np.mean(record.innovation[:, k - 19 : k + 1] ** 2, axis=1) - predicted
    expected = excess.sum(axis=1) / R.sum() if rule == "scalar-trace" else np.mean(excess / R, axis=1)
    np.testing.assert_allclose(factors[:, k - 1, 0], np.maximum(1.0, expected), rtol=1e-9)


def test_fault_raises_the_matching_factors(problem):
    case = problem(20)
    form = printed(case.matrices, case.parameters, "per-channel")
    fault, healthy = (np.mean(1 / case.run(form, condition).weights[:, STEADY], axis=(0, 1)) for condition in ("fault", "healthy"))
    raised = fault / healthy
    assert set(np.argsort(raised)[-2:]) == {Q_CHANNEL, THETA_CHANNEL}
    assert np.all(np.sort(raised)[-2:] > 5) and np.all(np.sort(raised)[:-2] < 2)


def test_the_lower_bound_raises_the_factors_of_a_healthy_filter(problem):
    """A permanent false alarm: s_i = 1 would be right in every channel."""
    case = problem(50)
    for build in (printed, corrected, augmented):
        weights = case.run(build(case.matrices, case.parameters, "per-channel")).weights[:, STEADY]
        assert np.all(np.mean(1 / weights, axis=(0, 1)) > 1.05)


def test_the_mean_of_a_bounded_factor_is_that_of_a_rectified_chi_square():
    """White innovations of the predicted variance: E[max(1, chi2_M / M)] by quadrature, about 1 + 0.564 / sqrt(M)."""
    window, epochs = 20, 100_000
    memory, weights, factors = np.zeros((window, 1)), np.ones(1), np.empty(epochs)
    rule = matching(window, 1)
    source = np.random.default_rng(5).standard_normal((epochs, 1))
    for k in range(epochs):
        covariance_matching(source[k], np.zeros((1, 1)), np.eye(1), rule.parameters, memory, k, weights)
        factors[k] = 1 / weights[0]
    exact = chi2.expect(lambda total: np.maximum(1.0, total / window), args=(window,))
    assert np.mean(factors[window:]) == pytest.approx(exact, abs=0.01)
    assert exact == pytest.approx(1 + 0.564 / np.sqrt(window), abs=0.005)


def test_one_factor_is_never_below_one(problem):
    case = problem(10)
    for rule in RULES:
        weights = case.run(printed(case.matrices, case.parameters, rule), "healthy").weights[:, 1:-1]
        assert np.all((weights > 0) & (weights <= 1.0))


def test_no_factor_before_the_window_is_full(problem):
    case = problem(5)
    weights = case.run(printed(case.matrices, case.parameters, "per-channel"), "healthy").weights
    assert np.all(weights[:, 1:20] == 1.0)
    assert np.any(weights[:, 20] < 1.0)
    partial = case.run(printed(case.matrices, case.parameters, "per-channel", minimum=1), "healthy").weights
    assert np.any(partial[:, 1] < 1.0)


def test_without_c_the_gain_is_that_of_uncorrelated_noise(problem):
    case = problem(1)
    form = printed(case.matrices, case.parameters, cross=False)
    assert not form.sensor.C_update.any() and not form.sensor.C_predict.any()
    assert np.any(case.run(form).posterior[0, 1:-1] != case.run(printed(case.matrices, case.parameters)).posterior[0, 1:-1])


def test_each_form_processes_the_epochs_that_its_measurement_exists_for(problem):
    m, p = problem(1).matrices, problem(1).parameters
    for form, first, last in ((classical(m, p), 0, 200), (augmented(m, p), 0, 200), (printed(m, p), 1, 199), (corrected(m, p), 0, 199),
                              (late(m, p), 1, 200)):  # fmt: skip
        assert np.flatnonzero(form.valid).tolist() == list(range(first, last + 1))


def test_late_form_reads_the_previous_difference_without_its_input(problem):
    case = problem(2)
    m, inputs = case.matrices, controls(case.parameters)
    z = case.ensemble.z["fault"]
    shifted = measurements("mu-late", case.ensemble, "fault", m, inputs)
    expected = z[:, 1:] - z[:, :-1] @ m.A_n.T - inputs[:-1] @ (m.H @ m.B).T
    np.testing.assert_allclose(shifted[:, 1:], expected, rtol=0, atol=1e-13)
