"""Tuning with one budget for all: sixteen settings of two knobs for each family, on runs that nothing else uses.

A 3 x 3 grid around the conventional setting is evaluated, then one row and one column more, on the side of the optimum (or,
where the optimum is in the middle, of its better neighbour). So an optimum at an edge extends the grid once, and every family
has exactly sixteen settings. The objective is the mean over the twelve channels of the logarithm of the ensemble RMSE against
the truth in F1; a setting under which a run fails is never chosen.

The brief asks for an equal number of evaluated settings. That every family also shares the multiplier of R, and that the own knobs of
all robust families go equally far, a factor of four on either side of the conventional setting, are choices of ours: without the first,
what a robust filter gains could be the gain of another R, without the second that of a longer grid. The EKF's own knob, the multiplier
of Q, has steps of a third of a decade, so that its sixteen settings are sixteen ratios of Q to R.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.ensemble import Case, headline, scores, tuning_runs
from robins.papers.imani2026.methods import FAMILIES, Setting, tuned
from robins.papers.imani2026.sensors import Outliers, Sensors
from robins.papers.protocol import Output, Settings

NOISE_SCALES = (0.1, 1.0, 10.0)
NOISE_BELOW, NOISE_ABOVE = 0.01, 100.0
RETUNED_RATE = 0.02
"""Share of outliers, two-sided, under which every family is tuned a second time."""
CONDITIONS = ("headline", "outliers")


def case_of(settings: Settings, condition: str) -> Case:
    """The headline condition, or the same with outliers."""
    case = headline(settings)
    return case if condition == "headline" else case._replace(sensors=Sensors(outliers=Outliers(rate=RETUNED_RATE)))


def objective(table: pd.DataFrame) -> float:
    """Mean over the channels of log ensemble RMSE, infinite when a run failed; `table` is that of one filter's scores."""
    if table["failed"].any():
        return np.inf
    squares = np.square(table["rmse"].to_numpy()).reshape(-1, len(CHANNELS))
    return float(np.mean(0.5 * np.log(np.mean(squares, axis=0))))


def evaluate(family: str, settings: Settings, case: Case, wanted: list[Setting]) -> tuple[list[float], list[int]]:
    """Objective and number of failed runs of each wanted setting."""
    methods = {str(i): tuned(family, settings.options, setting) for i, setting in enumerate(wanted)}
    by_filter = dict(list(scores(case, tuning_runs(settings), methods).groupby("filter")))
    tables = [by_filter[str(i)] for i in range(len(wanted))]
    return [objective(table) for table in tables], [int(table["failed"].sum()) // len(CHANNELS) for table in tables]


def outward(values: tuple[float, ...], losses: np.ndarray, below: float, above: float) -> float:
    """The value that a grid of three is extended by, given the best loss at each of its values."""
    best = int(np.argmin(losses))
    if best == 1:
        best = 0 if losses[0] <= losses[2] else 2
    return below if best == 0 else above


def search(family: str, settings: Settings, condition: str) -> pd.DataFrame:
    """Every evaluated setting of a family under a condition."""
    case, knob = case_of(settings, condition), FAMILIES[family]
    grid = [Setting(scale, value) for scale in NOISE_SCALES for value in knob.grid]
    found, failed = evaluate(family, settings, case, grid)
    losses = np.array(found).reshape(len(NOISE_SCALES), len(knob.grid))
    new_scale = outward(NOISE_SCALES, losses.min(axis=1), NOISE_BELOW, NOISE_ABOVE)
    new_value = outward(knob.grid, losses.min(axis=0), knob.values[0], knob.values[-1])
    more = [Setting(new_scale, value) for value in (*knob.grid, new_value)] + [Setting(scale, new_value) for scale in NOISE_SCALES]
    found_more, failed_more = evaluate(family, settings, case, more)
    settings_of = pd.DataFrame([*grid, *more], columns=["noise_scale", "value"])
    table = settings_of.assign(
        stage=["grid"] * len(grid) + ["extension"] * len(more),
        objective=[*found, *found_more],
        failed=[*failed, *failed_more],
    )
    if not np.isfinite(table["objective"]).any():
        raise ArithmeticError(f"{family}, {condition}: a run fails under every setting")
    table["chosen"] = table.index == table["objective"].idxmin()
    return table.assign(condition=condition, parameter=knob.parameter)


def tune(settings: Settings, family: str) -> Output:
    """Both conditions of one family: columns condition, noise_scale, parameter, value, stage, objective, failed, chosen."""
    table = pd.concat([search(family, settings, condition) for condition in CONDITIONS], ignore_index=True)
    return Output(table[["condition", "noise_scale", "parameter", "value", "stage", "objective", "failed", "chosen"]])


def budget(tables: Mapping[str, pd.DataFrame]) -> dict[str, int]:
    """Evaluated settings by family under the headline condition; `tables` are those of the tuning jobs."""
    return {family: int((table["condition"] == CONDITIONS[0]).sum()) for family, table in tables.items()}
