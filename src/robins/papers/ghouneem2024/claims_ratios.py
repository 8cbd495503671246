"""The claims of Tables II and III: levels (C1, C2), ratios by channel (C3 to C8c), the azimuth of the second trajectory (C9).

The overall verdict of a ratio is the headline's: T1-frozen settings, out of sample, against both readings of the EKF. A claim about
several channels has the verdict of the weakest.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np

from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import Verdict
from robins.papers.ghouneem2024.claims_settings import (
    SETTING_NEEDS,
    against_both,
    against_each,
    channel_verdict,
    frozen_setting,
    in_sample_setting,
    other_settings,
    printed,
    printed_name,
    printed_ratio,
    ratio_name,
)
from robins.papers.ghouneem2024.comparisons import GeometricMean, Where, mean_of, ratio_of, values, variant, where
from robins.papers.ghouneem2024.judging import (
    MINIMUM,
    NAMES,
    closing_row,
    listing,
    numeric_row,
    ratio_row,
    ratio_rule,
    together,
    too_small,
    unchanged_rule,
    weakest,
    words_row,
)
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import BASELINES, CONTROL, NEW
from robins.papers.protocol import Results

UNPUBLISHED = (
    "The level needs the paper's data: neither these nor Q, P0, thresholds, sigma points, outages or the initial azimuth are published."
)
RATIO_CLAIMS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "C3": ("t1", ("azimuth",)),
    "C4": ("t1", ("v_east", "v_north")),
    "C6": ("t1", ("north", "east")),
    "C7": ("t1", ("height",)),
    "C8a": ("t2", ("north",)),
    "C8b": ("t2", ("east", "v_east", "v_north", "height")),
    "C8c": ("t2", ("v_up",)),
}
"""Trajectory and channels of each claim about ratios."""
LEVEL_NEEDS = (NEW, *BASELINES, CONTROL, "in-sample")
UNCHANGED_NEEDS = (*SETTING_NEEDS, "ablations")
TILTS = ("as run", "tilt corrected")
NEAR_UNIFORM = 0.01
"""Relative difference from the level of a uniform azimuth error that still counts as that level."""


def factor_of(channel: str) -> float:
    """From the jobs' units to those that the paper prints."""
    return float(np.degrees(1.0)) if channel.startswith("azimuth") else 1.0


def level_row(claim_id: str, quantity: str, condition: str, found: GeometricMean, name: str, channel: str, remark: str) -> Row:
    """Geometric mean over the runs beside a published RMSE."""
    lost = f" {found.failed} of {found.n} runs failed." if found.failed else ""
    return numeric_row(
        claim_id, quantity, condition, found, found.n, name, Verdict.UNTESTABLE, f"{remark}{lost} {UNPUBLISHED}", factor_of(channel)
    )  # fmt: skip


def judge_levels(results: Results, place: str) -> list[Row]:
    """C1, C2: every RMSE of a table beside ours."""
    claim_id, made = f"C{TRAJECTORIES.index(place) + 1}", []
    new = [(setting.words, setting.new) for setting in (frozen_setting(place), frozen_setting(place, "t2"), in_sample_setting(place))]
    for channel in CHANNELS:
        sides = [("EKF", "data sheet's variances", name, variant(name, place)) for name in (*BASELINES, CONTROL)]
        sides += [("New-Algorithm", words, NEW, at) for words, at in new]
        for kind, condition, name, at in sides:
            found = mean_of(results, at, channel)
            remark = f"Geometric mean of {found.n} runs."
            made.append(level_row(claim_id, printed_name(place, channel, kind), condition, found, name, channel, remark))
    reason = f"{UNPUBLISHED} Ours stand beside them; the environment was chosen so that one of our EKFs has about the published error."
    return [*made, words_row(claim_id, "overall gain", made[0].n, NEW, Verdict.UNTESTABLE, reason)]


def judge_ratio(results: Results, claim_id: str) -> list[Row]:
    """C3, C4, C6 to C8c: is the method's error smaller than either EKF's, and by as much as printed?"""
    place, channels = RATIO_CLAIMS[claim_id]
    decisive, others, verdicts = [], [], {}
    for channel in channels:
        verdicts[channel], found = channel_verdict(results, place, channel, claim_id)
        decisive += found
        published = printed_ratio(results, place, channel)
        for setting in other_settings(place):
            rule = partial(ratio_rule, published=published)
            others += against_both(results, claim_id, ratio_name(place, channel), setting, channel, rule, published)
    verdict = weakest(verdicts.values())
    weak = next(channel for channel in channels if verdicts[channel] == verdict)
    shown = [row for row in decisive if row.quantity == ratio_name(place, weak)]
    rest = {NAMES[name]: word for name, word in verdicts.items()}
    several = f" By channel: {listing(rest)} The weakest decides." if len(channels) > 1 else ""
    quantity = ratio_name(place, weak) if len(channels) == 1 else f"{place.upper()} RMSE ratios, New over EKF"
    reason = f"T1-frozen settings, out of sample, {NAMES[weak]}. {against_each(shown)}{several}"
    return [*decisive, *others, closing_row(claim_id, quantity, verdict, reason, shown)]


def judge_unchanged(results: Results) -> list[Row]:
    """C5: V_up has the same error with both methods on the first trajectory."""
    quantity, channel = ratio_name("t1", "v_up"), "v_up"
    published = printed_ratio(results, "t1", channel)
    decisive = against_both(results, "C5", quantity, frozen_setting("t1"), channel, unchanged_rule, published)
    others = []
    for setting in other_settings("t1"):
        others += against_both(results, "C5", quantity, setting, channel, unchanged_rule, published)
    verdict = together(row.verdict for row in decisive)
    reason = f"T1-frozen settings, out of sample. {against_each(decisive)} No filter here has a state for the pitch that V_up is made from."
    closing = closing_row("C5", "T1 vUp nearly unchanged", verdict, reason, decisive)
    return [*decisive, *others, *pitch_rows(results), closing]


def pitch_rows(results: Results) -> list[Row]:
    """V_up with the pitch as printed and corrected: levels beside the paper's, and the UKF over each EKF (data sheet's variances)."""
    made = []
    for tilt in TILTS:
        words = "pitch as printed" if tilt == "as run" else "pitch corrected"

        def at(name: str, tilt: str = tilt) -> Where:
            return where("ablations", trajectory="t1", ablation=tilt, filter=name)

        for name, kind in ((BASELINES[0], "EKF"), (BASELINES[1], "EKF"), ("ukf", "New-Algorithm")):
            found = mean_of(results, at(name), "v_up")
            remark = f"Geometric mean of {found.n} runs, data sheet's variances, no gate."
            made.append(level_row("C5", printed_name("t1", "v_up", kind), words, found, name, "v_up", remark))
        for name in BASELINES:
            ratio = ratio_of(results, at("ukf"), at(name), "v_up")
            verdict, reason = unchanged_rule(ratio, MINIMUM["side_runs"])
            made.append(ratio_row("C5", ratio_name("t1", "v_up"), words, ratio, f"ukf/{name}", verdict, reason))
    return made


def level_rule(runs: np.ndarray, level: float, minimum: int) -> tuple[Verdict, str]:
    """Could a run of ours have the published level? `runs` in its unit, a failed run infinite."""
    if words := too_small(len(runs), minimum):
        return Verdict.TOO_SMALL, words
    low, high = np.quantile(runs, [0.025, 0.975], method="inverted_cdf")
    text = f"Central 95 % of {len(runs)} runs: {low:.3g} to {high:.3g} deg" if np.isfinite(high) else f"Runs from {low:.3g} deg up"
    if not np.isfinite(low):
        return Verdict.NOT_REPLICATED, "All runs fail."
    if low <= level <= high:
        return Verdict.COMPATIBLE, f"{text}; the published {level:.4g} deg is one of them, which does not say where it comes from."
    return Verdict.NOT_REPLICATED, f"{text}; the published {level:.4g} deg is none of them."


def wrap_rows(results: Results) -> list[Row]:
    """What the published levels of the azimuth may mean: ours wrapped and not, and two numbers of arithmetic for each."""
    made = []
    for kind, names in (("EKF", BASELINES), ("New-Algorithm", (NEW,))):
        level, quantity = printed(results, "t2", "azimuth", kind), printed_name("t2", "azimuth", kind)
        for name in names:
            for measure, words in (("azimuth", "difference wrapped"), ("azimuth_unwrapped", "difference not wrapped")):
                at = variant(name, "t2")
                runs, failed = values(results, at, measure)
                verdict, reason = level_rule(np.where(failed, np.inf, np.degrees(runs)), level, MINIMUM["runs"])
                found = mean_of(results, at, measure)
                made.append(numeric_row("C9", quantity, words, found, found.n, name, verdict, reason, factor_of("azimuth")))
        share = (level / 360.0) ** 2
        reason = f"A difference that is not wrapped, off by 360 deg in {share:.2%} of the samples and right elsewhere, has {level:.4g} deg."
        made.append(words_row("C9", quantity, 0, "", Verdict.COMPATIBLE, reason, "arithmetic, share not wrapped", f"{share:.2%}"))
        uniform = 180.0 / np.sqrt(3.0)
        near = abs(level / uniform - 1.0) < NEAR_UNIFORM
        reason = (
            f"An azimuth of which nothing is known has {uniform:.2f} deg; the published {level:.4g} deg is {level / uniform:.1%} of it."
        )
        verdict = Verdict.COMPATIBLE if near else Verdict.NOT_REPLICATED
        made.append(words_row("C9", quantity, 0, "", verdict, reason, "arithmetic, uniform error", f"{uniform:.2f} deg"))
    return made


def judge_azimuth(results: Results) -> list[Row]:
    """C9: the azimuth of the second trajectory, its ratio and what its level means."""
    verdict, decisive = channel_verdict(results, "t2", "azimuth", "C9")
    published, quantity = printed_ratio(results, "t2", "azimuth"), ratio_name("t2", "azimuth")
    rule = partial(ratio_rule, published=published)
    others = []
    for setting in other_settings("t2"):
        others += against_both(results, "C9", quantity, setting, "azimuth", rule, published)
    unwrapped = f"{quantity}, difference not wrapped"
    others += against_both(results, "C9", unwrapped, frozen_setting("t2"), "azimuth_unwrapped", rule, published)
    wraps = wrap_rows(results)
    ekf = [row for row in wraps if row.quantity.endswith("EKF")]
    explained = "; ".join(f"{row.condition} ({row.variant or 'no filter'}) {row.verdict}" for row in ekf)
    level = f"The EKF's level {printed(results, 't2', 'azimuth', 'EKF'):.4g} deg: {explained}."
    reason = f"T1-frozen settings, out of sample, difference wrapped. {against_each(decisive)} {level}"
    return [*decisive, *others, *wraps, closing_row("C9", quantity, verdict, reason, decisive)]
