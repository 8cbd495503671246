"""One run: errors that are wrapped, times until they settle, fixes that are held, what counts as failed, and independence of the rest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robins.navigation.riss import AZIMUTH, INPUTS, STATES
from robins.papers.ghouneem2024 import runs
from robins.papers.ghouneem2024.filters import PATIENCE, Variances, datasheet, design, physical
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.runs import (
    BOUND,
    CHANNELS,
    COLUMNS,
    FIRST_MOTION,
    MEASURES,
    controls,
    errors,
    headline,
    held_fixes,
    longest,
    marks,
    measure,
    prepare,
    received,
    score,
    score_held,
    scores,
    settling,
    truth,
    wrapped,
)
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES, trajectory

angles = st.floats(-50.0, 50.0)


# The azimuth.


@given(angle=angles, turns=st.integers(-20, 20))
def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(angle, turns):
    found = wrapped(np.array(angle + 2 * np.pi * turns))
    assert -np.pi <= found < np.pi
    np.testing.assert_allclose([np.sin(found), np.cos(found)], [np.sin(angle), np.cos(angle)], atol=1e-12)


@given(turns=st.integers(-5, 5), offset=st.floats(-3.0, 3.0))
def test_whole_turns_change_no_error_but_the_unwrapped_one(turns, offset):
    estimate = truth("t2")[:400].copy()
    estimate[:, AZIMUTH] += offset
    moved = estimate.copy()
    moved[:, AZIMUTH] += 2 * np.pi * turns
    at = slice(0, 400)
    one, other = errors(np.vstack([estimate, truth("t2")[400:]]), "t2", at), errors(np.vstack([moved, truth("t2")[400:]]), "t2", at)
    np.testing.assert_allclose(one, other, atol=1e-12)
    np.testing.assert_allclose(one[:, AZIMUTH], offset, atol=1e-12)


@pytest.mark.parametrize(("share", "degrees"), [(0.0825, 103.4), (0.0162, 45.8)])
def test_an_unwrapped_error_of_a_turn_in_some_samples_has_the_published_level(share, degrees):
    """Just on the other side of north for a share of the samples."""
    estimate, true = truth("t2").copy(), truth("t2")
    across = np.arange(len(true)) < share * len(true)
    raw = np.remainder(true[:, AZIMUTH], 2 * np.pi)
    estimate[across, AZIMUTH] += 2 * np.pi - 1e-9 - raw[across]
    found = measure(estimate, "t2")
    by_hand = np.sqrt(np.mean(np.where(across, 2 * np.pi - raw, 0.0) ** 2))
    assert found["azimuth_unwrapped"] == pytest.approx(by_hand, rel=1e-6)
    assert found["azimuth"] <= found["azimuth_unwrapped"] + 1e-12
    assert np.degrees(2 * np.pi * np.sqrt(share)) == pytest.approx(degrees, abs=0.1)


@given(st.lists(st.floats(-0.3, 0.3), min_size=1, max_size=60))
def test_an_azimuth_has_settled_when_it_never_leaves_five_degrees_again(values):
    error = np.array(values)
    start = round(FIRST_MOTION * 20)
    whole = np.concatenate([np.zeros(start), error])
    found = settling(whole)
    if np.isinf(found):
        assert abs(error[-1]) >= np.radians(5)
    else:
        first = round(found * 20)
        assert (np.abs(error[first:]) < np.radians(5)).all()
        assert first == 0 or abs(error[first - 1]) >= np.radians(5)


def test_an_error_that_is_no_number_has_not_settled():
    assert settling(np.array([0.0, np.nan])) == np.inf
    assert settling(np.zeros(3000)) == 0.0 and settling(np.r_[1.0, np.zeros(3000)]) == 0.0


@pytest.mark.parametrize("place", TRAJECTORIES)
def test_the_first_motion_is_after_a_minute(place):
    driven = trajectory(place)
    assert FIRST_MOTION - 0.05 <= driven.time[np.argmax(driven.speed > 0)] <= FIRST_MOTION + 1.0


# Measures.


def test_measures_are_root_mean_squares_over_the_whole_run():
    rng = np.random.default_rng(1)
    error = rng.normal(size=(len(truth("t2")), 7)) * [3, 4, 5, 0.1, 0.2, 0.3, 0.01]
    found = measure(truth("t2") + error, "t2")
    assert tuple(found) == MEASURES
    rmse = np.sqrt(np.mean(error**2, axis=0))
    names = ("north", "east", "height", "v_east", "v_north", "v_up", "azimuth")
    assert set(names) == set(CHANNELS)
    for name, value in zip(names, rmse, strict=True):
        assert found[name] == pytest.approx(value, rel=1e-9)
    assert found["horizontal"] == pytest.approx(np.hypot(rmse[0], rmse[1]))
    bend = error[2:, :2] - 2 * error[1:-1, :2] + error[:-2, :2]
    assert found["roughness"] == pytest.approx(np.sqrt(np.mean(np.sum(bend**2, axis=1))), rel=1e-6)


@given(st.lists(st.booleans(), max_size=40))
def test_the_longest_run_of_flags_is_counted(flags):
    words = "".join("x" if flag else " " for flag in flags).split()
    assert longest(np.array(flags, bool)) == max(map(len, words), default=0)


def test_consistency_is_that_of_the_record(prepared, fly):
    samples = prepared("t1", 101)
    flown = fly("ekf-f", samples, variances=physical(), gate="nis-recovery")
    row = runs.consistency(flown.record, samples)
    used = samples.fixes.epoch
    kept = ~flown.refused
    assert row["fixes"] == used.size and row["rejected"] == flown.refused.sum() and row["longest_rejection"] <= PATIENCE + 1
    assert row["nis"] == pytest.approx(flown.record.nis[0, used[kept]].mean())
    total = []
    for P, k in zip(flown.record.covariance[0], marks("t1"), strict=True):
        total.append(flown.error[k, :3] @ np.linalg.inv(P[:3, :3]) @ flown.error[k, :3])
    assert row["nees_position"] == pytest.approx(np.mean(total))
    variances = flown.record.posterior_variance[0, marks("t1"), AZIMUTH]
    assert row["nees_azimuth"] == pytest.approx(np.mean(flown.error[marks("t1"), AZIMUTH] ** 2 / variances))


# What a run is made of.


def test_an_outage_of_a_case_takes_its_fixes_and_no_others(prepared):
    case = prepared("t1", 400, 0.0).case
    whole, less = received(case, 400), received(case._replace(outage=(600.0, 300.0)), 400)
    missing = np.isin(whole.epoch, less.epoch, invert=True)
    np.testing.assert_array_equal(whole.epoch[missing] / 20, np.arange(600, 900))
    np.testing.assert_array_equal(whole.value[~missing], less.value)


def test_the_start_has_the_errors_of_the_run_or_the_azimuth_of_the_case():
    case = headline(1, "t1")
    plain, turned = prepare(case, 3).x0, prepare(case._replace(azimuth_error=2.0), 3).x0
    np.testing.assert_array_equal(plain[:AZIMUTH], turned[:AZIMUTH])
    assert turned[AZIMUTH] - truth("t1")[0, AZIMUTH] == pytest.approx(2.0)
    assert not plain[3:6].any() and not plain[7:].any()
    starts = np.array([prepare(case, run).x0 - np.r_[truth("t1")[0], 0, 0] for run in range(40)])
    np.testing.assert_allclose(starts[:, [0, 1, 2, 6]].std(axis=0), [2.5, 2.5, 4.0, np.radians(5)], rtol=0.35)


def test_controls_hold_samples_and_the_sigmas_of_this_epoch(prepared):
    samples = prepared("t1", 100)
    u = controls(samples, "level")
    np.testing.assert_array_equal(u[samples.fixes.epoch, INPUTS:], samples.fixes.sigma)
    assert not u[~samples.valid, INPUTS:].any()
    np.testing.assert_array_equal(u[:-1, 0], samples.sensed.rate[1:])
    np.testing.assert_array_equal(samples.measurements[samples.valid], samples.fixes.value)


def test_a_filter_without_updates_knows_of_no_fix(prepared, fly):
    samples = prepared("t1", 100)
    other = samples._replace(measurements=samples.measurements + 1e3)
    one, two = (fly("ekf-f", each, updates=False) for each in (samples, other))
    np.testing.assert_array_equal(one.record.posterior, two.record.posterior)
    assert np.isnan(one.record.weights).all()


def test_fixes_that_are_held_are_those_of_the_last_epoch(prepared):
    samples = prepared("t2", 100)
    held, fixes = held_fixes(samples), samples.fixes
    assert held.shape == truth("t2").shape
    np.testing.assert_array_equal(held[: fixes.epoch[0]], np.tile(samples.x0[:7], (fixes.epoch[0], 1)))
    course = samples.x0[AZIMUTH]
    for i, k in enumerate(fixes.epoch):
        last = fixes.epoch[i + 1] if i + 1 < fixes.epoch.size else len(held)
        if np.hypot(*fixes.value[i, 3:5]) > 1.0:
            course = np.arctan2(fixes.value[i, 3], fixes.value[i, 4])
        np.testing.assert_array_equal(held[k:last, :6], np.tile(fixes.value[i], (last - k, 1)))
        assert (held[k:last, AZIMUTH] == course).all()
    assert tuple(score_held(samples)) == COLUMNS


# Failure.


def test_a_covariance_that_is_lost_is_a_failed_run_with_its_epoch(prepared):
    samples = prepared("t1", 100)
    made = design("ukf", OPTIONS, Variances(datasheet("ukf").process, np.zeros(STATES)))
    row = score(made, samples, controls(samples, made.tilt))
    assert tuple(row) == COLUMNS and row["failed"] and row["reason"] == "no Cholesky factor or not finite at epoch 0"
    assert all(np.isnan(row[name]) for name in (*MEASURES, "nis", "nees_position", "nees_azimuth"))


@pytest.mark.parametrize(("north", "east", "failed"), [(0.9, 0.0, False), (1.01, 0.0, True), (0.8, 0.8, True), (np.nan, 0.0, True)])
def test_a_run_has_failed_beyond_a_horizontal_distance(prepared, fly, north, east, failed):
    record = fly("ekf-f", prepared("t2", 100)).record
    posterior = record.posterior.copy()
    posterior[0, 500, :2] = truth("t2")[500, :2] + BOUND * np.array([north, east])
    assert bool(runs.failure(record._replace(posterior=posterior), "t2")) == failed


def test_a_filter_that_leaves_the_earth_is_measured_without_a_warning():
    estimate = truth("t2").copy()
    estimate[1000:] = 1e200
    assert measure(estimate, "t2")["horizontal"] == np.inf


# Independence.


def test_the_score_of_a_run_depends_on_no_other_run_and_no_other_filter(settings):
    case = headline(1, "t2")
    named = {(name,): design(name, OPTIONS) for name in ("ekf-pi", "ukf")}
    whole = scores(case, range(100, 102), named | {("gated",): design("ekf-pm", OPTIONS, gate="integrity", multiple=1.0)}, ["filter"])
    alone = scores(case, [101], {("ukf",): named[("ukf",)]}, ["filter"])
    found = whole[(whole["run"] == 101) & (whole["filter"] == "ukf")].reset_index(drop=True)
    assert found.equals(alone)
    assert list(whole.columns) == ["filter", *COLUMNS] and len(whole) == 6


def test_filters_of_a_run_read_the_same_samples_and_write_to_none(prepared, fly):
    samples = prepared("t1", 100)
    before = [values.copy() for values in (*samples.sensed, *samples.fixes, samples.x0, samples.measurements)]
    for name in ("ekf-pi", "ukf"):
        fly(name, samples, gate="integrity", multiple=2.0)
        fly(name, samples, gate="nis-recovery")
    for values, kept in zip((*samples.sensed, *samples.fixes, samples.x0, samples.measurements), before, strict=True):
        np.testing.assert_array_equal(values, kept)


def test_a_gate_with_recovery_never_rejects_more_than_eleven_fixes_in_a_row(prepared, fly):
    for name in ("ekf-pi", "ekf-f"):
        plain, patient = (fly(name, prepared("t2", 100), gate=gate) for gate in ("nis", "nis-recovery"))
        assert longest(patient.refused) <= PATIENCE + 1
        assert longest(plain.refused) >= longest(patient.refused)
