"""The wing's figures draw what the jobs hold, in the units they name, say in words what failed, and keep to the style.

The runs are fabricated, so that what a figure has to show is known; the drive is the real one.
"""

import re
from collections.abc import Iterator

import numpy as np
import pandas as pd
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
from robins.kalman.weights import weighting
from robins.papers.imani2026 import ensemble, figures_channels, figures_filters, figures_scale, figures_sweeps, panels
from robins.papers.imani2026.comparisons import GROUPS, PAIR
from robins.papers.imani2026.drive import CHANNELS, DURATION
from robins.papers.imani2026.figures import FIGURES
from robins.papers.imani2026.formulations import FORMULATIONS
from robins.papers.imani2026.methods import FAMILIES, Method
from robins.papers.imani2026.options import OPTIONS
from robins.papers.imani2026.studies import OUTLIER_RATES, SCALED, outlier_cases, scale_methods
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Output, Results, Settings
from robins.publish import style

RUNS = 6
SETTINGS = Settings("smoke", 1, {"runs": RUNS, "tuning_runs": 2, "sweep_runs": RUNS, "fast_runs": 1, "bootstrap": 50}, OPTIONS)
MKMC, CI = PAIR
LEVELS = np.repeat([2.0, 0.05, 0.002, 0.01], 3)  # SI, by channel
FACTORS = {CI: 1.0, MKMC: 0.5, "no-update": 3.0, "mk-norm": 0.8}  # of the error, known so that improvements are
BY_NAME = {figure.name: figure for figure in FIGURES}
OF_OTHERS = {"figure-1", "figure-2", "figure-3", "figure-4", "figure-6", "extra-influence"}  # their modules have tests of their own
NAMES = [name for name in BY_NAME if name not in OF_OTHERS]
COLOURS = {value.lower() for name, value in vars(style).items() if re.fullmatch("#[0-9A-F]{6}", str(value)) and name.isupper()}
GRID_PAPER_AND_REMARKS = {"#d9d9d9", "#ffffff", "#505050"}


def factor(name: str) -> float:
    return FACTORS.get(name, 1.0 + 0.01 * (sum(map(ord, name)) % 40))


def score_rows(runs: int, level: float, failed=(), **labels) -> pd.DataFrame:
    """A job's rows of filters whose errors are `level` times those of the CI-RKF in every run."""
    rmse = level * LEVELS * (1.0 + 0.05 * np.arange(runs))[:, None]
    lost = np.isin(np.arange(runs), failed)
    rmse[lost] = np.nan
    columns = {"rmse": rmse, "mean": 0.3 * rmse, "sd": np.sqrt(0.91) * rmse, "drift": -rmse, "drift_integral": 0.3 * rmse * DURATION}
    return pd.DataFrame({
        **labels, "run": np.repeat(np.arange(runs), 12), "channel": np.tile(CHANNELS, runs),
        **{key: value.ravel() for key, value in columns.items()},
        "failed": np.repeat(lost, 12), "reason": np.where(np.repeat(lost, 12), "diverged", ""),
    })  # fmt: skip


def variant_output(name: str, truth: np.ndarray) -> Output:
    """A filter whose error is constant in run 0; the printed one fails in every run."""
    failed = np.full(RUNS, name == "mk-raw")
    frames, arrays, seconds = [], {}, np.arange(DURATION + 1)
    for formulation in FORMULATIONS:
        frames.append(score_rows(RUNS, factor(name), np.flatnonzero(failed), formulation=formulation, against="truth"))
        band = factor(name) * LEVELS * np.array([-1.0, 0.0, 1.0])[:, None, None] * np.ones((3, len(seconds), 1))
        found = {
            "estimate0": truth + factor(name) * LEVELS, "error_quantiles": band, "nis_mean": np.full(len(seconds), 6.0),
            "nees_attitude": np.full((RUNS, 11), 3.0), "nees_bias": np.full((RUNS, 11), 6.0), "marks": 300 * np.arange(1, 12),
            "position_rms": np.full((RUNS, 3), 100.0 * factor(name)), "position_final": np.full((RUNS, 3), 200.0), "failed": failed,
        }  # fmt: skip
        if failed[0]:
            found |= {key: np.full_like(value, np.nan, dtype=float) for key, value in found.items() if key not in ("marks", "failed")}
        arrays |= {f"{formulation}.{key}": value for key, value in found.items()}
    return Output(pd.concat(frames, ignore_index=True), arrays)


def sweep_rows(cases, names=figures_sweeps.SWEPT_FILTERS) -> Output:
    return Output(pd.concat([score_rows(RUNS, factor(name), **case, filter=name) for case in cases for name in names], ignore_index=True))


def scale_rows() -> Output:
    cases = [("F0", 0.0)] + [("F1", rate) for rate in OUTLIER_RATES]
    return Output(pd.concat([
        score_rows(RUNS, factor(method) * (1 + rate * (method != "ci-seq")), formulation=name, rate=rate, method=method, scale=float(value))
        for name, rate in cases for method, value in scale_methods(OPTIONS, dict.fromkeys(SCALED, 1.0), Method(weighting("unit")))
    ], ignore_index=True))  # fmt: skip


def tuning_rows(family: str) -> Output:
    knob = FAMILIES[family]
    rows = [
        (condition, scale, knob.parameter, value, "grid", 0.1 * i + 0.01 * j, 0, i == j == 0)
        for condition in ("headline", "outliers")
        for i, scale in enumerate((0.1, 1.0, 10.0, 100.0))
        for j, value in enumerate(knob.values[1:])
    ]
    columns = ["condition", "noise_scale", "parameter", "value", "stage", "objective", "failed", "chosen"]
    table = pd.DataFrame(rows, columns=columns)
    table.loc[5, "objective"] = np.inf
    return Output(table)


def study_output(name: str) -> Output:
    if name.startswith("tuning-"):
        return tuning_rows(name.removeprefix("tuning-"))
    if name == "scale":
        return scale_rows()
    if name == "outliers":
        cases = [case | {"tuned": "headline"} for case in outlier_cases()]
        return sweep_rows([*cases, {"law": "nig-zero-mean", "sided": "two-sided", "rate": 0.02, "tuned": "outliers"}])
    if name == "grades":
        return sweep_rows([{"grade": grade} for grade in figures_sweeps.GRADE_WORDS])
    return sweep_rows([{"rate_hz": rate, "noise": noise} for rate in OPTIONS["rates_hz"] for noise in figures_sweeps.NOISES])


@pytest.fixture(scope="module")
def outputs() -> dict[str, Output]:
    """Outputs of all jobs by name, made when first asked for."""
    return {"drive": ensemble.scenario(SETTINGS)}


@pytest.fixture(scope="module")
def results_for(outputs, repository):
    """``results_for(figure)``: what the figure may read, which is what it says that it needs and nothing else."""
    published = read_published(repository / "data" / "published" / "imani2026.csv")

    def load(name):
        if name not in outputs:
            outputs[name] = variant_output(name, outputs["drive"].arrays["truth"]) if name in VARIANTS else study_output(name)
        return outputs[name]

    def results(figure) -> Results:
        def allowed(name):
            assert name in figure.needs
            return load(name)

        return Results(SETTINGS, published, allowed)

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


def texts_of(drawing: Figure) -> Iterator[Text]:
    """Texts that a reader sees."""
    return (text for text in drawing.findobj(Text) if text.get_visible() and text.get_text().strip())


def words_in(drawing: Figure) -> str:
    return " ".join(text.get_text() for text in texts_of(drawing))


def colours_of(drawing: Figure) -> set[str]:
    """Every colour of lines, fills and texts, opacity aside."""
    drawn = []
    for artist in drawing.findobj(lambda artist: artist.get_visible()):
        if isinstance(artist, Line2D):
            drawn += [artist.get_color()] if artist.get_linestyle() != "None" else []
            drawn += [artist.get_markerfacecolor(), artist.get_markeredgecolor()] if artist.get_marker() not in ("", "None", None) else []
        elif isinstance(artist, Patch) or (isinstance(artist, Collection) and artist.axes not in colour_bars(drawing)):
            drawn += [artist.get_facecolor(), artist.get_edgecolor()]
        elif isinstance(artist, Text):
            drawn += [artist.get_color()]
    bars = {to_hex(patch.get_facecolor()) for ax in colour_bars(drawing) for patch in ax.patches}
    rows = np.vstack([to_rgba_array(colour) for colour in drawn if len(colour)])
    return {to_hex(row) for row in rows[rows[:, 3] > 0]} - bars


def colour_bars(drawing: Figure) -> list[Axes]:
    return [ax for ax in drawing.axes if ax.get_label() == "<colorbar>"]


def words_of(ax: Axes, axis: str) -> str:
    """Everything that labels an axis: its own label, that of the panel at the row's left end, and the figure's."""
    left = {id(ax.get_subplotspec().get_gridspec()): ax} if ax.get_subplotspec() else {}
    row = [other for other in ax.figure.axes if left and other.get_subplotspec()
           and other.get_subplotspec().rowspan == ax.get_subplotspec().rowspan]  # fmt: skip
    shared = [getattr(other, f"get_{axis}label")() for other in row] if axis == "y" else []
    return " ".join([getattr(ax, f"get_{axis}label")(), *shared, getattr(ax.figure, f"get_sup{axis}label")()])


def shows_numbers(ax: Axes, axis: str) -> bool:
    """Whether an axis shows numbers, and not names, or nothing because it shares another panel's."""
    if not getattr(ax, f"{axis}axis").get_tick_params().get({"x": "labelbottom", "y": "labelleft"}[axis], True):
        return False
    return any(re.fullmatch(r"[\d.−∞-]+", label.get_text()) for label in getattr(ax, f"get_{axis}ticklabels")())


def test_the_papers_eight_figures_stand_in_its_order():
    parts = [f"figure-{number}-{part}" for number in (7, 8) for part in ("velocity", "acceleration", "rate", "euler")]
    expected = [f"figure-{number}" for number in range(1, 7)] + parts
    assert [name for name in BY_NAME if name.startswith("figure-")] == expected
    assert list(BY_NAME)[: len(expected)] == expected and len(BY_NAME) == len(FIGURES)


def test_a_figure_names_the_module_that_draws_it_and_needs_jobs_that_exist():
    jobs = {*VARIANTS, *(f"tuning-{family}" for family in FAMILIES), "drive", "diagnose/drive", "scale", "outliers", "grades", "rates"}
    for figure in FIGURES:
        assert set(figure.needs) <= jobs
        assert figure.modules == (getattr(figure.draw, "func", figure.draw).__module__,)
        assert figure.title and figure.caption


@pytest.mark.parametrize("name", [name for name in NAMES if name != "figure-5"])
def test_a_caption_says_formulation_condition_and_tuning_and_has_an_n(name):
    figure = BY_NAME[name]
    said = figure.caption + figure.title
    assert figure.size in SETTINGS.sizes
    assert re.search(r"\bF[012]\b", said)
    assert re.search("10 Hz|run 1000", said)
    assert re.search("[Nn]ominal|[Cc]onventional|[Tt]un(ed|ing)", said)


@pytest.mark.parametrize("name", NAMES)
def test_every_axis_has_a_label_with_its_unit(name, drawing_of):
    for ax in drawing_of(name).axes:
        for axis in ("x", "y"):
            if shows_numbers(ax, axis):
                assert re.search(r"\((1|s|sd|%|m|m/s|m/s²|Hz|deg|rad/s)\)", words_of(ax, axis)), (name, axis)


@pytest.mark.parametrize("name", NAMES)
def test_a_figure_keeps_to_the_colours_and_widths_of_the_style(name, drawing_of):
    drawing = drawing_of(name)
    assert colours_of(drawing) <= COLOURS | GRID_PAPER_AND_REMARKS
    assert drawing.get_figwidth() <= style.WIDTH
    assert min(text.get_fontsize() for text in texts_of(drawing)) >= 8


@pytest.mark.parametrize("name", NAMES)
def test_nothing_leaves_the_figure(name, drawing_of):
    drawing = drawing_of(name)
    drawn, (width, height) = drawing.get_tightbbox(), drawing.get_size_inches()
    assert -0.01 <= drawn.x0 and drawn.x1 <= width + 0.01 and -0.01 <= drawn.y0 and drawn.y1 <= height + 0.01


def lines_by_label(ax: Axes) -> dict[str, Line2D]:
    return {line.get_label(): line for line in ax.lines}


def test_the_drive_marks_six_way_points_where_the_car_is(drawing_of, outputs):
    plan, height, speed = drawing_of("figure-5").axes
    names = [text for text in plan.texts if text.get_text()]
    assert [text.get_text() for text in names] == ["P1", "P2", "P3", "P4", "P5", "P6"]
    np.testing.assert_array_equal([text.xy for text in names], outputs["drive"].arrays["way_points"][:, :2])
    assert plan.get_aspect() == 1.0
    np.testing.assert_array_equal(lines_by_label(height)["truth"].get_ydata(), outputs["drive"].arrays["position"][:, 2])
    assert speed.lines[0].get_ydata().max() == pytest.approx(9.48, abs=0.01)


def test_estimates_are_drawn_as_they_are_and_velocity_in_metres_a_second(drawing_of, outputs):
    ax = drawing_of("figure-7-velocity").axes[0]
    drawn = lines_by_label(ax)[VARIANTS[MKMC].label]
    np.testing.assert_array_equal(drawn.get_ydata(), outputs[MKMC].arrays["F1.estimate0"][:, 0])
    np.testing.assert_array_equal(drawn.get_xdata(), outputs["drive"].arrays["time"])


def test_yaw_is_drawn_in_degrees_between_half_turns_without_lines_across(drawing_of):
    for line in drawing_of("figure-7-euler").axes[2].lines:
        values = line.get_ydata()
        assert np.nanmax(np.abs(values)) <= 180.0
        steps = np.abs(np.diff(values))
        assert np.nanmax(steps) < 180.0 and np.isnan(values).any()


@pytest.mark.parametrize(("group", "unit"), [("velocity", 1.0), ("acceleration", 1.0), ("rate", 1.0), ("euler", 180 / np.pi)])
def test_the_drawn_error_is_estimate_minus_truth_in_the_unit_of_the_axis(group, unit, drawing_of):
    for i, ax in enumerate(drawing_of(f"figure-8-{group}").axes):
        level = LEVELS[3 * ("velocity", "acceleration", "rate", "euler").index(group) + i]
        for name in PAIR:
            drawn = lines_by_label(ax)[VARIANTS[name].label].get_ydata()
            np.testing.assert_allclose(drawn[1:], unit * factor(name) * level, rtol=1e-9)
        bands = [band.get_paths()[0].vertices[:, 1] for band in ax.collections]
        np.testing.assert_allclose([band.max() for band in bands], [unit * factor(name) * level for name in (CI, MKMC)])


@pytest.mark.parametrize("name", ["figure-7-velocity", "figure-8-euler", "extra-figure-7-f0"])
def test_a_filter_that_fails_is_named_in_words_and_never_drawn(name, drawing_of):
    assert f"MKMC-EKF as printed: fails in {RUNS} of {RUNS} runs" in words_in(drawing_of(name))
    for ax in drawing_of(name).axes:
        assert VARIANTS["mk-raw"].label not in lines_by_label(ax)


def test_a_run_0_that_fails_is_not_drawn(results_for, outputs):
    figure = BY_NAME["figure-7-velocity"]
    lost = dict(outputs[MKMC].arrays) | {"F1.failed": np.arange(RUNS) == 0}
    loaded = {name: results_for(figure).output(name) for name in figure.needs} | {MKMC: Output(outputs[MKMC].table, lost)}
    found = figures_channels.series(Results(SETTINGS, pd.DataFrame(), loaded.__getitem__), "F1")
    assert set(found) == {"truth", "reference", "ekf-tuned", CI}


def test_the_position_of_filters_that_fail_is_said_in_words(drawing_of):
    texts = [text.get_text() for ax in drawing_of("extra-position").axes for text in ax.texts]
    assert texts == [f"all {RUNS} runs fail"] * len(FORMULATIONS)


def test_a_group_is_the_geometric_mean_of_its_channels_and_a_failed_run_a_loss():
    made = ((CI, 1.0, []), ("a", 1.0, []), ("b", 0.5, [2]))
    rows = pd.concat([score_rows(RUNS, level, failed, grade="x", filter=name) for name, level, failed in made])
    where = {"grade": "x"}
    scaled = rows["channel"].map({"v_e": 0.5, "v_n": 2.0, "v_u": 8.0}).fillna(3.0)
    rows.loc[rows["filter"] == "a", "rmse"] *= scaled[rows["filter"] == "a"]
    results = Results(SETTINGS, pd.DataFrame(), {"study": Output(rows)}.__getitem__)
    found = panels.group_ratio(results, "study", where, "a", CI)
    np.testing.assert_allclose(found.estimate, [2.0, 3.0, 3.0, 3.0], rtol=1e-12)
    np.testing.assert_allclose([found.low, found.high], [found.estimate] * 2, rtol=1e-9)  # the same ratio in every run
    lost = panels.group_ratio(results, "study", where, "b", CI)
    assert lost.failed == 1 and (lost.estimate > 0.5).all() and (lost.high <= 1.0 + 1e-9).all()
    level = panels.group_level(results, "study", where, "b")
    assert level.failed == 1 and (level.low < level.estimate).all() and (level.estimate < level.high).all()


@pytest.mark.parametrize("worst", [1.04, 1.3, 2.5, 12.0, 300.0])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_an_axis_of_improvements_reads_one_minus_the_ratio_and_holds_zero(worst, axis):
    ax = Figure().subplots()
    panels.improvement_axis(ax, axis, [[0.5, worst], [np.nan, np.inf]])
    ticks = getattr(ax, f"get_{axis}ticks")()
    labels = [getattr(ax, f"{axis}axis").get_major_formatter()(tick, None) for tick in ticks]
    assert "0" in labels and 3 <= len(labels) <= 12
    np.testing.assert_allclose([float(label.replace("−", "-")) for label in labels], 100 * (1 - np.array(ticks)), atol=1e-9)
    high, low = getattr(ax, f"get_{axis}lim")()
    assert low < 0.5 and high > worst


@pytest.mark.parametrize(("ratio", "text"), [(0.5, "50"), (1.0, "0"), (1.33, "−33"), (2.0, "×2.0"), (9.96, "×10"), (17.2, "×17")])
def test_a_cell_says_the_improvement_or_how_many_times_the_error_is(ratio, text):
    assert figures_scale.cell_text(ratio) == text


def test_the_map_has_the_ratios_of_its_study(results_for):
    results = results_for(BY_NAME["extra-improvement-map"])
    found = figures_scale.map_ratios(results, "mk-norm-gain")
    assert found.shape == (len(GROUPS), len(OUTLIER_RATES), len(figures_scale.KERNEL_SCALES))
    np.testing.assert_allclose(found, np.broadcast_to(0.5 * (1 + np.array(OUTLIER_RATES))[None, :, None], found.shape), rtol=1e-12)


@pytest.mark.parametrize("name", ["extra-kernel-scale-f0", "extra-kernel-scale-f1"])
def test_an_infinite_width_has_a_tick_of_its_own_at_the_right_end(name, drawing_of):
    for ax in drawing_of(name).axes[::2]:
        label = ax.get_xticklabels()[-1]
        assert (label.get_text(), label.get_position()[0]) == ("∞", figures_scale.INFINITE_AT)
        assert any(figures_scale.INFINITE_AT in np.atleast_1d(line.get_xdata()) for line in ax.lines)


def test_the_forest_marks_the_published_improvements_and_ours(drawing_of):
    for ax in drawing_of("extra-forest").axes:
        diamonds = {float(x) for line in ax.lines if line.get_label() == "published" for x in line.get_xdata()}
        np.testing.assert_allclose(sorted(diamonds), [0.01, 0.63])
        ours = [line.get_xdata() for line in ax.lines if line.get_marker() == "o"]
        np.testing.assert_allclose(ours, np.full((3, 12), 0.5))


def test_what_is_worse_than_the_forest_shows_is_a_triangle_at_its_edge(results_for, outputs):
    worse = Output(pd.concat([score_rows(RUNS, 50.0, formulation=name, against="truth") for name in FORMULATIONS]))
    loaded = {MKMC: worse, CI: results_for(BY_NAME["extra-forest"]).output(CI)}
    with style.use():
        drawing = figures_filters.draw_forest(Results(SETTINGS, pd.DataFrame(), loaded.__getitem__), published=False)
    for ax in drawing.axes:
        triangles = [line for line in ax.lines if line.get_marker() == "<"]
        assert [len(line.get_xdata()) for line in triangles] == [12, 12, 12]
        assert {x for line in triangles for x in line.get_xdata()} == {ax.get_xlim()[0]}


def test_an_honest_filter_stays_in_the_bands(drawing_of):
    for ax in drawing_of("extra-consistency").axes:
        low, high = (ax.patches[0].get_bbox().y0, ax.patches[0].get_bbox().y1)
        assert len(ax.lines) == 1 + len(figures_filters.CONSISTENT)
        assert all(low <= value <= high for line in ax.lines for value in line.get_ydata())


def test_every_family_shows_sixteen_settings_and_the_chosen_one(drawing_of):
    panels_drawn = drawing_of("extra-tuning").axes
    assert len(panels_drawn) == len(FAMILIES)
    for ax in panels_drawn:
        assert len(ax.texts) == 16 and [text.get_text() for text in ax.texts].count("F") == 1
        (mark,) = ax.lines
        assert (mark.get_xdata()[0], mark.get_ydata()[0]) == (0, 0)


def test_labels_of_a_short_axis_do_not_touch():
    assert figures_sweeps.sparse_labels([1, 2, 5, 10, 50, 100]) == ["1", "2", "5", "10", "", "100"]


@pytest.mark.parametrize("name", ["figure-8-acceleration", "extra-tuning"])
def test_a_figure_is_the_same_bytes_twice_and_small(name, results_for, tmp_path):
    figure = BY_NAME[name]
    files = [tmp_path / f"{attempt}{figure.suffix}" for attempt in (1, 2)]
    for file in files:
        with style.use():
            style.save(figure.draw(results_for(figure)), file)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[0].stat().st_size < 250_000
