"""What leakage is worth: settings chosen with the truth of the very run that is evaluated (brief, Q6).

Every run learns Q and P0 from its own truth and takes the best of the same forty-two settings for itself, cell by cell.
"""

import numpy as np
import pandas as pd

from robins.papers.ghouneem2024.ensemble import reporting_runs
from robins.papers.ghouneem2024.filters import design
from robins.papers.ghouneem2024.runs import COLUMNS, Prepared, controls, headline, prepare, score
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import CELLS, SETTINGS, Learned, chosen, learn, log_error, tuned_design
from robins.papers.protocol import Output, Settings

COMPARED = ("ekf-pi", "ukf")
LABELS = ("trajectory", "filter", "cell", "scale", "multiple")


def best_of_run(name: str, settings: Settings, prepared: Prepared) -> list[dict]:
    """A row for each cell with the setting that is best in this run, and one for the data sheet's filter without gate."""
    place = prepared.case.place
    (mechanisation,), (filtered,) = learn(name, settings.options, [prepared])
    learned = Learned(place, mechanisation, filtered)
    plain = design(name, settings.options)
    u = controls(prepared, plain.tilt)
    found = [score(tuned_design(name, settings.options, setting, learned), prepared, u) for setting in SETTINGS]
    objectives = np.array([log_error(row) for row in found])
    rows = [{"cell": "none", "scale": np.nan, "multiple": np.inf} | score(plain, prepared, u)]
    for cell in CELLS:
        best = chosen(objectives, cell)
        rows.append({"cell": cell} | SETTINGS[best]._asdict() | found[best])
    return [{"trajectory": place, "filter": name} | row for row in rows]


def in_sample(settings: Settings) -> Output:
    """Columns trajectory, filter, cell, scale, multiple and those of `runs.COLUMNS`."""
    rows = []
    for place in TRAJECTORIES:
        for number in reporting_runs(settings, "in_sample_runs"):
            prepared = prepare(headline(settings.seed, place), number)
            for name in COMPARED:
                rows += best_of_run(name, settings, prepared)
    return Output(pd.DataFrame(rows, columns=[*LABELS, *COLUMNS]))
