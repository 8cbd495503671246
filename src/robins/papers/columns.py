"""What the tables of every wing are made of: columns with their tolerances, tables, and cells that say when no run survived."""

from collections.abc import Callable, Iterable

import numpy as np

from robins.papers.protocol import Column, Table
from robins.publish.tables import FAILED

ADAPTIVE = 1e-6
"""Relative tolerance of a table that holds adaptive filters."""
LINEAR = 1e-9
ROUND_OFF = 1e-12
"""Absolute tolerance: what is zero on one machine may be rounding on another."""


def keys(*names: str) -> tuple[Column, ...]:
    """Columns that identify a row."""
    return tuple(Column(name, "key") for name in names)


def texts(*names: str, kind: str = "text") -> tuple[Column, ...]:
    """Columns of words."""
    return tuple(Column(name, kind) for name in names)


def counts(*names: str) -> tuple[Column, ...]:
    """Columns of whole numbers."""
    return tuple(Column(name, "count") for name in names)


def numbers(
    *names: str, kind: str = "number", relative: float = ADAPTIVE, absolute: float = ROUND_OFF, unit: str = ""
) -> tuple[Column, ...]:
    """Columns of numbers with a relative tolerance; an `absolute` one beyond round-off has to be small against their intervals."""
    return tuple(Column(name, kind, unit, relative, absolute) for name in names)


def make(name: str, title: str, build: Callable, columns: Iterable[tuple[Column, ...]], needs: Iterable[str], caption: str,
         size: str = "runs", location: str = "extra") -> Table:  # fmt: skip
    """A table whose modules are the one that builds it, and what that imports."""
    return Table(
        name, title, location, tuple(c for group in columns for c in group), build, tuple(needs), (build.__module__,), caption, size
    )


def finite(value: float) -> float | str:
    """`value`, or the word ``failed`` where no surviving run gave one."""
    return float(value) if np.isfinite(value) else FAILED


def ends(name: str, low: float, high: float) -> dict[str, float | str]:
    """Both ends of an interval as ``<name>_low`` and ``<name>_high``, or twice the word ``failed``."""
    sound = np.isfinite([low, high]).all()
    return {f"{name}_low": float(low) if sound else FAILED, f"{name}_high": float(high) if sound else FAILED}
