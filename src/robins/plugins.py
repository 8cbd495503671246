"""Weights, models and papers that live outside this package, found through Python's entry points.

A distribution that declares an entry point in the group ``robins.weights`` or ``robins.papers`` is
picked up wherever it is installed; nothing in this package has to be edited for it.
"""

import sys
from importlib.machinery import PathFinder
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

WEIGHTS = "robins.weights"
PAPERS = "robins.papers"


def found(group: str) -> list[EntryPoint]:
    """The installed entry points of `group`, sorted by name."""
    return sorted(entry_points(group=group), key=lambda entry: entry.name)


def source_files() -> list[Path]:
    """Python sources of every distribution that offers an entry point to robins, without importing them.

    They are what the distribution lists, and the whole package that the entry point names: an editable installation
    (``pip install -e``) lists none of its sources.
    """
    files = set()
    for group in (WEIGHTS, PAPERS):
        for entry in found(group):
            if entry.dist is None or entry.dist.name == "robins":
                continue
            files.update(Path(entry.dist.locate_file(f)) for f in entry.dist.files or () if f.suffix == ".py")
            files.update(package_files(entry.module.partition(".")[0]))
    return sorted({file.resolve() for file in files if file.is_file()})


def package_files(name: str) -> list[Path]:
    """Python sources of the top-level package or module `name`, as the import system would find it."""
    spec = PathFinder.find_spec(name, sys.path)
    if spec is None:
        return []
    if spec.submodule_search_locations is not None:
        return [file for folder in spec.submodule_search_locations for file in Path(folder).rglob("*.py")]
    return [Path(spec.origin)] if spec.origin and spec.origin.endswith(".py") else []
