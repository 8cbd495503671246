"""The claim ledger: what is filled in, what is refused, and the file."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.ledger import COLUMNS, Row, build_ledger, cell, finite_or_failed, read_ledger, validate_ledger, write_ledger
from robins.evaluate.published import COLUMNS as PUBLISHED_COLUMNS
from robins.foundation.errors import InputError

PUBLISHED = pd.DataFrame(
    [
        ["C1;C2", "Table 1", "RMSE u", "m/s", "0.0360", "", "number", "", ""],
        ["C1", "abstract", "reduction", "%", "37", "99", "range", "", ""],
        ["C2", "sec 5", "better", "", "", "", "qualitative", "", ""],
        ["C2", "sec 6", "better", "", "", "", "qualitative", "", ""],
        ["setup", "sec 2", "divisor", "1", "70", "", "number", "", ""],
    ],
    columns=list(PUBLISHED_COLUMNS),
    dtype=str,
)
LEVEL = Row("C1", "RMSE u", "deg fault", 0.03, 0.02, 0.04, 1000, "amdkf-printed", "replicated", "Inside the interval.")
FIRST = replace(LEVEL, condition="overall", reason="The same verdict throughout.")
SECOND = Row("C2", "better", "overall", "4 of 8 states", "", "", 1000, "all", "depends on assumption", "The branches differ.")
ROWS = [LEVEL, FIRST, SECOND]


def build(*rows):
    return build_ledger("paper2023", rows, PUBLISHED)


def test_columns_order_and_types():
    ledger = build(*ROWS)
    assert tuple(ledger.columns) == COLUMNS
    assert ledger["condition"].tolist() == ["deg fault", "overall", "overall"]
    assert ledger["n"].dtype == np.int64
    assert all(isinstance(value, str) for name in COLUMNS if name != "n" for value in ledger[name])


def test_published_cells_stay_as_printed_and_ours_have_ten_digits():
    ledger = build(replace(LEVEL, ours=1 / 3), *ROWS[1:])
    first = ledger.iloc[0]
    assert (first["published"], first["published_high"], first["unit"], first["location"]) == ("0.0360", "", "m/s", "Table 1")
    assert first["ours"] == "0.3333333333"


def test_a_published_range_has_both_ends():
    row = build(replace(LEVEL, quantity="reduction"), *ROWS[1:]).iloc[0]
    assert (row["published"], row["published_high"], row["location"]) == ("37", "99", "abstract")


def test_what_the_rule_says_itself_is_kept():
    row = build(replace(LEVEL, published=0.54, unit="1", location="Table 1, derived"), *ROWS[1:]).iloc[0]
    assert (row["published"], row["unit"], row["location"]) == ("0.54", "1", "Table 1, derived")
    row = build(replace(LEVEL, quantity="reduction", published=40.0), *ROWS[1:]).iloc[0]
    assert (row["published"], row["published_high"]) == ("40", "")


def test_a_quantity_that_the_paper_does_not_print_has_the_claim_s_places_only():
    row = build(replace(LEVEL, quantity="NIS"), *ROWS[1:]).iloc[0]
    assert (row["published"], row["unit"], row["location"]) == ("", "", "Table 1; abstract")


def test_the_location_chooses_among_rows_of_one_quantity():
    ledger = build(*ROWS[:2], replace(SECOND, location="sec 6"))
    assert ledger["location"].iloc[2] == "sec 6"
    assert build(*ROWS)["location"].iloc[2] == "sec 5"


def test_cells_know_no_minus_zero_and_failed_is_a_word():
    assert cell(-0.0) == "0" and cell(1e-12) == "1e-12" and cell("failed") == "failed"
    assert finite_or_failed(np.nan) == finite_or_failed(np.inf) == "failed" and finite_or_failed(2.0) == 2.0


def test_a_claim_outside_the_published_table_is_welcome_and_needs_its_overall_row():
    extra = replace(SECOND, claim_id="C14", verdict="untestable")
    assert len(build(*ROWS, extra)) == 4
    with pytest.raises(InputError, match="paper2023 / C14: found 0 overall rows"):
        build(*ROWS, replace(extra, condition="deg"))


def test_analytic_answers_need_no_runs():
    for verdict in ("refuted", "untestable"):
        ledger = build(*ROWS[:2], replace(SECOND, ours=-0.5, n=0, verdict=verdict))
        assert verdict in set(ledger["verdict"])
    ledger = build(*ROWS[:2], replace(SECOND, ours="13.14 as printed", n=0, verdict="replicated"))
    assert "13.14 as printed" in set(ledger["ours"])


def test_a_numeric_estimate_that_is_inconclusive_may_stand_without_an_interval():
    ledger = build(*ROWS[:2], replace(SECOND, ours=1.0, verdict="inconclusive"))
    assert "inconclusive" in set(ledger["verdict"])


BROKEN = {
    "missing claim": ([LEVEL, FIRST], "paper2023 / C2: found no row"),
    "missing overall": ([LEVEL, SECOND], "paper2023 / C1: found 0 overall rows, expected exactly one"),
    "two overall rows": ([*ROWS, replace(FIRST, quantity="reduction")], "paper2023 / C1: found 2 overall rows"),
    "duplicate key": ([*ROWS, LEVEL], "paper2023 / C1 / RMSE u / amdkf-printed / deg fault: found the key twice"),
    "joined id": ([*ROWS, replace(LEVEL, claim_id="C1;C2", condition="rad")], "claim_id: found 'C1;C2', expected one id"),
}
BROKEN_CELLS = {
    "unknown verdict": ({"verdict": "partly"}, "verdict: found 'partly', expected one of replicated"),
    "nan estimate": ({"ours": np.nan}, "ours: found 'nan'"),
    "nan as text": ({"ours": "NaN"}, "ours: found 'NaN'"),
    "infinite end": ({"ci_high": np.inf}, "ci_high: found 'inf'"),
    "empty reason": ({"reason": " "}, "reason: found ' ', expected a text"),
    "empty quantity": ({"quantity": ""}, "quantity: found ''"),
    "no interval": ({"ci_low": "", "ci_high": ""}, "ci_low: found '', expected an interval, since the verdict is replicated"),
    "no interval, refuted direction": ({"ci_low": "", "ci_high": "", "verdict": "not replicated"}, "ci_low: found ''"),
    "no interval, direction only": ({"ci_low": "", "ci_high": "", "verdict": "direction only"}, "ci_low: found ''"),
    "no runs": ({"n": 0}, "n: found 0, expected the number of runs"),
    "negative n": ({"n": -1}, "n: found -1"),
    "half an interval": ({"ci_high": ""}, "ci_high: found '', expected both ends"),
    "the other half": ({"ci_low": ""}, "ci_low: found '', expected both ends"),
    "interval upside down": ({"ci_low": 5.0}, "ci_low: found '5', expected at most the upper end 0.04"),
    "text in a number column": ({"ci_low": "small", "ci_high": "large"}, "ci_low: found 'small'"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_ledger_that_breaks_a_rule_is_refused_by_its_key(case):
    rows, message = BROKEN[case]
    with pytest.raises(InputError) as caught:
        build(*rows)
    assert message in str(caught.value) and str(caught.value).startswith("claim ledger of paper2023: ")


@pytest.mark.parametrize("case", BROKEN_CELLS)
def test_a_row_that_breaks_a_rule_is_refused_by_its_key_and_column(case):
    change, message = BROKEN_CELLS[case]
    with pytest.raises(InputError) as caught:
        build(replace(LEVEL, **change), FIRST, SECOND)
    assert message in str(caught.value)
    assert " / amdkf-printed / deg fault: " in str(caught.value)


def test_a_true_nan_and_a_missing_column_are_refused():
    ledger = build(*ROWS)
    with pytest.raises(InputError, match="published_high: found nan"):
        validate_ledger(ledger.assign(published_high=np.nan), {}, "ledger")
    with pytest.raises(InputError, match="columns: found paper"):
        validate_ledger(ledger.drop(columns="unit"), {}, "ledger")


def test_an_empty_ledger_misses_its_claims():
    with pytest.raises(InputError, match="paper2023 / C1: found no row"):
        build()


def test_the_file_is_read_back_as_it_was(tmp_path):
    ledger = build(*ROWS)
    path = tmp_path / "results" / "claims.csv"
    write_ledger(ledger, path)
    content = path.read_bytes()
    assert b"\r" not in content and content.startswith(b"paper,claim_id,location,") and b"0.0360" in content
    pd.testing.assert_frame_equal(read_ledger(path, {"paper2023": ["C1", "C2"]}), ledger)


def test_reading_asks_for_the_claims_of_every_paper(tmp_path):
    path = tmp_path / "claims.csv"
    write_ledger(build(*ROWS), path)
    with pytest.raises(InputError, match="other2024 / C1: found no row"):
        read_ledger(path, {"paper2023": ["C1", "C2"], "other2024": ["C1"]})


@pytest.mark.parametrize("old, new, message", [(",1000,", ",many,", "row 2, column n: found 'many'"), (",1000,", ",,", "found ''")])
def test_a_count_that_is_no_number_is_named_by_its_row(tmp_path, old, new, message):
    path = tmp_path / "claims.csv"
    write_ledger(build(*ROWS), path)
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_ledger(path, {})


def test_a_missing_an_empty_and_a_torn_file_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_ledger(tmp_path / "absent.csv", {})
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(InputError, match="unreadable"):
        read_ledger(tmp_path / "empty.csv", {})
    write_ledger(build(*ROWS), tmp_path / "torn.csv")
    content = (tmp_path / "torn.csv").read_text()
    (tmp_path / "torn.csv").write_text(content[: content.rindex(",")])
    with pytest.raises(InputError):
        read_ledger(tmp_path / "torn.csv", {})
