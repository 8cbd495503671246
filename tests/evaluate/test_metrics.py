"""Error measures: hand numbers and identities."""

import numpy as np
import pytest

from robins.evaluate.metrics import ensemble_quantiles, ensemble_rms, window_rms
from robins.foundation.randomness import standard_normals

ERRORS = standard_normals(0, [f"test/metrics/{run}/errors" for run in range(5)], (20, 3))


def test_root_mean_square_of_three_and_four():
    errors = np.array([[9.0], [3.0], [4.0], [9.0]])
    assert window_rms(errors, 1, 2, divisor=2)[0] == pytest.approx(np.sqrt(12.5))


def test_both_ends_of_the_window_count():
    errors = np.zeros((10, 1))
    errors[[3, 7]] = 1.0
    assert window_rms(errors, 3, 7, 1.0)[0] == pytest.approx(np.sqrt(2))
    assert window_rms(errors, 4, 6, 1.0)[0] == 0.0


def test_seventy_one_terms_over_seventy_are_larger_by_the_root_of_their_ratio():
    errors = np.ones((201, 1))
    assert window_rms(errors, 80, 150, 70)[0] == pytest.approx(np.sqrt(71 / 70))


def test_an_ensemble_is_its_runs_one_by_one():
    together = window_rms(ERRORS, 2, 11, 10)
    assert together.shape == (5, 3)
    for run, errors in enumerate(ERRORS):
        for channel in range(3):
            expected = np.linalg.norm(errors[2:12, channel]) / np.sqrt(10)
            assert together[run, channel] == pytest.approx(expected, rel=1e-14)


def test_a_diverged_run_is_not_finite_and_spoils_no_other():
    errors = ERRORS.copy()
    errors[1, 5], errors[2, 5] = np.nan, 1e200
    together = window_rms(errors, 0, 19, 20)
    assert np.isnan(together[1]).all() and np.isinf(together[2]).all()
    assert np.isfinite(together[[0, 3, 4]]).all()


@pytest.mark.parametrize("first, last", [(-1, 3), (4, 3), (0, 20)])
def test_a_window_outside_the_record_is_refused(first, last):
    with pytest.raises(ValueError, match="leaves a record of 20 epochs"):
        window_rms(ERRORS, first, last, 1)


def test_a_divisor_that_is_not_positive_is_refused():
    with pytest.raises(ValueError, match="not positive"):
        window_rms(ERRORS, 0, 1, 0)


def test_mean_square_is_bias_squared_plus_variance():
    expected = ERRORS.mean(axis=0) ** 2 + ERRORS.var(axis=0)
    np.testing.assert_allclose(ensemble_rms(ERRORS) ** 2, expected, rtol=1e-13)


def test_only_survivors_count():
    errors = ERRORS.copy()
    errors[3] = np.nan
    survived = np.array([True, True, True, False, True])
    np.testing.assert_array_equal(ensemble_rms(errors, survived), ensemble_rms(ERRORS[survived]))
    np.testing.assert_allclose(ensemble_quantiles(errors, [0.5], survived)[0], np.median(ERRORS[survived], axis=0), rtol=1e-10)


def test_an_ensemble_without_survivors_is_refused():
    with pytest.raises(ValueError, match="no run survives"):
        ensemble_rms(ERRORS, np.zeros(5, dtype=bool))


def test_quantiles_of_five_runs_are_the_sorted_runs():
    np.testing.assert_allclose(ensemble_quantiles(ERRORS, [0, 0.25, 0.5, 0.75, 1]), np.sort(ERRORS, axis=0), rtol=1e-14)
