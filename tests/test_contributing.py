"""CONTRIBUTING.md: what it quotes is what is there, what it says of the floors is true, and its example works from outside the package."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import pytest

import robins

ROOT = Path(__file__).parents[1]
PLUGIN = ROOT / "tests" / "plugin"
PAGE = ROOT / "CONTRIBUTING.md"
FLOORS = ("foundation", "kalman", "navigation", "diagnostics", "evaluate", "publish", "papers", "field")
OUTSIDE_THE_FLOORS = {"", "plugins", "compile_cache"}  # `import robins`, and what stands in its root
AT_THE_EDGE = {("publish/regenerate.py", "papers")}  # the command behind `check`

COMPUTE = """
import gc, json, sys
from numba.core.registry import CPUDispatcher
from robins.kalman import weights
from robins.papers import all_papers
from robins.papers.protocol import Settings
jobs = all_papers()["example2026"].jobs
rmse = {name: jobs[name].compute(Settings("smoke", 1, {"runs": 4})).table["rmse"].tolist() for name in ("ekf", "cauchy")}
compiled = [d.py_func.__qualname__ for d in gc.get_objects() if isinstance(d, CPUDispatcher) and sum(d.stats.cache_misses.values())]
print(json.dumps({"rmse": rmse, "compiled": compiled, "weights": weights.names()}))
"""


@dataclass(frozen=True)
class Installation:
    """The example as an installed distribution in the folder `site`, with a compile cache of its own."""

    site: Path
    cache: Path

    def run(self, *arguments: str) -> subprocess.CompletedProcess:
        """Run Python with `arguments` where the example is installed."""
        path = [str(self.site), str(Path(robins.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, path)), "ROBINS_CACHE": str(self.cache)}
        run = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment)
        assert run.returncode == 0, run.stdout + run.stderr
        return run

    def workflow(self, folder: Path, *arguments: str) -> subprocess.CompletedProcess:
        """Run the workflow on the example alone, in `folder`."""
        command = ["-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--directory", str(folder), "--cores", "2", *arguments]
        return self.run(*command, "--config", "ensemble=smoke", "papers=[example2026]")

    def compute(self) -> dict:
        """Errors of two variants, names of the functions that this process had to compile, and the registered weights."""
        return json.loads(self.run("-c", COMPUTE).stdout)

    @contextmanager
    def edited(self, name: str, old: str, new: str) -> Iterator[None]:
        """Inside, a piece of one of the example's modules is another."""
        path = self.site / "robins_example" / name
        original = path.read_text()
        assert original.count(old) == 1
        path.write_text(original.replace(old, new))
        try:
            yield
        finally:
            path.write_text(original)


def install(site: Path, cache: Path) -> Installation:
    """Copy the example to `site` with the metadata that pip would write from its pyproject.toml."""
    shutil.copytree(PLUGIN / "src", site, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    project = tomllib.loads((PLUGIN / "pyproject.toml").read_text())["project"]
    files = [file.relative_to(site).as_posix() for file in sorted(site.rglob("*")) if file.is_file()]
    information = site / f"robins_example-{project['version']}.dist-info"
    information.mkdir()
    (information / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n")
    (information / "RECORD").write_text("".join(f"{file},,\n" for file in files))
    with (information / "entry_points.txt").open("w") as entry_points:
        for group, entries in project["entry-points"].items():
            entry_points.write(f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in entries.items()))
    return Installation(site, cache)


def state_of_the_repository() -> str:
    """What git sees of changed and new files, and the changes themselves."""
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        return ""
    commands = (["git", "status", "--porcelain"], ["git", "diff"])
    return "".join(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout for command in commands)


@pytest.fixture(scope="module")
def example(tmp_path_factory) -> Installation:
    """The example, installed, tested by its own tests and so compiled."""
    folder = tmp_path_factory.mktemp("example")
    installation = install(folder / "site", folder / "cache")
    own = folder / "distribution"
    shutil.copytree(PLUGIN / "tests", own / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    (own / "pytest.ini").write_text("[pytest]\nfilterwarnings = error\n")
    run = installation.run("-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", str(own), "-c", str(own / "pytest.ini"), str(own))
    assert re.search(r"^\d+ passed", run.stdout, flags=re.MULTILINE), run.stdout
    return installation


@pytest.fixture(scope="module")
def finished(example, tmp_path_factory) -> Path:
    """The folder in which the workflow has run on the example, without a change in the repository."""
    folder = tmp_path_factory.mktemp("run")
    before = state_of_the_repository()
    example.workflow(folder)
    assert state_of_the_repository() == before
    return folder


@pytest.fixture(scope="module")
def results(finished) -> Path:
    return finished / "build" / "smoke" / "results"


def test_every_block_of_code_stands_in_the_file_above_it():
    blocks = re.findall(r"^([^\n]*)\n```(\w*)\n(.*?\n)```$", PAGE.read_text(), flags=re.MULTILINE | re.DOTALL)
    quoted = {}
    for above, language, block in blocks:
        link = re.fullmatch(r"\[`(.+)`\]\(tests/plugin/\1\)", above)
        assert (link is None) == (language == "sh"), block
        if link:
            assert f"\n{block}" in "\n" + (PLUGIN / link[1]).read_text(), block
            quoted.setdefault(Path(link[1]).name, block)
    assert len(PAGE.read_text().split("```")) == 2 * len(blocks) + 1
    assert quoted["weight.py"] == (PLUGIN / "src" / "robins_example" / "weight.py").read_text()
    assert {"model.py", "scenario.py", "paper.py", "published.csv", "pyproject.toml"} <= set(quoted)


def test_the_page_is_short_and_so_is_every_file_of_the_example():
    assert len(PAGE.read_text().splitlines()) <= 250
    files = [path for path in PLUGIN.rglob("*.py") if "egg-info" not in str(path)]
    assert max(len(path.read_text().splitlines()) for path in files) <= 80


def imports(path: Path) -> set[str]:
    """What a module imports from robins: the first name below it, or the second for papers."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{alias.name}" for alias in node.names} if not node.level else {"robins.relative"}
    return {name for name in found if name.split(".")[0] == "robins"}


@pytest.mark.parametrize("floor", FLOORS)
def test_each_floor_imports_what_its_row_allows(floor):
    row = re.search(rf"^\| `{floor}` \| ([^|]*)\|", PAGE.read_text(), flags=re.MULTILINE)
    allowed = {floor, *re.findall(r"`(\w+)`", row[1])} | OUTSIDE_THE_FLOORS
    package = Path(robins.__file__).parent
    for path in sorted((package / floor).rglob("*.py")):
        name = path.relative_to(package).as_posix()
        used = {f"{imported}.".split(".")[1] for imported in imports(path)}
        used -= {other for file, other in AT_THE_EDGE if file == name} | {"__version__"}
        assert used <= allowed, name


def test_no_paper_imports_another():
    package = Path(robins.__file__).parent / "papers"
    wings = {folder.name for folder in package.iterdir() if (folder / "__init__.py").is_file()}
    for wing in wings:
        for path in (package / wing).rglob("*.py"):
            others = {name.split(".")[2] for name in imports(path) if name.startswith("robins.papers.")} & wings
            assert others <= {wing}, path


@pytest.mark.slow
def test_the_weight_is_registered_and_a_second_process_compiles_nothing(example):
    found = example.compute()
    assert "example-cauchy" in found["weights"]
    assert found["compiled"] == []


@pytest.mark.slow
def test_an_edit_in_the_weight_is_never_served_stale(example):
    before = example.compute()["rmse"]
    with example.edited("weight.py", "= 1.0 / (1.0 + d_squared / parameters[0] ** 2)", "= 1.0"):
        after = example.compute()["rmse"]
    assert after["ekf"] == before["ekf"]
    assert after["cauchy"] == pytest.approx(after["ekf"], rel=1e-12)
    assert after["cauchy"] != pytest.approx(before["cauchy"], rel=0.1)


@pytest.mark.slow
def test_the_example_reaches_tables_figures_and_report_without_an_edit_to_the_repository(results):
    assert (results / "example2026" / "figures" / "figure-01.png").stat().st_size > 1000
    assert (results / "example2026" / "tables" / "table-1.md").is_file()
    page = (results / "report.html").read_text()
    for words in ("Cauchy weights on a rail", "They also beat an EKF", "A reflected range is 15 m too long."):
        assert words in page, words
    assert re.search(r"robins_example/weight\.py:\d+<.*test_the_weight_is_one_half_at_the_threshold", page)
    assert re.search(r"robins_example/model\.py:\d+<.*test_drag_brakes_in_both_directions", page)
    artefacts = json.loads((results / "manifest.json").read_text())["artefacts"]
    assert artefacts["example2026/tables/table-1.csv"]["n"] == 20


@pytest.mark.slow
def test_the_weight_acts_where_ranges_take_detours(results):
    table = pd.read_csv(results / "example2026" / "tables" / "table-1.csv", index_col="filter")
    assert (table["failed"] == 0).all()
    assert table.loc["cauchy", "rmse_high"] < table.loc["inflated", "rmse_low"]
    assert table.loc["inflated", "rmse"] < table.loc["ekf", "rmse"]


@pytest.mark.slow
def test_every_claim_of_the_example_has_its_verdict(results):
    ledger = pd.read_csv(results / "claims.csv", dtype=str, keep_default_na=False).set_index("claim_id")
    assert (ledger["paper"] == "example2026").all()
    assert list(ledger.index) == ["C1", "C2", "C3"]
    assert ledger["verdict"].isin(["replicated", "direction only"])[["C1", "C2"]].all()
    assert ledger.loc["C3", "verdict"] == "untestable"
    assert list(ledger["published"]) == ["0.40", "0.20", ""]


@pytest.mark.slow
def test_an_edit_in_the_weight_reruns_only_the_filter_that_uses_it(example, finished, tmp_path):
    shutil.copytree(finished, tmp_path / "run", symlinks=True)
    with example.edited("weight.py", "d_squared /", "4.0 * d_squared /"):
        run = example.workflow(tmp_path / "run", "--dry-run")
    jobs = dict(re.findall(r"^(\w+) +(\d+)$", run.stdout + run.stderr, flags=re.MULTILINE))
    assert jobs["estimate"] == "1"
    assert "build/smoke/example2026/estimate/cauchy.parquet" in run.stdout + run.stderr
    assert "simulate" not in jobs


def test_an_editable_installation_is_covered_like_any_other(tmp_path):
    installation = install(tmp_path / "site", tmp_path / "cache")
    for record in installation.site.glob("*.dist-info/RECORD"):  # what `pip install -e` leaves: metadata, and sources elsewhere on the path
        record.write_text("")
    code = "from robins import plugins; from robins.kalman import extension; print(len(plugins.source_files()), len(extension._loose_ends))"
    assert installation.run("-c", code).stdout.split() == [str(len(list((PLUGIN / "src").rglob("*.py")))), "0"]
