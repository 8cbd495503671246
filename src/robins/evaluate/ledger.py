"""The claim ledger: one row for each thing that was judged, and one ``overall`` row for each claim.

The key of a row is (paper, claim_id, quantity, variant, condition). Every cell but ``n`` is text: numbers
of ours are written with ``%.10g``, published ones as the paper prints them, and a value that does not
exist is an empty string, never NaN.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from robins.evaluate.published import PLAIN_NUMBER, claim_ids, rows_of
from robins.evaluate.verdicts import Verdict
from robins.foundation.errors import InputError
from robins.foundation.files import write_text

COLUMNS = (
    "paper", "claim_id", "location", "quantity", "condition", "unit", "published", "published_high",
    "ours", "ci_low", "ci_high", "n", "variant", "verdict", "reason",
)  # fmt: skip
KEY = ("paper", "claim_id", "quantity", "variant", "condition")
FILLED_COLUMNS = ("paper", "claim_id", "quantity", "condition", "reason")
NUMBER_COLUMNS = ("published", "published_high", "ci_low", "ci_high")
OVERALL = "overall"
FAILED = "failed"

NEEDS_INTERVAL = frozenset({Verdict.REPLICATED, Verdict.DIRECTION_ONLY, Verdict.NOT_REPLICATED})
"""Verdicts that compare an estimate: without an interval and an n they say nothing."""

NOT_A_VALUE = re.compile(r"[+-]?(nan|inf|infinity|none|<na>)", re.IGNORECASE)


@dataclass(frozen=True)
class Row:
    """One row of the ledger, as a claim's rule returns it.

    Attributes
    ----------
    claim_id, quantity, condition : str
        ``condition`` is ``overall`` in the row that closes the claim.
    ours, ci_low, ci_high : float or str
        Estimate and interval in `unit`; "" where there is none. ``ours`` may be words.
    n : int
        Runs behind the estimate; 0 for an analytic or arithmetic answer.
    variant, verdict, reason : str
    published, published_high, unit, location : float or str
        Filled from the published table when empty: from the row with this claim and quantity (and
        location, when that is given); the location also from all rows of the claim.
    """

    claim_id: str
    quantity: str
    condition: str
    ours: float | str
    ci_low: float | str
    ci_high: float | str
    n: int
    variant: str
    verdict: str
    reason: str
    published: float | str = ""
    published_high: float | str = ""
    unit: str = ""
    location: str = ""


def cell(value: float | str) -> str:
    """A ledger cell: text as it is, a number with ten digits (minus zero as zero)."""
    return value if isinstance(value, str) else f"{float(value) + 0.0:.10g}"


def finite_or_failed(value: float) -> float | str:
    """`value`, or the word ``failed`` where no surviving run gave one (NaN or infinite)."""
    return value if np.isfinite(value) else FAILED


def build_ledger(paper_key: str, rows: Iterable[Row], published: pd.DataFrame) -> pd.DataFrame:
    """The paper's claim rows, in the order given, validated.

    Parameters
    ----------
    paper_key : str
    rows : iterable of Row
    published : DataFrame
        From `robins.evaluate.published.read_published`.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`; ``n`` whole numbers, the rest text.

    Raises
    ------
    InputError
        See `validate_ledger`.
    """
    records = [filled(paper_key, row, published) for row in rows]
    ledger = pd.DataFrame(records, columns=list(COLUMNS)).astype({name: "int64" if name == "n" else str for name in COLUMNS})
    validate_ledger(ledger, {paper_key: claim_ids(published)}, f"claim ledger of {paper_key}")
    return ledger


def filled(paper_key: str, row: Row, published: pd.DataFrame) -> dict:
    """One record of the ledger; what the row leaves empty comes from the published table."""
    record = {"paper": paper_key} | {name: cell(getattr(row, name)) for name in COLUMNS if name not in ("paper", "n")} | {"n": row.n}
    of_claim = rows_of(published, row.claim_id)
    same = of_claim[of_claim["quantity"] == row.quantity]
    if row.location:
        same = same[same["location"] == row.location]
    if len(same):
        first = same.iloc[0]
        taken = {"published": first["value"], "published_high": first["value_high"], "unit": first["unit"], "location": first["location"]}
        if record["published"] or record["published_high"]:  # a pair of numbers is never mixed from two sources
            taken["published"] = taken["published_high"] = ""
    else:
        taken = {"location": "; ".join(dict.fromkeys(of_claim["location"]))}
    return record | {name: value for name, value in taken.items() if not record[name]}


def validate_ledger(ledger: pd.DataFrame, required: Mapping[str, Iterable[str]], source) -> None:
    """Raise `InputError`, naming the offending key, when the ledger breaks one of its rules.

    Parameters
    ----------
    ledger : DataFrame
    required : mapping of paper to claim ids
        Claims that must be there.
    source : str or Path
        What the message calls the ledger.

    Notes
    -----
    The rules: exactly the columns `COLUMNS`; no NaN or infinity; text where text is needed; numbers in
    number columns; a known verdict; ``n`` not negative; an interval has two ends, in order; a numeric
    estimate that is called (not) replicated or direction only has an interval and an n; the key is unique;
    each claim, required or present, has exactly one ``overall`` row.
    """
    if tuple(ledger.columns) != COLUMNS:
        raise InputError(source, "columns", ",".join(map(str, ledger.columns)), ",".join(COLUMNS))
    for record in ledger.to_dict("records"):
        validate_record(record, source)
    keys = ledger[list(KEY)]
    if len(double := keys[keys.duplicated()]):
        raise InputError(source, " / ".join(double.iloc[0]), "the key twice", "a unique key")
    overall = ledger.loc[ledger["condition"] == OVERALL, ["paper", "claim_id"]].value_counts()
    present = dict.fromkeys(zip(ledger["paper"], ledger["claim_id"], strict=True))
    wanted = dict.fromkeys((paper, name) for paper, names in required.items() for name in names)
    for claim in wanted | present:
        if claim not in present:
            raise InputError(source, " / ".join(claim), "no row", "a row for every claim of the published table")
        if (count := overall.get(claim, 0)) != 1:
            raise InputError(source, " / ".join(claim), f"{count} overall rows", "exactly one")


def validate_record(record: dict, source) -> None:
    """The rules of `validate_ledger` that concern one row."""
    key = " / ".join(str(record[name]) for name in KEY)

    def wrong(column: str, expected: str) -> InputError:
        return InputError(source, f"{key}: {column}", repr(record[column]), expected)

    for column, value in record.items():
        if value is None or value != value or (isinstance(value, str) and NOT_A_VALUE.fullmatch(value.strip())):
            raise wrong(column, "a finite value, a word or an empty cell")
        if column != "n" and not isinstance(value, str):
            raise wrong(column, "text")
        if column in FILLED_COLUMNS and not value.strip():
            raise wrong(column, "a text")
        if column in NUMBER_COLUMNS and value and not PLAIN_NUMBER.fullmatch(value):
            raise wrong(column, "a number or an empty cell")
    if ";" in record["claim_id"]:
        raise wrong("claim_id", "one id")
    if record["verdict"] not in list(Verdict):
        raise wrong("verdict", "one of " + ", ".join(Verdict))
    if not isinstance(record["n"], int | np.integer) or record["n"] < 0:
        raise wrong("n", "a whole number, not negative")
    if (record["ci_low"] == "") != (record["ci_high"] == ""):
        raise wrong("ci_high" if record["ci_low"] else "ci_low", "both ends of the interval or neither")
    if record["ci_low"] and float(record["ci_low"]) > float(record["ci_high"]):
        raise wrong("ci_low", f"at most the upper end {record['ci_high']}")
    if record["verdict"] in NEEDS_INTERVAL and PLAIN_NUMBER.fullmatch(record["ours"]):
        if not record["ci_low"]:
            raise wrong("ci_low", f"an interval, since the verdict is {record['verdict']}")
        if record["n"] == 0:
            raise wrong("n", f"the number of runs, since the verdict is {record['verdict']}")


def write_ledger(ledger: pd.DataFrame, path) -> None:
    """Write the ledger as CSV, whole or not at all."""
    write_text(path, ledger.to_csv(index=False, lineterminator="\n"))


def read_ledger(path, required: Mapping[str, Iterable[str]]) -> pd.DataFrame:
    """Read and validate a ledger (all papers' rows may stand in one file).

    Raises
    ------
    InputError
        The file is missing or cannot be read, ``n`` is not a whole number, or see `validate_ledger`.
    """
    path = Path(path)
    try:
        ledger = pd.read_csv(path, dtype=str, keep_default_na=False, encoding="utf-8")
    except FileNotFoundError:
        raise InputError(path, "", "no such file", "a claim ledger as CSV") from None
    except (OSError, ValueError) as error:  # decoding and parsing errors are ValueErrors
        raise InputError(path, "", f"an unreadable file ({error})", "a claim ledger as CSV") from error
    if "n" in ledger:
        for line, text in enumerate(ledger["n"], start=2):
            if not re.fullmatch(r"\d+", str(text)):
                raise InputError(path, f"row {line}, column n", repr(text), "a whole number, not negative")
        ledger["n"] = ledger["n"].astype("int64")
    validate_ledger(ledger, required, path)
    return ledger
