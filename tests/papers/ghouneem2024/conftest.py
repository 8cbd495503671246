"""Small ensembles: every job of the wing over two or three runs, computed when it is asked for and once a session; runs to order."""

from collections.abc import Callable
from functools import cache, partial
from typing import NamedTuple

import numpy as np
import pytest

from robins.evaluate.published import read_published
from robins.kalman.filter import Record
from robins.papers.ghouneem2024 import cost, ensemble, in_sample, studies, theory, traces, tune
from robins.papers.ghouneem2024.filters import FILTERS, Design, design
from robins.papers.ghouneem2024.gps import ENVIRONMENTS
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.runs import Case, Prepared, controls, headline, prepare, run, truth
from robins.papers.ghouneem2024.trajectories import KEY, TRAJECTORIES
from robins.papers.ghouneem2024.variants import VARIANTS
from robins.papers.protocol import Output, Results, Settings

SEED = 1
SIZES = {"runs": 3, "side_runs": 2, "in_sample_runs": 1, "tuning_runs": 1, "calibration_runs": 2, "bootstrap": 200}
ALONE = ("calibration", "cause", "initialisation", "unscented", "prior", "ablations", "long-outage", "jump")
TUNED = ("severity", "literal")
"""Studies that need nothing, and those that need tuning jobs."""
RECORDED = {"ratio": 1.7, "least": 1.6, "greatest": 1.9, "rounds": 5, "ekf_us": 1.0, "ukf_us": 1.7, "machine": {"cores": 2}}
"""In the place of the benchmark record, which may be absent."""


def compute(name: str, settings: Settings, results: Results) -> Output:
    """The job called `name`."""
    if name in TRAJECTORIES:
        return ensemble.scenario(settings, name)
    if name in VARIANTS:
        return ensemble.variant(settings, results, composition=VARIANTS[name].composition)
    if name.startswith("tuning-"):
        return tune.tune(settings, name.removeprefix("tuning-"))
    others = {
        "in-sample": in_sample.in_sample,
        "theory": theory.theory,
        "traces": partial(traces.traces, results=results),
        "cost": partial(cost.cost, recorded=RECORDED),
    }
    others |= {study: getattr(studies, study.replace("-", "_")) for study in ALONE}
    others |= {study: partial(getattr(studies, study), results=results) for study in TUNED}
    return others[name](settings)


JOBS = (*TRAJECTORIES, *map(tune.job_name, FILTERS), *VARIANTS, *ALONE, *TUNED, "in-sample", "theory", "traces", "cost")


@pytest.fixture(scope="session")
def settings() -> Callable[..., Settings]:
    """``settings(**changes of sizes and options)`` of a small ensemble with the tests' seed."""

    def made(ensemble: str = "smoke", **changes) -> Settings:
        sizes = SIZES | {key: value for key, value in changes.items() if key in SIZES}
        options = OPTIONS | {key: value for key, value in changes.items() if key not in SIZES}
        return Settings(ensemble, SEED, sizes, options)

    return made


@pytest.fixture(scope="session")
def results(repository, settings) -> Results:
    """Results over every job of the wing, each computed when it is first asked for."""
    published = read_published(repository / "data" / "published" / f"{KEY}.csv")
    found = Results(settings(), published, lambda name: compute(name, found.settings, found))
    return found


class Flown(NamedTuple):
    """What a filter made of a run, and its errors (N+1, 7), the azimuth's wrapped by hand."""

    design: Design
    prepared: Prepared
    record: Record
    error: np.ndarray

    @property
    def refused(self) -> np.ndarray:
        """Which fixes were not used at all, shape (M,)."""
        return (self.record.weights[0, self.prepared.fixes.epoch] == 0.0).all(axis=1)

    @property
    def horizontal(self) -> float:
        """RMSE, m."""
        return float(np.sqrt(np.mean(self.error[:, :2] ** 2, axis=0).sum()))


@cache
def case_of(place: str, severity: float) -> Case:
    return headline(SEED, place)._replace(environment=ENVIRONMENTS[place].scaled(severity))


@cache
def prepare_once(place: str, number: int, severity: float) -> Prepared:
    return prepare(case_of(place, severity), number)


@pytest.fixture(scope="session")
def prepared() -> Callable[..., Prepared]:
    """``prepared(place, run, severity)``; the same arguments give the same object, not to be written to."""
    return lambda place="t1", number=100, severity=1.0: prepare_once(place, number, severity)


@pytest.fixture(scope="session")
def fly() -> Callable[..., Flown]:
    """``fly(filter or design, prepared run, **fields of the design)``."""

    def flown(made: str | Design, samples: Prepared, **fields) -> Flown:
        made = design(made, OPTIONS, **fields) if isinstance(made, str) else made
        record = run(made, samples, controls(samples, made.tilt))
        error = record.posterior[0, :, :7] - truth(samples.case.place)
        error[:, 6] = np.angle(np.exp(1j * error[:, 6]))
        return Flown(made, samples, record, error)

    return flown
