"""Whole filters: against a textbook loop, against each other, and what every weight and every prediction owe."""

import numpy as np
import pytest

from robins.kalman.chi_square import LINEAR, MARGINAL, REJECT, ROOT, SEQUENTIAL, TEMPORAL, chi_square
from robins.kalman.filter import Record, run_filter, run_schedule, schedule
from robins.kalman.gates import gate, integrity_gate, nis_gate
from robins.kalman.m_estimators import correntropy, huber
from robins.kalman.model import LinearModel, linear_sensor
from robins.kalman.predict import Ekf, unscented
from robins.kalman.tuning import matching
from robins.kalman.weights import Iteration, names, weighting

EPOCHS, CHANNELS = 30, 3
KNOWN = np.random.default_rng(8).choice([0.0, 0.3, 1.0], size=(EPOCHS, CHANNELS))
KERNELS = correntropy((1.5, 3.0, 8.0), (0.3, 0.4, 0.3))
WEIGHTINGS = {
    "unit": weighting("unit"),
    "known": weighting("known", memory=KNOWN),
    "covariance-matching": matching(5, CHANNELS),
    "chi-square": chi_square(CHANNELS, SEQUENTIAL, LINEAR, 0.95, 1.0, 3.0),
    "chi-square, corrected and rejecting": chi_square(CHANNELS, MARGINAL, REJECT, 0.95, 1.0, 3.0, True),
    "chi-square in time": chi_square(CHANNELS, TEMPORAL, ROOT, 0.95, 1.0, 3.0),
    "gate": gate(1.5),
    "gate on the gain": gate(1.5)._replace(on_gain=True),
    "nis-gate, patient": nis_gate(25.0, patience=1),
    "integrity-gate": integrity_gate((9.0, 9.0, 9.0), (2.5, np.inf, np.inf), np.random.default_rng(1).normal(size=(EPOCHS, CHANNELS))),
    "huber": huber(1.345),
    "huber, iterated": huber(1.345)._replace(iteration=Iteration(5, 1e-9, 1e-8, True, np.zeros(0))),
    "correntropy": KERNELS,
    "correntropy on the gain": KERNELS._replace(on_gain=True),
    "correntropy, iterated with the prior": KERNELS._replace(iteration=Iteration(3, 1e-5, 1e-4, False, KERNELS.parameters)),
}
"""Settings of every weight of the package, on the noise, on the gain and iterated, for the contract below."""


def is_plain(method):
    """Whether the weights act on the noise, once: then there is a delayed estimate, and no update adds variance."""
    return not method.on_gain and method.iteration.limit == 0


def run(predictor, case, method):
    """Every state, and the delayed estimate where there is one."""
    return run_filter(predictor, case.model, case.sensor, method, *case.arguments, 4, is_plain(method))


def everything(record_a: Record, record_b: Record, tolerance: float):
    """Two records agree, NaN for NaN; arrays with one run stand for all."""
    for name, a, b in zip(Record._fields, record_a, record_b, strict=True):
        a, b = np.broadcast_arrays(a, b)
        np.testing.assert_allclose(a, b, rtol=tolerance, atol=tolerance, err_msg=name)


def textbook(case, run, weights=None):
    """One record with inverses and the short covariance form: prior, posterior and their variances, innovation, diag S, NIS."""
    (A, B, Q), (H, D, R, fixed, at_update, at_prediction) = case.model, case.sensor
    x, P, rows = case.x0[run], case.P0, []
    for k, u in enumerate(case.controls):
        row = [x, np.diag(P)]
        correction, correction_P = 0.0, 0.0
        seen = np.full(len(H), np.nan)
        innovation, diagonal, nis = seen, seen, np.nan
        if case.valid[k]:
            root = np.linalg.cholesky(R)
            R_bar = root @ np.diag(1 / (np.ones(len(R)) if weights is None else weights[k])) @ root.T + fixed
            innovation = case.measurements[run, k] - H @ x - D @ u
            cross = P @ H.T + at_update
            S = H @ P @ H.T + R_bar + H @ at_update + at_update.T @ H.T
            inverse = np.linalg.inv(S)
            diagonal, nis = np.diag(S), innovation @ inverse @ innovation
            full = A @ cross + at_prediction
            correction = at_prediction @ inverse @ innovation
            correction_P = full @ inverse @ full.T - A @ cross @ inverse @ cross.T @ A.T
            x, P = x + cross @ inverse @ innovation, P - cross @ inverse @ cross.T
        rows.append([*row, x, np.diag(P), innovation, diagonal, nis])
        x, P = A @ x + B @ u + correction, A @ P @ A.T + Q - correction_P
    return [np.array(column) for column in zip(*rows, strict=True)]


def cross_covariance(at):
    """Sensor matrices with a small cross-covariance at the update or at the prediction, and a fixed part of the noise."""
    C = 0.05 * np.random.default_rng(9).normal(size=(4, 3))
    return {at: C, "R_fixed": 0.5 * np.eye(3)} if at else {}


@pytest.mark.parametrize("at", ["", "C_update", "C_predict"])
def test_the_filter_is_the_textbook_loop(problem, at):
    case = problem(2, **cross_covariance(at))
    record = run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 4, False)
    fields = ("prior", "prior_variance", "posterior", "posterior_variance", "innovation", "innovation_variance", "nis")
    for run in range(2):
        for name, expected in zip(fields, textbook(case, run), strict=True):
            np.testing.assert_allclose(getattr(record, name)[run], expected, rtol=1e-10, atol=1e-10, err_msg=name)
    assert np.all(record.failed == -1)
    assert np.all(record.weights[:, case.valid] == 1.0) and np.isnan(record.weights[:, ~case.valid]).all()


@pytest.mark.parametrize("weights", ["unit", "known"])
def test_the_recorded_gains_are_norms_and_diagonal_of_the_gain(problem, weights):
    """The gain of an independent recursion, column by column: how the state moves when one channel's innovation grows by one."""
    case = problem(16)
    method, k = WEIGHTINGS[weights], 4
    assert case.valid[k]
    record = run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)
    for j in range(CHANNELS):
        measurements = case.measurements.copy()
        measurements[:, k, j] += 1.0
        moved = run_filter(Ekf(), case.model, case.sensor, method, *case._replace(measurements=measurements).arguments, 4, False)
        column = (moved.posterior - record.posterior)[0, k]
        assert record.gain_diagonal[0, k, j] == pytest.approx(column[j], rel=1e-9, abs=1e-9)
        assert record.gain_norm[0, k, j] == pytest.approx(np.linalg.norm(column), rel=1e-9, abs=1e-9)


def test_known_weights_are_used_at_the_updates_they_belong_to(problem):
    case = problem(3)
    given = np.random.default_rng(3).uniform(0.05, 1.0, (EPOCHS, CHANNELS))
    by_update = given[case.valid]  # row i belongs to the i-th update
    record = run_filter(Ekf(), case.model, case.sensor, weighting("known", memory=by_update), *case.arguments, 4, False)
    np.testing.assert_allclose(record.posterior[0], textbook(case, 0, given)[2], rtol=1e-10, atol=1e-10)
    np.testing.assert_array_equal(record.weights[1, case.valid], by_update)


@pytest.mark.parametrize("at", ["", "C_update", "C_predict"])
@pytest.mark.parametrize("weights", ["unit", "some removed"])
def test_a_schedule_is_the_filter(problem, at, weights):
    case = problem(4, **cross_covariance(at))
    given = np.ones((EPOCHS, CHANNELS)) if weights == "unit" else KNOWN
    measurements = np.where(given[None] == 0.0, np.nan, case.measurements)  # a removed channel may hold anything
    case = case._replace(measurements=measurements)
    method = weighting("known", memory=given[case.valid])
    filtered = run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, at == "")
    plan = schedule(Ekf(), case.model, case.sensor, case.P0, given, case.valid, 4, at == "")
    everything(filtered, run_schedule(plan, case.model, case.sensor, case.x0, case.controls, measurements, 4, at == ""), 1e-12)
    assert np.all(filtered.failed == -1) and np.isfinite(filtered.nis[:, case.valid]).all()


@pytest.mark.parametrize("weights", ["unit", "known"])
@pytest.mark.parametrize("predictor", [Ekf(), unscented(4, 1.0)], ids=["ekf", "ukf"])
def test_the_delayed_estimate_is_the_fixed_lag_smoother_by_state_augmentation(problem, weights, predictor):
    """Independent formulation: the Kalman filter on [x(k); x(k-1)] estimates x(k-1) from the measurements up to k."""
    case = problem(5)
    n, zero = 4, np.zeros((4, 4))
    A, B, Q = case.model
    both = LinearModel(np.block([[A, zero], [np.eye(n), zero]]), np.vstack([B, 0 * B]), np.block([[Q, zero], [zero, zero]]))
    sensor = linear_sensor(np.hstack([case.sensor.H, 0 * case.sensor.H]), case.sensor.R, case.sensor.D)
    smoother = case._replace(x0=np.hstack([case.x0, case.x0]), P0=np.block([[case.P0, zero], [zero, np.eye(n)]]))
    record = run_filter(predictor, case.model, case.sensor, WEIGHTINGS[weights], *case.arguments, n, True)
    smoothed = run_filter(Ekf(), both, sensor, WEIGHTINGS[weights], *smoother.arguments, 2 * n, False)
    for k in range(EPOCHS - 1):
        if case.valid[k + 1]:
            np.testing.assert_allclose(record.delayed[:, k], smoothed.posterior[:, k + 1, n:], rtol=1e-10, atol=1e-10)
            np.testing.assert_allclose(record.delayed_variance[:, k], smoothed.posterior_variance[:, k + 1, n:], rtol=1e-10, atol=1e-10)
        else:
            assert np.isnan(record.delayed[:, k]).all()
    assert np.isnan(record.delayed[:, -1]).all()
    assert record.delayed.shape == (2, EPOCHS, n) and record.delayed_variance.shape == (2, EPOCHS, n)


def test_a_delayed_estimate_that_nobody_asked_for_takes_no_room(problem):
    case = problem(5)
    record = run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 3, False)
    plan = schedule(Ekf(), case.model, case.sensor, case.P0, np.ones((EPOCHS, 3)), case.valid, 3, False)
    scheduled = run_schedule(plan, case.model, case.sensor, case.x0, case.controls, case.measurements, 3, False)
    assert record.delayed.shape == scheduled.delayed.shape == (2, 0, 3)
    assert record.delayed_variance.shape == (2, 0, 3) and scheduled.delayed_variance.shape == (1, 0, 3)


@pytest.mark.parametrize("at", ["C_update", "C_predict"])
def test_the_delayed_estimate_is_refused_where_a_cross_covariance_would_change_it(problem, at):
    case = problem(4, **cross_covariance(at))
    with pytest.raises(ValueError, match="delayed"):
        run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 4, True)
    with pytest.raises(ValueError, match="delayed"):
        schedule(Ekf(), case.model, case.sensor, case.P0, np.ones((EPOCHS, 3)), case.valid, 4, True)


@pytest.mark.parametrize("name", [name for name, method in WEIGHTINGS.items() if not is_plain(method)])
def test_the_delayed_estimate_is_refused_where_another_gain_would_be_needed_for_it(problem, name):
    case = problem(4)
    with pytest.raises(ValueError, match="delayed estimate needs weights that act on the noise, once"):
        run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS[name], *case.arguments, 4, True)


@pytest.mark.parametrize("at", ["C_update", "C_predict", "R_fixed"])
def test_iterated_weights_are_refused_beside_cross_covariances_and_fixed_noise(problem, at):
    case = problem(4, **({"R_fixed": np.eye(3)} if at == "R_fixed" else {at: cross_covariance(at)[at]}))
    with pytest.raises(ValueError, match="iterated weights need zero cross-covariances and no fixed part of the noise"):
        run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["huber, iterated"], *case.arguments, 4, False)


def test_each_run_may_have_its_own_controls(problem):
    case = problem(17)
    own = np.random.default_rng(17).normal(size=(2, *case.controls.shape))
    record = run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case._replace(controls=own).arguments, 4, True)
    for k in range(2):
        alone = case._replace(x0=case.x0[k : k + 1], measurements=case.measurements[k : k + 1], controls=own[k])
        everything(Record(*(field[k : k + 1] for field in record)), run(Ekf(), alone, WEIGHTINGS["unit"]), 0.0)
    assert np.abs(record.posterior - run(Ekf(), case, WEIGHTINGS["unit"]).posterior).max() > 0.1
    everything(run(Ekf(), case._replace(controls=case.controls[None]), WEIGHTINGS["unit"]), run(Ekf(), case, WEIGHTINGS["unit"]), 0.0)


def test_controls_of_another_number_of_runs_are_refused(problem):
    case = problem(17)
    with pytest.raises(ValueError, match="^there are controls of 3 runs and measurements of 2$"):
        run(Ekf(), case._replace(controls=np.zeros((3, EPOCHS, 2))), WEIGHTINGS["unit"])


def test_the_whole_covariance_is_recorded_at_the_marks(problem):
    """Against the textbook recursion; the last epoch, and one without a measurement, are marks like any other."""
    case, marks = problem(18), (0, 5, 13, EPOCHS - 1)
    record = run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 2, False, marks)
    assert record.covariance.shape == (2, 4, 4, 4) and not case.valid[5]
    A, _, Q = case.model
    H, P = case.sensor.H, case.P0
    for k in range(EPOCHS):
        if case.valid[k]:
            P = P - P @ H.T @ np.linalg.solve(H @ P @ H.T + case.sensor.R, H @ P)
        if k in marks:
            for covariance in record.covariance[:, marks.index(k)]:
                np.testing.assert_allclose(covariance, P, rtol=1e-10, atol=1e-10)
        P = A @ P @ A.T + Q
    assert run(Ekf(), case, WEIGHTINGS["unit"]).covariance.shape == (2, 0, 4, 4)


def test_only_the_leading_states_are_recorded(problem):
    case = problem(6)
    all_states, two = (run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, r, True) for r in (4, 2))
    for name in ("prior", "posterior", "delayed", "prior_variance", "posterior_variance", "delayed_variance"):
        np.testing.assert_array_equal(getattr(two, name), getattr(all_states, name)[..., :2])


# What every weight and every prediction owe.


def test_the_contract_below_covers_every_weight():
    of_the_package = {weighting(name).kind for name in names() if not name.startswith("example-")}
    assert {method.kind for method in WEIGHTINGS.values()} == of_the_package


@pytest.fixture(scope="module", params=[Ekf(), unscented(4)], ids=["ekf", "ukf"])
def predictor(request):
    return request.param


@pytest.fixture(params=WEIGHTINGS)
def method(request):
    return WEIGHTINGS[request.param]


def test_every_filter_returns_finite_records_of_the_promised_shapes(problem, predictor, method):
    case = problem(7)
    record = run(predictor, case, method)
    assert np.all(record.failed == -1)
    for name in ("prior", "posterior", "prior_variance", "posterior_variance"):
        assert getattr(record, name).shape == (2, EPOCHS, 4) and np.isfinite(getattr(record, name)).all()
    for name in ("innovation", "weights", "gain_norm", "gain_diagonal"):
        assert getattr(record, name).shape == (2, EPOCHS, CHANNELS)
        assert np.isfinite(getattr(record, name)[:, case.valid]).all() and np.isnan(getattr(record, name)[:, ~case.valid]).all()
    assert np.all((record.weights[:, case.valid] >= 0.0) & (record.weights[:, case.valid] <= 1.0))
    removed = (record.weights == 0.0) & (not method.on_gain)  # S is the plain one where the weights are on the gain
    assert np.isinf(record.innovation_variance[removed]).all()
    assert np.isfinite(record.innovation_variance[:, case.valid][~removed[:, case.valid]]).all()
    assert np.all(record.gain_norm[record.weights == 0.0] == 0.0)
    assert record.nis.shape == (2, EPOCHS) and np.all(record.nis[:, case.valid] >= 0.0)


def test_every_update_takes_variance_away_and_every_variance_is_positive(problem, predictor, method):
    case = problem(8)
    record = run(predictor, case, method)
    assert np.all(record.posterior_variance > 0.0)
    if not is_plain(method):
        return  # with such a gain, which is not the best one, the Joseph form may say that a state has become less certain
    assert np.all(record.posterior_variance <= record.prior_variance * (1 + 1e-12))
    delayed = np.isfinite(record.delayed_variance)
    assert np.all(record.delayed_variance[delayed] > 0.0)
    assert np.all(record.delayed_variance[delayed] <= record.posterior_variance[delayed] * (1 + 1e-12))


def test_every_filter_repeats_itself_bit_by_bit_and_leaves_its_inputs_alone(problem, predictor, method):
    case = problem(9)
    before = [a.copy() for a in (*case.arguments, *case.model, *case.sensor, method.memory)]
    first = run(predictor, case, method)
    everything(first, run(predictor, case, method), 0.0)
    for a, b in zip(before, (*case.arguments, *case.model, *case.sensor, method.memory), strict=True):
        np.testing.assert_array_equal(a, b)
    alone = case._replace(x0=case.x0[1:], measurements=case.measurements[1:])
    again = run(predictor, alone, method)
    np.testing.assert_array_equal(again.posterior[0], first.posterior[1])


def test_a_missing_number_in_a_measurement_fails_its_run_at_its_epoch_and_no_other(problem, predictor, method):
    case = problem(10)
    whole = run(predictor, case, method)
    channel = int(np.argmax(whole.weights[0, 13]))  # one that takes part
    assert whole.weights[0, 13, channel] > 0.0
    measurements = case.measurements.copy()
    measurements[0, 13, channel] = np.nan
    record = run(predictor, case._replace(measurements=measurements), method)
    assert record.failed.tolist() == [13, -1]
    np.testing.assert_array_equal(record.posterior[0, :13], whole.posterior[0, :13])
    assert np.isnan(record.posterior[0, 13:]).all() and np.isnan(record.nis[0, 13:]).all() and np.isnan(record.prior[0, 14:]).all()
    np.testing.assert_array_equal(record.posterior[1], whole.posterior[1])


def test_the_unscented_filter_is_the_kalman_filter_on_a_linear_model(problem, method):
    case = problem(11)
    extended, by_points = (run(p, case, method) for p in (Ekf(), unscented(4, 1.0)))
    everything(extended, by_points, 1e-10)


def navigation_like(seed=0):
    """Nine states of which six are measured, 200 epochs; the transition's spectral radius is at most one."""
    rng = np.random.default_rng(seed)
    A = np.eye(9) + 0.1 * rng.normal(size=(9, 9))
    A /= max(1.0, np.abs(np.linalg.eigvals(A)).max())
    model = LinearModel(A, np.zeros((9, 1)), np.diag(rng.uniform(0.01, 0.1, 9)))
    sensor = linear_sensor(np.eye(6, 9), np.diag(rng.uniform(0.1, 1.0, 6)))
    return model, sensor, (np.zeros((1, 9)), np.eye(9), np.zeros((200, 1)), rng.normal(size=(1, 200, 6)), np.ones(200, bool), 9, False)


@pytest.mark.parametrize("centre", ["sum", "product"])
@pytest.mark.parametrize("alpha", [1.0, 0.1])
def test_sigma_points_keep_a_linear_filter_for_200_epochs_whatever_the_weight_of_the_centre(alpha, centre):
    """On a linear problem the central point is the mean: (18) of ghouneem2024 may be a sum, as it should, or the printed product."""
    model, sensor, arguments = navigation_like()
    points = unscented(9, alpha)
    if centre == "product":
        points = points._replace(covariance_centre=points.mean_centre * (3.0 - alpha**2))
    extended, by_points = (run_filter(p, model, sensor, WEIGHTINGS["unit"], *arguments) for p in (Ekf(), points))
    everything(extended, by_points, 1e-10)


def test_sigma_points_of_another_number_of_states_are_refused(problem):
    case = problem(11)
    for points in (unscented(5), unscented(3, 1e-3), unscented(4)._replace(mean_centre=0.0)):
        with pytest.raises(ValueError, match="^the weights of the sigma points do not add up to one for 4 states$"):
            run(points, case, WEIGHTINGS["unit"])
        with pytest.raises(ValueError, match="add up to one"):
            schedule(points, case.model, case.sensor, case.P0, np.ones((EPOCHS, 3)), case.valid, 4, False)


def test_sigma_points_are_refused_beside_noise_that_is_correlated_with_the_prediction(problem):
    case = problem(11, **cross_covariance("C_predict"))
    with pytest.raises(ValueError, match="^sigma points leave no Jacobian"):
        run_filter(unscented(4), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 4, False)


# Failures are data: reason and epoch.


def test_an_innovation_covariance_that_is_not_positive_fails_every_run(problem):
    case = problem(12, R_fixed=np.diag([0.0, -50.0, 0.0]))
    record = run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 4, False)
    plan = schedule(Ekf(), case.model, case.sensor, case.P0, np.ones((EPOCHS, 3)), case.valid, 4, False)
    scheduled = run_schedule(plan, case.model, case.sensor, case.x0, case.controls, case.measurements, 4, False)
    assert record.failed.tolist() == [0, 0] and np.isnan(record.posterior).all()
    everything(record, scheduled, 1e-12)


def test_a_schedule_fails_the_run_whose_measurement_is_missing(problem):
    case = problem(13)
    measurements = case.measurements.copy()
    measurements[0, 13, 1] = np.nan
    plan = schedule(Ekf(), case.model, case.sensor, case.P0, np.ones((EPOCHS, 3)), case.valid, 4, True)
    scheduled = run_schedule(plan, case.model, case.sensor, case.x0, case.controls, measurements, 4, True)
    whole = run_schedule(plan, case.model, case.sensor, case.x0, case.controls, case.measurements, 4, True)
    assert scheduled.failed.tolist() == [13, -1]
    assert np.isnan(scheduled.posterior[0, 13:]).all()
    np.testing.assert_array_equal(scheduled.posterior[0, :13], whole.posterior[0, :13])
    np.testing.assert_array_equal(scheduled.posterior[1], whole.posterior[1])


@pytest.mark.parametrize("what", ["state", "variance"])
def test_a_prediction_that_overflows_fails_although_nothing_is_measured(problem, what):
    case = problem(14)
    A = case.model.A.copy()
    A[3, 3] = 1e100 if what == "variance" else 1e10
    x0 = np.full_like(case.x0, 1e295) if what == "state" else 0.0 * case.x0
    case = case._replace(model=case.model._replace(A=A), x0=x0, valid=np.zeros(EPOCHS, bool), controls=0.0 * case.controls)
    record = run_filter(Ekf(), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 4, False)
    first = int(np.argmax(~np.isfinite(record.prior_variance[0] + record.prior[0]).all(axis=1)))
    assert 0 < first < 5 and record.failed.tolist() == [first - 1, first - 1]
    plan = schedule(Ekf(), case.model, case.sensor, case.P0, np.ones((EPOCHS, 3)), case.valid, 4, False)
    scheduled = run_schedule(plan, case.model, case.sensor, case.x0, case.controls, case.measurements, 4, False)
    if what == "variance":
        everything(record, scheduled, 1e-12)
    for name in ("failed", "prior", "posterior"):
        np.testing.assert_array_equal(getattr(scheduled, name), getattr(record, name))


def test_a_prior_without_a_root_fails_the_unscented_filter_in_its_first_prediction(problem):
    case = problem(15)._replace(P0=np.diag([1.0, 1.0, 1.0, -1.0]), valid=np.zeros(EPOCHS, bool))
    record = run_filter(unscented(4), case.model, case.sensor, WEIGHTINGS["unit"], *case.arguments, 4, False)
    plan = schedule(unscented(4), case.model, case.sensor, case.P0, np.ones((EPOCHS, 3)), case.valid, 4, False)
    assert record.failed.tolist() == [0, 0] and plan.failed == 0
