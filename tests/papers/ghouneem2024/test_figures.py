"""The wing's figures draw what the jobs hold, in the units they name, mark what the paper prints, and survive whatever fails.

The runs are fabricated, so that what a figure has to show is known; no filter runs.
"""

import re
from functools import cache
from itertools import product

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
from robins.papers.ghouneem2024 import figures_factorial, figures_gate, figures_plan, figures_sweeps, figures_traces, panels
from robins.papers.ghouneem2024.comparisons import attribution
from robins.papers.ghouneem2024.figures import FIGURES
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.gps import MISLEADING, MULTIPATH
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.studies import ALPHAS, AZIMUTH_ERRORS, CAUSES, PRIORS, SEVERITIES
from robins.papers.ghouneem2024.traces import SHOWN
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import CELLS
from robins.papers.ghouneem2024.variants import BASELINES, FACTORIAL, NEW, VARIANTS
from robins.papers.protocol import Output, Results, Settings
from robins.publish import style

RUNS = 6
MEASURES = dict(zip((*CHANNELS, "horizontal", "azimuth_unwrapped", "roughness"), (0.1, 2.0, 3.0, 0.5, 40.0, 30.0, 8.0, 50.0, 0.3, 0.01),
                    strict=True))  # fmt: skip
FACTORS = {NEW: 0.5, "ekf-pm": 0.8, "ekf-f": 0.6, "ukf": 0.6}
OF_OTHERS = {"figure-1", "figure-2"}  # schematics have tests of their own
BY_NAME = {figure.name: figure for figure in FIGURES}
NAMES = [name for name in BY_NAME if name not in OF_OTHERS]
COLOURS = {value.lower() for name, value in vars(style).items() if re.fullmatch("#[0-9A-F]{6}", str(value)) and name.isupper()}
GRID_PAPER_AND_REMARKS = {"#d9d9d9", "#ffffff", "#505050", figures_sweeps.SOME_FILL.lower()}
STUDIES = {"in-sample", "severity", "cause", "initialisation", "unscented", "ablations", "traces"}
OUTAGE = (100, 160)


def factor(name: str) -> float:
    return FACTORS.get(name, 1.0 + 0.01 * (sum(map(ord, name)) % 40) if name not in BASELINES else 1.0)


def score_rows(level: float, runs: int, failed, **labels) -> pd.DataFrame:
    """Rows of scores that are `level` times `MEASURES` in every run, whatever the run; `failed` runs have none."""
    lost = np.isin(np.arange(runs), failed)
    found = {name: np.where(lost, np.nan, level * value * (1.0 + 0.1 * np.arange(runs))) for name, value in MEASURES.items()}
    found["settled"] = np.where(lost, np.nan, 12.0)
    found |= {name: np.where(lost, np.nan, value) for name, value in (("nis", 6.0), ("nees_position", 3.0), ("nees_azimuth", 1.0))}
    counts = {"fixes": 1000, "rejected": 10, "longest_rejection": np.where(lost, 0, 3 + np.arange(runs))}
    return pd.DataFrame(
        {**labels, "run": 100 + np.arange(runs), **found, **counts, "failed": lost, "reason": np.where(lost, "diverged", "")}
    )


def study_labels(name: str) -> list[dict]:
    """The rows of a study, by labels."""
    if name == "in-sample":
        cells = ("none", *CELLS)
        return [{"trajectory": p, "filter": f, "cell": c} for p, f, c in product(TRAJECTORIES, ("ekf-pi", "ukf"), cells)]
    if name == "severity":
        return [{"trajectory": p, "severity": s, "filter": f} for p, s, f in product(TRAJECTORIES, SEVERITIES, figures_sweeps.SWEPT)]
    if name == "cause":
        kinds = [(f, "integrity", m) for f, m in product(FILTERS, (*figures_gate.MULTIPLES, np.inf))]
        kinds += [("physical", gate, np.inf) for gate in ("none", *figures_gate.NIS_GATES)]
        return [{"trajectory": p, "cause": c, "filter": f, "gate": g, "multiple": m}
                for p, c, (f, g, m) in product(TRAJECTORIES, CAUSES, kinds)]  # fmt: skip
    if name == "initialisation":
        started = [(f, OPTIONS["alpha"]) for f in FILTERS] + [("ukf", 1.0)]
        return [
            {"trajectory": p, "azimuth_error": e, "prior": b, "filter": f, "alpha": a}
            for p, e, b, (f, a) in product(TRAJECTORIES, AZIMUTH_ERRORS, PRIORS, started)
        ]
    if name == "unscented":
        kinds = [*product(ALPHAS, ("corrected", "printed"), (True,)), (OPTIONS["alpha"], "corrected", False)]
        return [{"trajectory": p, "alpha": a, "weights": w, "redrawn": r} for p, (a, w, r) in product(TRAJECTORIES, kinds)]
    tilts = ("as run", "tilt corrected", "tilt literal", "two dimensions")
    return [{"trajectory": p, "ablation": t, "filter": f} for p, t, f in product(TRAJECTORIES, tilts, ("riss-only", *FILTERS))]


def frozen_of(name: str) -> tuple[str, ...]:
    return TRAJECTORIES if VARIANTS[name].composition.get("cell", "none") != "none" else ("none",)


def traced(lost=()) -> Output:
    """Every filter is off by a constant; `lost` filters are so by 200 km from second 50 on, and NaN from 60 on."""
    arrays, seconds = {}, 300
    for place in TRAJECTORIES:
        time = np.arange(seconds + 1.0)
        truth = np.column_stack([8.0 * time, 3.0 * time, 100.0 + 0 * time, *np.full((3, time.size), 5.0), np.radians(-20.0 + 0.5 * time)])
        fix_time = time[(time < OUTAGE[0]) | (time > OUTAGE[1])][1:]
        arrays |= {f"{place}.time": time, f"{place}.truth": truth, f"{place}.fix_time": fix_time,
                   f"{place}.fixes": truth[fix_time.astype(int), :6], f"{place}.fix_cause": fix_time.astype(int) % 4}  # fmt: skip
        for i, name in enumerate(SHOWN):
            estimate = truth + 0.1 * (i + 1)
            if name in lost:
                estimate[50:60, 0], estimate[60:] = 2e5, np.nan
            arrays |= {f"{place}.{name}.estimate": estimate, f"{place}.{name}.deviation": np.full_like(truth, 0.2),
                       f"{place}.{name}.rejected": fix_time % 7 == 0}  # fmt: skip
    table = pd.DataFrame({"trajectory": TRAJECTORIES, "run": 103, "ratio": np.nan if NEW in lost else 0.25})
    return Output(table, arrays)


@cache
def fabricate(name: str, runs: int, failed: tuple[int, ...], lost: tuple[str, ...]) -> Output:
    """The output of a job in which the runs `failed` of the filters `lost` (all filters when empty) fail."""

    def rows_of(who: str, **labels) -> pd.DataFrame:
        return score_rows(factor(who), runs, failed if not lost or who in lost else (), **labels)

    if name == "traces":
        return traced(lost)
    if name in STUDIES:
        return Output(pd.concat([rows_of(labels.get("filter", "ukf"), **labels) for labels in study_labels(name)], ignore_index=True))
    return Output(pd.concat([rows_of(name, trajectory=p, frozen=f) for p, f in product(TRAJECTORIES, frozen_of(name))], ignore_index=True))


@pytest.fixture(scope="module")
def published(repository):
    return read_published(repository / "data" / "published" / "ghouneem2024.csv")


@pytest.fixture(scope="module")
def results_for(published):
    """``results_for(figure, runs, failed, lost)``: what the figure may read, which is what it says that it needs and nothing else."""

    def results(figure, runs=RUNS, failed=(), lost=()) -> Results:
        def allowed(name):
            assert name in figure.needs
            return fabricate(name, runs, failed, lost)

        sizes = {"runs": runs, "side_runs": runs, "in_sample_runs": runs, "bootstrap": 50}
        return Results(Settings("smoke", 1, sizes, OPTIONS), published, allowed)

    return results


def laid_out(figure, results) -> Figure:
    with style.use():
        drawing = figure.draw(results)
        FigureCanvasAgg(drawing).draw()
    return drawing


@pytest.fixture(scope="module")
def drawing_of(results_for):
    """``drawing_of(name)``: a figure, drawn and laid out once for all tests that look at it."""
    drawn = {}

    def drawing(name) -> Figure:
        if name not in drawn:
            drawn[name] = laid_out(BY_NAME[name], results_for(BY_NAME[name]))
        return drawn[name]

    return drawing


def texts_of(drawing: Figure) -> list[Text]:
    """Texts that a reader sees."""
    return [text for text in drawing.findobj(Text) if text.get_visible() and text.get_text().strip()]


def words_in(drawing: Figure) -> str:
    return " ".join(text.get_text() for text in texts_of(drawing))


def colours_of(drawing: Figure) -> set[str]:
    """Every colour of lines, fills and texts, opacity aside."""
    drawn = []
    for artist in drawing.findobj(lambda artist: artist.get_visible()):
        if isinstance(artist, Line2D):
            drawn += [artist.get_color()] if artist.get_linestyle() != "None" else []
            drawn += [artist.get_markerfacecolor(), artist.get_markeredgecolor()] if artist.get_marker() not in ("", "None", None) else []
        elif isinstance(artist, Patch | Collection):
            drawn += [artist.get_facecolor(), artist.get_edgecolor()]
        elif isinstance(artist, Text):
            drawn += [artist.get_color()]
    rows = np.vstack([to_rgba_array(colour) for colour in drawn if len(colour)])
    return {to_hex(row) for row in rows[rows[:, 3] > 0]}


def shows_numbers(ax: Axes, axis: str) -> bool:
    """Whether an axis shows numbers, and not names, or nothing because it shares another panel's."""
    if not getattr(ax, f"{axis}axis").get_tick_params().get({"x": "labelbottom", "y": "labelleft"}[axis], True):
        return False
    return any(re.fullmatch(r"[\d.−-]+", label.get_text()) for label in getattr(ax, f"get_{axis}ticklabels")())


def markers(ax: Axes, family: str, hollow: bool = False) -> list[float]:
    """x of the marks of a family in a panel."""
    look = panels.dot(family, hollow)
    face = look.get("markerfacecolor", look["color"])
    return [float(line.get_xdata()[0]) for line in ax.lines if len(line.get_xdata()) == 1
            and (line.get_marker(), line.get_color(), line.get_markerfacecolor()) == (look["marker"], look["color"], face)]  # fmt: skip


def diamonds(ax: Axes) -> list[float]:
    return [float(x) for line in ax.lines if line.get_label() == "published" for x in line.get_xdata()]


def test_the_papers_nine_figures_stand_in_its_order_before_those_of_the_study():
    assert list(BY_NAME)[:9] == [f"figure-{number}" for number in range(1, 10)]
    assert list(BY_NAME)[9] == "extra-forest-channels" and len(BY_NAME) == len(FIGURES)
    assert all(figure.location == ("extra" if figure.name.startswith("extra") else f"Figure {figure.name[-1]}") for figure in FIGURES)


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.name)
def test_a_figure_names_the_module_that_draws_it_and_needs_jobs_that_exist(figure):
    assert set(figure.needs) <= {*VARIANTS, *STUDIES}
    assert figure.modules == (getattr(figure.draw, "func", figure.draw).__module__,)
    assert figure.title and figure.caption


@pytest.mark.parametrize("name", NAMES)
def test_a_caption_says_runs_settings_and_what_its_bars_are(name):
    figure = BY_NAME[name]
    assert figure.size in ("runs", "side_runs", "in_sample_runs")
    assert re.search(r"[Rr]uns \d+ and up|The reporting run whose ratio", figure.caption)
    assert re.search("settings|[Dd]ata sheet's variances|Q, P0", figure.caption)
    assert re.search("bars?:|Lines: 95 %|Bands|One run shows|every run|Failed:", figure.caption)


@pytest.mark.parametrize("name", NAMES)
def test_every_axis_has_a_label_with_its_unit(name, drawing_of):
    for ax in drawing_of(name).axes:
        row = [other for other in ax.figure.axes if other.get_subplotspec().rowspan == ax.get_subplotspec().rowspan]
        words = {"x": ax.get_xlabel(), "y": " ".join(other.get_ylabel() for other in row)}
        for axis in ("x", "y"):
            if shows_numbers(ax, axis):
                said = words[axis] + getattr(ax.figure, f"get_sup{axis}label")()
                assert re.search(r"\((1|s|m|m/s|deg|fixes)\)", said), (name, axis)


@pytest.mark.parametrize("name", NAMES)
def test_a_figure_keeps_to_the_colours_sizes_and_frame_of_the_style(name, drawing_of):
    drawing = drawing_of(name)
    assert colours_of(drawing) <= COLOURS | GRID_PAPER_AND_REMARKS
    assert drawing.get_figwidth() <= style.WIDTH
    assert min(text.get_fontsize() for text in texts_of(drawing)) >= 8
    drawn, (width, height) = drawing.get_tightbbox(), drawing.get_size_inches()
    assert -0.01 <= drawn.x0 and drawn.x1 <= width + 0.01 and -0.01 <= drawn.y0 and drawn.y1 <= height + 0.01


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("runs", "failed", "lost"), [(1, (0,), ()), (3, (1,), (NEW, "ukf", "ekf-pi"))],
    ids=["one run that fails", "a run of some filters fails"],
)  # fmt: skip
def test_a_figure_survives_tiny_ensembles_and_says_which_runs_fail(name, runs, failed, lost, results_for):
    results = results_for(BY_NAME[name], runs, failed, lost)
    with style.use():
        drawing = BY_NAME[name].draw(results) if lost else laid_out(BY_NAME[name], results)
    silent = {*(f"figure-{number}" for number in range(3, 10)), "extra-initial-azimuth"}  # there a failed run never settles
    if failed and name not in silent:
        assert re.search(r"\bfail\b|no run survives", words_in(drawing))


def test_a_filter_that_fails_in_the_median_run_is_drawn_until_it_fails():
    arrays = traced(("ekf-pi",)).arrays
    kept = figures_traces.kept(arrays, "t1", "ekf-pi")
    assert np.isfinite(kept[:50]).all() and np.isnan(kept[50:]).all()
    np.testing.assert_array_equal(kept[:50], arrays["t1.ekf-pi.estimate"][:50])


def test_an_outage_is_a_stretch_without_fixes_and_the_longest_is_enlarged():
    found = figures_traces.outages(np.array([1.0, 2.0, 3.0, 9.0, 10.0]), 14.0)
    np.testing.assert_array_equal(found, [[3.0, 9.0], [10.0, 14.0]])
    arrays = traced().arrays
    first, last = OUTAGE[0] - 1, OUTAGE[1] + 1  # the last fix before and the first after it
    around = figures_traces.AROUND
    assert figures_traces.longest_outage(arrays, "t1") == (first - around, last + around)
    everywhere = arrays | {"t1.fix_time": arrays["t1.time"]}
    assert figures_traces.longest_outage(everywhere, "t1") == (0.0, 300.0)


def test_an_angle_that_crosses_north_is_not_joined():
    time, angle = figures_traces.unjoined(np.arange(4.0), np.array([350.0, 359.0, 3.0, 5.0]))
    np.testing.assert_array_equal(time, [0.0, 1.0, np.nan, 2.0, 3.0])
    np.testing.assert_array_equal(angle, [350.0, 359.0, np.nan, 3.0, 5.0])


@pytest.mark.parametrize("place", TRAJECTORIES)
def test_a_minute_of_latitude_is_a_nautical_mile_and_one_of_longitude_shorter_by_the_cosine(place):
    moved, origin = figures_plan.degrees(place, np.array([[1852.0, 1852.0], [0.0, 0.0]]))
    east, north = 60.0 * (moved - origin)
    assert north == pytest.approx(1.0, rel=0.006)  # the ellipsoid's flattening
    assert east * np.cos(np.radians(origin[1])) == pytest.approx(1.0, rel=0.006) and origin[0] == 0.0


def test_errors_are_estimate_minus_truth_and_the_mechanisation_has_its_own_axes(drawing_of):
    axes = np.reshape(drawing_of("figure-4").axes, (3, 2))
    for wide, narrow in axes:
        drawn = {line.get_label(): line.get_ydata() for line in wide.lines}
        for name in ("ekf-pi", "ekf-pm", NEW):
            np.testing.assert_allclose(drawn[panels.label_of(name)], 0.1 * (SHOWN.index(name) + 1), atol=1e-9)
        (alone,) = narrow.lines
        np.testing.assert_allclose(alone.get_ydata(), 0.1, atol=1e-9)


def test_the_azimuth_error_is_in_degrees_wrapped_above_and_not_below(drawing_of):
    above, alone, below = drawing_of("figure-8").axes
    drawn = {line.get_label(): line.get_ydata() for line in above.lines}
    np.testing.assert_allclose(drawn[panels.label_of(NEW)], np.degrees(0.4))
    np.testing.assert_allclose(alone.lines[0].get_ydata(), np.degrees(0.1))
    last = {line.get_label(): line.get_ydata() for line in below.lines}[panels.label_of(NEW)]
    assert {round(value) for value in last} == {round(np.degrees(0.4)), round(np.degrees(0.4)) - 360}


def test_the_azimuth_is_drawn_between_0_and_360(drawing_of):
    for ax in drawing_of("figure-7").axes:
        values = np.concatenate([line.get_ydata() for line in ax.lines])
        assert np.nanmin(values) >= 0.0 and np.nanmax(values) < 360.0


@pytest.mark.parametrize("place", TRAJECTORIES)
def test_the_forest_marks_the_published_ratio_of_every_channel(place, drawing_of, published):
    table = published[published["location"].str.fullmatch({"t1": "Table II", "t2": "Table III"}[place]) & (published["value"] != "")]
    ekf, new = (table[table["quantity"].str.endswith(method)]["value"].astype(float).to_numpy() for method in ("EKF", "New-Algorithm"))
    expected = [*(new / ekf), np.hypot(*new[4:6]) / np.hypot(*ekf[4:6])]  # latitude and longitude follow azimuth and three velocities
    ax = drawing_of("extra-forest-channels").axes[TRAJECTORIES.index(place)]
    np.testing.assert_allclose(diamonds(ax), expected)


def test_the_forest_shows_our_ratios_against_both_readings_of_the_ekf(drawing_of):
    for ax in drawing_of("extra-forest-channels").axes:
        for baseline, ratio in (("ekf-pi", 0.5), ("ekf-pm", 0.5 / 0.8)):
            for hollow in (False, True):
                np.testing.assert_allclose(markers(ax, baseline, hollow), [ratio] * (len(CHANNELS) + 1))


def test_the_factorial_shows_geometric_means_of_all_cells(drawing_of):
    mean = np.exp(np.mean(np.log(1.0 + 0.1 * np.arange(RUNS))))
    ax = drawing_of("extra-factorial").axes[0]
    assert len(markers(ax, "ekf-pi")) == len(markers(ax, "ekf-f")) == 4 and len(markers(ax, "ukf")) == 3
    np.testing.assert_allclose(markers(ax, "new"), [0.5 * MEASURES["horizontal"] * mean])
    assert sorted(diamonds(ax)) == pytest.approx(sorted([np.hypot(82.9741, 74.8394), np.hypot(36.2292, 48.747)]))


def test_the_two_halves_of_the_filters_share_add_up_to_it(results_for):
    results = results_for(BY_NAME["extra-attribution"])
    for baseline in BASELINES:
        halves = figures_factorial.split(results, baseline, "t1", "horizontal")
        whole = attribution(results, baseline, "t1").parts["filter"]
        assert halves["model"].estimate + halves["unscented transform"].estimate == pytest.approx(whole.estimate, rel=1e-12)
        by_cells = [np.log(factor(f"ukf{cell}") / factor(f"ekf-f{cell}")) for cell in ("", "-gate", "-st", "-st-gate")]
        assert halves["unscented transform"].estimate == pytest.approx(np.dot([1 / 3, 1 / 6, 1 / 6, 1 / 3], by_cells), rel=1e-9)


def test_a_fix_that_is_misleading_within_a_burst_counts_as_misleading():
    cause = np.array([0, MULTIPATH, MISLEADING, MULTIPATH | MISLEADING])
    assert [list(figures_gate.KINDS)[row] for row in figures_gate.kind_of(cause)] == ["clean", "multipath", "misleading", "misleading"]


def test_a_run_that_never_settles_is_drawn_as_never(results_for):
    figure = BY_NAME["extra-initial-azimuth"]
    drawing = laid_out(figure, results_for(figure, 3, (0, 1, 2), ("ekf-f",)))
    for ax in drawing.axes:
        drawn = {line.get_label(): np.asarray(line.get_ydata()) for line in ax.lines}
        assert (drawn[VARIANTS["ekf-f"].label] == figures_sweeps.NEVER).all() and (drawn[VARIANTS["ukf"].label] == 12.0).all()
    assert "never" in words_in(drawing)


def test_the_map_of_sigma_points_says_failures_in_words_and_dashes_what_was_not_run(results_for):
    figure = BY_NAME["extra-sigma-points"]
    for failed, words in (((), "0 of 3 fail"), ((1,), "1 of 3 fail"), ((0, 1, 2), "3 of 3 fail")):
        for ax in laid_out(figure, results_for(figure, 3, failed)).axes:
            said = [text.get_text() for text in ax.texts]
            assert sum(text.startswith(words) for text in said) == 2 * len(ALPHAS) + 1 and said.count("–") == len(ALPHAS) - 1


def test_an_infinite_interval_ends_at_the_axis_and_does_not_widen_it(results_for):
    drawing = laid_out(BY_NAME["extra-forest-channels"], results_for(BY_NAME["extra-forest-channels"], 1))
    for ax in drawing.axes:
        low, high = ax.get_xlim()
        assert 0.005 < low and high < 20.0
        ends = np.concatenate([bars.get_segments()[0][:, 0] for bars in ax.collections if hasattr(bars, "get_segments")])
        assert set(ends) == {low, high}


@pytest.mark.parametrize(("tick", "words"), [(0.5, "0.5"), (300.0, "300"), (1e4, "$10^{4}$"), (2e5, "$2·10^{5}$"), (1e-6, "$10^{-6}$")])
def test_a_tick_is_a_plain_number_or_a_power_of_ten_where_that_is_shorter(tick, words):
    assert panels.tick_words(tick) == words


@pytest.mark.parametrize("limits", [(0.9, 1.1), (0.2, 3.0), (0.01, 400.0), (1e-3, 1e6)])
def test_an_axis_of_ratios_holds_1_and_has_a_few_ticks(limits):
    ax = Figure().subplots()
    panels.ratio_axis(ax, limits)
    low, high = ax.get_xlim()
    assert low <= limits[0] and limits[1] <= high and low < 1.0 < high
    assert 2 <= len(ax.get_xticks()) <= 8


def test_every_cell_of_the_factorial_is_needed_by_its_figures():
    assert set(BY_NAME["extra-factorial"].needs) == set(BY_NAME["extra-attribution"].needs) == set(FACTORIAL)


@pytest.mark.parametrize("name", ["figure-5", "figure-9", "extra-forest-channels"])
def test_a_figure_is_the_same_bytes_twice_and_small(name, results_for, tmp_path):
    figure = BY_NAME[name]
    files = [tmp_path / f"{attempt}{figure.suffix}" for attempt in (1, 2)]
    for file in files:
        with style.use():
            style.save(figure.draw(results_for(figure)), file)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[0].stat().st_size < 150_000
