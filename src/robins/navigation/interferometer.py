"""What a light-pulse atom interferometer measures: a phase, from acceleration and from rotation.

Three pulses, pi/2 - pi - pi/2, `T_pi` apart, split, turn and recombine a cloud of atoms; the whole interrogation takes ``T = 2 T_pi``.
The phase at the output is ``phi(0) - 2 phi(T_pi) + phi(2 T_pi)`` with ``phi(t) = k_eff . x(t)`` the phase of the light where the atoms
are: a second difference of their position against the instrument.

References
----------
.. [1] Peters, Chung and Chu 2001, High-precision gravity measurements using atom interferometry, Metrologia 38.
.. [2] Gustavson, Bouyer and Kasevich 1997, Precision rotation measurements with an atom interferometer gyroscope, PRL 78.
"""

import numpy as np
from scipy.constants import h


def acceleration_phase(k_eff: np.ndarray, acceleration: np.ndarray, pulse_separation: float) -> np.ndarray:
    """Phase (rad) of an accelerated Mach-Zehnder interferometer: exact for a constant acceleration and short pulses ([1]_).

    Parameters
    ----------
    k_eff : ndarray, shape (3,)
        Effective wave vector of the light (rad/m).
    acceleration : ndarray, shape (..., 3)
        Of the atoms against the instrument (m/s^2).
    pulse_separation : float
        `T_pi`, from one pulse to the next (s).

    Returns
    -------
    ndarray, shape (...)
    """
    return acceleration @ k_eff * pulse_separation**2  # (1) imani2026


def de_broglie_wavelength(mass: float, speed: float) -> float:
    """``h / (m v)`` (m) of a particle of the given `mass` (kg) and `speed` (m/s)."""
    return h / (mass * speed)


def sagnac_phase(area: np.ndarray, rate: np.ndarray, wavelength: float, speed: float) -> np.ndarray:
    """Phase (rad) of an interferometer that encloses an area and turns.

    Parameters
    ----------
    area : ndarray, shape (3,)
        Enclosed area along its normal (m^2).
    rate : ndarray, shape (..., 3)
        Angular rate of the instrument against inertial space (rad/s).
    wavelength, speed : float
        Of the wave: the de Broglie wavelength (m) of atoms and their speed (m/s), which makes it ``2 m A . Omega / hbar`` ([2]_).

    Returns
    -------
    ndarray, shape (...)
    """
    return 4.0 * np.pi * (rate @ area) / (wavelength * speed)  # (2) imani2026


def interferometer_phase(
    k_eff: np.ndarray, acceleration: np.ndarray, rate: np.ndarray, velocity: np.ndarray, interrogation_time: float
) -> np.ndarray:
    """Phase (rad) of an interferometer that is accelerated and turns, to first order in the rotation.

    Parameters
    ----------
    k_eff, acceleration : ndarray
        As in `acceleration_phase`.
    rate : ndarray, shape (..., 3)
        Angular rate omega (rad/s) in ``omega x v``: of inertial space against the instrument. An instrument that turns by Omega has
        ``omega = -Omega``, for its atoms have the Coriolis acceleration ``-2 Omega x v``.
    velocity : ndarray, shape (..., 3)
        Of the atoms (m/s).
    interrogation_time : float
        ``T = 2 T_pi``, from the first pulse to the last (s). The paper's text has the time between pulses, with which the
        factors 1/4 and 1/2 are wrong by four.

    Returns
    -------
    ndarray, shape (...)
    """
    both = 0.25 * acceleration + 0.5 * np.cross(rate, velocity)
    return both @ k_eff * interrogation_time**2  # (6) imani2026
