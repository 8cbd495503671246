"""The wing's own section of the configuration, checked when it is loaded."""

import math
from collections.abc import Mapping

from robins.foundation.errors import InputError
from robins.papers.imani2026.drive import CELLS_HZ, KEY
from robins.papers.protocol import Settings

OPTIONS = {
    "rate_hz": 10,
    "rates_hz": [1, 2, 5, 10, 50, 100],
    "kernel_widths": [1.5, 3.0, 8.0],
    "kernel_weights": [0.3, 0.4, 0.3],
    "chi_square_probability": 0.95,
    "chi_square_lower": 1.0,
    "chi_square_upper": 3.0,
    "huber_threshold": 1.345,
}
"""Sampling rate of the headline and those of the sweep (Hz); kernel widths in innovation standard deviations with their mixing
weights; beta, c0 and c1 of equation (35); Huber's threshold. The paper prints none of them."""


def validate(settings: Settings) -> None:
    """Raise `InputError`, naming the field, for the first option that makes no sense."""
    options = settings.options
    for field, rate in (("rate_hz", options["rate_hz"]), *(("rates_hz", rate) for rate in numbers(options, "rates_hz"))):
        if isinstance(rate, bool) or not isinstance(rate, int) or rate < 1 or CELLS_HZ % rate:
            raise wrong(field, rate, f"a whole number of hertz that divides {CELLS_HZ}")
    if len(set(options["rates_hz"])) != len(options["rates_hz"]):
        raise wrong("rates_hz", options["rates_hz"], "no rate twice")
    widths, mixing = numbers(options, "kernel_widths"), numbers(options, "kernel_weights")
    for width in widths:
        positive("kernel_widths", width)
    if len(widths) != len(mixing):
        raise wrong("kernel_weights", f"{len(mixing)} weights", f"one for each of the {len(widths)} kernel_widths")
    for share in mixing:
        if not (math.isfinite(share) and share >= 0.0):
            raise wrong("kernel_weights", share, "a finite number that is not negative")
    if abs(sum(mixing) - 1.0) > 1e-9:
        raise wrong("kernel_weights", f"a sum of {sum(mixing):g}", "weights that sum to one")
    for name in ("chi_square_lower", "chi_square_upper", "huber_threshold"):
        positive(name, options[name])
    if not 0.0 < options["chi_square_probability"] < 1.0:
        raise wrong("chi_square_probability", options["chi_square_probability"], "a number between 0 and 1")
    if options["chi_square_lower"] > options["chi_square_upper"]:
        raise wrong("chi_square_lower", options["chi_square_lower"], f"at most chi_square_upper, {options['chi_square_upper']:g}")


def numbers(options: Mapping, name: str) -> list:
    """The list `name`, which holds at least one number and nothing else."""
    values = options[name]
    if not values:
        raise wrong(name, "an empty list", "at least one number")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise wrong(name, value, "a number")
    return values


def positive(name: str, value: float) -> None:
    """Refuse what is not a positive finite number."""
    if not (math.isfinite(value) and value > 0.0):
        raise wrong(name, value, "a finite number above zero")


def wrong(name: str, found, expected: str) -> InputError:
    """The error for an option."""
    return InputError("config", f"options.{KEY}.{name}", found if isinstance(found, str) else repr(found), expected)
