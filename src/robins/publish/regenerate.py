"""The whole workflow once more, in an empty directory, and the comparison with what is versioned.

    python -m robins.publish.regenerate --ensemble standard     against results/
    python -m robins.publish.regenerate --ensemble smoke        against tests/reference/

Exit code 0 means: every job ran, and every table came out as versioned. "Nothing to be done" is a failure, since then
nothing has been shown. With ``--update-reference`` a smoke run replaces tests/reference/ instead of being compared.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

import robins
from robins.foundation.errors import InputError
from robins.publish.check import CLAIMS, Comparison, compare, compare_field

MANIFEST = "manifest.json"


def main(arguments: list[str] | None = None) -> int:
    """The command; returns the exit code."""
    options = _options(arguments)
    repository = options.repository.resolve()
    # The registry of papers is a floor above: only this command, at the edge, may ask it.
    from robins.evaluate.published import read_published
    from robins.papers import all_papers, pipeline

    try:
        source = repository / "src" / "robins"
        if source.is_dir() and not Path(robins.__file__).resolve().is_relative_to(source):
            raise InputError("--repository", "", f"{repository}, while robins is imported from elsewhere", "the clone that is installed")
        layout = pipeline.Layout(repository, options.ensemble)
        papers = {key: paper for key, paper in all_papers().items() if paper.published is None}  # not those of plug-ins
        published = {path.stem: read_published(path) for path in sorted((repository / "data" / "published").glob("*.csv"))}
        config = [f"ensemble={options.ensemble}", f"papers=[{','.join(papers)}]", *options.config]
        with tempfile.TemporaryDirectory(prefix="robins-") as folder:
            jobs = run(repository, Path(folder), config, options.cores, sum(len(paper.jobs) for paper in papers.values()))
            results = Path(folder) / layout.results
            if options.update_reference:
                replace_reference(results, reference_folder(repository, "smoke"))
                return 0
            reference = reference_folder(repository, options.ensemble)
            outcome = compare(results, reference, papers, published, demand_n=options.ensemble == "standard")
            return report(outcome, jobs, compare_field(results, reference, outcome, demand_n=options.ensemble == "standard"))
    except InputError as error:
        print(f"robins: {error}", file=sys.stderr)
        return 1


def _options(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m robins.publish.regenerate", description=__doc__.splitlines()[0])
    parser.add_argument("--ensemble", choices=["smoke", "standard"], required=True)
    parser.add_argument("--repository", type=Path, default=Path.cwd(), help="the clone (default: this directory)")
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--config", nargs="*", default=[], metavar="KEY=VALUE", help="as for snakemake")
    parser.add_argument("--update-reference", action="store_true", help="replace tests/reference/ by this smoke run")
    options = parser.parse_args(arguments)
    if options.update_reference and options.ensemble != "smoke":
        parser.error("--update-reference needs --ensemble smoke: results/ is written by the workflow itself")
    return options


def reference_folder(repository: Path, ensemble: str) -> Path:
    """What the results of `ensemble` are compared with."""
    return repository / "results" if ensemble == "standard" else repository / "tests" / "reference"


def run(repository: Path, folder: Path, config: Iterable[str], cores: int, least: int) -> int:
    """Run the whole workflow in the empty directory `folder` and return the number of jobs executed.

    Parameters
    ----------
    least : int
        Number of jobs that the registry of papers alone asks for.

    Raises
    ------
    InputError
        The workflow failed, or executed another number of jobs than its plan (a dry run) has, or fewer than `least`.
    """
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(repository / "Snakefile"), "--directory", str(folder)]
    tail = ["--cores", str(cores), "--config", *config]
    planned = planned_jobs(_output([*command, "--dry-run", *tail], echo=False))
    if planned < max(least, 1):
        raise InputError(repository / "Snakefile", "jobs planned in an empty directory", planned, f"at least {max(least, 1)}")
    print(f"robins: {planned} jobs in an empty directory", flush=True)
    executed = executed_jobs(_output([*command, *tail], echo=True))
    if executed != planned:
        raise InputError(repository / "Snakefile", "jobs executed in an empty directory", executed, f"{planned}, as planned")
    return executed


def _output(command: list[str], echo: bool) -> str:
    """Run `command` and return what it says; with `echo` pass on its progress and the lines of our own steps."""
    environment = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", **os.environ}
    lines = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment) as process:
        for line in process.stdout:
            lines.append(line)
            if echo and (re.match(r"\d+ of \d+ steps", line) or line.startswith("robins:")):
                print(line, end="", flush=True)
    if process.returncode:
        print("".join(lines[-60:]), file=sys.stderr, end="")
        raise InputError("snakemake", "exit code", process.returncode, "0")
    return "".join(lines)


def planned_jobs(text: str) -> int:
    """Number of jobs in snakemake's table of jobs; 0 when it says that nothing is to be done."""
    totals = re.findall(r"^total\s+(\d+)\s*$", text, flags=re.MULTILINE)
    return int(totals[-1]) if totals else 0


def executed_jobs(text: str) -> int:
    """Number of jobs that snakemake says it has finished, all of them; 0 when it never says so."""
    finished = re.findall(r"^(\d+) of (\d+) steps \(100%\) done", text, flags=re.MULTILINE)
    return int(finished[-1][0]) if finished else 0


def report(outcome: Comparison, jobs: int, skipped: list[str]) -> int:
    """Print what was compared, what was skipped and each difference; return the exit code."""
    for difference in outcome.differences:
        print(f"robins: {difference}", file=sys.stderr)
    print(
        f"robins: {jobs} jobs executed; {outcome.tables} tables, {outcome.cells} cells compared;"
        f" largest relative difference {outcome.largest:.2g}; {len(outcome.differences)} differences"
    )
    for name in skipped:
        print(f"robins: skipped field/{name}: this run had no recordings")
    return 1 if outcome.differences else 0


def replace_reference(results: Path, reference: Path) -> None:
    """Replace `reference` by the tables, the claim ledger and the manifest of `results`, all at once."""
    names = [CLAIMS, MANIFEST, *sorted(path.relative_to(results).as_posix() for path in results.glob("*/tables/*.csv"))]
    fresh = reference.with_name(f".{reference.name}-new")
    shutil.rmtree(fresh, ignore_errors=True)
    for name in names:
        if name.startswith("field/"):  # made from recordings, which a smoke run cannot count on
            continue
        (fresh / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(results / name, fresh / name)
    shutil.rmtree(reference, ignore_errors=True)
    fresh.rename(reference)
    print(f"robins: {reference} holds {len(names)} files")


if __name__ == "__main__":
    sys.exit(main())
