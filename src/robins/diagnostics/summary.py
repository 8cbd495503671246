"""All diagnostics of a series, as one tidy table."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from robins.diagnostics.allan import allan_findings
from robins.diagnostics.finding import Finding, checked
from robins.diagnostics.moments import skewness_and_kurtosis
from robins.diagnostics.normality import jarque_bera, kolmogorov_smirnov, lilliefors, shapiro_wilk
from robins.diagnostics.whiteness import first_lag, ljung_box

COLUMNS = ("series", "channel", "n", "test", "statistic", "p_value", "ci_low", "ci_high", "note")
"""Columns of the table, in order."""

INDEPENDENCE_TESTS = ("shapiro-wilk", "kolmogorov-smirnov", "lilliefors", "jarque-bera")
"""Tests whose p-value assumes independent samples."""


def diagnose_channel(samples, rate_hz: float, law, generator: np.random.Generator, block: int | None = None) -> list[Finding]:
    """Every test on one channel, shape (N,); see `diagnose`."""
    samples = checked(samples)
    whiteness = ljung_box(samples)
    findings = [shapiro_wilk(samples, generator)]
    if law is not None:
        findings.append(kolmogorov_smirnov(samples, law))
    findings += [lilliefors(samples), jarque_bera(samples), *skewness_and_kurtosis(samples, generator, block)]
    findings += [first_lag(samples), whiteness, *allan_findings(samples, rate_hz)]
    caveats = []
    if whiteness.p_value < 0.05:
        caveats.append("autocorrelated: p-value too small")
    if (distinct := np.unique(samples).size) < samples.size // 10:
        caveats.append(f"quantised to {distinct} values")
    return [with_caveats(finding, caveats) if finding.test in INDEPENDENCE_TESTS else finding for finding in findings]


def with_caveats(finding: Finding, caveats: Sequence[str]) -> Finding:
    """`finding` with `caveats` added to its note."""
    return finding._replace(note="; ".join(filter(None, [finding.note, *caveats])))


def diagnose(
    name: str,
    samples,
    rate_hz: float,
    law=None,
    *,
    generator: np.random.Generator,
    channels: Sequence[str] | None = None,
    block: int | None = None,
) -> pd.DataFrame:
    """Normality, moments, whiteness and Allan deviation of every channel of a series.

    Parameters
    ----------
    name : str
        Name of the series, for the column ``series``.
    samples : array, shape (N,) or (N, n)
        Time first; evenly sampled, finite, 8 or more.
    rate_hz : float
        Sampling rate [Hz].
    law : frozen scipy distribution, or one for each channel, optional
        The law that the samples are known to have; adds the Kolmogorov-Smirnov test with known parameters.
    generator : Generator
        A stream of its own: it draws Shapiro-Wilk's subsample and the bootstrap of the moments, channel by channel.
    channels : sequence of str, optional
        Names of the channels; ``"0"``, ``"1"``, ... by default.
    block : int, optional
        Block of the bootstrap, in samples: longer than the memory of the series.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`, one row for each channel and test, in the unit of the samples; intervals at 95 %. A number
        that a test does not have is NaN here and an empty cell once written.

    Raises
    ------
    ValueError
        A channel is too short, constant or not finite; the message names the series and the channel.
    """
    samples = np.asarray(samples, dtype=float)
    samples = samples[:, None] if samples.ndim == 1 else samples
    channels = [str(i) for i in range(samples.shape[1])] if channels is None else list(channels)
    laws = list(law) if isinstance(law, Sequence) else [law] * samples.shape[1]
    rows = []
    for channel, values, known in zip(channels, samples.T, laws, strict=True):
        try:
            findings = diagnose_channel(values, rate_hz, known, generator, block)
        except ValueError as error:
            raise ValueError(f"{name}, channel {channel}: {error}") from error
        rows += [{"series": name, "channel": channel, **finding._asdict()} for finding in findings]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def blanked(frame: pd.DataFrame) -> pd.DataFrame:
    """`frame` with empty text in place of NaN, as published tables want it; columns without NaN keep their type."""
    missing = frame.columns[frame.isna().any()]
    return frame.assign(**{name: frame[name].astype(object).where(frame[name].notna(), "") for name in missing})
