"""The registry: the factorial of filter, self-tuning and gate, and its controls. Each is a row.

A row's cell says what is tuned: "none", or a cell of `robins.papers.ghouneem2024.tune`. Tuned rows run with the settings of either
trajectory's tuning runs on both trajectories.
"""

from typing import NamedTuple

from robins.papers.ghouneem2024.filters import FILTERS

NEW, BASELINES, CONTROL = "ukf-st-gate", ("ekf-pi", "ekf-pm"), "ekf-f"
"""The paper's method; the two readings of its EKF; the EKF that has the method's model."""
LABELS = {"ekf-pi": "EKF, incremental", "ekf-pm": "EKF, memoryless", "ekf-f": "EKF, exact Jacobian", "ukf": "UKF"}
CELL_WORDS = {"none": "", "gate": " + gate", "st": " + self-tuning", "st-gate": " + self-tuning + gate"}


class Variant(NamedTuple):
    """What readers call it, the filter that decides its colour, and its composition."""

    label: str
    family: str
    composition: dict


def variant_name(filter_name: str, cell: str) -> str:
    """The row of a filter in a cell of the factorial."""
    return filter_name if cell == "none" else f"{filter_name}-{cell}"


FACTORIAL = {
    variant_name(name, cell): Variant(LABELS[name] + words, name, {"filter": name, "cell": cell})
    for name in FILTERS
    for cell, words in CELL_WORDS.items()
}
"""Filter x self-tuning x gate."""

VARIANTS = FACTORIAL | {
    "riss-only": Variant("RISS only", "riss-only", {"filter": "ekf-f", "updates": False}),
    "gps-only": Variant("GPS, last fix held", "gps-only", {"held": True}),
    "ekf-f-physical": Variant("EKF, physical Q", "physical", {"filter": "ekf-f", "physical": True}),
    "ekf-f-nis": Variant("EKF, physical Q, NIS gate", "physical", {"filter": "ekf-f", "physical": True, "gate": "nis"}),
    "ekf-f-nis-recovery": Variant(
        "EKF, physical Q, NIS gate, recovery", "physical", {"filter": "ekf-f", "physical": True, "gate": "nis-recovery"}
    ),
    "ekf-f-nis-recovery-r4": Variant(
        "EKF, physical Q, NIS gate, recovery, R x 4", "physical",
        {"filter": "ekf-f", "physical": True, "gate": "nis-recovery", "noise_scale": 4.0},
    ),
}  # fmt: skip
"""Every variant that runs on the reporting runs."""
