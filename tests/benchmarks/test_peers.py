"""What is timed is the same work: states and covariances of ours, of C and of filterpy agree."""

import numpy as np
import pytest

from benchmarks import ours, peers, reference
from benchmarks.models import CHANNELS, drive, unscented_drive
from benchmarks.steps import AGREEMENT, CASES, agreement

pytestmark = pytest.mark.slow
EPOCHS = 400


@pytest.fixture(scope="module", params=CASES)
def recorded(request):
    return CASES[request.param](EPOCHS)


@pytest.fixture(scope="module")
def own(recorded):
    return ours.run_whole(recorded)


def assert_agrees(found, expected):
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)


@pytest.mark.skipif(reference.compiler() is None, reason="no C compiler")
def test_c_computes_our_states_covariances_and_nis(recorded, own):
    in_c = reference.Reference(recorded)
    in_c.run()
    for found, expected in zip((in_c.states, in_c.covariances, in_c.nis), own, strict=True):
        assert_agrees(found, expected)


def test_filterpy_computes_our_states_and_covariances(recorded, own):
    for found, expected in zip(peers.run_filterpy(recorded), own[:2], strict=True):
        assert_agrees(found, expected)


def test_the_timed_filter_is_the_compared_one(recorded, own):
    record = ours.run_ours(recorded, ours.weightings()["unit weights"])
    assert_agrees(record.posterior[0], own[0])
    assert_agrees(record.posterior_variance[0], np.diagonal(own[1], axis1=1, axis2=2))
    assert_agrees(record.nis[0], own[2])
    assert record.failed[0] == -1


def test_the_filter_is_consistent_on_its_own_drive(own):
    """The mean NIS of K epochs is m with variance 2 m / K (independent innovations); five deviations."""
    assert abs(own[2].mean() - CHANNELS) < 5 * np.sqrt(2 * CHANNELS / EPOCHS)


def test_covariance_matching_is_timed_while_it_acts(recorded):
    record = ours.run_ours(recorded, ours.weightings()["covariance matching"])
    assert np.nanmin(record.weights[0]) < 1.0 and np.nanmax(record.weights[0]) == 1.0


def test_a_peer_that_computes_something_else_ends_the_run(recorded, monkeypatch):
    states, covariances = peers.run_filterpy(recorded)
    monkeypatch.setattr(peers, "run_filterpy", lambda _: (states + 2 * AGREEMENT, covariances))
    with pytest.raises(SystemExit, match="filterpy differ from ours by 2.0e-10, expected at most 1e-10"):
        agreement(recorded, None)


def test_without_a_compiler_the_reference_says_so(recorded, monkeypatch):
    monkeypatch.setattr(reference, "compiler", lambda: None)
    with pytest.raises(RuntimeError, match="no C compiler"):
        reference.Reference(recorded)


@pytest.mark.skipif(reference.compiler() is None, reason="no C compiler")
def test_the_unscented_reference_is_another_filter_on_the_same_drive():
    extended, unscented = reference.Reference(drive(EPOCHS)), reference.Reference(unscented_drive(EPOCHS))
    extended.run()
    unscented.run()
    np.testing.assert_array_equal(extended.states[0], unscented.states[0])  # before the first prediction
    assert np.abs(extended.covariances[1:] - unscented.covariances[1:]).max() > 1e4 * AGREEMENT


@pytest.mark.skipif(reference.compiler() is None, reason="no C compiler")
def test_the_unscented_reference_stops_at_a_covariance_without_a_root():
    recorded = unscented_drive(3)
    indefinite = recorded._replace(P0=recorded.P0 - 2.0 * np.diag(np.eye(9)[8] * recorded.P0[8, 8]))
    with pytest.raises(RuntimeError, match="failed at epoch 0"):
        reference.Reference(indefinite).run()
