"""One kind of error for input that a person can mend."""


class InputError(ValueError):
    """Bad input, said in one line: where it is, what was found and what was expected.

    Parameters
    ----------
    file : str or Path
        The file (or option) at fault.
    field : str
        Key, column or row inside it; empty when the whole file is meant.
    found, expected : object
        What stands there and what should.
    """

    def __init__(self, file, field, found, expected):
        self.file, self.field, self.found, self.expected = file, field, found, expected
        place = f"{file}: {field}" if field else f"{file}"
        super().__init__(f"{place}: found {found}, expected {expected}".replace("\n", " "))
