"""The cost of a step, EKF and UKF, from a committed benchmark record: run times never enter the results through the workflow (C15).

``python -m benchmarks --record ghouneem2024`` writes the record.
"""

import json
from pathlib import Path

import pandas as pd

from robins.papers.protocol import Output, Settings

RECORD = Path(__file__).resolve().parents[4] / "benchmarks" / "records" / "ghouneem2024.json"
PAIR = "UKF over EKF, 9 states"


def record() -> dict:
    """What the record says of the pair, with its machine; empty where there is no record (an installed package has none)."""
    if not RECORD.is_file():
        return {}
    content = json.loads(RECORD.read_text(encoding="utf-8"))
    return {"machine": content["machine"], **content["pairs"][PAIR]}


def cost(settings: Settings, *, recorded: dict) -> Output:
    """Columns ratio (of the minima), least, greatest (in single rounds), rounds, ekf_us, ukf_us, machine; no row without a record."""
    columns = ["ratio", "least", "greatest", "rounds", "ekf_us", "ukf_us", "machine"]
    if not recorded:
        return Output(pd.DataFrame(columns=columns))
    machine = ", ".join(f"{key} {value}" for key, value in sorted(recorded["machine"].items()))
    return Output(pd.DataFrame([{**{key: recorded[key] for key in columns[:-1]}, "machine": machine}]))
