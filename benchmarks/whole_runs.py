"""Milliseconds of one whole run after compilation: 21 error states, and a drive of ghouneem2024 with an EKF and with a UKF."""

from collections.abc import Callable

from benchmarks import ours
from benchmarks.goals import verdict
from benchmarks.rounds import interleave
from benchmarks.systems import strapdown_drive
from robins.papers.ghouneem2024 import runs
from robins.papers.ghouneem2024.filters import design
from robins.papers.ghouneem2024.gps import ENVIRONMENTS
from robins.papers.ghouneem2024.options import OPTIONS

EPOCHS = 3300
"""330 s at 10 Hz."""
SEED, RUN = 1, 90000
"""Of the drive of ghouneem2024: neither the configuration's seed nor a run that an ensemble has."""
GOALS = {"21 error states": 45.0, "ghouneem2024, EKF": 40.0, "ghouneem2024, UKF": 160.0}
"""Greatest milliseconds of each run."""

Call = Callable[[], object]


def strapdown_run() -> tuple[dict[str, int], Call]:
    """How many predictions and updates a run with 21 error states has, and the run."""
    recorded, weights = strapdown_drive(True, EPOCHS), ours.weightings()["unit weights"]
    return {"predictions": EPOCHS - 1, "updates": EPOCHS}, lambda: ours.run_ours(recorded, weights)


def drive_run(name: str) -> tuple[dict[str, int], Call]:
    """The same for the filter `name` of ghouneem2024 on its first drive, 30 minutes at 20 Hz with a fix in each second."""
    prepared = runs.prepare(runs.Case(SEED, "t1", ENVIRONMENTS["t1"].scaled(0.0)), RUN)
    made = design(name, OPTIONS)
    u = runs.controls(prepared, made.tilt)
    return {"predictions": prepared.valid.size - 1, "updates": int(prepared.valid.sum())}, lambda: runs.run(made, prepared, u)


def measure_runs(rounds: int) -> dict:
    """Milliseconds of each run; prints and judges them."""
    made = {"21 error states": strapdown_run(), "ghouneem2024, EKF": drive_run("ekf-f"), "ghouneem2024, UKF": drive_run("ukf")}
    seconds = interleave({name: call for name, (_, call) in made.items()}, rounds)
    print()
    found = {}
    for name, (counts, _) in made.items():
        least, goal = 1e3 * float(seconds[name].min()), GOALS[name]
        size = f"{counts['predictions']} predictions, {counts['updates']} updates"
        print(f"one run, {name:20}{size:34}{least:6.1f} ms (at most {goal:g} ms): {verdict(least, goal, goal)}")
        found[name] = {**counts, "milliseconds": least}
    return found
