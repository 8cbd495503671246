"""Ghouneem & Wassal (2024): a reduced inertial sensor system with GPS; EKF against UKF, self-tuning and GPS integrity.

International Journal on Informatics Visualization, November 2024.

``trajectories``, ``sensors``, ``gps``: the experiment (section III); ``filters``, ``as_printed``: section II-B; ``self_tuning``, ``tune``:
section II-A; ``variants``, ``runs``, ``ensemble``: the factorial and its scores; ``in_sample``, ``studies``, ``traces``, ``theory``,
``cost``: what the brief asks beyond the paper; ``tables``, ``figures``, ``noise``, ``claims``, ``register``: what is published;
``registry``: all of it. The mechanisation is `robins.navigation.riss`.

The registry is imported when ``PAPER`` is asked for: whoever loads a filter from the disk cache imports this package, and should not
have to wait for its figures.
"""


def __getattr__(name: str):
    if name != "PAPER":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from robins.papers.ghouneem2024.registry import PAPER

    return PAPER
