"""Figures 1-4: readable at the width of a column, nothing over anything else, and what they draw is right."""

import xml.etree.ElementTree as ElementTree
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import FancyBboxPatch

from robins.papers.imani2026 import schematics
from robins.publish import style

DRAWINGS = {
    "gyroscope": schematics.draw_gyroscope,
    "interferometer": schematics.draw_interferometer,
    "loop": schematics.draw_loop,
    "layout": schematics.draw_layout,
}
CONTAINERS = 1  # boxes of the layout that hold other boxes: the vehicle


@pytest.fixture(scope="module")
def drawings():
    """The four figures, drawn once."""
    drawn = {}
    for name, draw in DRAWINGS.items():
        with style.use():
            drawn[name] = draw(None)
            FigureCanvasAgg(drawn[name]).draw()
    return drawn


def seen(figure):
    return [text for text in figure.axes[0].texts if text.get_text().strip()]


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
    figure = drawings[name]
    blocks = [patch.get_window_extent() for patch in figure.axes[0].patches if isinstance(patch, FancyBboxPatch)]
    for text in seen(figure):
        box = shrunk(text.get_window_extent())
        for block in blocks:
            inside = block.x0 <= box.x0 and box.x1 <= block.x1 and block.y0 <= box.y0 and box.y1 <= block.y1
            assert inside or not block.overlaps(box), text.get_text()


@pytest.mark.parametrize("name", DRAWINGS)
def test_no_two_boxes_overlap(name, drawings):
    blocks = [patch for patch in drawings[name].axes[0].patches if isinstance(patch, FancyBboxPatch)]
    blocks = [block.get_window_extent() for block in (blocks[CONTAINERS:] if name == "layout" else blocks)]
    assert not any(one.overlaps(other) for one, other in combinations(blocks, 2))


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


def test_the_arms_part_meet_again_and_fall_alike():
    time, upper, lower = schematics.paths(-0.22)
    assert upper[0] == lower[0] and upper[-1] == pytest.approx(lower[-1])
    middle = np.searchsorted(time, 1.0)
    assert upper[middle] - lower[middle] == pytest.approx(1.0), "one recoil velocity times T"
    _, straight, _ = schematics.paths(0.0)
    np.testing.assert_allclose(upper - straight, -0.11 * time**2)


@pytest.mark.parametrize("acceleration", [-0.22, 0.0, 0.7])
def test_the_phase_of_the_drawn_arms_is_that_of_the_formula(acceleration):
    """The light's phase grows with height: ``phi_1 - phi_2up - phi_2low + phi_3 = a T^2`` for ``k_eff = T = 1``."""
    time, upper, lower = schematics.paths(acceleration)
    at = [np.searchsorted(time, epoch) for epoch in (0.0, 1.0, 2.0)]
    phase = lower[at[0]] - upper[at[1]] - lower[at[1]] + lower[at[2]]
    assert phase == pytest.approx(acceleration)


def test_the_sample_enters_twice_in_f0_and_once_in_f1(drawings):
    words = [text.get_text() for text in seen(drawings["loop"])]
    assert (words.count("as $z_k$"), words.count("as $u_k$")) == (2, 1)


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_drawing_is_a_small_svg_and_the_same_bytes_twice(name, tmp_path):
    files = [tmp_path / f"{attempt}.svg" for attempt in (1, 2)]
    for file in files:
        with style.use():
            style.save(DRAWINGS[name](None), file)
    assert files[0].read_bytes() == files[1].read_bytes() and files[0].stat().st_size < 100_000
    assert ElementTree.parse(files[0]).getroot().tag.endswith("svg")
