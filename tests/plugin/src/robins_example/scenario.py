"""Section 3 of the example: the cart runs two hundred metres while one range in ten takes a detour over a wall."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from robins.foundation.randomness import standard_normals, stream
from robins.papers.protocol import Output, Settings

KEY = "example2026"


@dataclass(frozen=True)
class Parameters:
    """The experiment's numbers: m, s, and 1/m for the drag."""

    dt: float = 0.2
    steps: int = 200
    drag: float = 0.005
    acceleration_sd: float = 0.3
    beacons: tuple = ((0.0, 20.0), (100.0, 10.0), (200.0, 20.0))
    range_sd: float = 0.5
    detour: float = 15.0
    detour_share: float = 0.1
    first_guess_sd: tuple = (5.0, 1.0)
    divergence: float = 100.0

    @property
    def controls(self) -> np.ndarray:
        """Commanded acceleration, shape (N, 1): forward for three quarters of the time, then brakes."""
        return np.where(np.arange(self.steps) < 0.75 * self.steps, 0.5, -0.5)[:, None]

    @property
    def inflation(self) -> float:
        """Mean square of a range error, detours included, over that of the noise alone."""
        return 1.0 + self.detour_share * self.detour**2 / self.range_sd**2


class Ensemble(NamedTuple):
    """`truth` ``(runs, N, 2)``, its measured `ranges` ``(runs, N, m)`` and the filters' first `guess` ``(runs, 2)``."""

    truth: np.ndarray
    ranges: np.ndarray
    guess: np.ndarray


def simulate(p: Parameters, seed: int, runs: int) -> Ensemble:
    """Every run from its own named streams, so that it depends on nothing else; all filters share it."""

    def names(sensor):
        return [f"{KEY}/rail/{run}/{sensor}" for run in range(runs)]

    beacons = np.array(p.beacons)
    push = p.controls[:, 0] + p.acceleration_sd * standard_normals(seed, names("acceleration"), (p.steps,))
    truth = np.zeros((runs, p.steps, 2))
    for k in range(p.steps - 1):
        position, velocity = truth[:, k].T
        truth[:, k + 1, 0] = position + p.dt * velocity
        truth[:, k + 1, 1] = velocity + p.dt * (push[:, k] - p.drag * velocity * np.abs(velocity))
    exact = np.hypot(truth[:, :, :1] - beacons[:, 0], beacons[:, 1])
    noise = p.range_sd * standard_normals(seed, names("range"), exact.shape[1:])
    reflected = np.array([stream(seed, name).random(exact.shape[1:]) for name in names("reflection")]) < p.detour_share
    guess = standard_normals(seed, names("first-guess"), (2,)) * p.first_guess_sd
    return Ensemble(truth, exact + noise + p.detour * reflected, guess)


def rail(settings: Settings) -> Output:
    """The scenario's job: run 0, and its range errors for the noise diagnostics."""
    p = Parameters()
    ensemble = simulate(p, settings.seed, 1)
    truth = ensemble.truth[0]
    exact = np.hypot(truth[:, :1] - np.array(p.beacons)[:, 0], np.array(p.beacons)[:, 1])
    arrays = {"residual.range": ensemble.ranges[0] - exact, "rate_hz.range": np.array(1.0 / p.dt)}
    return Output(pd.DataFrame(truth, columns=["position", "velocity"]), arrays)
