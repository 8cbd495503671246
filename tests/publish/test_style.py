"""One look for each family of filters, and the same bytes for the same figure."""

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from robins.publish import style


def line(ax=None):
    figure = Figure()
    ax = figure.subplots()
    ax.plot([0, 1, 2], [0, 1, 0.5])
    return figure


def test_no_two_families_look_alike_in_colour_or_in_grey():
    looks = [style.family(name) for name in style.families()]
    assert len({(str(look["linestyle"]), look["marker"]) for look in looks}) == len(looks)
    assert len({(look["color"], str(look["linestyle"])) for look in looks}) == len(looks)
    assert len({look["marker"] for look in looks}) >= len(looks) - 2


def test_an_adaptive_filter_has_the_colour_of_its_own_base_where_both_are_corrected_or_augmented():
    assert style.family("corrected")["color"] == style.family("corrected-adaptive")["color"]
    assert style.family("augmented")["color"] == style.family("augmented-adaptive")["color"]


def test_an_unknown_family_is_an_error_that_names_the_known_ones():
    with pytest.raises(KeyError, match="classical"):
        style.family("nonsense")


def test_a_family_is_what_plot_understands():
    ax = Figure().subplots()
    for name in style.families():
        ax.plot([0, 1], [0, 1], **style.family(name))


def test_published_values_are_open_diamonds():
    marker = style.published_marker(Figure().subplots(), [1], [2])
    assert (marker.get_marker(), marker.get_markerfacecolor(), marker.get_linestyle()) == ("D", "white", "None")


@pytest.mark.parametrize("horizontal", [True, False])
def test_an_interval_spans_its_ends_and_marks_its_value(horizontal):
    ax = Figure().subplots()
    marker = style.interval(ax, [3.0], [1.0], [0.5], [2.0], "corrected", horizontal)
    start, end = ax.collections[0].get_segments()[0]
    expected = ((0.5, 3.0), (2.0, 3.0)) if horizontal else ((3.0, 0.5), (3.0, 2.0))
    np.testing.assert_array_equal((start, end), expected)
    assert (marker.get_xdata()[0], marker.get_ydata()[0]) == ((1.0, 3.0) if horizontal else (3.0, 1.0))


def test_a_shaded_window_spans_its_epochs():
    span = style.shade_window(Figure().subplots(), 80, 150)
    assert (span.get_x(), span.get_width()) == (80, 70)


def test_the_style_sheet_ignores_the_users_settings_and_leaves_them_alone():
    with matplotlib.rc_context({"lines.linewidth": 9.0, "axes.facecolor": "red"}):
        with style.use():
            assert matplotlib.rcParams["lines.linewidth"] == 1.2
            assert matplotlib.rcParams["axes.facecolor"] == "white"
        assert matplotlib.rcParams["lines.linewidth"] == 9.0


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_a_figure_is_saved_with_the_same_bytes_each_time_and_without_a_date(suffix, tmp_path, monkeypatch):
    for name, epoch in (("a", "0"), ("b", "1700000000")):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
        with style.use():
            style.save(line(), tmp_path / f"{name}{suffix}")
    content = (tmp_path / f"a{suffix}").read_bytes()
    assert content == (tmp_path / f"b{suffix}").read_bytes()
    assert b"Matplotlib" not in content.split(b"-->")[-1]
    assert b"date" not in content.lower()


def test_a_figure_of_full_width_is_small(tmp_path):
    with style.use():
        figure = Figure(figsize=(style.WIDTH, 4))
        for row in figure.subplots(2, 1):
            for name in style.families():
                row.plot(np.random.default_rng(1).normal(size=200).cumsum(), label=name, **style.family(name) | {"marker": ""})
        style.save(figure, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size < 150_000


def test_another_format_is_refused_and_leaves_nothing(tmp_path):
    with pytest.raises(ValueError, match="png or .svg"):
        style.save(line(), tmp_path / "figure.pdf")
    assert list(tmp_path.iterdir()) == []
