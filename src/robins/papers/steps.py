"""The steps of the workflow, one function each: read inputs, let the paper's wing compute, write the outputs.

The scripts in workflow/scripts call these and nothing else.
"""

import hashlib
import json
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

import robins
from robins.diagnostics import summary
from robins.evaluate import ledger, published, storage
from robins.foundation.errors import InputError
from robins.foundation.files import replacing, write_text
from robins.foundation.randomness import stream
from robins.papers import all_papers, configuration
from robins.papers.configuration import Configuration
from robins.papers.pipeline import CLAIMS, DIAGNOSE, Layout, Sources
from robins.papers.protocol import Figure, Output, Paper, Results, Settings, Table
from robins.publish import manifest, style, tables
from robins.publish.check import CLAIM_TABLE
from robins.publish.sourcehash import source_hash

RESIDUAL = "residual."
"""How the names of a scenario's arrays begin that the diagnostics look at."""

HEARTBEAT = 10.0
"""Seconds after which, and between which, a running step says that it is alive."""


@dataclass(frozen=True)
class Desk:
    """Everything a step works with: one paper under one configuration."""

    paper: Paper
    configuration: Configuration
    layout: Layout

    @cached_property
    def settings(self) -> Settings:
        """What the configuration says to the paper."""
        return configuration.settings_for(self.paper, self.configuration)

    @cached_property
    def published(self) -> pd.DataFrame:
        """What the paper prints."""
        return published.read_published(self.layout.published_numbers(self.paper))

    @property
    def metadata(self) -> dict:
        """What every output carries: where its random numbers come from and which version made it."""
        settings, first = self.settings, self.paper.first_runs
        runs = {name: f"{first.get(name, 0)} to {first.get(name, 0) + size - 1}" for name, size in settings.sizes.items()}
        return {
            "paper": self.paper.key,
            "ensemble": settings.ensemble,
            "seed": settings.seed,
            "sizes": dict(settings.sizes),
            "reporting_runs": {name: span for name, span in runs.items() if name.endswith("runs") and name not in first},
            "tuning_runs": {name: span for name, span in runs.items() if name in first},
            "configuration": configuration.digest(settings),
            "version": robins.__version__,
        }

    @cached_property
    def sources(self) -> Sources:
        """The hashes of what is made here."""
        return Sources(self.paper, self.settings, self.layout.published_numbers(self.paper))

    def size(self, product: Table | Figure) -> int | None:
        """Ensemble size of a table or figure; None when nothing in it is random."""
        return self.settings.sizes[product.size] if product.size else None

    @cached_property
    def _loaded(self) -> dict[str, Output]:
        return {}

    def load(self, name: str) -> Output:
        """Read a result from disk, once; see `robins.papers.pipeline` for the names."""
        if name not in self._loaded:
            paths = self.layout.outputs(self.paper, name)
            parts = storage.read_output(*paths) if len(paths) == 2 else [pd.read_parquet(paths[0])]
            self._loaded[name] = Output(*parts)
        return self._loaded[name]

    def only(self, needs: Iterable[str]) -> Callable[[str], Output]:
        """`load` for whoever has these `needs`; a result that it does not name is refused."""
        allowed = frozenset(needs)

        def load(name: str) -> Output:
            if name not in allowed:
                raise LookupError(f"{name!r} is not among the needs {sorted(allowed)}")
            return self.load(name)

        return load

    def results(self, needs: Iterable[str]) -> Results:
        """What a table, figure or claim with these `needs` is made from."""
        return Results(self.settings, self.published, self.only(needs), self.load(CLAIMS).table if CLAIMS in needs else None)


def desk(snakemake) -> Desk:
    """The desk of a script whose rule has the parameter ``paper``."""
    return next(at for at in desks(snakemake) if at.paper.key == snakemake.params.paper)


def desks(snakemake) -> list[Desk]:
    """The desks of all chosen papers; the Snakefile has checked the configuration."""
    root = Path(snakemake.scriptdir).resolve().parents[1]
    chosen = configuration.from_values(snakemake.config, root)
    return [Desk(all_papers()[key], chosen, Layout(root, chosen.ensemble)) for key in chosen.papers]


def compute(at: Desk, name: str) -> None:
    """Run a scenario, a variant or a study, on the results that it needs."""
    job = at.paper.jobs[name]
    made_from = [Results(at.settings, at.published.head(0), at.only(job.needs))] if job.needs else []
    storage.write_output(job.compute(at.settings, *made_from), *at.layout.outputs(at.paper, name), at.metadata)


def diagnose(at: Desk, scenario: str) -> None:
    """Diagnose every array ``residual.<series>`` of a scenario, shape (N,) or (N, n), time first.

    Beside it may stand ``rate_hz.<series>``, a scalar (without it the averaging times are in samples), and
    ``sd.<series>``, the known standard deviation of each channel of a series that is meant to be Gaussian.
    """
    arrays = at.load(scenario).arrays
    frames = []
    for key in sorted(key for key in arrays if key.startswith(RESIDUAL)):
        series = key.removeprefix(RESIDUAL)
        generator = stream(at.settings.seed, f"{at.paper.key}/{scenario}/0/diagnose-{series}")
        law = [stats.norm(0, sd) for sd in np.atleast_1d(arrays[f"sd.{series}"])] if f"sd.{series}" in arrays else None
        frames.append(summary.diagnose(series, arrays[key], float(arrays.get(f"rate_hz.{series}", 1.0)), law, generator=generator))
    table = pd.concat(frames, ignore_index=True) if frames else pd.DataFrame(columns=list(summary.COLUMNS))
    with replacing(at.layout.outputs(at.paper, DIAGNOSE + scenario)[0]) as path:
        table.to_parquet(path, index=False)


def judge(at: Desk) -> None:
    """Judge every claim of the paper."""
    rows = [row for claim in at.paper.claims for row in claim.judge(at.results(claim.needs))]
    judged = ledger.build_ledger(at.paper.key, rows, at.published)
    with replacing(at.layout.outputs(at.paper, CLAIMS)[0]) as path:
        judged.to_parquet(path, index=False)


def merge_claims(all_desks: list[Desk]) -> None:
    """Publish the judged claims of all papers as one ledger."""
    layout = all_desks[0].layout
    merged = pd.concat([at.load(CLAIMS).table for at in all_desks], ignore_index=True)
    ledger.validate_ledger(merged, {at.paper.key: published.claim_ids(at.published) for at in all_desks}, "claims.csv")
    ledger.write_ledger(merged, f"{layout.results}/claims.csv")
    source = source_hash((), {at.paper.key: at.sources.result(CLAIMS) for at in all_desks})
    entry = manifest.entry("claims", None, source, tables.cells(len(merged), CLAIM_TABLE))
    manifest.write_record(layout.record("claims"), {"claims.csv": entry})


def write_tables(at: Desk) -> None:
    """Build and publish every table of the paper."""
    entries = {}
    for table in at.paper.tables:
        name, n = at.layout.product(at.paper, "tables", table), at.size(table)
        cells = tables.write(table.build(at.results(table.needs)), table, Path(at.layout.results) / name, n)
        entries[name] = manifest.entry("tables", n, at.sources.product(table), cells)
    manifest.write_record(at.layout.record("tables", at.paper.key), entries)


def write_figures(at: Desk) -> None:
    """Draw and publish every figure of the paper."""
    entries = {}
    for figure in at.paper.figures:
        name = at.layout.product(at.paper, "figures", figure)
        with style.use():
            style.save(figure.draw(at.results(figure.needs)), Path(at.layout.results) / name)
        entries[name] = manifest.entry("figures", at.size(figure), at.sources.product(figure))
    manifest.write_record(at.layout.record("figures", at.paper.key), entries)


def write_manifest(all_desks: list[Desk], records: Iterable) -> None:
    """Collect what the rules noted into the manifest."""
    layout, chosen = all_desks[0].layout, all_desks[0].configuration
    said = {at.paper.key: {"sizes": dict(at.settings.sizes), "options": dict(at.settings.options)} for at in all_desks}
    spans = {use: {at.paper.key: at.metadata[use] for at in all_desks} for use in ("reporting_runs", "tuning_runs")}
    seeds = {"seed": chosen.seed, **spans}
    config = {"ensemble": chosen.ensemble, "seed": chosen.seed, "papers": said}
    manifest.write_manifest(f"{layout.results}/manifest.json", records, layout.root / "requirements.lock", config, seeds)


def complete(all_desks: list[Desk]) -> None:
    """Note that every intermediate exists, with its hash, and on what machine the results were made."""
    layout = all_desks[0].layout
    files = sorted(file for at in all_desks for file in layout.intermediates(at.paper))
    manifest.write_run_info(f"{layout.sentinel}/run-info.json", layout.root, layout.results)
    hashes = {file: hashlib.sha256(Path(file).read_bytes()).hexdigest() for file in files}
    write_text(f"{layout.sentinel}/complete.json", json.dumps(hashes, indent=1) + "\n")


@contextmanager
def running(snakemake) -> Iterator[None]:
    """Run a script's body: say that it is alive when it takes long, and keep a failure's traceback in its log.

    A failure ends the process with exit code 1 and one line on standard error; nothing half-written is left,
    because every writer replaces whole files.
    """
    label = " ".join([snakemake.rule, *map(str, snakemake.wildcards)])
    log, began, done = Path(snakemake.log[0]), time.monotonic(), threading.Event()
    log.parent.mkdir(parents=True, exist_ok=True)

    def say_alive() -> None:
        while not done.wait(HEARTBEAT):
            print(f"robins: {label}: {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)

    threading.Thread(target=say_alive, daemon=True).start()
    try:
        yield
        log.write_text(f"{label}: {time.monotonic() - began:.1f} s\n", encoding="utf-8")
    except Exception as error:
        log.write_text(traceback.format_exc(), encoding="utf-8")
        said = (str(error).strip().splitlines() or [""])[-1]  # the last line names the cause where there are several
        reason = said if isinstance(error, InputError) else f"{type(error).__name__}: {said} (see {log})"
        print(f"robins: {label}: {reason}", file=sys.stderr, flush=True)
        sys.exit(1)
    finally:
        done.set()
