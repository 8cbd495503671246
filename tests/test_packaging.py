"""What a clone promises before any science runs: an environment that can be made anywhere, and nothing of one machine."""

import ast
import os
import re
import runpy
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

import robins

MEBIBYTE = 2**20

TEST_COMMAND = "pip install -r requirements.lock && pip install --no-deps -e . && pytest"
RUN_COMMAND = "pip install -r requirements.lock && pip install --no-deps -e . && snakemake --cores 2"

# Written in two halves so that this file passes its own scan.
FOREIGN = ["/wo" + "rk/", "/ro" + "ot/", "/op" + "t/", "pypi" + ".org", "files.python" + "hosted.org"]


def normalised(name: str) -> str:
    """The one spelling of a distribution's name."""
    return re.sub(r"[-_.]+", "-", name).lower()


def tracked_files(repository: Path) -> list[Path]:
    """The files that git tracks; skips the test where this is not a checkout."""
    try:
        listing = subprocess.run(["git", "ls-files", "-z"], cwd=repository, capture_output=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout")
    return [repository / os.fsdecode(name) for name in listing.split(b"\0") if name]


def imported_names(path: Path) -> set[str]:
    """First parts of the names of all modules that a source file imports absolutely."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(node.module.split(".")[0])
    return names


@pytest.fixture(scope="module")
def project(repository) -> dict:
    """The ``[project]`` table of pyproject.toml."""
    return tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.fixture(scope="module")
def declared(project) -> list[str]:
    """Names of the dependencies that pyproject.toml declares, at run time and for the tests."""
    requirements = project["dependencies"] + project["optional-dependencies"]["test"]
    return [normalised(re.match(r"[\w.-]+", requirement)[0]) for requirement in requirements]


@pytest.fixture(scope="module")
def lock(repository) -> str:
    return (repository / "requirements.lock").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def locked(lock) -> dict[str, str]:
    """Version of each distribution in the lock."""
    return {normalised(name): version for name, version in re.findall(r"^([\w.-]+)==([^\s;]+)", lock, flags=re.MULTILINE)}


def test_every_dependency_has_a_lower_bound(project):
    requirements = project["dependencies"] + project["optional-dependencies"]["test"]
    assert [requirement for requirement in requirements if ">=" not in requirement] == []


def test_every_dependency_is_locked_at_a_version_that_pyproject_accepts(project, locked):
    requirements = project["dependencies"] + project["optional-dependencies"]["test"]
    for requirement in requirements:
        name, lowest = requirement.split(">=")
        numbers = [tuple(int(part) for part in re.findall(r"\d+", version)) for version in (locked[normalised(name)], lowest)]
        assert numbers[0] >= numbers[1], requirement


def test_every_package_that_the_library_imports_is_declared(repository, project):
    runtime = {normalised(re.match(r"[\w.-]+", requirement)[0]) for requirement in project["dependencies"]}
    providers = packages_distributions()
    undeclared = {}
    for path in sorted((repository / "src").rglob("*.py")):
        for name in imported_names(path) - sys.stdlib_module_names - {"robins"}:
            if not runtime & {normalised(provider) for provider in providers.get(name, [])}:
                undeclared.setdefault(name, path.relative_to(repository).as_posix())
    assert undeclared == {}


def test_every_entry_of_the_lock_is_pinned_with_a_hash(lock, locked):
    entries = re.split(r"\n(?=\S)", re.sub(r"^ *#.*\n", "", lock, flags=re.MULTILINE).strip())
    assert len(entries) == len(locked) > 100
    assert [entry for entry in entries if not re.search(r"--hash=sha256:[0-9a-f]{64}", entry)] == []


def test_the_lock_knows_no_index_no_host_and_no_path(lock):
    assert re.findall(r"index-url|find-links|trusted-host|://|@ ", lock) == []
    # A slash appears in no name, version, marker or hash.
    assert [line for line in lock.splitlines() if "/" in line or "\\" in line.rstrip("\\")] == []


def test_the_lock_has_one_version_of_each_distribution_for_all_pythons(lock, locked):
    assert len(re.findall(r"^[\w.-]+==", lock, flags=re.MULTILINE)) == len(locked)


def test_environment_page_says_what_each_dependency_is_for(repository, declared):
    page = (repository / "environment.md").read_text(encoding="utf-8")
    table = page.split("## What each dependency is for")[1].split("\n## ")[0]
    rows = {match[1]: match[2] for match in re.finditer(r"^\| ([\w.-]+) \|[^|]*\| ([^|]+) \|$", table, flags=re.MULTILINE)}
    rows.pop("dependency")
    assert sorted(rows) == sorted(declared)


def test_environment_file_of_the_workflow_is_generated_from_the_lock(repository, lock):
    generator = runpy.run_path(str(repository / "workflow" / "envs" / "generate.py"))
    assert generator["environment"](lock) == (repository / "workflow" / "envs" / "robins.yaml").read_text(encoding="utf-8")


def test_environment_file_lists_every_entry_of_the_lock(repository, locked):
    text = (repository / "workflow" / "envs" / "robins.yaml").read_text(encoding="utf-8")
    listed = {normalised(name): version for name, version in re.findall(r'^ +- "([\w.-]+)==([^\s;"]+)', text, flags=re.MULTILINE)}
    assert listed == locked


def test_the_version_is_the_same_wherever_it_stands(repository, project):
    citation = (repository / "CITATION.cff").read_text(encoding="utf-8")
    cited = re.search(r"^version: (\S+)$", citation, flags=re.MULTILINE)[1]
    assert robins.__version__ == project["version"] == cited


@pytest.mark.parametrize("page", ["README.md", "environment.md"])
def test_the_two_commands_read_the_same_on_every_page(repository, page):
    lines = (repository / page).read_text(encoding="utf-8").splitlines()
    assert RUN_COMMAND in lines
    assert TEST_COMMAND in lines


def test_continuous_integration_runs_the_test_command_of_the_readme(repository):
    script = repository / ".ci" / "run"
    assert f"bash -c '{TEST_COMMAND}'" in script.read_text(encoding="utf-8")
    assert os.access(script, os.X_OK)


def test_continuous_integration_never_runs_the_standard_ensemble(repository):
    text = (repository / ".ci" / "run").read_text(encoding="utf-8")
    commands = [line for line in text.splitlines() if "snakemake" in line and not line.startswith("#")]
    assert len(commands) == 1
    assert '"${config[@]}"' in commands[0]
    assert re.findall(r"ensemble=(\w+)", text) == ["smoke"]


def test_no_tracked_file_names_a_machine_or_a_package_index(repository):
    found = []
    for path in tracked_files(repository):
        if path.is_file():
            content = path.read_bytes()
            found += [f"{path.relative_to(repository)}: {word}" for word in FOREIGN if word.encode() in content]
    assert found == []


def test_results_and_notebooks_stay_below_25_mebibytes(repository):
    files = [path for folder in ("results", "notebooks") for path in (repository / folder).rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 25 * MEBIBYTE
