"""The physics tests can fail: a weight switched off, the earth turning the wrong way, a sample one epoch late turn them red.

Each mutant is a copy of the package with one idea changed, tested by a second Python with a compile cache of its own and no golden
file. Weights share one mutant: each of its tests sees one of them only.
"""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

import robins

ACCEPTANCE = "tests/papers/imani2026/test_acceptance.py"
WITHSTANDS = f"{ACCEPTANCE}::test_a_robust_filter_withstands_one_sided_outliers_that_mislead_the_ekf"
ROBUST = ("increment", "corrected increment", "gate", "multi-kernel R / w", "multi-kernel K W", "Li", "Huber")
PRINTED = "tests/papers/imani2026/test_as_printed.py::test_printed_update_is_the_equations_letter_by_letter[0]"
A06 = f"{ACCEPTANCE}::test_a06_perfect_sensors_lead_through_the_whole_drive"
A12 = f"{ACCEPTANCE}::test_a12_with_gaussian_noise_the_hybrid_filter_is_honest_about_the_biases"
PITFALL_2 = f"{ACCEPTANCE}::test_pitfall_2_independent_noise_of_the_transients_loses_part_of_every_turn"
PITFALL_9 = f"{ACCEPTANCE}::test_pitfall_9_a_filter_that_smooths_is_not_without_error_when_its_sensors_are"


class Change(NamedTuple):
    """`old` becomes `new` in `file`. Without `old` the function called `new` is switched off."""

    file: str
    old: str
    new: str


class Mutant(NamedTuple):
    """Changes, and the tests that must notice them."""

    changes: tuple[Change, ...]
    tests: tuple[str, ...]


FORMULATIONS, STRAPDOWN = "papers/imani2026/formulations.py", "navigation/strapdown.py"
COUPLED = ("Q[i, k] += moved * G[k, j]", "Q[i, XF + j] = Q[XF + j, i] = moved")
MUTANTS = {
    "every weight off": Mutant(
        (
            Change("kalman/m_estimators.py", "", "correntropy_weights"),
            Change("kalman/m_estimators.py", "", "huber_weights"),
            Change("kalman/gates.py", "", "close_gate"),
            Change("kalman/chi_square.py", "", "chi_square_weights"),
            Change("papers/imani2026/as_printed.py", " * np.exp(-0.5 * (innovation[i] * inverse) ** 2)", ""),
        ),
        (*(f"{WITHSTANDS}[{method}]" for method in ROBUST), PRINTED),
    ),
    "earth turning the other way": Mutant(
        (Change(STRAPDOWN, "rate = EARTH_RATE *", "rate = -EARTH_RATE *"),), (f"{A06}[reckoned]", f"{A06}[F2]")
    ),
    "measurement one epoch late": Mutant(
        (Change(FORMULATIONS, "z[:, 1:] = measured.atomic", "z[:, 1:] = np.roll(measured.atomic, 1, axis=1)"),),
        (A12, f"{PITFALL_9}[1.0-3.5-3.8]"),
    ),
    "driving sample one epoch late": Mutant(
        (Change(FORMULATIONS, "inputs[:, :-1, :6], inputs[:, 1:, 6:]", "inputs[:, 1:, :6], inputs[:, 1:, 6:]"),), (f"{A06}[reckoned]",)
    ),
    "noise of the transients beside them": Mutant(
        tuple(Change(STRAPDOWN, line, line.replace("moved", "0.0 * moved")) for line in COUPLED), (PITFALL_2,)
    ),
}


def copy_package(folder: Path) -> Path:
    """A copy of the package's sources and data below `folder`."""
    return Path(shutil.copytree(Path(robins.__file__).parent, folder / "robins", ignore=shutil.ignore_patterns("__pycache__")))


def switched_off(source: str, function: str) -> str:
    """`source` with `function` returning before its first statement."""
    node = next(n for n in ast.parse(source).body if isinstance(n, ast.FunctionDef) and n.name == function)
    first = next(s for s in node.body if not (isinstance(s, ast.Expr) and isinstance(s.value, ast.Constant)))
    lines = source.splitlines(keepends=True)
    lines.insert(first.lineno - 1, f"{' ' * first.col_offset}return\n")
    return "".join(lines)


def mutate(package: Path, mutant: Mutant) -> None:
    """Apply a mutant to the copy; a text to change must be there exactly once."""
    for change in mutant.changes:
        file = package / change.file
        source = file.read_text(encoding="utf-8")
        if change.old:
            assert source.count(change.old) == 1, f"{change.file} has no single {change.old!r}"
            changed = source.replace(change.old, change.new)
        else:
            changed = switched_off(source, change.new)
        file.write_text(changed, encoding="utf-8")


def failures(repository: Path, folder: Path, tests) -> tuple[set[str], str]:
    """Run `tests` against the copy in `folder`: the tests that failed, and what pytest wrote."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "ROBINS_CACHE": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    where = subprocess.run([sys.executable, "-c", "import robins; print(robins.__file__)"], cwd=repository, env=environment,
                           capture_output=True, text=True, check=True)  # fmt: skip
    assert Path(where.stdout.strip()).is_relative_to(folder), "the copy is not what is tested"
    command = [sys.executable, "-m", "pytest", "-q", "-rf", "--tb=no", "--no-header", "-p", "no:cacheprovider", *tests]
    result = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, timeout=900)
    assert result.returncode in (0, 1), result.stdout + result.stderr
    lines = [line.removeprefix("FAILED ") for line in result.stdout.splitlines() if line.startswith("FAILED ")]
    return {test for test in tests for line in lines if line == test or line.startswith(f"{test} - ")}, result.stdout


@pytest.mark.slow
@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_is_noticed_by_a_physics_test(repository, tmp_path, name):
    mutant = MUTANTS[name]
    mutate(copy_package(tmp_path), mutant)
    failed, written = failures(repository, tmp_path, mutant.tests)
    assert failed == set(mutant.tests), written


@pytest.mark.slow
def test_the_unchanged_copy_passes_the_same_tests(repository, tmp_path):
    copy_package(tmp_path)
    tests = sorted({test for mutant in MUTANTS.values() for test in mutant.tests})
    failed, written = failures(repository, tmp_path, tests)
    assert not failed, written
    assert f"{len(tests)} passed" in written, written
