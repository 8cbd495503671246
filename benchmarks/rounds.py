"""Interleaved timing: in each round every candidate runs once, so that a busy spell of the machine meets them all."""

import time
from collections.abc import Callable

import numpy as np


def interleave(candidates: dict[str, Callable[[], object]], rounds: int, shortest: float = 0.02) -> dict[str, np.ndarray]:
    """Seconds of one call of each candidate, an array ``(rounds,)`` each.

    Within a round a candidate is called until `shortest` seconds have passed, and its fastest call counts. One
    call of each before the first round compiles it and warms the caches.
    """
    for candidate in candidates.values():
        candidate()
    seconds = {name: np.empty(rounds) for name in candidates}
    for index in range(rounds):
        for name, candidate in candidates.items():
            best, spent = np.inf, 0.0
            while spent < shortest:
                start = time.perf_counter()
                candidate()
                elapsed = time.perf_counter() - start
                best, spent = min(best, elapsed), spent + elapsed
            seconds[name][index] = best
    return seconds


def ratio(seconds: dict[str, np.ndarray], ours: str, peer: str) -> dict[str, float]:
    """Time of `ours` over time of `peer`: of the minima over all rounds, and the least and the greatest of a single round."""
    each = seconds[ours] / seconds[peer]
    return {"of_minima": float(seconds[ours].min() / seconds[peer].min()), "least": float(each.min()), "greatest": float(each.max())}
