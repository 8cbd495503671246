"""Imani & Keighobadi (2026): an atomic inertial navigation system with chi-square and multi-kernel correntropy Kalman filters.

NAVIGATION 73 (2026), navi.768.

``drive``, ``sensors``, ``reference``: the experiment (section 5); ``formulations``: sections 3 and 4.1; ``methods``, ``variants``,
``as_printed``: sections 4.2 and 4.3; ``ensemble``, ``scoring``: section 6; ``tune``, ``studies``, ``ablations``, ``theory``: what the
brief asks beyond the paper; ``tables``, ``figures``, ``noise``, ``claims``, ``register``: what is published; ``registry``: all of it.

The registry is imported when ``PAPER`` is asked for. The index of the compiled filters names a type of `as_printed`: whoever loads a
filter from the disk cache imports this package, and should not have to wait for its figures.
"""


def __getattr__(name: str):
    if name != "PAPER":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from robins.papers.imani2026.registry import PAPER

    return PAPER
