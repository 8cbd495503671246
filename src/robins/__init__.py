"""robins: robust inertial navigation, replicated.

Conventions, stated once and used everywhere
--------------------------------------------
Units    SI and radians. Degrees, kilometres and degrees per hour exist only where a configuration
         is loaded and where a table or a figure is published.
Frames   ``n`` east-north-up navigation frame unless a module says otherwise; ``b`` body frame, each
         model states its axes; a suffix names the frame of a vector (``specific_force_b``).
Arrays   time first, then channel: ``(N,)``, ``(N, n)``; ensembles ``(runs, N, n)``; float64, C order.
Symbols  ``x`` state, ``P`` its covariance, ``F`` transition Jacobian, ``Q`` process noise covariance,
         ``z`` measurement, ``H`` its Jacobian, ``R`` its noise covariance, ``K`` gain,
         ``S`` innovation covariance, ``w`` weights in [0, 1].
Noise    every random number comes from a named stream (`robins.foundation.randomness`).

The compiled kernels are cached on disk; the line below has to run before anything is compiled.
"""

import importlib

from robins import compile_cache

compile_cache.activate()

__version__ = "0.1.0"

_HOME = {
    "stream": "robins.foundation.randomness",
    "InputError": "robins.foundation.errors",
    "implements": "robins.kalman.extension",
    "propagate": "robins.kalman.model",
    "linearise": "robins.kalman.model",
    "observe": "robins.kalman.model",
    "linearise_observation": "robins.kalman.model",
    "LinearModel": "robins.kalman.model",
    "linear_sensor": "robins.kalman.model",
    "Ekf": "robins.kalman.predict",
    "unscented": "robins.kalman.predict",
    "weight": "robins.kalman.weights",
    "weighting": "robins.kalman.weights",
    "matching": "robins.kalman.tuning",
    "chi_square": "robins.kalman.chi_square",
    "gate": "robins.kalman.gates",
    "nis_gate": "robins.kalman.gates",
    "integrity_gate": "robins.kalman.gates",
    "huber": "robins.kalman.m_estimators",
    "correntropy": "robins.kalman.m_estimators",
    "run_filter": "robins.kalman.filter",
    "schedule": "robins.kalman.filter",
    "run_schedule": "robins.kalman.filter",
    "difference": "robins.kalman.differencing",
    "diagnose": "robins.diagnostics.summary",
    "paired_ratio": "robins.evaluate.intervals",
    "all_papers": "robins.papers",
}
"""The public names and where they live; a module is imported when one of its names is first asked for."""

__all__ = ["__version__", *_HOME]


def __getattr__(name: str):
    if name not in _HOME:
        raise AttributeError(f"module 'robins' has no attribute {name!r}")
    return getattr(importlib.import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
