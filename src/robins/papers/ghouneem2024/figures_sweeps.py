"""Studies: severity of the environment, wrong initial azimuth, and spread and weights of the sigma points."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from robins.papers.ghouneem2024.comparisons import mean_of, rows, values, where
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.palette import look
from robins.papers.ghouneem2024.panels import (
    LABELS,
    NAMES,
    PLACES,
    SMALL,
    UNITS,
    Mark,
    decades,
    family_of,
    headline,
    label_of,
    lost,
    panel_title,
    plain_ticks,
    reach,
    spread_of,
)
from robins.papers.ghouneem2024.studies import ALPHAS, AZIMUTH_ERRORS, DATA_SHEET, SEVERITIES
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import NEW
from robins.papers.protocol import Results
from robins.publish import style

SWEPT = (*FILTERS, NEW, "ekf-f-nis-recovery")
WIDTHS = {"ekf-f": 2.4, "ukf": 1.0}
"""The EKF with the exact Jacobian is wider than the UKF before it, so that both are seen where they coincide."""
MEASURES = ("horizontal", "height")


def line_of(name: str, **changes) -> dict:
    """Colour, style, marker and label of a variant: keywords for ``Axes.plot``."""
    found = look(family_of(name)) | {"label": label_of(name), "linewidth": WIDTHS.get(name, 1.3), "markersize": 5.5}
    return found | changes


def draw_severity(results: Results) -> Drawing:
    """Horizontal and altitude errors over the severity of the environment."""
    figure = Drawing(figsize=(style.WIDTH, 5.8))
    for row, measure in zip(figure.subplots(2, 2, sharex=True, sharey="row"), MEASURES, strict=True):
        found = {
            (place, name): [mean_of(results, where("severity", trajectory=place, severity=x, filter=name), measure) for x in SEVERITIES]
            for place in TRAJECTORIES
            for name in SWEPT
        }
        marks = [Mark(0.0, each, "truth") for several in found.values() for each in several]
        decades(row[0], "y", *reach(marks))
        for ax, place in zip(row, TRAJECTORIES, strict=True):
            for i, name in enumerate(SWEPT):
                severity_curve(ax, found[place, name], name, 0.012 * (i - len(SWEPT) / 2))
            count_failures(ax, np.max([[lost(each) for each in found[place, name]] for name in SWEPT], axis=0))
            panel_title(ax, PLACES[place], f"{results.settings.sizes['side_runs']} runs")
        row[0].set_ylabel(f"RMSE, {NAMES[measure]} ({UNITS[measure]})")
    plain_ticks(figure.axes[0], "x", SEVERITIES)
    figure.supxlabel("severity: events a run, as a share of the frozen environment's (1)", fontsize=LABELS)
    headline(figure, "Severity of the environment", [Line2D([], [], **line_of(name)) for name in SWEPT])
    return figure


def count_failures(ax: Axes, worst: np.ndarray) -> None:
    """At each severity the most runs that any one filter loses, where there are any."""
    for severity, failed in zip(SEVERITIES, worst, strict=True):
        if failed:
            ax.annotate(f"≤ {failed} fail", (severity, 0.99), xycoords=("data", "axes fraction"), fontsize=SMALL, ha="center", va="top")


def severity_curve(ax: Axes, found: list, name: str, shift: float) -> None:
    """Geometric means with intervals, moved aside by `shift` so that these do not cover each other; a gap where every run fails."""
    x = np.array(SEVERITIES) + shift
    ax.plot(x, [each.estimate for each in found], **line_of(name), zorder=3)
    low, high = np.clip(np.array([[each.low, each.high] for each in found]).T, *ax.get_ylim())
    ax.vlines(x, low, high, color=look(family_of(name))["color"], linewidth=0.9, zorder=2)


NEVER = 6000.0
"""Where "never" is drawn, above the last second of the axis."""
TIMES = (0, 1, 3, 10, 30, 100, 300, 1000)
STARTED = {(name, None): {} for name in FILTERS} | {("ukf", 1.0): {"label": "UKF, α = 1", "marker": "x", "linestyle": ":", "zorder": 5}}


def draw_initialisation(results: Results) -> Drawing:
    """Seconds from the first motion until the azimuth has settled, over its initial error."""
    figure = Drawing(figsize=(style.WIDTH, 4.2))
    for ax, place in zip(figure.subplots(1, 2, sharey=True), TRAJECTORIES, strict=True):
        ax.set_yscale("symlog", linthresh=1.0, linscale=0.4)
        for i, ((name, alpha), changes) in enumerate(STARTED.items()):
            settling_curve(ax, results, place, name, alpha or results.settings.options["alpha"], changes, 2.0 * (i - 2))
        ax.axhline(NEVER / 2.2, color=style.BLACK, linewidth=0.6, linestyle=(0, (2, 2)), zorder=1)
        ax.set(xlabel="initial error of the azimuth (deg)", ylim=(-0.3, NEVER * 1.5), xlim=(-8, 188))
        plain_ticks(ax, "x", np.degrees(AZIMUTH_ERRORS).round())
        plain_ticks(ax, "y", (*TIMES, NEVER), [*map(str, TIMES), "never"])
        panel_title(ax, PLACES[place], f"{results.settings.sizes['side_runs']} runs")
    figure.axes[0].set_ylabel("first motion until |azimuth error| stays < 5° (s)")
    handles = [Line2D([], [], **line_of(name, **changes)) for (name, _), changes in STARTED.items()]
    headline(figure, "Convergence from a wrong azimuth, clean satellites", handles)
    return figure


def settling_curve(ax: Axes, results: Results, place: str, name: str, alpha: float, changes: dict, shift: float) -> None:
    """Median over the runs with 5 % to 95 % of them; a run that fails never settles."""
    found = []
    for error in AZIMUTH_ERRORS:
        settled, failed = values(
            results, where("initialisation", trajectory=place, azimuth_error=error, prior=DATA_SHEET, filter=name, alpha=alpha), "settled"
        )
        found.append(spread_of(np.where(failed, np.inf, settled), np.zeros(len(settled), bool)))
    low, middle, high = np.minimum([[each.low, each.estimate, each.high] for each in found], NEVER).T
    x = np.degrees(AZIMUTH_ERRORS) + shift
    ax.plot(x, middle, **line_of(name, **changes))
    ax.vlines(x, low, high, color=look(name)["color"], linewidth=0.9)


WEIGHTS = {("corrected", True): "corrected", ("printed", True): "as printed (18)", ("corrected", False): "corrected,\npoints not redrawn"}
FAILED_FILL, SOME_FILL = style.VERMILLION, "#F6C9A8"
UNSCENTED_LABELS = ["trajectory", "alpha", "weights", "redrawn"]


def draw_sigma_points(results: Results) -> Drawing:
    """Failed runs and horizontal error of the UKF by spread of the sigma points and form of the weights."""
    figure = Drawing(figsize=(style.WIDTH, 3.5))
    for ax, place in zip(figure.subplots(1, 2, sharey=True), TRAJECTORIES, strict=True):
        for row, (weights, redrawn) in enumerate(WEIGHTS):
            for column, alpha in enumerate(ALPHAS):
                draw_cell(ax, column, row, results, {"trajectory": place, "alpha": alpha, "weights": weights, "redrawn": redrawn})
        ax.set(xlim=(-0.5, len(ALPHAS) - 0.5), ylim=(len(WEIGHTS) - 0.5, -0.5), xlabel="spread of the sigma points α (1)")
        plain_ticks(ax, "x", range(len(ALPHAS)), [f"{alpha:g}" for alpha in ALPHAS])
        ax.set_yticks(range(len(WEIGHTS)), list(WEIGHTS.values()))
        ax.grid(False)
        ax.tick_params(length=0)
        ax.spines[:].set_visible(False)
        panel_title(ax, PLACES[place], f"{results.settings.sizes['side_runs']} runs")
    figure.axes[0].set_ylabel("weight of the centre point")
    fills = {"no run fails": "white", "some fail": SOME_FILL, "every run fails": FAILED_FILL}
    handles = [Rectangle((0, 0), 1, 1, facecolor=fill, edgecolor=style.GREY, linewidth=0.7, label=words) for words, fill in fills.items()]
    headline(figure, "Where the UKF keeps its covariance: failed runs, and horizontal RMSE of the others", handles)
    return figure


def draw_cell(ax: Axes, column: int, row: int, results: Results, labels: dict) -> None:
    """One setting: its failed runs in words and colour, and the geometric mean of the error; a dash where it was not run."""
    table = results.table("unscented")
    if not (table[UNSCENTED_LABELS] == [labels[name] for name in UNSCENTED_LABELS]).all(axis=1).any():
        ax.text(column, row, "–", ha="center", va="center", fontsize=SMALL, color="#505050")
        return
    at = where("unscented", **labels)
    found, n = mean_of(results, at, "horizontal"), len(rows(results, at))
    fill = FAILED_FILL if found.failed == n else SOME_FILL if found.failed else "white"
    ax.add_patch(Rectangle((column - 0.47, row - 0.45), 0.94, 0.9, facecolor=fill, edgecolor=style.GREY, linewidth=0.7))
    error = f"\n{found.estimate:.2f} m" if np.isfinite(found.estimate) else ""
    ax.text(column, row, f"{found.failed} of {n} fail{error}", ha="center", va="center", fontsize=SMALL)
