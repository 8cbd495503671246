"""The physics tests can fail: a gate switched off, the earth turning the wrong way, a fix or a sample too late turn them red.

The harness is that of imani2026's mutants: copies of the package with one idea changed, tested by a second Python.
"""

import importlib.util
from pathlib import Path

import pytest


def load_harness():
    """The module of the other wing's mutants: test files are no package that could be imported from."""
    path = Path(__file__).parents[1] / "imani2026" / "test_mutations.py"
    specification = importlib.util.spec_from_file_location("mutants_of_imani2026", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


harness = load_harness()
Change, Mutant = harness.Change, harness.Mutant

ACCEPTANCE = "tests/papers/ghouneem2024/test_acceptance.py"
MODELS = "tests/papers/ghouneem2024/test_models.py"
RISS = "tests/navigation/test_riss.py"
MISLED = f"{ACCEPTANCE}::test_11_a_misleading_fix_that_the_gate_sees_does_not_reach_the_state"
PERFECT = f"{ACCEPTANCE}::test_perfect_sensors_lead_through_the_whole_drive"
CLOSE = f"{ACCEPTANCE}::test_perfect_sensors_and_fixes_keep_every_filter_within_a_metre"
MECHANISATION, RUNS = "navigation/riss.py", "papers/ghouneem2024/runs.py"
MUTANTS = {
    "integrity gate off": Mutant((Change("kalman/gates.py", "", "close_integrity_gate"),), (f"{MISLED}[integrity]",)),
    "NIS gate off": Mutant((Change("kalman/gates.py", "", "close_nis_gate"),), (f"{MISLED}[nis]",)),
    "earth turning the other way": Mutant(
        (Change(MECHANISATION, "- EARTH_RATE * np.sin(latitude) - transport", "+ EARTH_RATE * np.sin(latitude) - transport"),),
        (f"{RISS}::test_a_lap_closes_when_the_gyro_feels_the_rotation_of_the_earth", f"{PERFECT}[t1]", f"{PERFECT}[t2]"),
    ),
    "fix one epoch late": Mutant(
        (Change(RUNS, "measurements[fixes.epoch] = fixes.value", "measurements[fixes.epoch] = np.roll(fixes.value, 1, axis=0)"),),
        tuple(f"{CLOSE}[t1-{name}]" for name in ("ekf-f", "ukf")),
    ),
    "sample one epoch late": Mutant((Change(MECHANISATION, "u[:-1, column] = values[1:]", "u[:-1, column] = values[:-1]"),),
                                    (f"{PERFECT}[t1]", f"{PERFECT}[t2]")),
    "variances of a fix forgotten": Mutant(
        (Change("navigation/fixes.py", "R[i, i] = sensor.noise_scale * u[sensor.first + i] ** 2", "R[i, i] = 1.0"),),
        (f"{MODELS}::test_the_update_with_a_fix_is_the_textbook_one[ekf-f]",),
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_is_noticed_by_a_physics_test(repository, tmp_path, name):
    mutant = MUTANTS[name]
    harness.mutate(harness.copy_package(tmp_path), mutant)
    failed, written = harness.failures(repository, tmp_path, mutant.tests)
    assert failed == set(mutant.tests), written


@pytest.mark.slow
def test_the_unchanged_copy_passes_the_same_tests(repository, tmp_path):
    harness.copy_package(tmp_path)
    tests = sorted({test for mutant in MUTANTS.values() for test in mutant.tests})
    failed, written = harness.failures(repository, tmp_path, tests)
    assert not failed and f"{len(tests)} passed" in written, written
