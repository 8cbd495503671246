"""Under which settings the paper's method is compared with both readings of its EKF, and what the paper prints for it."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import NamedTuple

import numpy as np

from robins.evaluate.ledger import Row
from robins.evaluate.published import published_value
from robins.evaluate.verdicts import Verdict
from robins.papers.ghouneem2024.comparisons import GeometricRatio, Where, ratio_of, variant, where
from robins.papers.ghouneem2024.judging import MINIMUM, NAMES, ratio_row, ratio_rule, together
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.studies import SEVERITIES
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import BASELINES, NEW
from robins.papers.protocol import Results

PRINTED = {channel: NAMES[channel].capitalize() for channel in CHANNELS}
"""The channels as the published table calls them."""


class Setting(NamedTuple):
    """A condition under which the paper's method is compared with an EKF.

    Attributes
    ----------
    words : str
        The ledger's condition.
    place : str
        Trajectory.
    new : Where
        Rows of the paper's method.
    baseline : callable
        ``baseline(name) -> Where``: rows of an EKF.
    size : str
        Entry of `MINIMUM`.
    """

    words: str
    place: str
    new: Where
    baseline: Callable[[str], Where]
    size: str = "runs"

    def compare(self, results: Results, baseline: str, measure: str) -> GeometricRatio:
        """The paired ratio, the paper's method over an EKF."""
        return ratio_of(results, self.new, self.baseline(baseline), measure)


def frozen_setting(place: str, frozen: str = "t1") -> Setting:
    """Settings of the tuning runs of a trajectory, out of sample; T1's are the headline."""
    return Setting(f"{frozen.upper()}-frozen", place, variant(NEW, place, frozen), partial(variant, place=place))


def in_sample_setting(place: str) -> Setting:
    """Settings that every run chose with its own truth."""
    new = where("in-sample", trajectory=place, filter="ukf", cell="st-gate")
    return Setting("in sample", place, new, partial(variant, place=place), "in_sample_runs")


def severity_settings(place: str) -> list[Setting]:
    """The headline's settings over the severity of the environment, on the studies' runs."""

    def at(severity: float, name: str) -> Where:
        return where("severity", trajectory=place, severity=severity, filter=name)

    return [
        Setting(f"T1-frozen, severity {value:g}", place, at(value, NEW), partial(at, value), "side_runs") for value in SEVERITIES
    ]  # fmt: skip


def other_settings(place: str) -> list[Setting]:
    """One assumption changed at a time; rows beside the headline's that do not enter the overall verdict."""
    return [frozen_setting(place, "t2"), in_sample_setting(place), *severity_settings(place)]


SETTING_NEEDS = (NEW, *BASELINES, "in-sample", "severity")


def printed_name(place: str, channel: str, kind: str) -> str:
    """Quantity of a published RMSE; `kind` is ``EKF`` or ``New-Algorithm``."""
    return f"{place.upper()} {PRINTED[channel]} RMSE, {kind}"


def printed(results: Results, place: str, channel: str, kind: str) -> float:
    """A published RMSE, deg or SI."""
    return published_value(results.published, f"C{TRAJECTORIES.index(place) + 1}", printed_name(place, channel, kind))


def printed_ratio(results: Results, place: str, measure: str) -> float:
    """The paper's ratio, New over EKF, of a channel or of the horizontal error."""
    channels = ("north", "east") if measure == "horizontal" else (measure,)
    new, old = (np.hypot.reduce([printed(results, place, name, kind) for name in channels]) for kind in ("New-Algorithm", "EKF"))
    return float(new / old)


def ratio_name(place: str, measure: str) -> str:
    """Quantity of a ratio."""
    return f"{place.upper()} {NAMES.get(measure, measure.replace('_', ' '))} RMSE ratio, New over EKF"


Rule = Callable[[GeometricRatio, int], tuple[Verdict, str]]


def against_both(
    results: Results, claim_id: str, quantity: str, setting: Setting, measure: str, rule: Rule = ratio_rule, published: float | str = ""
) -> list[Row]:  # fmt: skip
    """Two rows: a measure's ratio against each reading of the EKF, each judged by itself."""
    made = []
    for baseline in BASELINES:
        found = setting.compare(results, baseline, measure)
        verdict, reason = rule(found, MINIMUM[setting.size])
        made.append(ratio_row(claim_id, quantity, setting.words, found, f"{NEW}/{baseline}", verdict, reason, published=published))
    return made


def channel_verdict(results: Results, place: str, measure: str, claim_id: str = "") -> tuple[Verdict, list[Row]]:
    """The headline's verdict on a published ratio against both readings of the EKF, and the two rows behind it."""
    published = printed_ratio(results, place, measure)
    rule = partial(ratio_rule, published=published)
    found = against_both(results, claim_id, ratio_name(place, measure), frozen_setting(place), measure, rule, published)
    return together(row.verdict for row in found), found


def against_each(found: Iterable[Row]) -> str:
    """The reasons of rows against each EKF, for a sentence."""
    return " ".join(f"Against {row.variant.split('/')[1]}: {row.reason}" for row in found)
