"""Published values: what is read, and one message for each kind of bad input."""

from pathlib import Path

import pytest

from robins.evaluate.published import COLUMNS, claim_ids, published_value, read_published, rows_of
from robins.foundation.errors import InputError

HEADER = ",".join(COLUMNS)
GOOD = [
    'C1;C2,Table 1,"RMSE, north",m/s,0.0360,,number,north 0.0360,a note',
    "C1,abstract,RMSE reduction,%,,99,range,up to 99%,",
    "C3,sec 5,better,,,,qualitative,it is better,",
    "setup,sec 2,interval,step,80,150,range,80 to 150,",
    "C2,sec 3,other,1,1,,number,1,",
    "C2,sec 4,other,1,1.0,,number,1.0,",
    "C2,sec 3,torn,1,1,,number,1,",
    "C2,sec 4,torn,1,2,,number,2,",
]
TRACKED = sorted((Path(__file__).parents[2] / "data" / "published").glob("*.csv"))


def write(folder, lines, header=HEADER):
    path = folder / "paper.csv"
    path.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    return path


@pytest.fixture
def table(tmp_path):
    return read_published(write(tmp_path, GOOD))


def test_cells_stay_as_printed(table):
    assert tuple(table.columns) == COLUMNS and len(table) == len(GOOD)
    assert table["value"].iloc[0] == "0.0360" and table["value"].iloc[1] == ""
    assert table["quantity"].iloc[0] == "RMSE, north"


def test_claims_are_listed_once_in_file_order_without_set_up_values(table):
    assert claim_ids(table) == ["C1", "C2", "C3"]


def test_a_joined_id_belongs_to_both_claims(table):
    assert "RMSE, north" in set(rows_of(table, "C1")["quantity"]) & set(rows_of(table, "C2")["quantity"])


def test_a_published_value_is_a_number(table):
    assert published_value(table, "C2", "RMSE, north") == 0.036


def test_the_same_number_in_two_places_is_one_value(table):
    assert published_value(table, "C2", "other") == 1.0


@pytest.mark.parametrize("claim, quantity", [("C9", "other"), ("C1", "other"), ("C3", "better"), ("C2", "torn")])
def test_a_value_that_is_missing_or_ambiguous_is_an_error_that_names_it(table, claim, quantity):
    with pytest.raises(LookupError, match=f"{claim}, '{quantity}'"):
        published_value(table, claim, quantity)


@pytest.mark.parametrize(
    "line, column, found",
    [
        ("C1,Table 1,RMSE,m,about 3,,number,q,", "value", "'about 3'"),
        ("C1,Table 1,RMSE,m,1_000,,number,q,", "value", "'1_000'"),
        ("C1,Table 1,RMSE,m,nan,,number,q,", "value", "'nan'"),
        ("C1,Table 1,RMSE,m,inf,,number,q,", "value", "'inf'"),
        ('C1,Table 1,RMSE,m,"1,5",,number,q,', "value", "'1,5'"),
        ("C1,Table 1,RMSE,m,1,over 9,range,q,", "value_high", "'over 9'"),
        ("C1,Table 1,RMSE,m,2,1,range,q,", "value_high", "'1'"),
        ("C1,Table 1,RMSE,m,,,number,q,", "value", "''"),
        ("C1,Table 1,RMSE,m,3,,qualitative,q,", "value", "'3'"),
        ("C1,Table 1,RMSE,m,3,,numeric,q,", "kind", "'numeric'"),
        ("C1,Table 1,RMSE,m,3,,,q,", "kind", "''"),
        (",Table 1,RMSE,m,3,,number,q,", "claim_id", "''"),
        ("C1; C2,Table 1,RMSE,m,3,,number,q,", "claim_id", "'C1; C2'"),
        ("C1;,Table 1,RMSE,m,3,,number,q,", "claim_id", "'C1;'"),
        ("C1,,RMSE,m,3,,number,q,", "location", "''"),
        ("C1,Table 1, ,m,3,,number,q,", "quantity", "' '"),
    ],
)
def test_a_bad_cell_is_named_by_file_line_and_column(tmp_path, line, column, found):
    path = write(tmp_path, [*GOOD[:2], line])
    with pytest.raises(InputError) as caught:
        read_published(path)
    assert (caught.value.file, caught.value.field) == (path, f"line 4, column {column}")
    assert str(caught.value).startswith(f"{path}: line 4, column {column}: found {found}, expected ")
    assert "\n" not in str(caught.value)


def test_the_line_number_counts_a_quoted_line_break(tmp_path):
    path = write(tmp_path, ['C1,Table 1,RMSE,m,3,,number,"two\nlines",', "C1,Table 1,RMSE,m,x,,number,q,"])
    with pytest.raises(InputError, match="line 4, column value"):
        read_published(path)


@pytest.mark.parametrize("line, cells", [("C1,Table 1,RMSE", 3), ("C1,Table 1,RMSE,m,3,,number,q,,extra", 10), ("", 0)])
def test_a_row_with_too_few_or_too_many_cells_is_refused(tmp_path, line, cells):
    with pytest.raises(InputError, match=f"line 3: found {cells} cells, expected 9 cells"):
        read_published(write(tmp_path, [GOOD[0], line]))


@pytest.mark.parametrize("header", [HEADER.replace("unit", "units"), HEADER + ",more", HEADER.replace(",note", "")])
def test_other_columns_are_refused(tmp_path, header):
    with pytest.raises(InputError, match="line 1: found .* expected claim_id,location"):
        read_published(write(tmp_path, GOOD, header))


def test_a_missing_file_an_empty_one_and_a_header_alone_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_published(tmp_path / "absent.csv")
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(InputError, match="an empty file"):
        read_published(tmp_path / "empty.csv")
    with pytest.raises(InputError, match="no row below the header"):
        read_published(write(tmp_path, []))


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", HEADER.encode() + b'\nC1,"torn'])
def test_an_unreadable_file_is_refused(tmp_path, content):
    (tmp_path / "bad.csv").write_bytes(content)
    with pytest.raises(InputError, match="bad.csv: found an unreadable file"):
        read_published(tmp_path / "bad.csv")
    with pytest.raises(InputError, match="found an unreadable file"):
        read_published(tmp_path)  # a folder


@pytest.mark.parametrize("path", TRACKED, ids=lambda path: path.stem)
def test_the_repository_s_own_tables_are_valid(path):
    assert claim_ids(read_published(path))
