"""Updates as the paper prints them: letter by letter, with what follows from the letters."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robins.kalman.model import linear_sensor
from robins.kalman.reweighted import process
from robins.kalman.update import workspace
from robins.kalman.weights import weighting
from robins.navigation.strapdown import ACCELEROMETER_BIAS
from robins.papers.imani2026.as_printed import plain_noise, printed_jacobian, process_printed, raw_correntropy, raw_weights, reduce_printed
from robins.papers.imani2026.formulations import FORMULATIONS
from robins.papers.imani2026.methods import Method, increment, nominal
from robins.papers.imani2026.options import OPTIONS
from robins.papers.imani2026.sensors import Sensors
from robins.papers.imani2026.variants import VARIANTS

EKF = Method(weighting("unit"))
AS_PRINTED = nominal(VARIANTS["mk-raw"].composition, OPTIONS, Sensors(), 10)


def updated(method, P, y, H, R):
    """Correction, weights, covariance and NIS of one update as printed."""
    (n, m), P = H.T.shape, P.copy()
    sensor, work, weights = linear_sensor(H, R), workspace(n, m), np.empty(m)
    work.innovation[:], work.H[:] = y, H
    nis = process(method, P, sensor, False, method.memory, 0, weights, np.empty((m, m)), work)
    return work.shift.copy(), weights, P, nis


def letters(P, y, H, R, widths, mixing):
    """(40)-(43) in numpy, with W on the side of K where it fits."""
    S = H @ P @ H.T + R
    K = P @ H.T @ np.linalg.inv(S)
    W = np.diag([np.sum(mixing / s**2 * np.exp(-(e**2) / (2.0 * s**2))) for e, s in zip(y, widths, strict=True)])
    reduced = (np.eye(len(P)) - K @ W @ H) @ P
    return K @ W @ y, np.diag(W), reduced, y @ np.linalg.inv(S) @ y


def covariance(rng, n):
    """A covariance with correlations."""
    root = rng.normal(size=(n, n)) / np.sqrt(n)
    return root @ root.T + 0.5 * np.eye(n)


# The robust factor without its bar.


@pytest.mark.parametrize("name", FORMULATIONS)
def test_without_the_bar_on_r_the_robust_filter_is_the_ekf(journey, name):
    """(36), A2: to the last bit, over a whole drive, although the factors of (35) are found and are not one."""
    trip = journey(2)
    plain, barless = trip.follow(name, EKF), trip.follow(name, Method(plain_noise(increment(OPTIONS))))
    robust = trip.follow(name, Method(increment(OPTIONS)))
    for field in ("posterior", "posterior_variance", "innovation", "nis"):
        np.testing.assert_array_equal(getattr(barless.record, field), getattr(plain.record, field))
    np.testing.assert_array_equal(barless.estimate, plain.estimate)
    assert np.mean(barless.record.weights[:, 1:] < 1.0) > 1e-3
    assert np.abs(robust.estimate - plain.estimate).max() > 1e-3


# Weights that are neither whitened nor normalised.


def test_printed_weights_of_a_zero_innovation_are_far_above_one():
    """(40), A4: ``sum eta_j / sigma_j^2`` for widths in proportion to the residuals' deviation, in SI units."""
    weights = np.empty(6)
    raw_weights(np.zeros(6), AS_PRINTED.weighting.widths, AS_PRINTED.weighting.mixing, weights)
    shares = 0.3 / 1.5**2 + 0.4 / 3.0**2 + 0.3 / 8.0**2
    np.testing.assert_allclose(weights, [shares / 0.05**2] * 3 + [shares / 0.002**2] * 3, rtol=1e-12)
    np.testing.assert_allclose(weights, [73.0] * 3 + [4.56e4] * 3, rtol=1e-3)


@pytest.mark.parametrize("factor", [180.0 / np.pi, 1e-3])
def test_printed_weights_are_not_invariant_whether_widths_have_units_or_not(factor):
    """Proposition 3: with fixed widths another unit gives another weight; with scaled ones it divides it by the square."""
    y, widths, mixing = np.array([0.01, -0.02]), np.outer(np.ones(2), [0.015, 0.03]), np.array([0.5, 0.5])
    first, fixed, scaled = np.empty(2), np.empty(2), np.empty(2)
    raw_weights(y, widths, mixing, first)
    raw_weights(factor * y, widths, mixing, fixed)
    raw_weights(factor * y, factor * widths, mixing, scaled)
    np.testing.assert_allclose(scaled, first / factor**2, rtol=1e-12)
    assert np.all(np.abs(np.log(fixed / first)) > 0.1)


def test_another_unit_changes_the_printed_correction():
    """A11: widths 1, 5 and 10, an innovation of .01 rad/s and a gain of .996: .003177 rad/s, and .002724 through degrees."""
    method, corrections = raw_correntropy(np.array([[1.0, 5.0, 10.0]]), OPTIONS["kernel_weights"]), []
    for unit in (1.0, 180.0 / np.pi):
        shift, *_ = updated(method, 0.996 * unit**2 * np.eye(1), np.array([0.01 * unit]), np.eye(1), 0.004 * unit**2 * np.eye(1))
        corrections.append(shift[0] / unit)
    np.testing.assert_allclose(corrections, [0.003177, 0.002724], rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", FORMULATIONS)
def test_wide_printed_kernels_are_no_update_and_not_the_ekf(journey, name):
    """A3, Proposition 3: their weights vanish instead of tending to one."""
    trip = journey(1)
    wide = trip.follow(name, Method(raw_correntropy(np.full((6, 3), 1e14), OPTIONS["kernel_weights"])))
    none, plain = trip.follow(name, Method(weighting("unit"), updates=False)), trip.follow(name, EKF)
    assert np.abs(wide.record.posterior - none.record.posterior)[..., ACCELEROMETER_BIAS:].max() < 1e-15
    # an update makes the quaternion one long again, if only by its last bit: the rest of the state is the same to rounding
    np.testing.assert_allclose(wide.record.posterior, none.record.posterior, rtol=0, atol=1e-12 * np.abs(none.record.posterior).max())
    assert np.abs(wide.estimate - plain.estimate).max() > 1e-2


@pytest.mark.parametrize(("weight", "diverges"), [(1.9, False), (2.1, True)])
def test_the_error_grows_where_the_weight_times_the_gain_exceeds_two(weight, diverges):
    """Proposition 3, in a scalar problem without noise: an update multiplies the error by ``1 - w kappa``."""
    kappa, error = 1.0 / 1.25, 1e-6
    method = raw_correntropy(np.full((1, 1), np.sqrt(kappa / weight)), np.ones(1))
    for _ in range(50):
        shift, (w,), P, _ = updated(method, np.eye(1), np.array([-error]), np.eye(1), 0.25 * np.eye(1))
        assert P[0, 0] == pytest.approx(1.0 - w * kappa, abs=1e-12) and P[0, 0] < 0.0
        assert (error + shift[0]) / error == pytest.approx(1.0 - w * kappa, rel=1e-9)
        error += shift[0]
    assert (abs(error) > 1e-5) == diverges


@pytest.mark.parametrize("name", FORMULATIONS)
def test_as_printed_every_run_ends_after_its_first_update(journey, name):
    """A4: there the weight times the gain exceeds two in at least five channels of six, and P is no covariance any more."""
    followed = journey(2).follow(name, AS_PRINTED)
    record, R = followed.record, np.diag(followed.form.sensor.R)
    processed = ~np.isnan(record.nis)
    np.testing.assert_array_equal(record.failed, 2)
    assert processed.sum() == 2
    kappa = 1.0 - R / record.innovation_variance[processed]
    assert np.all(np.sum(record.weights[processed] * kappa > 2.0, axis=1) >= 5)
    assert record.posterior_variance[:, 1].min() < 0.0
    assert np.isfinite(record.posterior[:, :2, 3:6]).all() and np.isnan(record.posterior[:, 3:]).all()


# The update.


@pytest.mark.parametrize("seed", range(5))
def test_printed_update_is_the_equations_letter_by_letter(seed):
    """(41), (43): correction, weights and NIS; (42) in its symmetric part."""
    rng = np.random.default_rng(seed)
    n, m = 9, 6
    P, R, H, y = covariance(rng, n), covariance(rng, m), rng.normal(size=(m, n)), rng.normal(size=m)
    widths, mixing = rng.uniform(0.3, 3.0, (m, 3)), np.array([0.2, 0.5, 0.3])
    shift, weights, after, nis = updated(raw_correntropy(widths, mixing), P, y, H, R)
    expected_shift, expected_weights, reduced, expected_nis = letters(P, y, H, R, widths, mixing)
    np.testing.assert_allclose(weights, expected_weights, rtol=1e-12)
    np.testing.assert_allclose(shift, expected_shift, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(after, 0.5 * (reduced + reduced.T), rtol=0, atol=1e-11)
    assert nis == pytest.approx(expected_nis, rel=1e-10)
    assert np.abs(reduced - reduced.T).max() > 1e-3, "as printed it is not even symmetric"


@pytest.mark.parametrize(("weight", "true", "printed"), [(0.25, 0.7083, 0.8333), (1.0, 0.3333, 0.3333), (1.6, 0.5733, -0.0667)])
def test_printed_covariance_is_not_that_of_the_estimate(weight, true, printed):
    """(42), A9, Proposition 4: P = 1, R = .5; the variance of the estimate by formula and by 2e6 draws."""
    method = raw_correntropy(np.full((1, 1), weight**-0.5), np.ones(1))
    _, (found,), P, _ = updated(method, np.eye(1), np.zeros(1), np.eye(1), 0.5 * np.eye(1))
    kappa = 1.0 / 1.5
    assert found == pytest.approx(weight, rel=1e-12)
    assert P[0, 0] == pytest.approx(printed, abs=5e-5)
    assert 1.0 - kappa * weight * (2.0 - weight) == pytest.approx(true, abs=5e-5)
    x, v = np.random.default_rng(9).standard_normal((2, 2_000_000)) * [[1.0], [np.sqrt(0.5)]]
    assert np.var(weight * kappa * (x + v) - x) == pytest.approx(true, abs=1e-3)


def test_printed_covariance_stays_symmetric():
    rng = np.random.default_rng(4)
    root, K, H = rng.normal(size=(5, 5)), rng.normal(size=(5, 2)), rng.normal(size=(2, 5))
    P = root @ root.T
    reduced = P.copy()
    reduce_printed(reduced, K, H)
    expected = (np.eye(5) - K @ H) @ P
    np.testing.assert_allclose(reduced, 0.5 * (expected + expected.T), rtol=0, atol=1e-12)
    np.testing.assert_array_equal(reduced, reduced.T)


@pytest.mark.parametrize("spoilt", ["innovation", "covariance"])
def test_what_cannot_be_updated_is_not_a_number(spoilt):
    P, y = np.eye(2), np.ones(2)
    if spoilt == "innovation":
        y[1] = np.nan
    else:
        P[0, 0] = -5.0
    assert np.isnan(updated(raw_correntropy(np.ones((2, 1)), np.ones(1)), P, y, np.eye(2), np.eye(2))[3])


def test_both_forms_are_one_compiled_update():
    assert isinstance(AS_PRINTED.weighting, type(plain_noise(increment(OPTIONS))))
    assert process_printed.py_func.__name__ == "process_printed"


# The Jacobian.


@pytest.mark.parametrize("seed", range(5))
def test_the_printed_jacobian_is_that_of_the_printed_rates(seed):
    """(21) by central differences of r' = v, v' = C (f - b_a) - 2 C0 ((omega - b_g) x v), q' = q (omega - b_g) / 2; C0 does not move."""
    rng = np.random.default_rng(seed)
    x, force, rate = rng.normal(size=16), rng.normal(size=3), rng.normal(size=3)
    x[6:10] /= np.linalg.norm(x[6:10])
    x[13:] = 0.0  # the printed Coriolis term takes the measured rate
    C0 = Rotation.from_quat(x[6:10], scalar_first=True).as_matrix()

    def rates(y):
        q = y[6:10]
        C = Rotation.from_quat(q, scalar_first=True).as_matrix() * (q @ q)  # homogeneous in the four numbers
        omega = rate - y[13:16]
        turned = 0.5 * np.array([-q[1:] @ omega, *(q[0] * omega + np.cross(q[1:], omega))])
        return np.concatenate([y[3:6], C @ (force - y[10:13]) - 2.0 * C0 @ np.cross(omega, y[3:6]), turned, np.zeros(6)])

    found = np.array([(rates(x + 1e-6 * axis) - rates(x - 1e-6 * axis)) / 2e-6 for axis in np.eye(16)]).T
    np.testing.assert_allclose(printed_jacobian(x, force, rate), found, rtol=0, atol=1e-8)
