"""Options of the wing that make no sense are refused with the field's name, before anything runs."""

import math

import pytest

from robins.foundation.errors import InputError
from robins.papers.ghouneem2024.options import OPTIONS, validate
from robins.papers.protocol import Settings


def settings(**changed) -> Settings:
    return Settings("smoke", 1, {}, {**OPTIONS, **changed})


def test_the_defaults_are_sound():
    validate(settings())
    assert OPTIONS == {"alpha": 0.1, "beta": 2.0, "kappa": 0.0}


@pytest.mark.parametrize("changed", [{"alpha": 1.0}, {"alpha": 1}, {"alpha": 1e-4}, {"beta": 0.0}, {"kappa": -6.0}, {"kappa": 3}])
def test_ends_of_the_ranges_are_sound(changed):
    validate(settings(**changed))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("alpha", 0.0),
        ("alpha", -0.1),
        ("alpha", 1.001),
        ("alpha", math.nan),
        ("alpha", "0.1"),
        ("alpha", True),
        ("alpha", None),
        ("beta", -0.1),
        ("beta", math.inf),
        ("beta", math.nan),
        ("beta", [2.0]),
        ("kappa", -9.0),
        ("kappa", math.inf),
        ("kappa", math.nan),
        ("kappa", False),
    ],
)
def test_an_option_that_makes_no_sense_is_refused_by_its_name(name, value):
    with pytest.raises(InputError, match=f"options.ghouneem2024.{name}"):
        validate(settings(**{name: value}))
