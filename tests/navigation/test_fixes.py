"""Fixes are the first six states with the noise that the receiver reports at each epoch."""

import numpy as np
import pytest

from robins.kalman.model import linearise_observation, measurement_noise, observe
from robins.navigation.fixes import CHANNELS, fix_sensor


def test_a_fix_is_the_first_six_states():
    sensor, x, z, H = fix_sensor(9, 9), np.arange(9.0), np.empty(CHANNELS), np.full((CHANNELS, 9), np.nan)
    observe(sensor, x, np.zeros(15), z)
    linearise_observation(sensor, x, np.zeros(15), H)
    np.testing.assert_array_equal(z, x[:6])
    np.testing.assert_array_equal(H, np.eye(6, 9))
    np.testing.assert_array_equal(H @ x, z)


@pytest.mark.parametrize("scale", [1.0, 4.0])
def test_the_noise_of_an_epoch_is_what_the_receiver_reports_for_it(scale):
    sensor, rng = fix_sensor(9, 9, scale), np.random.default_rng(1)
    R = np.full((CHANNELS, CHANNELS), np.nan)
    for _ in range(3):
        u = rng.uniform(0.1, 5.0, 15)
        measurement_noise(sensor, u, R)
        np.testing.assert_allclose(R, scale * np.diag(u[9:] ** 2), rtol=1e-15)


def test_fixes_have_no_fixed_noise_and_none_that_the_state_shares():
    sensor = fix_sensor(9, 9)
    assert not any(np.any(values) for values in (sensor.R_fixed, sensor.C_update, sensor.C_predict))
    assert sensor.C_update is not sensor.C_predict


@pytest.mark.parametrize("scale", [0.0, -1.0, np.nan, np.inf])
def test_a_noise_scale_that_is_not_positive_is_refused(scale):
    with pytest.raises(ValueError, match="noise_scale: found"):
        fix_sensor(9, 9, scale)
