"""The arrays behind the pictures of a series: Q-Q plot, histogram, autocorrelation, Allan deviation."""

from typing import NamedTuple

import numpy as np
from scipy import stats

from robins.diagnostics.allan import AllanCurve, allan_deviation
from robins.diagnostics.finding import LEVEL, checked
from robins.diagnostics.whiteness import Autocorrelation, autocorrelation

QUANTILES = 1000
"""Most points drawn in a Q-Q plot; a longer series is thinned in the middle, never in its tails."""


class QuantilePlot(NamedTuple):
    """Normal Q-Q plot.

    Attributes
    ----------
    theoretical, ordered : array, shape (K,)
        Quantiles of the standard normal law, and the ordered samples that belong to them.
    low, high : array, shape (K,)
        Pointwise band at 95 % in which an ordered sample of the fitted normal law lies.
    line : array, shape (K,)
        The fitted normal law (sample mean and standard deviation).
    """

    theoretical: np.ndarray
    ordered: np.ndarray
    low: np.ndarray
    high: np.ndarray
    line: np.ndarray


class Histogram(NamedTuple):
    """Histogram as a density.

    Attributes
    ----------
    edges, density : array, shape (B + 1,) and (B,)
    grid, fitted : array, shape (G,)
        Abscissae, and the density of the normal law fitted to the samples.
    true : array, shape (G,), or None
        Density of the law that the samples are known to have.
    """

    edges: np.ndarray
    density: np.ndarray
    grid: np.ndarray
    fitted: np.ndarray
    true: np.ndarray | None


class Pictures(NamedTuple):
    """Everything that a figure of one channel needs."""

    quantiles: QuantilePlot
    histogram: Histogram
    autocorrelation: Autocorrelation
    allan: AllanCurve


def thinned(n: int) -> np.ndarray:
    """Indices into `n` ordered samples: every one in the outer fifty on either side, evenly spaced normal quantiles between."""
    if n <= QUANTILES:
        return np.arange(n)
    middle = stats.norm.cdf(np.linspace(stats.norm.ppf(50 / n), stats.norm.ppf(1 - 50 / n), QUANTILES - 100))
    return np.unique(np.concatenate([np.arange(50), (middle * (n - 1)).astype(int), np.arange(n - 50, n)]))


def quantile_plot(samples) -> QuantilePlot:
    """Normal Q-Q plot of `samples`, shape (N,).

    The positions are those of `scipy.stats.probplot` (medians of the order statistics, Filliben). The i-th of N
    ordered uniform samples has the law Beta(i, N + 1 - i); its quantiles, carried through the fitted normal law, are
    the band. It is pointwise: about one point in twenty of a normal series lies outside.
    """
    samples = checked(samples)
    n = samples.size
    theoretical, ordered = stats.probplot(samples, dist="norm", fit=False)
    kept = thinned(n)
    mean, deviation = samples.mean(), samples.std(ddof=1)
    rank = kept + 1.0
    low, high = (mean + deviation * stats.norm.ppf(stats.beta.ppf(tail, rank, n + 1 - rank)) for tail in ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    return QuantilePlot(theoretical[kept], ordered[kept], low, high, mean + deviation * theoretical[kept])


def histogram(samples, law=None) -> Histogram:
    """Histogram of `samples`, the fitted normal density and that of `law` (frozen scipy).

    The number of bins is Rice's ``2 n^(1/3)``, at most 80: quantised samples leave gaps between finer ones.
    """
    samples = checked(samples)
    bins = min(80, int(np.ceil(2.0 * np.cbrt(samples.size))))
    density, edges = np.histogram(samples, bins=bins, density=True)
    grid = np.linspace(edges[0], edges[-1], 401)
    fitted = stats.norm.pdf(grid, samples.mean(), samples.std(ddof=1))
    return Histogram(edges, density, grid, fitted, None if law is None else law.pdf(grid))


def pictures(samples, rate_hz: float, law=None) -> Pictures:
    """The arrays of all pictures of one channel `samples`, shape (N,), taken at `rate_hz`; `law` is its true law if known."""
    return Pictures(quantile_plot(samples), histogram(samples, law), autocorrelation(samples), allan_deviation(samples, rate_hz))
