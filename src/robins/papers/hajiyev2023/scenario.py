"""Section 5 of the paper: the aircraft, its sensors, the faults and one ensemble of noise.

The paper prints none of its matrices. Everything here that it does not print is a calibrated or assumed
substitute (brief, section 2; table `extra-parameters`). The angular levels exist in two branches: ``deg``
reads them as the labels of Table 1 say, ``rad`` reads the same numbers as radians.
"""

from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import NamedTuple

import numpy as np
import yaml
from numba import njit

from robins.foundation.errors import InputError
from robins.foundation.randomness import stream
from robins.kalman.differencing import difference
from robins.navigation.aircraft import ANGULAR, STATES, continuous_matrices, discretise

KEY = "hajiyev2023"
BRANCHES = ("deg", "rad")
CONDITIONS = ("fault", "healthy")
Q_CHANNEL, THETA_CHANNEL = STATES.index("q"), STATES.index("theta")
SETTLED = 30
"""Epoch from which innovations are judged."""
STEADY = slice(100, 150)
"""Epochs over which scale factors and gains are averaged: the window of M innovations lies inside the fault."""


@dataclass(frozen=True)
class Parameters:
    """The experiment's numbers, in the units of `sigma_w` etc. as labelled: m/s, and degrees or radians by branch.

    Attributes
    ----------
    branch : str
        ``deg`` or ``rad``: the unit in which the angular entries below are read.
    dt, tau : float
        Sampling time and correlation time of the INS errors, s.
    sigma_w, sigma_v, sigma_lambda, sigma_0 : tuple of 8
        Per-step process noise, white measurement noise, stationary correlated error, initial error; order `STATES`.
    window : int
        M of equation (19).
    steps : int
        N; epochs run 0..N.
    fault_start, fault_length : int
        The fault and the score cover k = start..start+length, both ends (equations 27-29).
    multiplier_q, multiplier_theta : float
        Factors on the standard deviation of the white noise of the two faulty channels.
    pitch_damping : float or None
        Replaces M_q of the plant, 1/s.
    divergence : float
        A run fails when an error passes this many m/s or rad.
    """

    branch: str = "deg"
    dt: float = 0.1
    tau: float = 100.0
    sigma_w: tuple = (0.02, 0.8, 0.01, 0.0, 0.01, 0.01, 0.002, 0.0)
    sigma_v: tuple = (0.05, 0.5, 0.02, 0.01, 0.05, 0.02, 0.05, 0.02)
    sigma_lambda: tuple = (1.0, 1.0, 0.1, 0.3, 0.3, 0.1, 0.1, 0.1)
    sigma_0: tuple = (2.0, 2.0, 0.2, 0.2, 0.2, 0.2, 0.2, 0.1)
    window: int = 20
    steps: int = 200
    fault_start: int = 80
    fault_length: int = 70
    multiplier_q: float = 8.0
    multiplier_theta: float = 5.0
    pitch_damping: float | None = None
    divergence: float = 1000.0

    @property
    def fault(self) -> slice:
        """Epochs of the fault and of the score."""
        return slice(self.fault_start, self.fault_start + self.fault_length + 1)

    @property
    def unit(self) -> np.ndarray:
        """Factor from the labelled unit of each state to SI, shape (8,)."""
        return np.where(ANGULAR & (self.branch == "deg"), np.pi / 180, 1.0)

    def si(self, name: str) -> np.ndarray:
        """A noise level in SI units, shape (8,)."""
        return np.array(getattr(self, name)) * self.unit


def baseline(branch: str) -> Parameters:
    """The frozen baseline of a branch."""
    return Parameters(branch=branch)


class System(NamedTuple):
    """Matrices of equations (1)-(5), all 8 by 8 but `B`: ``P0`` initial covariance, ``Q_lambda`` = B_n Q_U B_n^T."""

    A: np.ndarray
    B: np.ndarray
    Q: np.ndarray
    H: np.ndarray
    A_n: np.ndarray
    Q_lambda: np.ndarray
    Q_v: np.ndarray
    P0: np.ndarray
    P0_lambda: np.ndarray


@cache
def load_plant(name: str) -> dict:
    """The plant called `name` from the wing's folder ``plants``, angles in radians.

    Raises
    ------
    InputError
        There is no such plant.
    """
    folder = resources.files(__package__) / "plants"
    known = sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml"))
    if name not in known:
        raise InputError("config", f"options.{KEY}.plant", repr(name), f"one of {', '.join(known)}")
    plant = yaml.safe_load((folder / f"{name}.yaml").read_text(encoding="utf-8"))
    plant["lateral"]["theta_e"] = np.radians(plant["lateral"].pop("theta_e_deg"))
    return plant


def system(parameters: Parameters, plant: str = "f4c") -> System:
    """The matrices of a set of parameters. G = I and H = I (brief A18); INS errors by equations (25), (26)."""
    A, B = discretise(*continuous_matrices(load_plant(plant), parameters.pitch_damping), parameters.dt)
    decay = 1.0 - parameters.dt / parameters.tau  # (25), (26) hajiyev2023: one minus beta dt
    stationary = np.diag(parameters.si("sigma_lambda") ** 2)
    return System(
        A=A,
        B=B,
        Q=np.diag(parameters.si("sigma_w") ** 2),  # (3) hajiyev2023
        H=np.eye(8),
        A_n=decay * np.eye(8),  # (4) hajiyev2023
        Q_lambda=stationary * (1.0 - decay**2),  # (5) hajiyev2023: B_n Q_U B_n^T with B_n = dt I
        Q_v=np.diag(parameters.si("sigma_v") ** 2),  # (3) hajiyev2023
        P0=np.diag(parameters.si("sigma_0") ** 2),
        P0_lambda=stationary,
    )


def differenced(matrices: System):
    """The differenced measurement of equations (6)-(11) for these matrices."""
    m = matrices
    return difference(m.A, m.B, m.Q, m.H, m.A_n, m.Q_lambda, m.Q_v)


def controls(parameters: Parameters) -> np.ndarray:
    """One-degree doublets (rad), shape (N+1, 3): elevator and aileron at 1 s, rudder at 4 s, a second each way."""
    time = np.arange(parameters.steps + 1) * parameters.dt
    doublet = ((time >= 1) & (time < 2)).astype(float) - ((time >= 2) & (time < 3))
    later = ((time >= 4) & (time < 5)).astype(float) - ((time >= 5) & (time < 6))
    return np.radians(np.column_stack([doublet, doublet, later]))


class Draws(NamedTuple):
    """Standard normal numbers of an ensemble: w, v, U ``(runs, N+1, 8)``; initial state error and lambda ``(runs, 8)``."""

    w: np.ndarray
    v: np.ndarray
    U: np.ndarray
    initial_error: np.ndarray
    initial_lambda: np.ndarray


def stream_names(scenario: str, run: int) -> list[str]:
    """The names of the five streams of a run."""
    return [f"{KEY}/{scenario}/{run}/{sensor}" for sensor in ("w", "v", "U", "initial-error", "initial-lambda")]


def draw(seed: int, scenario: str, runs: range, steps: int) -> Draws:
    """The named streams of `runs`; both branches and all filters of a scenario share them."""
    epochs = (len(runs), steps + 1, 8)
    draws = Draws(np.empty(epochs), np.empty(epochs), np.empty(epochs), np.empty((len(runs), 8)), np.empty((len(runs), 8)))
    for row, run in enumerate(runs):
        for name, array in zip(stream_names(scenario, run), draws, strict=True):
            stream(seed, name).standard_normal(out=array[row])
    return draws


class Ensemble(NamedTuple):
    """Truth and measurements: state `x` and error `lam` ``(runs, N+1, 8)``, `z` by condition, first guess ``(runs, 8)``."""

    x: np.ndarray
    lam: np.ndarray
    z: dict
    guess: np.ndarray


@njit(cache=True)
def linear_recursion(A, forcing, start):
    """``x(k) = A x(k-1) + forcing(k-1)`` for `forcing` ``(runs, N+1, n)`` and `start` ``(runs, n)``."""
    x = np.empty_like(forcing)
    for run in range(forcing.shape[0]):
        x[run, 0] = start[run]
        for k in range(1, forcing.shape[1]):
            for i in range(forcing.shape[2]):
                total = forcing[run, k - 1, i]
                for j in range(forcing.shape[2]):
                    total += A[i, j] * x[run, k - 1, j]
                x[run, k, i] = total
    return x


def simulate(parameters: Parameters, matrices: System, draws: Draws) -> Ensemble:
    """Truth, correlated errors and measurements of every run, with and without the fault. Equations (1)-(5), (27), (28)."""
    inputs = controls(parameters) @ matrices.B.T
    start = np.zeros_like(draws.initial_error)
    x = linear_recursion(matrices.A, inputs + draws.w * parameters.si("sigma_w"), start)  # (1) hajiyev2023
    drive = draws.U * np.sqrt(np.diag(matrices.Q_lambda))
    lam = linear_recursion(matrices.A_n, drive, draws.initial_lambda * parameters.si("sigma_lambda"))  # (4) hajiyev2023
    v = draws.v * parameters.si("sigma_v")
    faulty = v.copy()
    faulty[:, parameters.fault, Q_CHANNEL] *= parameters.multiplier_q  # (27) hajiyev2023, as the text says: x 8
    faulty[:, parameters.fault, THETA_CHANNEL] *= parameters.multiplier_theta  # (28) hajiyev2023: x 5
    z = {"fault": x + lam + faulty, "healthy": x + lam + v}  # (2) hajiyev2023, H = I
    return Ensemble(x, lam, z, draws.initial_error * parameters.si("sigma_0"))
