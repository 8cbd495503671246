"""GPS in one run: clean errors, multipath bursts, misleading fixes and outages, once per second.

Every number is a choice of the design. The environment was calibrated once, on the printed baseline only, before any other filter
ran, and is frozen since. Clean errors and every cause of trouble have a stream of their own. The events of a cause are drawn one
after the other and their number grows with the severity, so that a severer run has the errors and the events of a milder one and
some more.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from robins.foundation.errors import InputError
from robins.papers.ghouneem2024.sensors import run_stream
from robins.papers.ghouneem2024.trajectories import KEY, RATE_HZ, Trajectory, gauss_markov

MULTIPATH, MISLEADING = 1, 2
"""Flags of `Fixes.cause`."""
POSITION_DRIFT, POSITION_DRIFT_TIME = (2.0, 2.0, 3.5), 120.0
"""Gauss-Markov error of north, east, height [m] and its time constant [s]."""
POSITION_WHITE = (0.7, 0.7, 1.1)
VELOCITY_DRIFT, VELOCITY_DRIFT_TIME, VELOCITY_WHITE = 0.05, 20.0, 0.08
"""The same for each component of velocity [m/s]."""
REPORTED_SIGMA = (2.2, 2.2, 4.0, 0.12, 0.12, 0.12)
"""What the receiver says of a clean fix: north, east, height [m], velocity east, north, up [m/s]."""
TROUBLE_START, OUTAGE_START = 70.0, 100.0
"""Before this no burst or misleading fix, and no outage, begins [s]."""
BURST_SPREAD, BURST_VERTICAL = 0.7, 0.8
"""Standard deviation of the logarithm of a burst's magnitude, and vertical over horizontal size."""
BURST_POSITION_DRIFT, BURST_POSITION_TIME = 0.35, 8.0
BURST_VELOCITY_DRIFT, BURST_VELOCITY_TIME = 0.03, 5.0
"""Gauss-Markov part of a burst over its magnitude (of velocity: per second) and time constants [s]."""
BURST_INFLATION = (1.0, 4.0)
"""Bounds of the factor by which the reported sigma grows in a burst."""
MISLEADING_SECONDS, MISLEADING_OFFSET, MISLEADING_VERTICAL = (1.0, 5.0), (100.0, 400.0), 0.5
"""Bounds of length [s] and horizontal offset [m] of a misleading event, and vertical over horizontal size."""
MISLEADING_VELOCITY = (1.0, 8.0)
"""Bounds of the standard deviation of its error of velocity [m/s]."""


class Environment(NamedTuple):
    """What happens to GPS in a run; numbers of events are Poisson means, pairs are bounds of uniform laws.

    Attributes
    ----------
    outages, bursts, misleading : float
        Mean numbers of events per run.
    outage_seconds, burst_seconds : tuple of float
        s
    multipath_median : float
        Median magnitude of a burst, m.
    """

    outages: float
    outage_seconds: tuple[float, float]
    bursts: float
    burst_seconds: tuple[float, float]
    multipath_median: float
    misleading: float

    def scaled(self, severity: float) -> "Environment":
        """The environment with all three mean numbers times `severity`.

        Raises
        ------
        InputError
            `severity` is negative or not finite.
        """
        if not 0.0 <= severity < np.inf:
            raise InputError(KEY, "severity", severity, "a finite number, not negative")
        return self._replace(outages=severity * self.outages, bursts=severity * self.bursts, misleading=severity * self.misleading)


ENVIRONMENTS = {
    "t1": Environment(4.0, (30.0, 240.0), 10.0, (10.0, 60.0), 40.0, 6.0),
    "t2": Environment(5.0, (60.0, 300.0), 15.0, (10.0, 90.0), 60.0, 10.0),
}
"""The frozen environments of the two drives."""


class Fixes(NamedTuple):
    """The fixes of one run; there is none in an outage.

    Attributes
    ----------
    epoch : ndarray of int, shape (M,)
        Index into the truth's epochs.
    value, sigma : ndarray, shape (M, 6)
        North, east, height [m], velocity east, north, up [m/s], and the standard deviations that the receiver reports.
    cause : ndarray of int, shape (M,)
        0 when clean, else the sum of `MULTIPATH` and `MISLEADING`.
    """

    epoch: np.ndarray
    value: np.ndarray
    sigma: np.ndarray
    cause: np.ndarray


def receive(seed: int, trajectory: Trajectory, run: int, environment: Environment) -> Fixes:
    """The fixes of one run, at whole seconds from 1 s on.

    Parameters
    ----------
    seed : int
        The configuration's.
    trajectory : Trajectory
        Of any length; the streams are those of its name.
    run : int
    environment : Environment
    """
    epoch = np.arange(RATE_HZ, trajectory.time.size, RATE_HZ)
    time = trajectory.time[epoch]

    def draws(cause):
        return run_stream(seed, trajectory, run, cause)

    value = np.hstack([trajectory.position[epoch], trajectory.velocity[epoch]]) + clean_error(draws("gps"), time.size)
    sigma = np.tile(REPORTED_SIGMA, (time.size, 1))
    cause = np.zeros(time.size, dtype=np.int64)
    bursts, misleading, outages = draws("bursts"), draws("misleading"), draws("outages")
    for _ in events(bursts, environment.bursts):
        during = span(bursts, time, TROUBLE_START, environment.burst_seconds)
        add_burst(bursts, environment.multipath_median, value[during], sigma[during])
        cause[during] |= MULTIPATH
    for _ in events(misleading, environment.misleading):
        during = span(misleading, time, TROUBLE_START, MISLEADING_SECONDS)
        value[during] += misleading_error(misleading)
        cause[during] |= MISLEADING
    present = np.ones(time.size, dtype=bool)
    for _ in events(outages, environment.outages):
        present[span(outages, time, OUTAGE_START, environment.outage_seconds)] = False
    return Fixes(epoch[present], value[present], sigma[present], cause[present])


def clean_error(generator: np.random.Generator, fixes: int) -> np.ndarray:
    """Error of fixes that nothing disturbs, one per second, shape (fixes, 6)."""
    drift, white = generator.standard_normal((2, fixes, 6))
    position = gauss_markov(drift[:, :3], 1.0, POSITION_DRIFT_TIME) * POSITION_DRIFT + white[:, :3] * POSITION_WHITE
    velocity = gauss_markov(drift[:, 3:], VELOCITY_DRIFT, VELOCITY_DRIFT_TIME) + VELOCITY_WHITE * white[:, 3:]
    return np.hstack([position, velocity])


def events(generator: np.random.Generator, mean: float) -> Iterator[None]:
    """Yield a Poisson number of times. The caller draws an event's properties from `generator` before it asks for the next.

    The number counts the arrivals of a process of rate one up to `mean`, so a larger mean keeps the events of a smaller one.
    """
    arrival = generator.standard_exponential()
    while arrival <= mean:
        yield
        arrival += generator.standard_exponential()


def span(generator: np.random.Generator, time: np.ndarray, earliest: float, seconds: tuple[float, float]) -> slice:
    """The fixes within an event that begins between `earliest` and the end of the run, uniformly, and lasts U(`seconds`)."""
    start = generator.uniform(earliest, max(earliest, time[-1]))
    first, last = np.searchsorted(time, (start, start + generator.uniform(*seconds)))
    return slice(first, last)


def horizontal(generator: np.random.Generator, size: float) -> np.ndarray:
    """North and east of a vector of this `size` in a uniform direction, shape (2,)."""
    angle = generator.uniform(0.0, 2.0 * np.pi)
    return size * np.array([np.cos(angle), np.sin(angle)])


def add_burst(generator: np.random.Generator, median: float, value: np.ndarray, sigma: np.ndarray) -> None:
    """Add a multipath burst to the fixes within it, shape (n, 6), in place. Of overlapping bursts the larger inflation is reported."""
    size = median * np.exp(BURST_SPREAD * generator.standard_normal())
    value[:, :2] += horizontal(generator, size)
    value[:, 2] += BURST_VERTICAL * size * generator.standard_normal()
    inflation = generator.uniform(*BURST_INFLATION)
    np.maximum(sigma, inflation * np.array(REPORTED_SIGMA), out=sigma)
    white = generator.standard_normal((len(value), 6))
    if len(value):
        value[:, :3] += gauss_markov(white[:, :3], BURST_POSITION_DRIFT * size, BURST_POSITION_TIME)
        value[:, 3:] += gauss_markov(white[:, 3:], BURST_VELOCITY_DRIFT * size, BURST_VELOCITY_TIME)


def misleading_error(generator: np.random.Generator) -> np.ndarray:
    """Error of all fixes within one misleading event, shape (6,)."""
    offset = generator.uniform(*MISLEADING_OFFSET)
    vertical = MISLEADING_VERTICAL * offset * generator.standard_normal()
    velocity = generator.uniform(*MISLEADING_VELOCITY) * generator.standard_normal(3)
    return np.array([*horizontal(generator, offset), vertical, *velocity])
