"""The hard gates: of a channel, of the whole measurement by its NIS, and of fixes by their jumps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robins.kalman.filter import run_filter
from robins.kalman.gates import close_gate, close_integrity_gate, close_nis_gate, gate, integrity_gate, nis_gate
from robins.kalman.predict import Ekf
from robins.kalman.update import update, workspace
from robins.kalman.weights import weighting


def weights_of(threshold, innovation, predicted, R):
    method, weights = gate(threshold), np.ones(len(innovation))
    close_gate(innovation, predicted, R, method.parameters, method.memory, 0, weights)
    return weights


def test_a_channel_is_left_out_beyond_the_threshold_and_whole_up_to_it():
    predicted, R = np.diag([3.0, 3.0, 0.0, 15.0]), np.diag([1.0, 1.0, 1.0, 1.0])
    innovation = np.array([6.0, -6.001, 3.001, 11.999])  # standard deviations 2, 2, 1, 4
    np.testing.assert_array_equal(weights_of(3.0, innovation, predicted, R), [1.0, 0.0, 0.0, 1.0])


@given(st.integers(0, 2**32 - 1), st.floats(0.1, 4.0))
def test_units_signs_and_the_order_of_channels_do_not_matter(random_covariance, seed, threshold):
    rng = np.random.default_rng(seed)
    innovation, predicted, R = 3.0 * rng.normal(size=4), random_covariance(rng, 4), random_covariance(rng, 4)
    expected = weights_of(threshold, innovation, predicted, R)
    D = np.diag(rng.choice([-1.0, 1.0], 4) * 2.0 ** rng.integers(-9, 9, 4))  # powers of two: no rounding
    np.testing.assert_array_equal(weights_of(threshold, D @ innovation, D @ predicted @ D, D @ R @ D), expected)
    order = rng.permutation(4)
    turned = np.ix_(order, order)
    np.testing.assert_array_equal(weights_of(threshold, innovation[order], predicted[turned], R[turned]), expected[order])


def test_an_outlier_beyond_the_gate_moves_nothing():
    """Influence: proportional to the innovation, then zero (imani2026, the control of every robust filter)."""
    for size, moved in ((2.0, True), (4.0, False)):
        x, P, innovation, weights = np.zeros(1), np.array([[1e-4]]), np.array([size]), np.ones(1)
        weights = weights_of(3.0, innovation, P, np.eye(1))
        update(x, P, innovation, np.eye(1), np.eye(1), np.zeros((1, 1)), np.zeros((1, 1)), False, weights, workspace(1, 1))
        assert x[0] == pytest.approx(size * 1e-4 / 1.0001 if moved else 0.0, abs=1e-18)


def one_run(case):
    """The first run of a problem alone, and the measurements that its filter processes."""
    case = case._replace(x0=case.x0[:1], measurements=case.measurements[:1])
    return case, case.measurements[0, case.valid]


@pytest.mark.parametrize("limit", [1e15, np.inf])
@pytest.mark.parametrize("kind", ["channel", "nis", "patient nis", "integrity"])
def test_a_gate_that_never_closes_is_the_plain_filter_to_the_last_bit(problem, kind, limit):
    case, fixes = one_run(problem(3))
    closing = {
        "channel": gate,
        "nis": nis_gate,
        "patient nis": lambda c: nis_gate(c, 2),
        "integrity": lambda c: integrity_gate(np.full(3, c), np.full(3, c), fixes),
    }[kind]
    plain, limited, active = (
        run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)
        for method in (weighting("unit"), closing(limit), closing(1.0))
    )
    np.testing.assert_array_equal(limited.posterior, plain.posterior)
    np.testing.assert_array_equal(limited.posterior_variance, plain.posterior_variance)
    assert np.abs(active.posterior - plain.posterior).max() > 0.01


def test_a_gate_of_zero_width_closes_every_channel(problem):
    case = problem(3)
    shut = run_filter(Ekf(), case.model, case.sensor, gate(1e-300), *case.arguments, 4, False)
    np.testing.assert_array_equal(shut.posterior, shut.prior)
    assert np.nanmax(shut.nis) == 0.0 and np.all(shut.failed == -1)


@pytest.mark.parametrize("threshold", [0.0, -1.0, np.nan])
def test_a_threshold_that_is_not_positive_is_refused(threshold):
    with pytest.raises(ValueError, match=r"^threshold: .* is not positive$"):
        gate(threshold)


# The whole measurement by its NIS.


def nis_weights(threshold, patience, innovations, predicted, R):
    """The weights of one update after the other, (updates, m)."""
    method, rows = nis_gate(threshold, patience), []
    memory = method.memory.copy()
    for epoch, innovation in enumerate(innovations):
        weights = np.ones(len(R))
        close_nis_gate(innovation, predicted, R, method.parameters, memory, epoch, weights)
        rows.append(weights)
    return np.array(rows)


@given(st.integers(0, 2**32 - 1))
def test_a_measurement_is_left_out_as_a_whole_where_its_nis_exceeds_the_threshold(random_covariance, seed):
    rng = np.random.default_rng(seed)
    predicted, R, innovation = random_covariance(rng, 4), random_covariance(rng, 4), rng.normal(size=4)
    nis = innovation @ np.linalg.solve(predicted + R, innovation)
    np.testing.assert_array_equal(nis_weights(nis * 1.001, None, [innovation], predicted, R), np.ones((1, 4)))
    np.testing.assert_array_equal(nis_weights(nis * 0.999, None, [innovation], predicted, R), np.zeros((1, 4)))


def test_without_patience_a_filter_may_be_shut_out_for_good():
    assert not nis_weights(9.0, None, np.full((500, 1), 4.0), np.zeros((1, 1)), np.eye(1)).any()


@pytest.mark.parametrize("patience", [0, 3, 10])
def test_after_more_rejections_than_its_patience_a_gate_accepts_once_with_the_noise_that_makes_the_nis_usual(patience):
    """NIS 40 with two channels: the noise is 20 times as large. Then the count begins again."""
    innovations = np.full((3 * (patience + 2), 2), np.sqrt(20.0))
    weights = nis_weights(9.0, patience, innovations, np.zeros((2, 2)), np.eye(2))
    cycle = np.zeros((patience + 2, 2))
    cycle[-1] = 1.0 / 20.0
    np.testing.assert_allclose(weights, np.tile(cycle, (3, 1)), rtol=1e-14)


def test_a_gate_that_gives_in_never_trusts_a_measurement_more_than_its_noise_says():
    """A threshold below the number of channels: NIS 2 of four channels would ask for half the noise."""
    weights = nis_weights(1.0, 0, np.full((2, 4), np.sqrt(0.5)), np.zeros((4, 4)), np.eye(4))
    np.testing.assert_array_equal(weights, [[0.0] * 4, [1.0] * 4])


def test_an_accepted_measurement_ends_the_count_of_rejections():
    sizes = [4.0, 4.0, 1.0, 4.0, 4.0, 4.0, 4.0]
    weights = nis_weights(9.0, 2, np.array(sizes)[:, None], np.zeros((1, 1)), np.eye(1))
    np.testing.assert_allclose(weights[:, 0], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 / 16.0], rtol=1e-14)


def test_every_run_counts_its_own_rejections(problem):
    case = problem(3)
    method = nis_gate(3.0, 2)
    both = run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)
    second = case._replace(x0=case.x0[1:], measurements=case.measurements[1:])
    alone = run_filter(Ekf(), case.model, case.sensor, method, *second.arguments, 4, False)
    np.testing.assert_array_equal(both.weights[1], alone.weights[0])
    assert set(np.unique(both.weights[:, case.valid] > 0.0)) == {False, True} and not method.memory.any()


def test_a_covariance_that_is_not_positive_definite_is_left_to_the_update_to_refuse():
    np.testing.assert_array_equal(nis_weights(1.0, None, [np.full(2, 9.0)], -2.0 * np.eye(2), np.eye(2)), np.ones((1, 2)))


# Fixes by their innovation and by their jump, ghouneem2024 (24).


def integrity_weights(gate_of_fixes, innovations):
    rows = []
    for epoch, innovation in enumerate(innovations):
        weights = np.ones(innovation.size)
        close_integrity_gate(innovation, np.eye(2), np.eye(2), gate_of_fixes.parameters, gate_of_fixes.memory, epoch, weights)
        rows.append(weights)
    return np.array(rows)


def test_one_false_fix_is_rejected_and_the_good_one_after_it_too():
    """The jump out and the jump back; what was received last counts although it was rejected (acceptance check 11)."""
    fixes = np.tile([10.0, 20.0], (6, 1))
    fixes[3, 0] += 200.0
    for limit, rejected in ((160.0, [3, 4]), (320.0, [])):
        weights = integrity_weights(integrity_gate((np.inf, np.inf), (limit, limit), fixes), np.zeros((6, 2)))
        assert np.flatnonzero(weights.sum(axis=1) == 0.0).tolist() == rejected
        assert np.all((weights == 1.0) | (weights == 0.0)) and np.all(weights[:, 0] == weights[:, 1])


def test_the_first_fix_has_no_jump_however_far_it_lies():
    weights = integrity_weights(integrity_gate((np.inf, np.inf), (1.0, 1.0), np.full((2, 2), 1e6)), np.zeros((2, 2)))
    np.testing.assert_array_equal(weights, np.ones((2, 2)))


def test_one_channel_whose_innovation_or_jump_is_beyond_its_own_limit_rejects_the_whole_fix():
    fixes = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 6.0], [3.0, 2.0]])
    innovations = np.array([[1.0, -4.0], [0.0, 0.0], [0.0, 0.0], [-2.5, 0.0]])
    weights = integrity_weights(integrity_gate((2.0, 4.0), (3.0, 5.0), fixes), innovations)  # at a limit is not beyond it
    np.testing.assert_array_equal(weights[:, 0], [1.0, 1.0, 0.0, 0.0])


def test_a_rejected_fix_moves_nothing_in_a_filter(problem):
    case, fixes = one_run(problem(3))
    record = run_filter(Ekf(), case.model, case.sensor, integrity_gate(np.full(3, 9.0), np.full(3, 8.0), fixes), *case.arguments, 4, False)
    rejected = record.weights[0, :, 0] == 0.0
    innovation, jump = np.abs(record.innovation[0, case.valid]), np.abs(np.diff(fixes, axis=0, prepend=fixes[:1]))
    np.testing.assert_array_equal(rejected[case.valid], np.any(innovation > 9.0, axis=1) | np.any(jump > 8.0, axis=1))
    assert 0 < rejected.sum() < case.valid.sum()
    np.testing.assert_array_equal(record.posterior[0, rejected], record.prior[0, rejected])


def test_a_gate_made_for_other_measurements_is_refused(problem):
    case, fixes = one_run(problem(3))
    for method in (integrity_gate(np.ones(3), np.ones(3), fixes[:-1]), integrity_gate(np.ones(2), np.ones(2), fixes[:, :2])):
        with pytest.raises(ValueError, match="^measurements: the filter's updates are not those"):
            run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan])
def test_limits_that_are_not_positive_are_refused(value):
    with pytest.raises(ValueError, match="^threshold: .* is not positive$"):
        nis_gate(value)
    for name in ("prediction_limits", "jump_limits"):
        limits = {"prediction_limits": [1.0, 1.0], "jump_limits": [1.0, 1.0]} | {name: [1.0, value]}
        with pytest.raises(ValueError, match=f"^{name}: .* are not all positive$"):
            integrity_gate(**limits, measurements=np.zeros((3, 2)))


def test_a_negative_patience_is_refused():
    with pytest.raises(ValueError, match="^patience: -1 is negative$"):
        nis_gate(1.0, -1)


@pytest.mark.parametrize("shape", [(3,), (3, 3), (1, 3, 2)])
def test_limits_of_other_channels_than_the_measurements_are_refused(shape):
    with pytest.raises(ValueError, match=r"^prediction_limits: shape \(2,\) for measurements of shape"):
        integrity_gate([1.0, 1.0], [1.0, 1.0], np.zeros(shape))
