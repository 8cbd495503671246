"""One answer of one test, in the shape that a table's row has."""

import math
from typing import NamedTuple

import numpy as np

LEVEL = 0.95
"""Confidence level of every interval of this floor."""


class Finding(NamedTuple):
    """One row of the diagnostics of a channel.

    Attributes
    ----------
    test : str
        Name of the test.
    n : int
        Number of samples that the statistic was computed from.
    statistic, p_value : float
        NaN where the test has none; writers turn that into an empty cell.
    ci_low, ci_high : float
        Interval of the statistic at `LEVEL`, NaN where there is none.
    note : str
        What the reader must know to use the row: assumption, subsample, clipping.
    """

    test: str
    n: int
    statistic: float
    p_value: float = math.nan
    ci_low: float = math.nan
    ci_high: float = math.nan
    note: str = ""


def checked(samples) -> np.ndarray:
    """`samples` as a float64 vector, shape (N,); ValueError unless there are 8 or more, all finite and not all equal."""
    samples = np.ascontiguousarray(samples, dtype=float)
    if samples.ndim != 1 or samples.size < 8:
        raise ValueError(f"samples of shape {samples.shape}, expected one channel of 8 or more")
    if not np.isfinite(samples).all():
        raise ValueError(f"{np.count_nonzero(~np.isfinite(samples))} of {samples.size} samples are not finite")
    if samples.min() == samples.max():
        raise ValueError(f"all {samples.size} samples equal {samples[0]:g}: a constant has no distribution to test")
    return samples
