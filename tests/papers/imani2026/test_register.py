"""The register is complete: every equation has its LaTeX and its test's name, every entry its consequence, and no name dangles."""

import re

import numpy as np
import pytest
from latex2mathml.converter import convert

from robins.papers.imani2026.register import ASSUMPTIONS, EQUATIONS

NUMBERS = [*map(str, range(1, 36)), "35a", *map(str, range(36, 47))]
LETTERS = {
    "erratum": "E",
    "ambiguity": "A",
    "assumption": "S",
    "disclosure": "D",
    "substitute": "D",
    "proposition": "Prop",
    "correction": "B",
}
BY_NAME = {entry.name: entry for entry in ASSUMPTIONS}
REFERENCE = re.compile(r"\b((?:Prop|[EASDB])\d+)\b")
CITED = re.compile(r"\((\d{1,2}a?)\)")


def prose(entry) -> str:
    return " ".join((entry.statement, entry.consequence)) if hasattr(entry, "statement") else entry.note


def test_all_numbered_equations_are_there_in_order_and_the_display_without_a_number():
    assert [equation.number for equation in EQUATIONS] == NUMBERS


@pytest.mark.parametrize("equation", EQUATIONS, ids=lambda equation: equation.number)
def test_an_equation_is_complete(equation):
    assert equation.status in {"ok", "ambiguous", "wrong"}
    assert equation.title and equation.printed
    assert equation.corrected or equation.status != "wrong"
    assert equation.note or equation.status == "ok"
    assert re.fullmatch(r"tests/[a-z0-9_/]+\.py::test_[a-z0-9_]+", equation.test)
    for latex in (equation.printed, equation.corrected):
        if latex:
            assert convert(latex).startswith("<math")
            assert latex.count("{") == latex.count("}")


@pytest.mark.parametrize("entry", [*EQUATIONS, *ASSUMPTIONS], ids=lambda entry: getattr(entry, "number", "") or entry.name)
def test_prose_has_balanced_formulas_that_convert(entry):
    text = prose(entry)
    assert text.count("$") % 2 == 0 and text.count("`") % 2 == 0
    assert not re.search(r"[a-z]  |\.\.|[a-z]\$[a-z]", text), "two pieces of a string that do not fit"
    for latex in re.findall(r"\$([^$]+)\$", text):
        assert convert(latex).startswith("<math")


@pytest.mark.parametrize("entry", [*EQUATIONS, *ASSUMPTIONS], ids=lambda entry: getattr(entry, "number", "") or entry.name)
def test_what_prose_refers_to_exists(entry):
    text = re.sub(r"\$[^$]*\$", "", prose(entry))
    assert set(REFERENCE.findall(text)) <= set(BY_NAME)
    assert set(CITED.findall(text)) <= set(NUMBERS)


@pytest.mark.parametrize("entry", ASSUMPTIONS, ids=lambda entry: entry.name)
def test_an_entry_says_what_follows_from_it(entry):
    assert entry.kind in LETTERS and entry.name.rstrip("0123456789") == LETTERS[entry.kind]
    assert entry.statement.endswith(".") and entry.consequence.endswith(".")


def test_names_are_unique_and_counted_without_a_gap():
    assert len(BY_NAME) == len(ASSUMPTIONS)
    for prefix in set(LETTERS.values()):
        counted = [entry.name for entry in ASSUMPTIONS if entry.name.rstrip("0123456789") == prefix]
        assert counted == [f"{prefix}{i}" for i in range(1, len(counted) + 1)]


def test_no_name_is_that_of_a_claim_which_has_an_anchor_in_the_report_too():
    assert not [name for name in BY_NAME if re.fullmatch(r"C\d+", name)]


def test_the_ten_propositions_are_there():
    assert [name for name in BY_NAME if name.startswith("Prop")] == [f"Prop{i}" for i in range(1, 11)]


def test_what_the_text_has_lost_is_ambiguous_and_not_called_wrong():
    status = {equation.number: equation.status for equation in EQUATIONS}
    assert {status[number] for number in ("7", "35", "36", "44", "46")} == {"ambiguous"}
    assert {status[number] for number in ("5", "14", "17", "21", "30", "35a", "40", "42", "43")} == {"wrong"}


def test_the_numbers_of_the_register_are_those_that_its_formulas_give():
    quoted = {"E1": ("1.4 deg", np.rad2deg(7.3e-5 * 330)), "E4": ("5.7", 1e-4 * np.sqrt(3300) * 1e3),
              "E3": ("2.4 m", 2 * 0.3 * 4), "E8": ("73", (0.3 / 1.5**2 + 0.4 / 3**2 + 0.3 / 8**2) / 0.05**2),
              "Prop2": ("3.2 m/s", 9.8e-3 * 330), "Prop8": ("71", np.rad2deg(np.deg2rad(0.1) * np.sqrt(2) / 0.2 / 0.01)),
              "Prop9": ("6.3 %", 200 / np.pi * np.arctan(0.1))}  # fmt: skip
    for name, (words, value) in quoted.items():
        digits = re.match(r"[\d.]+", words).group()
        assert words in prose(BY_NAME[name]) and round(value, len(digits.partition(".")[2])) == float(digits), name
    assert "79 %" in prose(BY_NAME["Prop9"]) and round(100 * (1 - (1 - 2 / np.pi * np.arctan(0.1)) ** 24)) == 79


def test_the_gains_of_proposition_five_follow_from_its_formula():
    ratio, rho = 17.6, 64 / 3.841
    gains = [ratio / (ratio + factor) for factor in (1.0, rho, 1 + (rho - 1) * (1 + ratio))]
    assert [f"{gain:.3f}" for gain in gains] == re.findall(r"0\.\d{3}", BY_NAME["Prop5"].consequence)
