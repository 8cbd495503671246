"""Readings and choices, one at a time: omega_in of (5), process noise, law of the noise, the way back (brief, sections 1.2, 2.1, 2.3).

Three filters with conventional settings (EKF, CI-RKF, MKMC-EKF), in F0 and F1, on few runs: what an assumption does to all of them,
not who wins.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.integrate import quad
from scipy.optimize import brentq

from robins.foundation.noise_laws import Law, gaussian_mixture, normal_inverse_gaussian
from robins.navigation.strapdown import local_earth
from robins.papers.imani2026.drive import GRAVITY, LATITUDE
from robins.papers.imani2026.ensemble import Case, headline, method_of, scores
from robins.papers.imani2026.formulations import PROCESSES
from robins.papers.imani2026.sensors import GYROSCOPE_MOMENTS, Outliers, Sensors, Transients
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Output, Settings

FILTERS = ("ekf", "ci-seq-nominal", "mk-norm-gain-nominal")
FORMULATIONS = ("F0", "F1")
BURSTS = Outliers(rate=0.02, burst=5)
MIXTURE_SHARES = (0.02, 0.05, 0.10)
"""Shares of outliers of the impulsive law that meets the same two moments."""
NORMAL_HALF_WIDTH = 0.6744897501960817
"""Half the interquartile range of a standard normal law."""


class Ablation(NamedTuple):
    """One changed choice: the case that is measured, the multiplier of R and more arguments of the formulation."""

    case: Case
    noise_scale: np.ndarray | float = 1.0
    more: Mapping = {}


def core_sd(law: Law) -> float:
    """Half the width of the interval about the median that holds half of a standardised law, in units of a normal law's."""

    def quantile(share: float) -> float:
        return brentq(lambda x: quad(law.pdf, -40.0, x, limit=400)[0] - share, -5.0, 5.0, xtol=1e-9)

    return (quantile(0.75) - quantile(0.25)) / (2.0 * NORMAL_HALF_WIDTH)


def core_variance(sensors: Sensors) -> np.ndarray:
    """Variance of the core of the noise over its total variance, shape (6,): `R_core` of the brief."""
    return np.repeat([core_sd(sensors.accelerometer_law), core_sd(sensors.gyroscope_law)], 3) ** 2


def ablations_of(settings: Settings) -> dict[str, Ablation]:
    """Every ablation by the words that the table uses."""
    base = headline(settings)
    skewness, kurtosis = GYROSCOPE_MOMENTS
    sensors = {
        "transients (7)-(9)": Sensors(transients=Transients()),
        "bursts of outliers": Sensors(outliers=BURSTS),
        "19.91 is the raw kurtosis": Sensors(gyroscope_law=normal_inverse_gaussian(skewness, kurtosis - 3.0)),
    }
    sensors |= {
        f"impulsive law, {100 * share:g} %": Sensors(gyroscope_law=gaussian_mixture(share, skewness, kurtosis)) for share in MIXTURE_SHARES
    }
    unaware = local_earth(LATITUDE, GRAVITY, rotating=False)
    return (
        {"as designed": Ablation(base), "omega_in left out (5)": Ablation(base, more={"earth": unaware})}
        | {f"process noise: {name}": Ablation(base, more={"process": name}) for name in PROCESSES}
        | {"R of the core": Ablation(base, core_variance(base.sensors))}
        | {name: Ablation(base._replace(sensors=changed)) for name, changed in sensors.items()}
        | {"back in reverse gear": Ablation(base._replace(reversing=True))}
    )


def ablations(settings: Settings) -> Output:
    """Errors under each ablation: columns ablation, formulation, filter, run, channel, rmse, mean, drift, failed, reason."""
    frames = []
    for words, ablation in ablations_of(settings).items():
        methods = {name: method_of(VARIANTS[name].composition, settings, None, ablation.case) for name in FILTERS}
        methods = {name: method._replace(noise_scale=ablation.noise_scale) for name, method in methods.items()}
        for formulation in FORMULATIONS:
            table = scores(ablation.case, range(settings.sizes["fast_runs"]), methods, formulation, **ablation.more)
            frames.append(table.assign(ablation=words, formulation=formulation))
    table = pd.concat(frames, ignore_index=True)
    return Output(table[["ablation", "formulation", "filter", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]])
