"""What the measurements can say about each formulation's states, whatever filter reads them (proposition 2 of the register).

The information matrix ``sum_k (H_k Phi_k)^T (H_k Phi_k)`` along the drive, prior excluded, with rows in units of the noise
and columns in units of a plausible error. Its rank counts the directions of the initial error that are seen at all.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from scipy.spatial.transform import Rotation

from robins.navigation.inertial_sensor import linearise_inertial
from robins.navigation.strapdown import FORCE, Q0, RATE, linearise_strapdown, local_earth, propagate_strapdown
from robins.papers.imani2026.drive import GRAVITY, LATITUDE, Drive
from robins.papers.imani2026.formulations import Formulation, formulation
from robins.papers.imani2026.sensors import Sensors

UNITS: Mapping[str, float] = MappingProxyType({"r": 10.0, "v": 1.0, "theta": 0.01, "b_a": 0.01, "b_g": 0.001, "x_f": 1.0, "x_omega": 0.1})
"""Plausible errors, three components each, m, m/s, rad, m/s^2 and rad/s: the columns' units."""
THRESHOLDS = (1e-6, 1e-9)
"""Share of the largest eigenvalue below which a direction counts as unseen."""
SHORT_TIME_CONSTANT = 2.0
"""tau of the transients [s] in the brief's check; the filter's own is longer."""


def information(form: Formulation, driven: Drive, sensors: Sensors) -> np.ndarray:
    """The scaled information matrix of the initial error, shape (n, n).

    F and H are taken along the drive as the model itself makes it of perfect samples. Along the truth they would disagree by
    what a step leaves out, and that would look like information.
    """
    n, model = len(form.P0), form.model
    units, noise = np.repeat(list(UNITS.values()), 3)[:n], sensors.noise_sd(driven.rate_hz)
    F, Q, H = np.zeros((n, n)), np.zeros((n, n)), np.zeros((6, n))
    transition, total = np.eye(n), np.zeros((n, n))
    x, u = np.zeros(n + 1), np.zeros(12)
    x[Q0 : Q0 + 4] = driven.quaternion[0]
    for k, sample in enumerate(np.hstack([driven.specific_force_interval, driven.rate_interval])):
        linearise_inertial(form.sensor, x, u, H)
        rows = (H @ transition) * units / noise[:, None]
        total += rows.T @ rows
        u[:6] = sample
        if model.augmented:  # the transients that this step turns into those of its interval
            to_body = Rotation.from_quat(x[Q0 : Q0 + 4], scalar_first=True).inv()
            x[FORCE : FORCE + 3] = to_body.apply(driven.acceleration_n_interval[k]) / model.decay
            x[RATE : RATE + 3] = to_body.apply(driven.rate_n_interval[k]) / model.decay
        linearise_strapdown(model, x, u, F, Q)
        propagate_strapdown(model, x, u)
        transition = F @ transition
    return total


def ranks(matrix: np.ndarray) -> dict[float, int]:
    """Number of eigenvalues above each of `THRESHOLDS` times the largest."""
    eigenvalues = np.linalg.eigvalsh(matrix)
    return {threshold: int(np.sum(eigenvalues > threshold * eigenvalues[-1])) for threshold in THRESHOLDS}


def all_ranks(driven: Drive, sensors: Sensors) -> dict[str, tuple[dict[float, int], int]]:
    """`ranks` and number of states by formulation; F1 with a short time constant and with its own.

    Transport rate aside, which shows a trace of velocity.
    """
    found, earth = {}, local_earth(LATITUDE, GRAVITY)
    earth = earth._replace(transport=np.zeros_like(earth.transport))
    for name in ("F0", "F1", "F2"):
        form = formulation(name, driven.rate_hz, sensors, earth=earth)
        versions = {name: form}
        if name == "F1":
            short = form._replace(model=form.model._replace(decay=float(np.exp(-form.model.dt / SHORT_TIME_CONSTANT))))
            versions = {f"F1, tau = {SHORT_TIME_CONSTANT:g} s": short, "F1": form}
        for words, version in versions.items():
            found[words] = ranks(information(version, driven, sensors)), len(version.P0)
    return found
