"""Standardised laws of sensor noise: mean 0, variance 1, and given skewness and excess kurtosis.

Two families meet the same two moments exactly: the normal-inverse-Gaussian law [1]_, heavy-tailed and smooth, and a mixture
of two normals, a core with rare outliers. Each law has ``sample(generator, shape)``, ``pdf(x)`` and the analytic ``mean``,
``mode``, ``skewness`` and ``excess_kurtosis``, all in units of the standard deviation. `ZeroMode` moves a law so that its most
probable value, not its mean, is zero: for a skewed law these are two conventions of "no bias".

References
----------
.. [1] Barndorff-Nielsen, Normal inverse Gaussian distributions and stochastic volatility modelling, Scand. J. Statist. 24
   (1997) 1-13.
.. [2] Imani and Keighobadi, NAVIGATION 73 (2026), navi.768, section 5: skewness 2.64 and excess kurtosis 19.91 of a gyroscope.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.polynomial import Polynomial
from scipy import special
from scipy.integrate import quad
from scipy.optimize import brentq

TAIL = 60.0
"""Where a standardised law is cut for quadrature [sd]."""


class Law(Protocol):
    """What a law of variance one offers: its moments and mode, in standard deviations, its density and draws."""

    mean: float
    mode: float
    skewness: float
    excess_kurtosis: float

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Density at `x`."""

    def sample(self, generator: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
        """Independent draws, shape `shape`."""


@dataclass(frozen=True)
class Normal:
    """The standard normal law."""

    mean = 0.0
    mode = 0.0
    skewness = 0.0
    excess_kurtosis = 0.0

    def pdf(self, x):
        """Density at `x`."""
        return np.exp(-0.5 * np.square(x)) / np.sqrt(2.0 * np.pi)

    def sample(self, generator, shape):
        """Independent draws, shape `shape`."""
        return generator.standard_normal(shape)


@dataclass(frozen=True)
class NormalInverseGaussian:
    """The standardised normal-inverse-Gaussian law with tail parameter `a` and asymmetry `b`, ``|b| < a``.

    ``y = (x - location) / scale`` has the law of ``b Z + sqrt(Z) N`` with N standard normal and Z inverse Gaussian of mean
    ``1 / sqrt(a^2 - b^2)`` and shape 1: scipy's ``norminvgauss(a, b)``.
    """

    a: float
    b: float
    mean = 0.0

    @cached_property
    def steepness(self) -> float:
        """``sqrt(a^2 - b^2)``."""
        return float(np.sqrt((self.a - self.b) * (self.a + self.b)))

    @cached_property
    def scale(self) -> float:
        """Standard deviations per unit of y."""
        return self.steepness**1.5 / self.a

    @cached_property
    def location(self) -> float:
        """The value of x at ``y = 0``."""
        return -self.scale * self.b / self.steepness

    @property
    def skewness(self) -> float:
        """Third standardised moment."""
        return 3.0 * self.b / (self.a * self.steepness**0.5)

    @property
    def excess_kurtosis(self) -> float:
        """Fourth standardised moment less 3."""
        return 3.0 * (1.0 + 4.0 * (self.b / self.a) ** 2) / self.steepness

    @cached_property
    def mode(self) -> float:
        """Most probable value.

        The derivative of the logarithm of the density, ``b - a (y / q) K2(a q) / K1(a q)`` with ``q = sqrt(1 + y^2)``,
        changes sign between ``y = 0`` and the mean, because K2 > K1.
        """

        def derivative(y):
            q = np.hypot(1.0, y)
            return self.b - self.a * y / q * special.kve(2, self.a * q) / special.kve(1, self.a * q)

        if self.b == 0.0:
            return 0.0
        return self.location + self.scale * brentq(derivative, 0.0, self.b / self.steepness, xtol=1e-15)

    def pdf(self, x):
        """Density at `x`."""
        y = (np.asarray(x) - self.location) / self.scale
        q = np.hypot(1.0, y)
        exponent = self.steepness + self.b * y - self.a * q
        return self.a * special.k1e(self.a * q) * np.exp(exponent) / (np.pi * q * self.scale)

    def sample(self, generator, shape):
        """Independent draws, shape `shape`."""
        mixing = generator.wald(1.0 / self.steepness, 1.0, shape)
        draws = generator.standard_normal(shape)
        draws *= np.sqrt(mixing)
        draws += self.b * mixing
        draws *= self.scale
        draws += self.location
        return draws


def normal_inverse_gaussian(skewness: float, excess_kurtosis: float) -> NormalInverseGaussian:
    """The standardised normal-inverse-Gaussian law of these two moments, in closed form.

    Raises
    ------
    ValueError
        There is none: the excess kurtosis of such a law is above 5/3 of the squared skewness, and above zero.
    """
    if not excess_kurtosis > 5.0 / 3.0 * skewness**2:
        raise ValueError(f"no normal-inverse-Gaussian law has skewness {skewness} and excess kurtosis {excess_kurtosis} <= 5/3 skewness^2")
    steepness = 3.0 / (excess_kurtosis - 4.0 / 3.0 * skewness**2)
    asymmetry = skewness / 3.0 * np.sqrt(steepness)
    a = steepness / np.sqrt(1.0 - asymmetry**2)
    return NormalInverseGaussian(a=float(a), b=float(asymmetry * a))


@dataclass(frozen=True)
class GaussianMixture:
    """A normal core with a share of outliers that are normal too.

    Attributes
    ----------
    share : float
        Probability of an outlier.
    core_mean, core_sd, outlier_mean, outlier_sd : float
        So that the mixture has mean 0 and variance 1.
    """

    share: float
    core_mean: float
    core_sd: float
    outlier_mean: float
    outlier_sd: float

    @property
    def parts(self) -> np.ndarray:
        """Rows core and outliers; columns probability, mean, standard deviation."""
        return np.array([(1.0 - self.share, self.core_mean, self.core_sd), (self.share, self.outlier_mean, self.outlier_sd)])

    @property
    def mean(self) -> float:
        """Mean."""
        p, m, _ = self.parts.T
        return float(p @ m)

    @property
    def variance(self) -> float:
        """Second moment about zero."""
        p, m, s = self.parts.T
        return float(p @ (m**2 + s**2))

    @property
    def skewness(self) -> float:
        """Third standardised moment."""
        p, m, s = self.parts.T
        return float(p @ (m**3 + 3.0 * m * s**2))

    @property
    def excess_kurtosis(self) -> float:
        """Fourth standardised moment less 3."""
        p, m, s = self.parts.T
        return float(p @ (m**4 + 6.0 * m**2 * s**2 + 3.0 * s**4)) - 3.0

    @cached_property
    def mode(self) -> float:
        """Most probable value: the outliers pull it from the mean of the core towards their own, by less than one core deviation."""

        def slope(x):
            return sum(p * np.exp(-0.5 * ((x - m) / s) ** 2) * (m - x) / s**3 for p, m, s in self.parts)

        towards = np.sign(self.outlier_mean - self.core_mean) * min(abs(self.outlier_mean - self.core_mean), self.core_sd)
        return brentq(slope, self.core_mean, self.core_mean + towards, xtol=1e-15)

    def pdf(self, x):
        """Density at `x`."""
        return sum(p / s * Normal().pdf((np.asarray(x) - m) / s) for p, m, s in self.parts)

    def sample(self, generator, shape):
        """Independent draws, shape `shape`."""
        outlier = generator.random(shape) < self.share
        draws = generator.standard_normal(shape)
        draws *= np.where(outlier, self.outlier_sd, self.core_sd)
        draws += np.where(outlier, self.outlier_mean, self.core_mean)
        return draws


def gaussian_mixture(share: float, skewness: float, excess_kurtosis: float) -> GaussianMixture:
    """The standardised mixture of two normals with this share of outliers and these two moments.

    Mean, variance, skewness and kurtosis are four equations for two means and two variances. In terms of the distance D of
    the means and the difference of the variances, variance and skewness are linear and the kurtosis leaves a polynomial in D.
    Among its real roots those with two positive variances and the wider component in the outliers are laws.

    Raises
    ------
    ValueError
        There is no such law, or more than one.
    """
    core, distance = 1.0 - share, Polynomial([0.0, 1.0])
    core_mean, outlier_mean = -share * distance, core * distance
    # Both variances times D: the difference of the variances from the skewness, their mean from the variance.
    difference = (skewness / (share * core) - (1.0 - 2.0 * share) * distance**3) / 3.0
    average = distance - share * core * distance**3
    core_variance, outlier_variance = average - share * difference, average + core * difference
    fourth = sum(
        p * (m**4 * distance**2 + 6.0 * m**2 * variance * distance + 3.0 * variance**2)
        for p, m, variance in ((core, core_mean, core_variance), (share, outlier_mean, outlier_variance))
    )
    roots = (fourth - (excess_kurtosis + 3.0) * distance**2).roots()
    laws = []
    for d in map(float, roots[np.abs(roots.imag) < 1e-9 * np.abs(roots)].real):
        variances = core_variance(d) / d, outlier_variance(d) / d
        if 0.0 < variances[0] < variances[1]:
            laws.append(GaussianMixture(share, core_mean(d), variances[0] ** 0.5, outlier_mean(d), variances[1] ** 0.5))
    if len(laws) != 1:
        raise ValueError(f"{len(laws)} mixtures with {share} outliers have skewness {skewness} and excess kurtosis {excess_kurtosis}")
    return laws[0]


@dataclass(frozen=True)
class ZeroMode:
    """`law` moved so that its mode is zero; its mean then is not."""

    law: Law
    mode = 0.0

    @property
    def mean(self) -> float:
        """Mean."""
        return self.law.mean - self.law.mode

    @property
    def skewness(self) -> float:
        """Third standardised moment."""
        return self.law.skewness

    @property
    def excess_kurtosis(self) -> float:
        """Fourth standardised moment less 3."""
        return self.law.excess_kurtosis

    def pdf(self, x):
        """Density at `x`."""
        return self.law.pdf(np.asarray(x) + self.law.mode)

    def sample(self, generator, shape):
        """Independent draws, shape `shape`."""
        return self.law.sample(generator, shape) - self.law.mode


def robust_location(law: Law, weight: Callable[[float], float]) -> float:
    """What a weighted mean of very many draws of `law` tends to: the root m of ``E[w(x - m) (x - m)] = 0``.

    The mean for a constant weight. For a weight that falls with the residual it lies between mode and mean: the bias of a
    robust filter whose noise is skewed.

    Parameters
    ----------
    law : Law
    weight : callable
        ``weight(residual)``, an even function [sd].
    """

    def influence(m):
        parts = ((-TAIL, m), (m, m + 10.0), (m + 10.0, TAIL))
        return sum(quad(lambda x: weight(x - m) * (x - m) * law.pdf(x), *part, limit=200, epsabs=1e-12)[0] for part in parts)

    return brentq(influence, law.mean - 1.0, law.mean + 1.0, xtol=1e-12)
