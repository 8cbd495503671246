"""What the wing's tables, figures and claims share: scores by run, ensemble levels and improvements, Holm's adjustment.

An ensemble value is the root mean square of a run's RMSE (or standard deviation) over the runs, and the mean of the absolute
value for the mean error and the final drift. An improvement is one minus the ratio of two ensemble values, a fraction. All
channels and measures of a pair come from one set of resampled runs, computed once for a `Results`.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd

from robins.evaluate.ensembles import Improvement, Level, ensemble_improvement, ensemble_level, holm, multiplicities
from robins.foundation.randomness import stream
from robins.papers.imani2026.drive import CHANNELS, DURATION, KEY
from robins.papers.imani2026.scoring import AVERAGED
from robins.papers.memory import once
from robins.papers.protocol import Results

__all__ = [
    "GROUPS", "METRICS", "PAIR", "PRINTED_PAIR", "Improvement", "Level", "Scores", "adjusted", "holm", "improvement", "improvements",
    "level", "of_channel", "scores", "sweep_improvement", "sweep_improvements", "sweep_level", "sweep_scores",
]  # fmt: skip

PAIR = ("mk-norm-gain", "ci-seq")
"""The paper's comparison: its MKMC-EKF over its CI-RKF, both tuned with one budget."""
PRINTED_PAIR = ("mk-raw", "ci-seq-nominal")
"""The same with the equations as printed."""
METRICS = ("rmse", "mean", "sd", "drift")
POWER = {"rmse": 2, "mean": 1, "sd": 2, "drift": 1}
"""How a metric is averaged over the runs: root mean square, or mean absolute value."""
GROUPS = {
    "velocity": CHANNELS[:3],
    "acceleration": CHANNELS[3:6],
    "angular rate": CHANNELS[6:9],
    "Euler angles": CHANNELS[9:],
}
"""The paper's domains."""

Filter = str | Mapping
"""A filter of a study: its name in the column ``filter``, or its labels where a study names filters by several columns."""


class Scores(NamedTuple):
    """Measures of a filter by run and channel, SI; see `robins.papers.imani2026.scoring.Measures`.

    Attributes
    ----------
    rmse, mean, sd, drift, drift_integral : ndarray, shape (runs, 12)
        NaN in a run that failed.
    failed : ndarray of bool, shape (runs,)
    """

    rmse: np.ndarray
    mean: np.ndarray
    sd: np.ndarray
    drift: np.ndarray
    drift_integral: np.ndarray
    failed: np.ndarray


def _grouped_matrices(table: pd.DataFrame, names: list[str], columns) -> dict[tuple, dict[str, np.ndarray]]:
    """Columns of a long table as (runs, channels), runs in order, for every combination of the labels `names`."""
    run, channel = table["run"].to_numpy(), table["channel"].to_numpy()
    values = {name: table[name].to_numpy() for name in columns}
    grouped = {}
    for key, rows in table.groupby(names, sort=False).indices.items():
        rows = rows[np.argsort(run[rows], kind="stable")]
        channels = CHANNELS if len(rows) % len(CHANNELS) == 0 and channel[rows[0]] == CHANNELS[0] else CHANNELS[AVERAGED]
        if len(rows) % len(channels) or not np.array_equal(
            channel[rows].reshape(-1, len(channels)), [channels] * (len(rows) // len(channels))
        ):
            raise ValueError(f"{key}: not one row for each run and channel in the order of the channels")
        grouped[key] = {name: column[rows].reshape(-1, len(channels)) for name, column in values.items()}
    return grouped


def scores(results: Results, variant: str, formulation: str, against: str = "truth") -> Scores:
    """Measures of a variant; against ``interval`` velocity and angles are those against ``truth``, which have no average."""
    return once(results, ("scores", variant), lambda: _arranged(results, variant))[formulation, against]


def _arranged(results: Results, variant: str) -> dict[tuple[str, str], Scores]:
    arranged = {}
    for key, columns in _grouped_matrices(results.table(variant), ["formulation", "against"], Scores._fields).items():
        failed = columns.pop("failed")[:, 0].astype(bool)
        arranged[key] = Scores(**columns, failed=failed)
    for (name, against), found in list(arranged.items()):
        if against == "interval":
            arranged[name, against] = _completed(found, arranged[name, "truth"])
    return arranged


def _completed(averaged: Scores, complete: Scores) -> Scores:
    """Scores of all channels from those of acceleration and rate and those of all against another truth."""
    columns = {}
    for name in Scores._fields[:-1]:
        columns[name] = getattr(complete, name).copy()
        columns[name][:, AVERAGED] = getattr(averaged, name)
    return Scores(**columns, failed=averaged.failed)


def sweep_scores(results: Results, study: str, where: Mapping, of: Filter) -> Scores:
    """Measures of a filter in a study, at the labels `where` (every column in front of ``run`` but the filter's)."""
    by_labels = once(results, ("sweep", study), lambda: _grouped(results, study))
    labels = _labels(where, of)
    key = frozenset(labels.items())
    if key not in by_labels:
        raise LookupError(f"study {study} has no row with {labels}")
    return by_labels[key]


def _labels(where: Mapping, of: Filter) -> dict:
    return {**where, **({"filter": of} if isinstance(of, str) else of)}


def _grouped(results: Results, study: str) -> dict[frozenset, Scores]:
    table = results.table(study)
    names = list(table.columns[: table.columns.get_loc("run")])
    grouped = {}
    for values, columns in _grouped_matrices(table, names, ("rmse", "mean", "drift", "failed")).items():
        rmse, mean = columns["rmse"], columns["mean"]
        sd = np.sqrt(np.maximum(rmse**2 - mean**2, 0.0))
        # The sum of the errors times dt is the mean times the duration: equation (45).
        failed = columns["failed"][:, 0].astype(bool)
        grouped[frozenset(zip(names, values, strict=True))] = Scores(rmse, mean, sd, columns["drift"], mean * DURATION, failed)
    return grouped


def _resampling(results: Results, what: str) -> np.random.Generator:
    return stream(results.settings.seed, f"{KEY}/bootstrap/0/{what}")


def _improvements(results: Results, above: Scores, below: Scores, metric: str, what: str) -> Improvement:
    """`Improvement` of every channel; the stream `what` draws the same resamples for every metric."""
    counts = multiplicities(_resampling(results, what), len(above.failed), results.settings.sizes["bootstrap"])
    return ensemble_improvement(getattr(above, metric), getattr(below, metric), above.failed, below.failed, POWER[metric], counts)


def _levels(results: Results, found: Scores, metric: str, what: str) -> Level:
    bootstrap = results.settings.sizes["bootstrap"]
    return ensemble_level(getattr(found, metric), found.failed, POWER[metric], _resampling(results, what), bootstrap)


def of_channel(found, channel: str):
    """One channel of a `Level` or an `Improvement` of all channels."""
    i = CHANNELS.index(channel)
    return type(found)(*(float(value[i]) if isinstance(value, np.ndarray) else value for value in found))


def level(results: Results, variant: str, formulation: str, against: str, metric: str, channel: str) -> Level:
    """Ensemble value of a metric of one filter, SI, with its bootstrap interval."""

    def make() -> Level:
        return _levels(results, scores(results, variant, formulation, against), metric, f"{variant}-{formulation}-{against}")

    return of_channel(once(results, ("level", variant, formulation, against, metric), make), channel)


def improvements(results: Results, numerator: str, denominator: str, formulation: str, against: str, metric: str) -> Improvement:
    """`improvement` of all twelve channels."""

    def make() -> Improvement:
        above, below = (scores(results, name, formulation, against) for name in (numerator, denominator))
        return _improvements(results, above, below, metric, f"{numerator}-over-{denominator}-{formulation}-{against}")

    return once(results, ("improvement", numerator, denominator, formulation, against, metric), make)


def improvement(
    results: Results, numerator: str, denominator: str, formulation: str, against: str, metric: str, channel: str
) -> Improvement:
    """By how much the numerator's filter is better in a metric of a channel; see `robins.evaluate.ensembles.Improvement`."""
    return of_channel(improvements(results, numerator, denominator, formulation, against, metric), channel)


def _words(labels: Mapping) -> str:
    """Labels as a part of a stream's name, whatever their order."""
    return "-".join(f"{value:g}" if isinstance(value, float) else str(value) for _, value in sorted(labels.items()))


def sweep_level(results: Results, study: str, where: Mapping, of: Filter, metric: str, channel: str) -> Level:
    """`level` of a filter in a study."""
    labels = _labels(where, of)

    def make() -> Level:
        return _levels(results, sweep_scores(results, study, where, of), metric, f"{study}-{_words(labels)}")

    return of_channel(once(results, ("sweep-level", study, frozenset(labels.items()), metric), make), channel)


def sweep_improvements(results: Results, study: str, where: Mapping, numerator: Filter, denominator: Filter, metric: str) -> Improvement:
    """`sweep_improvement` of all twelve channels."""
    sides = [_labels({}, side) for side in (numerator, denominator)]

    def make() -> Improvement:
        above, below = (sweep_scores(results, study, where, side) for side in (numerator, denominator))
        return _improvements(results, above, below, metric, f"{_words(sides[0])}-over-{_words(sides[1])}-{study}-{_words(where)}")

    key = ("sweep-improvement", study, *(frozenset(labels.items()) for labels in (where, *sides)), metric)
    return once(results, key, make)


def sweep_improvement(
    results: Results, study: str, where: Mapping, numerator: Filter, denominator: Filter, metric: str, channel: str
) -> Improvement:
    """`improvement` from the rows of a study.

    Parameters
    ----------
    study : str
        ``outliers``, ``scale``, ``grades``, ``rates`` or ``grids``.
    where : mapping
        Every label of the row (the columns in front of ``run``) but the filter's, such as ``{"grade": "vehicle"}``.
    numerator, denominator : str or mapping
        Value of the column ``filter``, or labels such as ``{"method": "mk-norm", "scale": 1.0}`` in the studies without one.
    """
    return of_channel(sweep_improvements(results, study, where, numerator, denominator, metric), channel)


def adjusted(found: Improvement) -> np.ndarray:
    """Holm's p values of the twelve channels of one comparison, shape (12,)."""
    return holm(found.p)
