"""The earth as WGS-84 has it: ellipsoid, rotation rate, radii of curvature and normal gravity.

Frame ``n`` is east-north-up. Latitude is geodetic, in radians; height is above the ellipsoid, in metres. The
functions of a latitude and a height are compiled and take numbers, or arrays of one shape.

References
----------
.. [1] NIMA TR8350.2, Department of Defense World Geodetic System 1984, 3rd edition, amendment 1 (2000), chapters 3, 4.
.. [2] Heiskanen and Moritz, Physical Geodesy (1967), chapter 2.
"""

import math

import numpy as np
from numba import njit

SEMI_MAJOR_AXIS = 6378137.0
"""a [m], defining ([1]_, table 3.1)."""

FLATTENING = 1.0 / 298.257223563
"""f, defining ([1]_, table 3.1)."""

GRAVITATIONAL_CONSTANT = 3.986004418e14
"""GM of the earth with its atmosphere [m^3/s^2], defining ([1]_, table 3.1)."""

EARTH_RATE = 7.292115e-5
"""Rotation rate of the earth [rad/s], defining ([1]_, table 3.1)."""

SEMI_MINOR_AXIS = SEMI_MAJOR_AXIS * (1.0 - FLATTENING)
"""b [m]."""

ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)
"""First eccentricity squared."""

GRAVITY_EQUATOR = 9.7803253359
"""Normal gravity on the ellipsoid at the equator [m/s^2] ([1]_, table 3.4)."""

GRAVITY_POLE = 9.8321849378
"""Normal gravity on the ellipsoid at the poles [m/s^2] ([1]_, table 3.4)."""

SOMIGLIANA = SEMI_MINOR_AXIS * GRAVITY_POLE / (SEMI_MAJOR_AXIS * GRAVITY_EQUATOR) - 1.0
"""k of Somigliana's formula ([1]_, eq. 4-1)."""

GRAVITY_RATIO = EARTH_RATE**2 * SEMI_MAJOR_AXIS**2 * SEMI_MINOR_AXIS / GRAVITATIONAL_CONSTANT
"""m = omega^2 a^2 b / GM, centrifugal over gravitational acceleration ([1]_, eq. 4-4)."""


@njit(cache=True)
def meridian_radius(latitude):
    """Radius of curvature of the meridian [m], ``a (1 - e^2) / (1 - e^2 sin^2 latitude)^(3/2)``."""
    return SEMI_MAJOR_AXIS * (1.0 - ECCENTRICITY_SQUARED) / (1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2) ** 1.5


@njit(cache=True)
def transverse_radius(latitude):
    """Radius of curvature across the meridian (of the prime vertical) [m], ``a / sqrt(1 - e^2 sin^2 latitude)``."""
    return SEMI_MAJOR_AXIS / np.sqrt(1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)


@njit(cache=True)
def normal_gravity(latitude, height):
    """Magnitude of normal gravity [m/s^2] at `latitude` [rad] and `height` [m].

    Somigliana's closed formula on the ellipsoid ([1]_, eq. 4-1), continued upwards by the second-order expansion in
    the height ([1]_, eq. 4-3; [2]_, eq. 2-124), which is within 1e-6 m/s^2 of the exact normal field up to 10 km.
    """
    sine_squared = np.sin(latitude) ** 2
    surface = GRAVITY_EQUATOR * (1.0 + SOMIGLIANA * sine_squared) / np.sqrt(1.0 - ECCENTRICITY_SQUARED * sine_squared)
    relative_height = height / SEMI_MAJOR_AXIS
    linear = 2.0 * (1.0 + FLATTENING + GRAVITY_RATIO - 2.0 * FLATTENING * sine_squared)
    return surface * (1.0 - linear * relative_height + 3.0 * relative_height**2)


@njit(cache=True)
def earth_rate_n(latitude):
    """Rotation rate of the earth against inertial space in east-north-up [rad/s], shape (3,), at one latitude [rad]."""
    return np.array([0.0, EARTH_RATE * math.cos(latitude), EARTH_RATE * math.sin(latitude)])
