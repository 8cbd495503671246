"""What needs no simulated drive: analytic numbers of the brief, and moments that the unscented transform gets right (C17).

The transform is compared with exact moments of ``y = x^2`` and ``y = x^3`` for a scalar x of mean m: normal, and exponential (skewed) with
the same mean and variance. An unscented transform of any n takes 2n+1 points; here n = 1 and ``n + lambda = 3``, the choice that
matches the normal law's fourth moment, and the paper's alpha.
"""

from math import comb, factorial

import numpy as np
import pandas as pd
from scipy import stats

from robins.foundation.earth import EARTH_RATE
from robins.kalman.predict import Ukf, unscented
from robins.navigation.riss import GRAVITY
from robins.papers.protocol import Output, Settings

MEAN, SD = 1.0, 0.3
"""Of the scalar whose square and cube are taken."""
LAWS = ("normal", "exponential")
POWERS = {"square": 2, "cube": 3}


def central_moments(law: str, order: int) -> np.ndarray:
    """Central moments 0 to `order` of a law with standard deviation one, mean zero."""
    if law == "normal":
        return np.array([0.0 if k % 2 else float(np.prod(np.arange(k - 1, 0, -2))) if k else 1.0 for k in range(order + 1)])
    return np.array([sum(comb(k, j) * factorial(j) * (-1.0) ** (k - j) for j in range(k + 1)) for k in range(order + 1)])


def raw_moment(law: str, order: int) -> float:
    """``E[x^order]`` of the law with mean `MEAN` and standard deviation `SD`."""
    central = central_moments(law, order)
    return float(sum(comb(order, k) * central[k] * SD**k * MEAN ** (order - k) for k in range(order + 1)))


def exact(law: str, power: int) -> tuple[float, float]:
    """Mean and variance of ``x^power``."""
    mean = raw_moment(law, power)
    return mean, raw_moment(law, 2 * power) - mean**2


def transformed(points: Ukf, power: int) -> tuple[float, float]:
    """Mean and variance of ``x^power`` by the sigma points of one dimension."""
    values = np.array([MEAN, MEAN + np.sqrt(points.spread) * SD, MEAN - np.sqrt(points.spread) * SD]) ** power
    mean = float(points.mean_centre * values[0] + points.other * (values[1] + values[2]))
    deviation = np.square(values - mean)
    return mean, float(points.covariance_centre * deviation[0] + points.other * (deviation[1] + deviation[2]))


def linearised(power: int) -> tuple[float, float]:
    """The same by a first-order expansion, as the EKF has it."""
    return MEAN**power, (power * MEAN ** (power - 1) * SD) ** 2


def moments(settings: Settings) -> list[dict]:
    """Mean and variance by law, map and method, with the exact value."""
    options = settings.options
    methods = {
        "first order": linearised,
        f"unscented, alpha {options['alpha']:g}": lambda power: transformed(unscented(1, options["alpha"], options["beta"], 0.0), power),
        "unscented, n + lambda = 3": lambda power: transformed(unscented(1, 1.0, 0.0, 2.0), power),
    }
    return [
        {"topic": "moments", "quantity": f"{moment} of the {name}, {law} law, {method}", "expected": true, "value": found, "unit": "1"}
        for law in LAWS
        for name, power in POWERS.items()
        for method, take in methods.items()
        for moment, true, found in zip(("mean", "variance"), exact(law, power), take(power), strict=True)
    ]


def analytic() -> list[dict]:
    """Check 14 of the brief: expected as it states them, value as computed."""
    latitude = np.radians(44.23)
    rows = [
        ("earth's rate with the wrong sign, 44.23 deg", 21.0, 2 * np.degrees(EARTH_RATE) * 3600 * np.sin(latitude), "deg/h"),
        ("RMS of a uniform azimuth error", 103.92, 180.0 / np.sqrt(3.0), "deg"),
        ("share of unwrapped jumps for 103.38 deg", 0.0825, (103.38 / 360.0) ** 2, "1"),
        ("share of unwrapped jumps for 45.88 deg", 0.0162, (45.88 / 360.0) ** 2, "1"),
        ("altitude by an acceleration to 15 m/s", 11.5, 15.0**2 / (2 * GRAVITY), "m"),
        ("altitude by an acceleration to 12.4 m/s", 7.8, 12.4**2 / (2 * GRAVITY), "m"),
        ("99.9 % of chi-square, 6 degrees of freedom", 22.46, float(stats.chi2.ppf(0.999, 6)), "1"),
    ]
    return [
        {"topic": "analytic", "quantity": name, "expected": expected, "value": value, "unit": unit} for name, expected, value, unit in rows
    ]


def theory(settings: Settings) -> Output:
    """Columns topic, quantity, expected, value, unit."""
    return Output(pd.DataFrame([*analytic(), *moments(settings)]))
