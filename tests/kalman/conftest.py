"""Random linear systems, and a registry that forgets what a test put into it."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import pytest

from robins.kalman import extension, weights
from robins.kalman.model import LinearModel, Sensor, linear_sensor


class Problem(NamedTuple):
    """A system with simulated measurements: `x0` ``(runs, n)``, `controls` ``(N, l)``, `measurements` ``(runs, N, m)``."""

    model: LinearModel
    sensor: Sensor
    x0: np.ndarray
    P0: np.ndarray
    controls: np.ndarray
    measurements: np.ndarray
    valid: np.ndarray

    @property
    def arguments(self) -> tuple:
        """The arguments of `run_filter` between the weighting and the number of states."""
        return self.x0, self.P0, self.controls, self.measurements, self.valid


def covariance(rng: np.random.Generator, n: int) -> np.ndarray:
    """A well-conditioned covariance ``(n, n)`` with correlations."""
    root = rng.normal(size=(n, n)) / np.sqrt(n)
    return root @ root.T + 0.5 * np.eye(n)


def make_problem(seed: int = 0, n: int = 4, m: int = 3, epochs: int = 30, runs: int = 2, **sensor) -> Problem:
    rng = np.random.default_rng(seed)
    A = 0.9 * np.linalg.qr(rng.normal(size=(n, n)))[0]
    model = LinearModel(A, rng.normal(size=(n, 2)), 0.1 * covariance(rng, n))
    D = rng.normal(size=(m, 2))
    matrices = linear_sensor(rng.normal(size=(m, n)), covariance(rng, m), **{"D": D, **sensor})
    valid = np.ones(epochs, bool)
    valid[[5, 11]] = False
    measurements = 3.0 * rng.normal(size=(runs, epochs, m))
    return Problem(model, matrices, rng.normal(size=(runs, n)), covariance(rng, n), rng.normal(size=(epochs, 2)), measurements, valid)


@pytest.fixture(scope="session")
def problem() -> Callable[..., Problem]:
    """``problem(seed, n, m, epochs, runs, **matrices of the sensor)``; two epochs have no measurement."""
    return make_problem


@pytest.fixture(scope="session")
def random_covariance() -> Callable[[np.random.Generator, int], np.ndarray]:
    """``random_covariance(rng, n)``."""
    return covariance


@pytest.fixture(scope="module")
def registry() -> Iterator[None]:
    """What a module registers is forgotten after it; entry points are then served from the disk cache again."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(extension, "_kernels", dict(extension._kernels))
        patch.setattr(extension, "_loose_ends", set(extension._loose_ends))
        patch.setattr(weights, "_latecomers", dict(weights._latecomers))
        yield
