"""What a filter needs to know of a system, as generic functions, and the linear system that needs no more.

State equation   ``x(k+1) = f(x(k), u(k)) + w(k)``,  ``cov w = Q``
Measurement      ``z(k) = h(x(k), u(k)) + v(k)``,    ``cov v = R``

`propagate` and `linearise` describe the state equation; `observe` and `linearise_observation` the
measurement. A model registers its kernels with `robins.kalman.extension.implements`.

The covariance, F, Q and H belong to the error of the state. Where the state is a vector, that is a difference. A model of an
attitude keeps its state in more numbers than its error has (a quaternion and a rotation vector) and registers `retract`,
which applies an error to a state; the filter is then an error-state (multiplicative) one.

R is the sensor's own at every epoch, unless the sensor registers `measurement_noise`: a receiver that reports the standard
deviation of each fix passes it in the input u.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import overload

from robins.foundation.smallmat import assign, times_vector
from robins.kalman.extension import has_kernel, implements, kernel_of


def propagate(model, x, u):
    """Replace the state `x` ``(n,)`` by ``f(x, u)`` for the input `u` ``(l,)``."""
    return kernel_of("propagate", model)(model, x, u)


def linearise(model, x, u, F, Q):
    """Write ``df/dx`` at `x` into `F` and the process noise covariance of this step into `Q`, both ``(n, n)``."""
    return kernel_of("linearise", model)(model, x, u, F, Q)


def process_noise(model, x, u, Q):
    """Write the process noise covariance of this step into `Q` ``(n, n)``; by `linearise`, unless the model has a way without F."""
    return kernel_of("process_noise", model)(model, x, u, Q) if has_kernel("process_noise", model) else beside_jacobian(model, x, u, Q)


def observe(sensor, x, u, z):
    """Write the predicted measurement ``h(x, u)`` into `z` ``(m,)``."""
    return kernel_of("observe", sensor)(sensor, x, u, z)


def linearise_observation(sensor, x, u, H):
    """Write ``dh/dx`` at `x` into `H` ``(m, n)``."""
    return kernel_of("linearise_observation", sensor)(sensor, x, u, H)


def retract(model, x, error):
    """Apply the `error` ``(n,)`` to the state `x` in place; the sum, unless the model says otherwise."""
    return kernel_of("retract", model)(model, x, error) if has_kernel("retract", model) else add(model, x, error)


def measurement_noise(sensor, u, R):
    """Write the covariance of this epoch's noise into `R` ``(m, m)``, the part that a robust method re-weights.

    `R` holds what the epoch before left there, the sensor's own at first; it stays so, unless the sensor says otherwise.
    """
    return kernel_of("measurement_noise", sensor)(sensor, u, R) if has_kernel("measurement_noise", sensor) else keep(sensor, u, R)


@njit(cache=True)
def add(model, x, error):
    """``x += error``."""
    for i in range(x.size):
        x[i] += error[i]


@njit(cache=True)
def keep(sensor, u, R):
    """Leave `R` as it is."""


@overload(propagate, jit_options={"forceinline": True})
def _propagate(model, x, u):
    kernel = kernel_of("propagate", model)
    return lambda model, x, u: kernel(model, x, u)


@overload(linearise, jit_options={"forceinline": True})
def _linearise(model, x, u, F, Q):
    kernel = kernel_of("linearise", model)
    return lambda model, x, u, F, Q: kernel(model, x, u, F, Q)


@overload(process_noise, jit_options={"forceinline": True})
def _process_noise(model, x, u, Q):
    kernel = kernel_of("process_noise", model) if has_kernel("process_noise", model) else beside_jacobian
    return lambda model, x, u, Q: kernel(model, x, u, Q)


@njit(cache=True)
def beside_jacobian(model, x, u, Q):
    """`linearise` for its noise only."""
    linearise(model, x, u, np.empty_like(Q), Q)


@overload(observe, jit_options={"forceinline": True})
def _observe(sensor, x, u, z):
    kernel = kernel_of("observe", sensor)
    return lambda sensor, x, u, z: kernel(sensor, x, u, z)


@overload(linearise_observation, jit_options={"forceinline": True})
def _linearise_observation(sensor, x, u, H):
    kernel = kernel_of("linearise_observation", sensor)
    return lambda sensor, x, u, H: kernel(sensor, x, u, H)


@overload(retract, jit_options={"forceinline": True})
def _retract(model, x, error):
    kernel = kernel_of("retract", model) if has_kernel("retract", model) else add
    return lambda model, x, error: kernel(model, x, error)


@overload(measurement_noise, jit_options={"forceinline": True})
def _measurement_noise(sensor, u, R):
    kernel = kernel_of("measurement_noise", sensor) if has_kernel("measurement_noise", sensor) else keep
    return lambda sensor, u, R: kernel(sensor, u, R)


class LinearModel(NamedTuple):
    """``x(k+1) = A x(k) + B u(k) + w(k)``: `A` ``(n, n)``, `B` ``(n, l)``, `Q` ``(n, n)`` = cov w."""

    A: np.ndarray
    B: np.ndarray
    Q: np.ndarray


class Sensor(NamedTuple):
    """Noise of a measurement, and for a linear one its matrices: ``z = H x + D u + v``.

    Attributes
    ----------
    H, D : ndarray, shapes (m, n) and (m, l)
    R : ndarray, shape (m, m)
        The part of cov v that a robust method re-weights.
    R_fixed : ndarray, shape (m, m)
        The part that no sensor fault touches (zero in most problems).
    C_update : ndarray, shape (n, m)
        ``E[e v^T]`` between the predicted state's error ``e = x - x(k/k-1)`` and v.
    C_predict : ndarray, shape (n, m)
        ``E[w v^T]`` between the noise of the coming prediction and v.
    """

    H: np.ndarray
    D: np.ndarray
    R: np.ndarray
    R_fixed: np.ndarray
    C_update: np.ndarray
    C_predict: np.ndarray


def linear_sensor(H, R, D=None, R_fixed=None, C_update=None, C_predict=None, inputs=1) -> Sensor:
    """A `Sensor` with zeros where nothing is given; `inputs` is the length of u when `D` is absent."""
    m, n = H.shape
    shapes = ((D, (m, inputs)), (R_fixed, (m, m)), (C_update, (n, m)), (C_predict, (n, m)))
    rest = [np.zeros(shape) if given is None else np.ascontiguousarray(given, float) for given, shape in shapes]
    return Sensor(np.ascontiguousarray(H, float), rest[0], np.ascontiguousarray(R, float), *rest[1:])


@implements(propagate, LinearModel)
@njit(cache=True)
def propagate_linear(model, x, u):
    """``x <- A x + B u``."""
    previous = x.copy()
    times_vector(model.A, previous, x)
    for i in range(x.size):
        for j in range(u.size):
            x[i] += model.B[i, j] * u[j]


@implements(linearise, LinearModel)
@njit(cache=True)
def linearise_linear(model, x, u, F, Q):
    """F = A and Q = Q, whatever the state."""
    assign(model.A, F)
    assign(model.Q, Q)


@implements(observe, Sensor)
@njit(cache=True)
def observe_linear(sensor, x, u, z):
    """``z = H x + D u``."""
    times_vector(sensor.H, x, z)
    for i in range(z.size):
        for j in range(u.size):
            z[i] += sensor.D[i, j] * u[j]


@implements(linearise_observation, Sensor)
@njit(cache=True)
def linearise_observation_linear(sensor, x, u, H):
    """H = H, whatever the state."""
    assign(sensor.H, H)
