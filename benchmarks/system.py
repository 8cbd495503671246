"""What is measured of the whole system: the first result of a second process, and the cost of an ensemble."""

import os
import platform
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pandas as pd

from benchmarks.reference import compiler
from robins.papers import all_papers

FIRST_RESULT = """
import numpy as np
from robins.kalman.filter import run_filter
from robins.kalman.model import LinearModel, linear_sensor
from robins.kalman.predict import Ekf
from robins.kalman.weights import weighting
model, sensor = LinearModel(np.eye(3), np.zeros((3, 1)), np.eye(3)), linear_sensor(np.eye(2, 3), np.eye(2))
start, inputs, readings = np.zeros((1, 3)), np.zeros((5, 1)), np.zeros((1, 5, 2))
run_filter(Ekf(), model, sensor, weighting("unit"), start, np.eye(3), inputs, readings, np.ones(5, bool), 3, False)
"""
"""A process that filters five epochs: importing the package and loading the filter from the disk cache is nearly all of it."""


def first_result(repeats: int = 3) -> float:
    """Seconds from the start of a process to its first result with a filled disk cache: the least of `repeats`.

    One process more runs first and fills the cache.
    """
    seconds = []
    for _ in range(1 + repeats):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", FIRST_RESULT], check=True)
        seconds.append(time.perf_counter() - start)
    return min(seconds[1:])


def core_seconds(build: Path) -> dict[str, dict[str, float]]:
    """Processor seconds of each paper by stage, from what Snakemake noted in ``<build>/benchmarks``.

    A stage is ``variants``, or the first word of a study's name (``tuning``, ``sweep`` ...).
    """
    papers, spent = all_papers(), {}
    for folder in sorted(path for path in (build / "benchmarks").glob("*") if path.is_dir()):
        variants = {job.name for job in papers[folder.name].variants} if folder.name in papers else set()
        stages = spent.setdefault(folder.name, {})
        for file in sorted(folder.glob("*.tsv")):
            job = pd.read_csv(file, sep="\t", na_values="-")
            stage = "variants" if file.stem in variants else file.stem.split("-")[0]
            stages[stage] = stages.get(stage, 0.0) + float(job["cpu_time"].fillna(job["s"]).sum())
    return spent


def machine() -> dict[str, object]:
    """Processor, its load, and the versions of what takes part."""
    processor = platform.processor() or platform.machine()
    if (cpuinfo := Path("/proc/cpuinfo")).exists():
        names = [line.split(":", 1)[1].strip() for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        processor = names[0] if names else processor
    command = compiler()
    said = subprocess.run([command, "--version"], capture_output=True, text=True).stdout.splitlines()[:1] if command else []
    return {
        "system": f"{platform.system()} {platform.machine()}",
        "processor": processor,
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 1) if hasattr(os, "getloadavg") else None,
        "compiler": said[0] if said else "none",
        "python": platform.python_version(),
        **{package: version(package) for package in ("robins", "numba", "numpy", "filterpy")},
    }
