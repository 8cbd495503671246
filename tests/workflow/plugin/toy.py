"""A paper that does not exist: does halving the mean of twenty readings make it better? Registered as a plug-in."""

from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as Drawing
from toykernel import READINGS, errors, readings

from robins.evaluate.ledger import Row
from robins.papers.protocol import Claim, Column, Figure, Job, Output, Paper, Table

MODULES = ("toykernel",)
HERE = Path(__file__).parent
FIRST_TUNING_RUN = 1000


def reported(settings):
    """The runs that results are reported from."""
    return range(settings.sizes["runs"])


def held_back(settings):
    """The runs that weights are tried on."""
    return range(FIRST_TUNING_RUN, FIRST_TUNING_RUN + settings.sizes["tuning_runs"])


def constant(settings):
    """The scenario: run 0 and its residuals."""
    first = readings(settings, [0])[0]
    arrays = {"residual.gauge": first - settings.options["level"], "sd.gauge": np.array([1.0])}
    return Output(pd.DataFrame({"reading": first}), arrays)


def variant(name, weight):
    """One row of the registry."""
    return Job(name, name, lambda settings: Output(errors(settings, weight, reported(settings))), MODULES, {"weight": weight}, "classical")


def tuning(settings, weights):
    """A study: how wrong the mean is with each of these weights."""
    tried = [errors(settings, weight, held_back(settings))["error"].mean() for weight in weights]
    return Output(pd.DataFrame({"weight": weights, "error": tried}))


def tuned(settings, results):
    """A variant with the best of the weights that have been tried."""
    tried = results.table("tuning")
    return Output(errors(settings, tried["weight"][tried["error"].idxmin()], reported(settings)))


def theory(settings):
    """A study: the standard deviation of the mean."""
    return Output(pd.DataFrame({"sd": [READINGS**-0.5]}))


def errors_table(results):
    """Mean error of both variants."""
    rows = [(name, float(results.table(name)["error"].mean()), len(results.table(name)), 0) for name in ("plain", "shrunk")]
    return pd.DataFrame(rows, columns=["filter", "error", "n", "failed"])


def plain_table(results):
    """Mean error of one variant beside what theory says."""
    return pd.DataFrame({"filter": ["plain"], "error": [results.table("plain")["error"].mean()], "sd": [results.table("theory")["sd"][0]]})


def draw(results):
    """Errors over the runs."""
    drawing = Drawing()
    drawing.add_subplot().plot(results.table("plain")["error"] - results.table("tuned")["error"])
    return drawing


def judge(results):
    """Is the halved mean worse?"""
    ratio = results.table("shrunk")["error"].mean() / results.table("plain")["error"].mean()
    n = len(results.table("plain"))
    return [Row("C1", "error ratio", "overall", ratio, ratio / 2, ratio * 2, n, "shrunk", "direction only", "It is worse.")]


ERROR = Column("error", "number")

PAPER = Paper(
    key="toy",
    title="A toy",
    citation="Nobody (2026)",
    doi="",
    summary="A constant is read twenty times.",
    scenarios=(Job("constant", "a constant", constant, MODULES),),
    variants=(variant("plain", 1.0), variant("shrunk", 0.5), Job("tuned", "tuned", tuned, MODULES, needs=("tuning",))),
    studies=(Job("theory", "theory", theory, MODULES), Job("tuning", "tuning", partial(tuning, weights=(0.9, 1.0)), MODULES)),
    tables=(
        Table(
            "table-1",
            "Errors",
            "Table 1",
            (Column("filter", "key"), ERROR, Column("n", "count"), Column("failed", "count")),
            errors_table,
            ("plain", "shrunk"),
            MODULES,
            size="runs",
        ),
        Table(
            "extra-plain",
            "Error and theory",
            "",
            (Column("filter", "key"), ERROR, Column("sd", "number")),
            plain_table,
            ("plain", "theory"),
            MODULES,
            size="runs",
        ),
    ),
    figures=(Figure("figure-01", "Errors", "Fig. 1", draw, ("plain", "tuned"), MODULES, size="runs"),),
    claims=(Claim("C1", "Halving the mean makes it worse.", judge, ("plain", "shrunk"), MODULES, "runs", 4),),
    equations=(),
    assumptions=(),
    sizes={name: {"runs": size, "tuning_runs": 4} for name, size in (("smoke", 8), ("standard", 40), ("full", 80))},
    first_runs={"tuning_runs": FIRST_TUNING_RUN},
    options={"level": 3.0},
    published=HERE / "toy.csv",
    notebook=HERE / "toy.ipynb",
)
