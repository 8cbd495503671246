"""Sensors: what is added to the truth, how large it is, and that the runs stay paired whatever is switched on."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from robins.foundation.noise_laws import Normal
from robins.foundation.randomness import stream
from robins.papers.imani2026.drive import drive
from robins.papers.imani2026.sensors import (
    GRADES,
    LAWS,
    STREAMS,
    Outliers,
    Sensors,
    Transients,
    draw_outliers,
    draw_transients,
    measure,
    stream_name,
)

SILENT = Sensors(
    accelerometer_noise=0.0, gyroscope_noise=0.0, accelerometer_bias=0.0, gyroscope_bias=0.0, classical_accelerometer_noise=0.0,
    classical_gyroscope_noise=0.0, classical_accelerometer_bias=0.0, classical_gyroscope_bias=0.0, tilt_error=0.0, yaw_error=0.0,
)  # fmt: skip
VEHICLE_SD = np.array([0.05] * 3 + [0.002] * 3)


@pytest.fixture(scope="module")
def driven():
    return drive(10)


@pytest.fixture(scope="module")
def slow():
    return drive(1)


@pytest.fixture(scope="module")
def plain(driven):
    return measure(1, "test", range(30), driven, Sensors())


def test_without_errors_the_samples_are_the_interval_averages(driven):
    seen = measure(1, "test", range(2), driven, SILENT)
    perfect = np.hstack([driven.specific_force_interval, driven.rate_interval])
    for samples in (seen.atomic, seen.classical):
        np.testing.assert_array_equal(samples, np.broadcast_to(perfect, (2, 3300, 6)))
    for error in (seen.bias, seen.classical_bias, seen.attitude_error, seen.noise):
        np.testing.assert_array_equal(error, 0.0)


def test_a_sample_is_truth_and_bias_and_noise(driven, plain):
    perfect = np.hstack([driven.specific_force_interval, driven.rate_interval])
    np.testing.assert_allclose(plain.atomic, perfect + plain.bias[:, None] + plain.noise, atol=1e-14)


def test_the_noise_has_the_stated_deviations_and_laws(plain):
    """30 runs of 3300 samples and three axes; margins of four standard errors (of a variance: excess + 2 over n)."""
    pooled = plain.noise.reshape(-1, 2, 3).swapaxes(0, 1).reshape(2, -1) / VEHICLE_SD[::3, None]
    n = pooled.shape[1]
    for samples, excess in zip(pooled, (6.0, 19.91), strict=True):
        assert abs(samples.mean()) < 4 / np.sqrt(n)
        assert abs(samples.var() - 1.0) < 4 * np.sqrt((excess + 2.0) / n)
    assert stats.skew(pooled[0]) == pytest.approx(0.0, abs=0.1)
    assert stats.skew(pooled[1]) == pytest.approx(2.64, abs=0.26)  # .065 by the law's sixth moment
    assert stats.kurtosis(pooled[0]) == pytest.approx(6.0, abs=0.8)
    assert stats.kurtosis(pooled[1]) == pytest.approx(19.91, abs=5.3)


def test_the_classical_sensors_are_normal_with_their_own_deviations(driven, plain):
    perfect = np.hstack([driven.specific_force_interval, driven.rate_interval])
    noise = plain.classical - perfect - plain.classical_bias[:, None]
    n = 30 * 3300
    np.testing.assert_allclose(noise.std(axis=(0, 1)), [0.02] * 3 + [0.002] * 3, rtol=4 / np.sqrt(2 * n))
    assert np.abs(np.corrcoef(noise.reshape(-1, 6).T, plain.noise.reshape(-1, 6).T) - np.eye(12)).max() < 5 / np.sqrt(n)


def test_biases_and_initial_errors_have_the_stated_deviations(slow):
    runs = 400
    seen = measure(1, "test", range(runs), slow, Sensors())
    relative = 4 / np.sqrt(2 * runs)
    np.testing.assert_allclose(seen.bias.std(axis=0), [1e-3] * 3 + [2e-5] * 3, rtol=relative)
    np.testing.assert_allclose(seen.classical_bias.std(axis=0), [0.03] * 3 + [0.003] * 3, rtol=relative)
    np.testing.assert_allclose(seen.attitude_error.std(axis=0), np.radians([0.02, 0.02, 0.5]), rtol=relative)


def test_a_run_does_not_depend_on_the_runs_beside_it(slow):
    together = measure(1, "test", [0, 7, 3], slow, GRADES["vehicle"])
    alone = measure(1, "test", [3], slow, GRADES["vehicle"])
    for many, one in zip(together, alone, strict=True):
        np.testing.assert_array_equal(many[2], one[0])


def test_every_cause_of_error_has_a_stream_of_its_own():
    names = {stream_name(scenario, run, cause) for scenario in ("a", "b") for run in range(3) for cause in STREAMS}
    words = {stream(1, name).bit_generator.random_raw() for name in names}
    assert len(words) == len(names) == 6 * len(STREAMS)


def test_outliers_leave_the_noise_below_them_alone(driven, plain):
    hit = measure(1, "test", range(30), driven, Sensors(outliers=Outliers(rate=0.05), transients=Transients()))
    for name in ("noise", "bias", "classical", "classical_bias", "attitude_error"):
        np.testing.assert_array_equal(getattr(hit, name), getattr(plain, name))


@pytest.mark.parametrize("one_sided", [False, True])
def test_outliers_have_their_share_their_size_and_their_side(driven, plain, one_sided):
    hit = measure(1, "test", range(30), driven, Sensors(outliers=Outliers(rate=0.02, one_sided=one_sided)))
    added = (hit.atomic - plain.atomic) / VEHICLE_SD
    there = np.abs(added) > 1e-6
    shares = there.mean(axis=(0, 1))
    np.testing.assert_allclose(shares, 0.02, atol=4.5 * np.sqrt(0.02 * 0.98 / 99_000))
    sizes = np.abs(added[there])
    assert sizes.min() >= 7.5 - 1e-6 and sizes.max() <= 22.5 + 1e-6
    assert sizes.mean() == pytest.approx(15.0, abs=4 * 15 / np.sqrt(12 * sizes.size))
    positive = (added[there] > 0).mean()
    assert positive == 1.0 if one_sided else abs(positive - 0.5) < 2 / np.sqrt(sizes.size)


def test_a_higher_rate_keeps_the_outliers_of_a_lower_one():
    few, many = (draw_outliers(stream(1, "test/outliers/0/outliers"), 3300, Outliers(rate=rate)) for rate in (0.01, 0.10))
    kept = few != 0.0
    np.testing.assert_array_equal(many[kept], few[kept])
    assert (many != 0.0).sum() > 5 * kept.sum()


def test_bursts_last_and_keep_the_share():
    samples = 50_000
    burst = draw_outliers(stream(1, "test/outliers/0/bursts"), samples, Outliers(rate=0.05, burst=5))
    share = (burst != 0.0).mean()
    assert share == pytest.approx(0.05, abs=4 * np.sqrt(5 * 0.05 * 0.95 / (6 * samples)))
    for channel in burst.T:
        values, lengths = np.unique(channel[channel != 0.0], return_counts=True)
        assert lengths.max() == 5 and np.median(lengths) == 5
        first = values[np.argmax(lengths)]
        np.testing.assert_array_equal(np.diff(np.flatnonzero(channel == first)), 1)


def test_grades_differ_in_scale_only(slow):
    vehicle, ideal = (measure(1, "test", range(2), slow, GRADES[grade]) for grade in ("vehicle", "atomic-ideal"))
    np.testing.assert_allclose(vehicle.noise / VEHICLE_SD, ideal.noise / ([1e-4] * 3 + [1e-5] * 3), rtol=1e-12)
    np.testing.assert_allclose(vehicle.bias / ([1e-3] * 3 + [2e-5] * 3), ideal.bias / ([1e-6] * 3 + [1e-8] * 3), rtol=1e-12)
    np.testing.assert_array_equal(vehicle.attitude_error, ideal.attitude_error)


@pytest.mark.parametrize(("rate", "factor"), [(1, np.sqrt(0.1)), (10, 1.0), (100, np.sqrt(10.0))])
def test_equal_spectral_density_scales_a_sample_with_the_root_of_the_rate(rate, factor):
    np.testing.assert_allclose(Sensors(equal_psd=True).noise_sd(rate), VEHICLE_SD * factor, rtol=1e-15)
    np.testing.assert_allclose(Sensors().noise_sd(rate), VEHICLE_SD, rtol=1e-15)


def test_equal_spectral_density_scales_the_drawn_noise(slow):
    sample, density = (measure(1, "test", [0], slow, Sensors(equal_psd=equal)) for equal in (False, True))
    np.testing.assert_allclose(density.noise, sample.noise * np.sqrt(0.1), rtol=1e-12)


def test_zero_mode_noise_has_a_mean(slow):
    mean, mode = (measure(1, "test", [0], slow, Sensors(gyroscope_law=LAWS[f"nig-zero-{centre}"])) for centre in ("mean", "mode"))
    np.testing.assert_allclose((mode.noise - mean.noise)[0, :, 3:], 0.2158 * 0.002, rtol=3e-4)
    np.testing.assert_array_equal(mode.noise[..., :3], mean.noise[..., :3])


def test_any_law_can_be_put_in(slow):
    seen = measure(1, "test", range(60), slow, replace(Sensors(), gyroscope_law=Normal()))
    assert stats.kurtosis(seen.noise[..., 3:], axis=None) == pytest.approx(0.0, abs=4 * np.sqrt(24 / (60 * 330 * 3)))


def test_a_transient_decays_with_its_time_constant_and_has_the_pulse_s_integral():
    """Between pulses a sample is exp(-dt / tau) of the one before; all together they integrate to tau times the pulses."""
    transients, dt, samples = Transients(pulse_rate=0.2), 0.1, 20_000
    seen = draw_transients(stream(1, "test/transients/0/transients"), samples, dt, transients)
    jumps = np.diff(seen, axis=0, prepend=0.0)
    jumps[1:] = seen[1:] - np.exp(-dt / 0.5) * seen[:-1]
    pulses = jumps * dt / (0.5 * (1 - np.exp(-dt / 0.5))) / ([1.0] * 3 + [0.05] * 3)
    np.testing.assert_allclose(pulses, np.round(pulses), atol=1e-12)
    expected = 0.2 * dt * samples
    np.testing.assert_allclose(np.abs(np.round(pulses)).sum(axis=0), expected, atol=4.5 * np.sqrt(expected))
    tail = seen[-1] / (np.exp(dt / 0.5) - 1.0)
    np.testing.assert_allclose((seen.sum(axis=0) + tail) * dt, 0.5 * np.round(pulses).sum(axis=0) * ([1.0] * 3 + [0.05] * 3), atol=1e-9)
