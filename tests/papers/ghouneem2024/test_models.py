"""The filters are the equations: variances of the brief, (2)-(8) as transitions, and every filter the textbook's, written again."""

import numpy as np
import pytest
from scipy.stats import chi2

from robins.kalman.filter import run_filter
from robins.kalman.model import linearise, propagate
from robins.kalman.weights import weighting
from robins.navigation import riss as mechanisation
from robins.navigation.fixes import fix_sensor
from robins.navigation.riss import (
    ACCELERATION,
    AZIMUTH,
    COS_PITCH,
    COS_ROLL,
    EAST,
    GYRO_BIAS,
    HEIGHT,
    INPUTS,
    NORTH,
    ODOMETER,
    SIN_PITCH,
    STATES,
    V_EAST,
    V_NORTH,
    V_UP,
)
from robins.papers.ghouneem2024 import filters, sensors, trajectories
from robins.papers.ghouneem2024.filters import DT, FILTERS, LOOPS, Variances, datasheet, design, model, physical, predictor
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.runs import controls

ERROR_STATE, TOTAL_STATE = ("ekf-pi", "ekf-pm"), ("ekf-f", "ukf")
EPOCHS = 2400
"""Two minutes of T1, the second of which is driven."""
FIELDS = ("posterior", "posterior_variance", "innovation", "nis")
H = np.eye(6, STATES)


def transition(made, x, u, place="t1"):
    F, Q = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    linearise(model(made, place), x, u, F, Q)
    return F, Q


def moving(seed=0):
    """A state and an input of a car that turns on a slope."""
    rng = np.random.default_rng(seed)
    x = np.array([800.0, -300.0, 120.0, 8.0, 4.0, 0.3, rng.uniform(-3, 3), 1e-3, 0.0])
    u = np.zeros(INPUTS + 6)
    u[:INPUTS] = [rng.uniform(-0.5, 0.5), 9.0, rng.uniform(-1.5, 1.5), 0.04, np.sqrt(1 - 0.04**2), 0.9995, 8.95, 0.04, np.sqrt(1 - 0.04**2)]
    u[INPUTS:] = 2.2, 2.2, 4.0, 0.12, 0.12, 0.12
    return x, u


# Variances.


def test_the_variances_of_the_data_sheet_are_the_briefs():
    white, hour = np.radians(0.0237), np.radians(1 / 3600)
    for name in FILTERS:
        process, initial = datasheet(name)
        total = name in TOTAL_STATE
        assert not process[:6].any()
        assert process[AZIMUTH] == pytest.approx((1.3 * white * 0.05) ** 2)
        assert process[GYRO_BIAS] == pytest.approx(2 * (10 * hour) ** 2 * 0.05 / 300)
        assert process[ODOMETER] == pytest.approx(2 * (0.3 if total else 0.113) ** 2 * 0.05 / 60)
        sd = [3, 3, 5, 0.3, 0.3, 0.3, np.radians(5), np.radians(0.03), 0.3 if total else 0.12]
        np.testing.assert_allclose(np.sqrt(initial), sd)


def test_the_physical_variances_are_the_briefs():
    process, initial = physical()
    white, hour = np.radians(0.0237), np.radians(1 / 3600)
    expected = [0.09 * 0.05, 0.09 * 0.05, 0.25 * 0.05, 0.15**2, 0.15**2, 0.3**2, (2 * white * 0.05) ** 2]
    np.testing.assert_allclose(process, [*expected, 2 * (20 * hour) ** 2 * 0.05 / 300, 2 * 0.09 * 0.05 / 60])
    np.testing.assert_array_equal(initial, datasheet("ekf-f").initial)


def test_only_the_velocity_of_total_state_filters_has_a_floor():
    for name in FILTERS:
        made = design(name, OPTIONS)
        added = model(made, "t1").noise - made.variances.process
        np.testing.assert_array_equal(added, np.where((np.arange(STATES) // 3 == 1) & (name in TOTAL_STATE), 1e-6, 0.0))
    np.testing.assert_array_equal(design("ukf", OPTIONS).variances.process, datasheet("ukf").process)


def test_filters_of_one_model_have_the_same_variances():
    for names in (ERROR_STATE, TOTAL_STATE):
        for one, other in zip(*map(datasheet, names), strict=True):
            np.testing.assert_array_equal(one, other)
    assert LOOPS["ekf-f"] == LOOPS["ukf"] == mechanisation.TOTAL
    assert (LOOPS["ekf-pi"], LOOPS["ekf-pm"]) == (mechanisation.INCREMENTAL, mechanisation.MEMORYLESS)


def test_what_the_filters_take_from_the_data_sheet_is_what_the_sensors_have():
    assert filters.GYRO_NOISE == pytest.approx(sensors.GYROSCOPE_WHITE)
    assert filters.TURN_ON == pytest.approx(sensors.GYROSCOPE_TURN_ON)
    assert filters.BIAS_TIME == sensors.GYROSCOPE_DRIFT_TIME
    assert filters.HEIGHT_OF_ORIGIN == trajectories.START_HEIGHT and mechanisation.GRAVITY == trajectories.GRAVITY
    for place in trajectories.TRAJECTORIES:
        assert model(design("ukf", OPTIONS), place).latitude == trajectories.PLANS[place].latitude


def test_the_limit_of_the_nis_gate_is_its_quantile():
    assert filters.NIS_LIMIT == pytest.approx(chi2.ppf(0.999, 6), rel=1e-12)
    assert round(filters.NIS_LIMIT, 2) == 22.46


# (2)-(8).


def printed_error_model(x, u):
    """F of (2)-(6) for ``x' = F x``, metric, with the signs of states that are subtracted, written out."""
    F = np.zeros((STATES, STATES))
    F[NORTH, V_NORTH] = F[EAST, V_EAST] = F[HEIGHT, V_UP] = 1.0
    sine, cosine = np.sin(x[AZIMUTH]), np.cos(x[AZIMUTH])
    F[V_EAST, AZIMUTH], F[V_EAST, ODOMETER] = u[ACCELERATION] * cosine * u[COS_PITCH], -sine * u[COS_PITCH]
    F[V_NORTH, AZIMUTH], F[V_NORTH, ODOMETER] = -u[ACCELERATION] * sine * u[COS_PITCH], -cosine * u[COS_PITCH]
    F[V_UP, ODOMETER] = -u[SIN_PITCH]
    F[AZIMUTH, GYRO_BIAS] = u[COS_PITCH] * u[COS_ROLL]
    F[ODOMETER, ODOMETER], F[GYRO_BIAS, GYRO_BIAS] = -1 / 60, -1 / 300
    return F


@pytest.mark.parametrize("name", ERROR_STATE)
def test_the_transition_is_unity_plus_the_error_model_times_the_step(name):
    """(8); the two decays are exact, which differs from first order by (dt / tau)^2 / 2."""
    for seed in range(5):
        x, u = moving(seed)
        F, _ = transition(design(name, OPTIONS), x, u)
        np.testing.assert_allclose(F, np.eye(STATES) + printed_error_model(x, u) * 0.05, rtol=0, atol=5e-7)


def test_position_error_is_the_integral_of_velocity_error():
    """(2) with the derivative that its left side lacks: in a second a constant error of velocity is as many metres."""
    x, u = moving()
    error = np.zeros(STATES)
    error[V_EAST : V_UP + 1] = 0.3, -0.7, 0.1
    F, _ = transition(design("ekf-pi", OPTIONS), x, u)
    carried = np.linalg.matrix_power(F, 20) @ error
    np.testing.assert_allclose(carried[[EAST, NORTH, HEIGHT]], [0.3, -0.7, 0.1], rtol=1e-12)
    np.testing.assert_allclose(carried[V_EAST : V_UP + 1], error[V_EAST : V_UP + 1], rtol=1e-12)


@pytest.mark.parametrize(("name", "turning"), [("ekf-pi", True), ("ekf-f", False), ("ukf", False)])
def test_a_small_error_propagates_as_the_transition_says(name, turning):
    """(7). With the terms of the turn the incremental mechanisation is what (2)-(6) linearise, but for terms of the step squared."""
    made, rng = design(name, OPTIONS, turning=turning), np.random.default_rng(1)
    small = 1e-4 * np.array([1, 1, 1, 1, 1, 1, 0.1, 0.01, 1])
    for seed in range(5):
        x, u = moving(seed)
        u[mechanisation.SPEED_BEFORE] = u[mechanisation.SPEED] - u[ACCELERATION] * DT
        error = small * rng.standard_normal(STATES)
        F, _ = transition(made, x, u)
        there, here = x + error, x.copy()
        propagate(model(made, "t1"), there, u)
        propagate(model(made, "t1"), here, u)
        kept = np.abs(there - here - F @ error) / np.abs(small)
        assert kept.max() < (2e-2 if turning else 1e-3)


def test_an_error_of_velocity_that_the_printed_model_keeps_the_memoryless_mechanisation_forgets():
    made = design("ekf-pm", OPTIONS)
    x, u = moving()
    F, _ = transition(made, x, u)
    there = x.copy()
    there[V_EAST] += 1.0
    propagate(model(made, "t1"), there, u)
    propagate(model(made, "t1"), x, u)
    assert F[V_EAST, V_EAST] == 1.0 and there[V_EAST] - x[V_EAST] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", TOTAL_STATE)
def test_without_the_floor_the_predicted_velocities_have_two_degrees_of_freedom(name, random_root):
    made = design(name, OPTIONS)
    x, u = moving()
    F, Q = transition(made, x, u)
    P = F @ random_root @ random_root.T @ F.T
    velocity = slice(V_EAST, V_UP + 1)
    values = np.linalg.eigvalsh(P[velocity, velocity])
    assert values[0] < 1e-12 * values[1]
    assert np.linalg.eigvalsh((P + Q)[velocity, velocity])[0] >= 0.99e-6


@pytest.fixture
def random_root():
    return np.random.default_rng(3).normal(size=(STATES, STATES)) * np.sqrt(datasheet("ukf").initial)[:, None]


# Updates.


def first_minutes(made, prepared):
    """A filter over the first two minutes of a run: its record, and the samples."""
    u = controls(prepared, made.tilt)[:EPOCHS]
    record = run_filter(
        predictor(made), model(made, prepared.case.place), fix_sensor(INPUTS, STATES, made.noise_scale), weighting("unit"),
        prepared.x0[None], np.diag(made.variances.initial), u, prepared.measurements[None, :EPOCHS], prepared.valid[:EPOCHS],
        STATES, False, (EPOCHS - 1,),
    )  # fmt: skip
    return record, u, prepared.measurements[:EPOCHS], prepared.valid[:EPOCHS]


def textbook_update(x, P, z, R):
    """(9)-(11)."""
    K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
    return x + K @ (z - H @ x), (np.eye(STATES) - K @ H) @ P


def unscented_update(made, x, P, z, R):
    """(25)-(31) letter by letter, with points drawn again and the sum in (18)."""
    points, mean_weights, weights = textbook_points(made, x, P)
    seen = points[:, :6]
    z_mean = mean_weights @ seen
    Pyy = R + (weights[:, None] * (seen - z_mean)).T @ (seen - z_mean)
    Pxy = (weights[:, None] * (points - x)).T @ (seen - z_mean)
    K = Pxy @ np.linalg.inv(Pyy)
    return x + K @ (z - z_mean), P - K @ Pyy @ K.T


def textbook_points(made, x, P):
    """(14)-(21)."""
    n = STATES
    lam = made.alpha**2 * (n + made.kappa) - n
    root = np.sqrt(n + lam) * np.linalg.cholesky(P)
    points = np.vstack([x, x + root.T, x - root.T])
    mean_weights = np.full(2 * n + 1, 0.5 / (n + lam))
    weights = mean_weights.copy()
    mean_weights[0] = lam / (n + lam)
    weights[0] = mean_weights[0] + 1 - made.alpha**2 + made.beta
    return points, mean_weights, weights


def unscented_prediction(made, place, x, P, u):
    """(22), (23)."""
    points, mean_weights, weights = textbook_points(made, x, P)
    for point in points:
        propagate(model(made, place), point, u)
    mean = mean_weights @ points
    return mean, np.diag(model(made, place).noise) + (weights[:, None] * (points - mean)).T @ (points - mean)


def follow(made, prepared):
    """The filter of a design in numpy: states and covariances after every update, shapes (N, 9) and (N, 9, 9)."""
    place = prepared.case.place
    _, u, z, valid = first_minutes(made, prepared)
    x, P = prepared.x0.copy(), np.diag(made.variances.initial)
    states, covariances = [], []
    for k in range(EPOCHS):
        if valid[k]:
            R = made.noise_scale * np.diag(u[k, INPUTS:] ** 2)
            x, P = textbook_update(x, P, z[k], R) if made.filter != "ukf" else unscented_update(made, x, P, z[k], R)
            P = (P + P.T) / 2
        states.append(x.copy())
        covariances.append(P)
        if made.filter == "ukf":
            x, P = unscented_prediction(made, place, x, P, u[k])
        else:
            F, Q = transition(made, x, u[k], place)
            propagate(model(made, place), x, u[k])
            P = F @ P @ F.T + Q
    return np.array(states), np.array(covariances)


SCALE = np.sqrt(datasheet("ukf").initial)


@pytest.mark.parametrize("name", FILTERS)
def test_the_update_with_a_fix_is_the_textbook_one(prepared, name):
    """(7)-(11) and (14)-(31) in numpy, for two minutes of a run, with the variances that the receiver reports, times four."""
    made = design(name, OPTIONS, noise_scale=4.0)
    record, *_ = first_minutes(made, prepared())
    states, covariances = follow(made, prepared())
    np.testing.assert_allclose(record.posterior[0] / SCALE, states / SCALE, rtol=0, atol=1e-7)
    variances = np.diagonal(covariances, axis1=1, axis2=2)
    np.testing.assert_allclose(record.posterior_variance[0], variances, rtol=1e-6)
    np.testing.assert_allclose(
        record.covariance[0, 0] / np.outer(SCALE, SCALE), covariances[-1] / np.outer(SCALE, SCALE), rtol=0, atol=1e-9
    )


@pytest.mark.parametrize("name", ERROR_STATE)
def test_feedback_of_the_error_state_is_the_update_of_the_state(prepared, name):
    """(10): an error state that begins at zero, ``Z`` = GPS minus RISS, and its estimate added to the mechanisation, which then goes on."""
    made, trip = design(name, OPTIONS), prepared()
    record, u, z, valid = first_minutes(made, trip)
    riss, P = trip.x0.copy(), np.diag(made.variances.initial)
    for k in range(EPOCHS):
        if valid[k]:
            Z, error = z[k] - riss[:6], np.zeros(STATES)
            K = P @ H.T @ np.linalg.inv(H @ P @ H.T + np.diag(u[k, INPUTS:] ** 2))
            error = error + K @ (Z - H @ error)
            P = (np.eye(STATES) - K @ H) @ P
            riss += error
        np.testing.assert_allclose(record.posterior[0, k] / SCALE, riss / SCALE, rtol=0, atol=1e-7)
        F, Q = transition(made, riss, u[k])
        propagate(model(made, "t1"), riss, u[k])
        P = F @ P @ F.T + Q


# Bad input.


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"gate": "chi-square"}, "gate: found"),
        ({"multiple": 0.0}, "multiple: found"),
        ({"multiple": -1.0}, "multiple: found"),
        ({"multiple": np.nan}, "multiple: found"),
        ({"noise_scale": 0.0}, "noise_scale: found"),
        ({"noise_scale": np.nan}, "noise_scale: found"),
        ({"variances": Variances(-np.ones(STATES), np.ones(STATES))}, "process: found"),
        ({"variances": Variances(np.ones(STATES), np.full(STATES, np.nan))}, "initial: found"),
        ({"variances": Variances(np.ones(STATES), np.full(STATES, np.inf))}, "initial: found"),
        ({"variances": Variances(np.ones(8), np.ones(STATES))}, "process: found"),
    ],
)
def test_a_design_that_makes_no_sense_is_refused_by_its_field(fields, message):
    with pytest.raises(ValueError, match=message):
        design("ukf", OPTIONS, **fields)


def test_a_filter_that_there_is_not_is_refused():
    with pytest.raises(ValueError, match="filter: found 'ekf'"):
        design("ekf", OPTIONS)


@pytest.mark.parametrize("alpha", [0.0, -0.1, 1.01, np.nan])
def test_a_spread_outside_its_range_is_refused(alpha):
    with pytest.raises(ValueError, match="alpha"):
        predictor(design("ukf", OPTIONS, alpha=alpha))


def test_the_configured_sigma_points_are_those_of_the_filter_and_an_ablation_replaces_them():
    options = {"alpha": 0.3, "beta": 1.0, "kappa": 2.0}
    assert design("ukf", options)[-5:-2] == (0.3, 1.0, 2.0)
    assert design("ukf", options, alpha=1.0).alpha == 1.0
