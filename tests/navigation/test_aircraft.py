"""The aircraft models: known matrices and eigenvalues, and the zero-order hold against other ways to integrate."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete

from robins.navigation.aircraft import ANGULAR, STATES, continuous_matrices, discretise, lateral_matrices

LONGITUDINAL, LATERAL = slice(0, 4), slice(4, 8)


@pytest.fixture
def plant():
    """The F-4C, about Mach 0.6 at 35 000 ft, as in the wing of hajiyev2023: the plant its numbers are known for."""
    longitudinal = {
        "A": [[7.6180e-4, 4.7612e-3, 0, -9.81], [-6.6657e-2, -2.8567e-1, 180.0, 0], [1.5124e-3, -1.0083e-2, -1.6384e-1, 0], [0, 0, 1, 0]],
        "B": [0.0026532701, -6.8562, -5.4446, 0],
    }
    lateral = {
        "rho": 0.3809, "V0": 178.0, "theta_e": np.radians(9.4), "mass": 17642.0, "Ix": 33898.0, "Iz": 189496.0, "Ixz": 2952.0,
        "S": 49.239, "b": 11.787, "Yv": -0.5974, "Lv": -0.1048, "Nv": 0.0987, "Yp": 0.0, "Lp": -0.1164, "Np": -0.0045,
        "Yr": 0.0, "Lr": 0.0455, "Nr": -0.1132, "aileron": [-0.0159, 0.0454, 0.00084], "rudder": [0.1193, 0.0086, -0.0741],
    }  # fmt: skip
    return {"longitudinal": longitudinal, "lateral": lateral}


def test_lateral_matrices_are_the_known_ones(plant):
    A, B = lateral_matrices(plant["lateral"])
    known_A = [
        [-0.05652, 0.16333, -0.98657, 0.05437],
        [-10.68295, -0.79790, 0.29962, 0],
        [1.65769, -0.01794, -0.13387, 0],
        [0, 1, 0.16555, 0],
    ]
    known_B = [[-0.0015, 0.01129], [4.69818, 0.77029], [0.08871, -1.35747], [0, 0]]
    np.testing.assert_allclose(A, known_A, rtol=0, atol=6e-6)
    np.testing.assert_allclose(B, known_B, rtol=0, atol=6e-6)


def test_modes_are_the_known_ones_and_all_stable(plant):
    A, _ = continuous_matrices(plant)
    for block, known in (
        (LONGITUDINAL, [-0.22179 + 1.34328j, -0.22179 - 1.34328j, -0.00258 + 0.07640j, -0.00258 - 0.07640j]),
        (LATERAL, [-0.16052 + 1.81492j, -0.16052 - 1.81492j, -0.65006, -0.01720]),
    ):
        modes = np.linalg.eigvals(A[block, block])
        np.testing.assert_allclose(np.sort_complex(modes), np.sort_complex(np.array(known)), rtol=0, atol=2e-5)
        assert np.all(modes.real < 0)


def test_longitudinal_and_lateral_motion_do_not_couple(plant):
    A, B = continuous_matrices(plant)
    assert not A[LONGITUDINAL, LATERAL].any() and not A[LATERAL, LONGITUDINAL].any()
    assert not B[LONGITUDINAL, 1:].any() and not B[LATERAL, 0].any()


def test_angles_are_integrals_of_the_rates(plant):
    A, _ = continuous_matrices(plant)
    theta, phi = A[STATES.index("theta")], A[STATES.index("phi")]
    assert theta[STATES.index("q")] == 1.0 and np.count_nonzero(theta) == 1
    assert phi[STATES.index("p")] == 1.0 and phi[STATES.index("r")] == pytest.approx(np.tan(np.radians(9.4)))
    assert [state for state, angular in zip(STATES, ANGULAR, strict=True) if not angular] == ["u", "w"]


def test_a_side_force_moves_the_lateral_velocity_by_force_over_mass(plant):
    """Newton's law: with every moment derivative zero, beta-dot from sideslip is q1 Y_v / m."""
    alone = dict(plant["lateral"], Lv=0.0, Nv=0.0)
    A, _ = lateral_matrices(alone)
    pressure = 0.5 * alone["rho"] * alone["V0"] * alone["S"]
    assert A[0, 0] == pytest.approx(pressure * alone["Yv"] / alone["mass"], rel=1e-14)


def test_pitch_damping_replaces_one_entry(plant):
    A, _ = continuous_matrices(plant)
    damped, _ = continuous_matrices(plant, -0.4462)
    changed = np.argwhere(A != damped)
    assert changed.tolist() == [[2, 2]] and damped[2, 2] == -0.4462


@pytest.mark.parametrize("dt", [0.01, 0.1, 0.2])
def test_zero_order_hold_is_that_of_scipy(plant, dt):
    """Independent implementation: scipy.signal.cont2discrete."""
    A, B = continuous_matrices(plant)
    Ad, Bd = discretise(A, B, dt)
    other_A, other_B, *_ = cont2discrete((A, B, np.eye(8), np.zeros((8, 3))), dt, method="zoh")
    np.testing.assert_allclose(Ad, other_A, rtol=0, atol=1e-12)
    np.testing.assert_allclose(Bd, other_B, rtol=0, atol=1e-12)


def test_one_discrete_step_is_the_solution_of_the_differential_equation(plant):
    """Independent implementation: a Runge-Kutta integration with the input held."""
    A, B = continuous_matrices(plant)
    Ad, Bd = discretise(A, B, 0.1)
    start, held = np.array([3.0, -2.0, 0.02, 0.05, 0.01, -0.03, 0.02, 0.04]), np.array([0.02, -0.01, 0.015])
    flown = solve_ivp(lambda _, x: A @ x + B @ held, (0, 0.1), start, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    np.testing.assert_allclose(Ad @ start + Bd @ held, flown, rtol=0, atol=1e-11)


def test_two_half_steps_are_one_step(plant):
    A, B = continuous_matrices(plant)
    whole, half = discretise(A, B, 0.1)[0], discretise(A, B, 0.05)[0]
    np.testing.assert_allclose(half @ half, whole, rtol=0, atol=1e-13)
