"""A table is written only when it is what its specification promises."""

import numpy as np
import pandas as pd
import pytest

from robins.foundation.errors import InputError
from robins.papers.protocol import Column, Table
from robins.publish import tables

TABLE = Table(
    "table-9", "Errors", "Table 9",
    (Column("filter", "key"), Column("rmse", "number", "m/s"), Column("failed", "count"), Column("note", "text")),
    build=lambda results: None, needs=(), modules=(), caption="Made up.",
)  # fmt: skip


def frame(**changes) -> pd.DataFrame:
    columns = {"filter": ["a|b", "c"], "rmse": [1.23456789012345, "failed"], "failed": [0, 8], "note": ["", "all"]}
    return pd.DataFrame(columns | changes)


def test_the_csv_has_ten_digits_unix_lines_and_no_index(tmp_path):
    assert tables.write(frame(), TABLE, tmp_path / "t.csv", 8) == 6
    assert (tmp_path / "t.csv").read_bytes() == b"filter,rmse,failed,note\na|b,1.23456789,0,\nc,failed,8,all\n"


def test_the_markdown_has_units_four_digits_caption_and_n(tmp_path):
    tables.write(frame(), TABLE, tmp_path / "t.csv", 8)
    text = (tmp_path / "t.md").read_text()
    assert "| filter | rmse (m/s) | failed | note |" in text
    assert "| a\\|b | 1.235 | 0 |  |" in text
    assert "Made up.\n\nn = 8.\n" in text
    assert text.startswith("# Errors\n\n*Table 9*\n")


def test_what_was_written_is_read_back(tmp_path):
    tables.write(frame(rmse=[0.1, -0.0]), TABLE, tmp_path / "t.csv")
    back = tables.read(tmp_path / "t.csv", TABLE)
    assert back["rmse"].dtype == np.float64
    np.testing.assert_array_equal(back["rmse"], [0.1, 0.0])
    assert "-0" not in (tmp_path / "t.csv").read_text()
    tables.write(frame(), TABLE, tmp_path / "t.csv")
    assert tables.read(tmp_path / "t.csv", TABLE)["rmse"].tolist() == [1.23456789, "failed"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rmse": [1.0, np.nan]}, r"row 1 \(c\), rmse: found nan"),
        ({"rmse": [np.inf, 1.0]}, r"row 0 \(a\|b\), rmse: found inf"),
        ({"rmse": [1.0, "lost"]}, r"row 1 \(c\), rmse: found 'lost', expected a finite number or 'failed'"),
        ({"rmse": [1.0, None]}, r"row 1 \(c\), rmse"),
        ({"failed": [0, 1.5]}, r"row 0 \(a\|b\), failed: found .*0.0.*, expected a whole number"),
        ({"filter": ["c", "c"]}, r"row 1: found a second row with the key c"),
        ({"filter": ["a", ""]}, r"row 1 \(\), filter: .*a key that is not empty"),
        ({"note": ["", "two\nlines"]}, r"row 1 \(c\), note"),
        ({"more": [1, 2]}, r"columns: found filter, rmse, failed, note, more"),
    ],
)
def test_a_wrong_cell_is_refused_by_name_and_nothing_is_written(changes, message, tmp_path):
    with pytest.raises(InputError, match=message):
        tables.write(frame(**changes), TABLE, tmp_path / "t.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_missing_or_misplaced_column_and_an_empty_table_are_refused():
    for wrong in (frame().drop(columns="note"), frame()[["rmse", "filter", "failed", "note"]], frame().iloc[:0]):
        with pytest.raises(InputError):
            tables.validate(wrong, TABLE)


def test_cells_are_rows_times_columns_that_are_no_keys():
    assert tables.cells(7, TABLE) == 21


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xef\xbb\xbffilter,rmse\na,1\n", "a byte-order mark"),
        (b"filter,rmse\r\na,1\r\n", "a carriage return"),
        (b"filter,rmse\na,1\nb,2,3\n", "row 1: found 3 fields, expected 2"),
        (b"filter,rmse\na,1,\nb,2,\n", "row 0: found 3 fields"),
        (b"filter,rmse\na\n", "row 0: found 1 fields"),
        (b"filter,rmse\n\na,1\n", "row 0: found 0 fields"),
        (b"filter,filter\na,1\n", "each column once"),
        (b'filter,rmse\n"a,1\n', "no table"),
        (b"", "no table"),
    ],
)
def test_a_file_that_is_no_plain_table_is_refused(content, message, tmp_path):
    (tmp_path / "t.csv").write_bytes(content)
    with pytest.raises(InputError, match=message):
        tables.read_text(tmp_path / "t.csv")


@pytest.mark.parametrize("cell", [" 1", "1_0", "\u0661", "nan", "1e999"])
def test_a_number_that_is_not_plain_is_not_read_back(cell, tmp_path):
    for line in (f"a,{cell},0,", f"a,1,{cell},"):
        (tmp_path / "t.csv").write_text(f"filter,rmse,failed,note\n{line}\n", encoding="utf-8")
        with pytest.raises(InputError, match=r"row 0 \(a\)"):
            tables.read(tmp_path / "t.csv", TABLE)


def test_quoted_cells_and_empty_ones_are_read_as_they_stand(tmp_path):
    (tmp_path / "t.csv").write_text('filter,note\n"a, ""b""",\nNA,"two\nlines"\n')
    assert tables.read_text(tmp_path / "t.csv").to_numpy().tolist() == [['a, "b"', ""], ["NA", "two\nlines"]]
