"""The two drives of the wing: an arterial road in the suburbs ("t1") and a dense city ("t2"), one fixed random truth each.

The paper's recordings are not public. These drives are a design: the vehicle goes through segments of a target speed and a length,
some of which end with a stop, some with a turn. The draws do not depend on the configuration's seed, so that every ensemble drives
the same roads.

Frames: local level ENU about the origin; body x right, y forward, z up; specific force; pitch nose-up +, roll right-side-down +;
azimuth clockwise from north; gyroscope z-up, counter-clockwise +. The ENU metres are a map: their derivatives are the velocities,
and latitude is origin + north / (meridian radius + height), both taken at the origin, like the radii in the transport rate.

The rate about z is (-A' + up component of earth and transport rate) cos p cos r + p' sin r. The horizontal components, times the
tilt, are left out (3e-6 rad/s at most). The last term stands with a minus in the study's brief; with roll right-side-down it is a plus.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from robins.foundation import earth
from robins.foundation.errors import InputError
from robins.foundation.randomness import stream

KEY = "ghouneem2024"
DEGREE = float(np.pi / 180.0)
RATE_HZ = 20
"""Epochs per second of the truth and of the inertial sensors."""
TRAJECTORIES = ("t1", "t2")
GRAVITY = 9.8055
"""Magnitude of gravity [m/s^2]."""
START_HEIGHT = 100.0
"""Height of the origin above the ellipsoid [m]."""
TRUTH_SEED = 0
"""Seed of the truth in place of the configuration's."""
STANDING_SECONDS = (60, 10)
"""How long the vehicle stands at the beginning and, at least, at the end [s]."""
LAST_BRAKING = 1.6
"""Deceleration of the last stop [m/s^2]."""
SMOOTHING = 13
"""Epochs of the Hann window that smooths speed."""
LANE_TIME, LANE_DIFFUSION, LANE_LIMIT = 8.0, 6e-4, 0.004
"""Curvature within the lane: Ornstein-Uhlenbeck time [s], diffusion [1/m/sqrt(s)], limit [1/m]."""
GRADE_WAVES, GRADE_WAVELENGTH, GRADE_AMPLITUDE = 12, (300.0, 2500.0), (0.5, 1.5)
"""Sinusoids of the grade: their number, bounds of their wavelengths [m] and of their amplitudes before scaling to the rms."""


class Plan(NamedTuple):
    """What distinguishes the drives. Pairs are bounds of uniform laws.

    Attributes
    ----------
    truth_number : int
        Run in the name of the truth's stream: the first from the brief's seed (101, 202) upwards whose drive is within 10 % of
        `distance`, which both seeds are themselves. Chosen before any filter ran.
    latitude, azimuth : float
        Of the start, rad.
    seconds : int
    distance : float
        What the drive has to come near to, m.
    target_speeds : tuple of float
        Of a segment before a factor U(0.9, 1.05), m/s.
    segment_length : tuple of float
        m
    stop_probability, turn_probability : float
        At the end of a segment.
    turns : tuple of float
        Angles, equally probable, before a factor U(0.92, 1.08), rad.
    grade_rms : float
    """

    truth_number: int
    latitude: float
    azimuth: float
    seconds: int
    distance: float
    target_speeds: tuple[float, ...]
    segment_length: tuple[float, float]
    stop_probability: float
    turn_probability: float
    turns: tuple[float, ...]
    grade_rms: float


PLANS = {
    "t1": Plan(
        truth_number=101, latitude=44.23 * DEGREE, azimuth=40.0 * DEGREE, seconds=1800, distance=22_400.0,
        target_speeds=(14.0, 17.0, 22.0, 25.0), segment_length=(200.0, 1400.0), stop_probability=0.35, turn_probability=0.6,
        turns=tuple(angle * DEGREE for angle in (90.0, -90.0, 45.0, -45.0, 30.0, -30.0)), grade_rms=0.022,
    ),
    "t2": Plan(
        truth_number=202, latitude=51.05 * DEGREE, azimuth=350.0 * DEGREE, seconds=1500, distance=9_900.0,
        target_speeds=(9.0, 11.0, 14.0), segment_length=(90.0, 420.0), stop_probability=0.55, turn_probability=0.75,
        turns=tuple(angle * DEGREE for angle in (90.0, -90.0, 90.0, -90.0, 60.0, -60.0)), grade_rms=0.028,
    ),
}  # fmt: skip


class Segment(NamedTuple):
    """One stretch of road. SI units; `turn` [rad, clockwise] is 0 and `stop` is 0 where there is none."""

    target: float
    length: float
    acceleration: float
    braking: float
    stop: float
    turn: float
    turn_speed: float
    turn_radius: float


class Trajectory(NamedTuple):
    """The truth of one drive at `RATE_HZ`; N = 20 times its length in seconds. Shared by all callers: not to be written to.

    Attributes
    ----------
    name : str
    latitude : float
        Of the origin, rad.
    time : ndarray, shape (N+1,)
        s
    position : ndarray, shape (N+1, 3)
        North and east of the origin and height above the ellipsoid, m: the trapezoidal integral of `velocity`.
    velocity : ndarray, shape (N+1, 3)
        East, north, up, m/s.
    azimuth, pitch, roll : ndarray, shape (N+1,)
        rad; azimuth is not wrapped.
    speed, acceleration : ndarray, shape (N+1,)
        Along the road, m/s and m/s^2; acceleration is the central difference of speed.
    force : ndarray, shape (N+1, 3)
        Specific force right, forward, up, m/s^2.
    rate : ndarray, shape (N+1,)
        Rate about z against inertial space, rad/s.
    """

    name: str
    latitude: float
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    azimuth: np.ndarray
    pitch: np.ndarray
    roll: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    force: np.ndarray
    rate: np.ndarray


@cache
def trajectory(name: str) -> Trajectory:
    """The drive called `name`.

    Raises
    ------
    InputError
        No such drive.
    """
    if name not in PLANS:
        raise InputError(KEY, "trajectory", repr(name), " or ".join(map(repr, TRAJECTORIES)))
    return drive(name, PLANS[name])


def drive(name: str, plan: Plan) -> Trajectory:
    """The truth that `plan` and its truth number make."""
    generator = stream(TRUTH_SEED, f"{KEY}/{name}/{plan.truth_number}/truth")
    epochs = plan.seconds * RATE_HZ
    commanded, turn_rate = follow(plan, draw_segments(generator, plan), epochs)
    speed = smooth(commanded)
    azimuth_rate = turn_rate + speed * draw_lane_curvature(generator, epochs)
    azimuth = plan.azimuth + integrate(azimuth_rate)
    distance = integrate(speed)
    pitch, pitch_rate = draw_grade(generator, plan.grade_rms, distance, speed)
    roll = crossfall(distance)
    level = speed * np.cos(pitch)
    velocity = np.stack([level * np.sin(azimuth), level * np.cos(azimuth), speed * np.sin(pitch)], axis=1)
    position = integrate(velocity[:, [1, 0, 2]]) + (0.0, 0.0, START_HEIGHT)
    acceleration = np.gradient(speed, 1.0 / RATE_HZ)
    force = specific_force(speed, acceleration, azimuth_rate, pitch, roll)
    vertical = inertial_rate_up(plan.latitude, position[:, 0], velocity[:, 0]) - azimuth_rate
    rate = vertical * np.cos(pitch) * np.cos(roll) + pitch_rate * np.sin(roll)
    time = np.arange(epochs + 1) / RATE_HZ
    return Trajectory(name, plan.latitude, time, position, velocity, azimuth, pitch, roll, speed, acceleration, force, rate)


def draw_segments(generator: np.random.Generator, plan: Plan) -> list[Segment]:
    """More segments than the drive has time for."""
    fastest, shortest = 1.05 * max(plan.target_speeds), plan.segment_length[0]
    n = int(np.ceil(plan.seconds * fastest / shortest))
    uniform = generator.uniform
    target = generator.choice(plan.target_speeds, n) * uniform(0.9, 1.05, n)
    length = uniform(*plan.segment_length, n)
    acceleration, braking = 1.3 * uniform(0.7, 1.2, n), 1.6 * uniform(0.7, 1.2, n)
    stop = np.where(uniform(size=n) < plan.stop_probability, uniform(5.0, 40.0, n), 0.0)
    angle = generator.choice(plan.turns, n) * uniform(0.92, 1.08, n)
    turn = np.where(uniform(size=n) < plan.turn_probability, angle, 0.0)
    turn_speed, turn_radius = uniform(5.0, 7.0, n), uniform(12.0, 18.0, n)
    columns = (target, length, acceleration, braking, stop, turn, turn_speed, turn_radius)
    return [Segment(*row) for row in np.stack(columns, axis=1).tolist()]


def follow(plan: Plan, segments: list[Segment], epochs: int) -> tuple[np.ndarray, np.ndarray]:
    """Commanded speed [m/s] and azimuth rate of the turns [rad/s] at the epochs, shape (epochs+1,) each.

    A ramp down to the last stop is laid over the speed; a turn that would still go on when the ramp is felt is left out.
    """
    speeds, turns = [0.0] * (STANDING_SECONDS[0] * RATE_HZ + 1 + SMOOTHING // 2), []
    for segment in segments:
        if len(speeds) > epochs:
            break
        append_stretch(speeds, segment)
        if segment.stop:
            speeds += [0.0] * round(segment.stop * RATE_HZ)
        if segment.turn:
            if segment.stop:
                speeds += np.arange(0.0, segment.turn_speed, segment.acceleration / RATE_HZ).tolist()
            samples = raised_cosine(segment)
            turns.append((len(speeds), segment.turn_speed, samples))
            speeds += [segment.turn_speed] * (len(samples) - 1)
    halt = epochs - STANDING_SECONDS[1] * RATE_HZ - SMOOTHING // 2
    ramp = LAST_BRAKING * np.maximum(halt - np.arange(epochs + 1), 0) / RATE_HZ
    rate = np.zeros(epochs + 1)
    for first, turn_speed, samples in turns:
        last = first + len(samples)
        if last <= epochs and ramp[last] > turn_speed:
            rate[first:last] = samples
    return np.minimum(speeds[: epochs + 1], ramp), rate


def append_stretch(speeds: list[float], segment: Segment) -> None:
    """Append the speeds of a segment, from the last one there is up to the stop, to the turn or to the end at full speed.

    The approach to the target speed tapers within 1 m/s of it. A segment too short to brake in is as long as braking takes.
    """
    leave = 0.0 if segment.stop else segment.turn_speed if segment.turn else segment.target
    speed, left, step = speeds[-1], segment.length, 1.0 / RATE_HZ
    while left > 0.0 or speed > leave:
        if 2.0 * segment.braking * left <= speed**2 - leave**2:
            speed = max(speed - segment.braking * step, leave)
            if speed == 0.0:
                return
        elif speed < segment.target:
            speed += segment.acceleration * step * min(1.0, segment.target - speed)
        else:
            speed -= segment.braking * step * min(1.0, speed - segment.target)
        left -= speed * step
        speeds.append(speed)


def raised_cosine(segment: Segment) -> np.ndarray:
    """Azimuth rate of a turn [rad/s]: it begins and ends with 0, lasts whole epochs and turns by the exact angle."""
    steps = round(abs(segment.turn) * 1.6 * segment.turn_radius / segment.turn_speed * RATE_HZ)
    return segment.turn * RATE_HZ / steps * (1.0 - np.cos(2.0 * np.pi * np.arange(steps + 1) / steps))


def smooth(speed: np.ndarray) -> np.ndarray:
    """`speed` under a Hann window of `SMOOTHING` epochs; it stands still where all of them do."""
    window = np.hanning(SMOOTHING)
    return np.convolve(np.pad(speed, SMOOTHING // 2), window / window.sum(), mode="valid")


def integrate(rate: np.ndarray) -> np.ndarray:
    """Trapezoidal integral over the epochs along the first axis, zero at the first."""
    steps = (rate[1:] + rate[:-1]) / (2.0 * RATE_HZ)
    return np.concatenate([np.zeros_like(rate[:1]), np.cumsum(steps, axis=0)])


def draw_lane_curvature(generator: np.random.Generator, epochs: int) -> np.ndarray:
    """Curvature within the lane [1/m, clockwise], shape (epochs+1,), clipped."""
    white = generator.standard_normal(epochs + 1)
    return np.clip(gauss_markov(white, LANE_DIFFUSION * np.sqrt(0.5 * LANE_TIME), LANE_TIME * RATE_HZ), -LANE_LIMIT, LANE_LIMIT)


def gauss_markov(white: np.ndarray, sd: float, correlation_samples: float) -> np.ndarray:
    """First-order Gauss-Markov noise, stationary from its first sample on, along the first axis.

    Parameters
    ----------
    white : ndarray, shape (N, ...)
        Standard normal draws.
    sd : float
        Stationary standard deviation.
    correlation_samples : float
        Samples after which the correlation is 1/e.
    """
    decay = np.exp(-1.0 / correlation_samples)
    driving = white * (sd * np.sqrt(1.0 - decay**2))
    driving[0] = sd * white[0]
    return lfilter([1.0], [1.0, -decay], driving, axis=0)


def draw_grade(generator: np.random.Generator, rms: float, distance: np.ndarray, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pitch [rad] and its rate [rad/s] at `distance` [m] along the road: a sum of sinusoids with this rms grade."""
    wavenumber = 2.0 * np.pi / generator.uniform(*GRADE_WAVELENGTH, GRADE_WAVES)
    phase = generator.uniform(0.0, 2.0 * np.pi, GRADE_WAVES)
    amplitude = generator.uniform(*GRADE_AMPLITUDE, GRADE_WAVES)
    amplitude *= rms / np.sqrt(0.5 * np.sum(amplitude**2))
    angles = distance[:, None] * wavenumber + phase
    grade, change = np.sum(amplitude * np.sin(angles), axis=1), np.sum(amplitude * wavenumber * np.cos(angles), axis=1)
    return np.arctan(grade), change * speed / (1.0 + grade**2)


def crossfall(distance: np.ndarray) -> np.ndarray:
    """Roll [rad] at `distance` [m] along the road."""
    return 0.02 * np.sin(2.0 * np.pi * distance / 900.0) + 0.008 * np.sin(2.0 * np.pi * distance / 170.0 + 1.0)


def specific_force(speed, acceleration, azimuth_rate, pitch, roll) -> np.ndarray:
    """Specific force right, forward, up [m/s^2], shape (N+1, 3)."""
    right = speed * azimuth_rate - GRAVITY * np.cos(pitch) * np.sin(roll)
    forward = acceleration + GRAVITY * np.sin(pitch)
    return np.stack([right, forward, GRAVITY * np.cos(pitch) * np.cos(roll)], axis=1)


def inertial_rate_up(latitude: float, north: np.ndarray, velocity_east: np.ndarray) -> np.ndarray:
    """Up component of earth and transport rate [rad/s] north of an origin at `latitude` [rad], shape (N+1,)."""
    here = latitude + north / (earth.meridian_radius(latitude) + START_HEIGHT)
    transport = velocity_east * np.tan(here) / (earth.transverse_radius(latitude) + START_HEIGHT)
    return earth.EARTH_RATE * np.sin(here) + transport
