"""Entry point: ``python -m benchmarks`` from the root of the repository; ``--help`` explains it."""

import argparse
import datetime
import json
import sys
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks import system
from benchmarks.goals import verdict
from benchmarks.steps import measure_pairs, measure_propagation, measure_steps
from benchmarks.whole_runs import measure_runs
from robins.foundation.files import write_text

BUSY = 0.9
"""Load above which somebody else is at work. Measured: filterpy then takes up to twice its time, C and ours hardly more."""

FIRST_RESULT_GOAL = 2.0
CORE_SECONDS_GOALS = {"hajiyev2023": 200.0, "imani2026": 900.0, "ghouneem2024": 900.0}
ROOT = Path(__file__).parents[1]

DESCRIPTION = """\
Times one step of the extended Kalman filter (9 states, and 15 and 21 error states of a strapdown mechanisation) and of
the unscented one (9 states; 6 measurements at every epoch, Joseph form) against filterpy and against the same algorithm
in C, in one run: every round times all of them once, the minimum over the rounds counts. It first checks that all of
them compute the same states and covariances. For error states filterpy gets F, Q and H from our compiled kernels, C has
its own.

Counted is a whole call over 1000 epochs, divided by them. Ours writes its full record (prior and posterior states and
variances, innovations and their variances, weights, gain norms, NIS), C the states, covariances and NIS, filterpy what
it keeps itself, its states and its covariances.

Then: our unscented step over our extended one; microseconds of F P F' + Q by loops and by BLAS; milliseconds of one run
of 3300 steps with 21 error states, and of 30 minutes at 20 Hz of ghouneem2024 with an EKF and with a UKF; seconds to the
first result of a second process (disk cache filled); and processor seconds of the standard ensemble of each paper, by
stage, as noted by the last `snakemake` run."""


def parse(arguments: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser("python -m benchmarks", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15, help="interleaved rounds, at least 7 (default: %(default)s)")
    parser.add_argument("--record", nargs="?", const=datetime.date.today().isoformat(), metavar="NAME",
                        help="also write benchmarks/records/NAME.json (default name: today's date)")  # fmt: skip
    options = parser.parse_args(arguments)
    if options.rounds < 7:
        parser.error(f"argument --rounds: found {options.rounds}, expected 7 or more")
    return options


def measure_system() -> dict:
    """First result of a second process and processor seconds of the standard ensembles; prints them."""
    first = system.first_result()
    print(
        f"\nfirst result of a second process    {first:.2f} s (at most {FIRST_RESULT_GOAL:g} s): {verdict(first, FIRST_RESULT_GOAL, 1.0)}"
    )
    spent = system.core_seconds(ROOT / "build" / "standard")
    for paper, stages in spent.items():
        total, goal = sum(stages.values()), CORE_SECONDS_GOALS.get(paper, np.inf)
        print(f"standard ensemble of {paper:15}{total:.0f} core-seconds (at most {goal:g}): {verdict(total, goal, goal)}")
        print("  " + ", ".join(f"{stage} {seconds:.0f}" for stage, seconds in sorted(stages.items(), key=lambda item: -item[1])))
    if not spent:
        print("standard ensembles                  nothing noted in build/standard/benchmarks: run snakemake first")
    return {"first_result_seconds": first, "core_seconds": spent}


def main(arguments: list[str]) -> None:
    """Measure, print and, where asked for, record."""
    options = parse(arguments)
    about = system.machine()
    print(", ".join(f"{key} {value}" for key, value in about.items()))
    if (about["load"] or 0.0) >= BUSY:
        print(f"load {about['load']}: other work slows filterpy more than compiled code, so its ratios flatter us; wait for quiet")
    with threadpool_limits(1):
        found = {"machine": about, "steps": measure_steps(options.rounds), "pairs": measure_pairs(options.rounds)}
        found |= {"propagation": measure_propagation(options.rounds), "runs": measure_runs(options.rounds), "system": measure_system()}
    if options.record:
        path = ROOT / "benchmarks" / "records" / f"{options.record}.json"
        path.parent.mkdir(exist_ok=True)
        write_text(path, json.dumps(found, indent=2) + "\n")
        print(f"\nwritten: {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main(sys.argv[1:])
