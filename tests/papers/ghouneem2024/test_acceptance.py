"""The acceptance checks of the paper's science brief that need the drive, each at its tolerance.

Checks 8 to 13 are here. 1 and 2 are tests of sigma points, 3 of the forms as printed, 4 to 7 of the mechanisation, 14 of the theory.
"""

import numpy as np
import pytest

from robins.evaluate.consistency import normalised_squared
from robins.kalman.filter import run_filter
from robins.kalman.gates import integrity_gate
from robins.kalman.model import propagate
from robins.kalman.weights import weighting
from robins.navigation.fixes import fix_sensor
from robins.navigation.riss import EAST, INPUTS, NORTH, STATES, V_UP
from robins.papers.ghouneem2024.filters import FILTERS, design, model, physical, predictor
from robins.papers.ghouneem2024.gps import REPORTED_SIGMA
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.runs import controls, headline, prepare, score, truth
from robins.papers.ghouneem2024.sensors import Sensed
from robins.papers.ghouneem2024.studies import CAUSES, JUMP_FIX, LONG_OUTAGE, only
from robins.papers.ghouneem2024.trajectories import RATE_HZ, TRAJECTORIES, inertial_rate_up, trajectory

SEED = 1
UNIT = weighting("unit")


def refilter(made, samples, method):
    """A filter over a run with any weighting."""
    return run_filter(
        predictor(made), model(made, samples.case.place), fix_sensor(INPUTS, STATES), method, samples.x0[None],
        np.diag(made.variances.initial), controls(samples, made.tilt), samples.measurements[None], samples.valid, STATES, False,
    )  # fmt: skip


# Perfect samples.


@pytest.fixture(scope="module", params=TRAJECTORIES)
def perfect(request):
    """A run whose sensors and fixes have no error and whose start is known."""
    driven = trajectory(request.param)
    samples = prepare(headline(SEED, request.param), 100)
    epoch = np.arange(RATE_HZ, driven.time.size, RATE_HZ)
    exact = np.column_stack([driven.position, driven.velocity])[epoch]
    fixes = samples.fixes._replace(
        epoch=epoch, value=exact, sigma=np.tile(REPORTED_SIGMA, (epoch.size, 1)), cause=np.zeros(epoch.size, int)
    )
    samples = prepare(samples.case, 100, fixes)
    sensed = Sensed(driven.force, driven.rate, driven.speed, driven.acceleration, np.zeros(driven.time.size))
    return samples._replace(sensed=sensed, x0=np.r_[truth(request.param)[0], 0.0, 0.0])


def test_perfect_sensors_lead_through_the_whole_drive(perfect, fly):
    """But for the gyro's tilt, which (1) leaves out, and for velocities at the end of a step instead of a trapezoid."""
    alone = fly("ekf-f", perfect, updates=False, tilt="corrected")
    driven = trajectory(perfect.case.place)
    np.testing.assert_allclose(alone.record.posterior[0, :, V_UP], driven.velocity[:, 2], rtol=0, atol=1e-3)
    np.testing.assert_allclose(alone.error[:, [NORTH, EAST]], untilted(driven), rtol=0, atol=0.1)


def untilted(driven):
    """Error of north and east when the gyro's rate is taken for the vertical one and added up, in one sum and without a filter."""
    earth = inertial_rate_up(driven.latitude, driven.position[:, 0], driven.velocity[:, 0])
    azimuth = driven.azimuth[0] - np.r_[0.0, np.cumsum((driven.rate - earth)[1:])] / RATE_HZ
    level = driven.speed * np.cos(driven.pitch)
    steps = np.stack([level * np.cos(azimuth), level * np.sin(azimuth)], axis=1) / RATE_HZ
    return np.cumsum(np.vstack([np.zeros((1, 2)), steps[1:]]), axis=0) - driven.position[:, :2]


@pytest.mark.parametrize("name", FILTERS)
def test_perfect_sensors_and_fixes_keep_every_filter_within_a_metre(perfect, fly, name):
    flown = fly(name, perfect, tilt="corrected")
    assert np.hypot(flown.error[:, NORTH], flown.error[:, EAST]).max() < 1.5
    assert flown.horizontal < 0.6


# 8: an honest filter.


def matched(name, runs=200, seconds=600):
    """Runs of a truth that the filter's own model makes on the inputs of T1: final errors (runs, 9) and covariances."""
    rng = np.random.default_rng(8)
    made, samples = design(name, OPTIONS), prepare(headline(SEED, "t1"), 100)
    own, epochs = model(made, "t1"), seconds * RATE_HZ + 1
    u = controls(samples, made.tilt)[:epochs]
    u[:, INPUTS:] = REPORTED_SIGMA
    valid = np.arange(epochs) % RATE_HZ == 0
    mean = np.r_[truth("t1")[0], 0.0, 0.0]
    x = mean + np.sqrt(made.variances.initial) * rng.standard_normal((runs, STATES))
    z = np.zeros((runs, epochs, 6))
    for run in range(runs):
        driving = np.sqrt(own.noise) * rng.standard_normal((epochs, STATES))
        for k in range(epochs):
            z[run, k] = x[run, :6]
            if k + 1 < epochs:
                propagate(own, x[run], u[k])
                x[run] += driving[k]
    z += REPORTED_SIGMA * rng.standard_normal(z.shape)
    record = run_filter(
        predictor(made), own, fix_sensor(INPUTS, STATES), UNIT, np.tile(mean, (runs, 1)), np.diag(made.variances.initial), u, z, valid,
        STATES, False, (epochs - 1,),
    )  # fmt: skip
    assert (record.failed == -1).all()
    return record.posterior[:, -1] - x, record.covariance[:, 0]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ekf-f", "ukf"])
def test_08_a_filter_whose_model_is_the_truth_is_honest(name):
    """The mean of 200 chi-squares of nine degrees of freedom. Scaled by its deviations, the covariance is well conditioned."""
    error, covariance = matched(name)
    deviation = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    correlation = covariance / (deviation[:, :, None] * deviation[:, None, :])
    assert np.linalg.cond(correlation).max() < 1e6
    nees = normalised_squared(error / deviation, correlation)
    assert 8.41 <= nees.mean() <= 9.59


# 9: the printed weight.


def test_09_the_printed_weight_loses_definiteness_with_a_small_spread_and_not_with_alpha_one(prepared, fly):
    samples = prepared("t1", 100)
    lost = fly("ukf", samples, printed_weights=True, alpha=0.1)
    assert 0 <= lost.record.failed[0] < len(truth("t1")) - 1
    assert np.isnan(lost.record.posterior[0, lost.record.failed[0] + 1 :]).all()
    kept = fly("ukf", samples, printed_weights=True, alpha=1.0)
    assert kept.record.failed[0] == -1 and np.isfinite(kept.record.posterior).all()
    row = score(lost.design, samples, controls(samples, lost.design.tilt))
    assert row["failed"] and row["reason"].endswith(f"at epoch {lost.record.failed[0]}") and np.isnan(row["horizontal"])


# 10: the transform and the Jacobian.


@pytest.mark.parametrize("place", TRAJECTORIES)
def test_10_with_one_model_linearisation_and_sigma_points_differ_by_less_than_five_per_cent(prepared, fly, place):
    """In every channel of every run: with honest variances a step of 50 ms is nearly linear, so there is nothing to explain."""
    for number in range(100, 104):
        rmse = [np.sqrt(np.mean(fly(name, prepared(place, number)).error ** 2, axis=0)) for name in ("ekf-f", "ukf")]
        assert np.abs(rmse[1] / rmse[0] - 1.0).max() < 0.05


# 11, 12: the gate.


def test_11_one_jump_of_200_metres_costs_two_fixes_at_a_multiple_of_four_and_passes_at_eight(results):
    table = results.table("jump")
    for multiple, refused in ((4.0, True), (8.0, False)):
        part = table[table["multiple"] == multiple]
        assert set(part["filter"]) == set(FILTERS)
        assert (part["rejected_jump"] == refused).all() and (part["rejected_next"] == refused).all()
    assert (table[table["multiple"] <= 4.0]["rejected_jump"]).all()


def test_11_tighter_gates_have_more_false_alarms_in_a_clean_run(results):
    alarms = results.table("jump").groupby(["filter", "multiple"])["false_alarms"].mean().unstack()
    assert (np.diff(alarms[[2.0, 1.0, 0.5]].to_numpy(), axis=1) >= 0).all()
    assert (alarms[0.5] > 0.2 * (trajectory("t1").time[-1] - 2)).all()  # 20 m/s along an axis is a jump
    assert (alarms.loc[["ekf-f", "ukf"], 8.0] == 0).all()


def test_11_a_gate_without_limits_is_the_plain_filter(prepared, fly):
    samples = prepared("t2", 101)
    for name in FILTERS:
        plain = fly(name, samples)
        for limit in (np.inf, 1e12):
            gated = refilter(plain.design, samples, integrity_gate(np.full(6, limit), np.full(6, limit), samples.fixes.value))
            np.testing.assert_allclose(gated.posterior, plain.record.posterior, rtol=0, atol=1e-10)
        wide = fly(name, samples, gate="integrity", multiple=1e12)
        np.testing.assert_array_equal(wide.record.posterior, plain.record.posterior)


GATES = {"integrity": {"gate": "integrity", "multiple": 2.0}, "nis": {"gate": "nis", "variances": physical()}}


@pytest.mark.parametrize("name", GATES)
def test_11_a_misleading_fix_that_the_gate_sees_does_not_reach_the_state(prepared, fly, name):
    """Without a gate it moves the state by some of its size."""
    gate, samples = GATES[name], prepared("t1", 102, 0.0)
    value = samples.fixes.value.copy()
    value[JUMP_FIX, :2] += 150.0
    wrong = prepare(samples.case, 102, samples.fixes._replace(value=value))
    k = samples.fixes.epoch[JUMP_FIX]
    gated, plain = fly("ekf-f", wrong, **gate), fly("ekf-f", wrong, **gate | {"gate": "none"})
    assert gated.refused[JUMP_FIX]
    np.testing.assert_array_equal(gated.record.posterior[0, k], gated.record.prior[0, k])
    assert np.abs(plain.record.posterior[0, k, :2] - plain.record.prior[0, k, :2]).max() > 1.0
    assert np.hypot(*gated.error[k, :2]) < 10.0


def test_12_a_long_outage_has_no_fix_and_both_gates_their_rejections_and_errors(results):
    table = results.table("long-outage")
    for place in TRAJECTORIES:
        part = table[table["trajectory"] == place]
        seconds = int(trajectory(place).time[-1])
        assert (part["fixes"] == seconds - int(LONG_OUTAGE[1])).all()
        assert set(part["multiple"]) == {0.5, np.inf} and not part["failed"].any()
        open_gate = part[np.isinf(part["multiple"])]
        assert (open_gate["rejected"] == 0).all() and (open_gate["longest_rejection"] == 0).all()
        tight = part[part["multiple"] == 0.5]
        assert (tight["longest_rejection"] >= 1).all() and np.isfinite(tight["horizontal"]).all()


# 13: clean satellites.


@pytest.mark.parametrize(("place", "name"), [(p, n) for p in TRAJECTORIES for n in FILTERS if (p, n) != ("t1", "ekf-pm")])
def test_13_with_clean_satellites_a_filter_is_within_ten_metres(prepared, fly, place, name):
    for number in (400, 401):
        flown = fly(name, prepared(place, number, 0.0))
        assert flown.record.failed[0] == -1 and flown.horizontal < 10.0


def test_13_what_leads_the_memoryless_filter_astray_on_t1_is_the_turn_that_the_printed_error_model_leaves_out(prepared, fly):
    """The exception: in some runs up to 20 m with (3) as printed, also with a perfect odometer; the GPS error with the two terms."""
    driven = trajectory("t1")
    for odometer in ({}, {"speed": driven.speed, "acceleration": driven.acceleration}):
        runs = [prepared("t1", number, 0.0) for number in range(400, 408)]
        runs = [samples._replace(sensed=samples.sensed._replace(**odometer)) for samples in runs]
        assert 10.0 < max(fly("ekf-pm", samples).horizontal for samples in runs) < 25.0
        assert max(fly("ekf-pm", samples, turning=True).horizontal for samples in runs) < 5.0


def test_each_cause_alone_is_the_only_one_there_is(prepared):
    for place in TRAJECTORIES:
        whole = headline(SEED, place).environment
        for cause in CAUSES:
            alone = only(whole, cause)
            assert sum(value > 0 for value in (alone.outages, alone.bursts, alone.misleading)) == 1
