"""What the toy paper computes: the mean of twenty noisy readings of one constant, and how wrong it is."""

import numpy as np
import pandas as pd

from robins.foundation.randomness import standard_normals

READINGS = 20


def readings(settings):
    """Readings of every run, shape (runs, READINGS)."""
    names = [f"toy/constant/{run}/gauge" for run in range(settings.sizes["runs"])]
    return settings.options["level"] + standard_normals(settings.seed, names, (READINGS,))


def errors(settings, weight):
    """One row for each run: the error of the mean times `weight`."""
    estimates = weight * readings(settings).mean(axis=1)
    return pd.DataFrame({"run": np.arange(len(estimates)), "error": np.abs(estimates - settings.options["level"])})
