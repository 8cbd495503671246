"""Strapdown mechanisation in local east-north-up coordinates, and its error-state model.

State ``[r v q b_a b_g]``, augmented ``[r v q b_a b_g x_f x_omega]``: position (m) and velocity (m/s) in n, quaternion of C_b^n
(body x forward, y left, z up), accelerometer (m/s^2) and gyro bias (rad/s), transient specific force (m/s^2) and rate (rad/s).
Its error has three numbers for the attitude: ``C = C_hat exp([dtheta x])``; index names `R V THETA BA BG XF XW` below.

Driven by an inertial sensor, input ``u = [f omega ...]`` averaged over the step:

    f = u_f - b_a,  omega = u_omega - b_g,  r' = v,  v' = C f - (2 omega_ie + omega_en) x v + g,  C' = C [omega x] - [omega_in x] C

Augmented, without an input, the transients are what the vehicle does beyond the reaction to gravity and the earth's rate:

    f = -C^T g + x_f,  omega = C^T omega_in + x_omega,  so  v' = C x_f - (2 omega_ie + omega_en) x v,  C' = C [x_omega x]
    x(k+1) = exp(-dt/tau) x(k) + w(k),  and the step is made with the new x

A step turns by half the rotation, adds the specific force there, and turns by the other half: exact for a constant rate, and at
rest to rounding. Local coordinates: latitude, gravity and radii of curvature are those of the origin.

References
----------
.. [1] Groves 2013, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, sections 5.4 and 14.2.
.. [2] Sola 2017, Quaternion kinematics for the error-state Kalman filter, chapters 5 and 6.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.earth import EARTH_RATE, meridian_radius, transverse_radius
from robins.foundation.rotation import dcm, dcm_exponential, normalise, quaternion_exponential, quaternion_product, right_jacobian
from robins.foundation.smallmat import kernel, multiply, times_vector
from robins.kalman.extension import implements
from robins.kalman.model import linearise, propagate, retract

R, V, THETA, BA, BG, XF, XW = 0, 3, 6, 9, 12, 15, 18
"""Where the parts of the error begin."""
ERRORS, AUGMENTED_ERRORS = 15, 21
Q0, ACCELEROMETER_BIAS, GYRO_BIAS, FORCE, RATE = 6, 10, 13, 16, 19  # (15) imani2026
"""Where quaternion, biases and transients begin in the state."""
STATES, AUGMENTED_STATES = 16, 22


class Earth(NamedTuple):
    """The earth at the origin of local coordinates, all in n.

    Attributes
    ----------
    gravity : ndarray, shape (3,)
        m/s^2, ``[0, 0, -g]``.
    rate : ndarray, shape (3,)
        omega_ie, rad/s; zeros for a mechanisation that leaves it out.
    transport : ndarray, shape (3, 3)
        ``omega_en = transport v``, 1/m; zeros likewise.
    """

    gravity: np.ndarray
    rate: np.ndarray
    transport: np.ndarray


def local_earth(latitude: float, gravity: float, rotating: bool = True) -> Earth:
    """The `Earth` at a `latitude` (rad) at sea level with the given `gravity` (m/s^2); `rotating` False leaves omega_in out."""
    rate = EARTH_RATE * np.array([0.0, np.cos(latitude), np.sin(latitude)])
    transport = np.zeros((3, 3))
    transport[0, 1] = -1.0 / meridian_radius(latitude)
    transport[1, 0] = 1.0 / transverse_radius(latitude)
    transport[2, 0] = np.tan(latitude) / transverse_radius(latitude)
    return Earth(np.array([0.0, 0.0, -gravity]), rate * rotating, transport * rotating)


class Scratch(NamedTuple):
    """Small arrays that a step works in; one set for each model."""

    f: np.ndarray
    omega: np.ndarray
    omega_in: np.ndarray
    half_n: np.ndarray
    half_b: np.ndarray
    middle: np.ndarray
    acceleration: np.ndarray
    C: np.ndarray
    B: np.ndarray
    J: np.ndarray
    S: np.ndarray
    CS: np.ndarray
    G: np.ndarray


class Strapdown(NamedTuple):
    """The process model; see the module's docstring.

    Attributes
    ----------
    dt : float
        Step (s).
    augmented : bool
        Whether the transients are states and nothing drives the model.
    decay : float
        ``exp(-dt / tau)`` of the transients.
    earth : Earth
    noise : ndarray, shape (n,)
        Variance of the process noise of a step, independent for each error.
    transient : ndarray, shape (6,)
        Variance of w of the transients' step. It enters velocity, attitude and position with the new transient, not beside it.
    scratch : Scratch
    """

    dt: float
    augmented: bool
    decay: float
    earth: Earth
    noise: np.ndarray
    transient: np.ndarray
    scratch: Scratch


def strapdown(dt: float, earth: Earth, noise, transient=None, time_constant: float = np.inf) -> Strapdown:
    """A `Strapdown` model; `transient` ``(6,)`` and their `time_constant` (s) make it the augmented one.

    Raises
    ------
    ValueError
        The length of `noise` is not the number of errors.
    """
    augmented = transient is not None
    noise = np.array(noise, float)
    expected = AUGMENTED_ERRORS if augmented else ERRORS
    if noise.shape != (expected,):
        raise ValueError(f"the process noise has shape {noise.shape}, not ({expected},)")
    vectors, square = [np.zeros(size) for size in (3, 3, 3, 4, 4, 4, 3)], [np.zeros((3, 3)) for _ in range(5)]
    scratch = Scratch(*vectors, *square, np.zeros((BA, 6)))
    variance = np.array(transient, float) if augmented else np.zeros(6)
    return Strapdown(float(dt), augmented, float(np.exp(-dt / time_constant)), earth, noise, variance, scratch)


@kernel
def load_motion(model, x, u):
    """Specific force, rate and omega_in that this step integrates, into the scratch."""
    s = model.scratch
    for i in range(3):
        s.omega_in[i] = 0.0
        if model.augmented:
            s.f[i] = model.decay * x[FORCE + i]
            s.omega[i] = model.decay * x[RATE + i]
        else:
            s.f[i] = u[i] - x[ACCELEROMETER_BIAS + i]
            s.omega[i] = u[3 + i] - x[GYRO_BIAS + i]
            s.omega_in[i] = model.earth.rate[i]
            for j in range(3):
                s.omega_in[i] += model.earth.transport[i, j] * x[V + j]


@kernel
def turn(model, q, out):
    """``out = q`` turned by half a step: by omega in b, and against omega_in in n."""
    s = model.scratch
    quaternion_exponential(s.omega_in, -0.5 * model.dt, s.half_n)
    quaternion_exponential(s.omega, 0.5 * model.dt, s.half_b)
    quaternion_product(s.half_n, q, out)
    quaternion_product(out, s.half_b, out)


@kernel
def middle_attitude(model, x):
    """Quaternion and matrix of the attitude in the middle of the step, into the scratch."""
    s = model.scratch
    for i in range(4):
        s.middle[i] = x[Q0 + i]
    turn(model, s.middle, s.middle)
    dcm(s.middle, s.C)


@kernel
def coriolis_rate(earth, x, i):
    """Element i of ``2 omega_ie + omega_en``."""
    total = 2.0 * earth.rate[i]
    for j in range(3):
        total += earth.transport[i, j] * x[V + j]
    return total


@kernel
def load_acceleration(model, x):
    """Acceleration in n, ``C f + g - (2 omega_ie + omega_en) x v``, into the scratch."""
    s, earth = model.scratch, model.earth
    times_vector(s.C, s.f, s.acceleration)
    a, b, c = coriolis_rate(earth, x, 0), coriolis_rate(earth, x, 1), coriolis_rate(earth, x, 2)
    s.acceleration[0] -= b * x[V + 2] - c * x[V + 1]
    s.acceleration[1] -= c * x[V] - a * x[V + 2]
    s.acceleration[2] -= a * x[V + 1] - b * x[V]
    if not model.augmented:
        for i in range(3):
            s.acceleration[i] += earth.gravity[i]


@implements(propagate, Strapdown)
@kernel
def propagate_strapdown(model, x, u):
    """One step."""
    s = model.scratch
    load_motion(model, x, u)
    middle_attitude(model, x)
    load_acceleration(model, x)  # (4), (13) imani2026
    for i in range(3):
        x[R + i] += model.dt * (x[V + i] + 0.5 * model.dt * s.acceleration[i])  # (3), (12) imani2026
        x[V + i] += model.dt * s.acceleration[i]
    turn(model, s.middle, s.middle)  # (5), (14) imani2026
    normalise(s.middle)
    for i in range(4):
        x[Q0 + i] = s.middle[i]
    if model.augmented:
        for i in range(3):
            x[FORCE + i] *= model.decay  # (7) imani2026
            x[RATE + i] *= model.decay


@kernel
def times_cross(A, a, scale, out):
    """``out = scale A [a x]`` for ``(3, 3)`` and ``(3,)``."""
    for i in range(3):
        out[i, 0] = scale * (A[i, 1] * a[2] - A[i, 2] * a[1])
        out[i, 1] = scale * (A[i, 2] * a[0] - A[i, 0] * a[2])
        out[i, 2] = scale * (A[i, 0] * a[1] - A[i, 1] * a[0])


@kernel
def motion_jacobian(model, G):
    """Derivative of the step's errors of r, v and theta with respect to f and omega, `G` ``(9, 6)``.

    Leaves ``exp([omega dt/2 x])`` in ``scratch.B`` and ``-dt C_middle [f x]`` in ``scratch.CS``.
    """
    s, dt = model.scratch, model.dt
    dcm_exponential(s.omega, 0.5 * dt, s.B)
    times_cross(s.C, s.f, -dt, s.CS)
    right_jacobian(s.omega, 0.5 * dt, s.J)
    multiply(s.CS, s.J, s.S)
    right_jacobian(s.omega, dt, s.J)
    for i in range(3):
        for j in range(3):
            G[V + i, j] = dt * s.C[i, j]
            G[V + i, 3 + j] = 0.5 * dt * s.S[i, j]
            G[R + i, j] = 0.5 * dt * G[V + i, j]
            G[R + i, 3 + j] = 0.5 * dt * G[V + i, 3 + j]
            G[THETA + i, j] = 0.0
            G[THETA + i, 3 + j] = dt * s.J[i, j]


@kernel
def state_jacobian(model, x, F):
    """Columns of velocity and attitude of F."""
    s, dt, earth = model.scratch, model.dt, model.earth
    multiply(s.C, s.B, s.J)  # attitude at the end: an error of omega_in appears in its body axes
    a, b, c = coriolis_rate(earth, x, 0), coriolis_rate(earth, x, 1), coriolis_rate(earth, x, 2)
    F[V, V + 1], F[V, V + 2] = dt * c, -dt * b
    F[V + 1, V], F[V + 1, V + 2] = -dt * c, dt * a
    F[V + 2, V], F[V + 2, V + 1] = dt * b, -dt * a
    for j in range(3):  # Coriolis acceleration of the transport rate: [v x] transport
        p, q, r = earth.transport[0, j], earth.transport[1, j], earth.transport[2, j]
        F[V, V + j] += dt * (x[V + 1] * r - x[V + 2] * q)
        F[V + 1, V + j] += dt * (x[V + 2] * p - x[V] * r)
        F[V + 2, V + j] += dt * (x[V] * q - x[V + 1] * p)
    for i in range(3):
        for j in range(3):
            total, turned, transported = 0.0, 0.0, 0.0
            for k in range(3):
                total += s.CS[i, k] * s.B[j, k]
                turned += s.B[k, i] * s.B[j, k]
                if not model.augmented:
                    transported += s.J[k, i] * earth.transport[k, j]
            F[V + i, THETA + j] = total
            F[THETA + i, THETA + j] = turned
            F[THETA + i, V + j] = -dt * transported


@kernel
def position_jacobian(dt, F):
    """Rows of the position: ``r + (v + v') dt / 2``."""
    for i in range(3):
        for j in range(3):
            F[R + i, V + j] = 0.5 * dt * F[V + i, V + j]
            F[R + i, THETA + j] = 0.5 * dt * F[V + i, THETA + j]
        F[R + i, V + i] += 0.5 * dt


@implements(linearise, Strapdown)
@kernel
def linearise_strapdown(model, x, u, F, Q):
    """F of the error state and the process noise covariance of the step.

    Left out of F: the rotation of n during the step where it multiplies a velocity error (of relative size 1e-8).
    """
    n, s = F.shape[0], model.scratch
    load_motion(model, x, u)
    middle_attitude(model, x)
    for i in range(n):
        for j in range(n):
            F[i, j] = Q[i, j] = 0.0
        F[i, i] = 1.0
        Q[i, i] = model.noise[i]
    motion_jacobian(model, s.G)
    state_jacobian(model, x, F)
    position_jacobian(model.dt, F)
    if model.augmented:
        transient_jacobian(model, F, Q)
    else:
        for i in range(9):
            for j in range(6):
                F[i, BA + j] = -s.G[i, j]


@kernel
def transient_jacobian(model, F, Q):
    """Columns of the transients in F, and their noise in Q: what the new transient moves, its noise moves as well."""
    G, variance = model.scratch.G, model.transient
    for j in range(6):
        for i in range(BA):
            moved = G[i, j] * variance[j]
            F[i, XF + j] = model.decay * G[i, j]
            Q[i, XF + j] = Q[XF + j, i] = moved
            for k in range(i + 1):
                Q[i, k] += moved * G[k, j]
        F[XF + j, XF + j] = model.decay
        Q[XF + j, XF + j] += variance[j]
    for i in range(BA):
        for k in range(i):
            Q[k, i] = Q[i, k]


@implements(retract, Strapdown)
@kernel
def retract_strapdown(model, x, error):
    """``C = C_hat exp([dtheta x])``; everything else adds. The quaternion leaves with length one."""
    s = model.scratch
    for i in range(6):
        x[i] += error[i]
    for i in range(3):
        s.f[i] = error[THETA + i]
    for i in range(4):
        s.middle[i] = x[Q0 + i]
    quaternion_exponential(s.f, 1.0, s.half_b)
    quaternion_product(s.middle, s.half_b, s.middle)
    normalise(s.middle)
    for i in range(4):
        x[Q0 + i] = s.middle[i]
    for i in range(BA, error.size):
        x[i + 1] += error[i]


@njit(cache=True)
def mechanise(model, x0, controls, states):
    """Integrate the controls ``(N, l)`` from `x0` ``(n,)``; `states` ``(N + 1, n)`` takes every epoch."""
    x = x0.copy()
    states[0] = x
    for k in range(controls.shape[0]):
        propagate_strapdown(model, x, controls[k])
        states[k + 1] = x
