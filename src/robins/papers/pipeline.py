"""What the workflow builds for a paper: names of files, what each needs, and the hash that says whether it is stale.

The Snakefile and its rules are made from the registry through these functions, so no rule knows a paper by name.
A *name* is whatever may stand in the ``needs`` of a job, table, figure or claim: a job of the paper (scenario, variant,
study), ``diagnose/<scenario>`` for the noise diagnostics of a scenario, or, in tables and figures, ``claims`` for the
paper's judged claims.
"""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

from robins.foundation.errors import InputError
from robins.papers.protocol import Claim, Figure, Job, Paper, Settings, Table
from robins.publish.sourcehash import source_hash

CLAIMS = "claims"
DIAGNOSE = "diagnose/"
WRITERS = {
    "jobs": ["robins.evaluate.storage"],
    Table: ["robins.publish.tables"],
    Figure: ["robins.publish.style"],
    Claim: ["robins.evaluate.ledger"],
}
"""The modules that bring what is made to disk."""


@dataclass(frozen=True)
class Layout:
    """Where things lie, relative to the folder that the workflow runs in; `root` is the repository.

    Only ``standard`` writes the versioned folders; the other ensembles have the same layout below ``build/``.
    """

    root: Path
    ensemble: str

    @property
    def build(self) -> str:
        """Intermediates of this ensemble."""
        return f"build/{self.ensemble}"

    @property
    def published(self) -> str:
        """The folder that holds results/, notebooks/."""
        return "" if self.ensemble == "standard" else f"{self.build}/"

    @property
    def results(self) -> str:
        """What readers see."""
        return f"{self.published}results"

    @property
    def notebooks(self) -> str:
        """Executed notebooks."""
        return f"{self.published}notebooks"

    @property
    def sentinel(self) -> str:
        """The folder of complete.json and run-info.json: never versioned, so a fresh clone has to run everything."""
        return "build" if self.ensemble == "standard" else self.build

    def outputs(self, paper: Paper, name: str) -> list[str]:
        """Files that hold the result `name`: a table, and for jobs the arrays."""
        if name == CLAIMS:
            return [f"{self.build}/{paper.key}/evaluate/claims.parquet"]
        if name.startswith(DIAGNOSE):
            return [f"{self.build}/{paper.key}/{name}.parquet"]
        stage = "simulate" if name in scenario_names(paper) else "estimate"
        return [f"{self.build}/{paper.key}/{stage}/{name}.{suffix}" for suffix in ("parquet", "npz")]

    def inputs(self, paper: Paper, made: Iterable[Job | Table | Figure | Claim]) -> list[str]:
        """Files that hold everything that these jobs or products need."""
        return [path for name in needed(made) for path in self.outputs(paper, name)]

    def intermediates(self, paper: Paper) -> list[str]:
        """Every intermediate of the paper: jobs, diagnostics and the judged claims."""
        names = [*paper.jobs, *(DIAGNOSE + name for name in scenario_names(paper)), CLAIMS]
        return [path for name in names for path in self.outputs(paper, name)]

    def product(self, paper: Paper, stage: str, product: Table | Figure) -> str:
        """A table's CSV file or a figure, below the results folder."""
        return f"{paper.key}/{stage}/{product.name}{'.csv' if stage == 'tables' else product.suffix}"

    def products(self, paper: Paper, stage: str) -> list[str]:
        """Every file that ``tables`` or ``figures`` publishes; a table has a Markdown file beside its CSV."""
        files = [f"{self.results}/{self.product(paper, stage, product)}" for product in products(paper, stage)]
        return files + [str(Path(file).with_suffix(".md")) for file in files if stage == "tables"]

    def record(self, stage: str, key: str = "") -> str:
        """What a rule notes for the manifest about the artefacts that it made."""
        return f"{self.build}/{key}/{stage}/record.json" if key else f"{self.build}/{stage}-record.json"

    def published_numbers(self, paper: Paper) -> Path:
        """What the paper prints."""
        return Path(paper.published or self.root / "data" / "published" / f"{paper.key}.csv")

    def notebook_sources(self, papers: Mapping[str, Paper]) -> dict[str, Path]:
        """Notebook sources by name: one for each paper that has one, and the overview."""
        folder = self.root / "workflow" / "notebooks"
        sources = {key: Path(paper.notebook or folder / f"{key}.ipynb") for key, paper in papers.items()}
        sources["overview"] = folder / "overview.ipynb"
        return {name: path for name, path in sources.items() if path.is_file()}


def scenario_names(paper: Paper) -> list[str]:
    """Names of the paper's scenarios."""
    return [job.name for job in paper.scenarios]


def needed(made: Iterable[Job | Table | Figure | Claim]) -> list[str]:
    """Names of the results that any of these jobs or products needs, each once, in order of appearance."""
    return list(dict.fromkeys(name for each in made for name in each.needs))


def check_needs(paper: Paper) -> None:
    """Refuse a paper whose jobs and products cannot be made in any order.

    Raises
    ------
    InputError
        A need is no result of the paper, or jobs need each other in a circle.
    """
    wanted = {job.name: job.needs for job in paper.jobs.values()} | {DIAGNOSE + name: (name,) for name in scenario_names(paper)}
    for each in (*paper.jobs.values(), *paper.claims, *paper.tables, *paper.figures):
        offered = {*wanted, CLAIMS} if isinstance(each, Table | Figure) else wanted
        for name in each.needs:
            if name not in offered:
                label = each.claim_id if isinstance(each, Claim) else each.name
                raise InputError(f"paper {paper.key}", f"needs of {label}", repr(name), f"one of {', '.join(sorted(offered))}")
    try:
        TopologicalSorter(wanted).prepare()
    except CycleError as error:
        circle = ", ".join(error.args[1])  # each is needed by the next
        raise InputError(f"paper {paper.key}", "needs", f"a circle ({circle})", "jobs that can be made one after the other") from None


def products(paper: Paper, stage: str) -> tuple[Table | Figure | Claim, ...]:
    """What ``tables``, ``figures`` or ``evaluate`` makes of the paper."""
    return {"tables": paper.tables, "figures": paper.figures, "evaluate": paper.claims}[stage]


class Sources:
    """The hashes that decide what is stale: code, definitions, settings and published numbers, never a time stamp.

    The rules' parameters, the records of what a rule made and the staleness test all come here.

    Parameters
    ----------
    paper : Paper
    settings : Settings
        What the configuration says to it.
    published : Path
        Its file in data/published.
    """

    def __init__(self, paper: Paper, settings: Settings, published: Path):
        self._paper = paper
        self._said = {"seed": settings.seed, "sizes": dict(settings.sizes), "options": dict(settings.options)}
        self._published = hashlib.sha256(published.read_bytes()).hexdigest()
        self._results: dict[str, str] = {}

    def result(self, name: str) -> str:
        """The hash of a job's output, of a scenario's diagnostics or of the judged claims."""
        if name not in self._results:
            self._results[name] = self._result(name)
        return self._results[name]

    def _result(self, name: str) -> str:
        if name == CLAIMS:
            return self.stage("evaluate")
        if name.startswith(DIAGNOSE):
            return source_hash(["robins.diagnostics.summary"], {"scenario": self.result(name.removeprefix(DIAGNOSE))})
        job = self._paper.jobs[name]
        facts = {"paper": self._paper.key, "job": name, "definition": job.definition, "made_by": job.compute, "said": self._said}
        made_from = {"made_from": {need: self.result(need) for need in job.needs}} if job.needs else {}
        return source_hash([*job.modules, *WRITERS["jobs"]], facts | made_from)

    def product(self, product: Table | Figure | Claim) -> str:
        """The hash of a table, a figure or a claim: its code, what it promises, and everything it is made from."""
        made_from = {name: self.result(name) for name in product.needs}
        facts = {"promises": vars(product), "made_from": made_from, "said": self._said, "published": self._published}
        return source_hash([*product.modules, *WRITERS[type(product)]], facts)

    def stage(self, stage: str) -> str:
        """One hash for everything that a stage makes of the paper."""
        return source_hash((), {"products": [self.product(product) for product in products(self._paper, stage)]})
