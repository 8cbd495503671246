"""Is a filter's covariance honest? Normalised squared errors and innovations against chi-square.

For an honest Gaussian filter the normalised estimation error squared (NEES) of n states and the
normalised innovation squared (NIS) of n measurements are chi-square with n degrees of freedom.

References
----------
.. [1] Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation,
   Wiley 2001, section 5.4.
"""

from typing import NamedTuple

import numpy as np
from scipy import stats

from robins.evaluate.intervals import LEVEL, Interval, mean_interval


class Band(NamedTuple):
    """Two-sided 95 % band of a mean normalised square: its expectation and its ends."""

    expected: float
    low: float
    high: float


def normalised_squared(vectors: np.ndarray, covariances: np.ndarray) -> np.ndarray:
    """``e' S^-1 e`` for every vector: NEES of errors, NIS of innovations.

    Parameters
    ----------
    vectors : ndarray, shape (..., n)
    covariances : ndarray, shape (..., n, n)
        Leading axes broadcast against those of `vectors`.

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    numpy.linalg.LinAlgError
        A covariance is singular.
    """
    vectors = np.asarray(vectors, dtype=float)
    return np.sum(vectors * np.linalg.solve(covariances, vectors[..., np.newaxis])[..., 0], axis=-1)


def chi_square_band(dof: int, samples: int) -> Band:
    """95 % band of the mean of `samples` independent normalised squares with `dof` degrees of freedom each.

    The sum of the samples is chi-square with ``dof * samples`` degrees of freedom [1]_. Epochs of one run
    are independent only for white sequences; runs always are.
    """
    total = dof * samples
    low, high = stats.chi2.ppf([(1 - LEVEL) / 2, (1 + LEVEL) / 2], total) / samples
    return Band(float(dof), float(low), float(high))


def mean_nis_interval(nis: np.ndarray) -> Interval:
    """Mean normalised square over epochs and runs with its interval, from the spread between runs.

    Parameters
    ----------
    nis : ndarray, shape (runs, epochs)
        Surviving runs only. A run's epochs may be correlated (they are, in a filter that is wrong), so a
        run counts as one observation: its mean over the epochs.
    """
    return mean_interval(np.mean(np.asarray(nis, dtype=float), axis=1))
