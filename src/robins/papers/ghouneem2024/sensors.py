"""What the inertial sensors and the odometer put out in one run: truth, its scale error, bias, noise and the digits that are left.

Nothing here is printed in the paper. Range and resolution of the inertial sensor (SCC1300-D04) are its maker's; every other number
is assumed, typical of its class. Noise of every sensor and run comes from a stream of its own, so that all filters read the same.
"""

from typing import NamedTuple

import numpy as np

from robins.foundation.randomness import stream
from robins.papers.ghouneem2024.trajectories import DEGREE, GRAVITY, KEY, RATE_HZ, Trajectory, gauss_markov

MILLI_G = 1e-3 * GRAVITY
GYROSCOPE_TURN_ON = 0.03 * DEGREE
"""Standard deviation of the constant part of the gyroscope's bias [rad/s]."""
GYROSCOPE_DRIFT, GYROSCOPE_DRIFT_TIME = 10.0 * DEGREE / 3600.0, 300.0
"""Standard deviation [rad/s] and time constant [s] of the Gauss-Markov part of the gyroscope's bias."""
GYROSCOPE_WHITE = 0.0237 * DEGREE
"""White noise of a sample of the gyroscope [rad/s]."""
GYROSCOPE_SCALE = 0.003
GYROSCOPE_DIGIT = DEGREE / 18.0
"""Resolution [rad/s]; 18 counts to the degree per second."""
ACCELEROMETER_BIAS = 8.0 * MILLI_G
"""Standard deviation of the constant bias of each axis [m/s^2]."""
ACCELEROMETER_DRIFT, ACCELEROMETER_DRIFT_TIME = 2.0 * MILLI_G, 600.0
"""Standard deviation [m/s^2] and time constant [s] of the Gauss-Markov part."""
VIBRATION, STANDING_VIBRATION, STANDING_SPEED = 0.1, 0.03, 0.2
"""White noise of the accelerometers when driving and when standing [m/s^2]: up to which speed it stands [m/s]."""
ACCELEROMETER_DIGIT = GRAVITY / 650.0
"""Resolution [m/s^2]; 650 counts to the g."""
ODOMETER_SCALE = 0.012
ODOMETER_LATENCY = 0.4
"""Age of a speed when it arrives and is stamped [s]."""
ODOMETER_DIGIT = 1.0 / 3.6
"""Resolution [m/s]: 1 km/h."""
ACCELERATION_WINDOW = 21
"""Epochs over which the derivative of the odometer's speed is averaged."""
START_SIGMA = (2.5, 2.5, 4.0, 5.0 * DEGREE)
"""Standard deviations of the initial north, east, height [m] and azimuth [rad]."""


class Sensed(NamedTuple):
    """One run at the truth's epochs.

    Attributes
    ----------
    force : ndarray, shape (N+1, 3)
        Specific force right, forward, up, m/s^2.
    rate : ndarray, shape (N+1,)
        Rate about z, counter-clockwise, rad/s.
    speed : ndarray, shape (N+1,)
        Of the odometer, brought to 20 Hz, m/s.
    acceleration : ndarray, shape (N+1,)
        Smoothed derivative of `speed`, m/s^2.
    bias : ndarray, shape (N+1,)
        True bias of the gyroscope, constant part and drift, rad/s.
    """

    force: np.ndarray
    rate: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    bias: np.ndarray


def run_stream(seed: int, trajectory: Trajectory, run: int, sensor: str) -> np.random.Generator:
    """The stream of one sensor (or one cause of error) in one run."""
    return stream(seed, f"{KEY}/{trajectory.name}/{run}/{sensor}")


def sense(seed: int, trajectory: Trajectory, run: int, hold: bool = False) -> Sensed:
    """What the sensors put out in one run.

    Parameters
    ----------
    seed : int
        The configuration's.
    trajectory : Trajectory
        Of any length; the streams are those of its name.
    run : int
    hold : bool
        Keep the odometer's last value until the next arrives, and average its derivative backwards: causal. Otherwise it is
        interpolated between arrivals, as the brief has it, which looks up to a second ahead.
    """
    rate, bias = sense_rate(run_stream(seed, trajectory, run, "gyroscope"), trajectory)
    force = sense_force(run_stream(seed, trajectory, run, "accelerometer"), trajectory)
    arrival, value = sense_speed(run_stream(seed, trajectory, run, "odometer"), trajectory)
    if hold:
        last = np.searchsorted(arrival, trajectory.time, side="right") - 1
        speed = value[np.maximum(last, 0)]
    else:
        speed = np.interp(trajectory.time, arrival, value)
    return Sensed(force, rate, speed, smoothed_derivative(speed, causal=hold), bias)


def sense_rate(generator: np.random.Generator, trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """Rate and its true bias [rad/s], shape (N+1,) each."""
    scale, turn_on = generator.standard_normal(2) * (GYROSCOPE_SCALE, GYROSCOPE_TURN_ON)
    drift, white = generator.standard_normal((2, trajectory.time.size))
    bias = turn_on + gauss_markov(drift, GYROSCOPE_DRIFT, GYROSCOPE_DRIFT_TIME * RATE_HZ)
    return quantise((1.0 + scale) * trajectory.rate + bias + GYROSCOPE_WHITE * white, GYROSCOPE_DIGIT), bias


def sense_force(generator: np.random.Generator, trajectory: Trajectory) -> np.ndarray:
    """Specific force [m/s^2], shape (N+1, 3)."""
    bias = generator.standard_normal(3) * ACCELEROMETER_BIAS
    drift, white = generator.standard_normal((2, trajectory.time.size, 3))
    drift = gauss_markov(drift, ACCELEROMETER_DRIFT, ACCELEROMETER_DRIFT_TIME * RATE_HZ)
    vibration = np.where(trajectory.speed <= STANDING_SPEED, STANDING_VIBRATION, VIBRATION)
    return quantise(trajectory.force + bias + drift + vibration[:, None] * white, ACCELEROMETER_DIGIT)


def sense_speed(generator: np.random.Generator, trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """Arrivals [s], one in each second at a random phase, and the speeds that arrive [m/s], shape (seconds,) each."""
    phase, scale = generator.random(), ODOMETER_SCALE * generator.standard_normal()
    arrival = phase + np.arange(int(trajectory.time[-1]))
    speed = np.interp(arrival - ODOMETER_LATENCY, trajectory.time, trajectory.speed)
    return arrival, quantise((1.0 + scale) * speed, ODOMETER_DIGIT)


def quantise(value: np.ndarray, digit: float) -> np.ndarray:
    """The nearest multiple of `digit`."""
    return np.rint(value / digit) * digit


def smoothed_derivative(speed: np.ndarray, causal: bool) -> np.ndarray:
    """Derivative of `speed` [m/s^2], averaged over `ACCELERATION_WINDOW` epochs: central differences about the epoch, or backward ones.

    Outside the record the speed is that of its ends. The sum over the window telescopes.
    """
    if causal:
        before = np.concatenate([np.full(ACCELERATION_WINDOW, speed[0]), speed[:-ACCELERATION_WINDOW]])
        return (speed - before) * (RATE_HZ / ACCELERATION_WINDOW)
    reach = ACCELERATION_WINDOW // 2 + 1
    padded = np.pad(speed, reach, mode="edge")
    pairs = padded[1:] + padded[:-1]
    return (pairs[2 * reach - 1 :] - pairs[: 1 - 2 * reach]) * (0.5 * RATE_HZ / ACCELERATION_WINDOW)


def initial_error(seed: int, trajectory: Trajectory, run: int) -> np.ndarray:
    """Error of the initial north, east, height [m] and azimuth [rad], estimate minus truth, shape (4,)."""
    return run_stream(seed, trajectory, run, "initial").standard_normal(4) * START_SIGMA
