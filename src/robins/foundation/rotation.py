"""Rotations: unit quaternions, rotation vectors and Euler angles, as kernels for hot loops and for whole arrays.

A quaternion ``(w, x, y, z)`` turns a vector of the body frame b into the navigation frame n: ``C_b^n = dcm(q)``. A rotation
vector `a` is axis times angle (rad); ``exp([a x])`` is its matrix. Euler angles are roll, pitch, yaw (phi, theta, psi) with
``C_b^n = Rz(psi) Ry(theta) Rx(phi)``: for a body frame x forward, y left, z up and n = east-north-up, yaw counts from east
counter-clockwise and a raised nose is a negative pitch.

References
----------
.. [1] Sola, Deray and Atchuthan 2018, A micro Lie theory for state estimation in robotics, appendix B (SO(3)).
.. [2] Groves 2013, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, section 2.2.
"""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from robins.foundation.smallmat import kernel

SMALL_ANGLE = 1e-4
"""Below this angle (rad) the power series of the sine and cosine terms are exact to rounding."""


@kernel
def quaternion_product(p, q, out):
    """``out = p q`` (first q's rotation, then p's); all ``(4,)``, `out` may be `p` or `q`."""
    w = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3]
    x = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2]
    y = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1]
    z = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]
    out[0], out[1], out[2], out[3] = w, x, y, z


@kernel
def normalise(q):
    """Scale the quaternion `q` ``(4,)`` to length one, in place."""
    inverse = 1.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for i in range(4):
        q[i] *= inverse


@kernel
def quaternion_exponential(a, scale, out):
    """The quaternion ``(4,)`` of the rotation vector ``scale a``, `a` ``(3,)``."""
    half = 0.5 * scale
    x, y, z = half * a[0], half * a[1], half * a[2]
    squared = x * x + y * y + z * z
    angle = math.sqrt(squared)
    sinc = 1.0 - squared / 6.0 if angle < SMALL_ANGLE else math.sin(angle) / angle
    out[0] = math.cos(angle)
    out[1], out[2], out[3] = sinc * x, sinc * y, sinc * z


@kernel
def dcm(q, C):
    """The matrix ``(3, 3)`` of the unit quaternion `q` ``(4,)`` into `C`."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    C[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    C[0, 1] = 2.0 * (x * y - w * z)
    C[0, 2] = 2.0 * (x * z + w * y)
    C[1, 0] = 2.0 * (x * y + w * z)
    C[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    C[1, 2] = 2.0 * (y * z - w * x)
    C[2, 0] = 2.0 * (x * z - w * y)
    C[2, 1] = 2.0 * (y * z + w * x)
    C[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@kernel
def _series(a, scale, first, second, out):
    """``out = I + first [b x] + second [b x]^2`` for ``b = scale a``; ``[b x]^2 = b b^T - |b|^2 I``."""
    x, y, z = scale * a[0], scale * a[1], scale * a[2]
    squared = x * x + y * y + z * z
    out[0, 0] = 1.0 + second * (x * x - squared)
    out[1, 1] = 1.0 + second * (y * y - squared)
    out[2, 2] = 1.0 + second * (z * z - squared)
    out[0, 1], out[1, 0] = second * x * y - first * z, second * x * y + first * z
    out[0, 2], out[2, 0] = second * x * z + first * y, second * x * z - first * y
    out[1, 2], out[2, 1] = second * y * z - first * x, second * y * z + first * x


@kernel
def dcm_exponential(a, scale, out):
    """``out = exp([scale a x])``, ``(3, 3)`` (Rodrigues)."""
    angle = abs(scale) * math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    if angle < SMALL_ANGLE:
        first, second = 1.0 - angle * angle / 6.0, 0.5 - angle * angle / 24.0
    else:
        first, second = math.sin(angle) / angle, 2.0 * (math.sin(0.5 * angle) / angle) ** 2
    _series(a, scale, first, second, out)


@kernel
def right_jacobian(a, scale, out):
    """``J`` with ``exp([(b + d) x]) = exp([b x]) exp([J d x])`` to first order in d, for ``b = scale a`` ([1]_, eq. 143)."""
    angle = abs(scale) * math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    if angle < SMALL_ANGLE:
        first, second = -0.5 + angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0
    else:
        first = -2.0 * (math.sin(0.5 * angle) / angle) ** 2  # -(1 - cos) / angle^2 without its cancellation
        second = (angle - math.sin(angle)) / (angle * angle * angle)
    _series(a, scale, first, second, out)


def quaternion_of_euler(euler: np.ndarray) -> np.ndarray:
    """Quaternions ``(..., 4)`` of Euler angles ``(..., 3)`` roll, pitch, yaw (rad)."""
    euler = np.asarray(euler, float)
    flat = Rotation.from_euler("ZYX", euler.reshape(-1, 3)[:, ::-1]).as_quat(scalar_first=True)
    return flat.reshape(*euler.shape[:-1], 4)


def euler_of_quaternion(quaternion: np.ndarray) -> np.ndarray:
    """Roll, pitch, yaw ``(..., 3)`` (rad) of unit quaternions ``(..., 4)``; roll and yaw in (-pi, pi], pitch in [-pi/2, pi/2]."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, float), -1, 0)
    roll = np.arctan2(2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - x * z), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=-1)


def rotate(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """``C_b^n v`` for quaternions ``(..., 4)`` and vectors ``(..., 3)``."""
    w, axis = quaternion[..., :1], quaternion[..., 1:]
    twice = 2.0 * np.cross(axis, vector)
    return vector + w * twice + np.cross(axis, twice)


def conjugate(quaternion: np.ndarray) -> np.ndarray:
    """The inverse rotations, ``(..., 4)``."""
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def euler_rates(euler: np.ndarray, rate_b: np.ndarray) -> np.ndarray:
    """Time derivatives ``(..., 3)`` of Euler angles ``(..., 3)`` for the body rates `rate_b` ``(..., 3)`` against n ([2]_, eq. 2.58)."""
    roll, pitch = euler[..., 0], euler[..., 1]
    p, q, r = np.moveaxis(rate_b, -1, 0)
    transverse = q * np.sin(roll) + r * np.cos(roll)
    return np.stack([p + transverse * np.tan(pitch), q * np.cos(roll) - r * np.sin(roll), transverse / np.cos(pitch)], axis=-1)


def body_rates(euler: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Body rates ``(..., 3)`` against n of Euler angles ``(..., 3)`` that change at `rates` ``(..., 3)``; inverse of `euler_rates`."""
    roll, pitch = euler[..., 0], euler[..., 1]
    roll_rate, pitch_rate, yaw_rate = np.moveaxis(rates, -1, 0)
    return np.stack(
        [
            roll_rate - yaw_rate * np.sin(pitch),
            pitch_rate * np.cos(roll) + yaw_rate * np.sin(roll) * np.cos(pitch),
            yaw_rate * np.cos(roll) * np.cos(pitch) - pitch_rate * np.sin(roll),
        ],
        axis=-1,
    )


def wrapped(angle: np.ndarray) -> np.ndarray:
    """`angle` in [-pi, pi)."""
    return (np.asarray(angle) + np.pi) % (2.0 * np.pi) - np.pi
