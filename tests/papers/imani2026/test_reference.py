"""The reference system: its errors, and what differentiating it costs."""

import numpy as np
import pytest

from robins.foundation.randomness import stream
from robins.papers.imani2026.drive import CHANNELS, drive, truth
from robins.papers.imani2026.reference import ReferenceErrors, gauss_markov, observe

QUIET = ReferenceErrors(position=(0.0, 1.0), velocity=(0.0, 1.0), tilt=(0.0, 1.0), yaw=(0.0, 1.0), angle_noise=0.0)
ANGLES, RATES = [CHANNELS.index(name) for name in ("roll", "pitch", "yaw")], [CHANNELS.index(name) for name in ("w_e", "w_n", "w_u")]


@pytest.fixture(scope="module")
def driven():
    return drive(10)


def test_without_errors_the_reference_is_the_truth_up_to_its_differences():
    fine = drive(100)
    seen = observe(1, "test", 0, fine, QUIET)
    np.testing.assert_array_equal(seen.position, fine.position)
    kept = [index for index, name in enumerate(CHANNELS) if name[:2] not in ("a_", "w_")]
    np.testing.assert_array_equal(seen.channels[:, kept], truth(fine)[:, kept])
    np.testing.assert_allclose(seen.channels, truth(fine), atol=2e-4)


def test_white_angle_noise_puts_a_floor_under_the_rates(driven):
    """Proposition 8: 0.1 degrees of white noise, central differences at 10 Hz: 0.1 deg sqrt(2) / (2 dt) = .0123 rad/s."""
    noise = np.radians(0.1)
    white = ReferenceErrors((0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), angle_noise=noise)
    without = observe(1, "test", 0, driven, QUIET).channels
    errors = np.concatenate([observe(1, "test", run, driven, white).channels - without for run in range(10)])
    floor = noise * np.sqrt(2.0) / 0.2
    assert floor == pytest.approx(0.0123, abs=5e-5)
    margin = 4 / np.sqrt(len(errors))  # neighbouring differences are correlated: twice the usual variance
    np.testing.assert_allclose(errors[:, RATES].std(axis=0), floor, rtol=margin)
    np.testing.assert_allclose(errors[:, ANGLES].std(axis=0), noise, rtol=margin)


def test_a_gauss_markov_series_is_stationary_and_forgets_with_its_correlation_time():
    sd, tau, dt, series = 0.05, 10.0, 0.1, 4000
    path = gauss_markov(stream(1, "test/reference/0/path").standard_normal((301, series)), sd, tau, dt)
    for epoch in (0, 50, 300):
        assert path[epoch].std() == pytest.approx(sd, rel=4 / np.sqrt(2 * series))
    for lag in (1, 100, 300):
        assert np.corrcoef(path[0], path[lag])[0, 1] == pytest.approx(np.exp(-lag * dt / tau), abs=4 / np.sqrt(series))


def test_the_reference_has_the_stated_errors_over_many_runs():
    runs = 100
    slow = drive(1)
    errors, positions = [], []
    for run in range(runs):
        seen = observe(1, "test", run, slow)
        errors.append((seen.channels - truth(slow))[[10, 120, 230, 329]])
        positions.append((seen.position - slow.position)[[10, 120, 230, 329]])
    n = 4 * runs
    expected = np.hypot(np.radians([0.1, 0.1, 0.3]), np.radians(0.02))
    np.testing.assert_allclose(np.concatenate(errors)[:, ANGLES].std(axis=0), expected, rtol=4.5 / np.sqrt(2 * n))
    np.testing.assert_allclose(np.concatenate(errors)[:, :3].std(axis=0), 0.05, rtol=4.5 / np.sqrt(2 * n))
    np.testing.assert_allclose(np.concatenate(positions).std(axis=0), 2.5, rtol=5.5 / np.sqrt(2 * n))


def test_acceleration_is_the_differentiated_velocity(driven):
    seen = observe(1, "test", 0, driven).channels
    np.testing.assert_allclose(seen[1:-1, 3:6], (seen[2:, :3] - seen[:-2, :3]) * 5.0, atol=1e-12)


def test_rates_turn_the_reported_attitude(driven):
    """Where tilt is small the rate about up is the derivative of yaw; about the others roll and pitch turn with the heading."""
    seen = observe(1, "test", 3, driven).channels
    rates = np.gradient(seen[:, ANGLES], 0.1, axis=0)
    level = np.abs(seen[:, ANGLES[:2]]).max(axis=1) < 0.01
    yaw = seen[:, ANGLES[2]]
    np.testing.assert_allclose(seen[level, RATES[2]], rates[level, 2], atol=1e-3)
    np.testing.assert_allclose(seen[level, RATES[0]], (np.cos(yaw) * rates[:, 0] - np.sin(yaw) * rates[:, 1])[level], atol=1e-3)


def test_runs_and_scenarios_have_errors_of_their_own(driven):
    paths = [observe(1, scenario, run, driven).channels for scenario, run in (("a", 0), ("a", 1), ("b", 0))]
    assert len({path[5, 0] for path in paths}) == 3
    np.testing.assert_array_equal(paths[0], observe(1, "a", 0, driven).channels)
