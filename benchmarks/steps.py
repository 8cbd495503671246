"""One step of the filters against the peers, case by case: checked for agreement, timed, printed and judged; and our filters in pairs."""

import sys

import numpy as np

from benchmarks import ours, peers, propagation, reference
from benchmarks.goals import as_fraction, verdict
from benchmarks.models import Drive, drive, unscented_drive
from benchmarks.rounds import interleave, ratio
from benchmarks.systems import strapdown_drive
from robins.kalman.predict import Ekf

EPOCHS = 1000
AGREEMENT = 1e-10
"""Greatest absolute difference allowed between our states and covariances and a peer's."""

CASES = {
    "9 states": drive,
    "9 states, UKF": unscented_drive,
    "15 error states": lambda epochs: strapdown_drive(False, epochs),
    "21 error states": lambda epochs: strapdown_drive(True, epochs),
}
PEERS = "filterpy", "C"
GOALS = {case: {"C": (1.5, 1.1)} for case in CASES}
"""Time over the peer's time: required, and good."""
GOALS["9 states"]["filterpy"] = (1 / 18, 1 / 25)
GOALS["9 states, UKF"]["filterpy"] = (1 / 80, 1 / 110)
PAIRS = {"UKF over EKF, 9 states": ("9 states, UKF", "9 states")}
"""Two cases whose steps with unit weights are compared with each other."""


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
    """Microseconds of ``F P F^T + Q`` by loops and by BLAS, for each case that linearises; prints them."""
    found = {}
    for case, make in CASES.items():
        recorded = make(EPOCHS)
        if not isinstance(recorded.predictor, Ekf):
            continue
        seconds = interleave(propagation.propagations(recorded), rounds)
        found[case] = {name: 1e6 * float(each.min()) / propagation.CALLS for name, each in seconds.items()}
        print(f"F P F' + Q, {case:20}loops {found[case]['loops']:.2f} us, BLAS {found[case]['BLAS']:.2f} us")
    return found


def measure_pairs(rounds: int) -> dict:
    """Ratio of our own steps, pair by pair, and their microseconds; prints them."""
    return {pair: measure_pair(pair, rounds) for pair in PAIRS}


def measure_pair(pair: str, rounds: int) -> dict:
    """Ratio of the minima and the span of single rounds of one of the `PAIRS`; prints it."""
    weights = ours.weightings()["unit weights"]
    ukf, ekf = (CASES[case](EPOCHS) for case in PAIRS[pair])
    seconds = interleave({"ukf": lambda: ours.run_ours(ukf, weights), "ekf": lambda: ours.run_ours(ekf, weights)}, rounds)
    found = ratio(seconds, "ukf", "ekf")
    times = {f"{name}_us": 1e6 * float(each.min()) / EPOCHS for name, each in seconds.items()}
    span = f"{found['least']:.2f} to {found['greatest']:.2f} in single rounds"
    print(f"{pair}: {found['of_minima']:.2f} ({times['ukf_us']:.2f} us over {times['ekf_us']:.2f} us); {span}")
    return {"ratio": found["of_minima"], "least": found["least"], "greatest": found["greatest"], "rounds": rounds, **times}
