"""Where the results come from: what any machine reproduces (manifest.json) and what only this one did (run-info.json).

The rule that makes an artefact writes its record; the manifest collects the records and computes none of them, so it
cannot claim a freshness that no rule has earned.
"""

import hashlib
import json
import platform
import subprocess
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from robins.foundation.files import write_text
from robins.publish.sourcehash import canonical

# Packages whose version can change a number or a drawing.
PACKAGES = ("robins", "numpy", "scipy", "pandas", "pyarrow", "numba", "llvmlite", "statsmodels", "matplotlib", "allantools", "pymap3d")


def entry(rule: str, n: int | None, source_hash: str, cells: int | None = None) -> dict:
    """What the rule that made an artefact says about it.

    Parameters
    ----------
    rule : str
        The rule's name.
    n : int or None
        Ensemble size; None when nothing in the artefact is random.
    source_hash : str
        Hash of everything the artefact was made from, computed when it was made.
    cells : int, optional
        Tables and the claim ledger: how many cells the check has to compare (`robins.publish.tables.cells`).
    """
    return {"rule": rule, "n": n, "source_hash": source_hash} | ({} if cells is None else {"cells": cells})


def write_record(path, entries: Mapping[str, Mapping]) -> None:
    """Write the entries of the artefacts that one job made, by the artefact's path below the results folder."""
    _write_json(path, dict(sorted(entries.items())))


def write_manifest(path, records: Iterable, lock, config: Mapping, seeds: Mapping) -> None:
    """Write manifest.json.

    Parameters
    ----------
    path : Path
        Where it goes.
    records : iterable of Path
        Files of `write_record`; together they name every artefact.
    lock : Path
        The file with the pinned packages.
    config : mapping
        The whole configuration, as validated, without what is true of one machine only (folders).
    seeds : mapping
        Seed and ensemble sizes, for readers.
    """
    artefacts: dict[str, dict] = {}
    for record in records:
        artefacts |= json.loads(Path(record).read_text(encoding="utf-8"))
    sources = {name: artefacts[name]["source_hash"] for name in sorted(artefacts)}
    content = {
        "source_hash": hashlib.sha256(canonical(sources).encode()).hexdigest(),
        "config_hash": hashlib.sha256(canonical(config).encode()).hexdigest(),
        "lock_hash": _sha256(lock),
        "versions": versions(),
        "seeds": seeds,
        "artefacts": dict(sorted(artefacts.items())),
    }
    _write_json(path, content)


def versions() -> dict[str, str]:
    """Versions of Python (without its patch level) and of the packages that can change a number; absent ones are left out."""
    found = {"python": ".".join(platform.python_version_tuple()[:2])}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def write_run_info(path, repository, results) -> None:
    """Write run-info.json: commit, machine and BLAS of this run, and the SHA-256 of each file below `results`."""
    results = Path(results)
    files = sorted(file for file in results.rglob("*") if file.is_file())
    settings = np.show_config(mode="dicts")
    content = {
        "commit": _git(repository, "rev-parse", "HEAD"),
        "changed_files": len(_git(repository, "status", "--porcelain", "--untracked-files=no").splitlines()),
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "blas": settings["Build Dependencies"]["blas"],
        "simd": settings["SIMD Extensions"],
        "thread_pools": _thread_pools(),
        "sha256": {file.relative_to(results).as_posix(): _sha256(file) for file in files},
    }
    _write_json(path, content)


def _thread_pools() -> list[dict]:
    """BLAS libraries in use with their CPU kernel, when the package that can tell is installed."""
    try:
        from threadpoolctl import threadpool_info
    except ImportError:
        return []
    return [{name: pool.get(name) for name in ("internal_api", "version", "architecture", "num_threads")} for pool in threadpool_info()]


def _git(repository, *arguments: str) -> str:
    """Output of a git command, empty where there is no git or no repository."""
    try:
        run = subprocess.run(["git", "-C", str(repository), *arguments], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return ""
    return run.stdout.strip() if run.returncode == 0 else ""


def _sha256(path) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def _write_json(path, content: Mapping) -> None:
    write_text(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")
