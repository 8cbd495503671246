"""The register is complete: every equation has its LaTeX and its test's name, every entry its consequence, and no name dangles."""

import re

import numpy as np
import pytest
from latex2mathml.converter import convert
from scipy.stats import chi2

from robins.foundation.earth import EARTH_RATE
from robins.papers.ghouneem2024.register import ASSUMPTIONS, EQUATIONS

NUMBERS = list(map(str, range(1, 32)))
LETTERS = {
    "erratum": "E",
    "ambiguity": "A",
    "assumption": "A",
    "verified": "V",
    "decision": "D",
    "disclosure": "D",
    "substitute": "D",
    "proposition": "Prop",
    "correction": "B",
}
BY_NAME = {entry.name: entry for entry in ASSUMPTIONS}
BY_NUMBER = {equation.number: equation for equation in EQUATIONS}
REFERENCE = re.compile(r"\b((?:Prop|[EAVDB])\d+)\b")
CITED = re.compile(r"\((\d{1,2})\)")
PRODUCTS = {"D02", "D04"}  # of the inertial sensor's maker


def prose(entry) -> str:
    return " ".join((entry.statement, entry.consequence)) if hasattr(entry, "statement") else entry.note


def name_of(entry) -> str:
    return getattr(entry, "number", "") or entry.name


def test_all_numbered_equations_are_there_in_order():
    assert [equation.number for equation in EQUATIONS] == NUMBERS


@pytest.mark.parametrize("equation", EQUATIONS, ids=name_of)
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
            assert len(re.findall(r"\\begin", latex)) == len(re.findall(r"\\end", latex))


@pytest.mark.parametrize("entry", [*EQUATIONS, *ASSUMPTIONS], ids=name_of)
def test_prose_has_balanced_formulas_that_convert(entry):
    text = prose(entry)
    assert text.count("$") % 2 == 0 and text.count("`") % 2 == 0
    assert not re.search(r"[a-z]  |\.\.|[a-z]\$[a-z]", text), "two pieces of a string that do not fit"
    assert not re.search(r"[\x00-\x1f]", text), "a backslash that was taken for an escape"
    for latex in re.findall(r"\$([^$]+)\$", text):
        assert convert(latex).startswith("<math")


@pytest.mark.parametrize("entry", [*EQUATIONS, *ASSUMPTIONS], ids=name_of)
def test_what_prose_refers_to_exists(entry):
    text = re.sub(r"\$[^$]*\$", "", prose(entry))
    assert set(REFERENCE.findall(text)) - PRODUCTS <= set(BY_NAME)
    assert set(CITED.findall(text)) <= set(NUMBERS)


@pytest.mark.parametrize("entry", ASSUMPTIONS, ids=name_of)
def test_an_entry_says_what_follows_from_it(entry):
    assert entry.kind in LETTERS and entry.name.rstrip("0123456789") == LETTERS[entry.kind]
    assert entry.statement.endswith(".") and entry.consequence.endswith(".")


def test_names_are_unique_and_counted_without_a_gap():
    assert len(BY_NAME) == len(ASSUMPTIONS)
    for prefix in set(LETTERS.values()):
        counted = [entry.name for entry in ASSUMPTIONS if entry.name.rstrip("0123456789") == prefix]
        assert counted == [f"{prefix}{i}" for i in range(1, len(counted) + 1)]


def test_no_name_is_that_of_a_claim_which_has_an_anchor_in_the_report_too():
    assert not [name for name in BY_NAME if re.fullmatch(r"[CS]\d+[a-z]?", name)]


def test_every_erratum_is_told_at_an_equation_or_is_about_words_and_tables():
    told = {name for equation in EQUATIONS for name in REFERENCE.findall(equation.note)}
    assert {name for name in BY_NAME if name.startswith("E")} - told == {"E17", "E18", "E19"}


def test_sensors_whose_noise_nobody_printed_are_labelled():
    assert all(BY_NAME[name].statement.startswith("[assumed]") for name in ("A16", "A17", "A18", "A19"))


def test_the_numbers_of_the_register_are_those_that_its_formulas_give():
    quoted = {
        "E3": ("21.0 deg/h", 2 * np.rad2deg(EARTH_RATE) * 3600 * np.sin(np.deg2rad(44.23))),
        "A16": ("0.46 deg", np.rad2deg(0.008)),
        "A20": ("22.46", chi2.ppf(0.999, 6)),
        "D7": ("100 km", 1e5 / 1e3),
        "Prop1": ("103.92", 180 / np.sqrt(3)),
        "Prop3": ("7.8 m", 12.4**2 / 2 / 9.8055),
        "Prop6": ("25 km", np.sqrt(100 / 6.37e6) * 6.37e6 / 1e3),
        "B1": ("0.1 deg", np.rad2deg(0.06 * 0.028)),
        "B3": ("0.1 %", 100 * 0.05 / 60),
    }
    for name, (words, value) in quoted.items():
        digits = re.match(r"[\d.]+", words).group()
        assert words in prose(BY_NAME[name]) and round(value, len(digits.partition(".")[2])) == float(digits), name
    assert "11.5 m" in prose(BY_NAME["Prop3"]) and round(15**2 / 2 / 9.8055, 1) == 11.5
    assert "15.04 deg/h" in prose(BY_NAME["E3"]) and round(np.rad2deg(EARTH_RATE) * 3600, 2) == 15.04


def test_the_shares_of_proposition_two_follow_from_the_published_levels():
    shares = [100 * (level / 360) ** 2 for level in (103.3814, 45.8807)]
    assert [f"{share:.2f} %" for share in shares] == re.findall(r"\d\.\d\d %", BY_NAME["Prop2"].consequence)


def test_the_uniform_heading_has_the_rmse_of_proposition_one():
    assert np.sqrt(np.mean(np.linspace(-180, 180, 100_001) ** 2)) == pytest.approx(180 / np.sqrt(3), rel=1e-4)


def test_the_thresholds_of_proposition_seven_are_the_multiples_of_the_ones_chosen():
    prediction, jump = map(float, re.findall(r"(\d+), \d+, \d+ m (?:and|from)", BY_NAME["A6"].consequence))
    assert max(4 * prediction, 4 * jump) < 200 < min(8 * prediction, 8 * jump)
    assert f"({4 * jump:.0f} m)" in BY_NAME["Prop7"].consequence
    assert f"({8 * prediction:.0f} and {8 * jump:.0f} m)" in BY_NAME["Prop7"].consequence


def test_the_weights_that_eighteen_is_said_to_have_follow_from_it():
    n, beta = 9, 2.0
    for alpha, mean, printed, total in ((0.1, -99.0, -296.0, -96.0), (1.0, 0.0, 0.0, 2.0)):
        central = (alpha**2 * n - n) / (alpha**2 * n)
        found = central, central * (1 - alpha**2 + beta), central + 1 - alpha**2 + beta
        np.testing.assert_allclose(found, (mean, printed, total), atol=0.05)
        said = BY_NUMBER["17"].note + BY_NUMBER["18"].note
        assert all(re.search(rf"(?<![\d.-]){value:g}(?:\.0)?\b", said) for value in (mean, printed, total))


def test_a_turn_outweighs_the_term_that_three_prints():
    assert "6 m/s and 40 deg/s" in BY_NUMBER["3"].note
    assert 6 * np.deg2rad(40) > 2 * 1.9, "V times the rate of turn against the hardest braking of the drives"
