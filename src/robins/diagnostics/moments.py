"""Skewness and excess kurtosis with intervals that survive heavy tails and short-range dependence.

The textbook standard errors, sqrt(6/n) and sqrt(24/n), hold for independent normal samples only: for a Laplace law the
interval of the kurtosis that they give covers the truth in a quarter of the cases, not in 95 %. Here the interval is a
studentised block bootstrap:

* the standard error comes from the influence function of the statistic [1]_, so it grows with the tails;
* the bootstrap resamples contiguous blocks, so dependence that is short against a block is kept;
* the kurtosis is treated on a logarithmic scale, on which it is less skewed and less tied to its own error.

What it assumes: a stationary series, a block longer than the memory of the series, and finite sixth (skewness) or
eighth (kurtosis) moments. Coverage of the nominal 95 % intervals of skewness and of kurtosis, measured on independent
samples (500 series each): at n = 5000 normal 94 and 95 %, Laplace 95 and 91 %, exponential 91 and 88 %, a
normal-inverse-Gaussian law with excess kurtosis 19.9 89 and 85 %; at n = 150 94 and 91, 92 and 76, 83 and 72, 66 and
56 %. A few hundred samples of a heavy-tailed law do not determine its kurtosis, and no interval repairs that.

References
----------
.. [1] Bai and Ng, Tests for skewness, kurtosis, and normality for time series data, J. Bus. Econ. Stat. 23 (2005) 49.
.. [2] Hall, Horowitz and Jing, On blocking rules for the bootstrap with dependent data, Biometrika 82 (1995) 561.
"""

from math import ceil
from typing import NamedTuple

import numpy as np

from robins.diagnostics.finding import LEVEL, Finding, checked

REPLICATES = 999
"""Bootstrap replicates of an interval."""


class Shape(NamedTuple):
    """Mean, standard deviation, skewness and (raw) kurtosis; one number each or one per replicate."""

    mean: np.ndarray
    deviation: np.ndarray
    skewness: np.ndarray
    kurtosis: np.ndarray


def shape_from_power_sums(sums) -> Shape:
    """`Shape` from sums of the powers 0 to 4 of the samples, shape (..., 5)."""
    first, second, third, fourth = np.moveaxis(sums[..., 1:] / sums[..., :1], -1, 0)
    variance = second - first**2
    central_third = third - 3 * first * second + 2 * first**3
    central_fourth = fourth - 4 * first * third + 6 * first**2 * second - 3 * first**4
    return Shape(first, np.sqrt(variance), central_third / variance**1.5, central_fourth / variance**2)


def influence_coefficients(shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """Influence functions of skewness g and kurtosis k as polynomials: coefficients of x^0..x^4, shape (replicates, 5).

    With u = (x - mean) / deviation [1]_: g: u^3 - g - 3 u - 3/2 g (u^2 - 1); k: u^4 - k - 4 g u - 2 k (u^2 - 1).
    """
    scale, shift, zero = 1 / shape.deviation, -shape.mean / shape.deviation, np.zeros_like(shape.mean)
    one = np.stack([zero + 1, zero, zero, zero, zero], axis=-1)
    u = np.stack([shift, scale, zero, zero, zero], axis=-1)
    u2 = np.stack([shift**2, 2 * scale * shift, scale**2, zero, zero], axis=-1)
    u3 = np.stack([shift**3, 3 * scale * shift**2, 3 * scale**2 * shift, scale**3, zero], axis=-1)
    u4 = np.stack([shift**4, 4 * scale * shift**3, 6 * scale**2 * shift**2, 4 * scale**3 * shift, scale**4], axis=-1)
    g, k = shape.skewness[:, None], shape.kurtosis[:, None]
    return u3 - g * one - 3 * u - 1.5 * g * (u2 - one), u4 - k * one - 4 * g * u - 2 * k * (u2 - one)


def studentised_interval(values, errors) -> tuple[float, float]:
    """Bootstrap-t interval at `LEVEL` from a statistic and its standard error: entry 0 the sample's, the rest the replicates'."""
    pivots = (values[1:] - values[0]) / errors[1:]
    low, high = np.quantile(pivots, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return values[0] - high * errors[0], values[0] - low * errors[0]


def skewness_and_kurtosis(samples, generator: np.random.Generator, block: int | None = None) -> tuple[Finding, Finding]:
    """Skewness and excess kurtosis (of the sample, not bias-corrected) with their intervals; see the module.

    Parameters
    ----------
    samples : array, shape (N,)
    generator : Generator
        Source of the resampling.
    block : int, optional
        Length of a block in samples, longer than the memory of the series; by default N^(1/3), rounded up, the rate
        of [2]_. There should be 20 blocks or more.
    """
    samples = checked(samples)
    block = block or ceil(samples.size ** (1 / 3))
    standardised = (samples - samples.mean()) / samples.std()
    powers = standardised[:, None] ** np.arange(5)
    sums = np.add.reduceat(powers, np.arange(0, samples.size, block), axis=0)
    blocks = len(sums)
    # every replicate is a vector of how often each block was drawn; row 0 is the sample itself
    weights = np.vstack([np.ones(blocks), generator.multinomial(blocks, np.full(blocks, 1 / blocks), size=REPLICATES)])
    total = weights @ sums
    shape = shape_from_power_sums(total)
    products = (weights @ (sums[:, :, None] * sums[:, None, :]).reshape(blocks, 25)).reshape(-1, 5, 5)
    error_skewness, error_kurtosis = (
        np.sqrt(np.einsum("ri,rij,rj->r", coefficients, products, coefficients)) / total[:, 0]
        for coefficients in influence_coefficients(shape)
    )
    low, high = studentised_interval(shape.skewness, error_skewness)
    note = f"studentised bootstrap of {blocks} blocks of {block}"
    skewness = Finding("skewness", samples.size, shape.skewness[0], ci_low=low, ci_high=high, note=note)
    low, high = studentised_interval(np.log(shape.kurtosis), error_kurtosis / shape.kurtosis)
    excess = shape.kurtosis[0] - 3
    return skewness, Finding("excess kurtosis", samples.size, excess, ci_low=np.exp(low) - 3, ci_high=np.exp(high) - 3, note=note)
