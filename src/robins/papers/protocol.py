"""What a paper's wing offers to the rest of the house.

A wing's package exposes ``PAPER``, a `Paper`: its scenarios, variants, studies, tables, figures and
claims, by name. The workflow builds its targets from that and knows no paper by name.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as Drawing


@dataclass(frozen=True)
class Settings:
    """What the configuration says to one paper.

    Attributes
    ----------
    ensemble : str
        ``smoke``, ``standard`` or ``full``.
    seed : int
        The configuration's seed; see `robins.foundation.randomness`.
    sizes : mapping of str to int
        The paper's ensemble sizes at this ensemble (`Paper.sizes` names them).
    options : mapping
        The paper's own section of the configuration.
    """

    ensemble: str
    seed: int
    sizes: Mapping[str, int]
    options: Mapping = field(default_factory=dict)


@dataclass
class Output:
    """What a job leaves behind: one tidy table (SI units and radians) and named arrays."""

    table: pd.DataFrame
    arrays: dict[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class Job:
    """One computation of the DAG: a scenario, a variant (a filter) or a study (a sweep, a theory check).

    Attributes
    ----------
    name, label : str
        Key in file names (``[a-z0-9-]+``), and the words a reader sees.
    compute : callable
        ``compute(settings) -> Output``; for a job with `needs`, ``compute(settings, results) -> Output``. These `Results`
        load what the job needs and nothing else, and their published numbers have no rows: no filter sees what the paper prints.
    modules : tuple of str
        Modules whose code the result depends on (their imports are followed).
    definition : mapping
        The composition that this row of the registry stands for; a change makes the job's result stale.
    family : str
        Variants: the filter family, which decides the colour everywhere (`robins.publish.style`).
    needs : tuple of str
        Results that it is made from, such as the jobs that tuned it (`robins.papers.pipeline` says what may stand here).
    """

    name: str
    label: str
    compute: Callable[..., Output]
    modules: tuple[str, ...]
    definition: Mapping = field(default_factory=dict)
    family: str = ""
    needs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Column:
    """One column of a published table and how exactly it must regenerate.

    ``kind`` is ``key`` (identifies the row, exact), ``text`` (exact), ``count`` (whole number, exact) or
    ``number`` (compared within ``relative`` and ``absolute``; a cell may instead hold the word ``failed``),
    ``optional`` (a number or nothing) or ``prose`` (a generated sentence: its words exact, its numerals to their last
    digit, compared where ``n`` is equal).
    """

    name: str
    kind: str
    unit: str = ""
    relative: float = 1e-9
    absolute: float = 0.0


@dataclass(frozen=True)
class Table:
    """One published table. ``build(results)`` returns a frame with exactly these columns.

    ``size`` names the entry of `Settings.sizes` that is the n of this table ("" when nothing is random).
    """

    name: str
    title: str
    location: str
    columns: tuple[Column, ...]
    build: Callable[["Results"], pd.DataFrame]
    needs: tuple[str, ...]
    modules: tuple[str, ...]
    caption: str = ""
    size: str = ""


@dataclass(frozen=True)
class Figure:
    """One published figure. ``draw(results)`` returns a matplotlib figure; ``suffix`` is ``.png`` or ``.svg``."""

    name: str
    title: str
    location: str
    draw: Callable[["Results"], Drawing]
    needs: tuple[str, ...]
    modules: tuple[str, ...]
    caption: str = ""
    size: str = ""
    suffix: str = ".png"


@dataclass(frozen=True)
class Claim:
    """One claim id of the paper and the rule that judges it.

    ``judge(results)`` returns rows of the claim ledger (`robins.evaluate.ledger.Row`), one of them with the
    condition ``overall``. ``minimum`` is the n below which the row must say ``n too small``.
    """

    claim_id: str
    statement: str
    judge: Callable[["Results"], list]
    needs: tuple[str, ...]
    modules: tuple[str, ...]
    size: str = ""
    minimum: int = 0


@dataclass(frozen=True)
class Equation:
    """One numbered equation: as printed, as it should be, and the test that pins it.

    ``status`` is ``ok``, ``ambiguous`` or ``wrong``. ``printed`` and ``corrected`` are LaTeX without dollar
    signs (``corrected`` empty when the printed form stands). The code line is found by the marker
    ``# (number) key`` in the library's sources. ``test`` is ``tests/path.py::name``.
    """

    number: str
    title: str
    printed: str
    status: str
    note: str
    test: str
    corrected: str = ""


@dataclass(frozen=True)
class Assumption:
    """One entry of the register of assumptions and errata."""

    name: str
    kind: str
    statement: str
    consequence: str


@dataclass(frozen=True)
class Paper:
    """A paper's wing. See the module's docstring; ``sizes`` are used where the configuration has none.

    ``first_runs`` names the sizes whose runs do not begin with run 0, and where they begin: runs that filters are tuned on
    and that no result may be reported from. The runs of a size that is not named here are 0 to n - 1.

    ``validate(settings)`` raises `robins.foundation.errors.InputError` when the paper's own options are wrong.
    """

    key: str
    title: str
    citation: str
    doi: str
    summary: str
    scenarios: tuple[Job, ...]
    variants: tuple[Job, ...]
    studies: tuple[Job, ...]
    tables: tuple[Table, ...]
    figures: tuple[Figure, ...]
    claims: tuple[Claim, ...]
    equations: tuple[Equation, ...]
    assumptions: tuple[Assumption, ...]
    sizes: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    options: Mapping = field(default_factory=dict)
    first_runs: Mapping[str, int] = field(default_factory=dict)
    published: Path | None = None
    notebook: Path | None = None
    validate: Callable[[Settings], object] | None = None

    @property
    def jobs(self) -> dict[str, Job]:
        """Scenarios, variants and studies by name."""
        return {job.name: job for job in (*self.scenarios, *self.variants, *self.studies)}


class Results:
    """What tables, figures, claims and jobs with needs are made from: the settings, the published numbers and the jobs' outputs.

    Parameters
    ----------
    settings : Settings
    published : DataFrame
        data/published/<key>.csv.
    load : callable
        ``load(name) -> Output``; called at most once per job.
    ledger : DataFrame, optional
        The paper's claim rows, for tables and figures that show verdicts.
    """

    def __init__(self, settings: Settings, published: pd.DataFrame, load: Callable[[str], Output], ledger: pd.DataFrame | None = None):
        self.settings, self.published, self.ledger = settings, published, ledger
        self._load, self._loaded = load, {}

    def output(self, job: str) -> Output:
        """The output of `job`."""
        if job not in self._loaded:
            self._loaded[job] = self._load(job)
        return self._loaded[job]

    def table(self, job: str) -> pd.DataFrame:
        """The tidy table of `job`."""
        return self.output(job).table

    def arrays(self, job: str) -> dict[str, np.ndarray]:
        """The named arrays of `job`."""
        return self.output(job).arrays
