"""The acceptance checks T1-T13 and T16 of the paper's science brief (there is no T14 and no T15), each at its tolerance.

SI units and the ``deg`` branch unless a check says otherwise; "no v" sets sigma_v = 0. What the brief asks to
*report* without an expected value (MDKF, AMDKF and BH with white noise) is a finding of the study, not a test.
"""

import numpy as np
import pytest
from scipy.linalg import block_diag

from robins.kalman.filter import schedule
from robins.kalman.model import LinearModel, linear_sensor
from robins.kalman.predict import Ekf
from robins.papers.hajiyev2023.estimators import augmented, classical, corrected, epochs_valid, late, oracle, printed
from robins.papers.hajiyev2023.scenario import Q_CHANNEL, SETTLED, STEADY, THETA_CHANNEL, controls, differenced
from robins.papers.hajiyev2023.studies import differenced_noise, lag_one

NO_V = {"sigma_v": (0.0,) * 8}
LEVEL = np.where([False, False, True, True, True, True, True, True], 180 / np.pi, 1.0)
"""From SI to the units in which the brief prints levels."""


def covariances(form):
    """Prior and posterior covariances of a filter whose weights no data enters, shapes (N+1, n, n)."""
    plan = schedule(Ekf(), form.model, form.sensor, form.P0, form.weights, form.valid, 8, False)
    assert plan.failed < 0
    return plan.prior_covariance, plan.posterior_covariance


def filters(problem):
    """Every form of the study for one problem."""
    m, p = problem.matrices, problem.parameters
    rules = ("per-channel", "gated", "scalar-trace", "scalar-mean")
    return {
        "ckf": classical(m, p),
        "ckf-inflated": classical(m, p, inflated=True),
        "akf": augmented(m, p),
        "aakf": augmented(m, p, "per-channel"),
        "oracle": oracle(m, p),
        "mdkf": printed(m, p),
        **{f"amdkf {rule}": printed(m, p, rule) for rule in rules},
        "bh": corrected(m, p),
        "abh": corrected(m, p, "per-channel"),
        "mdkf-lagged": late(m, p),
        "amdkf-lagged": late(m, p, "per-channel"),
    }


def test_t01_bh_from_the_posterior_of_the_first_measurement_is_the_augmented_filter(problem):
    """Without v. The independent formulation is the augmented state: it knows neither mu nor C."""
    case = problem(5, **NO_V)
    akf = augmented(case.matrices, case.parameters)
    augmented_record = case.run(akf)
    _, posterior = covariances(akf)
    bh = corrected(case.matrices, case.parameters)._replace(P0=np.ascontiguousarray(posterior[0, :8, :8]))
    record = case._replace(ensemble=case.ensemble._replace(guess=augmented_record.posterior[:, 0])).run(bh)
    np.testing.assert_allclose(record.prior, augmented_record.posterior, rtol=0, atol=1e-8)
    np.testing.assert_allclose(record.posterior[:, :-1], augmented_record.delayed[:, :-1], rtol=0, atol=1e-8)
    prior, _ = covariances(bh)
    scale = np.sqrt(np.einsum("kii->ki", posterior[:, :8, :8]))
    np.testing.assert_allclose((prior - posterior[:, :8, :8]) / (scale[:, :, None] * scale[:, None, :]), 0, atol=1e-8)


def test_t01_both_are_the_conditional_mean_of_the_joint_gaussian(problem, joint_gaussian):
    """Without v. Independent implementation: conditioning all states on all measurements at once (batch, no recursion)."""
    case = problem(5, **NO_V)
    akf, last = augmented(case.matrices, case.parameters), 12
    record = case.run(akf)
    inputs = controls(case.parameters)
    start = np.concatenate([case.ensemble.guess[0], np.zeros(8)])
    mean, covariance = joint_gaussian(
        *akf.model, akf.sensor.H, akf.sensor.R, start, akf.P0, inputs, case.ensemble.z["healthy"][0, : last + 1]
    )
    np.testing.assert_allclose(record.posterior[0, last], mean[last, :8], rtol=0, atol=1e-8)
    np.testing.assert_allclose(record.posterior_variance[0, last], np.diag(covariance[last])[:8], rtol=1e-8)
    np.testing.assert_allclose(record.delayed[0, last - 1], mean[last - 1, :8], rtol=0, atol=1e-8)
    np.testing.assert_allclose(record.delayed_variance[0, last - 1], np.diag(covariance[last - 1])[:8], rtol=1e-8)


def test_t02_bh_from_p0_is_the_augmented_filter_with_a_diffuse_error(problem):
    """Without v. The difference is the information of the first level; it falls as 1 / P_lambda0."""
    case = problem(5, **NO_V)
    bh = case.run(corrected(case.matrices, case.parameters))
    size = {}
    for diffuse in (1e4, 1e6, 1e8, 1e10):
        akf = case.run(augmented(case.matrices, case.parameters, P0_lambda=diffuse * np.eye(8)))
        size[diffuse] = np.max(np.abs(bh.prior[:, 1:] - akf.posterior[:, 1:]))
    assert size[1e8] < 1e-5
    assert size[1e4] / size[1e6] == pytest.approx(100, rel=0.01)
    assert size[1e6] / size[1e8] == pytest.approx(100, rel=0.01)
    assert size[1e8] / size[1e10] == pytest.approx(100, rel=0.01)


def petovello(case):
    """The non-delayed form and what it reads: y(k) = z(k) - A_n z(k-1) - A_n H A^-1 B u(k-1), with C in the update."""
    m, p = case.matrices, case.parameters
    back = m.A_n @ m.H @ np.linalg.inv(m.A)
    noise = back @ m.Q @ back.T + m.Q_lambda + m.Q_v + m.A_n @ m.Q_v @ m.A_n.T
    sensor = linear_sensor(m.H - back, noise, C_update=m.Q @ back.T, inputs=3)
    form = corrected(m, p)._replace(sensor=sensor, reads="z", valid=epochs_valid(p, 1, p.steps), filtered="posterior", delayed="")
    z, y = case.ensemble.z["healthy"], np.zeros_like(case.ensemble.z["healthy"])
    y[:, 1:] = z[:, 1:] - z[:, :-1] @ m.A_n.T - (controls(p) @ (back @ m.B).T)[:-1]
    return form, case._replace(ensemble=case.ensemble._replace(z={"healthy": y}))


def test_t03_the_non_delayed_form_is_bh(problem):
    """Without v. Independent formulation: Petovello's H - A_n H A^-1 with the cross-covariance in the *update*."""
    case = problem(5, **NO_V)
    form, reading = petovello(case)
    filtered = reading.run(form)
    bh = case.run(corrected(case.matrices, case.parameters))
    np.testing.assert_allclose(filtered.posterior[:, 1:], bh.prior[:, 1:], rtol=0, atol=1e-8)
    np.testing.assert_allclose(filtered.posterior_variance[:, 1:], bh.prior_variance[:, 1:], rtol=1e-8)


def exact_differencing(case):
    """Differencing with v in the state, X = [x; v(k)]: the differenced noise is then white."""
    m, p = case.matrices, case.parameters
    model = LinearModel(block_diag(m.A, np.zeros((8, 8))), np.vstack([m.B, np.zeros_like(m.B)]), block_diag(m.Q, m.Q_v))
    sensor = linear_sensor(np.hstack([m.H @ m.A - m.A_n @ m.H, -m.A_n]), m.H @ m.Q @ m.H.T + m.Q_lambda + m.Q_v, m.H @ m.B,
                           C_predict=np.vstack([m.Q @ m.H.T, m.Q_v]))  # fmt: skip
    return corrected(m, p)._replace(model=model, sensor=sensor, P0=block_diag(m.P0, m.Q_v))


def test_t04_differencing_with_v_in_the_state_is_the_diffuse_augmented_filter(problem):
    case = problem(5)
    differencing = case.run(exact_differencing(case))
    akf = case.run(augmented(case.matrices, case.parameters, P0_lambda=1e8 * np.eye(8)))
    np.testing.assert_allclose(differencing.prior[:, 1:], akf.posterior[:, 1:], rtol=0, atol=1e-5)


def test_t05_xi_is_a_moving_average_with_the_predicted_lag_one_correlation(problem):
    case = problem(400, scenario="tests-xi", steps=1000)
    d = differenced(case.matrices)
    theory = np.diag(-case.matrices.A_n @ case.matrices.Q_v) / np.diag(d.R_process + d.R_sensor)
    np.testing.assert_allclose(theory, [-0.3378, -0.2188, -0.4347, -0.2631, -0.4735, -0.4347, -0.4976, -0.4878], rtol=0, atol=5e-5)
    xi = differenced_noise(case.parameters, case.matrices, case.ensemble)
    assert xi[..., 0].size == 400_000
    np.testing.assert_allclose(lag_one(xi).estimate, theory, rtol=0, atol=0.01)


@pytest.mark.parametrize(("build", "changes"), [(augmented, {}), (corrected, NO_V)], ids=["akf", "bh without v"])
def test_t06_innovations_of_a_right_filter_are_white(problem, build, changes):
    case = problem(400, **changes)
    innovation = case.run(build(case.matrices, case.parameters)).innovation[:, SETTLED:]
    innovation = innovation[:, ~np.isnan(innovation[0, :, 0])]
    for channel in np.moveaxis(innovation, 2, 0):
        assert abs(np.corrcoef(channel[:, :-1].ravel(), channel[:, 1:].ravel())[0, 1]) < 0.02


@pytest.mark.parametrize(
    ("build", "changes", "condition"),
    [
        (lambda m, p: augmented(m, p), {}, "healthy"),
        (lambda m, p: corrected(m, p), NO_V, "healthy"),
        (lambda m, p: oracle(m, p), {}, "fault"),
    ],
    ids=["akf", "bh without v", "oracle with the fault"],
)
def test_t07_mean_nis_of_a_right_filter_is_the_number_of_measurements(problem, build, changes, condition):
    case = problem(400, **changes)
    assert np.nanmean(case.run(build(case.matrices, case.parameters), condition).nis[:, SETTLED:]) == pytest.approx(8.0, abs=0.1)


def errors_of_every_filter(case):
    """Errors by filter. The late ones compare mu(k-1) with x(k), so they follow the input by construction (test_as_printed)."""
    for name, form in filters(case).items():
        if not name.endswith("lagged"):
            yield name, getattr(case.run(form, "fault"), form.filtered or form.delayed) - case.ensemble.x


def test_t08_errors_do_not_depend_on_the_input(problem, without_inputs):
    case = problem(2)
    with_doublets = dict(errors_of_every_filter(case))
    still = without_inputs(case)
    assert np.max(np.abs(still.ensemble.x - case.ensemble.x)) > 1.0
    for name, errors in errors_of_every_filter(still):
        np.testing.assert_allclose(errors, with_doublets[name], rtol=0, atol=1e-10, err_msg=name)


def test_t09_amdkf_with_a_window_beyond_the_record_is_mdkf(problem):
    case = problem(5, window=202)
    plain = case.run(printed(case.matrices, case.parameters), "fault")
    adaptive = case.run(printed(case.matrices, case.parameters, "per-channel"), "fault")
    np.testing.assert_allclose(adaptive.posterior, plain.posterior, rtol=0, atol=1e-12)


def test_t10_every_covariance_is_symmetric_and_positive(problem):
    """The covariances of an adaptive filter are those of a schedule with the weights that its run 0 chose."""
    case = problem(2)
    for name, form in filters(case).items():
        record = case.run(form, "fault")
        weights = np.where(np.isnan(record.weights[0]), 1.0, record.weights[0])
        prior, posterior = covariances(form._replace(weights=np.ascontiguousarray(weights)))
        np.testing.assert_allclose(np.einsum("kii->ki", posterior)[:, :8], record.posterior_variance[0], rtol=1e-9, err_msg=name)
        for P in (*prior, *posterior):
            assert np.max(np.abs(P - P.T)) <= 1e-12 * np.max(np.abs(P)), name
            assert np.linalg.eigvalsh(P)[0] > -1e-12, name


def test_t10_smallest_eigenvalues_are_the_known_ones(problem):
    case = problem(2)
    for build, value in ((printed, 5.5e-8), (augmented, 1.1e-8)):
        form = build(case.matrices, case.parameters)
        _, posterior = covariances(form)
        assert np.linalg.eigvalsh(posterior[form.valid][-1])[0] == pytest.approx(value, rel=0.02)


def test_t11_matrices_have_the_known_diagonals(problem):
    m = problem(2).matrices
    d = differenced(m)
    np.testing.assert_allclose(np.diag(d.H_d), [0.0011, -0.0360, -0.0241, 0.0010, -0.0213, -0.0841, -0.0204, 0.0009], rtol=0, atol=5.1e-5)
    levels = np.sqrt(np.diag(d.R_process + d.R_sensor)) * LEVEL
    np.testing.assert_allclose(levels[:2], [0.086, 1.068], rtol=0, atol=5e-4)
    np.testing.assert_allclose(levels[2:], [0.0303, 0.0195, 0.0726, 0.0303, 0.0708, 0.0286], rtol=0, atol=5e-5)
    moduli = np.sort(np.abs(np.linalg.eigvals(m.A)))
    np.testing.assert_allclose(moduli, np.sort([0.9781, 0.9781, 0.9997, 0.9997, 0.9841, 0.9841, 0.9371, 0.9983]), rtol=0, atol=5e-5)


@pytest.mark.parametrize("branch", ["deg", "rad"])
def test_t12_scale_factors_of_the_faulty_channels_follow_the_variance_of_the_fault(problem, branch):
    case = problem(100, branch)
    record = case.run(printed(case.matrices, case.parameters, "per-channel"), "fault")
    mean = np.mean(1.0 / record.weights[:, STEADY], axis=(0, 1))
    d = differenced(case.matrices)
    share = np.diag(d.R_sensor) / np.diag(d.R_process + d.R_sensor)
    for channel, excess, value in ((Q_CHANNEL, 63, 55.9), (THETA_CHANNEL, 24, 13.6)):
        theory = 1 + excess * share[channel]
        assert theory == pytest.approx(value, rel=0.005)
        assert mean[channel] == pytest.approx(theory, rel=0.08)


def test_t13_the_augmented_filter_is_honest_about_its_error(problem):
    case = problem(400)
    record = case.run(augmented(case.matrices, case.parameters))
    squared = np.mean((record.posterior - case.ensemble.x)[:, STEADY] ** 2 / record.posterior_variance[:, STEADY], axis=(0, 1))
    np.testing.assert_allclose(np.sqrt(squared), 1.0, rtol=0, atol=0.08)


def test_t16_differencing_loses_the_level_of_the_first_measurement(problem):
    m, p = problem(2, **NO_V).matrices, problem(2, **NO_V).parameters
    prior, _ = covariances(corrected(m, p))
    _, posterior = covariances(augmented(m, p))
    loss = np.sqrt(np.diag(prior[50]) / np.diag(posterior[50])[:8])
    np.testing.assert_allclose(loss, [2.103, 1.802, 1.005, 1.132, 1.000, 1.004, 1.029, 1.354], rtol=0, atol=5e-4)
