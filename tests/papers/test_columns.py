"""Columns and cells that the tables of every wing share."""

import math

from robins.papers.columns import ADAPTIVE, counts, ends, finite, keys, make, numbers, texts
from robins.publish.tables import FAILED
from robins.publish.tolerances import refuse_columns


def build(results):
    """Stands for a table's builder."""


def test_each_kind_of_column_has_its_kind_and_numbers_their_tolerance():
    columns = *keys("state"), *texts("unit"), *counts("n"), *numbers("rmse", unit="m/s")
    assert [column.kind for column in columns] == ["key", "text", "count", "number"]
    assert columns[-1].relative == ADAPTIVE and columns[-1].unit == "m/s"
    assert numbers("gain", absolute=1e-8)[0].absolute == 1e-8


def test_a_made_table_has_its_columns_in_order_and_depends_on_the_module_of_its_builder():
    table = make("table-1", "Errors", build, (keys("state"), numbers("rmse"), counts("n")), ["ekf"], "One filter.")
    assert [column.name for column in table.columns] == ["state", "rmse", "n"]
    assert table.modules == (__name__,) and table.needs == ("ekf",)
    assert refuse_columns(table) == []


def test_what_no_surviving_run_gave_is_the_word_failed():
    assert finite(2.0) == 2.0
    assert finite(math.nan) == finite(math.inf) == FAILED


def test_an_interval_with_one_open_end_has_no_end():
    assert ends("ci", 1.0, 2.0) == {"ci_low": 1.0, "ci_high": 2.0}
    assert set(ends("ci", 1.0, math.inf).values()) == {FAILED}
