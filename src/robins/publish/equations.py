"""From a numbered equation to the line of code that implements it and the test that pins it.

A line of code carries the equation's number and the paper's key in a comment (several numbers are separated by commas;
words may follow), as in ``x = A @ x  # (1) key2026``. Only comments count, not text. The index is made from these
markers, so it cannot point to a line that has moved.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import robins
from robins import plugins

_MARKER = re.compile(r"#\s*((?:\([\w.'-]+\)(?:\s*,\s*)?)+)\s*([a-z][a-z0-9]*)\b")
_NUMBER = re.compile(r"\(([\w.'-]+)\)")


@dataclass(frozen=True)
class Row:
    """One line of the equation index; ``code`` holds ``file:line`` of every marker. LaTeX without dollar signs."""

    number: str
    title: str
    printed: str
    corrected: str
    status: str
    note: str
    code: tuple[str, ...]
    test: str


def library_sources() -> dict[str, Path]:
    """Python files that may carry markers, by the name readers see: this package's and those of installed plug-ins."""
    package = Path(robins.__file__).parent
    found = {f"src/{file.relative_to(package.parent).as_posix()}": file for file in sorted(package.rglob("*.py"))}
    return found | {f"{file.parent.name}/{file.name}": file for file in plugins.source_files()}


def markers(sources: dict[str, Path]) -> dict[tuple[str, str], list[str]]:
    """Places ``file:line`` of every marker in `sources`, by (paper, equation number)."""
    found: dict[tuple[str, str], list[str]] = {}
    for name, file in sources.items():
        for line, comment in comments(file.read_bytes()):
            for numbers, paper in _MARKER.findall(comment):
                for number in _NUMBER.findall(numbers):
                    found.setdefault((paper, number), []).append(f"{name}:{line}")
    return found


def comments(source: bytes) -> list[tuple[int, str]]:
    """Line and text of every comment in a Python `source`."""
    tokens = tokenize.tokenize(io.BytesIO(source).readline)
    return [(token.start[0], token.string) for token in tokens if token.type == tokenize.COMMENT]


def index(paper, sources: dict[str, Path] | None = None) -> list[Row]:
    """The equation index of `paper`, in the order of its registry.

    Parameters
    ----------
    paper : Paper
        Its key and equations are read.
    sources : mapping of str to Path, optional
        Default: `library_sources`.
    """
    places = markers(library_sources() if sources is None else sources)
    return [
        Row(e.number, e.title, e.printed, e.corrected, e.status, e.note, tuple(places.get((paper.key, e.number), ())), e.test)
        for e in paper.equations
    ]


def incomplete(paper, tests: Path, sources: dict[str, Path] | None = None) -> list[str]:
    """What the equation index of `paper` lacks: a code line, or a test that exists; markers of unknown equations too.

    Parameters
    ----------
    tests : Path
        The folder that ``tests/...`` in the registry's test names is relative to (the repository).
    """
    sources = library_sources() if sources is None else sources
    rows = index(paper, sources)
    problems = [f"({row.number}): no line of code is marked '# ({row.number}) {paper.key}'" for row in rows if not row.code]
    problems += [f"({row.number}): no test {row.test!r}" for row in rows if not test_exists(row.test, tests)]
    known = {row.number for row in rows}
    for (key, number), places in markers(sources).items():
        if key == paper.key and number not in known:
            problems.append(f"({number}): marked at {places[0]}, but not in the registry")
    return problems


def test_exists(name: str, repository: Path) -> bool:
    """Whether ``tests/path.py::function`` (or ``::Class::function``) is defined below `repository`."""
    file, *path = name.split("::")
    if not path or not (Path(repository) / file).is_file():
        return False
    nodes = _body(Path(repository) / file)
    for part in path:
        match = next((node for node in nodes if getattr(node, "name", None) == part), None)
        if match is None:
            return False
        nodes = match.body
    return True


test_exists.__test__ = False  # the name begins with "test", but it is none


@cache
def _body(file: Path) -> Iterable[ast.stmt]:
    return ast.parse(file.read_text(encoding="utf-8")).body
