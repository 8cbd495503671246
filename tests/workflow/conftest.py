"""A throw-away paper, installed beside a copy of nothing: its folder goes on PYTHONPATH and its entry point is found."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

import robins

ROOT = Path(__file__).parents[2]
PLUGIN = Path(__file__).parent / "plugin"


def install_toy(site: Path) -> Path:
    """Copy the toy paper to the folder `site` with the metadata of an installed distribution."""
    shutil.copytree(PLUGIN, site, ignore=shutil.ignore_patterns("__pycache__"))
    information = site / "toy-0.1.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 0.1\n")
    (information / "entry_points.txt").write_text("[robins.papers]\ntoy = toy:PAPER\n")
    (information / "RECORD").write_text("toy.py,,\ntoykernel.py,,\n")
    return site


@dataclass(frozen=True)
class Workflow:
    """The workflow on the toy paper alone, run in the folder `folder`, with the plug-in of the folder `site`."""

    folder: Path
    site: Path
    cache: Path

    def __call__(self, *arguments: str, papers: str = "papers=[toy]", config: tuple[str, ...] = ()) -> subprocess.CompletedProcess:
        """Run snakemake with `arguments`."""
        path = [str(self.site), str(Path(robins.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, path)), "ROBINS_CACHE": str(self.cache)}
        command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--directory", str(self.folder)]
        return subprocess.run([*command, *arguments, "--config", papers, *config], capture_output=True, text=True, env=environment)

    def planned(self, *arguments: str, config: tuple[str, ...] = ()) -> dict[str, int]:
        """Number of jobs of each rule that a run would execute."""
        run = self("--cores", "2", "--dry-run", *arguments, config=config)
        assert run.returncode == 0, run.stderr
        text = run.stdout + run.stderr
        if "Nothing to be done" in text:
            return {}
        rows = text.split("Job stats:")[-1].split("total")[0]
        return {name: int(count) for name, count in re.findall(r"^(\w+) +(\d+)$", rows, flags=re.MULTILINE)}

    def refusal(self, *config: str, **options) -> str:
        """The one line that a refused run prints; checks the exit code and that nothing was written."""
        before = self.published()
        run = self("--cores", "1", config=config, **options)
        assert run.returncode == 1, run.stderr
        lines = [line for line in run.stderr.splitlines() if line]
        assert len(lines) == 1, run.stderr
        assert not run.stdout
        assert self.published() == before
        assert not (self.folder / "build").exists() or before
        return lines[0]

    def copy(self, folder: Path) -> "Workflow":
        """The same workflow, as far as it has run, with its own plug-in to edit."""
        shutil.copytree(self.folder, folder / "run", symlinks=True)
        shutil.copytree(self.site, folder / "site")
        return Workflow(folder / "run", folder / "site", self.cache)

    def edit(self, name: str, old: str, new: str) -> None:
        """Replace text in a file of the plug-in."""
        text = (self.site / name).read_text()
        assert old in text
        (self.site / name).write_text(text.replace(old, new))

    def published(self) -> dict[str, bytes]:
        """Everything below results/ and notebooks/."""
        files = [file for name in ("results", "notebooks") for file in (self.folder / name).rglob("*") if file.is_file()]
        return {file.relative_to(self.folder).as_posix(): file.read_bytes() for file in sorted(files)}


@pytest.fixture(scope="session")
def cache(tmp_path_factory) -> Path:
    """A compile cache of the tests' own, since every edit of a plug-in opens a new one and old ones are pruned."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def fresh(tmp_path, cache) -> Workflow:
    """The workflow in an empty folder."""
    (tmp_path / "run").mkdir()
    return Workflow(tmp_path / "run", install_toy(tmp_path / "site"), cache)


@pytest.fixture(scope="module")
def finished(tmp_path_factory, cache) -> Iterator[Workflow]:
    """The workflow after a run with two cores; copy it before changing anything. Its tests share a file, so that it runs once."""
    folder = tmp_path_factory.mktemp("finished")
    (folder / "run").mkdir()
    workflow = Workflow(folder / "run", install_toy(folder / "site"), cache)
    run = workflow("--cores", "2")
    assert run.returncode == 0, run.stdout + run.stderr
    before = workflow.published()
    yield workflow
    assert workflow.published() == before
