"""Comparing two CSV files cell by cell, and naming what differs.

Cells are compared as they stand in the files. Kinds of columns are those of `robins.papers.protocol.Column`, and these:
``verdict`` of the claim ledger is one of the closed list of words and compared only where the n is equal; ``printed`` is
the paper's own number, compared as text; ``measured`` of field tables is ``optional`` with exact whole numbers.
``optional`` cells hold a number, words or nothing; in ``prose`` the words are exact and the numerals agree to their last
printed digit and to `PROSE_RELATIVE`, where the n is equal.
"""

import math
import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from robins.evaluate.verdicts import Verdict
from robins.publish import tables
from robins.publish.tables import FAILED, PLAIN_COUNT, PLAIN_NUMBER

PROSE_RELATIVE = 1e-3
"""How far two numerals in a sentence may differ at most: one unit in the last digit of "0.1" would be far too much."""
_NUMERAL = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?")
_VERDICTS = frozenset(map(str, Verdict))


@dataclass
class Comparison:
    """What was compared and where it differs; ``largest`` is the largest relative difference of two numbers."""

    differences: list[str] = field(default_factory=list)
    tables: int = 0
    cells: int = 0
    largest: float = 0.0

    def differ(self, table: str, place: str, found, expected, tolerance="exact") -> None:
        """Note one difference, in one line."""
        where = f"{table}: {place}" if place else table
        self.differences.append(f"{where}: found {found}, expected {expected} (tolerance: {tolerance})".replace("\n", " "))


def compare_file(name: str, table, found_path: Path, expected_path: Path, recorded: int | None, outcome: Comparison) -> None:
    """Compare one table of the results with the reference's.

    Parameters
    ----------
    name : str
        What differences call the table.
    table : Table
        Its specification.
    found_path, expected_path : Path
        The two files.
    recorded : int or None
        Number of cells that the manifest records; None (not recorded) is a difference.
    outcome : Comparison
        Where differences and counts go.
    """
    frames = []
    for path, side in ((found_path, "results"), (expected_path, "reference")):
        if not path.is_file():
            outcome.differ(name, "", f"no table in the {side}", "the table")
            continue
        try:
            frames.append(tables.read_text(path))
        except (ValueError, OSError) as error:
            outcome.differ(name, "", f"an unreadable file in the {side} ({error})", "a CSV file")
    if len(frames) == 2:
        before = outcome.cells
        compare_frames(name, table, *frames, outcome)
        if outcome.cells - before != recorded:
            outcome.differ(name, "number of cells", f"{outcome.cells - before} compared", f"{recorded} recorded in the manifest")


def compare_frames(name: str, table, found: pd.DataFrame, expected: pd.DataFrame, outcome: Comparison) -> None:
    """Compare two frames of text cells (`robins.publish.tables.read_text`) by the specification `table`."""
    sound = [_is_sound(name, table, frame, side, outcome) for frame, side in ((found, "results"), (expected, "reference"))]
    if all(sound):
        _compare_rows(name, table, found, expected, outcome)
        outcome.tables += 1


def _is_sound(name: str, table, frame: pd.DataFrame, side: str, outcome: Comparison) -> bool:
    """Whether `frame` has the promised columns, unique keys and sound cells; notes what it has not."""
    names = [column.name for column in table.columns]
    if list(frame.columns) != names:
        outcome.differ(name, f"columns of the {side}", ", ".join(frame.columns), ", ".join(names))
        return False
    before = len(outcome.differences)
    keys = _keys(frame, table)
    for key in sorted(key for key, count in Counter(keys).items() if count > 1):
        outcome.differ(name, f"row {_words(key)}", f"a duplicate key in the {side}", "each key once")
    for column in table.columns:
        for key, cell in zip(keys, frame[column.name], strict=True):
            problem = _objection(cell, column.kind)
            if problem:
                outcome.differ(name, f"row {_words(key)}, {column.name}", f"{cell!r} in the {side}", problem)
    return len(outcome.differences) == before


def _objection(cell: str, kind: str) -> str:
    """What the text of a cell should be, when it is not; else nothing."""
    if kind == "number" and cell != FAILED and not math.isfinite(_number(cell)):
        return f"a finite number or {FAILED!r}"
    if kind == "count" and not PLAIN_COUNT.fullmatch(cell):
        return "a whole number"
    if kind in ("optional", "measured", "printed") and _is_crooked(cell):
        return "a finite number, words or nothing"
    if kind == "verdict" and cell not in _VERDICTS:
        return "a verdict: " + ", ".join(sorted(_VERDICTS))
    return ""


def _is_crooked(cell: str) -> bool:
    """Whether Python would take `cell` for a number though it is none to be published, like ``nan`` or ``1_0``."""
    try:
        float(cell)
    except ValueError:
        return False
    return not math.isfinite(_number(cell))


def _number(cell: str) -> float:
    return float(cell) if PLAIN_NUMBER.fullmatch(cell) else math.nan


def _keys(frame: pd.DataFrame, table) -> list[tuple[str, ...]]:
    names = tables.key_columns(table)
    return list(frame[names].itertuples(index=False, name=None)) if names else [()] * len(frame)


def _words(key: tuple[str, ...]) -> str:
    return "(" + ", ".join(key) + ")"


def _compare_rows(name: str, table, found: pd.DataFrame, expected: pd.DataFrame, outcome: Comparison) -> None:
    found_keys, expected_keys = _keys(found, table), _keys(expected, table)
    lines = dict(zip(found_keys, found.to_dict("records"), strict=True))
    known = set(expected_keys)
    for key in found_keys:
        if key not in known:
            outcome.differ(name, f"row {_words(key)}", "an extra row", "no such row")
    if found_keys != expected_keys and sorted(found_keys) == sorted(expected_keys):
        outcome.differ(name, "rows", "another order", "the order of the reference")
    for key, line in zip(expected_keys, expected.to_dict("records"), strict=True):
        if key in lines:
            _compare_row(name, table, key, lines[key], line, outcome)
        else:
            outcome.differ(name, f"row {_words(key)}", "no such row", "the row")


def _compare_row(name: str, table, key: tuple[str, ...], found: dict, expected: dict, outcome: Comparison) -> None:
    same_n = found.get("n") == expected.get("n")
    for column in table.columns:
        if column.kind == "key":
            continue
        outcome.cells += 1
        if same_n or column.kind not in ("verdict", "prose"):
            place = f"row {_words(key)}, {column.name}"
            _compare_cell(name, place, column, found[column.name], expected[column.name], outcome)


def _compare_cell(name: str, place: str, column, found: str, expected: str, outcome: Comparison) -> None:
    numbers = _number(found), _number(expected)
    whole = column.kind == "measured" and PLAIN_COUNT.fullmatch(found) and PLAIN_COUNT.fullmatch(expected)
    if column.kind in ("number", "optional", "measured") and not whole and all(map(math.isfinite, numbers)):
        distance = abs(numbers[0] - numbers[1])
        if distance:
            outcome.largest = max(outcome.largest, distance / max(map(abs, numbers)))
        if distance > column.absolute + column.relative * abs(numbers[1]):
            outcome.differ(name, place, found, expected, f"relative {column.relative:g}, absolute {column.absolute:g}")
    elif found != expected and not (column.kind == "prose" and _same_prose(found, expected)):
        outcome.differ(name, place, found or "nothing", expected or "nothing")


def _same_prose(found: str, expected: str) -> bool:
    """Whether two sentences differ at most in the last printed digit of their numerals (rounding on another machine)."""
    if _NUMERAL.sub("#", found) != _NUMERAL.sub("#", expected):
        return False
    pairs = zip(_NUMERAL.findall(found), _NUMERAL.findall(expected), strict=True)
    return all(a == b or _same_numeral(a, b) for a, b in pairs)


def _same_numeral(found: str, expected: str) -> bool:
    a, b = float(found), float(expected)
    return abs(a - b) <= min(1.001 * max(_last_digit(found), _last_digit(expected)), PROSE_RELATIVE * max(abs(a), abs(b)))


def _last_digit(numeral: str) -> float:
    """The size of one unit in the last place of a printed numeral; whole numbers are exact."""
    digits, _, exponent = numeral.partition("e")
    decimals = len(digits.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals) if decimals or exponent else 0.0
