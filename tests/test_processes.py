"""The suite in two processes: when, and in which order they take the files."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from .conftest import pytest_collection_modifyitems, pytest_xdist_auto_num_workers

SOURCES = pytest.Config.ArgsSource


def processes(source) -> int:
    """How many processes pytest starts for arguments from this source."""
    return pytest_xdist_auto_num_workers(SimpleNamespace(args_source=source, ArgsSource=SOURCES))


def item(file, *marks):
    """A collected test, as far as the hooks look at it."""
    return SimpleNamespace(path=Path(file), get_closest_marker=lambda name: name in marks, add_marker=lambda mark: None)


def test_the_whole_suite_has_two_processes_and_a_part_of_it_has_none_of_its_own(monkeypatch):
    monkeypatch.delenv("PYTEST_XDIST_WORKER", raising=False)
    assert [processes(source) for source in (SOURCES.TESTPATHS, SOURCES.ARGS)] == [2, 0]


def test_a_test_that_runs_pytest_starts_no_further_processes(monkeypatch):
    monkeypatch.setenv("PYTEST_XDIST_WORKER", "gw0")
    assert processes(SOURCES.TESTPATHS) == 0


def test_two_processes_begin_with_the_files_that_have_most_slow_tests_and_one_keeps_the_order():
    items = [item("a"), item("b", "slow"), item("c"), item("d", "slow"), item("d", "slow"), item("d")]
    alone = list(items)
    pytest_collection_modifyitems(SimpleNamespace(), alone)
    assert alone == items
    pytest_collection_modifyitems(SimpleNamespace(workerinput={}), items)
    assert "".join(each.path.name for each in items) == "dddbac"
