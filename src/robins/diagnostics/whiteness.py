"""Does a series remember? Autocorrelation with the band of white noise, and the Ljung-Box test."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy import stats

from robins.diagnostics.finding import LEVEL, Finding, checked

LAGS = 20
"""Lags of the Ljung-Box test and of the autocorrelation panel."""


class Autocorrelation(NamedTuple):
    """Sample autocorrelation.

    Attributes
    ----------
    lags : array of int, shape (lags + 1,)
    values : array, shape (lags + 1,)
        Biased estimate (divisor N at every lag); 1 at lag 0.
    band : float
        Half-width 1.96 / sqrt(N): white noise stays within it at 95 % of the lags.
    """

    lags: np.ndarray
    values: np.ndarray
    band: float


def autocorrelation(samples, lags: int = LAGS) -> Autocorrelation:
    """Autocorrelation of `samples`, shape (N,), at lags 0 to `lags`."""
    from statsmodels.tsa.stattools import acf  # half a second, in jobs that test nothing too

    samples = checked(samples)
    band = stats.norm.ppf((1 + LEVEL) / 2) / sqrt(samples.size)
    return Autocorrelation(np.arange(lags + 1), acf(samples, nlags=lags, fft=True), band)


def first_lag(samples) -> Finding:
    """Autocorrelation at lag 1; p-value and interval with white noise's standard error 1 / sqrt(N)."""
    samples = checked(samples)
    values, band = autocorrelation(samples, 1)[1:]
    p_value = 2 * stats.norm.sf(abs(values[1]) * sqrt(samples.size))
    return Finding("autocorrelation lag 1", samples.size, values[1], p_value, values[1] - band, values[1] + band)


def ljung_box(samples, lags: int = LAGS) -> Finding:
    """Ljung-Box test that the autocorrelations at lags 1 to `lags` are all zero.

    Valid for a raw series; residuals of a model with p fitted coefficients would need lags - p degrees of freedom.
    """
    from statsmodels.tsa.stattools import q_stat  # as above

    samples = checked(samples)
    statistics, p_values = q_stat(autocorrelation(samples, lags).values[1:], samples.size)
    return Finding("ljung-box", samples.size, statistics[-1], p_values[-1], note=f"lags 1 to {lags}")
