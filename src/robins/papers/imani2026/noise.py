"""Section 5 and Figure 6 of the paper: is the sensors' noise normal, and what would one record say of it?"""

from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from robins.diagnostics.pictures import histogram, quantile_plot
from robins.diagnostics.summary import COLUMNS, blanked
from robins.papers.columns import counts, keys, make, numbers, texts
from robins.papers.imani2026.ensemble import headline
from robins.papers.protocol import Figure, Results, Settings
from robins.publish import style

DIAGNOSED = "diagnose/drive"
AXES = "xyz"
PICTURED = 0
"""The axis that Figure 6 shows: x."""
SENSORS = {"accelerometer": (1.0, "m/s²", "s²/m"), "gyroscope": (1e3, "10⁻³ rad/s", "10³ s/rad")}
"""Factor on SI units, its unit and that of a density, for the figure."""
PRINTED = {
    "skewness": "skewness {:.2f}", "excess kurtosis": "excess kurtosis {:.2f}", "shapiro-wilk": "SW {:.3f}", "lilliefors": "KS {:.3f}",
}  # fmt: skip
"""Tests that stand in each panel, in the words of the paper."""
SPREAD = {
    "sample ": "median and central 95 % over n records of the gyroscope's law",
    "share of runs rejected, ": "share of n runs with p < 0.05, with Wilson's 95 % interval",
}
"""How the quantities of the theory job begin that belong here, and what their rows are."""
REACH = 7.0
"""Half the width of the densities' axis, in standard deviations; what lies beyond is in the Q-Q plots."""
SMALLEST = 1e-3
"""p values below it are shown as that: Lilliefors' table ends there."""


def noise_table(results: Results) -> pd.DataFrame:
    """Every test on every channel of run 0, then what records and runs show of moments and of the tests."""
    tested = results.table(DIAGNOSED).copy()
    tested["channel"] = [AXES[int(channel)] for channel in tested["channel"]]
    # Round-off decides a tail probability of 1e-60, which is no result.
    tested["p_value"] = tested["p_value"].where(tested["p_value"].isna() | (tested["p_value"] > 1e-12), 0.0)
    frames = [tested[list(COLUMNS)]]
    facts = results.table("theory")
    for beginning, note in SPREAD.items():
        found = facts[facts["quantity"].str.startswith(beginning)]
        named = {"value": "statistic", "low": "ci_low", "high": "ci_high", "quantity": "test"}
        frames.append(found.rename(columns=named).assign(series="ensemble", channel="any", p_value=np.nan, note=note)[list(COLUMNS)])
    return blanked(pd.concat(frames, ignore_index=True))


def true_law(settings: Settings, sensor: str, factor: float) -> SimpleNamespace:
    """The law that a sensor's noise is drawn from, with its density in the figure's unit."""
    sensors = headline(settings).sensors
    law, channel = {"accelerometer": (sensors.accelerometer_law, 0), "gyroscope": (sensors.gyroscope_law, 3)}[sensor]
    sd = factor * sensors.noise_sd(settings.options["rate_hz"])[channel]
    return SimpleNamespace(pdf=lambda x: law.pdf(x / sd) / sd)


def printed_tests(tested: pd.DataFrame, sensor: str) -> str:
    """Skewness, excess kurtosis, Shapiro-Wilk and Kolmogorov-Smirnov of the pictured channel, a line each."""
    rows = tested[(tested["series"] == sensor) & (tested["channel"].astype(int) == PICTURED)].set_index("test")
    lines = []
    for test, words in PRINTED.items():
        row = rows.loc[test]
        line = words.format(row["statistic"])
        if not np.isnan(row["p_value"]):
            line += f", p < {SMALLEST:g}" if row["p_value"] <= SMALLEST else f", p = {row['p_value']:.2g}"
        lines.append(line)
    return "\n".join(lines)


def draw_noise(results: Results) -> Drawing:
    """Figure 6: density (a, c) and normal Q-Q plot (b, d) of the accelerometer's and the gyroscope's noise."""
    arrays, tested = results.arrays("drive"), results.table(DIAGNOSED)
    figure = Drawing(figsize=(style.WIDTH, 5.6))
    for axes, letters, sensor in zip(figure.subplots(len(SENSORS), 2), ("ab", "cd"), SENSORS, strict=True):
        factor, unit, density = SENSORS[sensor]
        samples = factor * arrays[f"residual.{sensor}"][:, PICTURED]
        words = printed_tests(tested, sensor)
        draw_density(axes[0], samples, true_law(results.settings, sensor, factor))
        draw_quantiles(axes[1], samples)
        axes[0].set(xlabel=f"{sensor} noise ({unit})", ylabel=f"density ({density})", title=f"({letters[0]}) {sensor}: density")
        axes[1].set(xlabel="normal quantile (sd)", ylabel=f"ordered noise ({unit})", title=f"({letters[1]}) {sensor}: normal Q-Q")
        for ax in axes:
            ax.text(0.03, 0.98, words, transform=ax.transAxes, va="top", fontsize=7.5, linespacing=1.35)
    return figure


def draw_density(ax: Axes, samples: np.ndarray, law) -> None:
    """Histogram, fitted normal density and true density of the noise."""
    seen = histogram(samples, law)
    ax.stairs(seen.density, seen.edges, color=style.SKY, fill=True, alpha=0.55, label="run 0")
    ax.plot(seen.grid, seen.fitted, color=style.BLACK, linestyle="--", label="normal fit")
    ax.plot(seen.grid, seen.true, color=style.BLUE, label="true law")
    reach = REACH * samples.std(ddof=1)
    ax.set_xlim(-reach, reach)
    ax.legend(loc="upper right", handlelength=1.4, borderaxespad=0.1)


def draw_quantiles(ax: Axes, samples: np.ndarray) -> None:
    """Ordered noise over the quantiles of a normal law, with the line of the fitted one."""
    seen = quantile_plot(samples)
    ax.fill_between(seen.theoretical, seen.low, seen.high, color=style.BLACK, alpha=0.12, linewidth=0, label="95 % band")
    ax.plot(seen.theoretical, seen.ordered, linestyle="none", marker=".", markersize=2.5, color=style.BLUE, label="run 0")
    ax.plot(seen.theoretical, seen.line, color="red", label="normal fit")
    ax.legend(loc="lower right")


DIAGNOSTICS_TABLE = make(
    "extra-noise", "Noise of the sensors: normality, moments, whiteness", noise_table,
    (
        keys("series", "channel"), counts("n"), keys("test"), numbers("statistic", "p_value", "ci_low", "ci_high", kind="optional"),
        texts("note"),
    ),
    (DIAGNOSED, "theory"),
    "The noise alone, without bias, of run 0, in SI units; p values below 1e-12 are shown as 0. Skewness 2.64 and excess kurtosis 19.91 of "
    "the gyroscope are put in, so that normality is rejected follows from the construction (C5, C6). ensemble: the spread of the sample "
    "moments of one channel's record, and how often tests reject.",
)  # fmt: skip

DIAGNOSTICS_FIGURE = Figure(
    name="figure-6",
    title="Noise of accelerometer and gyroscope: density and normal Q-Q plot",
    location="Figure 6",
    draw=draw_noise,
    needs=("drive", DIAGNOSED),
    modules=(__name__,),
    caption="Simulated noise of run 0, x axis, 3300 samples at 10 Hz; the paper shows residuals of its recording. Histograms as densities "
    "with the normal fit and the law that the noise was drawn from, within 7 standard deviations; Q-Q plots with the pointwise 95 % band "
    "of the normal fit. SW: Shapiro-Wilk; KS: Kolmogorov-Smirnov with estimated parameters (Lilliefors). Skewness and excess kurtosis are "
    "of this one record; over records of its length they spread widely (extra-noise). The tests reject because the law was made so.",
)
