"""The reference that the paper calls VITANS: an aided inertial system with errors of its own, which the paper takes for the truth.

Its position, velocity and attitude are the truth plus Gauss-Markov and white errors. As in the paper, rates are its
differentiated Euler angles; acceleration is its differentiated velocity. The sizes of the errors are design choices.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from robins.foundation.randomness import stream
from robins.papers.imani2026.drive import Drive, euler_to_rate_n
from robins.papers.imani2026.sensors import stream_name

TILT, YAW = float(np.radians(0.1)), float(np.radians(0.3))


@dataclass(frozen=True)
class ReferenceErrors:
    """Pairs are stationary standard deviation and correlation time [s] of a first-order Gauss-Markov error.

    Attributes
    ----------
    position, velocity, tilt, yaw : tuple of float
        m, m/s, rad (roll and pitch), rad.
    angle_noise : float
        Standard deviation of the white error of all three Euler angles, rad.
    """

    position: tuple[float, float] = (2.5, 60.0)
    velocity: tuple[float, float] = (0.05, 10.0)
    tilt: tuple[float, float] = (TILT, 30.0)
    yaw: tuple[float, float] = (YAW, 30.0)
    angle_noise: float = float(np.radians(0.02))


class Reference(NamedTuple):
    """What the reference system reports: `channels` (N+1, 12) in the order of `drive.CHANNELS`, `position` (N+1, 3)."""

    channels: np.ndarray
    position: np.ndarray


def gauss_markov(white: np.ndarray, sd: float, correlation_time: float, dt: float) -> np.ndarray:
    """Stationary first-order Gauss-Markov series along the first axis from standard normal `white`; `dt` in s."""
    decay = np.exp(-dt / correlation_time)
    driving = sd * np.sqrt(1.0 - decay**2) * white
    driving[0] = sd * white[0]
    return lfilter([1.0], [1.0, -decay], driving, axis=0)


def observe(seed: int, scenario: str, run: int, driven: Drive, errors: ReferenceErrors | None = None) -> Reference:
    """The reference of one run, from the run's stream ``reference``.

    Derivatives are central differences, one-sided at both ends.
    """
    errors = errors or ReferenceErrors()
    dt = 1.0 / driven.rate_hz
    generator = stream(seed, stream_name(scenario, run, "reference"))
    position, velocity, angles, white = generator.standard_normal((4, driven.time.size, 3))
    position = driven.position + gauss_markov(position, *errors.position, dt)
    velocity = driven.velocity_n + gauss_markov(velocity, *errors.velocity, dt)
    tilt, yaw = gauss_markov(angles[:, :2], *errors.tilt, dt), gauss_markov(angles[:, 2:], *errors.yaw, dt)
    euler = driven.euler + np.hstack([tilt, yaw]) + errors.angle_noise * white
    acceleration, euler_rate = np.gradient(velocity, dt, axis=0), np.gradient(euler, dt, axis=0)
    return Reference(np.hstack([velocity, acceleration, euler_to_rate_n(euler, euler_rate), euler]), position)
