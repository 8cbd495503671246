"""The register is complete: every equation has its LaTeX, its line of code and its test; every assumption its consequence."""

import re
from types import SimpleNamespace

import pytest
from latex2mathml.converter import convert

from robins.papers.hajiyev2023.register import ASSUMPTIONS, EQUATIONS
from robins.publish.equations import incomplete, library_sources, markers

KEY = "hajiyev2023"
STATUSES = {"ok", "ambiguous", "wrong"}


def test_all_numbered_equations_are_there_in_order():
    assert [equation.number for equation in EQUATIONS] == [str(number) for number in range(1, 30)]


@pytest.mark.parametrize("equation", EQUATIONS, ids=lambda equation: equation.number)
def test_an_equation_is_complete(equation):
    assert equation.status in STATUSES
    assert equation.title and equation.printed
    assert equation.corrected or equation.status != "wrong"
    assert equation.note or equation.status == "ok"
    for latex in (equation.printed, equation.corrected, *re.findall(r"\$([^$]+)\$", equation.note)):
        if latex:
            assert convert(latex).startswith("<math")
            assert latex.count("{") == latex.count("}")


def test_every_equation_has_a_line_of_code_and_a_test_that_exists(repository):
    assert incomplete(SimpleNamespace(key=KEY, equations=EQUATIONS), repository) == []


def test_the_printed_filter_is_marked_letter_by_letter():
    places = markers(library_sources())
    for number in (*range(12, 25), 13):
        assert any("as_printed.py" in place for place in places[KEY, str(number)]), number


def test_assumptions_are_those_of_the_brief_its_corrections_and_the_disclosures():
    names = [entry.name for entry in ASSUMPTIONS]
    expected = [f"E{i}" for i in range(1, 4)] + [f"A{i}" for i in range(1, 20)]
    expected += [f"B{i}" for i in range(1, 6)] + [f"D{i}" for i in range(1, 8)]
    assert names == expected


@pytest.mark.parametrize("entry", ASSUMPTIONS, ids=lambda entry: entry.name)
def test_an_assumption_says_what_follows_from_it(entry):
    assert entry.kind in {"erratum", "ambiguity", "assumption", "correction", "disclosure", "substitute"}
    assert entry.statement.endswith(".") and entry.consequence.endswith(".")
    for text in (entry.statement, entry.consequence):
        assert text.count("$") % 2 == 0
        for latex in re.findall(r"\$([^$]+)\$", text):
            assert convert(latex).startswith("<math")


@pytest.mark.parametrize("number", ["12", "13", "14", "15", "16", "18", "20", "21", "24"])
def test_a_corrected_form_says_that_it_rests_on_white_xi(number):
    equation = next(equation for equation in EQUATIONS if equation.number == number)
    assert "exact for $Q_v=0$" in equation.note
    assert "P(k/k)" not in equation.corrected and "P(k/k-1)" not in equation.corrected, "one notation: P(k) is given z(0..k)"


def test_the_substitute_is_called_one():
    substitute = next(entry for entry in ASSUMPTIONS if entry.kind == "substitute")
    assert "BRAVO" in substitute.statement and "F-4C" in substitute.statement
