"""The report is one page that needs nothing else."""

import dataclasses
import re
import shutil
from html.parser import HTMLParser

import pytest

from robins.foundation.errors import InputError
from robins.publish import manifest, report

KEY = "nobody1999"
VOID = {"meta", "link", "img", "br", "hr", "input", "source"}


class Page(HTMLParser):
    """Elements in order, ids, and whether every tag is closed where it should be."""

    def __init__(self, text: str):
        super().__init__()
        self.open, self.elements, self.problems = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.problems.append(f"</{tag}> at {self.getpos()}")


@pytest.fixture(scope="module")
def text(reference, paper) -> str:
    return report.render({KEY: paper}, reference, "standard")


@pytest.fixture(scope="module")
def page(text) -> Page:
    return Page(text)


def test_every_tag_is_closed_and_every_id_is_unique(page):
    assert page.problems == [] and page.open == []
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids))


def test_nothing_is_loaded_from_anywhere(page, text):
    for tag, attributes in page.elements:
        for name in ("src", "href"):
            if name in attributes:
                assert attributes[name].startswith(("#", "data:")), (tag, attributes[name])
        assert tag not in ("script", "link", "iframe")
    style = re.search(r"<style>(.*?)</style>", text, flags=re.DOTALL).group(1)
    assert "url(" not in style and "@import" not in style


def test_every_link_leads_to_a_place_on_the_page(page):
    ids = {attributes["id"] for _, attributes in page.elements if "id" in attributes}
    links = {attributes["href"][1:] for tag, attributes in page.elements if tag == "a"}
    assert links <= ids


def test_the_order_is_verdicts_then_the_paper_then_provenance(text):
    places = [f'id="{name}"' for name in ("verdicts", KEY, f"{KEY}-claims", f"{KEY}-tables", f"{KEY}-figures")]
    places += [f'id="{name}"' for name in (f"{KEY}-equations", f"{KEY}-assumptions", "provenance", "rerun")]
    positions = [text.index(place) for place in places]
    assert positions == sorted(positions)


def test_claims_tables_figures_equations_and_assumptions_are_all_there(page, paper, text):
    ids = {attributes["id"] for _, attributes in page.elements if "id" in attributes}
    assert {f"{KEY}-{claim.claim_id}" for claim in paper.claims} <= ids
    assert {f"{KEY}-{item.name}" for item in (*paper.tables, *paper.figures, *paper.assumptions)} <= ids
    assert {f"{KEY}-eq-{equation.number}" for equation in paper.equations} <= ids
    assert text.count("<math ") >= 3 + 4
    assert "tests/test_it.py::test_differencing" in text


def test_figures_have_words_for_those_who_do_not_see_them(page):
    assert all(attributes.get("alt") for tag, attributes in page.elements if tag == "img")


def test_what_the_paper_says_is_escaped(text):
    assert "&lt;was&gt;" in text and "<was>" not in text


def test_two_renderings_are_the_same(text, reference, paper):
    assert report.render({KEY: paper}, reference, "standard") == text


def test_another_ensemble_says_so_at_the_top(reference, paper, text):
    assert "<code>smoke</code> ensemble" in report.render({KEY: paper}, reference, "smoke")
    assert "ensemble.</strong>" not in text


def test_a_field_folder_becomes_a_section(reference, paper, tmp_path, text):
    assert 'id="field"' not in text
    folder = shutil.copytree(reference, tmp_path / "results")
    (folder / "field" / "gyro").mkdir(parents=True)
    shutil.copyfile(reference / KEY / "tables" / "table-1.csv", folder / "field" / "gyro" / "noise.csv")
    shutil.copyfile(reference / KEY / "figures" / "figure-01.png", folder / "field" / "gyro" / "noise.png")
    entries = {f"gyro/noise{suffix}": manifest.entry("field", None, "a" * 64) for suffix in (".csv", ".png")}
    recording = {"source": "https://example.org/recording"}
    manifest.write_record(folder / "field" / "manifest.json", {"recording": recording, "artefacts": entries})
    with_field = report.render({KEY: paper}, folder, "standard")
    assert 'id="field-gyro-noise"' in with_field and 'id="field-figure-gyro-noise"' in with_field
    assert '<dd class="long">https://example.org/recording</dd>' in with_field
    assert Page(with_field).problems == []


def test_a_claim_without_an_overall_row_is_refused(reference, paper):
    more = dataclasses.replace(paper, claims=(*paper.claims, dataclasses.replace(paper.claims[0], claim_id="C3")))
    with pytest.raises(InputError, match="C3"):
        report.render({KEY: more}, reference, "standard")


@pytest.mark.parametrize("latex", [r"\frac{1", r"\frac", r"\left( x", r"\unknown{x}", r"a &= b", r"x^a^b"])
def test_a_formula_that_cannot_be_set_is_named(latex):
    with pytest.raises(InputError) as caught:
        report.math(latex)
    assert latex in str(caught.value)


def test_escaped_braces_are_no_open_braces():
    assert "<math " in report.math(r"\{x\}") and "<math " in report.math(r"\left\{ x \right.")


def test_prose_sets_formulas_and_code_and_escapes_the_rest():
    text = report.prose("a < b, $x^2$ and `y < 1`")
    assert text.startswith("a &lt; b, <math ")
    assert text.endswith("<code>y &lt; 1</code>")


@pytest.mark.parametrize(
    ("cell", "shown"),
    [("0.6123456", "0.6123"), ("0.54", "0.54"), ("1000", "1000"), ("12345", "1.234e+04"), ("not white", "not white"), ("", "")],
)
def test_long_numbers_are_rounded_and_short_ones_left_as_printed(cell, shown):
    assert report.number(cell) == shown


def test_the_fingerprint_changes_with_the_words_of_the_wing(paper):
    other = dataclasses.replace(paper, summary="Something else.")
    assert report.fingerprint({KEY: paper}) != report.fingerprint({KEY: other})
    assert report.fingerprint({KEY: paper}) == report.fingerprint({KEY: dataclasses.replace(paper)})
