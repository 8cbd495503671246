"""GPS: clean fixes are as good as they say, trouble has the stated size and number, and severity adds trouble but changes nothing else."""

import numpy as np
import pytest

from robins.foundation.errors import InputError
from robins.papers.ghouneem2024 import gps, sensors
from robins.papers.ghouneem2024.gps import (
    ENVIRONMENTS,
    MISLEADING,
    MULTIPATH,
    REPORTED_SIGMA,
    Environment,
    add_burst,
    clean_error,
    events,
    misleading_error,
    receive,
    span,
)
from robins.papers.ghouneem2024.trajectories import RATE_HZ, TRAJECTORIES, trajectory

TRUE_SIGMA = np.array([np.hypot(2.0, 0.7), np.hypot(2.0, 0.7), np.hypot(3.5, 1.1), *[np.hypot(0.05, 0.08)] * 3])
STREAM = np.random.default_rng


def clean(name):
    return ENVIRONMENTS[name].scaled(0.0)


def error(fixes, driven):
    return fixes.value - np.hstack([driven.position, driven.velocity])[fixes.epoch]


def received(name, runs, environment):
    """Errors, causes and presence of many runs on the grid of whole seconds: (runs, T, 6), (runs, T) and (runs, T)."""
    driven = trajectory(name)
    seconds = int(driven.time[-1])
    errors, causes, present = np.zeros((runs, seconds, 6)), np.zeros((runs, seconds), int), np.zeros((runs, seconds), bool)
    for run in range(runs):
        fixes = receive(1, driven, run, environment)
        rows = fixes.epoch // RATE_HZ - 1
        errors[run, rows], causes[run, rows], present[run, rows] = error(fixes, driven), fixes.cause, True
    return errors, causes, present


@pytest.fixture
def pure_burst(monkeypatch):
    """Bursts without their Gauss-Markov part."""
    monkeypatch.setattr(gps, "BURST_POSITION_DRIFT", 0.0)
    monkeypatch.setattr(gps, "BURST_VELOCITY_DRIFT", 0.0)


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_without_trouble_there_is_a_clean_fix_at_every_whole_second(name):
    driven = trajectory(name)
    fixes = receive(1, driven, 0, clean(name))
    np.testing.assert_array_equal(driven.time[fixes.epoch], np.arange(1, int(driven.time[-1]) + 1))
    np.testing.assert_array_equal(fixes.cause, 0)
    np.testing.assert_array_equal(fixes.sigma, np.broadcast_to([2.2, 2.2, 4.0, 0.12, 0.12, 0.12], fixes.value.shape))
    assert np.issubdtype(fixes.epoch.dtype, np.integer) and np.issubdtype(fixes.cause.dtype, np.integer)


def test_clean_errors_have_their_variances_and_are_no_worse_than_reported():
    """Independent runs of four fixes each."""
    runs = 4000
    errors = np.array([clean_error(STREAM(run), 4) for run in range(runs)])
    margin = 4 / np.sqrt(2 * runs)
    np.testing.assert_allclose(errors.std(axis=0), np.broadcast_to(TRUE_SIGMA, (4, 6)), rtol=margin)
    np.testing.assert_allclose(errors.mean(axis=0), 0.0, atol=4.5 * TRUE_SIGMA.max() / np.sqrt(runs))
    share = TRUE_SIGMA / REPORTED_SIGMA
    assert (share <= 1.0).all() and (share > 0.75).all()
    assert np.abs(np.corrcoef(errors[:, 0].T) - np.eye(6)).max() < 5 / np.sqrt(runs)


def test_clean_errors_are_correlated_as_long_as_their_time_constants_say():
    runs, lag = 4000, 10
    errors = np.array([clean_error(STREAM(run), lag + 1) for run in range(runs)])
    covariance = np.mean(errors[:, 0] * errors[:, lag], axis=0)
    expected = np.array([2.0, 2.0, 3.5, 0.05, 0.05, 0.05]) ** 2 * np.exp(-lag / np.array([120.0] * 3 + [20.0] * 3))
    np.testing.assert_allclose(covariance / TRUE_SIGMA**2, expected / TRUE_SIGMA**2, atol=5 / np.sqrt(runs))


def test_a_run_is_the_same_again_and_other_runs_drives_and_seeds_are_not():
    driven = trajectory("t1")
    one = receive(1, driven, 3, clean("t1"))
    for field, again in zip(one, receive(1, driven, 3, clean("t1")), strict=True):
        np.testing.assert_array_equal(field, again)
    for other in (
        receive(1, driven, 4, clean("t1")),
        receive(2, driven, 3, clean("t1")),
        receive(1, driven._replace(name="t2"), 3, clean("t1")),
    ):
        assert (one.value != other.value).all()


def test_clean_errors_and_every_cause_have_streams_of_their_own(monkeypatch):
    names = []
    own = sensors.stream
    monkeypatch.setattr(sensors, "stream", lambda seed, name: names.append(name) or own(seed, name))
    receive(1, trajectory("t2"), 7, ENVIRONMENTS["t2"])
    assert sorted(names) == [f"ghouneem2024/t2/7/{cause}" for cause in ("bursts", "gps", "misleading", "outages")]


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_a_severer_run_keeps_the_errors_and_the_trouble_of_a_milder_one(name):
    driven = trajectory(name)
    for run in range(10):
        ladder = [receive(1, driven, run, ENVIRONMENTS[name].scaled(severity)) for severity in (0.0, 0.25, 0.5, 1.0)]
        for mild, severe in zip(ladder, ladder[1:], strict=False):
            assert np.isin(severe.epoch, mild.epoch).all()
            mild_rows = np.isin(mild.epoch, severe.epoch)
            np.testing.assert_array_equal(mild.cause[mild_rows] & ~severe.cause, 0)
            assert (severe.sigma >= mild.sigma[mild_rows]).all()
            unhurt = severe.cause == 0
            np.testing.assert_array_equal(severe.value[unhurt], mild.value[mild_rows][unhurt])
            np.testing.assert_array_equal(severe.sigma[unhurt], mild.sigma[mild_rows][unhurt])


def test_a_cause_alone_does_what_it_does_among_the_others():
    driven, environment = trajectory("t2"), ENVIRONMENTS["t2"]
    everything = receive(1, driven, 5, environment)
    outages = receive(1, driven, 5, environment._replace(bursts=0.0, misleading=0.0))
    bursts = receive(1, driven, 5, environment._replace(outages=0.0, misleading=0.0))
    np.testing.assert_array_equal(everything.epoch, outages.epoch)
    np.testing.assert_array_equal(outages.cause, 0)
    rows = np.isin(bursts.epoch, everything.epoch)
    np.testing.assert_array_equal(bursts.cause[rows], everything.cause & MULTIPATH)
    np.testing.assert_array_equal(bursts.sigma[rows], everything.sigma)
    alone = everything.cause & MISLEADING == 0
    np.testing.assert_array_equal(bursts.value[rows][alone], everything.value[alone])


@pytest.mark.parametrize("mean", [0.0, 0.5, 6.0, 15.0])
def test_the_number_of_events_is_poisson(mean):
    runs = 4000
    numbers = np.array([sum(1 for _ in events(STREAM(run), mean)) for run in range(runs)])
    assert numbers.mean() == pytest.approx(mean, abs=4 * np.sqrt(mean / runs))
    assert numbers.var() == pytest.approx(mean, abs=4 * np.sqrt((mean + 2 * mean**2) / runs))  # fourth moment of the Poisson law


def test_an_event_begins_uniformly_lasts_uniformly_and_holds_the_fixes_within_it():
    time = np.arange(1.0, 1801.0)
    runs = 4000
    spans = [span(STREAM(run), time, 70.0, (10.0, 60.0)) for run in range(runs)]
    first = np.array([during.start for during in spans]) + 1.0
    assert first.min() >= 70.0 and first.mean() == pytest.approx((70.0 + 1800.0) / 2 + 0.5, abs=4 * 1730 / np.sqrt(12 * runs))
    whole = np.array([during.stop - during.start for during in spans])[first < 1740.0]
    assert whole.min() >= 10 and whole.max() <= 60
    assert whole.mean() == pytest.approx(35.0, abs=4 * 50 / np.sqrt(12 * whole.size))


@pytest.mark.parametrize("name, means", [("t1", (4, 135.0, 10, 35.0)), ("t2", (5, 180.0, 15, 50.0))])
def test_the_shares_of_outages_and_bursts_are_those_of_their_numbers_and_lengths(name, means):
    """Far from the ends the number of events that cover an instant is Poisson with mean rate times mean length."""
    outages, outage_length, bursts, burst_length = means
    runs = 500
    _, causes, present = received(name, runs, ENVIRONMENTS[name])
    end = present.shape[1]
    instants = [450, 800, 1200]
    absent = np.exp(-outages * outage_length / (end - 100.0))
    np.testing.assert_allclose(present[:, instants].mean(axis=0), absent, atol=4.5 * np.sqrt(absent * (1 - absent) / runs))
    _, causes, present = received(name, runs, ENVIRONMENTS[name]._replace(outages=0.0))
    assert present.all()
    untouched = np.exp(-bursts * burst_length / (end - 70.0))
    seen = (causes[:, instants] & MULTIPATH == 0).mean(axis=0)
    np.testing.assert_allclose(seen, untouched, atol=4.5 * np.sqrt(untouched * (1 - untouched) / runs))
    misleading = {"t1": 6, "t2": 10}[name]
    expected = runs * end * (1 - np.exp(-misleading * 3.0 / (end - 70.0))) * (end - 70.0) / end
    assert (causes & MISLEADING > 0).sum() == pytest.approx(expected, rel=4 / np.sqrt(runs * misleading))


def test_nothing_happens_in_the_first_minute():
    _, causes, present = received("t2", 150, ENVIRONMENTS["t2"].scaled(4.0))
    assert (causes[:, :69] == 0).all() and (causes[:, 69:80] > 0).any()
    assert present[:, :99].all() and not present[:, 99:110].all()


def test_a_burst_is_lognormal_in_size_and_uniform_in_direction(pure_burst):
    runs = 4000
    value, sigma = np.zeros((runs, 1, 6)), np.broadcast_to(REPORTED_SIGMA, (runs, 1, 6)).copy()
    for run in range(runs):
        add_burst(STREAM(run), 40.0, value[run], sigma[run])
    north, east, up = value[:, 0, :3].T
    size = np.log(np.hypot(north, east))
    assert size.mean() == pytest.approx(np.log(40.0), abs=4 * 0.7 / np.sqrt(runs)) and size.std() == pytest.approx(
        0.7, rel=4 / np.sqrt(2 * runs)
    )
    assert np.abs(np.mean(np.exp(1j * np.arctan2(east, north)))) < 4 / np.sqrt(runs)
    assert np.std(up / np.hypot(north, east)) == pytest.approx(0.8, rel=4 / np.sqrt(2 * runs))
    np.testing.assert_array_equal(value[:, 0, 3:], 0.0)
    inflation = sigma[:, 0] / REPORTED_SIGMA
    np.testing.assert_allclose(inflation, np.broadcast_to(inflation[:, :1], inflation.shape), rtol=1e-12)
    assert 1.0 <= inflation.min() and inflation.max() <= 4.0 and inflation.mean() == pytest.approx(2.5, abs=4 * 3 / np.sqrt(12 * runs))


def test_within_a_burst_position_and_velocity_wander_in_proportion_to_its_size(monkeypatch):
    runs, fixes = 3000, 6
    with_drift, without = np.zeros((runs, fixes, 6)), np.zeros((runs, fixes, 6))
    sigma = np.ones((fixes, 6))
    for run in range(runs):
        add_burst(STREAM(run), 40.0, with_drift[run], sigma.copy())
    monkeypatch.setattr(gps, "BURST_POSITION_DRIFT", 0.0)
    monkeypatch.setattr(gps, "BURST_VELOCITY_DRIFT", 0.0)
    for run in range(runs):
        add_burst(STREAM(run), 40.0, without[run], sigma.copy())
    size = np.hypot(without[:, 0, 0], without[:, 0, 1])
    wander = (with_drift - without) / size[:, None, None]
    sd = np.array([0.35] * 3 + [0.03] * 3)
    np.testing.assert_allclose(wander.std(axis=0), np.broadcast_to(sd, (fixes, 6)), rtol=4.5 / np.sqrt(2 * runs))
    correlation = np.mean(wander[:, 0] * wander[:, 5], axis=0) / sd**2
    np.testing.assert_allclose(correlation, np.exp(-5.0 / np.array([8.0] * 3 + [5.0] * 3)), atol=5 / np.sqrt(runs))


def test_of_overlapping_bursts_the_larger_inflation_is_reported():
    value, sigma = np.zeros((1, 6)), np.tile(REPORTED_SIGMA, (1, 1))
    factors = []
    for seed in range(5):
        alone = np.tile(REPORTED_SIGMA, (1, 1))
        add_burst(STREAM(seed), 40.0, np.zeros((1, 6)), alone)
        factors.append(alone[0, 0])
        add_burst(STREAM(seed), 40.0, value, sigma)
    assert sigma[0, 0] == max(factors) > min(factors)


def test_a_misleading_error_is_far_off_in_position_and_in_velocity():
    runs = 4000
    errors = np.array([misleading_error(STREAM(run)) for run in range(runs)])
    offset = np.hypot(errors[:, 0], errors[:, 1])
    assert 100.0 <= offset.min() and offset.max() <= 400.0 and offset.mean() == pytest.approx(250.0, abs=4 * 300 / np.sqrt(12 * runs))
    assert np.abs(np.mean(np.exp(1j * np.arctan2(errors[:, 1], errors[:, 0])))) < 4 / np.sqrt(runs)
    assert np.std(errors[:, 2] / offset) == pytest.approx(0.5, rel=4 / np.sqrt(2 * runs))
    second = (1.0 + 8.0 + 64.0) / 3.0  # mean square of U(1, 8)
    fourth = 3.0 * (8.0**5 - 1.0) / 35.0
    np.testing.assert_allclose(np.mean(errors[:, 3:] ** 2, axis=0), second, atol=4 * np.sqrt((fourth - second**2) / runs))


def test_misleading_fixes_are_offset_as_one_and_their_sigma_says_nothing():
    """So few events that none of them overlap."""
    driven = trajectory("t1")
    only = Environment(0.0, (1.0, 1.0), 0.0, (1.0, 1.0), 1.0, 0.7)
    lengths = []
    for run in range(100):
        fixes, undisturbed = receive(1, driven, run, only), receive(1, driven, run, only.scaled(0.0))
        np.testing.assert_array_equal(fixes.sigma, undisturbed.sigma)
        added = fixes.value - undisturbed.value
        hit = fixes.cause == MISLEADING
        np.testing.assert_array_equal(added[~hit], 0.0)
        for first, last in np.flatnonzero(np.diff(np.concatenate([[0], hit, [0]]))).reshape(-1, 2):
            lengths.append(last - first)
            np.testing.assert_allclose(added[first:last], np.broadcast_to(added[first], (last - first, 6)), atol=1e-9)
            assert 100.0 <= np.hypot(*added[first, :2]) <= 400.0
    assert len(lengths) == pytest.approx(70, abs=4 * np.sqrt(70)) and set(lengths) == {1, 2, 3, 4, 5}


def test_a_misleading_fix_in_a_burst_has_both_flags():
    driven = trajectory("t2")
    crowded = ENVIRONMENTS["t2"]._replace(outages=0.0, bursts=60.0, misleading=60.0)
    assert set(receive(1, driven, 0, crowded).cause) == {0, MULTIPATH, MISLEADING, MULTIPATH | MISLEADING}


def test_severity_scales_the_three_mean_numbers_and_nothing_else():
    environment = ENVIRONMENTS["t1"]
    half = environment.scaled(0.5)
    assert (half.outages, half.bursts, half.misleading) == (2.0, 5.0, 3.0)
    assert half._replace(outages=4.0, bursts=10.0, misleading=6.0) == environment == environment.scaled(1.0)


@pytest.mark.parametrize("severity", [-0.5, np.nan, np.inf])
def test_a_severity_that_is_no_severity_is_refused_in_one_line(severity):
    with pytest.raises(InputError, match="^ghouneem2024: severity: found .*, expected a finite number, not negative$"):
        ENVIRONMENTS["t1"].scaled(severity)


def test_a_drive_shorter_than_the_quiet_time_has_clean_fixes_only():
    driven = trajectory("t1")
    short = type(driven)(driven.name, driven.latitude, *(value[: 50 * RATE_HZ + 1] for value in driven[2:]))
    fixes = receive(1, short, 0, ENVIRONMENTS["t1"])
    assert fixes.epoch.size == 50 and (fixes.cause == 0).all()
