"""The one error for bad input: one line that names the place, what was found and what was expected."""

from robins.foundation.errors import InputError


def test_the_message_names_file_field_finding_and_expectation():
    error = InputError("config.yaml", "sizes.runs", -1, "a whole number above 0")
    assert str(error) == "config.yaml: sizes.runs: found -1, expected a whole number above 0"
    assert (error.file, error.field, error.found, error.expected) == ("config.yaml", "sizes.runs", -1, "a whole number above 0")


def test_without_a_field_the_whole_file_is_meant():
    assert str(InputError("imu.bin", "", "3 bytes", "a multiple of 8")) == "imu.bin: found 3 bytes, expected a multiple of 8"


def test_the_message_is_one_line_whatever_it_quotes():
    assert "\n" not in str(InputError("a\nb", "c\nd", "e\nf", "g\nh"))


def test_it_is_a_value_error():
    assert isinstance(InputError("a", "b", "c", "d"), ValueError)
