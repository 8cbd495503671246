"""Tolerances that can fail: a wide one would let a wrong table pass, so it is refused."""

import pandas as pd

RELATIVE_LIMIT = 1e-5
INTERVAL_SHARE = 1e-3
ROUND_OFF = 1e-12  # an absolute tolerance that no interval has to justify


def refuse_columns(table) -> list[str]:
    """What is wrong with the columns of a table's specification, whatever its rows are; empty when nothing is."""
    problems = []
    names = [column.name for column in table.columns]
    kinds = {column.kind for column in table.columns}
    if len(set(names)) < len(names):
        problems.append("two columns with one name")
    if not kinds <= {"key", "text", "count", "number", "optional", "prose"}:
        problems.append(f"unknown kinds of columns: {', '.join(sorted(kinds))}")
    if "key" not in kinds:
        problems.append("no key column")
    if kinds == {"key"}:
        problems.append("no column to compare")
    for column in table.columns:
        if not 0 <= column.relative <= RELATIVE_LIMIT:
            problems.append(f"{column.name}: relative tolerance {column.relative:g}, at most {RELATIVE_LIMIT:g} is allowed")
        if not column.absolute >= 0:
            problems.append(f"{column.name}: absolute tolerance {column.absolute:g}, a number that is not negative is needed")
    return problems


def refuse_tolerances(table, frame: pd.DataFrame) -> list[str]:
    """Where a table's absolute tolerances are too wide for its own numbers; empty when nowhere.

    An absolute tolerance may be at most a thousandth of the half-width of the cell's interval: the columns
    ``<name>_low`` and ``<name>_high`` of its row, else ``ci_low`` and ``ci_high``. Without an interval only round-off
    (1e-12) is allowed.

    Parameters
    ----------
    table : Table
        The specification.
    frame : DataFrame
        The table, as `robins.publish.tables.read` gives it.
    """
    problems = []
    for column in table.columns:
        if column.kind not in ("number", "optional") or column.absolute <= ROUND_OFF:
            continue
        low, high = _interval(column.name, frame)
        for position, half_width in enumerate(abs(high - low) / 2):
            limit = max(INTERVAL_SHARE * half_width, ROUND_OFF)
            if not column.absolute <= limit:
                problems.append(f"{column.name}, row {position}: absolute tolerance {column.absolute:g}, at most {limit:g} is allowed")
    return problems


def _interval(name: str, frame: pd.DataFrame) -> tuple[pd.Series, pd.Series]:
    stem = name.removesuffix("_low").removesuffix("_high")
    for prefix in (name, stem, "ci"):
        ends = f"{prefix}_low", f"{prefix}_high"
        if set(ends) <= set(frame.columns):
            low, high = (pd.to_numeric(frame[end], errors="coerce").fillna(0.0) for end in ends)
            return low, high
    nothing = pd.Series(0.0, index=frame.index)
    return nothing, nothing
