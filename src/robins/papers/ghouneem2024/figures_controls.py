"""Controls: the EKF with physical noise, the pitch behind the up velocity, and whether covariances are honest."""

import numpy as np
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from robins.evaluate.consistency import chi_square_band
from robins.papers.ghouneem2024.comparisons import HEADLINE, Where, mean_of, ratio_of, values, variant, where
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.panels import (
    LABELS,
    NAMES,
    PLACES,
    UNITS,
    Mark,
    decades,
    draw_marks,
    family_of,
    headline,
    key,
    label_of,
    name_rows,
    panel_title,
    published_rmse,
    ratio_axis,
    reach,
    spread_of,
)
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import NEW, VARIANTS
from robins.papers.protocol import Results
from robins.publish import style

CONTROLS = {
    "ekf-pi": "EKF, incremental",
    "ekf-pm": "EKF, memoryless",
    "ekf-f": "EKF, exact Jacobian",
    "ekf-f-physical": "physical Q",
    "ekf-f-nis": "physical Q, NIS gate",
    "ekf-f-nis-recovery": "physical Q, NIS gate,\nrecovery",
    "ekf-f-nis-recovery-r4": "physical Q, NIS gate,\nrecovery, R × 4",
    "gps-only": "GPS, last fix held",
    "riss-only": "RISS only",
}
CONTROL_NEEDS = (NEW, *CONTROLS)
MEASURES = ("horizontal", "azimuth", "height")


def draw_controls(results: Results) -> Drawing:
    """Errors of filters without tuning, and of no filter at all, over those of the new method."""
    figure = Drawing(figsize=(style.WIDTH, 7.0))
    for row, place in zip(figure.subplots(2, len(MEASURES), sharex="col", sharey=True), TRAJECTORIES, strict=True):
        for ax in row:
            name_rows(ax, list(CONTROLS.values()))
        row[0].set_ylabel(f"{PLACES[place]}, {results.settings.sizes['runs']} runs")
    for column, measure in zip(np.reshape(figure.axes, (2, -1)).T, MEASURES, strict=True):
        marks = {
            place: [
                Mark(row, ratio_of(results, variant(name, place), variant(NEW, place), measure), family_of(name))
                for row, name in enumerate(CONTROLS)
            ]
            for place in TRAJECTORIES
        }
        for ax, place in zip(column, TRAJECTORIES, strict=True):
            ratio_axis(ax, reach(sum(marks.values(), [])))
            draw_marks(ax, marks[place])
        panel_title(column[0], NAMES[measure])
    figure.supxlabel(f"RMSE over that of the new method with {HEADLINE.upper()}'s settings (1); left of 1 better than New", fontsize=LABELS)
    mark = key("truth", "geometric mean of the paired ratios, 95 % interval", marker="o")
    headline(figure, "Filters without tuning and without truth, over the new method", [mark])
    return figure


TILTS = {
    "as run": "as printed,\nsign of the axes repaired",
    "tilt corrected": "corrected: acceleration\nremoved",
    "tilt literal": "as printed, sign and all",
    "two dimensions": "no pitch, no roll",
}
PITCHED = ("riss-only", *FILTERS)
SHIFTS = dict(zip(PITCHED, (-0.32, -0.16, 0.0, 0.16, 0.32), strict=True))
VERTICAL = ("v_up", "height")
PRINTED = {"color": style.BLACK, "linewidth": 0.8, "marker": "D", "markersize": 5.5, "markerfacecolor": "white"}
PITCH_NEEDS = ("ablations",)


def draw_pitch(results: Results) -> Drawing:
    """Up velocity and altitude by reading of the pitch, every filter with the data sheet's variances."""
    figure = Drawing(figsize=(style.WIDTH, 6.4))
    for row, measure in zip(figure.subplots(2, 2, sharex="row", sharey=True), VERTICAL, strict=True):
        marks = {
            place: [
                Mark(i + shift, mean_of(results, where("ablations", trajectory=place, ablation=tilt, filter=name), measure), name)
                for i, tilt in enumerate(TILTS)
                for name, shift in SHIFTS.items()
            ]
            for place in TRAJECTORIES
        }
        printed = {p: [published_rmse(results, p, measure, method) for method in ("EKF", "New-Algorithm")] for p in TRAJECTORIES}
        limits = reach(sum(marks.values(), []), sum(printed.values(), []))
        for ax, place in zip(row, TRAJECTORIES, strict=True):
            decades(ax, "x", *limits)
            name_rows(ax, list(TILTS.values()))
            for value, line in zip(printed[place], ("-", "--"), strict=True):
                ax.axvline(value, color=style.BLACK, linewidth=0.8, linestyle=line, zorder=1)
            style.published_marker(ax, printed[place], [len(TILTS) - 0.5] * 2).set(clip_on=False)
            draw_marks(ax, marks[place])
            ax.set_xlabel(f"RMSE, {NAMES[measure]} ({UNITS[measure]})")
            panel_title(ax, PLACES[place], f"{results.settings.sizes['side_runs']} runs")
    handles = [key(name, label_of(name)) for name in PITCHED]
    handles += [Line2D([], [], linestyle=line, **PRINTED, label=f"published, {words}") for words, line in (("EKF", "-"), ("New", "--"))]
    headline(figure, "The pitch in (1) and what it does to up velocity and altitude", handles)
    return figure


CHECKED = (*FILTERS, NEW, "ekf-f-physical", "ekf-f-nis", "ekf-f-nis-recovery", "ekf-f-nis-recovery-r4")
CONSISTENCY = {"nis": ("NIS of accepted fixes", 6), "nees_position": ("NEES of position", 3), "nees_azimuth": ("NEES of azimuth", 1)}
"""Words and degrees of freedom."""


def run_means(results: Results, at: Where, measure: str):
    """The spread of the runs' means; a run without an accepted fix has none."""
    return spread_of(*values(results, at, measure))


def draw_consistency(results: Results) -> Drawing:
    """NIS and NEES of every filter on both trajectories against what an honest filter has."""
    figure = Drawing(figsize=(style.WIDTH, 7.0))
    axes = figure.subplots(2, len(CONSISTENCY), sharex="col", sharey=True)
    labels = [words_of(name) for name in CHECKED]
    for column, (measure, (words, dof)) in zip(axes.T, CONSISTENCY.items(), strict=True):
        marks = {
            place: [Mark(row, run_means(results, variant(name, place), measure), family_of(name)) for row, name in enumerate(CHECKED)]
            for place in TRAJECTORIES
        }
        band = chi_square_band(dof, 1)
        limits = reach(sum(marks.values(), []), [band.low, band.high] if dof > 1 else [dof, band.high])
        for ax, place in zip(column, TRAJECTORIES, strict=True):
            decades(ax, "x", *limits)
            name_rows(ax, labels)
            ax.axvspan(band.low, band.high, color=style.BLACK, alpha=0.12, linewidth=0, zorder=0)
            ax.axvline(dof, color=style.BLACK, linewidth=0.8, zorder=1)
            draw_marks(ax, marks[place])
        panel_title(column[0], words)
        column[1].set_xlabel("mean of a run (1)")
    for ax, place in zip(axes[:, 0], TRAJECTORIES, strict=True):
        ax.set_ylabel(f"{PLACES[place]}, {results.settings.sizes['runs']} runs")
    band = Patch(color=style.BLACK, alpha=0.12, linewidth=0, label="95 % of one chi-square value; line: its mean")
    mark = key("truth", "median of the runs, 5 % to 95 % of them", marker="o")
    headline(figure, f"Consistency; New with {HEADLINE.upper()}'s settings", [mark, band], columns=2)
    return figure


def words_of(name: str) -> str:
    """A variant's label in two lines."""
    return CONTROLS.get(name, {NEW: "New", "ukf": VARIANTS["ukf"].label}.get(name, ""))
