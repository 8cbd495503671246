"""Generic compiled functions: one kernel for each type of model, chosen when the caller is compiled.

A model is a `typing.NamedTuple` of numbers and arrays. Registering its kernels is all it takes to use it:

    class Clock(NamedTuple):
        A: np.ndarray

    @implements(propagate, Clock)
    @njit
    def propagate_clock(model, x, u):
        ...

`entry_point` compiles the few functions that Python calls. Their machine code is cached on disk for
kernels of this package and of installed plug-ins, whose sources name the cache folder; kernels that
come from anywhere else (a script, a notebook, a test) are compiled afresh in every process, because an
edit in them could not be noticed. A type's kernels are registered once: a filter that is compiled keeps
those that it was compiled with.
"""

import functools
import sys
from pathlib import Path

from numba import njit
from numba.core.errors import TypingError

from robins import plugins

_kernels: dict[tuple[str, type], object] = {}
_loose_ends: set[str] = set()
_PACKAGE = Path(__file__).resolve().parents[1]


@functools.cache
def is_covered(module: str) -> bool:
    """Whether the cache folder's name changes when the source of `module` does."""
    source = getattr(sys.modules.get(module), "__file__", None)
    if source is None:
        return False
    path = Path(source).resolve()
    return path.is_relative_to(_PACKAGE) or path in {file.resolve() for file in plugins.source_files()}


def note_kernel(kernel, covered: bool = True) -> None:
    """Remember `kernel` where it lies outside the covered sources or is not `covered`; entry points are then compiled afresh."""
    module = kernel.py_func.__module__
    if not (covered and is_covered(module)):
        _loose_ends.add(f"{module}.{kernel.py_func.__qualname__}")


def implements(generic, model_type: type):
    """Decorator: register a compiled kernel as the implementation of `generic` for `model_type`.

    Raises
    ------
    ValueError
        There is one already.
    """

    def register(kernel):
        if (generic.__name__, model_type) in _kernels:
            raise ValueError(f"{model_type.__name__} has a kernel for {generic.__name__} already")
        _kernels[generic.__name__, model_type] = kernel
        note_kernel(kernel)
        return kernel

    return register


def has_kernel(generic: str, model) -> bool:
    """Whether `generic` has a kernel of its own for a Numba type or a Python value."""
    return (generic, getattr(model, "instance_class", None) or type(model)) in _kernels


def kernel_of(generic: str, model):
    """The kernel of `generic` for a Numba type or a Python value.

    Raises
    ------
    TypingError
        There is none; the message says how to register it.
    """
    model_type = getattr(model, "instance_class", None) or type(model)
    try:
        return _kernels[generic, model_type]
    except KeyError:
        raise TypingError(f"{model_type.__name__} has no kernel for {generic}; register one with implements()") from None


def entry_point(function):
    """Compile `function` with the disk cache, or without it while a kernel outside the covered sources is registered.

    ``.dispatcher`` of the result is the cached one.
    """
    cached, fresh = njit(cache=True)(function), njit(function)

    @functools.wraps(function)
    def call(*arguments):
        return fresh(*arguments) if _loose_ends else cached(*arguments)

    call.dispatcher = cached
    return call
