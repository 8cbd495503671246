"""Does the code still make the published tables?

The set of tables comes from the registry of papers and from data/published, never from what happens to lie in a
folder, so a table cannot vanish from both sides. Whether a paper was *replicated* is none of this module's business,
but a verdict that changed at the same n is. `robins.publish.regenerate` makes the fresh results and calls `compare`.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace

import pandas as pd

from robins.publish import tables
from robins.publish.comparison import Comparison, compare_file, compare_frames
from robins.publish.tolerances import refuse_columns, refuse_tolerances

CLAIMS = "claims.csv"
TOO_SMALL = "n too small"
_CLAIM_COLUMNS = {
    "paper": "key", "claim_id": "key", "location": "text", "quantity": "key", "condition": "key", "unit": "text",
    "published": "printed", "published_high": "printed", "ours": "optional", "ci_low": "optional", "ci_high": "optional",
    "n": "count", "variant": "key", "verdict": "verdict", "reason": "prose",
}  # fmt: skip


def _specification(name: str, kinds: Mapping[str, str]) -> SimpleNamespace:
    """A table's specification for what is not in the registry of papers."""
    columns = [SimpleNamespace(name=column, kind=kind, unit="", relative=1e-6, absolute=0.0) for column, kind in kinds.items()]
    return SimpleNamespace(name=name, columns=tuple(columns))


CLAIM_TABLE = _specification(CLAIMS, _CLAIM_COLUMNS)
"""The claim ledger as a table's specification."""


def compare(results, reference, papers: Mapping, published: Mapping[str, pd.DataFrame], demand_n: bool = False) -> Comparison:
    """Compare a fresh results folder with the versioned one.

    Parameters
    ----------
    results, reference : Path
        Folders with ``<paper>/tables/<name>.csv`` and ``claims.csv``; the reference also has ``manifest.json``.
    papers : mapping of str to Paper
        The registry.
    published : mapping of str to DataFrame
        data/published, by paper.
    demand_n : bool
        Whether a claim that says ``n too small`` is a difference (it is in ``results/``, not in a small ensemble).

    Returns
    -------
    Comparison
        Its list of differences is empty when the code still makes the reference.
    """
    results, reference = Path(results), Path(reference)
    outcome = Comparison()
    expected = expected_tables(papers, published, outcome)
    recorded = _recorded_cells(reference, outcome)
    for folder, side in ((results, "results"), (reference, "reference")):
        for path in sorted(folder.glob("*/tables/*.csv")):
            name = path.relative_to(folder).as_posix()
            if name not in expected and not name.startswith("field/"):
                outcome.differ(name, "", f"an undeclared table in the {side}", "only tables of the registry")
    for name, table in expected.items():
        compare_file(name, table, results / name, reference / name, recorded.pop(name, None), outcome)
        _check_tolerances(name, table, reference / name, outcome)
    compare_file(CLAIMS, CLAIM_TABLE, results / CLAIMS, reference / CLAIMS, recorded.pop(CLAIMS, None), outcome)
    for name in recorded:
        outcome.differ(name, "", "a table that only the manifest knows", "only tables of the registry")
    _check_claims(results / CLAIMS, published, demand_n, outcome)
    if not outcome.cells:
        outcome.differ("all tables", "", "no cell compared", "at least one")
    return outcome


def expected_tables(papers: Mapping, published: Mapping[str, pd.DataFrame], outcome: Comparison) -> dict[str, object]:
    """The specification of every table that has to be there, by path below the results folder.

    Every paper needs published numbers and the other way round, and each numbered table that a paper's published
    numbers come from needs a table of the registry that names it in its location.
    """
    for key in sorted(set(papers) ^ set(published)):
        found = "published numbers without a paper" if key in published else "a paper without published numbers"
        outcome.differ(key, "", found, "a wing in the registry and a file in data/published")
    specifications = {}
    for key, paper in papers.items():
        for table in paper.tables:
            specifications[f"{key}/tables/{table.name}.csv"] = table
            for problem in refuse_columns(table):
                outcome.differ(f"{key}/tables/{table.name}.csv", "specification", problem, "a specification that can fail")
        if key in published:
            printed = {number for place in published[key]["location"] for number in _table_numbers(str(place))}
            made = {number for table in paper.tables for number in _table_numbers(table.location)}
            for number in sorted(printed - made):
                outcome.differ(key, f"Table {number}", "no table of the registry with this location", "one: data/published cites it")
    return specifications


def _table_numbers(location: str) -> list[str]:
    """Numbers of the tables that a location names: "Table 1, Fig 5" gives ["1"]."""
    return re.findall(r"\bTable ([IVX]+|\d+)\b", location)


def _recorded_cells(reference: Path, outcome: Comparison) -> dict[str, int]:
    path = reference / "manifest.json"
    if not path.is_file():
        outcome.differ("manifest.json", "", "no file in the reference", "the recorded number of cells of every table")
        return {}
    artefacts = json.loads(path.read_text(encoding="utf-8"))["artefacts"]
    return {name: entry["cells"] for name, entry in artefacts.items() if "cells" in entry}


def compare_field(results, reference, outcome: Comparison, demand_n: bool = False) -> list[str]:
    """Compare the tables made from real recordings, as far as the fresh run had the recordings.

    They are no part of the registry of papers, so the reference's own columns are the specification: numbers to 1e-6,
    whole numbers and words exact, rows by position.

    Parameters
    ----------
    results, reference : Path
        Folders that may have ``field/``.
    outcome : Comparison
        Where differences and counts go.
    demand_n : bool
        As in `compare`: whether the reference has to have every field table that the run made or that its own
        ``field/manifest.json`` lists. A reference of a small ensemble may have none at all.

    Returns
    -------
    list of str
        Names of the tables that were not compared because the run had no recordings.
    """
    results, reference = Path(results) / "field", Path(reference) / "field"
    names = sorted(path.relative_to(reference).as_posix() for path in reference.rglob("*.csv"))
    for name in sorted(_listed_field_tables(reference) - set(names)) if demand_n else ():
        outcome.differ(f"field/{name}", "", "no table in the reference", "the table that its manifest lists")
    if not results.is_dir():
        return names
    extra = {path.relative_to(results).as_posix() for path in results.rglob("*.csv")} - set(names)
    for name in sorted(extra if names or demand_n else ()):
        outcome.differ(f"field/{name}", "", "a table that the reference does not have", "no such table")
    for name in names:
        _compare_field_table(f"field/{name}", results / name, reference / name, outcome)
    return []


def _listed_field_tables(folder: Path) -> set[str]:
    path = folder / "manifest.json"
    artefacts = json.loads(path.read_text(encoding="utf-8"))["artefacts"] if path.is_file() else ()
    return {name for name in artefacts if name.endswith(".csv")}


def _compare_field_table(name: str, found_path: Path, expected_path: Path, outcome: Comparison) -> None:
    if not found_path.is_file():
        outcome.differ(name, "", "no table in the results", "the table")
        return
    try:
        frames = [tables.read_text(path) for path in (found_path, expected_path)]
    except (ValueError, OSError) as error:
        outcome.differ(name, "", f"an unreadable file ({error})", "a CSV file")
        return
    for frame in frames:
        frame.insert(0, "row", [str(position) for position in range(len(frame))])
    kinds = {column: "key" if column == "row" else "measured" for column in frames[1].columns}
    compare_frames(name, _specification(name, kinds), *frames, outcome)


def _check_tolerances(name: str, table, path: Path, outcome: Comparison) -> None:
    """A tolerance too wide for the table's own intervals is a difference too; unreadable tables are noted elsewhere."""
    try:
        problems = refuse_tolerances(table, tables.read(path, table))
    except (ValueError, OSError, KeyError):
        return
    for problem in problems:
        outcome.differ(name, "tolerance", problem, "a tolerance that can fail")


def _check_claims(path: Path, published: Mapping[str, pd.DataFrame], demand_n: bool, outcome: Comparison) -> None:
    """Note claims of data/published without exactly one overall row, and verdicts from too few runs."""
    if not path.is_file():
        return
    frame = tables.read_text(path)
    if list(frame.columns) != list(_CLAIM_COLUMNS):
        return
    judged = list(frame.loc[frame["condition"] == "overall", ["paper", "claim_id"]].itertuples(index=False, name=None))
    for key, numbers in published.items():
        for claim in claim_ids(numbers):
            if judged.count((key, claim)) != 1:
                outcome.differ(
                    CLAIMS, f"{key} {claim}", f"{judged.count((key, claim))} overall rows", "one for each claim of data/published"
                )
    for line in frame[frame["verdict"] == TOO_SMALL].itertuples():
        if demand_n:
            outcome.differ(CLAIMS, f"{line.paper} {line.claim_id} {line.condition}", f"n = {line.n}", "the n that the brief demands")


def claim_ids(published: pd.DataFrame) -> list[str]:
    """The ids in data/published that carry a verdict: those that begin with C, in order of appearance."""
    ids = (part.strip() for cell in published["claim_id"] for part in str(cell).split(";"))
    return list(dict.fromkeys(part for part in ids if part.startswith("C")))
