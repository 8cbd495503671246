"""Options of the wing that make no sense are refused with the field's name, before anything runs."""

import math

import pytest

from robins.foundation.errors import InputError
from robins.papers.imani2026.options import OPTIONS, validate
from robins.papers.protocol import Settings


def settings(**changed) -> Settings:
    return Settings("smoke", 1, {}, {**OPTIONS, **changed})


def test_the_defaults_are_sound():
    validate(settings())


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("kernel_widths", [1.5, 0.0, 8.0]),
        ("kernel_widths", [1.5, -3.0, 8.0]),
        ("kernel_widths", [1.5, math.inf, 8.0]),
        ("kernel_widths", [1.5, math.nan, 8.0]),
        ("kernel_widths", [1.5, "3", 8.0]),
        ("kernel_widths", []),
        ("kernel_weights", [0.5, 0.5]),
        ("kernel_weights", [0.3, 0.4, 0.2]),
        ("kernel_weights", [0.8, 0.4, -0.2]),
        ("kernel_weights", [math.nan, 0.7, 0.3]),
        ("chi_square_probability", 1.0),
        ("chi_square_probability", 0.0),
        ("chi_square_probability", math.nan),
        ("chi_square_lower", 0.0),
        ("chi_square_lower", math.inf),
        ("chi_square_lower", 4.0),
        ("chi_square_upper", -1.0),
        ("chi_square_upper", math.nan),
        ("huber_threshold", 0.0),
        ("huber_threshold", math.inf),
        ("rate_hz", 3),
        ("rate_hz", 0),
        ("rates_hz", [1, 7]),
        ("rates_hz", [10.0]),
        ("rates_hz", [10, 10]),
        ("rates_hz", []),
    ],
)
def test_an_option_that_makes_no_sense_is_refused_by_its_name(name, value):
    with pytest.raises(InputError, match=f"options.imani2026.{name}"):
        validate(settings(**{name: value}))
