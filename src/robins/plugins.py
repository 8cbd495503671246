"""Weights, models and papers that live outside this package, found through Python's entry points.

A distribution that declares an entry point in the group ``robins.weights`` or ``robins.papers`` is
picked up wherever it is installed; nothing in this package has to be edited for it.
"""

from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

WEIGHTS = "robins.weights"
PAPERS = "robins.papers"


def found(group: str) -> list[EntryPoint]:
    """The installed entry points of `group`, sorted by name."""
    return sorted(entry_points(group=group), key=lambda entry: entry.name)


def source_files() -> list[Path]:
    """Python sources of every distribution that offers an entry point to robins, without importing them."""
    files = set()
    for group in (WEIGHTS, PAPERS):
        for entry in found(group):
            if entry.dist is not None and entry.dist.files and entry.dist.name != "robins":
                files.update(Path(entry.dist.locate_file(f)) for f in entry.dist.files if f.suffix == ".py")
    return sorted(f for f in files if f.is_file())
