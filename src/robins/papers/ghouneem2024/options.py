"""The wing's own section of the configuration, checked when it is loaded."""

import math

from robins.foundation.errors import InputError
from robins.navigation.riss import STATES
from robins.papers.ghouneem2024.trajectories import KEY
from robins.papers.protocol import Settings

OPTIONS = {"alpha": 0.1, "beta": 2.0, "kappa": 0.0}
"""Spread, prior knowledge and secondary scaling of the sigma points; the paper names usual values, not its own."""


def validate(settings: Settings) -> None:
    """Raise `InputError`, naming the field, for the first option that makes no sense."""
    options = settings.options
    rules = {
        "alpha": (lambda value: 0.0 < value <= 1.0, "a number above 0 and at most 1"),
        "beta": (lambda value: value >= 0.0, "a number that is not negative"),
        "kappa": (lambda value: value > -STATES, f"a number above -{STATES}"),
    }
    for name, (holds, expected) in rules.items():
        value = options[name]
        if isinstance(value, bool) or not isinstance(value, int | float) or not (math.isfinite(value) and holds(value)):
            raise InputError("config", f"options.{KEY}.{name}", repr(value), expected)
