"""A few runs of the campus drive and the filters that follow it, simulated once a session; settings and tuning results to order."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import pandas as pd
import pytest

from robins.kalman.filter import Record
from robins.papers.imani2026 import drive as driving
from robins.papers.imani2026.ensemble import Case, build, run
from robins.papers.imani2026.formulations import Formulation
from robins.papers.imani2026.methods import FAMILIES, Method
from robins.papers.imani2026.options import OPTIONS
from robins.papers.imani2026.scoring import errors, estimates
from robins.papers.imani2026.sensors import Measurements, Sensors, measure
from robins.papers.protocol import Output, Results, Settings

SEED = 1
SIZES = {"runs": 2, "tuning_runs": 1, "sweep_runs": 2, "fast_runs": 1, "bootstrap": 200}


class Followed(NamedTuple):
    """What a filter made of a journey: its record, its channels (runs, N+1, 12) and their errors at the epochs 1..N."""

    form: Formulation
    record: Record
    estimate: np.ndarray
    error: np.ndarray


class Journey(NamedTuple):
    """Samples of some runs of the drive, and the case that they belong to."""

    case: Case
    measured: Measurements

    def follow(self, name: str, method: Method, marks=(), form: Formulation | None = None, **more) -> Followed:
        """Run a filter that believes in the default sensors, whatever those of the journey are."""
        form = form or build(name, method, self.case._replace(sensors=Sensors()), **more)
        record = run(form, method, self.case, self.measured, marks)
        estimate = estimates(form, record, self.measured)
        return Followed(form, record, estimate, errors(estimate, driving.truth(self.case.driven)))


@cache
def make_journey(runs: int, sensors: Sensors, rate_hz: int) -> Journey:
    case = Case(SEED, rate_hz, sensors)
    return Journey(case, measure(SEED, case.scenario, range(runs), case.driven, sensors))


@pytest.fixture(scope="session")
def journey() -> Callable[..., Journey]:
    """``journey(runs, sensors, rate_hz)``; the same arguments give the same object."""
    return lambda runs=2, sensors=None, rate_hz=10: make_journey(runs, sensors or Sensors(), rate_hz)


@pytest.fixture(scope="session")
def silent() -> Sensors:
    """Sensors without any error."""
    quiet = {name: 0.0 for name, value in vars(Sensors()).items() if isinstance(value, float)}
    return replace(Sensors(), **quiet)


@pytest.fixture(scope="session")
def settings() -> Callable[..., Settings]:
    """``settings(**changes of sizes and options)`` of a small ensemble with the tests' seed."""

    def made(ensemble: str = "smoke", **changes) -> Settings:
        sizes = SIZES | {key: value for key, value in changes.items() if key in SIZES}
        options = OPTIONS | {key: value for key, value in changes.items() if key not in SIZES}
        return Settings(ensemble, SEED, sizes, options)

    return made


@pytest.fixture(scope="session")
def tuned_results() -> Callable[..., Results]:
    """``tuned_results(settings, {(family, condition): (noise_scale, value)})``: tuning jobs that chose these, else the usual values."""

    def made(settings: Settings, chosen: Mapping = MappingProxyType({})) -> Results:
        def load(job: str) -> Output:
            family = job.removeprefix("tuning-")
            rows = []
            for condition in ("headline", "outliers"):
                scale, value = chosen.get((family, condition), (1.0, FAMILIES[family].grid[1]))
                rows += [(condition, 77.0, 77.0, False), (condition, scale, value, True)]
            return Output(pd.DataFrame(rows, columns=["condition", "noise_scale", "value", "chosen"]))

        return Results(settings, pd.DataFrame(), load)

    return made
