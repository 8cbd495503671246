"""Self-tuning of Q and P0 from a reference, (12) and (13), at every level of the brief.

``st_printed``  the signed means themselves, in absolute value because half of them would be no variances; latitude and longitude in
                radians, as the state has them, taken as rad^2
``st_ms``       mean squares in place of means
``st_ms_ft``    mean squares, Q times a scalar s that is chosen on the tuning runs (the paper: "manual adjustments")
``st_inc``      Q from the mean square of the error's increment over a second, a twentieth of it for a step

Gyro bias and odometer have no reference: their variances stay those of the data sheet. All levels need the truth.
"""

from typing import NamedTuple

import numpy as np

from robins.foundation.earth import meridian_radius, transverse_radius
from robins.navigation.riss import AZIMUTH, EAST, NORTH
from robins.papers.ghouneem2024.filters import DT, HEIGHT_OF_ORIGIN, Variances, datasheet
from robins.papers.ghouneem2024.runs import errors, wrapped
from robins.papers.ghouneem2024.trajectories import RATE_HZ, trajectory

REFERENCED = 7
"""States that a reference has: position, velocity, azimuth."""
LEVELS = ("st-printed", "st-ms", "st-inc")
SCALES = (1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
"""The scalars s that the tuning chooses from."""


class Statistics(NamedTuple):
    """Averages of the errors of one run, or over runs, each (7,) in the order of the states.

    Attributes
    ----------
    mean : ndarray
        Over the epochs, of estimate minus reference: (12) and (13) have the other sign.
    mean_square : ndarray
        Over the epochs.
    increment : ndarray
        Mean square of the change over a second.
    """

    mean: np.ndarray
    mean_square: np.ndarray
    increment: np.ndarray


def statistics(estimate: np.ndarray, place: str) -> Statistics:
    """Averages of the errors of an estimate ``(N+1, 7 or more)``."""
    error = errors(estimate, place)
    change = error[RATE_HZ:] - error[:-RATE_HZ]
    change[:, AZIMUTH] = wrapped(change[:, AZIMUTH])
    return Statistics(error.mean(axis=0), np.mean(np.square(error), axis=0), np.mean(np.square(change), axis=0))


def pooled(each: list[Statistics]) -> Statistics:
    """Averages over runs."""
    return Statistics(*(np.mean(values, axis=0) for values in zip(*each, strict=True)))


def radii(place: str) -> np.ndarray:
    """Metres of north and east for a radian of latitude and longitude at the origin of a trajectory."""
    latitude = trajectory(place).latitude
    across = (transverse_radius(latitude) + HEIGHT_OF_ORIGIN) * np.cos(latitude)
    return np.array([meridian_radius(latitude) + HEIGHT_OF_ORIGIN, across])


def printed_variances(mean: np.ndarray, place: str) -> np.ndarray:
    """``|avg|`` of (12) or (13) as the filter takes it, shape (7,): metres of sd are the earth's radius times the root of radians."""
    taken = np.abs(mean)  # (12), (13) ghouneem2024
    horizontal = [NORTH, EAST]
    taken[horizontal] = taken[horizontal] / radii(place) * radii(place) ** 2
    return taken


def self_tuned(name: str, level: str, mechanisation: Statistics, filtered: Statistics, place: str, scale: float = 1.0) -> Variances:
    """Variances of a filter from its tuning runs on a trajectory.

    Parameters
    ----------
    name : str
        The filter.
    level : {"st-printed", "st-ms", "st-inc"}
        See the module's docstring; ``st-ms`` with a `scale` below one is ``st_ms_ft``.
    mechanisation, filtered : Statistics
        Of the mechanisation alone (Q) and of the same filter with data-sheet variances and no gate (P0).
    scale : float
        Multiplies Q.

    Raises
    ------
    ValueError
        No such level, or a scale that is not positive.
    """
    if level not in LEVELS:
        raise ValueError(f"level: found {level!r}, expected one of {', '.join(LEVELS)}")
    if not scale > 0.0:
        raise ValueError(f"scale: found {scale}, expected a positive number")
    variances = datasheet(name)
    process, initial = variances.process.copy(), variances.initial.copy()
    if level == "st-printed":
        process[:REFERENCED], initial[:REFERENCED] = (printed_variances(each.mean, place) for each in (mechanisation, filtered))
    else:
        process[:REFERENCED] = mechanisation.increment * DT if level == "st-inc" else mechanisation.mean_square
        initial[:REFERENCED] = filtered.mean_square
    process[:REFERENCED] *= scale
    return Variances(process, initial)
