"""Named streams of random numbers.

A stream is named ``paper/scenario/run/sensor`` and seeded from that name and the configuration's
seed, so a run's noise depends on nothing else: not on the number of cores, the order of the work or
which other filters ran. All filters of a run read the same streams (paired comparison).
"""

import hashlib

import numpy as np


def stream(seed: int, name: str) -> np.random.Generator:
    """The generator of the stream `name` under the configuration's `seed`.

    Parameters
    ----------
    seed : int
        The configuration's seed, not negative.
    name : str
        ``paper/scenario/run/sensor``; the run is a number.
    """
    digest = hashlib.sha256(name.encode()).digest()
    words = np.frombuffer(digest, dtype="<u4")
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, *map(int, words)])))


def standard_normals(seed: int, names: list[str], shape: tuple[int, ...]) -> np.ndarray:
    """Standard normal draws, shape ``(len(names), *shape)``, one stream for each name."""
    draws = np.empty((len(names), *shape))
    for row, name in zip(draws, names, strict=True):
        stream(seed, name).standard_normal(out=row)
    return draws
