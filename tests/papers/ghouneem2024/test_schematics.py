"""Figures 1 and 2: readable at the width of a column, nothing over anything else, and the truth is marked where it is used."""

import xml.etree.ElementTree as ElementTree
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.patches import FancyBboxPatch

from robins.papers.ghouneem2024 import palette, schematics
from robins.publish import style

DRAWINGS = {"baseline": schematics.draw_baseline, "new-method": schematics.draw_new_method}


@pytest.fixture(scope="module")
def drawings():
    """The two figures, drawn once."""
    drawn = {}
    for name, draw in DRAWINGS.items():
        with style.use():
            drawn[name] = draw(None)
            FigureCanvasAgg(drawn[name]).draw()
    return drawn


def seen(figure):
    return [text for text in figure.axes[0].texts if text.get_text().strip()]


def blocks(figure):
    return [patch for patch in figure.axes[0].patches if isinstance(patch, FancyBboxPatch)]


def shrunk(box, by=1.0):
    """A box without its outermost pixel: neighbours may touch."""
    return box.padded(-by)


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_drawing_is_a_column_wide_in_letters_that_can_be_read(name, drawings):
    assert drawings[name].get_figwidth() * 25.4 == pytest.approx(85)
    assert min(text.get_fontsize() for text in seen(drawings[name])) >= 7


@pytest.mark.parametrize("name", DRAWINGS)
def test_nothing_leaves_the_drawing(name, drawings):
    figure = drawings[name]
    for artist in [*seen(figure), *figure.axes[0].patches, *figure.axes[0].lines]:
        box = artist.get_window_extent()
        assert box.x0 >= 0 and box.y0 >= 0 and box.x1 <= figure.bbox.width and box.y1 <= figure.bbox.height, artist


@pytest.mark.parametrize("name", DRAWINGS)
def test_no_text_lies_over_another(name, drawings):
    boxes = [(text.get_text(), shrunk(text.get_window_extent())) for text in seen(drawings[name])]
    assert [(a, b) for (a, one), (b, other) in combinations(boxes, 2) if one.overlaps(other)] == []


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_text_is_inside_a_box_or_outside_of_it(name, drawings):
    for text in seen(drawings[name]):
        box = shrunk(text.get_window_extent())
        for block in (patch.get_window_extent() for patch in blocks(drawings[name])):
            inside = block.x0 <= box.x0 and box.x1 <= block.x1 and block.y0 <= box.y0 and box.y1 <= block.y1
            assert inside or not block.overlaps(box), text.get_text()


@pytest.mark.parametrize("name", DRAWINGS)
def test_no_two_boxes_overlap(name, drawings):
    extents = [patch.get_window_extent() for patch in blocks(drawings[name])]
    assert not any(one.overlaps(other) for one, other in combinations(extents, 2))


@pytest.mark.parametrize("name", DRAWINGS)
def test_no_line_crosses_a_text(name, drawings):
    figure = drawings[name]
    for text in seen(figure):
        box = shrunk(text.get_window_extent())
        for line in figure.axes[0].lines:
            places = figure.axes[0].transData.transform(line.get_xydata())
            dense = np.concatenate([np.linspace(a, b, 60) for a, b in zip(places[:-1], places[1:], strict=True)])
            assert not any(box.contains(x, y) for x, y in dense), text.get_text()
        for arrow in (child for child in figure.axes[0].texts if getattr(child, "arrow_patch", None)):
            ends = figure.axes[0].transData.transform([arrow.xyann, arrow.xy])
            assert not any(box.contains(x, y) for x, y in np.linspace(*ends, 60)), text.get_text()


def test_what_is_made_with_the_truth_is_white_on_black_and_nothing_else_is(drawings):
    dark = [patch for patch in blocks(drawings["new-method"]) if to_hex(patch.get_facecolor()) == style.BLACK]
    white = {text.get_text() for text in seen(drawings["new-method"]) if to_hex(text.get_color()) == "#ffffff"}
    assert white == {schematics.TRUTH, "$Q$", "$P_0$", "$TH$"} and len(dark) == len(white)
    assert not any(to_hex(patch.get_facecolor()) == style.BLACK for patch in blocks(drawings["baseline"]))


def test_the_baseline_names_both_readings_of_its_loop(drawings):
    said = " ".join(text.get_text() for text in seen(drawings["baseline"]))
    assert "EKF-Pi" in said and "EKF-Pm" in said


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_drawing_is_a_small_svg_and_the_same_bytes_twice(name, tmp_path):
    files = [tmp_path / f"{attempt}.svg" for attempt in (1, 2)]
    for file in files:
        with style.use():
            style.save(DRAWINGS[name](None), file)
    assert files[0].read_bytes() == files[1].read_bytes() and files[0].stat().st_size < 150_000
    assert ElementTree.parse(files[0]).getroot().tag.endswith("svg")


def test_every_kind_of_filter_has_a_look_and_no_two_look_alike_in_grey():
    assert set(palette.FAMILIES) <= set(style.families())
    looks = [palette.look(family) for family in palette.FAMILIES]
    assert len({str(look["linestyle"]) for look in looks}) == len(looks)
    assert len({str(look["marker"]) for look in looks}) == len(looks)


def test_an_ekf_has_the_colour_that_an_ekf_has_everywhere():
    assert {palette.look(family)["color"] for family in ("ekf-pi", "ekf-pm", "ekf-f")} == {style.family("classical")["color"]}
