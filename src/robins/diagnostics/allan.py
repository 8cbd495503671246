"""Allan deviation with confidence intervals, through allantools.

The input is the rate itself (a gyro's angular rate, an accelerometer's specific force), in any unit; the deviation has
that unit. Slopes in log-log over the averaging time tau: quantisation -1, white noise -1/2, bias instability 0, rate
random walk +1/2 [1]_.

References
----------
.. [1] IEEE Std 952-1997, annex C.
.. [2] Riley and Howe, Handbook of Frequency Stability Analysis, NIST SP 1065 (2008), sections 5.2 and 5.3.
"""

from typing import NamedTuple

import allantools
import numpy as np

from robins.diagnostics.finding import LEVEL, Finding, checked

NOISE_NAMES = {0: "white", -1: "flicker", -2: "random walk"}
"""Names of the power-law exponents alpha of the rate's spectral density f^alpha that an interval may be based on."""

SHORTEST_FOR_IDENTIFICATION = 30
"""Averages below which the noise type cannot be told ([2]_, section 5.5.6)."""


class AllanCurve(NamedTuple):
    """Allan deviation over averaging time.

    Attributes
    ----------
    tau : array, shape (K,)
        Averaging times [s].
    deviation, low, high : array, shape (K,)
        Deviation, and its interval at 95 %, in the unit of the samples.
    exponent : array of int, shape (K,)
        Power-law exponent on which the interval's degrees of freedom are based, see `NOISE_NAMES`.
    """

    tau: np.ndarray
    deviation: np.ndarray
    low: np.ndarray
    high: np.ndarray
    exponent: np.ndarray


def averaging_factors(n: int) -> np.ndarray:
    """1, 2, 5, 10, 20, ... samples, up to a fifth of `n`."""
    grid = np.outer(10 ** np.arange(int(np.log10(n)) + 1), [1, 2, 5]).ravel()
    return grid[grid <= n // 5]


def identified_exponents(samples, factors) -> list[int]:
    """Power-law exponent at each averaging factor (lag-1 autocorrelation method), from -2 to 0.

    Where fewer than 30 averages are left, the exponent of the last factor that could be judged stands; white if none.
    Exponents above 0 (quantisation, a rocking that averages out) count as white: theirs would be degrees of freedom in
    number of samples, not of averages, an accuracy of a percent from seven averages that no record of mixed noise has.
    """
    exponents = []
    for factor in factors:
        previous = exponents[-1] if exponents else 0
        enough = samples.size // factor >= SHORTEST_FOR_IDENTIFICATION
        exponents.append(int(np.clip(allantools.autocorr_noise_id(samples, factor, data_type="freq")[0], -2, 0)) if enough else previous)
    return exponents


def allan_deviation(samples, rate_hz: float, factors=None, overlapping: bool = True) -> AllanCurve:
    """Allan deviation of a rate.

    Parameters
    ----------
    samples : array, shape (N,)
        The rate, evenly sampled.
    rate_hz : float
        Sampling rate [Hz].
    factors : sequence of int, optional
        Averaging times in samples, ascending, below N/2 (disjoint averages: up to N/3); `averaging_factors` by default.
    overlapping : bool
        Overlapping estimator, or the classical one of disjoint averages, which some tables print.

    Returns
    -------
    AllanCurve
        The interval is chi-squared with the equivalent degrees of freedom of the identified noise type ([2]_, section
        5.3), never narrower than white noise's. It holds for Gaussian power-law noise; vibration or rocking is not that,
        and then it is a rough guide.
    """
    samples = checked(samples)
    factors = averaging_factors(samples.size) if factors is None else np.asarray(factors)
    estimator = allantools.oadev if overlapping else allantools.adev
    tau, deviation, _, _ = estimator(samples, rate=rate_hz, data_type="freq", taus=factors / rate_hz)
    if len(tau) != len(factors):
        raise ValueError(f"averaging over {factors.max()} of {samples.size} samples leaves no Allan deviation")
    exponents = identified_exponents(samples, factors)
    bounds = [
        allantools.confidence_interval(value, degrees_of_freedom(exponent, factor, samples.size, overlapping), LEVEL)
        for value, exponent, factor in zip(deviation, exponents, factors, strict=True)
    ]
    low, high = np.transpose(bounds)
    return AllanCurve(tau, deviation, low, high, np.array(exponents))


def degrees_of_freedom(exponent: int, factor: int, n: int, overlapping: bool) -> float:
    """Equivalent degrees of freedom of an Allan variance of `n` rates averaged over `factor` (Greenhall and Riley), at least 1."""
    return max(1.0, float(allantools.edf_greenhall(exponent, 2, factor, n + 1, overlapping=overlapping)))


def slope(curve: AllanCurve, shortest: float, longest: float) -> float:
    """Least-squares slope of log(deviation) over log(tau) for tau [s] from `shortest` to `longest`, both included."""
    inside = (curve.tau >= shortest * (1 - 1e-9)) & (curve.tau <= longest * (1 + 1e-9))
    return float(np.polyfit(np.log(curve.tau[inside]), np.log(curve.deviation[inside]), 1)[0])


def allan_findings(samples, rate_hz: float) -> list[Finding]:
    """Overlapping Allan deviation at 1, 10, 100, ... samples, and the slope over the first decade."""
    samples = checked(samples)
    curve = allan_deviation(samples, rate_hz)
    findings = []
    for tau, deviation, low, high, exponent in zip(*curve, strict=True):
        if np.isclose(np.log10(tau * rate_hz) % 1, [0, 1], atol=1e-6).any():
            note = f"interval for {NOISE_NAMES[exponent]} noise"
            findings.append(Finding(f"allan deviation tau = {tau:g} s", samples.size, deviation, ci_low=low, ci_high=high, note=note))
    longest = min(curve.tau[-1], 10 / rate_hz)
    if longest > curve.tau[0]:
        name, note = f"allan slope tau = {curve.tau[0]:g} to {longest:g} s", "quantisation -1; white -1/2; random walk +1/2"
        findings.append(Finding(name, samples.size, slope(curve, curve.tau[0], longest), note=note))
    return findings
