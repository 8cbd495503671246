"""Scenarios and variants: what the reporting runs see, and every row of the registry on them."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from robins.papers.ghouneem2024 import sensors
from robins.papers.ghouneem2024.filters import Design, design, physical
from robins.papers.ghouneem2024.gps import ENVIRONMENTS
from robins.papers.ghouneem2024.runs import COLUMNS, Case, headline, prepare, score_held, scores
from robins.papers.ghouneem2024.trajectories import RATE_HZ, TRAJECTORIES, trajectory
from robins.papers.ghouneem2024.tune import frozen
from robins.papers.protocol import Output, Results, Settings

FIRST_RUN = 100
SENSOR_ROWS = (
    ("gyro turn-on bias, sd", "", sensors.GYROSCOPE_TURN_ON, "rad/s", "assumed"),
    ("gyro bias drift, sd", "", sensors.GYROSCOPE_DRIFT, "rad/s", "assumed"),
    ("gyro bias drift, time constant", "1/beta", sensors.GYROSCOPE_DRIFT_TIME, "s", "assumed"),
    ("gyro white noise of a sample, sd", "", sensors.GYROSCOPE_WHITE, "rad/s", "assumed"),
    ("gyro scale error, sd", "", sensors.GYROSCOPE_SCALE, "1", "assumed"),
    ("gyro resolution", "", sensors.GYROSCOPE_DIGIT, "rad/s", "maker"),
    ("accelerometer bias, sd", "", sensors.ACCELEROMETER_BIAS, "m/s^2", "assumed"),
    ("accelerometer drift, sd", "", sensors.ACCELEROMETER_DRIFT, "m/s^2", "assumed"),
    ("vibration when driving, sd", "", sensors.VIBRATION, "m/s^2", "assumed"),
    ("accelerometer resolution", "", sensors.ACCELEROMETER_DIGIT, "m/s^2", "maker"),
    ("odometer scale error, sd", "", sensors.ODOMETER_SCALE, "1", "assumed"),
    ("odometer latency", "", sensors.ODOMETER_LATENCY, "s", "assumed"),
    ("odometer resolution", "", sensors.ODOMETER_DIGIT, "m/s", "assumed"),
)
UNTUNED = "none"


def reporting_runs(settings: Settings, size: str = "runs") -> range:
    """The runs that results are reported from."""
    return range(FIRST_RUN, FIRST_RUN + settings.sizes[size])


def scenario(settings: Settings, place: str) -> Output:
    """Truth of a trajectory, sensor noise of the first reporting run, and every parameter of sensors and environment."""
    driven, case = trajectory(place), headline(settings.seed, place)
    prepared = prepare(case, FIRST_RUN)
    noise = prepared.sensed.rate - driven.rate - prepared.sensed.bias
    clear = prepared.fixes.cause == 0
    fix_error = prepared.fixes.value - np.column_stack([driven.position, driven.velocity])[prepared.fixes.epoch]
    arrays = {
        "time": driven.time, "position": driven.position, "velocity": driven.velocity, "azimuth": driven.azimuth,
        "pitch": driven.pitch, "roll": driven.roll, "speed": driven.speed,
        "fix_epoch": prepared.fixes.epoch, "fix_cause": prepared.fixes.cause, "fix_error": fix_error,
        "residual.gyroscope": noise[1:], "rate_hz.gyroscope": np.array(float(RATE_HZ)),
        "residual.gps_position": fix_error[clear, :3], "rate_hz.gps_position": np.array(1.0),
        "residual.gps_velocity": fix_error[clear, 3:], "rate_hz.gps_velocity": np.array(1.0),
    }  # fmt: skip
    return Output(parameters(place), arrays)


def parameters(place: str) -> pd.DataFrame:
    """What the trajectory, the sensors and the environment are made of, SI."""
    driven, environment = trajectory(place), ENVIRONMENTS[place]
    length = float(np.sum(driven.speed[1:]) / RATE_HZ)
    rows = [
        ("duration", "T", float(driven.time[-1]), "s", "ours"),
        ("length of the road", "L", length, "m", "ours"),
        ("mean speed", "V", length / float(driven.time[-1]), "m/s", "ours"),
        ("latitude of the origin", "phi", driven.latitude, "rad", "ours"),
        ("sampling rate", "1/dt", float(RATE_HZ), "Hz", "paper"),
        *SENSOR_ROWS,
        ("outages a run, mean", "", float(environment.outages), "1", "ours"),
        ("multipath bursts a run, mean", "", float(environment.bursts), "1", "ours"),
        ("multipath, median of the bias", "", float(environment.multipath_median), "m", "ours"),
        ("misleading fixes a run, mean", "", float(environment.misleading), "1", "ours"),
    ]
    return pd.DataFrame(rows, columns=["parameter", "symbol", "value", "unit", "source"])


def untuned(composition: Mapping, settings: Settings) -> Design:
    """The filter of a row that nothing is tuned for."""
    fields = {key: value for key, value in composition.items() if key not in ("filter", "cell", "physical")}
    return design(composition["filter"], settings.options, physical() if composition.get("physical") else None, **fields)


def designs(composition: Mapping, settings: Settings, results: Results | None) -> dict[tuple[str], Design]:
    """The filters of a row by the trajectory whose tuning runs gave the settings."""
    if composition.get("cell", UNTUNED) == UNTUNED:
        return {(UNTUNED,): untuned(composition, settings)}
    return {(place,): frozen(results, settings, composition["filter"], place, composition["cell"]) for place in TRAJECTORIES}


def variant(settings: Settings, results: Results | None = None, *, composition: Mapping) -> Output:
    """One row of the registry over the reporting runs: columns trajectory, frozen and those of `runs.COLUMNS`."""
    frames = []
    for place in TRAJECTORIES:
        case, runs = headline(settings.seed, place), reporting_runs(settings)
        if composition.get("held"):
            table = held(case, runs)
        else:
            table = scores(case, runs, designs(composition, settings, results), ["frozen"])
        table.insert(0, "trajectory", place)
        frames.append(table)
    return Output(pd.concat(frames, ignore_index=True))


def held(case: Case, runs: range) -> pd.DataFrame:
    """Scores of the last fix held."""
    return pd.DataFrame([{"frozen": UNTUNED} | score_held(prepare(case, run)) for run in runs], columns=["frozen", *COLUMNS])
