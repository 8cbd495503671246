"""From a row of the registry to a filter: every row, every family at every value that its tuning can try."""

import numpy as np
import pytest

from robins.kalman.weights import Weighting, weigh, weighting
from robins.papers.imani2026.as_printed import Printed
from robins.papers.imani2026.methods import (
    CHEN,
    FAMILIES,
    LI,
    NORMAL_GATE,
    SWEPT,
    Method,
    Setting,
    fixed_point,
    increment,
    kernels,
    multi_kernel,
    nominal,
    raw_widths,
    tuned,
)
from robins.papers.imani2026.options import OPTIONS
from robins.papers.imani2026.sensors import Sensors
from robins.papers.imani2026.variants import VARIANTS

NOMINAL = [name for name, variant in VARIANTS.items() if "method" in variant.composition]
FAMILY_VALUES = [(name, value) for name, family in FAMILIES.items() for value in family.values]


def made(name):
    return nominal(VARIANTS[name].composition, OPTIONS, Sensors(), 10)


def weights_of(method, innovation, noise=1.0, predicted=1.0):
    """Weights of six independent channels, in the first update of a run."""
    y, out = np.broadcast_to(np.asarray(innovation, float), 6).copy(), np.ones(6)
    weigh(method, method.parameters, y, predicted * np.eye(6), noise * np.eye(6), method.memory.copy(), 0, out)
    return out


def same(a, b):
    """Whether two methods are the same filter."""
    flat = [[np.asarray(part) for part in (*m.weighting[:-1], *m.weighting[-1], *m[1:])] for m in (a, b)]
    return all(np.array_equal(x, y) for x, y in zip(*flat, strict=True))


# Rows.


@pytest.mark.parametrize("name", NOMINAL)
def test_every_row_that_is_not_tuned_is_a_filter(name):
    method = made(name)
    assert isinstance(method.weighting, Printed if VARIANTS[name].family == "as-printed" else Weighting)
    assert method.updates == (name != "no-update")
    assert method.noise_scale == {"ekf-r4": 1e4, "ekf-r8": 1e8}.get(name, 1.0) and method.process_scale == 1.0


def test_every_tuned_row_names_a_family_and_every_swept_family_has_a_row():
    tuned_rows = {name: variant.composition["tuned"] for name, variant in VARIANTS.items() if "tuned" in variant.composition}
    assert set(tuned_rows.values()) == set(FAMILIES)
    for family in SWEPT:
        assert tuned_rows["ekf-tuned" if family == "ekf" else family] == family


def test_no_two_rows_that_are_not_tuned_are_the_same_filter():
    methods = [made(name) for name in NOMINAL if VARIANTS[name].family != "as-printed"]
    for i, first in enumerate(methods):
        assert not any(same(first, second) for second in methods[i + 1 :]), NOMINAL[i]


def test_a_method_that_nobody_knows_is_named():
    with pytest.raises(ValueError, match=r"^no method is called 'magic'$"):
        nominal({"method": "magic"}, OPTIONS, Sensors(), 10)


def test_options_reach_the_weights():
    """Thresholds and kernels by their definitions: S = 2 in every channel, so an innovation of e sd is e sqrt(2)."""
    options = OPTIONS | {"huber_threshold": 2.0, "kernel_widths": [2.0, 4.0], "kernel_weights": [0.5, 0.5], "chi_square_probability": 0.9}
    e = np.array([0.0, 0.5, 1.0, 2.5, 4.0, 8.0])
    built = {name: nominal(VARIANTS[name].composition, options, Sensors(), 10) for name in NOMINAL}
    weights = {name: weights_of(m.weighting, e * np.sqrt(2.0)) for name, m in built.items() if isinstance(m.weighting, Weighting)}
    np.testing.assert_allclose(weights["huber-nominal"], np.minimum(1.0, 2.0 / np.maximum(e, 1e-9)), rtol=1e-12)
    mixture = (np.exp(-(e**2) / 8.0) / 4.0 + np.exp(-(e**2) / 32.0) / 16.0) / (1.0 / 4.0 + 1.0 / 16.0)
    for name in ("mk-norm-nominal", "mk-norm-gain-nominal"):
        np.testing.assert_allclose(weights[name], mixture, rtol=1e-12)
    ratio = e**2 / 2.705543
    linear = np.maximum(1.0, ratio)
    for name in ("ci-seq-nominal", "ci-marg"):
        np.testing.assert_allclose(weights[name], 1.0 / linear, rtol=1e-6)
    np.testing.assert_allclose(weights["ci-corr-nominal"], 1.0 / (1.0 + (linear - 1.0) * 2.0), rtol=1e-6)
    np.testing.assert_allclose(weights["ci-sqrt"], 1.0 / np.where(ratio > 3.0, ratio, np.sqrt(linear)), rtol=1e-6)
    np.testing.assert_allclose(weights["ci-reject"], np.where(ratio > 3.0, 0.0, 1.0 / linear), rtol=1e-6)
    np.testing.assert_array_equal(weights["ci-temp"], 1.0)  # nothing came before
    np.testing.assert_array_equal(weights["gate-nominal"], e <= 1.959963984540054)


def test_weights_on_the_gain_differ_from_weights_on_the_noise_by_that_only():
    on_noise, on_gain = made("mk-norm-nominal").weighting, made("mk-norm-gain-nominal").weighting
    assert not on_noise.on_gain and on_gain.on_gain
    np.testing.assert_array_equal(on_noise.parameters, on_gain.parameters)


@pytest.mark.parametrize(("rate_hz", "growth"), [(10, 1.0), (100, np.sqrt(10.0))])
def test_raw_widths_are_in_proportion_to_the_residuals_deviation(rate_hz, growth):
    sd = growth * np.array([0.05] * 3 + [0.002] * 3)
    np.testing.assert_allclose(raw_widths(OPTIONS, Sensors(equal_psd=True), rate_hz), np.outer(sd, [1.5, 3.0, 8.0]), rtol=1e-12)


# Families.


def test_every_grid_is_conventional_in_its_middle():
    """There a family with a nominal row is that row; the multiplier of R and the budget are the same for all."""
    assert NORMAL_GATE**2 == pytest.approx(3.841458820694124, rel=1e-12)
    rows = {"ekf": "ekf", "ci-seq": "ci-seq-nominal", "ci-corr": "ci-corr-nominal", "mk-norm": "mk-norm-nominal",
            "mk-norm-gain": "mk-norm-gain-nominal", "huber": "huber-nominal"}  # fmt: skip
    for family, row in rows.items():
        assert same(tuned(family, OPTIONS, Setting(1.0, FAMILIES[family].grid[1])), made(row))
    assert same(tuned("gate", OPTIONS, Setting(1.0, NORMAL_GATE)), made("gate-nominal"))


@pytest.mark.parametrize("family", FAMILIES)
def test_a_grid_ascends_and_its_extensions_lie_outside(family):
    knob = FAMILIES[family]
    values = knob.values
    assert list(values) == sorted(set(values))


@pytest.mark.parametrize(("family", "value"), FAMILY_VALUES)
def test_every_value_that_tuning_can_try_makes_a_filter_that_trusts_small_innovations_more(family, value):
    method = tuned(family, OPTIONS, Setting(7.0, value))
    assert method.noise_scale == 7.0 and method.updates
    assert method.process_scale == (value if family == "ekf" else 1.0)
    small, large = weights_of(method.weighting, 0.01)[0], weights_of(method.weighting, 50.0)[0]
    assert small == pytest.approx(1.0, abs=1e-3)
    assert large == 1.0 if family == "ekf" else 0.0 <= large < 0.2


@pytest.mark.parametrize("family", [name for name in FAMILIES if name != "ekf"])
def test_a_larger_value_of_the_knob_trusts_more(family):
    knob = FAMILIES[family]
    trusted = [weights_of(tuned(family, OPTIONS, Setting(1.0, v)).weighting, 4.0)[0] for v in knob.values]
    assert trusted == sorted(trusted) and trusted[0] < trusted[-1]


def test_the_multiplier_of_the_widths_multiplies_all_of_them():
    widths, mixing = kernels(OPTIONS, 0.5)
    np.testing.assert_allclose(widths, [0.75, 1.5, 4.0])
    np.testing.assert_allclose(mixing, [0.3, 0.4, 0.3])
    e = np.array([0.0, 0.3, 1.0, 2.0, 3.0, 4.0])
    halved, whole = weights_of(multi_kernel(OPTIONS, 0.5), e), weights_of(multi_kernel(OPTIONS, 1.0), 2.0 * e)
    np.testing.assert_allclose(halved, whole, rtol=1e-12)
    np.testing.assert_array_equal(weights_of(multi_kernel(OPTIONS, np.inf), e), 1.0)


def test_the_two_fixed_points_differ_in_the_prior_and_in_where_they_stop():
    li, chen = fixed_point(3.0, LI), fixed_point(3.0, CHEN, prior=True)
    np.testing.assert_array_equal(li.parameters, chen.parameters)
    assert li.iteration.prior.size == 0
    np.testing.assert_array_equal(chen.iteration.prior, chen.parameters)
    assert (li.iteration.limit, li.iteration.tolerance, li.iteration.floor, li.iteration.warm) == (3, 1e-5, 1e-4, False)
    assert (chen.iteration.limit, chen.iteration.tolerance, chen.iteration.floor, chen.iteration.warm) == (3, 1e-6, 1e-8, False)


def test_thresholds_given_take_the_place_of_the_configured_ones():
    np.testing.assert_array_equal(increment(OPTIONS).parameters, increment(OPTIONS, probability=0.95, lower=1.0, upper=3.0).parameters)
    given = increment(OPTIONS, probability=0.99, lower=2.0, upper=6.0).parameters
    assert tuple(given[2:5]) == pytest.approx((6.634896601, 2.0, 6.0), rel=1e-9)


def test_a_method_updates_with_plain_r_and_q_unless_told_otherwise():
    assert Method(weighting("unit"))[1:] == (1.0, 1.0, True)
