"""The physics tests can fail: a weight switched off or a measurement shifted by one epoch turns them red, with no golden file at hand.

Each mutant is a copy of the package with one change, tested by a second Python with a compile cache of its own.
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

HERE = "tests/papers/hajiyev2023"
T01 = f"{HERE}/test_acceptance.py::test_t01_bh_from_the_posterior_of_the_first_measurement_is_the_augmented_filter"
T07_ORACLE = f"{HERE}/test_acceptance.py::test_t07_mean_nis_of_a_right_filter_is_the_number_of_measurements[oracle with the fault]"
T12 = f"{HERE}/test_acceptance.py::test_t12_scale_factors_of_the_faulty_channels_follow_the_variance_of_the_fault[deg]"
T13 = f"{HERE}/test_acceptance.py::test_t13_the_augmented_filter_is_honest_about_its_error"
KNOWN = f"{HERE}/test_estimators.py::test_oracle_told_through_the_weight_function_is_the_oracle"
GATE = f"{HERE}/test_estimators.py::test_gate_leaves_healthy_channels_alone_and_opens_for_the_faulty_ones"
SCALAR = tuple(f"{HERE}/test_estimators.py::test_scalar_rules_give_one_factor_to_all_channels[scalar-{rule}]" for rule in ("trace", "mean"))


class Mutant(NamedTuple):
    """A change in one file, and the tests that must notice it. Without `old` the function called `new` is switched off."""

    file: str
    old: str
    new: str
    tests: tuple[str, ...]


MUTANTS = {
    "covariance matching off": Mutant("kalman/tuning.py", "", "covariance_matching", (T12,)),
    "every rule the per-channel one": Mutant("kalman/tuning.py", "(window, rule, ", "(window, PER_CHANNEL, ", (GATE, *SCALAR)),
    "known weights off": Mutant("kalman/weights.py", "", "known", (KNOWN,)),
    "oracle not told": Mutant("papers/hajiyev2023/estimators.py", "._replace(weights=weights)", "", (T07_ORACLE,)),
    "mu one epoch late": Mutant("kalman/differencing.py", "mu[..., :-1, :] = z[..., 1:, :]", "mu[..., 1:, :] = z[..., 1:, :]", (T01,)),
    "z one epoch late": Mutant(
        "papers/hajiyev2023/estimators.py", "z = ensemble.z[condition]", "z = np.roll(ensemble.z[condition], 1, axis=1)", (T13,)
    ),
    "noise correlation not predicted": Mutant("kalman/differencing.py", "", "correlate_prediction", (T01,)),
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
    """Apply a mutant to the copy; the text to change must be there exactly once."""
    file = package / mutant.file
    source = file.read_text(encoding="utf-8")
    if mutant.old:
        assert source.count(mutant.old) == 1, f"{mutant.file} has no single {mutant.old!r}"
        changed = source.replace(mutant.old, mutant.new)
    else:
        changed = switched_off(source, mutant.new)
    file.write_text(changed, encoding="utf-8")


def failures(repository: Path, folder: Path, tests) -> tuple[set[str], str]:
    """Run `tests` against the copy in `folder`: the tests that failed, and what pytest wrote."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "ROBINS_CACHE": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    where = subprocess.run([sys.executable, "-c", "import robins; print(robins.__file__)"], cwd=repository, env=environment,
                           capture_output=True, text=True, check=True)  # fmt: skip
    assert Path(where.stdout.strip()).is_relative_to(folder), "the copy is not what is tested"
    command = [sys.executable, "-m", "pytest", "-q", "-rf", "--tb=no", "--no-header", "-p", "no:cacheprovider", *tests]
    result = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, timeout=600)
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
