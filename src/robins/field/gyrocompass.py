"""North from an inertial unit at rest: level with the specific force, then project the earth's rotation.

Frames: ``b`` is right-forward-up, ``n`` east-north-up. At rest, and without sensor errors, a unit senses

    specific force   f = -gravity = g up
    angular rate     w = omega (cos(latitude) north + sin(latitude) up)

so, with every vector in ``b``,

    up    = f / |f|
    north = (w - (w . up) up) / |w - (w . up) up|
    east  = north x up

and the heading of the forward axis y, clockwise from north, is atan2(y . east, y . north). An error of the rate along
east of d turns the heading by d / (omega cos(latitude)); a bias along north or up does not turn it, to first order.

References
----------
.. [1] Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd edition (2013), section 5.6.2.
"""

from typing import NamedTuple

import numpy as np

FORWARD_B = np.array([0.0, 1.0, 0.0])


class Alignment(NamedTuple):
    """What a unit at rest senses of the earth.

    Attributes
    ----------
    specific_force : float
        Magnitude of the mean specific force [m/s^2].
    up_rate, horizontal_rate : float
        Components of the mean angular rate along up (signed) and across it [rad/s].
    heading : float
        Heading of the forward axis, clockwise from north, in (-pi, pi] [rad].
    """

    specific_force: float
    up_rate: float
    horizontal_rate: float
    heading: float


def gyrocompass(rate_b, specific_force_b) -> Alignment:
    """Alignment of a unit at rest from its mean rate and mean specific force, see the module.

    Parameters
    ----------
    rate_b, specific_force_b : array, shape (N, 3)
        Angular rate against inertial space [rad/s] and specific force [m/s^2], right-forward-up. They are averaged
        before any length is taken: the length of a noisy vector is too long on average.
    """
    rate, force = np.mean(rate_b, axis=0), np.mean(specific_force_b, axis=0)
    magnitude = np.linalg.norm(force)
    up = force / magnitude
    up_rate = rate @ up
    horizontal = rate - up_rate * up
    horizontal_rate = np.linalg.norm(horizontal)
    north = horizontal / horizontal_rate
    east = np.cross(north, up)
    heading = np.arctan2(FORWARD_B @ east, FORWARD_B @ north)
    return Alignment(float(magnitude), float(up_rate), float(horizontal_rate), float(heading))
