"""What a paper prints: data/published/<key>.csv, validated at the door.

Cells stay text, exactly as they stand in the file: ``0.0360`` says that the paper prints four digits.
`published_value` gives the number. A ``claim_id`` cell may hold several ids joined by ``;``; ids that
begin with ``C`` are claims and need a verdict, all others are set-up values.
"""

import csv
import re
from pathlib import Path

import pandas as pd

from robins.foundation.errors import InputError

COLUMNS = ("claim_id", "location", "quantity", "unit", "value", "value_high", "kind", "quote_max_12_words", "note")
KINDS = ("number", "range", "qualitative")
NUMBER_COLUMNS = ("value", "value_high")
FILLED_COLUMNS = ("claim_id", "location", "quantity", "kind")

PLAIN_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
CLAIM_IDS = re.compile(r"[A-Za-z]+\d*[a-z]?(;[A-Za-z]+\d*[a-z]?)*")


def read_published(path) -> pd.DataFrame:
    """Read and validate one paper's published values.

    Returns
    -------
    DataFrame
        Text columns `COLUMNS`, rows in file order; an empty cell is an empty string.

    Raises
    ------
    InputError
        Names the file, line and column: missing, unreadable or empty file, other columns, a row with too
        many or too few cells, an unknown kind, text in a number column, or numbers that do not fit the kind.
    """
    path = Path(path)
    lines = read_lines(path)
    _, header = lines[0]
    if tuple(header) != COLUMNS:
        raise InputError(path, "line 1", ",".join(header), ",".join(COLUMNS))
    if len(lines) == 1:
        raise InputError(path, "", "no row below the header", "at least one published value")
    for number, cells in lines[1:]:
        if len(cells) != len(COLUMNS):
            raise InputError(path, f"line {number}", f"{len(cells)} cells", f"{len(COLUMNS)} cells")
        check_row(path, number, dict(zip(COLUMNS, cells, strict=True)))
    return pd.DataFrame([cells for _, cells in lines[1:]], columns=list(COLUMNS), dtype=str)


def read_lines(path: Path) -> list[tuple[int, list[str]]]:
    """Line number (of the record's last line) and cells of every record of the file, header first."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            reader = csv.reader(file, strict=True)
            lines = [(reader.line_num, cells) for cells in reader]
    except FileNotFoundError:
        raise InputError(path, "", "no such file", "the paper's published values as CSV") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(path, "", f"an unreadable file ({error})", "CSV in UTF-8") from error
    if not lines:
        raise InputError(path, "", "an empty file", "a header and at least one published value")
    return lines


def check_row(path: Path, number: int, row: dict[str, str]) -> None:
    """Raise `InputError` when a row, read from line `number`, breaks a rule of the table."""

    def wrong(column: str, expected: str) -> InputError:
        return InputError(path, f"line {number}, column {column}", repr(row[column]), expected)

    for column in FILLED_COLUMNS:
        if not row[column].strip():
            raise wrong(column, "a text")
    if not CLAIM_IDS.fullmatch(row["claim_id"]):
        raise wrong("claim_id", "ids such as C1, joined by ';' without blanks")
    if row["kind"] not in KINDS:
        raise wrong("kind", " or ".join(KINDS))
    for column in NUMBER_COLUMNS:
        if row[column] and not PLAIN_NUMBER.fullmatch(row[column]):
            raise wrong(column, "a number or an empty cell")
        if row[column] and row["kind"] == "qualitative":
            raise wrong(column, "an empty cell, since the claim is qualitative")
    if row["kind"] != "qualitative" and not (row["value"] or row["value_high"]):
        raise wrong("value", f"a number here or in value_high, since the kind is {row['kind']}")
    if row["value"] and row["value_high"] and float(row["value"]) > float(row["value_high"]):
        raise wrong("value_high", f"at least the value {row['value']}")


def claim_ids(published: pd.DataFrame) -> list[str]:
    """The ids that need a verdict (those that begin with ``C``), each once, in file order."""
    ids = (name for cell in published["claim_id"] for name in cell.split(";"))
    return list(dict.fromkeys(name for name in ids if name.startswith("C")))


def rows_of(published: pd.DataFrame, claim_id: str) -> pd.DataFrame:
    """The rows whose ``claim_id`` cell names `claim_id`."""
    return published[[claim_id in cell.split(";") for cell in published["claim_id"]]]


def published_value(published: pd.DataFrame, claim_id: str, quantity: str) -> float:
    """The number that the paper prints for `quantity` under `claim_id`.

    Raises
    ------
    LookupError
        There is none, or the paper prints different numbers in different places.
    """
    rows = rows_of(published, claim_id)
    values = set(rows.loc[(rows["quantity"] == quantity) & (rows["value"] != ""), "value"])
    if len({float(value) for value in values}) != 1:
        found = ", ".join(sorted(values)) or "none"
        raise LookupError(f"published value of {claim_id}, {quantity!r}: found {found}, expected exactly one")
    return float(values.pop())
