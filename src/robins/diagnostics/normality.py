"""Is a series normal, or of a given law? Tests, and skewness and kurtosis with intervals.

All p-values here hold for independent samples. An autocorrelated series has fewer independent samples than samples, so
its p-values are too small; `robins.diagnostics.whiteness` says whether that is the case.
"""

import numpy as np
from scipy import stats

from robins.diagnostics.finding import Finding, checked

SHAPIRO_LIMIT = 5000
"""Largest sample for which scipy's Shapiro-Wilk p-value (Royston's AS R94) is calibrated."""


def shapiro_wilk(samples, generator: np.random.Generator) -> Finding:
    """Shapiro-Wilk test of normality.

    The p-value of `scipy.stats.shapiro` is not reliable above 5000 samples. A longer series is therefore thinned to
    5000 samples, drawn without replacement from `generator`. A random choice cannot lock on to a period of the
    series as an even stride can, and it loosens the dependence between neighbours.
    """
    samples = checked(samples)
    note = ""
    if samples.size > SHAPIRO_LIMIT:
        note = f"random subsample of {samples.size}: p-value unreliable above {SHAPIRO_LIMIT}"
        samples = generator.choice(samples, SHAPIRO_LIMIT, replace=False)
    result = stats.shapiro(samples)
    return Finding("shapiro-wilk", samples.size, float(result.statistic), float(result.pvalue), note=note)


def kolmogorov_smirnov(samples, law) -> Finding:
    """Kolmogorov-Smirnov test against a law whose parameters are known beforehand (a frozen scipy distribution).

    With parameters estimated from the same samples its p-value is far too large; that case is `lilliefors`.
    """
    samples = checked(samples)
    result = stats.kstest(samples, law.cdf)
    return Finding("kolmogorov-smirnov", samples.size, float(result.statistic), float(result.pvalue), note="parameters known")


def lilliefors(samples) -> Finding:
    """Kolmogorov-Smirnov test of normality with mean and variance estimated (Lilliefors).

    statsmodels interpolates simulated critical values, so the p-value is clipped to [0.001, 0.99].
    """
    from statsmodels.stats.diagnostic import lilliefors as statsmodels_lilliefors  # half a second, in jobs that test nothing too

    samples = checked(samples)
    statistic, p_value = statsmodels_lilliefors(samples, dist="norm", pvalmethod="table")
    return Finding("lilliefors", samples.size, float(statistic), float(p_value), note="parameters estimated; p-value within [0.001, 0.99]")


def jarque_bera(samples) -> Finding:
    """Jarque-Bera test: skewness and excess kurtosis together against those of a normal law (asymptotic p-value)."""
    samples = checked(samples)
    result = stats.jarque_bera(samples)
    return Finding("jarque-bera", samples.size, float(result.statistic), float(result.pvalue))
