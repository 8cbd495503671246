"""Proposition 6: the influence of an innovation, from the filters' own weight functions, is what analysis says."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from scipy.stats import chi2

from robins.kalman.m_estimators import correntropy
from robins.papers.imani2026 import palette
from robins.papers.imani2026.influence import INNOVATIONS, RATIOS, REACH, curves, draw_influence, influence
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Results, Settings
from robins.publish import style

OPTIONS = {"kernel_widths": [1.5, 3.0, 8.0], "kernel_weights": [0.3, 0.4, 0.3], "chi_square_probability": 0.95,
           "chi_square_lower": 1.0, "chi_square_upper": 3.0, "huber_threshold": 1.345}  # fmt: skip
CURVES = {curve.label: curve for column in curves(OPTIONS).values() for curve in column}
NOISE_ONLY = 1e-12  # P/R of a channel whose innovation is all noise
QUANTILE = chi2.ppf(0.95, 1)
FIRST, LAST = np.sqrt(QUANTILE), np.sqrt(3.0 * QUANTILE)  # where the factor begins to act, and its upper bound


def of(label, ratio=NOISE_ONLY, innovations=INNOVATIONS):
    return influence(CURVES[label].weighting, np.asarray(innovations, float), ratio)


@pytest.mark.parametrize("ratio", [NOISE_ONLY, 0.04, 1.0, 17.6])
def test_the_ekf_is_the_diagonal(ratio):
    np.testing.assert_allclose(of("EKF", ratio), INNOVATIONS)


@pytest.mark.parametrize("label", sorted(set(CURVES) - {"CI, corrected"}))  # whose weight depends on P itself: see its own test
@pytest.mark.parametrize("ratio", [0.04, 17.6])
def test_the_correction_is_the_posterior_mean_of_the_weighted_noise(label, ratio):
    """Information form ``(1/P + w/R)^-1 w/R y``, with the weight read off a channel without prior variance."""
    weighting, y = CURVES[label].weighting, np.array([0.5, 1.5, 2.5, 4.0, 7.0])
    weight = of(label, innovations=y) / y
    by_gain = weight * ratio / (1 + ratio) * y
    by_noise = weight / (1 / ratio + weight) * y
    expected = (by_gain if weighting.on_gain else by_noise) * (1 + ratio) / ratio
    np.testing.assert_allclose(of(label, ratio, y), expected, rtol=1e-9)


def test_where_noise_dominates_the_linear_increment_falls_as_the_inverse_and_the_root_is_constant():
    beyond = INNOVATIONS[INNOVATIONS > FIRST]
    np.testing.assert_allclose(of("CI, linear (as read)", innovations=beyond), QUANTILE / beyond, rtol=1e-9)
    between = beyond[beyond < LAST]
    np.testing.assert_allclose(of("CI, root", innovations=between), FIRST, rtol=1e-9)
    np.testing.assert_allclose(of("Huber, 1.345", innovations=beyond), 1.345, rtol=1e-9)


def test_rejection_and_gate_leave_nothing_beyond_their_bounds():
    beyond = INNOVATIONS[INNOVATIONS > LAST]
    for ratio in RATIOS.values():
        assert not of("CI, rejecting", ratio, beyond).any()
        assert not of("gate, 1.96", ratio, beyond).any()


def test_where_noise_dominates_a_kernel_redescends_as_a_gaussian():
    np.testing.assert_allclose(of("one kernel, 3"), INNOVATIONS * np.exp(-(INNOVATIONS**2) / 18), rtol=1e-9)


def test_the_corrected_increment_has_the_same_influence_in_every_channel():
    beyond = INNOVATIONS[INNOVATIONS > FIRST]
    for ratio in (NOISE_ONLY, *RATIOS.values()):
        np.testing.assert_allclose(of("CI, corrected", ratio, beyond), QUANTILE / beyond, rtol=1e-6)


def test_the_printed_increment_hardly_acts_where_the_prior_dominates():
    """Proposition 5: at 8 deviations and P/R = 17.6 the gain goes from 0.946 to 0.514 instead of 0.057."""
    gains = [17.6 / 18.6 * of(label, 17.6, [8.0])[0] / 8 for label in ("EKF", "CI, linear (as read)", "CI, corrected")]
    np.testing.assert_allclose(gains, [0.946, 0.514, 0.057], atol=5e-4)


def test_weights_on_the_gain_do_not_care_about_the_prior_and_weights_on_the_noise_do():
    np.testing.assert_allclose(of("kernels on the gain", 17.6), of("kernels on the gain", 0.04), rtol=1e-12)
    assert np.all(of("kernels on the noise", 17.6)[1:] > of("kernels on the noise", 0.04)[1:])


def test_the_weight_is_the_derivative_of_the_mixture_correntropy():
    """``-dV/de = w e`` with V of equation (39) for one channel, up to the normalisation by w(0)."""
    widths, mixing = np.array(OPTIONS["kernel_widths"]), np.array(OPTIONS["kernel_weights"])

    def correntropy_of(e):
        return np.sum(mixing * np.exp(-(np.asarray(e)[..., None] ** 2) / (2 * widths**2)), axis=-1)

    e, step = np.linspace(0.1, 7.9, 40), 1e-5
    slope = -(correntropy_of(e + step) - correntropy_of(e - step)) / (2 * step)
    ours = influence(correntropy(widths, mixing), e, NOISE_ONLY) * np.sum(mixing / widths**2)
    np.testing.assert_allclose(ours, slope, rtol=1e-6, atol=1e-9)


@pytest.fixture(scope="module")
def drawing():
    with style.use():
        figure = draw_influence(Results(Settings("smoke", 1, {}, OPTIONS), None, None))
        FigureCanvasAgg(figure).draw()
    return figure


def test_every_filter_is_drawn_for_both_kinds_of_channel(drawing):
    labels = [line.get_label() for ax in drawing.axes for line in ax.lines]
    assert set(labels) == set(CURVES)
    assert all(labels.count(label) == 2 * (1 + (label == "EKF")) for label in CURVES)
    assert len(drawing.axes) == 4 and all(ax.get_xlim() == (0, REACH) for ax in drawing.axes)


def test_the_figure_stays_inside_and_its_legends_off_the_curves(drawing):
    drawn, (width, height) = drawing.get_tightbbox(), drawing.get_size_inches()
    assert -0.01 <= drawn.x0 and drawn.x1 <= width + 0.01 and -0.01 <= drawn.y0 and drawn.y1 <= height + 0.01
    for ax in drawing.axes[:2]:
        for text in ax.get_legend().get_texts():
            box = text.get_window_extent()
            for line in ax.lines:
                places = ax.transData.transform(line.get_xydata())
                assert not any(box.contains(x, y) for x, y in places)


def test_curves_that_share_a_panel_look_different():
    for column in curves(OPTIONS).values():
        looks = [palette.look(curve.family) | dict(curve.changes) for curve in column]
        assert len({str(look["linestyle"]) for look in looks}) == len(looks), "in grey too"


def test_every_filter_of_the_registry_has_a_look():
    assert {variant.family for variant in VARIANTS.values()} <= set(palette.FAMILIES)
    assert set(palette.FAMILIES) <= set(style.families())


def test_what_is_drawn_together_differs_in_grey_by_its_line():
    together = ("truth", "reference", "ekf", "chi-square", "multi-kernel-gain")
    assert len({str(palette.look(family)["linestyle"]) for family in together}) == len(together)


def test_relatives_share_their_colour():
    relatives = [("ekf", "inflated", "classical"), ("chi-square", "chi-square-corrected", "gated"),
                 ("multi-kernel", "multi-kernel-gain"), ("single-kernel", "correntropy")]  # fmt: skip
    for kin in relatives:
        assert len({palette.look(family)["color"] for family in kin}) == 1, kin
