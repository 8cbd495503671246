"""Entry point: ``python -m benchmarks`` from the root of the repository; ``--help`` explains it."""

import argparse
import datetime
import json
import sys
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks import ours, peers, propagation, reference, system
from benchmarks.models import Drive, drive
from benchmarks.rounds import interleave, ratio
from benchmarks.systems import strapdown_drive
from robins.foundation.files import write_text

EPOCHS = 1000
AGREEMENT = 1e-10
"""Greatest absolute difference allowed between our states and covariances and a peer's."""

CASES = {
    "9 states": drive,
    "15 error states": lambda epochs: strapdown_drive(False, epochs),
    "21 error states": lambda epochs: strapdown_drive(True, epochs),
}
PEERS = "filterpy", "C"
GOALS = {case: {"C": (1.5, 1.1)} for case in CASES}
"""Time over the peer's time: required, and good."""
GOALS["9 states"]["filterpy"] = (1 / 18, 1 / 25)

RUN_EPOCHS, RUN_GOAL = 3300, 45.0
"""One run of the filter with 21 error states, 330 s at 10 Hz, and the milliseconds that it may take."""

BUSY = 0.9
"""Load above which somebody else is at work. Measured: filterpy then takes up to twice its time, C and ours hardly more."""

FIRST_RESULT_GOAL = 2.0
CORE_SECONDS_GOALS = {"hajiyev2023": 200.0, "imani2026": 900.0}
ROOT = Path(__file__).parents[1]

DESCRIPTION = """\
Times one step of the extended Kalman filter (9 states, and 15 and 21 error states of a strapdown mechanisation; 6
measurements at every epoch, Joseph form) against filterpy and against the same algorithm in C, in one run: every round
times all of them once, the minimum over the rounds counts. It first checks that all of them compute the same states and
covariances. For error states filterpy gets F, Q and H from our compiled kernels, C has its own.

Counted is a whole call over 1000 epochs, divided by them. Ours writes its full record (prior and posterior states and
variances, innovations and their variances, weights, gain norms, NIS), C the states, covariances and NIS, filterpy what
it keeps itself, its states and its covariances.

Then: microseconds of F P F' + Q by loops and by BLAS; milliseconds of one run of 3300 steps with 21 error states;
seconds to the first result of a second process (disk cache filled); and processor seconds of the standard ensemble of
each paper, by stage, as noted by the last `snakemake` run."""


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


def largest_difference(states: np.ndarray, covariances: np.ndarray, own: tuple[np.ndarray, ...]) -> float:
    """Largest absolute difference of a peer's states and covariances from ours."""
    return float(max(np.abs(states - own[0]).max(), np.abs(covariances - own[1]).max()))


def agreement(recorded: Drive, in_c: reference.Reference | None) -> dict[str, float]:
    """Largest difference from each peer, and between the timed run and the one that keeps whole covariances.

    Raises
    ------
    SystemExit
        One is larger than `AGREEMENT`: the times would not compare the same work.
    """
    own = ours.run_whole(recorded)
    timed = ours.run_ours(recorded, ours.weightings()["unit weights"])
    variances = np.abs(timed.posterior_variance[0] - np.diagonal(own[1], axis1=1, axis2=2)).max()
    found = {"run_filter": float(max(np.abs(timed.posterior[0] - own[0]).max(), variances))}
    found["filterpy"] = largest_difference(*peers.run_filterpy(recorded), own)
    if in_c:
        in_c.run()
        found["C"] = largest_difference(in_c.states, in_c.covariances, own)
    for peer, difference in found.items():
        if not difference <= AGREEMENT:
            sys.exit(f"benchmarks: states or covariances of {peer} differ from ours by {difference:.1e}, expected at most {AGREEMENT:.0e}")
    return found


def as_fraction(value: float) -> str:
    """A ratio below one as ``1/x``, any other as it is."""
    return f"1/{1 / value:.1f}" if value < 1 else f"{value:.2f}"


def verdict(value: float, required: float, good: float) -> str:
    """How a ratio or time compares with its goals; smaller is better."""
    return "good" if value <= good else "met" if value <= required else "MISSED"


def measure_steps(rounds: int) -> dict:
    """Times and ratios of the filter step, case by case; prints them."""
    print("compiling the filters for the benchmark's models, which lie outside the package and are not cached ...", flush=True)
    return {case: measure_case(case, rounds) for case in CASES}


def measure_case(case: str, rounds: int) -> dict:
    """Times and ratios of one of the `CASES`; prints them."""
    recorded = CASES[case](EPOCHS)
    try:
        in_c, why = reference.Reference(recorded), ""
    except RuntimeError as error:
        in_c, why = None, str(error)
    differences = agreement(recorded, in_c)
    candidates = {name: lambda weights=weights: ours.run_ours(recorded, weights) for name, weights in ours.weightings().items()}
    candidates["filterpy"] = lambda: peers.run_filterpy(recorded)
    if in_c:
        candidates["C"] = in_c.run
    seconds = interleave(candidates, rounds)
    ratios = {name: {peer: ratio(seconds, name, peer) for peer in PEERS if peer in seconds} for name in ours.weightings()}
    show_steps(case, seconds, ratios, why)
    times = {name: {"least": 1e6 * s.min() / EPOCHS, "median": 1e6 * float(np.median(s)) / EPOCHS} for name, s in seconds.items()}
    return {"epochs": EPOCHS, "rounds": rounds, "differences": differences, "ratios": ratios, "microseconds": times}


def show_steps(case: str, seconds: dict[str, np.ndarray], ratios: dict, why_no_c: str) -> None:
    """Print times beside ratios, and the goals of the case."""
    print(f"\n{f'one step, {case}, 6 measurements':40}{'us':>8}{'/ filterpy':>12}{'/ C':>8}")
    for name, each in seconds.items():
        label = name if name in PEERS else f"robins, {name}"
        against = [as_fraction(ratios[name][peer]["of_minima"]) if name in ratios and peer in seconds else "" for peer in PEERS]
        print(f"{label:40}{1e6 * each.min() / EPOCHS:8.2f}{against[0]:>12}{against[1]:>8}")
    if why_no_c:
        print(f"{'C':40}not measured: {why_no_c}")
    for peer, (required, good) in GOALS[case].items():
        if found := ratios["unit weights"].get(peer):
            goal = f"required {as_fraction(required)}, good {as_fraction(good)}"
            span = f"{as_fraction(found['least'])} to {as_fraction(found['greatest'])} in single rounds"
            print(f"  against {peer}: {as_fraction(found['of_minima'])} ({goal}): {verdict(found['of_minima'], required, good)}; {span}")


def measure_propagation(rounds: int) -> dict:
    """Microseconds of ``F P F^T + Q`` by loops and by BLAS, case by case; prints them."""
    found = {}
    for case, make in CASES.items():
        seconds = interleave(propagation.propagations(make(EPOCHS)), rounds)
        found[case] = {name: 1e6 * float(each.min()) / propagation.CALLS for name, each in seconds.items()}
        print(f"F P F' + Q, {case:20}loops {found[case]['loops']:.2f} us, BLAS {found[case]['BLAS']:.2f} us")
    return found


def measure_run(rounds: int) -> dict:
    """Milliseconds of one run of `RUN_EPOCHS` steps with 21 error states, after compilation; prints them."""
    recorded = strapdown_drive(True, RUN_EPOCHS)
    seconds = interleave({"run": lambda: ours.run_ours(recorded, ours.weightings()["unit weights"])}, rounds)["run"]
    least = 1e3 * float(seconds.min())
    judged = verdict(least, RUN_GOAL, RUN_GOAL)
    print(f"\none run, 21 error states, {RUN_EPOCHS} steps    {least:.1f} ms (at most {RUN_GOAL:g} ms): {judged}")
    return {"epochs": RUN_EPOCHS, "milliseconds": least}


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
        found = {"machine": about, "steps": measure_steps(options.rounds), "propagation": measure_propagation(options.rounds)}
        found |= {"run": measure_run(options.rounds), "system": measure_system()}
    if options.record:
        path = ROOT / "benchmarks" / "records" / f"{options.record}.json"
        path.parent.mkdir(exist_ok=True)
        write_text(path, json.dumps(found, indent=2) + "\n")
        print(f"\nwritten: {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main(sys.argv[1:])
