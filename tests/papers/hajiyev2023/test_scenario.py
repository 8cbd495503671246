"""The simulated experiment: units, inputs, noise, fault, streams."""

from itertools import product

import numpy as np
import pytest

from robins.foundation.errors import InputError
from robins.navigation.aircraft import ANGULAR, STATES
from robins.papers.hajiyev2023.scenario import (
    BRANCHES,
    Q_CHANNEL,
    THETA_CHANNEL,
    baseline,
    controls,
    draw,
    linear_recursion,
    load_plant,
    stream_names,
    system,
)

LEVELS = ("sigma_w", "sigma_v", "sigma_lambda", "sigma_0")


@pytest.mark.parametrize("name", LEVELS)
def test_branches_read_the_same_numbers_in_two_units(name):
    degrees, radians = baseline("deg").si(name), baseline("rad").si(name)
    np.testing.assert_allclose(radians[ANGULAR], np.degrees(degrees[ANGULAR]), rtol=1e-15)
    np.testing.assert_array_equal(radians[~ANGULAR], degrees[~ANGULAR])
    np.testing.assert_array_equal(radians, getattr(baseline("rad"), name))


def test_fault_and_score_cover_both_ends():
    assert (baseline("deg").fault.start, baseline("deg").fault.stop - 1) == (80, 150)


def test_correlated_error_decays_with_tau_and_keeps_its_variance():
    parameters = baseline("deg")
    matrices = system(parameters)
    decay = 1 - parameters.dt / parameters.tau
    np.testing.assert_array_equal(matrices.A_n, decay * np.eye(8))
    sigma_U = parameters.si("sigma_lambda") * np.sqrt(1 - decay**2) / parameters.dt
    np.testing.assert_allclose(np.diag(matrices.Q_lambda), (parameters.dt * sigma_U) ** 2, rtol=1e-13)  # B_n = dt I
    np.testing.assert_allclose(matrices.A_n @ matrices.P0_lambda @ matrices.A_n.T + matrices.Q_lambda, matrices.P0_lambda, rtol=1e-13)


def test_inputs_are_one_degree_doublets_of_one_second_each_way():
    u = np.degrees(controls(baseline("deg")))
    time = np.arange(201) * 0.1
    for column, start in ((0, 1), (1, 1), (2, 4)):
        np.testing.assert_allclose(u[(time > start - 0.05) & (time < start + 0.95), column], 1.0)
        np.testing.assert_allclose(u[(time > start + 0.95) & (time < start + 1.95), column], -1.0)
        assert np.count_nonzero(u[:, column]) == 20 and u[:, column].sum() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("branch", BRANCHES)
def test_truth_and_measurement_obey_equations_1_2_and_4(problem, branch):
    case = problem(2, branch)
    m, x, lam = case.matrices, case.ensemble.x, case.ensemble.lam
    draws = draw(1, "tests", range(2), case.parameters.steps)
    w, v = draws.w * case.parameters.si("sigma_w"), draws.v * case.parameters.si("sigma_v")
    np.testing.assert_allclose(x[:, 1:] - x[:, :-1] @ m.A.T - controls(case.parameters)[:-1] @ m.B.T, w[:, :-1], rtol=0, atol=1e-11)
    driven = draws.U * np.sqrt(np.diag(m.Q_lambda))
    np.testing.assert_allclose(lam[:, 1:] - lam[:, :-1] @ m.A_n.T, driven[:, :-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(case.ensemble.z["healthy"], x + lam + v, rtol=0, atol=1e-14)
    np.testing.assert_allclose(case.ensemble.guess, draws.initial_error * case.parameters.si("sigma_0"), rtol=1e-15)
    assert not x[:, 0].any()


def test_noises_have_their_covariances_and_no_correlation(problem):
    case = problem(200)
    x, p = case.ensemble.x, case.parameters
    w = (x[:, 1:] - x[:, :-1] @ case.matrices.A.T - controls(p)[:-1] @ case.matrices.B.T).reshape(-1, 8)
    v = (case.ensemble.z["healthy"] - x - case.ensemble.lam)[:, :-1].reshape(-1, 8)
    together = np.hstack([w[:, p.si("sigma_w") > 0], v])
    scale = np.concatenate([p.si("sigma_w")[p.si("sigma_w") > 0], p.si("sigma_v")])
    np.testing.assert_allclose(together.T @ together / len(together) / np.outer(scale, scale), np.eye(14), rtol=0, atol=0.03)
    later = w[1:, p.si("sigma_w") > 0].T @ v[:-1] / len(v) / np.outer(scale[:6], scale[6:])
    np.testing.assert_allclose(later, 0.0, rtol=0, atol=0.03)


def test_measurements_with_and_without_the_fault_differ_only_in_two_channels_and_the_window(problem):
    case = problem(3)
    difference = case.ensemble.z["fault"] - case.ensemble.z["healthy"]
    runs, epochs, channels = np.nonzero(difference)
    assert set(channels) == {Q_CHANNEL, THETA_CHANNEL}
    assert set(epochs) == set(range(80, 151)) and set(runs) == {0, 1, 2}
    v = case.ensemble.z["healthy"] - case.ensemble.x - case.ensemble.lam
    np.testing.assert_allclose(difference[:, 80:151, Q_CHANNEL], 7 * v[:, 80:151, Q_CHANNEL], rtol=0, atol=1e-12)
    np.testing.assert_allclose(difference[:, 80:151, THETA_CHANNEL], 4 * v[:, 80:151, THETA_CHANNEL], rtol=0, atol=1e-12)


def test_correlated_error_is_stationary_over_the_runs(problem):
    case = problem(400)
    for epoch in (0, 100, 200):
        np.testing.assert_allclose(case.ensemble.lam[:, epoch].std(axis=0) / case.parameters.si("sigma_lambda"), 1.0, rtol=0, atol=0.15)


def test_lateral_truth_of_the_branches_differs_by_the_unit_only(problem, without_inputs):
    degrees, radians = (without_inputs(problem(2, branch)).ensemble.x[..., 4:] for branch in BRANCHES)
    np.testing.assert_allclose(radians, np.degrees(degrees), rtol=1e-11, atol=1e-15)


def test_a_run_does_not_depend_on_the_size_of_the_ensemble():
    many, few = draw(1, "tests", range(10), 20), draw(1, "tests", range(4), 20)
    alone = draw(1, "tests", range(3, 4), 20)
    for a, b, c in zip(many, few, alone, strict=True):
        np.testing.assert_array_equal(a[3], b[3])
        np.testing.assert_array_equal(a[3], c[0])


def test_no_two_streams_share_a_name_or_their_numbers():
    names = [name for scenario, run in product(("aircraft", "specification"), range(50)) for name in stream_names(scenario, run)]
    assert len(set(names)) == len(names)
    first = [array[run].flat[0] for array in draw(1, "tests", range(20), 5) for run in range(20)]
    assert len(set(first)) == len(first)


def test_recursion_is_the_sum_of_propagated_forcings():
    """Independent formulation: x(k) = A^k x(0) + sum of A^(k-1-j) f(j)."""
    rng = np.random.default_rng(0)
    A, forcing, start = rng.normal(size=(3, 3)) / 3, rng.normal(size=(2, 6, 3)), rng.normal(size=(2, 3))
    x = linear_recursion(A, forcing, start)
    power = np.linalg.matrix_power
    for k in range(6):
        expected = start @ power(A, k).T + sum(forcing[:, j] @ power(A, k - 1 - j).T for j in range(k))
        np.testing.assert_allclose(x[:, k], expected, rtol=0, atol=1e-12)


def test_an_unknown_plant_is_named_with_those_there_are():
    with pytest.raises(InputError, match="f4c"):
        load_plant("bravo")


def test_the_plant_says_that_it_is_a_substitute():
    assert "substitute" in load_plant("f4c")["name"]
    assert len(STATES) == 8
