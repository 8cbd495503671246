"""Tuning of the self-tuned scale and the gate's thresholds, with one budget for every filter, on runs that nothing else uses.

Forty-two settings a filter and trajectory: six thresholds with the data sheet's variances, and six scales times six thresholds with
self-tuned ones. Each cell of the factorial has the best of its own: ``gate`` a threshold, ``st`` a scale (no gate), ``st-gate`` both. The
criterion is the mean over the runs of the mean logarithm of the RMSE over the seven channels; a setting under which a run fails is
never chosen while another is left.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from robins.papers.ghouneem2024.filters import Design, design
from robins.papers.ghouneem2024.runs import CHANNELS, Prepared, controls, headline, prepare, run, score
from robins.papers.ghouneem2024.self_tuning import SCALES, Statistics, pooled, self_tuned, statistics
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.protocol import Output, Results, Settings

FIRST_TUNING_RUN = 1000
MULTIPLES = (0.5, 1.0, 2.0, 4.0, 8.0, np.inf)
"""Of both thresholds of the gate; infinity never rejects."""
CELLS = ("gate", "st", "st-gate")
COLUMNS = ("trajectory", "cell", "scale", "multiple", "objective", "failed", "chosen")


class Setting(NamedTuple):
    """What a tuned cell has: the scale of self-tuned Q (NaN with the data sheet's), and the multiple of the thresholds."""

    scale: float
    multiple: float


SETTINGS = (
    *(Setting(np.nan, multiple) for multiple in MULTIPLES),
    *(Setting(scale, multiple) for scale in SCALES for multiple in MULTIPLES),
)


def belongs(setting: Setting, cell: str) -> bool:
    """Whether a setting is one of a cell's."""
    self_tuning = not np.isnan(setting.scale)
    if cell == "gate":
        return not self_tuning
    return self_tuning and (cell == "st-gate" or np.isinf(setting.multiple))


class Learned(NamedTuple):
    """Statistics of the mechanisation alone and of the filter with the data sheet's variances, on one trajectory."""

    place: str
    mechanisation: Statistics
    filtered: Statistics


def learn(name: str, options: Mapping, prepared: Sequence[Prepared]) -> tuple[list[Statistics], list[Statistics]]:
    """Statistics of each run: of the mechanisation alone, and of the filter."""
    alone, filtered = design("ekf-f", options, updates=False), design(name, options)
    found = ([], [])
    for each in prepared:
        u = controls(each, alone.tilt)
        for statistics_of, made in zip(found, (alone, filtered), strict=True):
            statistics_of.append(statistics(run(made, each, u).posterior[0], each.case.place))
    return found


def tuned_design(name: str, options: Mapping, setting: Setting, learned: Learned) -> Design:
    """The filter at a setting."""
    gate = {"gate": "integrity", "multiple": setting.multiple}
    if np.isnan(setting.scale):
        return design(name, options, **gate)
    return design(name, options, self_tuned(name, "st-ms", learned.mechanisation, learned.filtered, learned.place, setting.scale), **gate)


def log_error(row: Mapping) -> float:
    """Mean logarithm of the RMSE over the channels of one run, infinite when it failed."""
    return np.inf if row["failed"] else float(np.mean(np.log([row[channel] for channel in CHANNELS])))


def chosen(objectives: np.ndarray, cell: str) -> int:
    """Index in `SETTINGS` of a cell's best."""
    own = np.array([belongs(setting, cell) for setting in SETTINGS])
    return int(np.argmin(np.where(own, objectives, np.inf))) if np.isfinite(objectives[own]).any() else int(np.argmax(own))


def search(name: str, settings: Settings, place: str) -> tuple[pd.DataFrame, dict[str, np.ndarray]]:
    """Every setting of a filter on the tuning runs of a trajectory, and the statistics behind them."""
    runs = range(FIRST_TUNING_RUN, FIRST_TUNING_RUN + settings.sizes["tuning_runs"])
    prepared = [prepare(headline(settings.seed, place), number) for number in runs]
    mechanisation, filtered = learn(name, settings.options, prepared)
    learned = Learned(place, pooled(mechanisation), pooled(filtered))
    designs = [tuned_design(name, settings.options, setting, learned) for setting in SETTINGS]
    logs, failed = np.zeros((len(designs), len(prepared))), np.zeros((len(designs), len(prepared)), bool)
    for j, each in enumerate(prepared):
        u = controls(each, designs[0].tilt)
        for i, made in enumerate(designs):
            row = score(made, each, u)
            logs[i, j], failed[i, j] = log_error(row), row["failed"]
    objectives = logs.mean(axis=1)
    rows = []
    for cell in CELLS:
        best = chosen(objectives, cell)
        rows += [
            (place, cell, setting.scale, setting.multiple, objectives[i], int(failed[i].sum()), i == best)
            for i, setting in enumerate(SETTINGS) if belongs(setting, cell)
        ]  # fmt: skip
    arrays = {}
    for source, each in (("mechanisation", mechanisation), ("filtered", filtered)):
        for field in Statistics._fields:
            arrays[f"{place}.{source}.{field}"] = np.array([getattr(one, field) for one in each])
    return pd.DataFrame(rows, columns=list(COLUMNS)), arrays


def tune(settings: Settings, name: str) -> Output:
    """Both trajectories: columns `COLUMNS`; arrays ``<trajectory>.<mechanisation or filtered>.<statistic>`` (runs, 7)."""
    tables, arrays = [], {}
    for place in TRAJECTORIES:
        table, found = search(name, settings, place)
        tables.append(table)
        arrays |= found
    return Output(pd.concat(tables, ignore_index=True), arrays)


def job_name(name: str) -> str:
    """The job that tunes a filter."""
    return f"tuning-{name}"


def learned_from(results: Results, name: str, place: str) -> Learned:
    """The pooled statistics of a tuning job."""
    arrays = results.arrays(job_name(name))
    parts = [
        Statistics(*(arrays[f"{place}.{source}.{field}"].mean(axis=0) for field in Statistics._fields))
        for source in ("mechanisation", "filtered")
    ]
    return Learned(place, *parts)


def frozen_setting(results: Results, name: str, place: str, cell: str) -> Setting:
    """What a tuning job chose for a cell on a trajectory."""
    table = results.table(job_name(name))
    row = table[(table["trajectory"] == place) & (table["cell"] == cell) & table["chosen"]].iloc[0]
    return Setting(float(row["scale"]), float(row["multiple"]))


def frozen(results: Results, settings: Settings, name: str, place: str, cell: str) -> Design:
    """The filter of a cell with the settings of the tuning runs of a trajectory."""
    return tuned_design(name, settings.options, frozen_setting(results, name, place, cell), learned_from(results, name, place))
