"""Reduced inertial sensor system (RISS): one vertical gyro, an odometer and accelerometers for the tilt of a road vehicle.

State ``[N E h | V_e V_n V_up | A | b | d]``: position north and east (m, in the plane of the origin) and height (m), velocity (m/s),
azimuth clockwise from north (rad, never wrapped), gyro bias (rad/s) and the error of the odometer. Body axes: x right, y forward,
z up; pitch is positive nose up, roll right side down; the gyro is positive counter-clockwise; accelerometers report specific force.

    A(t) = A(t-1) - (omega - b - omega_e sin(phi) - V_e tan(phi) / (R_N + h)) dt,   V_mech = V_od (sin A cos p, cos A cos p, sin p)

Three readings of what becomes of the velocity that a filter corrects:

TOTAL        V(t) = (V_od - d) (sin A cos p, cos A cos p, sin p), with d a speed error; F is the exact Jacobian
INCREMENTAL  V(t) = V(t-1) + V_mech(t) - V_mech(t-1) - d dt (...), with d an error of acceleration; a correction of V persists
MEMORYLESS   V(t) = V_mech(t): the next odometer reading overwrites a correction of V

The last two have the error model that ghouneem2024 prints, (2)-(6), for F. Positions are ``N' = V_n``, ``E' = V_e``, ``h' = V_up`` with
the new velocity; `geodetic` makes latitude and longitude of them. In two dimensions there is no accelerometer: the tilt is zero.

References
----------
.. [1] Noureldin, Karamat, Georgy 2013, Fundamentals of Inertial Navigation, Satellite-based Positioning and their Integration, ch. 9.
.. [2] ghouneem2024, equations (1)-(6).
"""

from typing import NamedTuple

import numpy as np

from robins.foundation.earth import EARTH_RATE, meridian_radius, transverse_radius
from robins.foundation.errors import InputError
from robins.foundation.smallmat import kernel
from robins.kalman.extension import implements
from robins.kalman.model import linearise, process_noise, propagate

NORTH, EAST, HEIGHT, V_EAST, V_NORTH, V_UP, AZIMUTH, GYRO_BIAS, ODOMETER = range(9)
STATES = 9
RATE, SPEED, ACCELERATION, SIN_PITCH, COS_PITCH, COS_ROLL, SPEED_BEFORE, SIN_PITCH_BEFORE, COS_PITCH_BEFORE = range(9)
"""Columns of the input: samples of the epoch that is predicted, then those of the one before."""
INPUTS = 9
TOTAL, INCREMENTAL, MEMORYLESS = range(3)
GRAVITY = 9.8055
"""m/s^2; only the tilt depends on it."""
PRINTED, LITERAL, CORRECTED, LEVEL = "printed", "literal", "corrected", "level"
TILTS = (PRINTED, LITERAL, CORRECTED, LEVEL)


class Riss(NamedTuple):
    """The mechanisation and its process noise.

    Attributes
    ----------
    loop : int
        `TOTAL`, `INCREMENTAL` or `MEMORYLESS`.
    turning : bool
        Whether the printed error model gets the terms of the turn that (3) leaves out.
    clockwise : float
        -1: a counter-clockwise rate lessens the azimuth; +1: as (1) prints it.
    dt : float
        s.
    latitude, meridian, transverse : float
        Of the origin: rad, ``R_M + h`` there, and ``R_N`` (m), to which a step adds its own height.
    bias_decay, odometer_decay : float
        ``exp(-dt/tau)`` of the two Gauss-Markov states.
    noise : ndarray, shape (9,)
        Variances that a step adds.
    """

    loop: int
    turning: bool
    clockwise: float
    dt: float
    latitude: float
    meridian: float
    transverse: float
    bias_decay: float
    odometer_decay: float
    noise: np.ndarray


def riss(
    loop: int, dt: float, latitude: float, height: float, noise, bias_time: float, odometer_time: float,
    turning: bool = False, clockwise: float = -1.0,
) -> Riss:  # fmt: skip
    """A `Riss` whose origin lies at `latitude` (rad) and `height` (m), with time constants (s) of gyro bias and odometer error.

    Raises
    ------
    ValueError
        A step or time constant is not positive, a variance is negative, or something is not finite.
    """
    noise = np.array(noise, float)
    for name, value in (("dt", dt), ("bias_time", bias_time), ("odometer_time", odometer_time)):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name}: found {value}, expected a positive number of seconds")
    if not abs(latitude) < np.pi / 2:
        raise ValueError(f"latitude: found {latitude}, expected radians between the poles")
    if noise.shape != (STATES,) or not (np.isfinite(noise).all() and (noise >= 0.0).all()):
        raise ValueError(f"noise: found {noise}, expected {STATES} variances, none of them negative")
    radii = float(meridian_radius(latitude)) + height, float(transverse_radius(latitude))
    decays = float(np.exp(-dt / bias_time)), float(np.exp(-dt / odometer_time))
    return Riss(loop, turning, clockwise, dt, latitude, *radii, *decays, noise)


def tilt(mode: str, force: np.ndarray, speed: np.ndarray, acceleration: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pitch and roll from specific force, rad, each (N,).

    Parameters
    ----------
    mode : {"printed", "literal", "corrected", "level"}
        ``printed``: (1) with the accelerometers' sign mended and the vehicle's own acceleration left in; ``literal``: the printed
        sign; ``corrected``: without the vehicle's acceleration [1]_; ``level``: two dimensions.
    force : ndarray, shape (N, 3)
        m/s^2.
    speed, acceleration, rate : ndarray, shape (N,)
        Of the odometer (m/s, m/s^2) and of the gyro (rad/s).
    """
    if mode not in TILTS:
        raise ValueError(f"mode: found {mode!r}, expected one of {', '.join(TILTS)}")
    fx, fy, fz = force.T
    if mode == LEVEL:
        return np.zeros(len(force)), np.zeros(len(force))
    if mode == CORRECTED:
        pitch = np.arcsin(np.clip((fy - acceleration) / GRAVITY, -1.0, 1.0))
        return pitch, -np.arcsin(np.clip((fx + speed * rate) / (GRAVITY * np.cos(pitch)), -1.0, 1.0))
    sign = 1.0 if mode == PRINTED else -1.0
    pitch = np.arctan(sign * fy / np.hypot(fx, fz))  # (1) ghouneem2024
    return pitch, np.arctan(-fx / fz)  # (1) ghouneem2024


def require_regular(name: str, time: np.ndarray, dt: float) -> None:
    """Refuse a record ``(N,)`` whose time (s) does not go on by `dt` from row to row: the mechanisation has no other step.

    Raises
    ------
    InputError
        Naming the row after a gap, a repetition or a step back.
    """
    step = np.diff(time)
    wrong = np.flatnonzero(~(np.abs(step - dt) < 1e-3 * dt))
    if wrong.size:
        row = int(wrong[0]) + 1
        raise InputError(name, f"time, row {row}", f"{step[wrong[0]]:g} s after the row before", f"{dt:g} s: no gap, no step back")


def inputs(rate: np.ndarray, speed: np.ndarray, acceleration: np.ndarray, pitch: np.ndarray, roll: np.ndarray) -> np.ndarray:
    """The input ``(N, 9)`` of samples ``(N,)``; row k holds the epoch k+1 that it predicts, the last row is never used."""
    sine, cosine = np.sin(pitch), np.cos(pitch)
    u = np.zeros((rate.size, INPUTS))
    for column, values in enumerate((rate, speed, acceleration, sine, cosine, np.cos(roll))):
        u[:-1, column] = values[1:]
    u[:-1, SPEED_BEFORE], u[:-1, SIN_PITCH_BEFORE], u[:-1, COS_PITCH_BEFORE] = speed[:-1], sine[:-1], cosine[:-1]
    return u


def geodetic(position: np.ndarray, latitude: float, longitude: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Latitude and longitude, rad, of plane positions ``(..., 2 or more)`` [N, E] about an origin."""
    north, east = position[..., 0], position[..., 1]
    across = (transverse_radius(latitude) + height) * np.cos(latitude)
    return latitude + north / (meridian_radius(latitude) + height), longitude + east / across


@kernel
def turn_rate(model, x, u):
    """The bracket of (1), rad/s: the gyro's rate without its bias, the earth's and the transport rate."""
    latitude = model.latitude + x[NORTH] / model.meridian
    transport = x[V_EAST] * np.tan(latitude) / (model.transverse + x[HEIGHT])
    return u[RATE] - x[GYRO_BIAS] - EARTH_RATE * np.sin(latitude) - transport


@implements(propagate, Riss)
@kernel
def propagate_riss(model, x, u):
    """One step of (1) in the order that it needs: azimuth, velocity, position."""
    before = x[AZIMUTH]
    x[AZIMUTH] += model.clockwise * turn_rate(model, x, u) * model.dt  # (1) ghouneem2024
    sine, cosine = np.sin(x[AZIMUTH]), np.cos(x[AZIMUTH])
    if model.loop == INCREMENTAL:
        gained = u[SPEED] - x[ODOMETER] * model.dt
        level = gained * u[COS_PITCH]
        level_before = u[SPEED_BEFORE] * u[COS_PITCH_BEFORE]
        x[V_EAST] += level * sine - level_before * np.sin(before)
        x[V_NORTH] += level * cosine - level_before * np.cos(before)
        x[V_UP] += gained * u[SIN_PITCH] - u[SPEED_BEFORE] * u[SIN_PITCH_BEFORE]
    else:
        speed = u[SPEED] - x[ODOMETER] if model.loop == TOTAL else u[SPEED]
        x[V_EAST] = speed * sine * u[COS_PITCH]  # (1) ghouneem2024
        x[V_NORTH] = speed * cosine * u[COS_PITCH]
        x[V_UP] = speed * u[SIN_PITCH]
    x[NORTH] += x[V_NORTH] * model.dt  # (1) ghouneem2024
    x[EAST] += x[V_EAST] * model.dt
    x[HEIGHT] += x[V_UP] * model.dt
    x[GYRO_BIAS] *= model.bias_decay
    x[ODOMETER] *= model.odometer_decay


@implements(process_noise, Riss)
@kernel
def process_noise_riss(model, x, u, Q):
    """The variances of a step on the diagonal."""
    for i in range(STATES):
        for j in range(STATES):
            Q[i, j] = 0.0
        Q[i, i] = model.noise[i]


@implements(linearise, Riss)
@kernel
def linearise_riss(model, x, u, F, Q):
    """The exact Jacobian of a step (TOTAL), or ``I + F dt`` of the printed error model."""
    process_noise_riss(model, x, u, Q)
    for i in range(STATES):
        for j in range(STATES):
            F[i, j] = 0.0
        F[i, i] = 1.0
    F[GYRO_BIAS, GYRO_BIAS] = model.bias_decay  # (6) ghouneem2024
    F[ODOMETER, ODOMETER] = model.odometer_decay  # (5) ghouneem2024
    if model.loop == TOTAL:
        exact_jacobian(model, x, u, F)
    else:
        printed_jacobian(model, x, u, F)


@kernel
def exact_jacobian(model, x, u, F):
    """Derivatives of azimuth, velocity and position after a TOTAL step; the rest of `F` is that of unit and decays."""
    latitude, radius = model.latitude + x[NORTH] / model.meridian, model.transverse + x[HEIGHT]
    sine_latitude, cosine_latitude = np.sin(latitude), np.cos(latitude)
    tangent = sine_latitude / cosine_latitude
    turned = model.clockwise * model.dt
    azimuth = x[AZIMUTH] + turned * turn_rate(model, x, u)
    F[AZIMUTH, NORTH] = -turned * (EARTH_RATE * cosine_latitude + x[V_EAST] / (radius * cosine_latitude**2)) / model.meridian
    F[AZIMUTH, HEIGHT] = turned * x[V_EAST] * tangent / radius**2
    F[AZIMUTH, V_EAST] = -turned * tangent / radius
    F[AZIMUTH, GYRO_BIAS] = -turned
    speed = u[SPEED] - x[ODOMETER]
    sine, cosine = np.sin(azimuth), np.cos(azimuth)
    east, north = speed * cosine * u[COS_PITCH], -speed * sine * u[COS_PITCH]  # per radian
    for j in range(STATES):
        F[V_EAST, j] = east * F[AZIMUTH, j]
        F[V_NORTH, j] = north * F[AZIMUTH, j]
        F[V_UP, j] = 0.0
    F[V_EAST, ODOMETER] = -sine * u[COS_PITCH]
    F[V_NORTH, ODOMETER] = -cosine * u[COS_PITCH]
    F[V_UP, ODOMETER] = -u[SIN_PITCH]
    for j in range(STATES):
        F[NORTH, j] += model.dt * F[V_NORTH, j]
        F[EAST, j] += model.dt * F[V_EAST, j]
        F[HEIGHT, j] += model.dt * F[V_UP, j]


@kernel
def printed_jacobian(model, x, u, F):
    """Off-diagonal elements of ``I + F dt`` for (2)-(4); the signs are those of a clockwise azimuth and of states, not errors."""
    dt = model.dt
    F[NORTH, V_NORTH] = F[EAST, V_EAST] = F[HEIGHT, V_UP] = dt  # (2) ghouneem2024
    sine, cosine = np.sin(x[AZIMUTH]) * u[COS_PITCH], np.cos(x[AZIMUTH]) * u[COS_PITCH]
    F[V_EAST, AZIMUTH] = u[ACCELERATION] * cosine * dt  # (3) ghouneem2024
    F[V_NORTH, AZIMUTH] = -u[ACCELERATION] * sine * dt
    F[V_EAST, ODOMETER] = -sine * dt
    F[V_NORTH, ODOMETER] = -cosine * dt
    F[V_UP, ODOMETER] = -u[SIN_PITCH] * dt
    F[AZIMUTH, GYRO_BIAS] = -model.clockwise * u[COS_PITCH] * u[COS_ROLL] * dt  # (4) ghouneem2024
    if model.turning:
        rate = model.clockwise * turn_rate(model, x, u)
        F[V_EAST, AZIMUTH] -= u[SPEED] * sine * rate * dt
        F[V_NORTH, AZIMUTH] -= u[SPEED] * cosine * rate * dt
        F[V_EAST, GYRO_BIAS] -= model.clockwise * u[SPEED] * cosine * dt
        F[V_NORTH, GYRO_BIAS] += model.clockwise * u[SPEED] * sine * dt
