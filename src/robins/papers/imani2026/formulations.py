"""The three formulations of the estimation problem (sections 3, 4.1 of the paper; brief, section 1.4).

F0   the printed states; the IMU sample drives the mechanisation, and is the measurement again, of a vehicle that is taken to stand
     still: the only reading in which (26) has the printed blocks
F1   the transients of (7)-(9) are states, nothing drives the model, every sample is used once
F2   a classical sensor drives the mechanisation, the atomic one measures its bias

Errors are ordered as in the paper: r, v, theta, b_a, b_g, and in F1 x_f, x_omega. Epoch 0 has no measurement; sample k, the
average over the interval that ends at k, is processed at epoch k.
"""

from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from robins.foundation.rotation import quaternion_exponential, quaternion_product
from robins.navigation.inertial_sensor import AUGMENTED, DIFFERENCE, QUASI_STATIC, InertialSensor, inertial_sensor
from robins.navigation.strapdown import AUGMENTED_STATES, Q0, STATES, Earth, R, Strapdown, V, local_earth, strapdown
from robins.papers.imani2026.drive import GRAVITY, LATITUDE, Drive
from robins.papers.imani2026.sensors import Measurements, Sensors, channels

FORMS = {"F0": QUASI_STATIC, "F1": AUGMENTED, "F2": DIFFERENCE}
FORMULATIONS = tuple(FORMS)
INITIAL_SD = MappingProxyType({"position": 0.01, "velocity": 0.01, "tilt": np.radians(0.05), "yaw": np.radians(0.6)})
"""Initial standard deviations in m, m/s and rad; those of the biases are twice the scatter of the biases themselves."""
TRANSIENT_SD = (0.01, 0.001)
"""Initial standard deviations of the transients, m/s^2 and rad/s."""
TIME_CONSTANT = 50.0
"""tau of the transients in F1 [s]. A short one levels the filter on centripetal force."""
TRANSIENT_STEP = np.array([0.158, 0.158, 0.038, 0.0063, 0.0063, 0.030])
"""Standard deviation of what the transients change by in 0.1 s, m/s^2 and rad/s."""
PRINTED_NOISE = MappingProxyType({"velocity": 0.1, "quaternion": 0.01, "accelerometer_bias": 1e-3, "gyro_bias": 1e-4})
"""The paper's process noise (after equation 22)."""
TUNED_NOISE = MappingProxyType({"velocity": 0.01, "attitude": 1e-4, "accelerometer_bias": 1e-5, "gyro_bias": 1e-6})
"""Ours: m/s^2 (times dt), and rad, m/s^2, rad/s per root second."""
PROCESSES = ("printed", "printed-dt", "tuned")
DEFAULT_PROCESS = {"F0": "printed-dt", "F1": "tuned", "F2": "tuned"}


class Formulation(NamedTuple):
    """A formulation at one rate: model, sensor and initial covariance."""

    name: str
    model: Strapdown
    sensor: InertialSensor
    P0: np.ndarray


def process_noise(name: str, dt: float) -> np.ndarray:
    """Variances of a step of r, v, theta, b_a and b_g, shape (15,).

    ``printed`` takes the printed deviations for those of a step, ``printed-dt`` for an acceleration and per root second.
    """
    if name == "tuned":
        n = TUNED_NOISE
        variances = (n["velocity"] * dt) ** 2, n["attitude"] ** 2 * dt, n["accelerometer_bias"] ** 2 * dt, n["gyro_bias"] ** 2 * dt
    else:
        n = PRINTED_NOISE  # (22) imani2026
        scale = (1.0, 1.0) if name == "printed" else (dt**2, dt)
        angle = 2.0 * n["quaternion"]  # an error of q is half the angle
        variances = n["velocity"] ** 2 * scale[0], *(sd**2 * scale[1] for sd in (angle, n["accelerometer_bias"], n["gyro_bias"]))
    return np.repeat([0.0, *variances], 3)  # (10), (11) imani2026: the Gaussian part; the other is the sensors'


def transient_noise(dt: float) -> np.ndarray:
    """Variances of the transients' step that keep their stationary variance, shape (6,)."""
    at_ten_hertz = -np.expm1(-2.0 * 0.1 / TIME_CONSTANT)
    return TRANSIENT_STEP**2 * (-np.expm1(-2.0 * dt / TIME_CONSTANT) / at_ten_hertz)


def initial_covariance(name: str, sensors: Sensors) -> np.ndarray:
    """P of epoch 0, shape (n, n)."""
    tilt, yaw = INITIAL_SD["tilt"], INITIAL_SD["yaw"]
    if name == "F2":
        bias = channels(sensors.classical_accelerometer_bias, sensors.classical_gyroscope_bias)
    else:
        bias = 2.0 * channels(sensors.accelerometer_bias, sensors.gyroscope_bias)
    sd = [*[INITIAL_SD["position"]] * 3, *[INITIAL_SD["velocity"]] * 3, tilt, tilt, yaw, *bias]
    if name == "F1":
        sd += list(channels(*TRANSIENT_SD))
    return np.diag(np.square(sd))


def noise_variance(name: str, sensors: Sensors, rate_hz: int) -> np.ndarray:
    """R's diagonal: the total variance of a sample; in F2 of the difference of two sensors, shape (6,)."""
    variance = sensors.noise_sd(rate_hz) ** 2
    if name == "F2":
        classical = channels(sensors.classical_accelerometer_noise, sensors.classical_gyroscope_noise) * sensors.noise_growth(rate_hz)
        variance = variance + classical**2
    return variance


def formulation(name: str, rate_hz: int, sensors: Sensors, noise_scale: float = 1.0, process_scale: float = 1.0, process: str = "",
                earth: Earth | None = None) -> Formulation:  # fmt: skip
    """A formulation.

    Parameters
    ----------
    name : str
        ``F0``, ``F1`` or ``F2``.
    rate_hz : int
    sensors : Sensors
        What the filter believes of them.
    noise_scale, process_scale : float
        Multipliers of R and of Q.
    process : str
        One of `PROCESSES`; the formulation's own when empty.
    earth : Earth, optional
        What the mechanisation knows; equations (4) and (5) in full when left out.
    """
    dt, earth = 1.0 / rate_hz, earth or local_earth(LATITUDE, GRAVITY)
    noise = process_scale * process_noise(process or DEFAULT_PROCESS[name], dt)
    if name == "F1":
        model = strapdown(dt, earth, [*noise, *[0.0] * 6], process_scale * transient_noise(dt), TIME_CONSTANT)
    else:
        model = strapdown(dt, earth, noise)
    sensor = inertial_sensor(FORMS[name], dt, earth, noise_scale * noise_variance(name, sensors, rate_hz))
    return Formulation(name, model, sensor, initial_covariance(name, sensors))


def initial_states(name: str, driven: Drive, measured: Measurements) -> np.ndarray:
    """Estimates of epoch 0, shape (runs, n): at rest, no bias, and an attitude whose error is the run's."""
    runs = len(measured.attitude_error)
    x0 = np.zeros((runs, AUGMENTED_STATES if name == "F1" else STATES))
    x0[:, R : R + 3], x0[:, V : V + 3] = driven.position[0], driven.velocity_n[0]
    turn = np.empty(4)
    for run in range(runs):
        quaternion_exponential(measured.attitude_error[run], -1.0, turn)
        quaternion_product(driven.quaternion[0], turn, x0[run, Q0 : Q0 + 4])
    return x0


def controls(name: str, measured: Measurements) -> np.ndarray:
    """Inputs, shape (runs or 1, N+1, 12): at epoch k the sample that drives the step to k + 1, then the one that ended at k."""
    runs, samples, _ = measured.atomic.shape
    if name == "F1":
        return np.zeros((1, samples + 1, 12))
    driving = measured.classical if name == "F2" else measured.atomic  # (18), (19) imani2026
    inputs = np.zeros((runs, samples + 1, 12))
    inputs[:, :-1, :6], inputs[:, 1:, 6:] = driving, driving
    return inputs


def readings(name: str, measured: Measurements) -> np.ndarray:
    """Measurements, shape (runs, N+1, 6); in F2 the difference that the sensor predicts is taken against the atomic sample."""
    runs, samples, width = measured.atomic.shape
    z = np.zeros((runs, samples + 1, width))
    z[:, 1:] = measured.atomic
    return z


def true_bias(name: str, measured: Measurements) -> np.ndarray:
    """What the bias states stand for, shape (runs, 6): in F2 the classical bias against the atomic one."""
    return measured.classical_bias - measured.bias if name == "F2" else measured.bias
