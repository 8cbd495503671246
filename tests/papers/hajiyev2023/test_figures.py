"""Every figure of the wing draws from a small ensemble, says its units, keeps to the style and leaves nothing outside."""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import Collection
from matplotlib.colors import to_hex, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

from robins.evaluate.published import read_published
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023 import PAPER, figures_epochs, figures_study, figures_sweeps, panels, schematics
from robins.papers.hajiyev2023.figures import FIGURES
from robins.papers.hajiyev2023.scenario import BRANCHES
from robins.papers.hajiyev2023.studies import ADAPTED
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Output, Results, Settings
from robins.publish import style

SIZES = {"runs": 8, "sweep_runs": 8, "specification_sets": 8, "specification_runs": 8, "bootstrap": 50}
BY_NAME = {figure.name: figure for figure in FIGURES}
WITH_DATA = [figure for figure in FIGURES if figure.needs]
COLOURS = {value.lower() for name, value in vars(style).items() if re.fullmatch("#[0-9A-F]{6}", str(value)) and name.isupper()}
GRID_AND_PAPER = {"#d9d9d9", "#ffffff"}


@pytest.fixture(scope="module")
def outputs() -> dict[str, Output]:
    """The outputs of the jobs, each computed once."""
    return {}


@pytest.fixture(scope="module")
def results_for(outputs, repository):
    """``results_for(figure)``: what the figure may read, which is what it says that it needs and nothing else."""
    settings = Settings("smoke", 1, SIZES, {"plant": "f4c"})
    published = read_published(repository / "data" / "published" / "hajiyev2023.csv")

    def load(name):
        if name not in outputs:
            outputs[name] = PAPER.jobs[name].compute(settings)
        return outputs[name]

    def results(figure) -> Results:
        def allowed(name):
            assert name in figure.needs
            return load(name)

        return Results(settings, published, allowed)

    return results


@pytest.fixture(scope="module")
def drawing_of(results_for):
    """``drawing_of(name)``: a figure, drawn and laid out once for all tests that look at it."""
    drawn = {}

    def drawing(name) -> Figure:
        if name not in drawn:
            with style.use():
                drawn[name] = BY_NAME[name].draw(results_for(BY_NAME[name]))
                FigureCanvasAgg(drawn[name]).draw()
        return drawn[name]

    return drawing


def names(figures) -> list[str]:
    return [figure.name for figure in figures]


def texts_of(drawing: Figure) -> Iterator[Text]:
    """Texts that a reader sees."""
    hidden = {id(text) for ax in drawing.axes if not ax.axison for axis in (ax.xaxis, ax.yaxis) for text in axis.findobj(Text)}
    return (text for text in drawing.findobj(Text) if text.get_visible() and text.get_text().strip() and id(text) not in hidden)


def colours_of(drawing: Figure) -> set[str]:
    """Every colour that is drawn with, opacity aside."""
    drawn = []
    for artist in drawing.findobj(lambda artist: artist.get_visible()):
        if isinstance(artist, Line2D):
            drawn += [artist.get_color()] if artist.get_linestyle() != "None" else []
            if artist.get_marker() not in ("", "None", None):
                drawn += [artist.get_markerfacecolor(), artist.get_markeredgecolor()]
        elif isinstance(artist, Patch | Collection):
            drawn += [artist.get_facecolor(), artist.get_edgecolor()]
        elif isinstance(artist, Text):
            drawn += [artist.get_color()]
    rows = np.vstack([to_rgba_array(colour) for colour in drawn if len(colour)])
    return {to_hex(row) for row in rows[rows[:, 3] > 0]}


def words_of(ax: Axes, axis: str) -> str:
    """Everything that labels an axis: its own label and those that its figures give to all panels."""
    own = getattr(ax, f"get_{axis}label")()
    return " ".join([own, getattr(ax.figure, f"get_sup{axis}label")(), getattr(ax.get_figure(root=True), f"get_sup{axis}label")()])


def shows_numbers(ax: Axes, axis: str) -> bool:
    """Whether an axis shows numbers: not the names of the states, and not nothing because it shares another panel's."""
    if not getattr(ax, f"{axis}axis").get_tick_params().get({"x": "labelbottom", "y": "labelleft"}[axis], True):
        return False
    labels = [label.get_text() for label in getattr(ax, f"get_{axis}ticklabels")()]
    return not any("$" in label for label in labels) or any(re.fullmatch(r"[\d.−-]+", label) for label in labels)


def test_the_papers_eight_figures_stand_in_both_branches():
    expected = {f"figure-{number:02d}-{branch}" for number in range(1, 9) for branch in BRANCHES}
    assert {name for name in BY_NAME if name.startswith("figure-")} == expected
    assert len(BY_NAME) == len(FIGURES)


def test_a_figure_needs_jobs_that_exist_and_names_the_module_that_draws_it():
    for figure in FIGURES:
        assert set(figure.needs) <= set(PAPER.jobs)
        draw = getattr(figure.draw, "func", figure.draw)
        assert figure.modules == (draw.__module__,)
        assert figure.title and figure.caption


def test_a_caption_says_substitute_and_its_n_where_runs_are_behind_it():
    for figure in WITH_DATA:
        assert panels.SUBSTITUTE in figure.caption
        assert bool(figure.size) == (figure.name != "extra-information-loss")
    assert all("Open diamond" in BY_NAME[name].caption for name in ("extra-overview", "extra-forest", "extra-single-seed-ratios"))


@pytest.mark.parametrize("name", names(WITH_DATA))
def test_a_figure_says_that_the_aircraft_is_a_substitute(name, drawing_of):
    assert any(panels.SUBSTITUTE in text.get_text() for text in texts_of(drawing_of(name)))


@pytest.mark.parametrize("name", names(WITH_DATA))
def test_every_axis_has_a_label_with_its_unit(name, drawing_of):
    for ax in drawing_of(name).axes:
        for axis in ("x", "y"):
            if shows_numbers(ax, axis):
                assert re.search(r"\((1|steps|s|%|m/s|deg|deg/s|rad|rad/s)\)", words_of(ax, axis)), (name, axis)


@pytest.mark.parametrize("name", names(FIGURES))
def test_a_figure_keeps_to_the_colours_and_widths_of_the_style(name, drawing_of):
    drawing = drawing_of(name)
    assert colours_of(drawing) <= COLOURS | GRID_AND_PAPER
    assert drawing.get_figwidth() <= style.WIDTH
    assert min(text.get_fontsize() for text in texts_of(drawing)) >= 8


@pytest.mark.parametrize("name", names(FIGURES))
def test_nothing_leaves_the_figure(name, drawing_of):
    drawing = drawing_of(name)
    drawn, (width, height) = drawing.get_tightbbox(), drawing.get_size_inches()
    assert -0.01 <= drawn.x0 and drawn.x1 <= width + 0.01 and -0.01 <= drawn.y0 and drawn.y1 <= height + 0.01


@pytest.mark.parametrize("branch", BRANCHES)
@pytest.mark.parametrize("number", [1, 3, 5, 7])
def test_paired_figures_share_their_limits(number, branch, drawing_of):
    adaptive, plain = (drawing_of(f"figure-{n:02d}-{branch}") for n in (number, number + 1))
    for ours, theirs in zip(adaptive.axes, plain.axes, strict=True):
        assert ours.get_ylim() == theirs.get_ylim()
        assert ours.get_xlim() == theirs.get_xlim()


def test_angles_are_drawn_in_the_unit_of_their_branch(drawing_of, outputs):
    for branch, factor in (("deg", 180 / np.pi), ("rad", 1.0)):
        truth = drawing_of(f"figure-07-{branch}").axes[0].lines[0].get_ydata()
        np.testing.assert_allclose(truth, factor * outputs["mdkf-printed"].arrays[f"{branch}.fault.truth0"][:-1, STATES.index("theta")])


def test_the_drawn_error_is_estimate_minus_truth(drawing_of):
    upper, lower = drawing_of("figure-03-deg").axes
    truth, estimate = (line.get_ydata() for line in upper.lines)
    np.testing.assert_allclose(lower.lines[-1].get_ydata(), estimate - truth)


def test_the_overview_marks_the_ratios_of_table_one(drawing_of):
    (diamonds,) = [line for line in drawing_of("extra-overview").axes[0].lines if line.get_label() == panels.PUBLISHED]
    np.testing.assert_allclose(diamonds.get_xdata(), [0.540, 0.968, 0.813, 0.650, 1.136, 1.689, 1.056, 1.161], atol=6e-4)


def test_the_lateral_panels_show_both_branches_since_their_ratios_agree(results_for, drawing_of):
    drawing_of("extra-overview")
    logs = panels.paired_logs(results_for(BY_NAME["extra-overview"]), ADAPTED)
    for state in STATES[4:]:
        np.testing.assert_allclose(logs["deg", "fault", state], logs["rad", "fault", state], atol=1e-7)


def test_a_failed_run_leaves_the_pair(results_for, outputs):
    figure = BY_NAME["extra-overview"]
    results = results_for(figure)
    table = results.table("amdkf-printed").copy()
    table.loc[(table["run"] == 3), ["failed", "rmse"]] = [True, np.nan]
    broken = {"amdkf-printed": Output(table), "mdkf-printed": results.output("mdkf-printed")}
    logs = panels.paired_logs(Results(results.settings, results.published, broken.__getitem__), ADAPTED)
    assert {len(values) for values in logs.values()} == {SIZES["runs"] - 1}
    assert np.isfinite(np.concatenate(list(logs.values()))).all()


def test_the_published_error_of_w_implies_the_angles_of_the_brief(results_for):
    expected = figures_study.expected_from_gust(results_for(BY_NAME["extra-units"]))
    np.testing.assert_allclose([expected[state] for state in ("q", "theta", "beta")], [0.029, 0.0215, 0.0215], atol=5e-4)


def test_curves_that_end_together_share_a_label():
    ends = np.array([2.0, 1.5, 1.001, 1.1, 1.0, 1.0, 1.02, 1.3])
    labels = [words for _, words in figures_epochs.joined_labels(ends, 1.035)]
    assert labels == ["$u$", "$w$", r"$\phi$", r"$\theta$", r"$r$, $q$, $\beta$, $p$"]


def test_settings_of_the_fault_off_the_curve_stand_beside_it(results_for):
    results = results_for(BY_NAME["extra-fault-multiplier"])
    curve, beside = figures_sweeps.sweep_points(results.table("sweep-deg"), figures_sweeps.MULTIPLIER, ADAPTED, "q")
    assert list(curve["value"]) == [1, 2, 4, 8, 16, 32]
    assert set(beside["setting"]) == set(figures_sweeps.SPECIAL)


@pytest.mark.parametrize("name", ["extra-window", "extra-tau-duration"])
def test_a_sweep_fills_its_panels(name, drawing_of):
    for ax in drawing_of(name).axes:
        places = ax.transData.transform(np.column_stack([ax.lines[0].get_xdata(), np.ones(len(ax.lines[0].get_xdata()))]))[:, 0]
        assert np.ptp(places) > 0.8 * ax.get_window_extent().width


def test_the_schematic_says_for_every_filter_what_the_registry_says():
    drawing = schematics.draw_filters(None)
    shown = {text.get_text() for text in drawing.axes[0].texts}
    assert {row.label for row in VARIANTS.values()} <= shown
    assert schematics.cells(VARIANTS["abh"].composition)[2:] == ("prediction", "each channel its own", "$R_v$ only")
    assert schematics.cells(VARIANTS["amdkf-printed"].composition)[2:] == ("update", "each channel its own", "all of $R$")


@pytest.mark.parametrize("name", ["figure-05-deg", "extra-overview", "extra-single-seed-ratios", "schematic-differencing"])
def test_a_figure_is_the_same_bytes_twice_and_small(name, results_for, tmp_path):
    figure = BY_NAME[name]
    files = [tmp_path / f"{attempt}{figure.suffix}" for attempt in (1, 2)]
    for file in files:
        with style.use():
            style.save(figure.draw(results_for(figure)), file)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[0].stat().st_size < 200_000


@pytest.mark.parametrize("name", [figure.name for figure in FIGURES if figure.suffix == ".svg"])
def test_a_schematic_is_a_well_formed_svg(name, tmp_path):
    path = tmp_path / f"{name}.svg"
    with style.use():
        style.save(BY_NAME[name].draw(None), path)
    assert ElementTree.parse(path).getroot().tag.endswith("svg")
    assert path.stat().st_size < 200_000
