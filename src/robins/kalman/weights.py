"""Weights: what makes a Kalman filter robust. Each is one function, registered by name.

A weight function looks at the innovation and says how far to trust each channel, between 1 (as the
plain filter does) and 0 (not at all). Its arguments are the same for all:

    kernel(innovation, predicted, R, parameters, memory, epoch, weights)

    innovation   (m,)     z - h(x)
    predicted    (m, m)   innovation covariance without the weighted part R of the noise
    R            (m, m)   the part of the noise covariance that the weights act on
    parameters   (p,)     the method's constants
    memory       (r, c)   private to a run; kept from one update to the next
    epoch        int      number of updates before this one
    weights      (m,)     to be written; holds ones on entry

An integer flag selects the kernel inside the compiled filter, so all weights that are there when
`robins.kalman` has been imported share one compilation. To add one, write the function and decorate it; a
weight of your own package is announced through the entry-point group ``robins.weights``. A weight that is
registered later, in a notebook or a test, works too: its filters are compiled for it alone.
"""

from collections import namedtuple
from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import overload

from robins.kalman.extension import implements, kernel_of, note_kernel

_flags: dict[str, int] = {}
_kernels: list = []
_latecomers: dict[str, type] = {}
_closed = False


class Iteration(NamedTuple):
    """A fixed-point iteration of weights (`robins.kalman.fixed_point`).

    Attributes
    ----------
    limit : int
        The largest number of iterations; 0 for weights that are taken from the innovation, once.
    tolerance : float
        Relative change of the whitened correction at which it stops before.
    floor : float
        The smallest weight; an update fails where a weight is zero all the same.
    warm : bool
        Whether to start at the least-squares solution; at the prior otherwise.
    prior : ndarray, shape (p,)
        Constants of the weight function for the prior's residuals; empty when the prior keeps weight one.
    """

    limit: int
    tolerance: float
    floor: float
    warm: bool
    prior: np.ndarray


ONCE = Iteration(0, 0.0, 0.0, False, np.zeros(0))
"""No iteration."""


class Weighting(NamedTuple):
    """A weight function and how a filter uses it.

    Attributes
    ----------
    kind : int
        Its flag.
    parameters, memory : ndarray, shapes (p,) and (r, c)
        Its constants and its initial memory.
    on_gain : bool
        Whether the weights multiply the columns of the plain gain; they divide the noise otherwise.
    iteration : Iteration
    """

    kind: int
    parameters: np.ndarray
    memory: np.ndarray
    on_gain: bool
    iteration: Iteration


def close_list() -> None:
    """End the list of weights that share one compilation.

    The flags are numbers in the cached machine code, so they must be the same in every process. A weight that comes
    later, in an order that depends on what else is imported, gets a type of its own instead of a flag.
    """
    global _closed
    _closed = True


def weight(name: str):
    """Decorator: register a compiled weight function under `name`.

    Raises
    ------
    ValueError
        The name is taken.
    """

    def register(kernel):
        if name in names():
            raise ValueError(f"a weight named {name!r} is registered already")
        if _closed:
            _latecomers[name] = namedtuple(f"Weighting{len(_latecomers)}", Weighting._fields)
            note_kernel(kernel, covered=False)
            return implements(weigh, _latecomers[name])(kernel)
        _flags[name] = len(_kernels)
        _kernels.append(kernel)
        note_kernel(kernel)
        return kernel

    return register


def weighting(name: str, parameters=(), memory=None, on_gain: bool = False, iteration: Iteration = ONCE) -> Weighting:
    """The `Weighting` of the weight function called `name`.

    Raises
    ------
    ValueError
        No such weight (the message lists those there are), or weights on the gain are to be iterated.
    """
    if name not in names():
        raise ValueError(f"no weight is called {name!r}; there are {', '.join(names())}")
    if on_gain and iteration.limit > 0:
        raise ValueError("weights on the gain cannot be iterated: the iteration re-weights the noise and the prior")
    memory = np.zeros((1, 1)) if memory is None else np.ascontiguousarray(memory, float)
    made = _latecomers.get(name, Weighting)
    return made(_flags.get(name, -1), np.array(parameters, float), memory, on_gain, iteration)


def names() -> list[str]:
    """The registered weights in alphabetical order."""
    return sorted([*_flags, *_latecomers])


def weigh(weighting, parameters, innovation, predicted, R, memory, epoch, weights):
    """Write the weights of the method that `weighting` names, with these `parameters`; see the module's docstring."""
    kernel = _kernels[weighting.kind] if type(weighting) is Weighting else kernel_of("weigh", weighting)
    kernel(innovation, predicted, R, parameters, memory, epoch, weights)


@overload(weigh)
def _weigh(weighting, parameters, innovation, predicted, R, memory, epoch, weights):
    if getattr(weighting, "instance_class", None) is not Weighting:
        own = kernel_of("weigh", weighting)

        def alone(weighting, parameters, innovation, predicted, R, memory, epoch, weights):
            own(innovation, predicted, R, parameters, memory, epoch, weights)

        return alone
    chain = None
    for flag, kernel in reversed(list(enumerate(_kernels))):
        chain = _link(flag, kernel, chain)
    chain = njit(chain, inline="always")

    def select(weighting, parameters, innovation, predicted, R, memory, epoch, weights):
        chain(weighting.kind, innovation, predicted, R, parameters, memory, epoch, weights)

    return select


def _link(flag, kernel, others):
    """One ``if`` of the compiled dispatch: this kernel for its flag, `others` for every other flag."""
    if others is None:

        def last(kind, innovation, predicted, R, parameters, memory, epoch, weights):
            kernel(innovation, predicted, R, parameters, memory, epoch, weights)

        return last
    rest = njit(others, inline="always")

    def link(kind, innovation, predicted, R, parameters, memory, epoch, weights):
        if kind == flag:
            kernel(innovation, predicted, R, parameters, memory, epoch, weights)
        else:
            rest(kind, innovation, predicted, R, parameters, memory, epoch, weights)

    return link


@weight("unit")
@njit(cache=True)
def unit(innovation, predicted, R, parameters, memory, epoch, weights):
    """Every weight one: the plain Kalman filter."""


@weight("known")
@njit(cache=True)
def known(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weights given beforehand, one row of `memory` for each update: an oracle that is told the fault."""
    for i in range(weights.size):
        weights[i] = memory[epoch, i]
