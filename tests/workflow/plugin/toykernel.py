"""What the toy paper computes: the mean of twenty noisy readings of one constant, and how wrong it is."""

import pandas as pd

from robins.foundation.randomness import standard_normals

READINGS = 20


def readings(settings, runs):
    """Readings of these runs, shape (runs, READINGS)."""
    names = [f"toy/constant/{run}/gauge" for run in runs]
    return settings.options["level"] + standard_normals(settings.seed, names, (READINGS,))


def errors(settings, weight, runs):
    """One row for each run: the error of the mean times `weight`."""
    estimates = weight * readings(settings, runs).mean(axis=1)
    return pd.DataFrame({"run": list(runs), "error": abs(estimates - settings.options["level"])})
