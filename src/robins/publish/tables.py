"""Tables on disk: a CSV to compute with and a Markdown file to read, written by what the table promises.

A table's specification (`robins.papers.protocol.Table`) names its columns, their units and kinds. A frame that differs
from it is refused with the name of the cell; so is NaN or infinity, which never enter a published table: where no run
survives, the cell is the word ``failed``.
"""

import csv
import math
import re
from io import StringIO
from numbers import Integral, Real
from pathlib import Path

import pandas as pd

from robins.foundation.errors import InputError
from robins.foundation.files import write_text

FAILED = "failed"
PLAIN_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
"""A number as tables spell it: no spaces, no underscores, no digits but these ten; not infinity either."""
PLAIN_COUNT = re.compile(r"-?[0-9]+")


def write(frame: pd.DataFrame, table, path, n: int | None = None) -> int:
    """Write `frame` to `path` (.csv) and, rounded, to the Markdown file beside it.

    Parameters
    ----------
    frame : DataFrame
        Exactly the columns of `table`, in their order; rows stay in the builder's order.
    table : Table
        The specification.
    path : Path
        Where the CSV goes.
    n : int, optional
        Ensemble size, for the caption.

    Returns
    -------
    int
        Number of cells that the check will compare.

    Raises
    ------
    InputError
        The frame is not what the specification says.
    """
    validate(frame, table)
    write_csv(frame, path)
    write_text(Path(path).with_suffix(".md"), markdown(frame, table, n))
    return cells(len(frame), table)


def cells(rows: int, table) -> int:
    """How many cells of `table` are compared when it has `rows` rows."""
    return rows * sum(column.kind != "key" for column in table.columns)


def validate(frame: pd.DataFrame, table) -> None:
    """Refuse a frame that is not what `table` promises, naming the first cell at fault."""
    names = [column.name for column in table.columns]
    if list(frame.columns) != names:
        raise InputError(table.name, "columns", ", ".join(map(str, frame.columns)), ", ".join(names))
    if not len(frame):
        raise InputError(table.name, "", "no row", "at least one")
    for column in table.columns:
        for position, value in enumerate(frame[column.name]):
            expected = _objection(value, column.kind)
            if expected:
                raise InputError(table.name, f"row {position} ({_key(frame, table, position)}), {column.name}", repr(value), expected)
    keys = key_columns(table)
    repeated = frame.duplicated(keys) if keys else pd.Series(len(frame) > 1, index=frame.index)
    if repeated.any():
        position = int(repeated.to_numpy().argmax())
        raise InputError(table.name, f"row {position}", f"a second row with the key {_key(frame, table, position)}", "each key once")


def _objection(value, kind: str) -> str:
    """What a cell should hold, when it does not; else nothing."""
    if kind == "number":
        fine = value == FAILED if isinstance(value, str) else isinstance(value, Real) and math.isfinite(value)
        return "" if fine else f"a finite number or {FAILED!r}"
    if kind == "count":
        return "" if isinstance(value, Integral) else "a whole number"
    if kind == "optional" and isinstance(value, Real):
        return "" if math.isfinite(value) else "a finite number or nothing"
    if kind == "key" and isinstance(value, Real) and math.isfinite(value):
        return ""
    if not isinstance(value, str) or "\n" in value:
        return "one line of text"
    return "" if value or kind != "key" else "a key that is not empty"


def key_columns(table) -> list[str]:
    """Names of the columns that identify a row of `table`."""
    return [column.name for column in table.columns if column.kind == "key"]


def _key(frame: pd.DataFrame, table, position: int) -> str:
    return ", ".join(str(frame[name].iloc[position]) for name in key_columns(table))


def write_csv(frame: pd.DataFrame, path) -> None:
    """Write any frame in the house's CSV format: ``%.10g`` numbers, Unix line ends, no index, UTF-8."""
    spelled = frame.apply(lambda column: column.map(_spelled))
    write_text(path, spelled.to_csv(index=False, lineterminator="\n"))


def _spelled(value) -> str:
    if isinstance(value, Real) and not isinstance(value, Integral):
        return f"{value + 0.0:.10g}"  # the sum turns -0 into 0
    return str(value)


def read_text(path) -> pd.DataFrame:
    """A CSV as it stands: every cell text, nothing interpreted, empty cells empty.

    Raises
    ------
    InputError
        The file has a byte-order mark or a carriage return, a column twice, or a row with more or fewer fields than the
        header. Bytes that are no UTF-8 are a ValueError too.
    """
    text = Path(path).read_bytes().decode("utf-8")
    for mark, name in (("\ufeff", "a byte-order mark"), ("\r", "a carriage return")):
        if mark in text:
            raise InputError(path, "", name, "UTF-8 with Unix line ends")
    try:
        header, *rows = csv.reader(StringIO(text, newline=""), strict=True)
    except (csv.Error, ValueError) as error:
        raise InputError(path, "", f"no table ({error})", "a header and rows") from error
    if len(set(header)) < len(header):
        raise InputError(path, "header", ",".join(header), "each column once")
    for position, row in enumerate(rows):
        if len(row) != len(header):
            raise InputError(path, f"row {position}", f"{len(row)} fields", f"{len(header)}, as in the header")
    return pd.DataFrame(rows, columns=header, dtype=str)


def read(path, table) -> pd.DataFrame:
    """Read a published table back; number columns are float64 unless they hold the word ``failed``.

    A cell that is no plain number stays text, which `validate` refuses where a number has to be.
    """
    frame = read_text(path)
    for column in table.columns:
        if column.kind == "count":
            frame[column.name] = [int(cell) if PLAIN_COUNT.fullmatch(cell) else cell for cell in frame[column.name]]
        elif column.kind in ("number", "optional"):
            frame[column.name] = [float(cell) if PLAIN_NUMBER.fullmatch(cell) else cell for cell in frame[column.name]]
    validate(frame, table)
    return frame


def markdown(frame: pd.DataFrame, table, n: int | None = None) -> str:
    """`frame` as a Markdown page: title, where it stands in the paper, the table to four digits, caption and n."""
    heads = [header(column) for column in table.columns]
    rules = ["---:" if column.kind in ("number", "count", "optional") else "---" for column in table.columns]
    rows = [[rounded(value) for value in row] for row in frame.itertuples(index=False)]
    lines = [" | ".join(row) for row in ([_escaped(head) for head in heads], rules, *([_escaped(cell) for cell in row] for row in rows))]
    notes = [text for text in (table.caption, f"n = {n}." if n else "") if text]
    parts = [f"# {table.title}", f"*{table.location}*" if table.location else "", "\n".join(f"| {line} |" for line in lines), *notes]
    return "\n\n".join(part for part in parts if part) + "\n"


def header(column) -> str:
    """A column's name with its unit."""
    return f"{column.name} ({column.unit})" if column.unit else column.name


def rounded(value) -> str:
    """A cell for readers: numbers to four significant digits, of what stands in the CSV."""
    if isinstance(value, Real) and not isinstance(value, Integral):
        return f"{float(_spelled(value)):.4g}"
    return str(value)


def _escaped(cell: str) -> str:
    return cell.replace("|", "\\|")
