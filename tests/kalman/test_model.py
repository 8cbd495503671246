"""The linear model and sensor, inside and outside compiled code; and a model whose state is not a vector, in a filter."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import njit
from numba.core.errors import TypingError

from robins.kalman.extension import implements
from robins.kalman.filter import run_filter, schedule
from robins.kalman.model import LinearModel, linear_sensor, linearise, linearise_observation, measurement_noise, observe, propagate, retract
from robins.kalman.predict import Ekf, unscented
from robins.kalman.reweighted import process
from robins.kalman.update import update_error


class Nothing(NamedTuple):
    """A model that nobody wrote kernels for."""

    a: float


@njit
def everything(model, sensor, x, u, F, Q, z, H):
    observe(sensor, x, u, z)
    linearise_observation(sensor, x, u, H)
    linearise(model, x, u, F, Q)
    propagate(model, x, u)


def in_python(model, sensor, x, u, F, Q, z, H):
    observe(sensor, x, u, z)
    linearise_observation(sensor, x, u, H)
    linearise(model, x, u, F, Q)
    propagate(model, x, u)


@pytest.mark.parametrize("call", [everything, in_python], ids=["compiled", "in python"])
def test_a_linear_system_is_its_matrices(problem, call):
    case = problem(3)
    x, u = case.x0[0].copy(), case.controls[0]
    F, Q, z, H = (np.full(shape, np.nan) for shape in ((4, 4), (4, 4), 3, (3, 4)))
    call(case.model, case.sensor, x, u, F, Q, z, H)
    np.testing.assert_allclose(z, case.sensor.H @ case.x0[0] + case.sensor.D @ u, rtol=1e-14)
    np.testing.assert_allclose(x, case.model.A @ case.x0[0] + case.model.B @ u, rtol=1e-13, atol=1e-14)
    for matrix, expected in ((F, case.model.A), (Q, case.model.Q), (H, case.sensor.H)):
        np.testing.assert_array_equal(matrix, expected)


def test_a_sensor_has_zeros_where_nothing_is_given_and_contiguous_arrays():
    sensor = linear_sensor(np.ones((4, 2), dtype=int).T, np.eye(2), inputs=3)
    shapes = {"H": (2, 4), "D": (2, 3), "R": (2, 2), "R_fixed": (2, 2), "C_update": (4, 2), "C_predict": (4, 2)}
    for name, shape in shapes.items():
        array = getattr(sensor, name)
        assert array.shape == shape and array.dtype == float and array.flags.c_contiguous
        assert name in ("H", "R") or not array.any()


@pytest.mark.parametrize("generic", [propagate, linearise, observe, linearise_observation])
def test_a_model_without_a_kernel_is_told_how_to_get_one(generic):
    arguments = {propagate: 2, linearise: 4, observe: 3, linearise_observation: 3}[generic]
    message = rf"Nothing has no kernel for {generic.__name__}; register one with implements\(\)"
    with pytest.raises(TypingError, match=message):
        generic(Nothing(1.0), *[np.zeros(1)] * arguments)


def test_a_missing_kernel_is_told_by_the_compiler_too():
    @njit
    def compiled(model, x):
        propagate(model, x, x)

    with pytest.raises(TypingError, match="Nothing has no kernel for propagate"):
        compiled(Nothing(1.0), np.zeros(1))


@pytest.mark.parametrize("compiled", [False, True], ids=["in python", "compiled"])
def test_an_error_is_added_where_the_model_does_not_say_otherwise(problem, compiled):
    apply = njit(lambda model, x, error: retract(model, x, error)) if compiled else retract
    x = np.array([1.0, 2.0, 3.0, 4.0])
    apply(problem(1).model, x, np.array([0.5, -2.0, 0.0, 1.0]))
    np.testing.assert_array_equal(x, [1.5, 0.0, 3.0, 5.0])


@pytest.mark.parametrize("compiled", [False, True], ids=["in python", "compiled"])
def test_the_noise_of_an_epoch_is_the_sensors_own_where_the_sensor_does_not_say_otherwise(problem, compiled):
    write = njit(lambda sensor, u, R: measurement_noise(sensor, u, R)) if compiled else measurement_noise
    R = np.array([[2.0, 0.5], [0.5, 3.0]])
    write(problem(1).sensor, np.zeros(1), R)
    np.testing.assert_array_equal(R, [[2.0, 0.5], [0.5, 3.0]])


# A state on the circle: two numbers, (cos, sin) of an angle, with an error of one.


class Circle(NamedTuple):
    """The angle grows by the input."""

    q: float


class Compass(NamedTuple):
    """Measures both numbers; noise as in `robins.kalman.model.Sensor`."""

    R: np.ndarray
    R_fixed: np.ndarray
    C_update: np.ndarray
    C_predict: np.ndarray


class Plain(NamedTuple):
    """A weighting with an update of its own: the plain one. It keeps every weight of the package out of the compilation."""

    memory: np.ndarray


COMPASS = Compass(np.diag([0.02, 0.05]), np.zeros((2, 2)), np.zeros((1, 2)), np.zeros((1, 2)))
PLAIN = Plain(np.zeros((1, 1)))
RUNS, EPOCHS, Q, P0 = 3, 40, 1e-3, 0.09


@pytest.fixture(scope="module")
def circle(registry):
    @njit
    def turn(x, angle):
        c, s = np.cos(angle), np.sin(angle)
        x[0], x[1] = c * x[0] - s * x[1], s * x[0] + c * x[1]

    @implements(propagate, Circle)
    @njit
    def propagate_circle(model, x, u):
        turn(x, u[0])

    @implements(retract, Circle)
    @njit
    def retract_circle(model, x, error):
        turn(x, error[0])

    @implements(linearise, Circle)
    @njit
    def linearise_circle(model, x, u, F, Q):
        F[0, 0], Q[0, 0] = 1.0, model.q

    @implements(observe, Compass)
    @njit
    def observe_compass(sensor, x, u, z):
        z[0], z[1] = x[0], x[1]

    @implements(linearise_observation, Compass)
    @njit
    def linearise_compass(sensor, x, u, H):
        H[0, 0], H[1, 0] = -x[1], x[0]

    @implements(process, Plain)
    @njit
    def process_plain(weighting, P, sensor, correlated, memory, epoch, weights, predicted, work):
        weights[:] = 1.0
        return update_error(P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, correlated, weights, work)

    return Circle(Q)


def circle_case(seed=1):
    """Initial states, controls of each run, measurements; and the angles that the runs begin with."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(-3.0, 3.0, RUNS)
    controls, measurements = 0.3 * rng.normal(size=(RUNS, EPOCHS, 1)), rng.normal(size=(RUNS, EPOCHS, 2))
    return np.stack([np.cos(start), np.sin(start)], axis=1), controls, measurements, start


def test_a_filter_over_errors_is_the_textbook_filter_of_the_angle(circle):
    """Independent: the extended Kalman filter whose state is the angle; every run with its own controls."""
    x0, controls, measurements, start = circle_case()
    valid, marks = np.arange(EPOCHS) % 7 != 3, (0, 10, EPOCHS - 1)
    record = run_filter(Ekf(), circle, COMPASS, PLAIN, x0, np.array([[P0]]), controls, measurements, valid, 2, False, marks)
    assert record.posterior.shape == (RUNS, EPOCHS, 2) and record.posterior_variance.shape == (RUNS, EPOCHS, 1)
    assert record.covariance.shape == (RUNS, 3, 1, 1) and np.all(record.failed == -1)
    for run in range(RUNS):
        angle, P = start[run], P0
        for k in range(EPOCHS):
            np.testing.assert_allclose(record.prior[run, k], [np.cos(angle), np.sin(angle)], rtol=0, atol=1e-11)
            assert record.prior_variance[run, k, 0] == pytest.approx(P, rel=1e-10)
            if valid[k]:
                H = np.array([-np.sin(angle), np.cos(angle)])
                gain = P * H @ np.linalg.inv(P * np.outer(H, H) + COMPASS.R)
                angle += gain @ (measurements[run, k] - [np.cos(angle), np.sin(angle)])
                P -= P * gain @ H
            np.testing.assert_allclose(record.posterior[run, k], [np.cos(angle), np.sin(angle)], rtol=0, atol=1e-11)
            assert record.posterior_variance[run, k, 0] == pytest.approx(P, rel=1e-10)
            if k in marks:
                assert record.covariance[run, marks.index(k), 0, 0] == record.posterior_variance[run, k, 0]
            angle, P = angle + controls[run, k, 0], P + Q
    np.testing.assert_allclose(np.linalg.norm(record.posterior, axis=2), 1.0, rtol=0, atol=1e-14)


@pytest.mark.parametrize(("predictor", "delayed"), [(Ekf(), True), (unscented(1), False)], ids=["delayed estimate", "sigma points"])
def test_what_needs_a_state_as_long_as_its_error_says_so(predictor, delayed):
    x0, controls, measurements, _ = circle_case()
    with pytest.raises(ValueError, match="need a state that is as long as its error"):
        run_filter(predictor, Circle(Q), COMPASS, PLAIN, x0, np.eye(1), controls, measurements, np.ones(EPOCHS, bool), 2, delayed)


# A receiver that reports the standard deviation of each of its fixes.


class Receiver(NamedTuple):
    """Measures the only state; the standard deviation is the second input, where that is not zero."""

    R: np.ndarray
    R_fixed: np.ndarray
    C_update: np.ndarray
    C_predict: np.ndarray


RECEIVER = Receiver(np.array([[0.5]]), np.array([[0.1]]), np.zeros((1, 1)), np.zeros((1, 1)))
WALK = LinearModel(np.eye(1), np.array([[1.0, 0.0]]), np.array([[Q]]))


@pytest.fixture(scope="module")
def receiver(circle):
    @implements(observe, Receiver)
    @njit
    def observe_position(sensor, x, u, z):
        z[0] = x[0]

    @implements(linearise_observation, Receiver)
    @njit
    def linearise_position(sensor, x, u, H):
        H[0, 0] = 1.0

    @implements(measurement_noise, Receiver)
    @njit
    def report(sensor, u, R):
        if u[1] > 0.0:
            R[0, 0] = u[1] ** 2

    return RECEIVER


def test_each_epoch_is_processed_with_the_noise_that_the_sensor_reports_for_it(receiver):
    """Independent: the scalar filter. Every run begins with the sensor's own noise, and what is not measured is not reported."""
    rng = np.random.default_rng(2)
    controls = np.stack([rng.normal(size=EPOCHS), rng.uniform(0.1, 2.0, EPOCHS)], axis=1)
    controls[[0, 9], 1] = 0.0
    valid, measurements = np.arange(EPOCHS) % 7 != 1, rng.normal(size=(2, EPOCHS, 1))
    own = receiver.R.copy()
    record = run_filter(Ekf(), WALK, receiver, PLAIN, np.zeros((2, 1)), np.array([[P0]]), controls, measurements, valid, 1, False)
    for run in range(2):
        x, P, R = 0.0, P0, receiver.R[0, 0]
        for k in range(EPOCHS):
            if valid[k]:
                R = controls[k, 1] ** 2 or R
                gain = P / (P + R + receiver.R_fixed[0, 0])
                assert record.innovation_variance[run, k, 0] == pytest.approx(P + R + receiver.R_fixed[0, 0], rel=1e-12)
                x, P = x + gain * (measurements[run, k, 0] - x), (1.0 - gain) * P
            assert record.posterior[run, k, 0] == pytest.approx(x, rel=1e-10, abs=1e-12)
            assert record.posterior_variance[run, k, 0] == pytest.approx(P, rel=1e-10)
            x, P = x + controls[k, 0], P + Q
    np.testing.assert_array_equal(receiver.R, own)


def test_a_schedule_refuses_a_sensor_whose_noise_depends_on_the_input(receiver):
    with pytest.raises(ValueError, match="^a schedule needs measurement noise that does not depend on the input$"):
        schedule(Ekf(), WALK, receiver, np.eye(1), np.ones((EPOCHS, 1)), np.ones(EPOCHS, bool), 1, False)
