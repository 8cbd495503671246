"""Noise diagnostics of the simulated series: one table and one figure. The paper shows none."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as Drawing
from scipy import stats

from robins.diagnostics.pictures import pictures
from robins.diagnostics.summary import COLUMNS, blanked
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.scenario import BRANCHES, baseline
from robins.papers.protocol import Column, Figure, Results, Table
from robins.publish import style

NUMBERS = ("statistic", "p_value", "ci_low", "ci_high")
PICTURED = (
    ("process-noise", "w", "gust noise $w$"),
    ("fault-noise", "q", "pitch-rate noise with the fault"),
    ("differenced-noise", "q", r"differenced noise $\xi_q$"),
    ("correlated-error", "u", r"correlated error $\lambda_u$"),
)


def channel_names(series: str) -> list[str]:
    """States of a residual series' channels: those without process noise are not among its channels."""
    driven = np.array(baseline("deg").sigma_w) > 0
    return [state for state, kept in zip(STATES, driven, strict=True) if kept or series != "process-noise"]


def diagnostics_table(results: Results) -> pd.DataFrame:
    """Every test on every channel of every series of run 0."""
    frames = []
    for branch in BRANCHES:
        frame = results.table(f"diagnose/aircraft-{branch}").copy()
        names = [channel_names(series)[int(channel)] for series, channel in zip(frame["series"], frame["channel"], strict=True)]
        frames.append(frame.assign(branch=branch, channel=names))
    merged = pd.concat(frames, ignore_index=True)
    # Round-off decides an autocorrelation's sign or a tail probability of 1e-60; neither is a result.
    merged["p_value"] = merged["p_value"].where(merged["p_value"].isna() | (merged["p_value"] > 1e-12), 0.0)
    return blanked(merged[["branch", *COLUMNS]])


def draw_diagnostics(results: Results) -> Drawing:
    """Q-Q plot, histogram and autocorrelation of four series of run 0, deg branch, each over its sample deviation."""
    arrays = results.arrays("aircraft-deg")
    figure = Drawing(figsize=(style.WIDTH, 6.6))
    axes = figure.subplots(len(PICTURED), 3)
    look = style.family("differencing")
    for (quantiles, density, lags), (series, state, title) in zip(axes, PICTURED, strict=True):
        channel = channel_names(series).index(state)
        samples = arrays[f"residual.{series}"][:, channel]
        deviation = np.std(samples, ddof=1)
        law = stats.norm(0, arrays[f"sd.{series}"][channel] / deviation) if f"sd.{series}" in arrays else None
        seen = pictures(samples / deviation, float(arrays[f"rate_hz.{series}"]), law)
        q, h, a = seen.quantiles, seen.histogram, seen.autocorrelation
        quantiles.fill_between(q.theoretical, q.low, q.high, color="#000000", alpha=0.12, linewidth=0)
        quantiles.plot(q.theoretical, q.line, color="#000000", linewidth=0.8)
        quantiles.plot(q.theoretical, q.ordered, linestyle="none", marker=".", markersize=2.5, color=look["color"])
        quantiles.set(xlabel="normal quantile (sd)", ylabel="sample (sd)", title=title)
        density.stairs(h.density, h.edges, color=look["color"], fill=True, alpha=0.5)
        density.plot(h.grid, h.fitted, color="#000000", linewidth=0.9, label="fitted")
        if h.true is not None:
            density.plot(h.grid, h.true, color=style.family("published")["color"], linestyle=":", linewidth=1.4, label="true")
            density.set_ylim(top=1.4 * max(h.density.max(), h.true.max()))
            density.legend(loc="upper center", ncols=2)
        density.set(xlabel="sample (sd)", ylabel="density (1/sd)")
        lags.axhspan(-a.band, a.band, color="#000000", alpha=0.12, linewidth=0)
        lags.vlines(a.lags, 0, a.values, color=look["color"])
        lags.set(xlabel="lag (steps)", ylabel="autocorrelation (1)", ylim=(-0.65, 1.05))
    return figure


DIAGNOSTICS_TABLE = Table(
    name="extra-diagnostics",
    title="Noise diagnostics of the simulated series",
    location="extra",
    columns=(
        Column("branch", "key"), Column("series", "key"), Column("channel", "key"), Column("n", "count"), Column("test", "key"),
        *(Column(name, "optional", relative=1e-6) for name in NUMBERS), Column("note", "text"),
    ),
    build=diagnostics_table,
    needs=tuple(f"diagnose/aircraft-{branch}" for branch in BRANCHES),
    modules=(__name__,),
    caption="Run 0. Statistics and intervals in SI units where they have one; p-values below 1e-12 are shown as 0. "
    "The correlated error and the differenced noise are not white, so the p-values of their normality tests are too small. "
    "The fault noise is Gaussian with two variances, hence not Gaussian.",
)  # fmt: skip

DIAGNOSTICS_FIGURE = Figure(
    name="extra-diagnostics",
    title="Noise of run 0: quantiles, density, autocorrelation",
    location="extra",
    draw=draw_diagnostics,
    needs=("aircraft-deg",),
    modules=(__name__,),
    caption="Left: normal Q-Q plot with the pointwise 95 % band; middle: histogram, fitted normal density and, where it is "
    "known, the true one; right: autocorrelation with the 95 % band of white noise. One run of 201 epochs; substitute "
    "aircraft (F-4C), deg branch.",
)
