"""The benchmark's vehicle: its Jacobian is a derivative, and its NumPy form is the compiled one."""

import numpy as np
import pytest

from benchmarks import peers
from benchmarks.models import INPUTS, STATES, drive, linearise_vehicle, process_noise_vehicle, propagate_vehicle, unscented_drive
from benchmarks.reference import definitions

RECORDED = drive(20)


def random_state(seed):
    rng = np.random.default_rng(seed)
    return rng.normal(size=STATES), rng.normal(size=INPUTS)


@pytest.mark.parametrize("seed", range(5))
def test_the_jacobian_is_the_derivative_of_the_propagation(seed):
    x, u = random_state(seed)
    F, Q = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    linearise_vehicle(RECORDED.model, x, u, F, Q)
    step, numerical = 1e-6, np.empty((STATES, STATES))
    for j in range(STATES):
        ahead, behind = x.copy(), x.copy()
        ahead[j] += step
        behind[j] -= step
        propagate_vehicle(RECORDED.model, ahead, u)
        propagate_vehicle(RECORDED.model, behind, u)
        numerical[:, j] = (ahead - behind) / (2 * step)
    np.testing.assert_allclose(F, numerical, rtol=0, atol=1e-8)
    np.testing.assert_array_equal(Q, np.diag(RECORDED.model.noise))


@pytest.mark.parametrize("seed", range(5))
def test_the_numpy_form_is_the_compiled_one(seed):
    x, u = random_state(seed)
    F, Q = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    linearise_vehicle(RECORDED.model, x, u, F, Q)
    np.testing.assert_allclose(peers.jacobian(RECORDED.model, x, u), F, rtol=1e-14)
    moved = peers.propagate(RECORDED.model, x, u)
    propagate_vehicle(RECORDED.model, x, u)
    np.testing.assert_allclose(moved, x, rtol=1e-14)


def test_a_drive_is_the_same_in_every_run():
    np.testing.assert_array_equal(drive(20).measurements, RECORDED.measurements)
    assert not np.array_equal(drive(20, seed=2).measurements, RECORDED.measurements)


def test_the_noise_without_a_jacobian_is_the_one_beside_it():
    F, Q, alone = np.empty((STATES, STATES)), np.empty((STATES, STATES)), np.empty((STATES, STATES))
    linearise_vehicle(RECORDED.model, *random_state(0), F, Q)
    process_noise_vehicle(RECORDED.model, *random_state(0), alone)
    np.testing.assert_array_equal(alone, Q)


def test_the_unscented_filter_gets_the_same_drive():
    unscented = unscented_drive(20)
    for field in ("x0", "P0", "controls", "measurements", "truth"):
        np.testing.assert_array_equal(getattr(unscented, field), getattr(RECORDED, field))
    assert "-DUNSCENTED" in definitions(unscented) and "-DUNSCENTED" not in definitions(RECORDED)
