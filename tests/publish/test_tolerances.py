"""A tolerance that lets a wrong table pass is refused."""

import pandas as pd
import pytest

from robins.papers.protocol import Column, Table
from robins.publish.tolerances import refuse_columns, refuse_tolerances


def table(*columns) -> Table:
    return Table("t", "T", "", columns, build=lambda results: None, needs=(), modules=())


def test_a_relative_tolerance_above_one_in_a_hundred_thousand_is_refused():
    assert refuse_columns(table(Column("a", "key"), Column("x", "number", relative=1e-5))) == []
    assert refuse_columns(table(Column("a", "key"), Column("x", "number", relative=1.01e-5)))
    assert refuse_columns(table(Column("a", "key"), Column("x", "number", relative=float("nan"))))


@pytest.mark.parametrize(
    "columns",
    [
        (Column("x", "number"),),
        (Column("a", "key"),),
        (Column("a", "key"), Column("x", "figure")),
        (Column("a", "key"), Column("x", "number"), Column("x", "number")),
        (Column("a", "key"), Column("x", "number", absolute=-1.0)),
    ],
)
def test_a_specification_that_cannot_fail_is_refused(columns):
    assert refuse_columns(table(*columns))


@pytest.mark.parametrize(("low", "high"), [("x_low", "x_high"), ("ci_low", "ci_high")])
def test_an_absolute_tolerance_is_measured_against_the_half_width_of_the_cells_interval(low, high):
    frame = pd.DataFrame({"a": ["p", "q"], "x": [1.0, 2.0], low: [0.9, 1.0], high: [1.1, 3.0]})

    def specification(absolute):
        ends = Column(low, "number", absolute=absolute), Column(high, "number")
        return table(Column("a", "key"), Column("x", "number", absolute=absolute), *ends)

    assert refuse_tolerances(specification(0.99e-4), frame) == []
    problems = refuse_tolerances(specification(1.01e-4), frame)  # a thousandth of 0.1 in row 0; row 1 would allow 1e-3
    assert [problem.partition(":")[0] for problem in problems] == ["x, row 0", f"{low}, row 0"]


def test_without_an_interval_only_round_off_is_allowed():
    frame = pd.DataFrame({"a": ["p"], "x": [1.0]})
    assert refuse_tolerances(table(Column("a", "key"), Column("x", "number", absolute=1e-12)), frame) == []
    assert refuse_tolerances(table(Column("a", "key"), Column("x", "number", absolute=1e-11)), frame)
