"""What sigma points are worth: against an EKF with the same model (C10), for convergence (C14), and for moments (C17)."""

import numpy as np

from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import FAILURE_LIMIT, Verdict
from robins.papers.ghouneem2024.comparisons import GeometricRatio, Where, ratio_of, rows, variant, where
from robins.papers.ghouneem2024.judging import (
    MINIMUM,
    NAMES,
    closing_row,
    listing,
    lost_runs,
    most_rule,
    numbers_of,
    numeric_row,
    ratio_row,
    ratio_rule,
    sooner,
    times,
    together,
    too_small,
    unreliable,
    words_row,
)
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.studies import AZIMUTH_ERRORS, DATA_SHEET, MATCHED
from robins.papers.ghouneem2024.theory import LAWS, POWERS
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import CELLS
from robins.papers.ghouneem2024.variants import BASELINES, CONTROL, variant_name
from robins.papers.protocol import Results

UKF = "ukf"
MATERIAL = 0.95
"""Ratio that a gain has to be below to count as one."""
LARGE = 0.05
"""Relative difference between the UKF and the EKF with its model above which a sentence is owed."""
TRANSFORM_NEEDS = (UKF, CONTROL, *BASELINES, *(variant_name(name, cell) for name in (UKF, CONTROL) for cell in CELLS))
CONVERGENCE_NEEDS = ("initialisation",)
ALL = "all initial errors, P0 of the data sheet"
KNOWN = "all initial errors, P0 that knows them"
EXACT = 1e-9
"""Relative difference below which a moment counts as exact."""


def gain_rule(found: GeometricRatio, minimum: int) -> tuple[Verdict, str]:
    """Judge "supported only if the interval lies below 1 and the ratio is below `MATERIAL`" (brief, C10).

    An interval that contains 1 and reaches below `MATERIAL` leaves it open; one that contains 1 and does not excludes a gain.
    """
    if words := too_small(found.n, minimum):
        return Verdict.TOO_SMALL, words
    lost = lost_runs(found)
    if found.survivors < 2:
        return Verdict.NOT_REPLICATED, f"Fewer than two runs survive in both filters, so there is no ratio.{lost}"
    text = f"{numbers_of(found)}; a gain is an interval below 1 and a ratio below {MATERIAL:g}"
    if found.high < 1.0 and found.estimate < MATERIAL:
        if unreliable(found):
            limit = f"A filter that fails in more than {FAILURE_LIMIT:.0%} of the runs is never replicated."
            return Verdict.DIRECTION_ONLY, f"{text}: there is one.{lost} {limit}"
        return Verdict.REPLICATED, f"{text}: there is one.{lost}"
    if found.low <= 1.0 <= found.high and found.low < MATERIAL:
        return Verdict.INCONCLUSIVE, f"{text}: the interval contains 1 and reaches below {MATERIAL:g}.{lost}"
    return Verdict.NOT_REPLICATED, f"{text}: there is none.{lost}"


def largest_difference(results: Results, first: Where, second: Where, measure: str) -> float:
    """Largest relative difference of a measure over the runs that survive in both; NaN where there is none."""
    own, other = (rows(results, at).set_index("run") for at in (first, second))
    survived = ~(own["failed"] | other["failed"])
    if not survived.any():
        return float("nan")
    return float(np.max(np.abs(own[measure][survived] / other[measure][survived] - 1.0)))


def difference_words(results: Results, first: Where, second: Where, measure: str) -> str:
    """A sentence on `largest_difference`."""
    largest = largest_difference(results, first, second, measure)
    return f"Largest relative difference in a run {largest:.2g}." if np.isfinite(largest) else ""


def judge_transform(results: Results) -> list[Row]:
    """C10: the UKF against the EKF with the same model and variances, horizontal, all reporting runs; beside it the change of model."""
    made, decisive, reasons = [], [], []
    for place in TRAJECTORIES:
        above, below = variant(UKF, place), variant(CONTROL, place)
        for measure in ("horizontal", *CHANNELS):
            found = ratio_of(results, above, below, measure)
            verdict, reason = gain_rule(found, MINIMUM["runs"])
            reason = f"{reason} {difference_words(results, above, below, measure)}".rstrip()
            condition = f"{place.upper()}, data sheet's variances, no gate, {NAMES[measure]}"
            made.append(ratio_row("C10", "UKF superior", condition, found, f"{UKF}/{CONTROL}", verdict, reason))
            if measure == "horizontal":
                decisive.append(made[-1])
                reasons.append(f"{place.upper()}: {reason}")
    verdict = together(row.verdict for row in decisive)
    reason = f"Horizontal error, UKF over the EKF with its model and variances. {' '.join(reasons)} {large_differences(results)}"
    closing = closing_row("C10", "UKF superior", verdict, reason, decisive)
    return [*made, *cell_rows(results), *model_rows(results), closing]


def large_differences(results: Results) -> str:
    """Which channels differ by more than `LARGE` in some run (check 10 of the brief)."""
    named = []
    for place in TRAJECTORIES:
        for channel in CHANNELS:
            largest = largest_difference(results, variant(UKF, place), variant(CONTROL, place), channel)
            if largest > LARGE:
                named.append(f"{place.upper()} {NAMES[channel]} {largest:.2g}")
    if not named:
        return f"No channel differs by more than {LARGE:.0%} in any run."
    return f"Channels that differ by more than {LARGE:.0%} in some run, with the largest relative difference: {'; '.join(named)}."


def cell_rows(results: Results) -> list[Row]:
    """The same in the other cells of the factorial, where each filter has a tuning of its own."""
    made = []
    for place in TRAJECTORIES:
        for frozen in TRAJECTORIES:
            for cell in CELLS:
                above, below = (variant(variant_name(name, cell), place, frozen) for name in (UKF, CONTROL))
                found = ratio_of(results, above, below, "horizontal")
                verdict, reason = gain_rule(found, MINIMUM["runs"])
                condition = f"{place.upper()}, {frozen.upper()}-frozen, {cell}, horizontal"
                made.append(ratio_row("C10", "UKF non-linearity", condition, found, f"{above.job}/{below.job}", verdict, reason))
    return made


def model_rows(results: Results) -> list[Row]:
    """The other part of the filter factor: EKF with the UKF's model, and the UKF, over both readings of the paper's EKF."""
    made = []
    for place in TRAJECTORIES:
        for numerator, words in ((CONTROL, "change of model alone"), (UKF, "change of model and transform")):
            for baseline in BASELINES:
                found = ratio_of(results, variant(numerator, place), variant(baseline, place), "horizontal")
                verdict, reason = ratio_rule(found, MINIMUM["runs"])
                condition = f"{place.upper()}, data sheet's variances, no gate, horizontal, {words}"
                quantity = "linearisation degrades EKF accuracy"
                made.append(ratio_row("C10", quantity, condition, found, f"{numerator}/{baseline}", verdict, reason))
    return made


def started(place: str, error: float, name: str, alpha: float, prior: str = DATA_SHEET) -> Where:
    """Rows of the study of the initial azimuth."""
    return where("initialisation", trajectory=place, azimuth_error=error, prior=prior, filter=name, alpha=alpha)


def judge_convergence(results: Results) -> list[Row]:
    """C14: does the azimuth settle sooner with sigma points, from initial errors up to 179 deg with clean satellites?"""
    alpha, quantity = results.settings.options["alpha"], "convergence, UKF"
    made, decisive = [], {}
    wrong = [error for error in AZIMUTH_ERRORS if error > 0.0]
    for place in TRAJECTORIES:
        for rival in (CONTROL, *BASELINES):

            def pair(error: float, own: float, place: str = place, rival: str = rival, prior: str = DATA_SHEET) -> tuple[Where, Where]:
                return started(place, error, UKF, own, prior), started(place, error, rival, alpha, prior)

            cases = {ALL: [pair(error, alpha) for error in wrong]}
            cases |= {KNOWN: [pair(error, alpha, prior=MATCHED) for error in wrong]}
            cases |= {f"initial error {np.degrees(error):.0f} deg": [pair(error, alpha)] for error in AZIMUTH_ERRORS}
            if alpha != 1.0:
                cases[f"{ALL}, alpha 1"] = [pair(error, 1.0) for error in wrong]
            for words, pairs in cases.items():
                share = sooner(results, pairs)
                verdict, reason = most_rule(share, MINIMUM["side_runs"], "The UKF settles sooner")
                condition = f"{place.upper()}, {words}"
                made.append(numeric_row("C14", quantity, condition, share, share.n, f"{UKF}/{rival}", verdict, reason, unit="1"))
                if words in (ALL, KNOWN):
                    decisive[f"{place.upper()} against {rival}, {words}"] = made[-1]
    never = never_rows(results, alpha)
    counts = "; ".join(f"{row.condition} {row.variant} {row.ours}" for row in never)
    verdicts = {words: row.verdict for words, row in decisive.items()}
    own = [
        np.isinf(np.concatenate([times(results, started(place, error, UKF, alpha)) for error in AZIMUTH_ERRORS])) for place in TRAJECTORIES
    ]
    counts += "".join(f"; {place.upper()} {UKF} {int(lost.sum())} of {lost.size}" for place, lost in zip(TRAJECTORIES, own, strict=True))
    reason = (
        f"Share of the runs in which the UKF's azimuth settles within 5 deg sooner, at more initial errors than later: {listing(verdicts)} "
        f"Never settled with P0 of the data sheet: {counts}."
    )
    return [*made, *never, closing_row("C14", quantity, together(verdicts.values()), reason, list(decisive.values()), larger=True)]


def never_rows(results: Results, alpha: float) -> list[Row]:
    """Starts from which a linearised filter never settles, and in how many of these the UKF does."""
    made = []
    for place in TRAJECTORIES:
        for name in (CONTROL, *BASELINES):
            own, other = (
                np.array([times(results, started(place, error, each, alpha)) for error in AZIMUTH_ERRORS]) for each in (name, UKF)
            )
            lost, rescued = np.isinf(own), int(np.sum(np.isinf(own) & np.isfinite(other)))
            n = own.shape[1]
            verdict = Verdict.DIRECTION_ONLY if rescued else Verdict.NOT_REPLICATED if lost.any() else Verdict.COMPATIBLE
            reason = f"{int(lost.sum())} of {own.size} starts never settle; the UKF settles in {rescued} of these."
            if words := too_small(n, MINIMUM["side_runs"]):
                verdict, reason = Verdict.TOO_SMALL, f"{words} {reason}"
            ours = f"{int(lost.sum())} of {own.size}"
            made.append(words_row("C14", "convergence, EKF", n, name, verdict, reason, f"{place.upper()}, never settled", ours))
    return made


def judge_moments(results: Results) -> list[Row]:
    """C17: are mean and covariance of a square and a cube exact? Laws and moments separately, against exact moments."""
    table = results.table("theory")
    table = table[table["topic"] == "moments"].set_index("quantity")
    made, parts = [], {}
    own = f"unscented, alpha {results.settings.options['alpha']:g}"
    for quantity, row in table.iterrows():
        exact, value = float(row["expected"]), float(row["value"])
        apart = abs(value / exact - 1.0)
        verdict = Verdict.REPLICATED if apart < EXACT else Verdict.REFUTED
        what, law, method = str(quantity).split(", ", 2)
        if method == own:
            moment, power = what.split(" of the ")
            parts.setdefault((moment, law), {})[power] = verdict
        told = "exact" if verdict == Verdict.REPLICATED else f"{value:.6g}, the exact moment is {exact:.6g}: {apart:.2g} off"
        ours = f"{value:.6g} against {exact:.6g}"
        made.append(words_row("C17", f"{what}, {law}", 0, method, verdict, f"Analytic: {told}.", "exact moments", ours))
    verdicts = {f"{moment}, {law}": moment_word(list(found.values())) for (moment, law), found in parts.items()}
    words = set(verdicts.values())
    verdict = words.pop() if len(words) == 1 else Verdict.DEPENDS
    detail = "; ".join(
        f"{moment} of the {power}, {law} {'exact' if word == Verdict.REPLICATED else 'wrong'}"
        for (moment, law), found in parts.items()
        for power, word in found.items()
    )
    reason = f"A scalar through the maps {', '.join(POWERS)}, laws {', '.join(LAWS)}, {own}. {detail}. By part: {listing(verdicts)}"
    return [*made, words_row("C17", "order of accuracy of UKF mean and covariance", 0, UKF, verdict, reason)]


def moment_word(verdicts: list[Verdict]) -> Verdict:
    """Exact for every map, for none, or for some."""
    words = set(verdicts)
    return words.pop() if len(words) == 1 else Verdict.DEPENDS
