"""The registry of the paper example2026: everything that the workflow is to make, by name."""

from functools import partial
from pathlib import Path

from robins.papers.protocol import Assumption, Claim, Equation, Figure, Job, Paper, Table
from robins_example.filters import estimate
from robins_example.products import COLUMNS, FAMILIES, MINIMUM, NAMES, draw_errors, errors_table, judge_ratio, judge_real_time
from robins_example.scenario import KEY, Parameters, rail
from robins_example.weight import EFFICIENT

PRODUCTS = ("robins_example.products",)
CODE = "robins_example.filters"
COMPOSITIONS = {  # what estimate() is called with, and the modules that it depends on: a weight's name does not tell
    "ekf": ("EKF", {}, (CODE,)),
    "inflated": ("EKF that knows the mean square of a range error", {"inflation": Parameters().inflation}, (CODE,)),
    "cauchy": ("EKF with Cauchy weights", {"weight": "example-cauchy", "constants": (EFFICIENT,)}, (CODE, "robins_example.weight")),
}
TEST = "tests/test_example.py::"


def variant(name: str) -> Job:
    """One row of the registry."""
    label, composition, modules = COMPOSITIONS[name]
    return Job(name, label, partial(estimate, **composition), modules, composition, FAMILIES[name])


def ratio_claim(claim_id: str, statement: str, other: str) -> Claim:
    """A claim that the Cauchy filter is better than another."""
    return Claim(claim_id, statement, partial(judge_ratio, claim_id=claim_id, other=other), ("cauchy", other), PRODUCTS, "runs", MINIMUM)


PAPER = Paper(
    key=KEY,
    title="Cauchy weights on a rail",
    citation="An example for contributors; no such paper exists.",
    doi="",
    summary="A cart on a rail hears three beacons; one range in ten takes a detour. Every number is made up.",
    scenarios=(Job("rail", "a cart on a rail", rail, ("robins_example.scenario",)),),
    variants=tuple(variant(name) for name in NAMES),
    studies=(),
    tables=(Table("table-1", "Error of the position", "Table 1", COLUMNS, errors_table, NAMES, PRODUCTS, size="runs"),),
    figures=(Figure("figure-01", "Error over time", "Fig. 1", draw_errors, NAMES, PRODUCTS, size="runs"),),
    claims=(
        ratio_claim("C1", "Cauchy weights make the error smaller than the EKF's.", "ekf"),
        ratio_claim("C2", "They also beat an EKF that is told the mean square of a range error.", "inflated"),
        Claim("C3", "The filter runs in real time.", judge_real_time, (), PRODUCTS),
    ),
    equations=(
        Equation("1", "weight", r"w = \frac{1}{1 + d^2 / c^2}", "ok", "", TEST + "test_the_weight_is_one_half_at_the_threshold"),
        Equation("2", "motion", r"\dot v = u - c v^2", "wrong", "Printed, drag pushes a cart that rolls backwards.",
                 TEST + "test_drag_brakes_in_both_directions", r"\dot v = u - c v |v|"),
    ),
    assumptions=(Assumption("detours", "substitute", "A reflected range is 15 m too long.", "The sizes of the ratios depend on it."),),
    sizes={name: {"runs": runs, "bootstrap": 10 * runs} for name, runs in (("smoke", 20), ("standard", 400), ("full", 2000))},
    published=Path(__file__).with_name("published.csv"),
)  # fmt: skip
