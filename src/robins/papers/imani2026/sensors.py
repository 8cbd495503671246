"""What the sensors put out in one run: interval averages of the truth, a constant bias, noise, and what else is asked for.

Six channels in this order: accelerometers x, y, z [m/s^2], gyroscopes x, y, z [rad/s], in b. The paper prints none of these
numbers except the skewness and the kurtosis of the gyroscopes' residuals; the rest are design choices.

Every run draws from named streams of its own, one for each cause of error. So a run's noise is the same whatever filter reads it
and whether or not outliers are added, a larger rate of outliers keeps those of a smaller one, and two grades of sensor differ in
scale only.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from robins.foundation.noise_laws import Law, Normal, ZeroMode, gaussian_mixture, normal_inverse_gaussian
from robins.foundation.randomness import stream
from robins.papers.imani2026.drive import KEY, Drive

RATE_HZ = 10
"""Rate at which the standard deviations of the noise are given [Hz]."""
GYROSCOPE_MOMENTS = (2.64, 19.91)
"""Skewness and excess kurtosis of the gyroscopes' residuals (section 5 of the paper)."""
OUTLIER_SHARE = 0.05
"""Share of the wide component in the impulsive law (ours)."""
LAWS: Mapping[str, Law] = MappingProxyType(
    {
        "nig-zero-mean": normal_inverse_gaussian(*GYROSCOPE_MOMENTS),
        "nig-zero-mode": ZeroMode(normal_inverse_gaussian(*GYROSCOPE_MOMENTS)),
        "mixture": gaussian_mixture(OUTLIER_SHARE, *GYROSCOPE_MOMENTS),
        "normal": Normal(),
    }
)
"""Laws of the gyroscopes' noise by the names that the tables use."""
STREAMS = (
    "accelerometer",
    "gyroscope",
    "bias",
    "outliers",
    "transients",
    "classical-noise",
    "classical-bias",
    "initial-attitude",
    "reference",
)
"""What has a stream of its own in every run; the last is drawn in `reference`."""


@dataclass(frozen=True)
class Outliers:
    """Gross errors added to the samples of the atomic sensors.

    Attributes
    ----------
    rate : float
        Share of the samples of each channel that is hit, 0 <= rate < 1. At another sampling rate the same share means another
        number of outliers per second.
    one_sided : bool
        All positive, instead of either sign with equal probability.
    size : float
        In standard deviations of the noise, times U(0.5, 1.5).
    burst : int
        Samples that one outlier lasts.
    """

    rate: float = 0.0
    one_sided: bool = False
    size: float = 15.0
    burst: int = 1


@dataclass(frozen=True)
class Transients:
    """Decaying transients (equations 7-9), set off by Poisson pulses of either sign, in each channel its own.

    Attributes
    ----------
    time_constant : float
        s
    pulse_rate : float
        Mean number of pulses per second and channel.
    accelerometer, gyroscope : float
        By how much a pulse moves the transient state, m/s^2 and rad/s.
    """

    time_constant: float = 0.5
    pulse_rate: float = 0.05
    accelerometer: float = 1.0
    gyroscope: float = 0.05


@dataclass(frozen=True)
class Sensors:
    """The atomic sensors, the classical ones beside them (formulation F2) and the initial attitude error.

    Attributes
    ----------
    accelerometer_noise, gyroscope_noise : float
        Standard deviation of a sample at `RATE_HZ`, m/s^2 and rad/s.
    accelerometer_bias, gyroscope_bias : float
        Standard deviation of the constant bias over the runs.
    accelerometer_law, gyroscope_law : Law
        Of the noise in units of its standard deviation.
    equal_psd : bool
        The noise has one power spectral density at all rates, so that a sample's standard deviation grows as sqrt(rate).
    outliers : Outliers
    transients : Transients, optional
    classical_accelerometer_noise ... classical_gyroscope_bias : float
        The same for the classical sensors, normal, averaged over the same intervals.
    tilt_error, yaw_error : float
        Standard deviations of the initial attitude error, rad.
    """

    accelerometer_noise: float = 0.05
    gyroscope_noise: float = 0.002
    accelerometer_bias: float = 1e-3
    gyroscope_bias: float = 2e-5
    accelerometer_law: Law = normal_inverse_gaussian(0.0, 6.0)
    gyroscope_law: Law = LAWS["nig-zero-mean"]
    equal_psd: bool = False
    outliers: Outliers = field(default_factory=Outliers)
    transients: Transients | None = None
    classical_accelerometer_noise: float = 0.02
    classical_gyroscope_noise: float = 0.002
    classical_accelerometer_bias: float = 0.03
    classical_gyroscope_bias: float = 0.003
    tilt_error: float = float(np.radians(0.02))
    yaw_error: float = float(np.radians(0.5))

    def noise_sd(self, rate_hz: int) -> np.ndarray:
        """Standard deviation of a sample, shape (6,)."""
        return channels(self.accelerometer_noise, self.gyroscope_noise) * self.noise_growth(rate_hz)

    def noise_growth(self, rate_hz: int) -> float:
        """Factor on the standard deviations at this rate."""
        return float(np.sqrt(rate_hz / RATE_HZ)) if self.equal_psd else 1.0


GRADES: Mapping[str, Sensors] = MappingProxyType(
    {
        "vehicle": Sensors(),
        "atomic-ideal": Sensors(accelerometer_noise=1e-4, gyroscope_noise=1e-5, accelerometer_bias=1e-6, gyroscope_bias=1e-8),
    }
)
"""What an atomic sensor is worth in a moving car, and what it promises in the laboratory."""


class Measurements(NamedTuple):
    """Several runs of one drive; N samples, sample k - 1 of an array belongs to epoch k.

    Attributes
    ----------
    atomic, classical : ndarray, shape (runs, N, 6)
        Samples of the two sets of sensors.
    bias, classical_bias : ndarray, shape (runs, 6)
        The true biases.
    attitude_error : ndarray, shape (runs, 3)
        Rotation vector d in b of the initial estimate: true C = estimated C exp([d x]).
    noise : ndarray, shape (runs, N, 6)
        Noise in `atomic`: without bias, outliers and transients.
    """

    atomic: np.ndarray
    classical: np.ndarray
    bias: np.ndarray
    classical_bias: np.ndarray
    attitude_error: np.ndarray
    noise: np.ndarray


def channels(accelerometer: float, gyroscope: float) -> np.ndarray:
    """One number for each accelerometer and one for each gyroscope, shape (6,)."""
    return np.repeat([accelerometer, gyroscope], 3)


def stream_name(scenario: str, run: int, cause: str) -> str:
    """Name of the stream that one cause of error (`STREAMS`) of one run is drawn from."""
    return f"{KEY}/{scenario}/{run}/{cause}"


def measure(seed: int, scenario: str, runs: Sequence[int], driven: Drive, sensors: Sensors) -> Measurements:
    """What the sensors put out in these runs of the drive.

    Parameters
    ----------
    seed : int
        The configuration's.
    scenario : str
        First part of the streams' names after the paper: runs of one scenario and number share their noise.
    runs : sequence of int
    driven : Drive
        At the sensors' rate.
    sensors : Sensors
    """
    samples = len(driven.specific_force_interval)
    noise, classical = np.empty((len(runs), samples, 6)), np.empty((len(runs), samples, 6))
    bias, classical_bias, attitude_error = np.empty((len(runs), 6)), np.empty((len(runs), 6)), np.empty((len(runs), 3))
    extra = np.zeros_like(noise) if sensors.transients or sensors.outliers.rate > 0.0 else None
    sd = sensors.noise_sd(driven.rate_hz)
    for row, run in enumerate(runs):

        def draws(cause, run=run):
            return stream(seed, stream_name(scenario, run, cause))

        noise[row, :, :3] = sensors.accelerometer_law.sample(draws("accelerometer"), (samples, 3))
        noise[row, :, 3:] = sensors.gyroscope_law.sample(draws("gyroscope"), (samples, 3))
        draws("classical-noise").standard_normal(out=classical[row])
        bias[row] = draws("bias").standard_normal(6)
        classical_bias[row] = draws("classical-bias").standard_normal(6)
        attitude_error[row] = draws("initial-attitude").standard_normal(3)
        if sensors.outliers.rate > 0.0:
            extra[row] += draw_outliers(draws("outliers"), samples, sensors.outliers) * sd
        if sensors.transients:
            extra[row] += draw_transients(draws("transients"), samples, 1.0 / driven.rate_hz, sensors.transients)  # (8), (9) imani2026
    noise *= sd
    growth = sensors.noise_growth(driven.rate_hz)
    classical *= channels(sensors.classical_accelerometer_noise, sensors.classical_gyroscope_noise) * growth
    bias *= channels(sensors.accelerometer_bias, sensors.gyroscope_bias)
    classical_bias *= channels(sensors.classical_accelerometer_bias, sensors.classical_gyroscope_bias)
    attitude_error *= (sensors.tilt_error, sensors.tilt_error, sensors.yaw_error)
    perfect = np.hstack([driven.specific_force_interval, driven.rate_interval])
    atomic = perfect + bias[:, None] + noise
    if extra is not None:
        atomic += extra
    classical += perfect + classical_bias[:, None]
    return Measurements(atomic, classical, bias, classical_bias, attitude_error, noise)


def draw_outliers(generator: np.random.Generator, samples: int, outliers: Outliers) -> np.ndarray:
    """Outliers in standard deviations of the noise, zero where there is none, shape (samples, 6).

    A sample is hit when one of the last `burst` samples began a burst; the probability to begin one makes the share of hit
    samples equal to the rate. A burst that begins inside another takes its place.
    """
    beginning = 1.0 - (1.0 - outliers.rate) ** (1.0 / outliers.burst)
    begins = generator.random((samples, 6)) < beginning
    size = outliers.size * generator.uniform(0.5, 1.5, (samples, 6))
    positive = generator.random((samples, 6)) < 0.5
    size = np.where(begins & (positive | outliers.one_sided), size, np.where(begins, -size, 0.0))
    out = size.copy()
    for lag in range(1, outliers.burst):
        earlier = size[:-lag]
        out[lag:] = np.where(out[lag:] == 0.0, earlier, out[lag:])
    return out


def draw_transients(generator: np.random.Generator, samples: int, dt: float, transients: Transients) -> np.ndarray:
    """Transients in SI units, averaged over the intervals of length `dt` [s], shape (samples, 6). A pulse begins with an interval."""
    up, down = generator.poisson(0.5 * transients.pulse_rate * dt, (2, samples, 6))
    pulses = (up - down) * channels(transients.accelerometer, transients.gyroscope)
    decay = np.exp(-dt / transients.time_constant)
    states = lfilter([1.0], [1.0, -decay], pulses, axis=0)  # (7) imani2026
    return states * (1.0 - decay) * transients.time_constant / dt  # average of the decay over an interval
