"""Noise diagnostics: is the gyroscope's noise white and normal, and what would one drive say of clean fixes? The paper shows none."""

import pandas as pd

from robins.diagnostics.summary import COLUMNS, blanked
from robins.papers.columns import counts, keys, make, numbers, texts
from robins.papers.ghouneem2024.ensemble import FIRST_RUN
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.protocol import Results

CHANNELS = {"gyroscope": ("z",), "gps_position": ("north", "east", "up"), "gps_velocity": ("east", "north", "up")}
"""Residual series of the scenarios and their channels."""
SMALLEST = 1e-12
"""p values below it are shown as 0: round-off decides a tail probability of 1e-60, which is no result."""


def noise_table(results: Results) -> pd.DataFrame:
    """Every test on every channel of the first reporting run of both trajectories."""
    frames = []
    for place in TRAJECTORIES:
        tested = results.table(f"diagnose/{place}")
        names = [CHANNELS[series][int(channel)] for series, channel in zip(tested["series"], tested["channel"], strict=True)]
        shown = tested["p_value"].where(tested["p_value"].isna() | (tested["p_value"] > SMALLEST), 0.0)
        frames.append(tested.assign(trajectory=place, channel=names, p_value=shown))
    return blanked(pd.concat(frames, ignore_index=True)[["trajectory", *COLUMNS]])


DIAGNOSTICS_TABLE = make(
    "extra-noise", "Noise of gyroscope and clean fixes: normality, moments, whiteness", noise_table,
    (
        keys("trajectory", "series", "channel"), counts("n"), keys("test"),
        numbers("statistic", "p_value", "ci_low", "ci_high", kind="optional"), texts("note"),
    ),
    tuple(f"diagnose/{place}" for place in TRAJECTORIES),
    f"Run {FIRST_RUN} of each trajectory, SI units and rad/s. gyroscope: reading minus rate and bias at 20 Hz, with scale error. "
    "gps: errors of the fixes without multipath or misleading offset, one a second, joined across gaps. Correlation of "
    "the fixes is put in (A18) and no filter models it. 95 % intervals; n: samples.", "",
)  # fmt: skip
