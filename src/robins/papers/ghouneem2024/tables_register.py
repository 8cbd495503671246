"""Tables that say where things come from: parameters, variances, what each filter is, every claim's verdict, the audit of the equations."""

import numpy as np
import pandas as pd

from robins.evaluate.ledger import OVERALL
from robins.papers.columns import LINEAR, counts, keys, make, numbers, texts
from robins.papers.ghouneem2024 import gps, sensors
from robins.papers.ghouneem2024.claims import CLAIMS
from robins.papers.ghouneem2024.ensemble import FIRST_RUN
from robins.papers.ghouneem2024.filters import (
    FILTERS,
    JUMP_LIMITS,
    NIS_LIMIT,
    PATIENCE,
    PREDICTION_LIMITS,
    VELOCITY_FLOOR,
    datasheet,
    physical,
)
from robins.papers.ghouneem2024.register import EQUATIONS
from robins.papers.ghouneem2024.runs import BOUND
from robins.papers.ghouneem2024.studies import FIRST_SIDE_RUN
from robins.papers.ghouneem2024.table_parts import FROZEN, multiple_words, shown
from robins.papers.ghouneem2024.tables_tuning import STATE_UNITS, STATES, scale_words
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import frozen_setting, job_name
from robins.papers.ghouneem2024.variants import VARIANTS
from robins.papers.protocol import Results, Table

IN_DEGREES = {"rad": "deg", "rad/s": "deg/s"}
COMPONENTS = (("north", "m"), ("east", "m"), ("up", "m"), ("east velocity", "m/s"), ("north velocity", "m/s"), ("up velocity", "m/s"))
"""Components of a fix, and their units."""
SETS = {"data sheet, error state": datasheet("ekf-pi"), "data sheet, whole state": datasheet("ukf"), "physical": physical()}
"""Sets of variances: of ekf-pi and ekf-pm, of ekf-f and ukf, of the physical controls."""


def scenario_rows(results: Results) -> list[tuple]:
    """Group, parameter, symbol, value on each trajectory, unit and source of what the scenario jobs name; angles in degrees."""
    found = [results.table(place) for place in TRAJECTORIES]
    made = []
    for each in zip(*(table.itertuples(index=False) for table in found), strict=True):
        unit = IN_DEGREES.get(each[0].unit, each[0].unit)
        made.append(("scenario", each[0].parameter, each[0].symbol, *(shown(row.value, unit) for row in each), unit, each[0].source))
    return made


def spread(name: str, group: str, values, unit: str) -> list[tuple]:
    """Rows of a quantity that differs by component: horizontal twice and vertical are named."""
    axes = ("north", "east", "up")
    return [(group, f"{name}, {axis}", "", value, value, unit, "assumed") for axis, value in zip(axes, values, strict=True)]


def gps_rows() -> list[tuple]:
    """Clean fixes, and what a burst and a misleading fix are made of."""
    alone = [
        ("position drift, time constant", gps.POSITION_DRIFT_TIME, "s"),
        ("velocity drift, sd", gps.VELOCITY_DRIFT, "m/s"),
        ("velocity drift, time constant", gps.VELOCITY_DRIFT_TIME, "s"),
        ("velocity white noise, sd", gps.VELOCITY_WHITE, "m/s"),
        ("reported sd of velocity", gps.REPORTED_SIGMA[3], "m/s"),
        ("burst magnitude, sd of the logarithm", gps.BURST_SPREAD, "1"),
        ("burst, vertical over horizontal", gps.BURST_VERTICAL, "1"),
        ("reported sd in a burst, largest factor", gps.BURST_INFLATION[1], "1"),
        *((f"misleading, {end} {what}", value, unit)
          for what, values, unit in (("length", gps.MISLEADING_SECONDS, "s"), ("offset", gps.MISLEADING_OFFSET, "m"))
          for end, value in zip(("least", "greatest"), values, strict=True)),
    ]  # fmt: skip
    made = spread("position drift, sd", "gps", gps.POSITION_DRIFT, "m") + spread("position white noise, sd", "gps", gps.POSITION_WHITE, "m")
    made += spread("reported sd of position", "gps", gps.REPORTED_SIGMA[:3], "m")
    made += [("gps", name, "", value, value, unit, "assumed") for name, value, unit in alone]
    for i, end in enumerate(("least", "greatest")):
        for what in ("outage", "burst"):
            values = [getattr(gps.ENVIRONMENTS[place], f"{what}_seconds")[i] for place in TRAJECTORIES]
            made.append(("gps", f"{what}, {end} length", "", *values, "s", "assumed"))
    return made


def start_rows() -> list[tuple]:
    """Initial errors."""
    names = (("north", "m"), ("east", "m"), ("up", "m"), ("azimuth", "deg"))
    return [
        ("start", f"initial error, sd, {name}", "", *2 * (shown(value, unit),), unit, "assumed")
        for (name, unit), value in zip(names, sensors.START_SIGMA, strict=True)
    ]


def filter_rows(results: Results) -> list[tuple]:
    """Gates, sigma points and what ends a run."""
    made = [
        ("gate", f"{name} of (24) at the multiple 1, {component}", symbol, value, value, unit, "assumed")
        for name, symbol, limits in (("first test", "TH_RISS", PREDICTION_LIMITS), ("second test", "TH_GPS", JUMP_LIMITS))
        for (component, unit), value in zip(COMPONENTS, limits, strict=True)
    ]
    symbols = {"alpha": "paper names 1e-4 to 1", "beta": "paper names 2", "kappa": "paper names 0"}
    alone = [
        ("gate", "NIS limit, 99.9 % of chi-square", "", NIS_LIMIT, "1", "assumed"),
        ("gate", "rejections before recovery", "", float(PATIENCE), "1", "assumed"),
        *(("sigma points", name, name, float(results.settings.options[name]), "1", source) for name, source in symbols.items()),
        ("filter", "variance added to each velocity", "", VELOCITY_FLOOR, "m^2/s^2", "assumed"),
        ("filter", "horizontal error that ends a run", "", BOUND, "m", "assumed"),
    ]
    return made + [(group, name, symbol, value, value, unit, source) for group, name, symbol, value, unit, source in alone]


def parameters(results: Results) -> pd.DataFrame:
    """Every number of the experiment but the filters' variances."""
    made = [*scenario_rows(results), *gps_rows(), *start_rows(), *filter_rows(results)]
    return pd.DataFrame(made, columns=["group", "parameter", "symbol", *TRAJECTORIES, "unit", "source"])


def variances(results: Results) -> pd.DataFrame:
    """Standard deviations of Q, a step of 20 Hz, and of P0."""
    made = []
    for name, found in SETS.items():
        odometer = ("odometer acceleration", "m/s^2") if "error" in name else ("odometer speed", "m/s")
        states = (*zip(STATES, STATE_UNITS, strict=True), ("gyro bias", "deg/s"), odometer)
        for (state, unit), process, initial in zip(states, found.process, found.initial, strict=True):
            process_sd, initial_sd = (shown(np.sqrt(value), unit) for value in (process, initial))
            made.append({"set": name, "state": state, "unit": unit, "process_sd": process_sd, "initial_sd": initial_sd})
    return pd.DataFrame(made)


def variants(results: Results) -> pd.DataFrame:
    """What each name stands for, and the frozen settings of those that are tuned."""
    made = []
    for name, variant in VARIANTS.items():
        row = {"variant": name, "label": variant.label}
        row["composition"] = ", ".join(f"{key}: {value}" for key, value in variant.composition.items() if key != "cell")
        cell = variant.composition.get("cell", "none")
        for place in TRAJECTORIES:
            words = ("", "")
            if cell != "none":
                setting = frozen_setting(results, variant.composition["filter"], place, cell)
                words = (scale_words(setting.scale), multiple_words(setting.multiple))
            row |= {f"{place}_scale": words[0], f"{place}_multiple": words[1]}
        made.append(row)
    return pd.DataFrame(made)


def claims(results: Results) -> pd.DataFrame:
    """The verdict of every claim in short."""
    overall = results.ledger[results.ledger["condition"] == OVERALL].set_index("claim_id")
    made = []
    for claim in CLAIMS:
        found = overall.loc[claim.claim_id]
        row = {"claim_id": claim.claim_id, "location": found["location"], "statement": claim.statement}
        made.append(row | {"n": int(found["n"]), "verdict": found["verdict"], "reason": found["reason"]})
    return pd.DataFrame(made)


def equations(results: Results) -> pd.DataFrame:
    """The audit of the paper's equations."""
    made = [(e.number, e.title, e.status, e.note, e.test) for e in EQUATIONS]
    return pd.DataFrame(made, columns=["number", "title", "status", "note", "test"])


TUNING = tuple(map(job_name, FILTERS))

REGISTER_TABLES: tuple[Table, ...] = (
    make(
        "extra-parameters", "Every number of the experiment", parameters,
        (keys("group", "parameter"), texts("symbol"), numbers(*TRAJECTORIES, relative=LINEAR), texts("unit", "source")), TRAJECTORIES,
        "Values on both trajectories. source: paper; maker of the sensor; ours: property of the drives made here; assumed: chosen here, "
        "typical of its class. The paper prints rates and typical sigma-point parameters only. Variances of the filters are in "
        "extra-variances.", "",
    ),
    make(
        "extra-variances", "Q and P0 without tuning", variances,
        (keys("set", "state"), texts("unit"), numbers("process_sd", "initial_sd", relative=LINEAR)), (),
        "process_sd: standard deviation that a step of 0.05 s adds, without the floor of the velocities; initial_sd: at the start. error "
        "state: ekf-pi, ekf-pm; whole state: ekf-f, ukf; physical: the controls with a NIS gate. All assumed (A3).", "",
    ),
    make(
        "extra-variants", "Every filter of the factorial and its controls", variants,
        (keys("variant"), texts("label", "composition", *(f"{place}_{what}" for place in TRAJECTORIES for what in ("scale", "multiple")))),
        TUNING,
        f"t1, t2: settings frozen on the tuning runs of either trajectory: scale of self-tuned Q, multiple of the "
        f"thresholds of (24). {FROZEN}",
        "tuning_runs",
    ),
    make(
        "extra-claims", "Claims and verdicts in short", claims,
        (keys("claim_id"), texts("location", "statement"), counts("n"), texts("verdict", "reason", kind="prose")), ("claims",),
        "Decided against both readings of the EKF with T1-frozen settings, out of sample, in the frozen environment. n: runs from "
        f"{FIRST_RUN} on, or from {FIRST_SIDE_RUN} on where a study decides. Every row behind a verdict is in the claim ledger.",
    ),
    make(
        "extra-equations", "Audit of the paper's equations", equations, (keys("number"), texts("title", "status", "note", "test")), (),
        "ok: stands as printed; ambiguous: a reading had to be chosen; wrong: shown to be so by the test.", "",
    ),
)  # fmt: skip
"""Tables of provenance, in the order of the report."""
