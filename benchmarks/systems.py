"""The strapdown mechanisation that the peers of the benchmark filter: its errors, and the sensor that observes it.

QUASI-STATIC, 15 errors: `robins.navigation.strapdown` is driven by an inertial sensor, and a second one reports what it would
at rest. AUGMENTED, 21 errors: specific force and rate are states, and one sensor measures everything. Both are simulated with
their own model, so that a filter of it is consistent.
"""

import numpy as np

from benchmarks.models import Drive
from robins.foundation.randomness import stream
from robins.navigation.inertial_sensor import AUGMENTED, CHANNELS, QUASI_STATIC, InertialSensor, inertial_sensor, observe_inertial
from robins.navigation.strapdown import (
    AUGMENTED_ERRORS,
    AUGMENTED_STATES,
    ERRORS,
    Q0,
    STATES,
    Strapdown,
    V,
    local_earth,
    propagate_strapdown,
    retract_strapdown,
    strapdown,
)

EARTH = local_earth(np.radians(38.06), 9.80)
SENSOR_NOISE = np.repeat([1e-2, 1e-3], 3)
"""Standard deviation of a reading: m/s^2, rad/s."""


def system(augmented: bool, dt: float = 0.1) -> tuple[Strapdown, InertialSensor]:
    """The process model and the sensor, `dt` seconds an epoch."""
    noise = np.repeat([1e-5, 1e-4, 1e-5, 1e-6, 1e-8], 3)  # of position, velocity, attitude and the two biases
    if not augmented:
        return strapdown(dt, EARTH, noise**2), inertial_sensor(QUASI_STATIC, dt, EARTH, SENSOR_NOISE**2)
    transient = np.repeat([2e-2, 5e-3], 3)
    model = strapdown(dt, EARTH, np.r_[noise, np.zeros(6)] ** 2, transient**2, time_constant=2.0)
    return model, inertial_sensor(AUGMENTED, dt, EARTH, SENSOR_NOISE**2)


def strapdown_drive(augmented: bool, epochs: int, seed: int = 1, dt: float = 0.1) -> Drive:
    """Simulate a vehicle that sways; `augmented` moves by its transients alone."""
    model, sensor = system(augmented, dt)
    errors, states = (AUGMENTED_ERRORS, AUGMENTED_STATES) if augmented else (ERRORS, STATES)
    deviation = np.repeat([1e-2, 1e-2, 1e-3, 1e-3, 1e-5, 1e-2, 1e-3], 3)[:errors]
    variance = model.noise.copy()
    variance[ERRORS:] += model.transient[: errors - ERRORS]
    process_noise = stream(seed, "benchmarks/process").standard_normal((epochs, errors)) * np.sqrt(variance)
    sensor_noise = stream(seed, "benchmarks/sensor").standard_normal((epochs, CHANNELS)) * SENSOR_NOISE
    time = dt * np.arange(epochs)
    force = np.column_stack([0.3 * np.sin(0.2 * time), 0.2 * np.sin(0.3 * time), 9.8 + 0.1 * np.sin(0.5 * time)])
    controls = np.zeros((epochs, CHANNELS))
    if not augmented:
        controls = np.column_stack([force, 0.02 * np.cos(np.outer(time, [0.4, 0.5, 0.1]))])
    truth, measurements = np.empty((epochs, states)), np.empty((epochs, CHANNELS))
    x = np.zeros(states)
    x[V], x[Q0] = 5.0, 1.0
    for k in range(epochs):
        truth[k] = x
        observe_inertial(sensor, x, controls[k], measurements[k])
        propagate_strapdown(model, x, controls[k])
        retract_strapdown(model, x, process_noise[k])
    x0 = truth[0].copy()
    retract_strapdown(model, x0, deviation * stream(seed, "benchmarks/start").standard_normal(errors))
    return Drive(model, sensor, x0, np.diag(deviation**2), controls, measurements + sensor_noise, truth)
