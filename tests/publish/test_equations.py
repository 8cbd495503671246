"""Each equation leads to its line of code and to its test."""

import dataclasses

import pytest

from robins.papers import all_papers
from robins.publish import equations

CODE = """# (6) nobody1999: the measurement is differenced
def difference(z):
    return z  # (6), (18) nobody1999

# (7) somebody2000 and a line about (18)
"""
TESTS = """
def test_differencing():
    pass


class TestInnovation:
    def test_covariance(self):
        pass
"""


@pytest.fixture
def sources(tmp_path):
    (tmp_path / "code.py").write_text(CODE)
    return {"src/code.py": tmp_path / "code.py"}


@pytest.fixture
def clone(tmp_path):
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_it.py").write_text(TESTS)
    return tmp_path


def test_markers_are_found_with_file_and_line_also_several_on_a_line(sources):
    assert equations.markers(sources) == {
        ("nobody1999", "6"): ["src/code.py:1", "src/code.py:3"],
        ("nobody1999", "18"): ["src/code.py:3"],
        ("somebody2000", "7"): ["src/code.py:5"],
    }


def test_the_index_has_a_row_for_each_equation_of_the_registry(paper, sources):
    rows = equations.index(paper, sources)
    assert [(row.number, row.status, row.code) for row in rows] == [
        ("6", "ok", ("src/code.py:1", "src/code.py:3")),
        ("18", "wrong", ("src/code.py:3",)),
    ]


def test_a_complete_index_has_no_complaint(paper, sources, clone):
    assert equations.incomplete(paper, clone, sources) == []


def test_a_missing_line_a_missing_test_and_an_unknown_equation_are_named(paper, sources, clone):
    strange = dataclasses.replace(paper.equations[0], number="99", test="tests/test_it.py::test_nothing")
    other = dataclasses.replace(paper, equations=(paper.equations[1], strange))
    problems = equations.incomplete(other, clone, sources)
    assert problems == [
        "(99): no line of code is marked '# (99) nobody1999'",
        "(99): no test 'tests/test_it.py::test_nothing'",
        "(6): marked at src/code.py:1, but not in the registry",
    ]


@pytest.mark.parametrize("name", ["", "tests/test_it.py", "tests/other.py::test_differencing", "tests/test_it.py::TestInnovation::test_x"])
def test_a_test_that_does_not_exist_is_seen(name, clone):
    assert not equations.test_exists(name, clone)


def test_every_equation_of_the_library_has_its_line_and_its_test(repository):
    built_in = [paper for paper in all_papers().values() if paper.published is None]
    assert [problem for paper in built_in for problem in equations.incomplete(paper, repository)] == []
