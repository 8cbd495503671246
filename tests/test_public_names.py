"""The names that `robins` offers."""

import robins


def test_every_public_name_can_be_imported():
    for name in robins.__all__:
        assert getattr(robins, name) is not None


def test_an_unknown_name_is_an_attribute_error():
    assert not hasattr(robins, "no_such_name")


def test_the_public_names_are_listed():
    assert set(robins.__all__) <= set(dir(robins))
