"""What the printed equations say and what follows from them: the composed filter is them, and each defect shows."""

import numpy as np
import pytest

from robins.foundation.randomness import stream
from robins.kalman.differencing import differenced_measurements
from robins.kalman.filter import schedule
from robins.kalman.predict import Ekf
from robins.kalman.update import weighted_noise
from robins.papers.hajiyev2023.as_printed import literal, scale_matrix
from robins.papers.hajiyev2023.ensemble import scores
from robins.papers.hajiyev2023.estimators import corrected, late, printed
from robins.papers.hajiyev2023.scenario import Draws, controls, differenced, simulate
from robins.papers.hajiyev2023.studies import differenced_noise

NO_V = {"sigma_v": (0.0,) * 8}
W = 1
"""Vertical velocity: the state that the doublets move most."""


@pytest.mark.parametrize("branch", ["deg", "rad"])
@pytest.mark.parametrize(("rule", "window"), [("", 500), ("per-channel", 20)], ids=["mdkf", "amdkf"])
def test_composed_filter_is_the_printed_equations(problem, branch, rule, window):
    case = problem(3, branch)
    record = case.run(printed(case.matrices, case.parameters, rule), "fault")
    estimate, variance = literal(case.parameters, case.matrices, case.ensemble, "fault", window)
    scored = slice(1, case.parameters.steps)
    assert np.all(np.isnan(estimate[:, [0, -1]]))
    scale = np.sqrt(variance[:, scored])
    np.testing.assert_allclose((record.posterior[:, scored] - estimate[:, scored]) / scale, 0.0, rtol=0, atol=1e-10)
    np.testing.assert_allclose(
        np.broadcast_to(record.posterior_variance[:, scored], variance[:, scored].shape), variance[:, scored], rtol=1e-10
    )


def test_e1_xi_is_a_moving_average_of_first_order_and_white_only_without_v(problem):
    for changes, white in (({}, False), (NO_V, True)):
        case = problem(200, scenario="tests-xi", **changes)
        xi = differenced_noise(case.parameters, case.matrices, case.ensemble)
        lags = [np.mean(xi[:, : xi.shape[1] - lag] * xi[:, lag:], axis=(0, 1)) / np.mean(xi**2, axis=(0, 1)) for lag in range(5)]
        d = differenced(case.matrices)
        expected = -np.diag(case.matrices.A_n @ case.matrices.Q_v) / np.diag(d.R_process + d.R_sensor)
        assert np.all(expected == 0.0) if white else np.all(expected < -0.2)
        np.testing.assert_allclose(lags[1], expected, rtol=0, atol=0.03)
        np.testing.assert_allclose(lags[2:], 0.0, rtol=0, atol=0.03)


def test_xi_and_the_noise_of_the_coming_step_have_the_covariances_of_equations_10_and_11(problem):
    case = problem(400, scenario="tests-xi")
    xi = differenced_noise(case.parameters, case.matrices, case.ensemble)
    x, inputs = case.ensemble.x, controls(case.parameters)
    w = x[:, 1:] - x[:, :-1] @ case.matrices.A.T - inputs[:-1] @ case.matrices.B.T
    d, count = differenced(case.matrices), xi[..., 0].size
    R, scale_w = d.R_process + d.R_sensor, np.maximum(np.sqrt(np.diag(case.matrices.Q)), 1e-9)
    scale = np.sqrt(np.diag(R))
    np.testing.assert_allclose(np.mean(xi, axis=(0, 1)) / scale, 0.0, rtol=0, atol=0.02)
    np.testing.assert_allclose(
        np.einsum("rki,rkj->ij", xi, xi) / count / np.outer(scale, scale), R / np.outer(scale, scale), rtol=0, atol=0.03
    )
    np.testing.assert_allclose(
        np.einsum("rki,rkj->ij", w, xi) / count / np.outer(scale_w, scale), d.C / np.outer(scale_w, scale), rtol=0, atol=0.03
    )
    later = np.einsum("rki,rkj->ij", w[:, :-1], xi[:, 1:]) / count / np.outer(scale_w, scale)
    np.testing.assert_allclose(later, 0.0, rtol=0, atol=0.03, err_msg="w(k-1), which x(k) has felt, is not correlated with xi(k)")


def first_innovations(problem, runs):
    """Innovations of the printed filter at k = 1, without v: before any gain could have been wrong."""
    case = problem(1, steps=2, **NO_V)
    source = stream(1, "hajiyev2023/tests-first-innovation/0/all")
    noise = [source.standard_normal((runs, 3, 8)) for _ in range(3)]
    draws = Draws(*noise, source.standard_normal((runs, 8)), source.standard_normal((runs, 8)))
    case = case._replace(ensemble=simulate(case.parameters, case.matrices, draws))
    return case, case.run(printed(case.matrices, case.parameters)).innovation[:, 1]


def test_e2_innovation_covariance_has_no_c_in_it(problem):
    runs = 20_000
    case, innovation = first_innovations(problem, runs)
    m, d = case.matrices, differenced(case.matrices)
    prior = m.A @ m.P0 @ m.A.T + m.Q
    true = d.H_d @ prior @ d.H_d.T + d.R_process + d.R_sensor
    as_printed = true + d.H_d @ d.C + d.C.T @ d.H_d.T  # (18)
    sampled = innovation.T @ innovation / runs
    error = np.sqrt((np.outer(np.diag(true), np.diag(true)) + true**2) / runs)
    assert np.max(np.abs(sampled - true) / error) < 4.5
    assert np.max(np.abs(sampled - as_printed) / error) > 20


def true_covariances(case):
    """Innovation covariance that the printed gains really lead to, without v, and the one of equation (18); both (N+1, 8, 8).

    Independent covariance analysis of a filter with any gain: the error obeys ``e+ = (I - K H_d) e- - K xi`` and
    ``e- = A e+ + G w`` with ``E[xi (G w)^T] = C^T``.
    """
    m, d, form = case.matrices, differenced(case.matrices), printed(case.matrices, case.parameters)
    plan = schedule(Ekf(), form.model, form.sensor, form.P0, form.weights, form.valid, 8, False)
    R, cross = d.R_process + d.R_sensor, d.H_d @ d.C + d.C.T @ d.H_d.T
    P = m.A @ m.P0 @ m.A.T + m.Q
    true, claimed = np.full((2, case.parameters.steps + 1, 8, 8), np.nan)
    for k in range(1, case.parameters.steps):
        true[k] = d.H_d @ P @ d.H_d.T + R
        claimed[k] = d.H_d @ plan.prior_covariance[k] @ d.H_d.T + R + cross
        K, rest = plan.gain[k], np.eye(8) - plan.gain[k] @ d.H_d
        after = rest @ P @ rest.T + K @ R @ K.T
        P = m.A @ after @ m.A.T + m.Q - m.A @ K @ d.C.T - d.C @ K.T @ m.A.T
    return true, claimed


def test_e3_statement_1_is_false_even_without_v(problem):
    case = problem(400, **NO_V)
    innovation = case.run(printed(case.matrices, case.parameters)).innovation
    true, claimed = true_covariances(case)
    epochs = np.arange(30, case.parameters.steps)
    sampled = np.einsum("rki,rkj->ij", innovation[:, epochs], innovation[:, epochs]) / (len(innovation) * len(epochs))
    for expected, holds in ((true[epochs].mean(axis=0), True), (claimed[epochs].mean(axis=0), False)):
        scale = np.sqrt(np.diag(expected))
        worst = np.max(np.abs(sampled - expected) / np.outer(scale, scale))
        assert worst < 0.03 if holds else worst > 0.1


def test_e3_innovations_of_the_printed_filter_are_not_white_with_v(problem):
    case = problem(100)
    innovation = case.run(printed(case.matrices, case.parameters)).innovation[:, 30:-1]
    lag = np.sum(innovation[:, 1:] * innovation[:, :-1], axis=(0, 1)) / np.sum(innovation**2, axis=(0, 1))
    assert np.all(lag < -0.1)


def test_equation_14_is_the_optimal_gain_of_the_other_textbook_case(problem):
    """If the *prior* error were correlated with the noise, E[e xi^T] = C, no gain would beat (14), and (16) would be its covariance."""
    case = problem(1)
    m, d = case.matrices, differenced(case.matrices)
    P, R = m.A @ m.P0 @ m.A.T + m.Q, d.R_process + d.R_sensor
    bracket = d.H_d @ P @ d.H_d.T + R + d.H_d @ d.C + d.C.T @ d.H_d.T
    best = (P @ d.H_d.T + d.C) @ np.linalg.inv(bracket)

    def joseph(K):
        rest = np.eye(8) - K @ d.H_d
        return rest @ P @ rest.T + K @ R @ K.T - rest @ d.C @ K.T - K @ d.C.T @ rest.T

    scale = np.sqrt(np.diag(P))
    short = P - best @ bracket @ best.T  # (16)
    np.testing.assert_allclose((short - joseph(best)) / np.outer(scale, scale), 0.0, atol=1e-12)
    for factor in (0.9, 1.1):
        other = factor * best
        assert np.all(np.diag(joseph(other)) >= np.diag(joseph(best)))
        wrong = (P - other @ bracket @ other.T - joseph(other)) / np.outer(scale, scale)
        assert np.max(np.abs(wrong)) > 1e-3, "(16) is no covariance at another gain"


def test_a1_printed_estimate_looks_one_step_ahead(problem):
    case = problem(1)
    form = printed(case.matrices, case.parameters)
    before = case.run(form).posterior
    z = case.ensemble.z["healthy"].copy()
    z[:, 61] += 1.0
    after = case._replace(ensemble=case.ensemble._replace(z={"healthy": z})).run(form).posterior
    np.testing.assert_array_equal(after[0, :60], before[0, :60])
    assert np.all(after[0, 60] != before[0, 60])


def test_a15_first_affected_estimate_is_one_step_before_the_fault(problem):
    case = problem(1)
    form = printed(case.matrices, case.parameters)
    healthy, fault = case.run(form, "healthy").posterior, case.run(form, "fault").posterior
    assert np.flatnonzero(np.any(healthy[0] != fault[0], axis=1))[0] == case.parameters.fault_start - 1 == 79


def test_a6_dropping_the_feedthrough_makes_errors_depend_on_the_input(problem, without_inputs):
    case = problem(1)
    form = printed(case.matrices, case.parameters)
    dropped = form._replace(sensor=form.sensor._replace(D=np.zeros_like(form.sensor.D)))
    kept, lost = (case.run(f).posterior - case.ensemble.x for f in (form, dropped))
    still = without_inputs(case)
    np.testing.assert_allclose(still.run(form).posterior - still.ensemble.x, kept, rtol=0, atol=1e-10)
    assert np.max(np.abs(still.run(dropped).posterior - still.ensemble.x - lost)[:, :, W]) > 0.1


def test_a2_reading_mu_one_step_late_makes_errors_depend_on_the_input(problem, without_inputs):
    case = problem(1)
    form = late(case.matrices, case.parameters)
    errors = case.run(form).posterior - case.ensemble.x
    still = without_inputs(case)
    assert np.max(np.abs(still.run(form).posterior - still.ensemble.x - errors)[:, :, W]) > 0.1


def correlated_noise():
    """A noise covariance of two correlated channels."""
    return np.array([[1.0, 0.6], [0.6, 1.0]])


def test_a8_scaling_from_the_left_is_not_symmetric_but_the_root_form_is():
    R, factors = correlated_noise(), np.array([10.0, 1.0])
    left = np.diag(factors) @ R
    assert np.max(np.abs(left - left.T)) > 1.0
    weighted = np.empty((2, 2))
    assert weighted_noise(R, np.zeros((2, 2)), 1 / factors, weighted)
    np.testing.assert_allclose(weighted, weighted.T, rtol=0, atol=1e-15)
    assert weighted_noise(np.diag([2.0, 3.0]), np.zeros((2, 2)), 1 / factors, weighted)
    np.testing.assert_allclose(weighted, np.diag(factors) @ np.diag([2.0, 3.0]), rtol=1e-15)


def test_a8_the_two_symmetric_forms_agree_for_diagonal_r_only():
    """Code: R^1/2 S R^T/2 with the Cholesky factor. Corrected (20), (24): S^1/2 R S^1/2, which alone multiplies the diagonal by s."""
    factors, weighted = np.array([10.0, 1.0]), np.empty((2, 2))
    root = np.diag(np.sqrt(factors))
    diagonal = np.diag([2.0, 3.0])
    assert weighted_noise(diagonal, np.zeros((2, 2)), 1 / factors, weighted)
    np.testing.assert_allclose(weighted, root @ diagonal @ root, rtol=1e-15)
    assert weighted_noise(correlated_noise(), np.zeros((2, 2)), 1 / factors, weighted)
    np.testing.assert_allclose(np.diag(weighted), [10.0, 0.6**2 * 10 + 0.8**2], rtol=1e-14)
    np.testing.assert_allclose(np.diag(root @ correlated_noise() @ root), [10.0, 1.0], rtol=1e-14)


def test_a8_equation_21_mixes_channels_when_r_is_not_diagonal():
    """Ten times the variance in channel one only: (21) gives a factor to the healthy channel two, the ratio of diagonals does not."""
    R, root = correlated_noise(), np.diag(np.sqrt([10.0, 1.0]))
    seen, nothing = root @ R @ root, np.zeros((2, 2))
    S = scale_matrix(seen, nothing, np.eye(2), nothing, R)
    assert abs(S[1, 1] - 1.0) > 0.3
    np.testing.assert_allclose(np.diag(seen) / np.diag(R), [10.0, 1.0])
    diagonal = np.diag([2.0, 3.0])
    np.testing.assert_allclose(
        scale_matrix(root @ diagonal @ root, nothing, np.eye(2), nothing, diagonal), np.diag([10.0, 1.0]), atol=1e-15
    )


def test_a9_joint_covariance_stays_positive_with_c_unscaled(problem):
    m, d = problem(1).matrices, differenced(problem(1).matrices)
    for scale in (1.0, 50.0, 1e4):
        joint = np.block([[m.Q, d.C], [d.C.T, scale * (d.R_process + d.R_sensor)]])
        size = np.sqrt(np.maximum(np.diag(joint), 1e-30))
        assert np.linalg.eigvalsh(joint / np.outer(size, size))[0] > -1e-12


def test_a10_unscaled_covariance_update_belongs_to_no_noise(problem):
    """One adaptive update: with (24) as gain, (16) with the unscaled bracket is neither the error under S* R nor under R."""
    m, d = problem(1).matrices, differenced(problem(1).matrices)
    P, R, scaled = m.A @ m.P0 @ m.A.T + m.Q, d.R_process + d.R_sensor, np.diag([1, 1, 56.0, 14, 1, 1, 1, 1])
    core = d.H_d @ P @ d.H_d.T + d.H_d @ d.C + d.C.T @ d.H_d.T
    K = (P @ d.H_d.T + d.C) @ np.linalg.inv(core + scaled @ R)
    rest = np.eye(8) - K @ d.H_d

    def error_covariance(noise):
        return rest @ P @ rest.T + K @ noise @ K.T - rest @ d.C @ K.T - K @ d.C.T @ rest.T

    size = np.outer(np.sqrt(np.diag(P)), np.sqrt(np.diag(P)))
    np.testing.assert_allclose((P - K @ (core + scaled @ R) @ K.T - error_covariance(scaled @ R)) / size, 0.0, atol=1e-12)
    unscaled = P - K @ (core + R) @ K.T
    assert np.max(np.abs(unscaled - error_covariance(scaled @ R)) / size) > 1e-3
    assert np.max(np.abs(unscaled - error_covariance(R)) / size) > 1e-3


def test_a10_unscaled_covariance_changes_the_estimates(problem):
    case = problem(3)
    estimate, variance = literal(case.parameters, case.matrices, case.ensemble, "fault", 20)
    other, other_variance = literal(case.parameters, case.matrices, case.ensemble, "fault", 20, scale_covariance=False)
    np.testing.assert_array_equal(other[:, 1:20], estimate[:, 1:20])
    window = case.parameters.fault
    assert np.max(np.abs(other - estimate)[:, window] / np.sqrt(variance[:, window])) > 0.1
    assert np.mean(other_variance[:, window] / variance[:, window]) != pytest.approx(1.0, abs=0.01)


def test_a14_equations_27_and_28_taken_literally_multiply_by_nine_and_six(problem):
    case = problem(2, multiplier_q=9.0, multiplier_theta=6.0)
    z, v = case.ensemble.z, case.ensemble.z["healthy"] - case.ensemble.x - case.ensemble.lam
    expected = z["healthy"].copy()
    expected[:, 80:151, 2] += 8 * v[:, 80:151, 2]
    expected[:, 80:151, 3] += 5 * v[:, 80:151, 3]
    np.testing.assert_allclose(z["fault"], expected, rtol=0, atol=1e-12)


def test_a16_seventy_one_squares_over_seventy(problem):
    case = problem(2)
    form = printed(case.matrices, case.parameters)
    record = case.run(form, "fault")
    frame = scores(form, record, case.ensemble, case.parameters, range(2))
    squares = (record.posterior - case.ensemble.x)[:, 80:151] ** 2
    assert squares.shape[1] == 71
    np.testing.assert_allclose(frame["rmse"].to_numpy().reshape(2, 8), np.sqrt(71 / 70) * np.sqrt(squares.mean(axis=1)), rtol=1e-12)


def test_equation_6_holds_for_every_simulated_epoch(problem):
    """mu(k) from the measurements is its right-hand side from truth, inputs and noise, fault included."""
    case = problem(2)
    m, d, inputs = case.matrices, differenced(case.matrices), controls(case.parameters)
    x, lam = case.ensemble.x, case.ensemble.lam
    w = x[:, 1:] - x[:, :-1] @ m.A.T - inputs[:-1] @ m.B.T
    driven = lam[:, 1:] - lam[:, :-1] @ m.A_n.T
    for z in case.ensemble.z.values():
        v = z - x - lam
        right = x[:, :-1] @ d.H_d.T + inputs[:-1] @ d.D.T + w @ m.H.T + driven + v[:, 1:] - v[:, :-1] @ m.A_n.T
        np.testing.assert_allclose(differenced_measurements(z, m.A_n)[:, :-1], right, rtol=0, atol=1e-11)


def bh_innovation_covariances(case):
    """Covariance of BH's innovations and the filter's own, by recursion over the joint covariance of its error and v(k).

    ``Delta = H_d e + n + v' - A_n v`` and ``e' = A e + w - L Delta`` with ``n = H w + B_n U`` and v' the coming v.
    """
    m, d = case.matrices, differenced(case.matrices)
    R, zero = d.R_process + d.R_sensor, np.zeros((8, 8))
    P = m.P0
    joint = np.block([[m.P0, zero], [zero, m.Q_v]])
    for _ in range(case.parameters.steps):
        sigma = d.H_d @ P @ d.H_d.T + R
        seen = np.hstack([d.H_d, -m.A_n])
        true = seen @ joint @ seen.T + d.R_process + m.Q_v
        gain = (m.A @ P @ d.H_d.T + d.C) @ np.linalg.inv(sigma)
        F = np.block([[m.A - gain @ d.H_d, gain @ m.A_n], [zero, zero]])
        upper = m.Q - d.C @ gain.T - gain @ d.C.T + gain @ (d.R_process + m.Q_v) @ gain.T
        joint = F @ joint @ F.T + np.block([[upper, -gain @ m.Q_v], [-m.Q_v @ gain.T, m.Q_v]])
        P = m.A @ P @ m.A.T + m.Q - gain @ sigma @ gain.T
    return true, sigma


def test_corrected_statement_1_is_exact_without_v_and_false_with_it(problem):
    true, sigma = bh_innovation_covariances(problem(1, **NO_V))
    np.testing.assert_allclose(np.diag(true) / np.diag(sigma), 1.0, rtol=1e-9)
    true, sigma = bh_innovation_covariances(problem(1))
    assert np.max(np.diag(true) / np.diag(sigma)) > 1.05
    assert np.trace(np.linalg.solve(sigma, true)) > 8.1, "mean of the normalised innovation squared"


def test_corrected_covariance_keeps_statement_1_in_its_right_form(problem):
    """BH without v: the innovation covariance H_d P H_d^T + R is the sampled one."""
    case = problem(400, **NO_V)
    record = case.run(corrected(case.matrices, case.parameters))
    ratio = np.nanmean(record.innovation[:, 30:] ** 2 / record.innovation_variance[:, 30:], axis=(0, 1))
    np.testing.assert_allclose(ratio, 1.0, rtol=0, atol=0.03)
