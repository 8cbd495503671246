"""The registry: a factorial of filter, self-tuning and gate, complete, and controls beside it."""

from itertools import product

import pytest

from robins.papers.ghouneem2024.ensemble import untuned
from robins.papers.ghouneem2024.filters import FILTERS, physical
from robins.papers.ghouneem2024.tune import CELLS
from robins.papers.ghouneem2024.variants import BASELINES, CELL_WORDS, CONTROL, FACTORIAL, LABELS, NEW, VARIANTS, variant_name

CONTROLS = {"riss-only", "gps-only", "ekf-f-physical", "ekf-f-nis", "ekf-f-nis-recovery", "ekf-f-nis-recovery-r4"}


def test_the_factorial_has_every_filter_in_every_cell():
    cells = [row.composition["cell"] for row in FACTORIAL.values()]
    assert set(CELL_WORDS) == {"none", *CELLS} and set(LABELS) == set(FILTERS)
    pairs = sorted((row.composition["filter"], cell) for row, cell in zip(FACTORIAL.values(), cells, strict=True))
    assert pairs == sorted(product(FILTERS, CELL_WORDS))
    for name, row in FACTORIAL.items():
        assert name == variant_name(row.composition["filter"], row.composition["cell"]) and row.family == row.composition["filter"]
    assert set(VARIANTS) == set(FACTORIAL) | CONTROLS


def test_the_papers_method_is_the_unscented_filter_with_everything_and_every_baseline_has_nothing():
    assert VARIANTS[NEW].composition == {"filter": "ukf", "cell": "st-gate"}
    assert {*BASELINES, CONTROL} == set(FILTERS) - {"ukf"}
    assert all(VARIANTS[name].composition["cell"] == "none" for name in (*BASELINES, CONTROL))


def test_labels_are_unique():
    labels = [row.label for row in VARIANTS.values()]
    assert len(set(labels)) == len(labels)


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("riss-only", {"updates": False, "gate": "none"}),
        ("ekf-f-physical", {"gate": "none"}),
        ("ekf-f-nis", {"gate": "nis"}),
        ("ekf-f-nis-recovery", {"gate": "nis-recovery", "noise_scale": 1.0}),
        ("ekf-f-nis-recovery-r4", {"gate": "nis-recovery", "noise_scale": 4.0}),
    ],
)
def test_a_control_is_what_its_name_says(settings, name, fields):
    made = untuned(VARIANTS[name].composition, settings())
    assert made.filter == "ekf-f"
    for field, value in fields.items():
        assert getattr(made, field) == value
    if name != "riss-only":
        assert (made.variances.process == physical().process).all()


@pytest.mark.parametrize("name", FILTERS)
def test_a_plain_filter_has_neither_gate_nor_tuning(settings, name):
    made = untuned(VARIANTS[name].composition, settings())
    assert (made.filter, made.gate, made.noise_scale, made.updates, made.tilt, made.turning) == (name, "none", 1.0, True, "printed", False)
