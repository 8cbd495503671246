"""The run that the figures show: the one whose ratio of horizontal errors, new method over incremental EKF, is the median of all.

Chosen by that rule on each trajectory, never by eye; with an even number of runs the lower of the two in the middle.
"""

import numpy as np
import pandas as pd

from robins.papers.ghouneem2024.ensemble import UNTUNED
from robins.papers.ghouneem2024.filters import Design, design
from robins.papers.ghouneem2024.runs import controls, headline, prepare, run, truth
from robins.papers.ghouneem2024.studies import HEADLINE
from robins.papers.ghouneem2024.trajectories import RATE_HZ, TRAJECTORIES
from robins.papers.ghouneem2024.tune import frozen
from robins.papers.ghouneem2024.variants import NEW
from robins.papers.protocol import Output, Results, Settings

BASELINE = "ekf-pi"
SHOWN = ("riss-only", "ekf-pi", "ekf-pm", NEW)


def median_run(results: Results, place: str) -> tuple[int, float]:
    """Number and ratio of the median run; a run that failed in either filter is none."""
    tables = []
    for job, settings_of in ((NEW, HEADLINE), (BASELINE, UNTUNED)):
        table = results.table(job)
        tables.append(table[(table["trajectory"] == place) & (table["frozen"] == settings_of)].set_index("run"))
    survived = ~(tables[0]["failed"] | tables[1]["failed"])
    ratios = (tables[0]["horizontal"] / tables[1]["horizontal"])[survived].sort_values(kind="stable")
    if ratios.empty:
        return int(tables[0].index[0]), float("nan")
    middle = (len(ratios) - 1) // 2
    return int(ratios.index[middle]), float(ratios.iloc[middle])


def shown_designs(settings: Settings, results: Results) -> dict[str, Design]:
    """The filters of the figures."""
    return {
        "riss-only": design("ekf-f", settings.options, updates=False),
        "ekf-pi": design("ekf-pi", settings.options),
        "ekf-pm": design("ekf-pm", settings.options),
        NEW: frozen(results, settings, "ukf", HEADLINE, "st-gate"),
    }


def traces(settings: Settings, results: Results) -> Output:
    """Columns trajectory, run, ratio; arrays once a second, by trajectory.

    ``<t>.time`` (E,), ``<t>.truth`` (E, 7); ``<t>.<filter>.estimate`` and ``.deviation`` (E, 7), the filter's own standard deviations;
    ``<t>.fixes`` (M, 6) with ``<t>.fix_time`` and ``<t>.fix_cause`` (M,); ``<t>.<filter>.rejected`` (M,).
    """
    rows, arrays = [], {}
    for place in TRAJECTORIES:
        number, ratio = median_run(results, place)
        prepared = prepare(headline(settings.seed, place), number)
        every = slice(0, None, RATE_HZ)
        arrays |= {
            f"{place}.time": np.arange(truth(place).shape[0])[every] / RATE_HZ,
            f"{place}.truth": truth(place)[every],
            f"{place}.fixes": prepared.fixes.value,
            f"{place}.fix_time": prepared.fixes.epoch / RATE_HZ,
            f"{place}.fix_cause": prepared.fixes.cause,
        }
        for name, made in shown_designs(settings, results).items():
            record = run(made, prepared, controls(prepared, made.tilt))
            arrays[f"{place}.{name}.estimate"] = record.posterior[0, every, :7]
            arrays[f"{place}.{name}.deviation"] = np.sqrt(record.posterior_variance[0, every, :7])
            arrays[f"{place}.{name}.rejected"] = np.any(record.weights[0, prepared.fixes.epoch] == 0.0, axis=1)
        rows.append((place, number, ratio))
    return Output(pd.DataFrame(rows, columns=["trajectory", "run", "ratio"]), arrays)
