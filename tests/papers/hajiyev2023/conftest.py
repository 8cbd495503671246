"""One simulated problem of the wing, made on demand. The tests have streams and a seed of their own."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from robins.kalman.filter import Record
from robins.papers.hajiyev2023 import estimators, scenario
from robins.papers.hajiyev2023.scenario import Ensemble, Parameters, System, baseline, draw, simulate, system

SEED = 1


class Problem(NamedTuple):
    """Parameters, matrices and simulated runs that belong together."""

    parameters: Parameters
    matrices: System
    ensemble: Ensemble

    def run(self, form: estimators.Filter, condition: str = "healthy") -> Record:
        """Run a filter over every record."""
        return estimators.run(form, self.parameters, self.matrices, self.ensemble, condition)


@cache
def make_problem(runs: int, branch: str = "deg", scenario: str = "tests", **changes) -> Problem:
    parameters = replace(baseline(branch), **changes)
    matrices = system(parameters)
    return Problem(parameters, matrices, simulate(parameters, matrices, draw(SEED, scenario, range(runs), parameters.steps)))


@pytest.fixture(scope="session")
def problem() -> Callable[..., Problem]:
    """``problem(runs, branch, **changes of Parameters)``; the same arguments give the same object."""
    return make_problem


@pytest.fixture
def without_inputs(monkeypatch) -> Callable[[Problem], Problem]:
    """Switch every input to zero, in simulation and filters; the fixture's function simulates a problem again with the same noise."""

    def again(case: Problem) -> Problem:
        for module in (scenario, estimators):
            monkeypatch.setattr(module, "controls", lambda parameters: np.zeros((parameters.steps + 1, 3)))
        draws = draw(SEED, "tests", range(len(case.ensemble.x)), case.parameters.steps)
        return case._replace(ensemble=simulate(case.parameters, case.matrices, draws))

    return again
