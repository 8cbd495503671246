"""The drive through the campus (Figure 5 of the paper): what the car does and what perfect sensors would feel.

The paper gives the way points P1-P6 in words and pictures. Here speed along the road, heading and slope are C2 functions of
time, sums of quintic ramps, so that velocity, acceleration, attitude and rate are closed forms of time; three parameters that
the paper does not give are solved for so that the car ends where it started to within (3, 4, 0) m.

Frames: n east-north-up, local metres; b forward-left-up, ``C = Rz(yaw) Ry(pitch) Rx(roll)``, yaw counter-clockwise from east,
nose up is pitch < 0. Gravity is `GRAVITY` downwards, the latitude `LATITUDE` and the height zero throughout (the car moves by
some hundred metres). Epochs ``t_k = k / rate``; an interval average k belongs to ``(t_(k-1), t_k]``.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from robins.foundation import earth as wgs84
from robins.foundation.errors import InputError

KEY = "imani2026"
GRAVITY = 9.80
"""Magnitude of gravity [m/s^2]."""
LATITUDE = float(np.radians(38.06))
"""Latitude of Tabriz [rad]."""
DURATION = 330
"""Length of the record [s]."""
CELLS_HZ = 200
"""Cells of the quadrature per second; a sensor's interval is a whole number of them."""
WAY_POINT_TIMES = (0, 58, 108, 177, 233, 312)
"""When the car is at P1 to P6 [s]: start, corner, full turn at the library, far end of the slope, corner on the way back, stop."""
CHANNELS = ("v_e", "v_n", "v_u", "a_e", "a_n", "a_u", "w_e", "w_n", "w_u", "roll", "pitch", "yaw")
"""What is estimated and evaluated: velocity, acceleration, rate (all in n) and Euler angles."""


class Closure(NamedTuple):
    """Two speeds on the way back [m/s] and the slope of the descent [rad], positive: what closes the drive."""

    first_speed: float
    second_speed: float
    descent: float


class Route(NamedTuple):
    """Ramps of speed [m/s], heading [rad] and slope [rad]: rows of start [s], end [s] and the value reached."""

    speed: np.ndarray
    heading: np.ndarray
    slope: np.ndarray


class Motion(NamedTuple):
    """Closed forms at given times, each of shape (n, 3), in n or b as named; `rate_n` is that of b against n."""

    velocity_n: np.ndarray
    acceleration_n: np.ndarray
    rate_n: np.ndarray
    euler: np.ndarray
    specific_force_b: np.ndarray
    rate_b: np.ndarray


class Drive(NamedTuple):
    """The truth of one drive. SI units and radians; N = `DURATION` * `rate_hz`.

    Attributes
    ----------
    rate_hz : int
        Samples per second.
    time : ndarray, shape (N+1,)
    position, velocity_n, acceleration_n : ndarray, shape (N+1, 3)
        Local metres east, north, up, and their derivatives.
    rate_n : ndarray, shape (N+1, 3)
        Rate of b against n, in n.
    euler : ndarray, shape (N+1, 3)
        Roll, pitch and yaw, yaw not wrapped.
    quaternion : ndarray, shape (N+1, 4)
        (w, x, y, z), b to n, without jumps of sign.
    specific_force_b, rate_b : ndarray, shape (N+1, 3)
        What perfect accelerometers and gyroscopes feel at t_k: ``rate_b`` is against inertial space.
    specific_force_interval, rate_interval : ndarray, shape (N, 3)
        Averages of these two over the intervals: what perfect sensors put out.
    acceleration_n_interval, rate_n_interval : ndarray, shape (N, 3)
        Averages of `acceleration_n` and `rate_n`.
    """

    rate_hz: int
    time: np.ndarray
    position: np.ndarray
    velocity_n: np.ndarray
    acceleration_n: np.ndarray
    rate_n: np.ndarray
    euler: np.ndarray
    quaternion: np.ndarray
    specific_force_b: np.ndarray
    rate_b: np.ndarray
    specific_force_interval: np.ndarray
    rate_interval: np.ndarray
    acceleration_n_interval: np.ndarray
    rate_n_interval: np.ndarray


def route(closure: Closure, reversing: bool = False) -> Route:
    """The ramps of the whole drive.

    The paper says that the car "reversed along the same path". Read as: it turns round at P4 and drives back. With
    `reversing` it stops at P4 instead and comes back in reverse gear: speed and slope have the other sign, heading is half a
    turn less.
    """
    sign, half_turn, turning_speed = (-1.0, 180.0, 0.0) if reversing else (1.0, 0.0, 2.5)
    first, second, descent = closure
    speed = [(20, 28, 8), (48, 54, 4), (61, 68, 8), (90, 96, 4), (118, 124, 7), (166, 172, turning_speed)]
    speed += [(183, 189, sign * 7), (228, 233, sign * 4), (239, 245, sign * first), (266, 272, sign * 4)]
    speed += [(281, 287, sign * second), (303, 312, 0)]
    heading = [(54, 62, 90), (97, 118, 390), (172, 182, 570 - half_turn), (233, 239, 630 - half_turn), (272, 280, 540 - half_turn)]
    slope = [(60, 66, 1.5), (90, 95, 0), (124, 130, 5), (160, 166, 0)]
    slope += [(186, 192, -sign * np.degrees(descent)), (222, 228, 0), (245, 250, -sign * 1.5), (262, 266, 0)]
    in_radians = np.array([1.0, 1.0, np.pi / 180.0])
    return Route(np.array(speed, float), np.array(heading, float) * in_radians, np.array(slope, float) * in_radians)


def profile(ramps: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Value, first and second derivative, shape (3, n), of a function that starts at 0 and climbs `ramps` in turn.

    A ramp is the quintic with vanishing first and second derivatives at both ends. `time` ascends; no ramps overlap.
    """
    out = np.zeros((3, time.size))
    before = 0.0
    for start, end, after in ramps:
        first, last = np.searchsorted(time, (start, end))
        length, step = end - start, after - before
        s = (time[first:last] - start) / length
        out[0, first:last] = before + step * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
        out[1, first:last] = step / length * 30.0 * (s * (1.0 - s)) ** 2
        out[2, first:last] = step / length**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)
        out[0, last:] = before = after
    return out


def course(way: Route, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and acceleration in n, shape (n, 3) each."""
    speed, pull, _ = profile(way.speed, time)
    heading, turn, _ = profile(way.heading, time)
    slope, bend, _ = profile(way.slope, time)
    east, north, level, climb = np.cos(heading), np.sin(heading), np.cos(slope), np.sin(slope)
    forward = np.stack([level * east, level * north, climb], axis=1)
    left = np.stack([-level * north, level * east, np.zeros_like(east)], axis=1)
    upward = np.stack([-climb * east, -climb * north, level], axis=1)
    velocity = speed[:, None] * forward
    return velocity, pull[:, None] * forward + (speed * turn)[:, None] * left + (speed * bend)[:, None] * upward


def euler_to_rate_n(euler: np.ndarray, euler_rate: np.ndarray) -> np.ndarray:
    """Rate of b against n, in n, from Euler angles and their derivatives, shape (n, 3) each.

    Yaw turns about up, pitch about the level axis of the turned frame, roll about the body's forward axis.
    """
    _, pitch, yaw = euler.T
    zero, one = np.zeros_like(yaw), np.ones_like(yaw)
    forward = np.stack([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)], axis=1)
    level = np.stack([-np.sin(yaw), np.cos(yaw), zero], axis=1)
    up = np.stack([zero, zero, one], axis=1)
    return euler_rate[:, :1] * forward + euler_rate[:, 1:2] * level + euler_rate[:, 2:] * up


def attitude(way: Route, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Euler angles and their derivatives, shape (n, 3) each: the car leans out of curves and squats when it pulls."""
    speed, pull, pull_rate = profile(way.speed, time)
    heading, turn, turn_rate = profile(way.heading, time)
    slope, bend, _ = profile(way.slope, time)
    euler = np.stack([0.02 * speed * turn, -slope - 0.012 * pull, heading], axis=1)
    return euler, np.stack([0.02 * (pull * turn + speed * turn_rate), -bend - 0.012 * pull_rate, turn], axis=1)


def earth_and_transport_rate(velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rate of the earth (3,) and rate of n against the earth at these velocities (n, 3), in n."""
    meridian, transverse = wgs84.meridian_radius(LATITUDE), wgs84.transverse_radius(LATITUDE)
    east, north = velocity[:, 0], velocity[:, 1]
    transport = np.stack([-north / meridian, east / transverse, east * np.tan(LATITUDE) / transverse], axis=1)
    return wgs84.earth_rate_n(LATITUDE), transport


def motion(way: Route, time: np.ndarray, earth: bool = True) -> Motion:
    """Everything at given times; without `earth` the earth neither turns nor is it round."""
    velocity, acceleration = course(way, time)
    euler, euler_rate = attitude(way, time)
    rate_n = euler_to_rate_n(euler, euler_rate)
    force_n, inertial_rate_n = acceleration + np.array([0.0, 0.0, GRAVITY]), rate_n
    if earth:
        of_earth, transport = earth_and_transport_rate(velocity)
        force_n = force_n + np.cross(2.0 * of_earth + transport, velocity)
        inertial_rate_n = rate_n + of_earth + transport
    to_body = Rotation.from_euler("ZYX", euler[:, ::-1]).inv()
    return Motion(velocity, acceleration, rate_n, euler, to_body.apply(force_n), to_body.apply(inertial_rate_n))


def quadrature(cells_hz: int, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes in all cells of the drive, shape (cells * points,), and the weights of one cell (they sum to 1)."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    times = (np.arange(DURATION * cells_hz)[:, None] + 0.5 * (1.0 + nodes)) / cells_hz
    return times.ravel(), 0.5 * weights


@cache
def solve_closure(reversing: bool = False) -> Closure:
    """The three parameters with which the drive ends at (3, 4, 0) m."""
    times, weights = quadrature(cells_hz=4, points=8)
    weights = np.tile(weights / 4, DURATION * 4)

    def miss(parameters):
        return weights @ course(route(Closure(*parameters), reversing), times)[0] - (3.0, 4.0, 0.0)

    found = root(miss, (9.0, 9.5, np.radians(5.5)), tol=1e-12)
    if not found.success:
        raise ArithmeticError(f"the drive does not close: {found.message}")
    return Closure(*map(float, found.x))


def quaternions(euler: np.ndarray) -> np.ndarray:
    """(w, x, y, z) of Euler angles, shape (n, 4), from half angles: continuous where yaw is."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(0.5 * euler.T), np.sin(0.5 * euler.T)
    real, x = cx * cy * cz + sx * sy * sz, sx * cy * cz - cx * sy * sz
    return np.stack([real, x, cx * sy * cz + sx * cy * sz, cx * cy * sz - sx * sy * cz], axis=1)


def drive(rate_hz: int, reversing: bool = False, earth: bool = True) -> Drive:
    """The truth at `rate_hz` samples per second.

    Averages and positions are integrals of the closed forms by Gauss-Legendre quadrature with two points in each cell of 5
    ms. No ramp begins inside a cell, so the error is of fourth order: 1e-12 in every unit.

    Parameters
    ----------
    rate_hz : int
    reversing : bool
        See `route`.
    earth : bool
        Whether the sensors feel the earth's rate, the transport rate and Coriolis acceleration.

    Raises
    ------
    InputError
        The intervals are no whole number of cells.
    """
    if rate_hz not in range(1, CELLS_HZ + 1) or CELLS_HZ % rate_hz != 0:
        raise InputError("config", f"options.{KEY}.rate_hz", repr(rate_hz), f"a whole number that divides {CELLS_HZ}")
    rate_hz = int(rate_hz)
    way = route(solve_closure(reversing), reversing)
    epochs = DURATION * rate_hz
    times, weights = quadrature(CELLS_HZ, points=2)
    inside = motion(way, times, earth)

    def averages(values):
        return np.einsum("ecpi,p->ei", values.reshape(epochs, CELLS_HZ // rate_hz, weights.size, 3), weights) * (rate_hz / CELLS_HZ)

    time = np.arange(epochs + 1) / rate_hz
    at_epochs = motion(way, time, earth)
    position = np.concatenate([np.zeros((1, 3)), np.cumsum(averages(inside.velocity_n) / rate_hz, axis=0)])
    return Drive(
        rate_hz,
        time,
        position,
        quaternion=quaternions(at_epochs.euler),
        specific_force_interval=averages(inside.specific_force_b),
        rate_interval=averages(inside.rate_b),
        acceleration_n_interval=averages(inside.acceleration_n),
        rate_n_interval=averages(inside.rate_n),
        **at_epochs._asdict(),
    )


def truth(driven: Drive) -> np.ndarray:
    """`CHANNELS` at the epochs, shape (N+1, 12)."""
    return np.hstack([driven.velocity_n, driven.acceleration_n, driven.rate_n, driven.euler])


def truth_interval(driven: Drive) -> np.ndarray:
    """As `truth`, but acceleration and rate averaged over the interval that ends at the epoch; epoch 0 has epoch 1's."""
    channels = truth(driven)
    channels[1:, 3:9] = np.hstack([driven.acceleration_n_interval, driven.rate_n_interval])
    channels[0, 3:9] = channels[1, 3:9]
    return channels
