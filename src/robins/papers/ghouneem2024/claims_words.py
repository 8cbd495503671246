"""Claims in words: "real-time" tuning (C12), the cost of a step (C15), the smoother track (C16), small P0 (C18)."""

import numpy as np

from robins.evaluate.intervals import Interval
from robins.evaluate.ledger import Row
from robins.evaluate.published import rows_of
from robins.evaluate.verdicts import Verdict
from robins.papers.ghouneem2024.claims_settings import SETTING_NEEDS, against_both, frozen_setting, other_settings
from robins.papers.ghouneem2024.comparisons import Where, ratio_of, variant, where
from robins.papers.ghouneem2024.cost import PAIR, RECORD
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.judging import (
    MINIMUM,
    closing_row,
    listing,
    most_rule,
    numeric_row,
    ratio_row,
    ratio_rule,
    sooner,
    times,
    together,
    words_row,
)
from robins.papers.ghouneem2024.studies import PRIOR_ERROR, PRIOR_SCALES
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import variant_name
from robins.papers.protocol import Results

LEAKED = ("ekf-pi", "ukf")
"""Filters that the study in sample has."""
INSPECTION_NEEDS = ("in-sample", *(variant_name(name, cell) for name in LEAKED for cell in ("st", "st-gate")))
SMOOTH_NEEDS = SETTING_NEEDS
SMALL = tuple(scale for scale in PRIOR_SCALES if scale <= 1e-4)
"""Scales of P0 that are "zeros or minimal values"."""
UKF = "ukf"
FULL = 1.0


def quote(results: Results, claim_id: str, quantity: str) -> str:
    """The paper's words, as the published table quotes them; "" where it has none."""
    found = rows_of(results.published, claim_id)
    texts = found.loc[found["quantity"] == quantity, "quote_max_12_words"]
    return str(texts.iloc[0]) if len(texts) else ""


def judge_inspection(results: Results) -> list[Row]:
    """C12: is Q updated online, and is a reference needed? The paper's section II-A against its abstract."""
    against = {name: quote(results, "C12", name) for name in ("Q constant", "reference needed")}
    made = []
    for name, words in against.items():
        verdict = Verdict.REFUTED if words else Verdict.UNTESTABLE
        reason = f'Section II-A: "{words}".' if words else "The published table has no such sentence."
        made.append(words_row("C12", name, 0, "", verdict, reason, "inspection"))
    verdict = inspection_word([row.verdict for row in made])
    told = " ".join(row.reason for row in made)
    reason = (
        f'The abstract says "{quote(results, "C12", "tuning dynamic")}". {told} (12) and (13) are averages over a whole drive against the '
        "reference, taken once: what has to be known before the drive is not tuned in real time."
    )
    return [*made, *leakage_rows(results), words_row("C12", "tuning dynamic", 0, "", verdict, reason)]


def inspection_word(verdicts: list[str]) -> Verdict:
    """One sentence of the paper against the claim refutes it; without any it cannot be tested."""
    return Verdict.REFUTED if Verdict.REFUTED in verdicts else Verdict.UNTESTABLE


def leakage_rows(results: Results) -> list[Row]:
    """What the reference of the very run is worth: horizontal error tuned in sample over that with frozen settings."""
    made = []
    for place in TRAJECTORIES:
        for name in LEAKED:
            for cell in ("st", "st-gate"):
                inside = where("in-sample", trajectory=place, filter=name, cell=cell)
                for frozen in TRAJECTORIES:
                    found = ratio_of(results, inside, variant(variant_name(name, cell), place, frozen), "horizontal")
                    verdict, reason = ratio_rule(found, MINIMUM["in_sample_runs"])
                    reason = f"How much the reference of the evaluated run is worth, not whether it is needed. {reason}"
                    if verdict != Verdict.TOO_SMALL:
                        verdict = Verdict.COMPATIBLE
                    condition = f"{place.upper()}, {cell}, in sample over {frozen.upper()}-frozen"
                    made.append(ratio_row("C12", "reference needed", condition, found, f"{name}-{cell}", verdict, reason))
    return made


def judge_cost(results: Results) -> list[Row]:
    """C15: a step of the UKF takes longer than one of the EKF, by the committed benchmark record."""
    quantity, table = "computation, UKF", results.table("cost")
    if table.empty:
        record = "/".join(RECORD.parts[-3:])
        reason = f"There is no benchmark record {record}: run times are never taken in the workflow."
        return [words_row("C15", quantity, 0, PAIR, Verdict.UNTESTABLE, reason)]
    row = table.iloc[0]
    found = Interval(float(row["ratio"]), float(row["least"]), float(row["greatest"]), int(row["rounds"]))
    side = "lies above 1" if found.low > 1.0 else "lies below 1" if found.high < 1.0 else "contains 1"
    verdict = {"lies above 1": Verdict.REPLICATED, "lies below 1": Verdict.NOT_REPLICATED, "contains 1": Verdict.INCONCLUSIVE}[side]
    numbers = f"{found.estimate:.3g} (range of {found.n} rounds {found.low:.3g} to {found.high:.3g})"
    reason = (
        f"A step of the UKF takes {float(row['ukf_us']):.3g} us, one of the EKF {float(row['ekf_us']):.3g} us: ratio {numbers}; the range "
        f"{side}. Same code style, one machine: {row['machine']}."
    )
    return [numeric_row("C15", quantity, "overall", found, found.n, PAIR, verdict, reason, unit="1")]


def judge_smoothness(results: Results) -> list[Row]:
    """C16: the track of the new method is smoother and more accurate than the EKF's."""
    made, verdicts, quantity = [], {}, "track of the new method"
    for measure, words in (("roughness", "smoother"), ("horizontal", "more accurate")):
        for place in TRAJECTORIES:
            for setting in (frozen_setting(place), *other_settings(place)):
                worded = setting._replace(words=f"{place.upper()}, {words}, {setting.words}")
                found = against_both(results, "C16", quantity, worded, measure)
                made += found
                if setting.words == "T1-frozen":
                    verdicts[measure, place] = (together(row.verdict for row in found), found)
    decisive = [row for place in TRAJECTORIES for row in verdicts["roughness", place][1]]
    verdict = together(row.verdict for row in decisive)
    told = " ".join(f"{row.condition[:2]} from {row.variant.split('/')[1]}, {row.verdict}: {row.reason}" for row in decisive)
    accurate = listing({place.upper(): verdicts["horizontal", place][0] for place in TRAJECTORIES})
    reason = (
        f"Root mean square of the second difference of the horizontal position error, T1-frozen settings, out of sample. {told} "
        f"More accurate (horizontal, both EKFs): {accurate}"
    )
    return [*made, closing_row("C16", quantity, verdict, reason, decisive)]


def judge_prior(results: Results) -> list[Row]:
    """C18: with zero or tiny P0 the azimuth settles later than with the data sheet's."""
    quantity, made, decisive = "small P0", [], {}
    for place in TRAJECTORIES:
        for name in FILTERS:

            def at(scale: float, place: str = place, name: str = name) -> Where:
                return where("prior", trajectory=place, prior_scale=scale, filter=name)

            for scale in [scale for scale in PRIOR_SCALES if scale != FULL]:
                share = sooner(results, [(at(FULL), at(scale))])
                what = f"With the data sheet's P0 the azimuth settles sooner than with {scale:g} times that"
                verdict, reason = most_rule(share, MINIMUM["side_runs"], what)
                if name == UKF and scale == 0.0:
                    verdict, reason = Verdict.UNTESTABLE, "A P0 of zero has no Cholesky factor: the UKF fails at once, whatever P0 does."
                own = times(results, at(scale))
                reason = f"{reason} With the small one {int(np.isinf(own).sum())} of {own.size} never settle or fail."
                condition = f"{place.upper()}, P0 x {scale:g}, settles later"
                made.append(numeric_row("C18", quantity, condition, share, share.n, name, verdict, reason, unit="1"))
                if scale in SMALL and not (name == UKF and scale == 0.0):
                    decisive[f"{place.upper()} {name} x {scale:g}"] = made[-1]
                for measure in ("azimuth", "horizontal"):
                    found = ratio_of(results, at(FULL), at(scale), measure)
                    verdict, reason = ratio_rule(found, MINIMUM["side_runs"])
                    reason = f"RMSE with the data sheet's P0 over that with the small one. {reason}"
                    made.append(ratio_row("C18", quantity, f"{place.upper()}, P0 x {scale:g}, {measure}", found, name, verdict, reason))
    verdicts = {words: row.verdict for words, row in decisive.items()}
    reason = (
        f"Does the azimuth settle later in most runs with P0 times {' or '.join(f'{scale:g}' for scale in SMALL)}? {listing(verdicts)} "
        f"Clean "
        f"fixes, first azimuth wrong by {np.degrees(PRIOR_ERROR):.0f} deg. A P0 of zero has no Cholesky factor, so the UKF fails at "
        f"once: that "
        "says something of the factorisation, and is not counted."
    )
    return [*made, closing_row("C18", quantity, together(verdicts.values()), reason, list(decisive.values()), larger=True)]
