"""The results as one page for readers: verdicts first, then each paper, then where everything comes from.

The page needs no network: styles are inside, figures are data URIs, formulas are MathML. Two runs over the same results
give the same bytes.
"""

import base64
import json
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path

import jinja2
import pandas as pd
from latex2mathml.converter import convert
from markupsafe import Markup

from robins.foundation.errors import InputError
from robins.foundation.files import write_text
from robins.publish import equations, tables
from robins.publish.check import CLAIMS
from robins.publish.sourcehash import source_hash

TEMPLATES = Path(__file__).parent / "templates"
LONG_TABLE = 24  # rows; longer tables are folded

# How a reader should feel about a verdict; the words themselves are always printed.
_TONES = {
    "replicated": "good",
    "direction only": "fair",
    "compatible but uninformative": "fair",
    "not replicated": "bad",
    "refuted": "bad",
    "n too small": "bad",
    "depends on assumption": "mixed",
    "inconclusive": "open",
    "untestable": "open",
}
_MEDIA = {".png": "image/png", ".svg": "image/svg+xml"}
_PROSE = re.compile(r"\$([^$]+)\$|`([^`]+)`")


@dataclass(frozen=True)
class Judged:
    """One claim in the report: its statement, its overall row of the ledger and the rows behind it."""

    claim_id: str
    statement: str
    overall: dict
    details: list[dict]


@dataclass(frozen=True)
class TableView:
    """One table in the report; ``rows`` are cells as readers see them, ``numeric`` tells which columns are numbers."""

    name: str
    title: str
    location: str
    caption: str
    n: int | None
    heads: list[str]
    numeric: list[bool]
    rows: list[list[str]]
    file: str


@dataclass(frozen=True)
class FigureView:
    """One figure in the report, as a data URI."""

    name: str
    title: str
    location: str
    caption: str
    n: int | None
    uri: str


@dataclass(frozen=True)
class PaperView:
    """Everything the template shows of one paper."""

    paper: object
    counts: dict[str, int]
    claims: list[Judged]
    tables: list[TableView]
    figures: list[FigureView]
    equations: list[equations.Row]


def write(path, papers: Mapping, results, ensemble: str) -> None:
    """Write the report of `results` to `path`; see `render`."""
    write_text(path, render(papers, results, ensemble))


def render(papers: Mapping, results, ensemble: str) -> str:
    """The report as HTML.

    Parameters
    ----------
    papers : mapping of str to Paper
        The papers that `results` shows.
    results : Path
        Folder with ``<paper>/tables``, ``<paper>/figures``, ``claims.csv``, ``manifest.json`` and perhaps ``field/``.
    ensemble : str
        Which ensemble this is; anything but ``standard`` is said at the top.

    Raises
    ------
    InputError
        A table is not what the registry promises, or a formula cannot be set.
    FileNotFoundError
        Something that the registry promises is not there.
    """
    results = Path(results)
    manifest = json.loads((results / "manifest.json").read_text(encoding="utf-8"))
    ledger = tables.read_text(results / CLAIMS)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES), autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    environment.filters |= {"math": math, "prose": prose, "tone": lambda verdict: _TONES.get(verdict, "open"), "number": number}
    views = [_view(paper, results, ledger[ledger["paper"] == key], manifest["artefacts"]) for key, paper in papers.items()]
    page = environment.get_template("report.html.j2").render(
        papers=views, manifest=manifest, ensemble=ensemble, field=field_views(results / "field"), long_table=LONG_TABLE
    )
    return page.rstrip() + "\n"


def fingerprint(papers: Mapping) -> str:
    """Hash of what the page shows beside the results: its code and templates, the wings' words, and the equation index."""
    words = {}
    for key, paper in papers.items():
        products = [(item.name, item.title, item.location, item.caption) for item in (*paper.tables, *paper.figures)]
        claims = [(claim.claim_id, claim.statement) for claim in paper.claims]
        head = (paper.title, paper.citation, paper.doi, paper.summary)
        words[key] = (head, products, claims, paper.assumptions, equations.index(paper))
    templates = {path.name: path.read_text(encoding="utf-8") for path in sorted(TEMPLATES.iterdir()) if path.is_file()}
    return source_hash([__name__], {"words": words, "templates": templates})


def _view(paper, results: Path, ledger: pd.DataFrame, artefacts: Mapping) -> PaperView:
    claims = judged_claims(paper, ledger)
    counted = Counter(claim.overall["verdict"] for claim in claims)
    order = [*_TONES, *sorted(set(counted) - set(_TONES))]
    folder = results / paper.key
    return PaperView(
        paper=paper,
        counts={verdict: counted[verdict] for verdict in order if counted[verdict]},
        claims=claims,
        tables=[_table_view(table, folder, artefacts) for table in paper.tables],
        figures=[_figure_view(figure, folder, artefacts) for figure in paper.figures],
        equations=equations.index(paper),
    )


def judged_claims(paper, ledger: pd.DataFrame) -> list[Judged]:
    """The paper's claims in the registry's order, each with its overall row first and the rest behind it."""
    claims = []
    for claim in paper.claims:
        rows = ledger[ledger["claim_id"] == claim.claim_id]
        overall = rows[rows["condition"] == "overall"]
        if len(overall) != 1:
            raise InputError(CLAIMS, f"{paper.key} {claim.claim_id}", f"{len(overall)} overall rows", "one")
        details = rows[rows["condition"] != "overall"].to_dict("records")
        claims.append(Judged(claim.claim_id, claim.statement, overall.iloc[0].to_dict(), details))
    return claims


def _table_view(table, folder: Path, artefacts: Mapping) -> TableView:
    frame = tables.read(folder / "tables" / f"{table.name}.csv", table)
    file = f"{folder.name}/tables/{table.name}.csv"
    return TableView(
        name=table.name,
        title=table.title,
        location=table.location,
        caption=table.caption,
        n=artefacts.get(file, {}).get("n"),
        heads=[tables.header(column) for column in table.columns],
        numeric=[column.kind in ("number", "count") for column in table.columns],
        rows=[[tables.rounded(cell) for cell in row] for row in frame.itertuples(index=False)],
        file=file,
    )


def _figure_view(figure, folder: Path, artefacts: Mapping) -> FigureView:
    path = folder / "figures" / f"{figure.name}{figure.suffix}"
    n = artefacts.get(f"{folder.name}/figures/{path.name}", {}).get("n")
    return FigureView(figure.name, figure.title, figure.location, figure.caption, n, data_uri(path))


def field_views(folder: Path) -> dict:
    """What was made from real recordings, as results/field/manifest.json lists it; nothing where there is none.

    Returns
    -------
    dict
        ``tables`` and ``figures`` as for a paper, ``recording``: what the manifest says about its origin.
    """
    found = {"tables": [], "figures": [], "recording": {}}
    if not (folder / "manifest.json").is_file():
        return found
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    found["recording"] = manifest.get("recording", {})
    for file, entry in manifest["artefacts"].items():
        path = folder / file
        name = file.removesuffix(path.suffix)
        anchor, title = name.replace("/", "-"), name.replace("/", ": ").replace("-", " ").capitalize()
        if path.suffix == ".csv":
            frame = tables.read_text(path)
            numeric = [bool(pd.to_numeric(frame[column], errors="coerce").notna().any()) for column in frame.columns]
            rows = [[number(cell) for cell in row] for row in frame.itertuples(index=False)]
            view = TableView(anchor, title, "", "", entry["n"], list(frame.columns), numeric, rows, f"field/{file}")
            found["tables"].append(view)
        else:
            found["figures"].append(FigureView(anchor, title, "", "", entry["n"], data_uri(path)))
    return found


def data_uri(path: Path) -> str:
    """The bytes of an image as a data URI."""
    return f"data:{_MEDIA[path.suffix]};base64,{base64.b64encode(path.read_bytes()).decode()}"


def math(latex: str, display: str = "block") -> Markup:
    """LaTeX (without dollar signs) as MathML.

    Raises
    ------
    InputError
        The converter refuses it, or would silently show something else: an open brace, an unknown command, a stray ``&``.
    """
    try:
        markup = convert(latex, display=display)
    except Exception as error:  # the converter has a dozen kinds of errors and no common base
        raise InputError("formula", latex, f"{type(error).__name__} {error}".strip(), "LaTeX that can be set as MathML") from error
    bare = latex.replace("\\{", "").replace("\\}", "")
    if bare.count("{") != bare.count("}") or "\\" in markup or "<mi>&</mi>" in markup:
        raise InputError("formula", latex, "an open brace, an unknown command or a stray &", "LaTeX that can be set as MathML")
    return Markup(markup)


def prose(text: str) -> Markup:
    """A sentence with ``$formulas$`` and `` `code` `` in it."""
    pieces, end = [], 0
    for match in _PROSE.finditer(text):
        pieces.append(escape(text[end : match.start()]))
        latex, code = match.groups()
        pieces.append(math(latex, "inline") if latex else f"<code>{escape(code)}</code>")
        end = match.end()
    return Markup("".join([*pieces, escape(text[end:])]))


def number(cell: str) -> str:
    """The text of a cell, rounded to four digits when it is a number with more."""
    try:
        value = float(cell)
    except ValueError:
        return cell
    return cell if len(cell.lstrip("-0.").replace(".", "")) <= 4 else tables.rounded(value)
