"""The workflow of the repository's own papers: an empty directory needs every job that the registry implies."""

import os
import re
import subprocess
import sys

import pytest

from robins.papers import all_papers

from .conftest import ROOT

PAPERS = {key: paper for key, paper in all_papers().items() if paper.published is None}


def implied_jobs() -> dict[str, int]:
    """Number of jobs of each rule, counted from the registry alone."""
    papers = PAPERS.values()
    jobs = {
        "simulate": sum(len(paper.scenarios) for paper in papers),
        "diagnose": sum(len(paper.scenarios) for paper in papers),
        "estimate": sum(len(paper.variants) + len(paper.studies) for paper in papers),
        "evaluate": len(papers),
        "notebook": len(papers) + 1,  # and the overview
    }
    jobs |= {f"{stage}_{key}": 1 for key in PAPERS for stage in ("tables", "figures")}
    return jobs | dict.fromkeys(("claims", "manifest", "report", "complete", "all"), 1)


@pytest.fixture(scope="module")
def plan(tmp_path_factory) -> str:
    """What a dry run in an empty directory says."""
    command = [
        sys.executable,
        "-m",
        "snakemake",
        "--snakefile",
        str(ROOT / "Snakefile"),
        "--directory",
        str(tmp_path_factory.mktemp("empty")),
    ]
    arguments = ["--cores", "2", "--dry-run", "--config", "ensemble=smoke", f"papers=[{','.join(PAPERS)}]"]
    run = subprocess.run([*command, *arguments], capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout + run.stderr


def test_an_empty_directory_needs_every_job_of_the_registry(plan):
    rows = dict(re.findall(r"^(\w+) +(\d+)$", plan.split("Job stats:")[-1], flags=re.MULTILINE))
    assert {name: int(count) for name, count in rows.items()} == implied_jobs() | {"total": sum(implied_jobs().values())}


def test_every_result_is_planned_under_its_own_name(plan):
    outputs = [name for line in re.findall(r"^ +output: (.+)$", plan, flags=re.MULTILINE) for name in line.split(", ")]
    planned = sorted(re.findall(r"^build/smoke/(\w+)/(?:simulate|estimate)/([a-z0-9-]+)\.parquet$", "\n".join(outputs), flags=re.MULTILINE))
    assert planned == sorted((key, name) for key, paper in PAPERS.items() for name in paper.jobs)
