"""The registry of weights, the oracle, and weights that come from elsewhere and later."""

import numpy as np
import pytest
from numba import njit

from robins.kalman import weights as registry_of_weights
from robins.kalman.extension import entry_point
from robins.kalman.filter import run_filter
from robins.kalman.predict import Ekf
from robins.kalman.weights import Weighting, close_list, known, names, unit, weigh, weight, weighting


@entry_point
def weigh_once(weighting, innovation, R, memory, epoch, weights):
    """What a filter does with a weighting, and nothing else."""
    weigh(weighting, weighting.parameters, innovation, R, R, memory, epoch, weights)


def weights_of(method, innovation=(1.0, 4.0), epoch=0):
    out = np.ones(2)
    weigh_once(method, np.array(innovation), np.eye(2), method.memory.copy(), epoch, out)
    return out


def test_the_weights_of_the_package_are_named_in_alphabetical_order():
    assert set(names()) >= {"unit", "known", "covariance-matching"}
    assert names() == sorted(names())


def test_a_name_that_is_taken_is_refused():
    with pytest.raises(ValueError, match="'known' is registered already"):
        weight("known")(known)
    assert names().count("known") == 1


def test_an_unknown_name_is_answered_with_those_there_are():
    with pytest.raises(ValueError, match="no weight is called 'knwon'; there are .*known.*unit"):
        weighting("knwon")


def test_a_weighting_holds_flag_constants_and_memory():
    method = weighting("known", (1, 2), [[3, 4]])
    assert type(method) is Weighting
    assert method.parameters.dtype == method.memory.dtype == float
    assert weighting("unit").kind == 0 and weighting("unit").memory.shape == (1, 1)


def test_unit_weights_are_ones():
    np.testing.assert_array_equal(weights_of(weighting("unit")), 1.0)
    assert unit.py_func(None, None, None, None, None, 0, None) is None


def test_known_weights_are_the_row_of_the_update():
    method = weighting("known", memory=[[0.1, 0.2], [0.3, 0.4]])
    np.testing.assert_array_equal(weights_of(method), [0.1, 0.2])
    np.testing.assert_array_equal(weights_of(method, epoch=1), [0.3, 0.4])


def test_known_weights_of_one_give_the_plain_filter(problem):
    case = problem(1)
    told, plain = (
        run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)
        for method in (weighting("known", memory=np.ones((30, 3))), weighting("unit"))
    )
    np.testing.assert_array_equal(told.posterior, plain.posterior)


@pytest.fixture(scope="module")
def huber(registry):
    """A weight that is registered here, after filters may have been compiled: Huber's, with parameters[0] as threshold."""
    weights_of(weighting("unit"))

    @weight("test-huber")
    @njit
    def kernel(innovation, predicted, R, parameters, memory, epoch, weights):
        for i in range(innovation.size):
            standardised = abs(innovation[i]) / np.sqrt(predicted[i, i] + R[i, i])
            weights[i] = min(1.0, parameters[0] / standardised) if standardised > 0.0 else 1.0

    @weight("test-half")
    @njit
    def half(innovation, predicted, R, parameters, memory, epoch, weights):
        weights[:] = 0.5

    return lambda threshold: weighting("test-huber", (threshold,))


def test_a_weight_that_is_registered_late_is_used_and_disturbs_no_other(huber):
    expected = np.minimum(1.0, 2.0 / (np.array([1.0, 4.0]) / np.sqrt(2)))
    np.testing.assert_allclose(weights_of(huber(2.0)), expected, rtol=1e-14)
    np.testing.assert_array_equal(weights_of(weighting("test-half")), 0.5)
    np.testing.assert_array_equal(weights_of(weighting("unit")), 1.0)
    np.testing.assert_array_equal(weights_of(weighting("known", memory=[[0.1, 0.2]])), [0.1, 0.2])
    assert {"test-huber", "test-half"} < set(names())


def test_a_late_weight_is_the_same_outside_compiled_code(huber):
    out = np.ones(2)
    method = huber(2.0)
    weigh(method, method.parameters, np.array([1.0, 4.0]), np.eye(2), np.eye(2), method.memory, 0, out)
    np.testing.assert_array_equal(out, weights_of(method))
    weigh(weighting("unit"), np.ones(0), np.ones(2), np.eye(2), np.eye(2), method.memory, 0, np.ones(2))


def test_a_late_weight_makes_a_filter_and_its_infinite_threshold_the_plain_one(huber, problem):
    case = problem(2)
    plain = run_filter(Ekf(), case.model, case.sensor, weighting("unit"), *case.arguments, 4, False)
    limit, robust = (run_filter(Ekf(), case.model, case.sensor, huber(c), *case.arguments, 4, False) for c in (np.inf, 1.0))
    np.testing.assert_allclose(limit.posterior, plain.posterior, rtol=0, atol=1e-10)
    assert np.abs(robust.posterior - plain.posterior).max() > 0.01
    standardised = np.abs(robust.innovation[:, 0]) / np.sqrt(np.diag(case.sensor.H @ case.P0 @ case.sensor.H.T + case.sensor.R))
    np.testing.assert_allclose(robust.weights[:, 0], np.minimum(1.0, 1.0 / standardised), rtol=1e-12)


def test_the_flags_are_closed_once_the_floor_is_imported(huber):
    assert registry_of_weights._closed
    assert "test-huber" not in registry_of_weights._flags
    close_list()  # once more changes nothing
    assert sorted(registry_of_weights._flags.values()) == list(range(len(registry_of_weights._kernels)))
