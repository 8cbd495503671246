"""What the measurements can say about each formulation's states, whatever filter reads them (proposition 2 of the register).

The information matrix ``sum_k (H_k Phi_k)^T (H_k Phi_k)`` along the true drive, prior excluded, with rows in units of the noise
and columns in units of a plausible error. Its rank counts the directions of the initial error that are seen at all.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from scipy.spatial.transform import Rotation

from robins.navigation.inertial_sensor import linearise_inertial
from robins.navigation.strapdown import FORCE, Q0, RATE, R, V, linearise_strapdown
from robins.papers.imani2026.drive import Drive
from robins.papers.imani2026.formulations import Formulation, formulation
from robins.papers.imani2026.sensors import Sensors

UNITS: Mapping[str, float] = MappingProxyType({"r": 10.0, "v": 1.0, "theta": 0.01, "b_a": 0.01, "b_g": 0.001, "x_f": 1.0, "x_omega": 0.1})
"""Plausible errors, three components each, m, m/s, rad, m/s^2 and rad/s: the columns' units."""
THRESHOLDS = (1e-6, 1e-9)
"""Share of the largest eigenvalue below which a direction counts as unseen."""
SHORT_TIME_CONSTANT = 2.0
"""tau of the transients [s] in the brief's check; the filter's own is longer."""


def true_states(form: Formulation, driven: Drive) -> np.ndarray:
    """States of a formulation along the drive, shape (N+1, n), without biases; transients by (8), (9)."""
    states = np.zeros((driven.time.size, 22 if form.model.augmented else 16))
    states[:, R : R + 3], states[:, V : V + 3] = driven.position, driven.velocity_n
    states[:, Q0 : Q0 + 4] = driven.quaternion
    if form.model.augmented:
        to_body = Rotation.from_quat(driven.quaternion, scalar_first=True).inv()
        states[:, FORCE : FORCE + 3] = driven.specific_force_b + to_body.apply(form.model.earth.gravity)
        states[:, RATE : RATE + 3] = driven.rate_b - to_body.apply(form.model.earth.rate)
    return states


def perfect_controls(form: Formulation, driven: Drive) -> np.ndarray:
    """What drives the model along the drive, shape (N+1, 12), as `robins.papers.imani2026.formulations.controls` has it."""
    inputs = np.zeros((driven.time.size, 12))
    if not form.model.augmented:
        perfect = np.hstack([driven.specific_force_interval, driven.rate_interval])
        inputs[:-1, :6], inputs[1:, 6:] = perfect, perfect
    return inputs


def information(form: Formulation, driven: Drive, sensors: Sensors) -> np.ndarray:
    """The scaled information matrix of the initial error, shape (n, n)."""
    states, inputs = true_states(form, driven), perfect_controls(form, driven)
    n = len(form.P0)
    units = np.repeat(list(UNITS.values()), 3)[:n]
    noise = sensors.noise_sd(driven.rate_hz)
    F, Q, H = np.zeros((n, n)), np.zeros((n, n)), np.zeros((6, n))
    transition, total = np.eye(n), np.zeros((n, n))
    for k in range(driven.time.size - 1):
        linearise_strapdown(form.model, states[k], inputs[k], F, Q)
        transition = F @ transition
        linearise_inertial(form.sensor, states[k + 1], inputs[k + 1], H)
        rows = (H @ transition) * units / noise[:, None]
        total += rows.T @ rows
    return total


def ranks(matrix: np.ndarray) -> dict[float, int]:
    """Number of eigenvalues above each of `THRESHOLDS` times the largest."""
    eigenvalues = np.linalg.eigvalsh(matrix)
    return {threshold: int(np.sum(eigenvalues > threshold * eigenvalues[-1])) for threshold in THRESHOLDS}


def all_ranks(driven: Drive, sensors: Sensors) -> dict[str, tuple[dict[float, int], int]]:
    """`ranks` and number of states by formulation; F1 with a short time constant and with its own."""
    found = {}
    for name in ("F0", "F1", "F2"):
        form = formulation(name, driven.rate_hz, sensors)
        versions = {name: form}
        if name == "F1":
            short = form._replace(model=form.model._replace(decay=float(np.exp(-form.model.dt / SHORT_TIME_CONSTANT))))
            versions = {f"F1, tau = {SHORT_TIME_CONSTANT:g} s": short, "F1": form}
        for words, version in versions.items():
            found[words] = ranks(information(version, driven, sensors)), len(version.P0)
    return found
