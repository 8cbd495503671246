"""What a contribution owes: the weight's limit, the model's properties, the printed defect, a complete registry."""

from pathlib import Path

import numpy as np
import pytest
from robins_example.filters import estimate
from robins_example.model import Cart, range_sensor
from robins_example.paper import PAPER
from robins_example.scenario import Parameters, simulate
from robins_example.weight import EFFICIENT, cauchy

from robins.foundation.randomness import stream
from robins.kalman.model import linearise, linearise_observation, observe, propagate
from robins.papers.protocol import Settings
from robins.publish.equations import incomplete

SETTINGS = Settings("smoke", 1, {"runs": 4})
CART, SENSOR, U = Cart(0.2, 0.005, 0.3), range_sensor(np.array(Parameters().beacons), 0.5), np.array([0.5])


def test_an_infinite_threshold_gives_the_ekf():
    ekf, limit = estimate(SETTINGS), estimate(SETTINGS, "example-cauchy", (1e9,))
    np.testing.assert_allclose(limit.arrays["rms_error"], ekf.arrays["rms_error"], rtol=0, atol=1e-10)
    weighted = estimate(SETTINGS, "example-cauchy", (EFFICIENT,))
    assert np.all(weighted.table["rmse"] < ekf.table["rmse"])  # so the threshold does reach the filter


def test_the_weight_is_one_half_at_the_threshold():
    S, R, weights = np.diag([3.0, 8.0]), np.eye(2), np.ones(2)
    cauchy(np.array([2.0 * EFFICIENT, -3.0 * EFFICIENT]), S, R, np.array([EFFICIENT]), np.zeros((1, 1)), 0, weights)
    np.testing.assert_allclose(weights, 0.5, rtol=1e-15)


@pytest.mark.parametrize("velocity", [-8.0, 0.3, 9.0])
def test_jacobians_are_the_slopes_of_the_kernels(velocity):
    x, step = np.array([40.0, velocity]), 1e-5
    F, Q, H = np.empty((2, 2)), np.empty((2, 2)), np.empty((3, 2))
    linearise(CART, x, U, F, Q)
    linearise_observation(SENSOR, x, U, H)
    for i in range(2):
        above, below = x + step * np.eye(2)[i], x - step * np.eye(2)[i]
        seen_above, seen_below = np.empty(3), np.empty(3)
        observe(SENSOR, above, U, seen_above)
        observe(SENSOR, below, U, seen_below)
        propagate(CART, above, U)
        propagate(CART, below, U)
        np.testing.assert_allclose(F[:, i], (above - below) / (2 * step), atol=1e-8)
        np.testing.assert_allclose(H[:, i], (seen_above - seen_below) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("velocity", [-8.0, 9.0])
def test_drag_brakes_in_both_directions(velocity):
    x = np.array([0.0, velocity])
    propagate(CART, x, np.zeros(1))
    assert abs(x[1]) < abs(velocity)
    printed = velocity - CART.dt * CART.drag * velocity**2  # as printed: backwards the cart gains speed
    assert (abs(printed) < abs(velocity)) == (velocity > 0)


def test_without_noise_the_simulated_cart_moves_as_the_model_says():
    p = Parameters(acceleration_sd=0.0)
    truth, x = simulate(p, 1, 1).truth[0], np.zeros(2)
    for k in range(p.steps):
        np.testing.assert_allclose(truth[k], x, rtol=1e-12)
        propagate(CART, x, p.controls[k])


def test_a_run_does_not_depend_on_how_many_there_are():
    np.testing.assert_array_equal(simulate(Parameters(), 1, 2).ranges, simulate(Parameters(), 1, 5).ranges[:2])
    assert stream(1, "example2026/rail/0/range").random() != stream(1, "example2026/rail/1/range").random()


def test_every_equation_has_a_line_of_code_and_a_test():
    assert incomplete(PAPER, Path(__file__).parents[1]) == []
