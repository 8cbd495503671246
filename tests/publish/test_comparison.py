"""Two cells agree when they say the same, and a cell that is no plain number is none."""

from types import SimpleNamespace

import pandas as pd
import pytest

from robins.publish.comparison import Comparison, compare_frames


def differences(kind: str, found: str, expected: str) -> list[str]:
    """What differs between two tables with one cell each."""
    column = SimpleNamespace(name="cell", kind=kind, relative=1e-6, absolute=0.0)
    outcome = Comparison()
    frames = [pd.DataFrame({"cell": [cell]}, dtype=str) for cell in (found, expected)]
    compare_frames("t", SimpleNamespace(columns=(column,)), *frames, outcome)
    return outcome.differences


@pytest.mark.parametrize(
    ("found", "expected"), [("1e-12", "1e-3"), ("0.0123", "0.1"), ("0.9", "1.0"), ("7", "8"), ("-0.5001", "0.5001"), ("0", "0.0001")]
)
def test_numerals_in_prose_that_say_something_else_differ(found, expected):
    assert differences("prose", f"p {found}.", f"p {expected}.")
    assert differences("prose", f"p {expected}.", f"p {found}.")


@pytest.mark.parametrize(("found", "expected"), [("1.017", "1.018"), ("0.6", "0.6000"), ("0.98765", "0.98766"), ("1.2345e-7", "1.2346e-7")])
def test_numerals_in_prose_may_be_rounded_another_way(found, expected):
    assert differences("prose", f"p {found}.", f"p {expected}.") == []


@pytest.mark.parametrize("cell", [" 1", "1 ", "1_0", "\u0661", "\uff11", "0x1", "1e999", "nan", "+inf", "1,0"])
def test_what_is_no_plain_number_is_refused_on_both_sides(cell):
    assert any("a finite number" in line for line in differences("number", cell, cell))
    assert any("a whole number" in line for line in differences("count", cell, cell))
    if cell not in ("0x1", "1,0"):  # which are words
        assert any("a finite number, words" in line for line in differences("optional", cell, cell))


@pytest.mark.parametrize("cell", ["1", "-0.5", "1e-05", "2.5E+10", "1."])
def test_plain_numbers_are_compared_as_numbers(cell):
    assert differences("number", cell, f"{float(cell):.17g}") == []


def test_whole_numbers_are_exact_where_they_are_measured_and_printed_ones_always():
    assert differences("measured", "10000001", "10000000") and not differences("optional", "10000001", "10000000")
    assert differences("measured", "0.10000000001", "0.1") == []
    assert differences("printed", "0.10000000001", "0.1") and differences("printed", "0.10", "0.1")
