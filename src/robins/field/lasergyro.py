"""The laser-gyro recording against the earth: gravity, earth rate, heading, and what kind of noise its gyros have.

The vehicle is parked but not still: wind and people rock it, most in the first 15 minutes. What is compared with theory
is therefore the quiet part, and its noise is the sensor's and the rocking together. It is one recording: nothing here
has an ensemble behind it, so no number but a diagnostic has an interval.
"""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from robins.diagnostics.allan import NOISE_NAMES, allan_deviation, averaging_factors
from robins.diagnostics.pictures import Pictures, pictures
from robins.diagnostics.summary import blanked, diagnose
from robins.field import psins
from robins.field.gyrocompass import gyrocompass
from robins.foundation import earth
from robins.publish import style

QUIET = (900.0, 1650.0)
"""First and last time stamp of the quiet part [s]."""

CHANNELS = ("right", "forward", "up")

BLOCK_SECONDS = 2.0
"""Block of the bootstrap of the moments: a few periods of the rocking, whose autocorrelation swings about once in 0.4 s."""

ALLAN_SECONDS = 100.0
"""Averaging time at which the disjoint estimator stands beside the overlapping one."""

DEGREE_PER_HOUR = np.radians(1.0) / 3600
ONE = "one recording"


def tables(path, generator: np.random.Generator) -> dict[str, pd.DataFrame]:
    """The tables of the recording at `path`, ready to be written: degrees, deg/h, empty text for a missing number.

    Parameters
    ----------
    path : Path
        The recording (`robins.field.psins.locate`).
    generator : Generator
        A stream of its own, for subsample and bootstrap.

    Returns
    -------
    dict of str to DataFrame
        ``extra-alignment`` (key: quantity), ``extra-diagnostics`` (key: series, channel, test) and ``extra-allan``
        (key: estimator, channel, tau [s]).
    """
    recording = psins.read(path)
    quiet = recording.between(*QUIET)
    return {
        "extra-alignment": alignment_table(recording, quiet),
        "extra-diagnostics": blanked(diagnostics_table(quiet, generator)),
        "extra-allan": allan_table(quiet),
    }


def alignment_table(recording: psins.Recording, quiet: psins.Recording) -> pd.DataFrame:
    """What the unit senses of the earth beside what the earth has.

    Columns quantity, unit, ours, expected, difference (ours less expected), expected_from, note.
    """
    gravity = float(earth.normal_gravity(recording.latitude, recording.height))
    _, north_rate, up_rate = earth.earth_rate_n(recording.latitude) / DEGREE_PER_HOUR
    whole, still = (gyrocompass(part.rate_b, part.specific_force_b) for part in (recording, quiet))
    mean_magnitude = float(np.linalg.norm(recording.specific_force_b, axis=1).mean())
    heading, whole_heading, header_heading = np.degrees([still.heading, whole.heading, -recording.yaw])
    normal, header = "WGS-84 normal gravity", "the file's header, rough"
    span = f"{QUIET[0]:g} to {QUIET[1]:g} s"
    rows = [
        ("magnitude of the mean specific force, whole record", "m/s^2", whole.specific_force, gravity, normal, ""),
        (f"magnitude of the mean specific force, {span}", "m/s^2", still.specific_force, gravity, normal, ""),
        ("mean of the magnitudes, whole record", "m/s^2", mean_magnitude, gravity, normal, "too long: noise adds to every magnitude"),
        (f"rate along up, {span}", "deg/h", still.up_rate / DEGREE_PER_HOUR, up_rate, "earth rate x sin(latitude)", ""),
        (f"horizontal rate, {span}", "deg/h", still.horizontal_rate / DEGREE_PER_HOUR, north_rate, "earth rate x cos(latitude)", ""),
        (f"heading of forward, clockwise from north, {span}", "deg", heading, header_heading, header, ""),
        ("heading of forward, clockwise from north, whole record", "deg", whole_heading, header_heading, header, "disturbed"),
    ]
    names = ["quantity", "unit", "ours", "expected", "expected_from", "note"]
    frame = pd.DataFrame([dict(zip(names, row, strict=True)) for row in rows])
    frame.insert(4, "difference", frame.ours - frame.expected)
    frame["note"] = ["; ".join(filter(None, [ONE, note])) for note in frame.note]
    return frame


def diagnostics_table(quiet: psins.Recording, generator: np.random.Generator) -> pd.DataFrame:
    """Every diagnostic of the gyros [deg/h] and accelerometers (m/s^2) in the quiet part."""
    rate_hz, block = 1 / quiet.interval, round(BLOCK_SECONDS / quiet.interval)
    series = {"gyro (deg/h)": quiet.rate_b / DEGREE_PER_HOUR, "accelerometer (m/s^2)": quiet.specific_force_b}
    return pd.concat(
        [diagnose(name, samples, rate_hz, generator=generator, channels=CHANNELS, block=block) for name, samples in series.items()],
        ignore_index=True,
    )


def allan_table(quiet: psins.Recording) -> pd.DataFrame:
    """Allan deviation of the gyros in the quiet part: columns estimator, channel, tau [s], deviation, low, high, unit, noise.

    The disjoint estimator has six differences at 100 s and catches the rocking at one phase; the overlapping one averages
    over the phases. Where they are far apart, as here, neither is the bare sensor's.
    """
    rate_hz = 1 / quiet.interval
    estimators = {"overlapping": averaging_factors(len(quiet.time)), "disjoint": [round(ALLAN_SECONDS * rate_hz)]}
    rows = []
    for estimator, factors in estimators.items():
        for channel, rate in zip(CHANNELS, quiet.rate_b.T / DEGREE_PER_HOUR, strict=True):
            curve = allan_deviation(rate, rate_hz, factors, overlapping=estimator == "overlapping")
            frame = pd.DataFrame({"tau": curve.tau, "deviation": curve.deviation, "low": curve.low, "high": curve.high, "unit": "deg/h"})
            frame["noise"] = [NOISE_NAMES[exponent] for exponent in curve.exponent]
            rows.append(frame.assign(estimator=estimator, channel=channel))
    return pd.concat(rows, ignore_index=True)[["estimator", "channel", "tau", "deviation", "low", "high", "unit", "noise"]]


def figures(path) -> dict[str, Figure]:
    """The figures of the recording at `path`: ``extra-residuals`` and ``extra-allan``."""
    quiet = psins.read(path).between(*QUIET)
    drawn = [pictures(rate, 1 / quiet.interval) for rate in quiet.rate_b.T / DEGREE_PER_HOUR]
    with style.use():
        return {"extra-residuals": draw_residuals(drawn, quiet.interval), "extra-allan": draw_allan(drawn)}


def draw_residuals(drawn: list[Pictures], interval: float) -> Figure:
    """One row for each gyro: Q-Q plot, histogram on a logarithmic axis, autocorrelation."""
    figure = Figure(figsize=(style.WIDTH, 6.6))
    axes = figure.subplots(3, 3)
    for (left, middle, right), channel, picture in zip(axes, CHANNELS, drawn, strict=True):
        draw_quantiles(left, picture)
        draw_histogram(middle, picture)
        draw_autocorrelation(right, picture, interval)
        left.set_ylabel(f"{channel} gyro (deg/h)")
    for axis, title in zip(axes[0], ("normal Q-Q", "density (h/deg)", "autocorrelation"), strict=True):
        axis.set_title(title)
    for axis, label in zip(axes[-1], ("standard normal quantile", "rate (deg/h)", "lag (s)"), strict=True):
        axis.set_xlabel(label)
    axes[0, 0].legend(loc="upper left")
    axes[0, 1].legend(loc="upper left")
    return figure


def draw_quantiles(axis, picture: Pictures) -> None:
    """Q-Q plot with the pointwise band of the fitted normal law."""
    quantiles = picture.quantiles
    axis.fill_between(quantiles.theoretical, quantiles.low, quantiles.high, color=style.GREY, alpha=0.4, linewidth=0, label="95 % band")
    axis.plot(quantiles.theoretical, quantiles.line, color=style.BLACK, linewidth=0.8, label="fitted normal")
    axis.plot(quantiles.theoretical, quantiles.ordered, ".", color=style.BLUE, markersize=2.5, label="samples")


def draw_histogram(axis, picture: Pictures) -> None:
    """Histogram with the fitted normal density; logarithmic, so that the tails show."""
    bars = picture.histogram
    axis.stairs(bars.density, bars.edges, fill=True, color=style.SKY, alpha=0.6, label="samples")
    axis.plot(bars.grid, bars.fitted, color=style.BLACK, linewidth=0.9, label="fitted normal")
    axis.set_yscale("log")
    axis.set_ylim(0.5 * bars.density[bars.density > 0].min(), 200 * bars.density.max())


def draw_autocorrelation(axis, picture: Pictures, interval: float) -> None:
    """Autocorrelation over the lag, with the band that white noise keeps to."""
    correlation = picture.autocorrelation
    axis.axhspan(-correlation.band, correlation.band, color=style.GREY, alpha=0.4, linewidth=0)
    axis.axhline(0, color=style.BLACK, linewidth=0.6)
    axis.vlines(correlation.lags[1:] * interval, 0, correlation.values[1:], color=style.BLUE)
    axis.set_ylim(-1, 1)


def draw_allan(drawn: list[Pictures]) -> Figure:
    """Overlapping Allan deviation of the three gyros, with the slopes of quantisation, white noise and random walk."""
    figure = Figure(figsize=(style.WIDTH, 4.0))
    axis = figure.subplots()
    looks = zip(CHANNELS, drawn, (style.BLUE, style.VERMILLION, style.GREEN), ("o", "s", "^"), strict=True)
    for channel, picture, color, marker in looks:
        curve = picture.allan
        axis.fill_between(curve.tau, curve.low, curve.high, color=color, alpha=0.2, linewidth=0)
        axis.plot(curve.tau, curve.deviation, color=color, marker=marker, label=f"{channel} gyro")
    start, level, decade = 0.02, 0.5, 10.0
    for slope, name in ((-1.0, "-1 quantisation"), (-0.5, "-1/2 white noise"), (0.5, "+1/2 random walk")):
        end = (start * decade, level * decade**slope)
        axis.plot([start, end[0]], [level, end[1]], color=style.GREY, linestyle=":")
        axis.annotate(name, end, xytext=(4, 0), textcoords="offset points", color=style.GREY, va="center")
    axis.set(xscale="log", yscale="log", xlabel="averaging time (s)", ylabel="Allan deviation (deg/h)")
    axis.legend(loc="upper right")
    return figure
