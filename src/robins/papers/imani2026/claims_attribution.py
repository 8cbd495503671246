"""What the improvement comes from: CI-RKF over the EKF (C10), the multi-kernel over its simpler relatives (C11)."""

from collections.abc import Sequence

from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import Verdict
from robins.papers.imani2026.comparisons import PAIR
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.judging import (
    HEADLINE,
    NAMES,
    Case,
    Cell,
    cells_of,
    cells_row,
    combine_many,
    conjunction,
    grade_sweep,
    improvement_row,
    majority,
    outlier_sweep,
    rate_sweep,
    without_interval,
)
from robins.papers.protocol import Results

OVER_EKF = {"tuned": ("ci-seq", "ekf-tuned"), "conventional settings": ("ci-seq-nominal", "ekf")}
"""The CI-RKF and the EKF that it is compared with."""
MKMC_OVER_EKF = {"tuned": (PAIR[0], "ekf-tuned"), "conventional settings": ("mk-norm-gain-nominal", "ekf")}
RIVALS = {
    "mk-norm-gain": ("single-kernel-gain", "mcc1", "gate", "ci-corr"),
    "mk-norm": ("single-kernel", "mcc1", "gate", "ci-corr"),
}
"""What would have to be worse for the several kernels to be the cause: one kernel in the same form of update, the fixed point with one
kernel, a hard gate, the corrected CI-RKF."""
BESIDE = ("huber",)
"""Compared too, without a say in the verdict."""
SWEPT_RIVALS = ("single-kernel", "gate", "ci-corr")
EKF_NEEDS = tuple(dict.fromkeys(name for pair in (*OVER_EKF.values(), *MKMC_OVER_EKF.values()) for name in pair))
KERNEL_NEEDS = tuple(dict.fromkeys((*RIVALS, *(rival for rivals in RIVALS.values() for rival in rivals), *BESIDE)))


def judge_moderate(results: Results) -> list[Row]:
    """C10: the CI-RKF improves on the EKF in most channels."""
    quantity, both = (
        "CI-RKF moderately improves stability (over standard filtering)",
        "both robust filters superior to EKF in suppressing disturbances",
    )
    rows, judged = [], {}
    for words, pair in OVER_EKF.items():
        case = Case(f"F1, {words}", pair)
        cells = cells_of(results, case, CHANNELS)
        rows += [improvement_row("C10", quantity, f"{case.words}, {NAMES[cell.channel]}", case, cell) for cell in cells]
        together = cells_row("C10", quantity, case, cells, majority)
        rows.append(together)
        judged[words] = together
        for formulation in ("F0", "F2"):
            other = Case(f"{formulation}, {words}", pair, formulation)
            rows.append(cells_row("C10", quantity, other, cells_of(results, other, CHANNELS), majority))
    for words in OVER_EKF:
        for pair in (OVER_EKF[words], MKMC_OVER_EKF[words]):
            case = Case(f"F1, {words}", pair)
            rows.append(cells_row("C10", both, case, cells_of(results, case, CHANNELS), majority))
    for pair in (OVER_EKF["tuned"], MKMC_OVER_EKF["tuned"]):
        for case in (*outlier_sweep(pair), *grade_sweep(pair), *rate_sweep(results, pair)):
            rows.append(cells_row("C10", both, case, cells_of(results, case, CHANNELS), majority))
    told = " ".join(f"{words}, {row.verdict}: {row.reason}" for words, row in judged.items())
    reason = f"RMSE in F1 against the truth, both tuned; a majority of the twelve channels has to improve. {told}"
    return [*rows, without_interval("C10", quantity, rows[0].n, OVER_EKF["tuned"][0], judged["tuned"].verdict, reason)]


def judge_kernels(results: Results) -> list[Row]:
    """C11: the multi-kernel better than every simpler filter that had the same tuning budget."""
    quantity, several = "superiority attributed to multi-kernel framework", "several bandwidths instead of one give adaptive sensitivity"
    rows, of_channel = [], {channel: [] for channel in CHANNELS}
    for kernel, rivals in RIVALS.items():
        for rival in (*rivals, *BESIDE):
            case = Case("F1", (kernel, rival))
            cells = cells_of(results, case, CHANNELS)
            if kernel == PAIR[0] and rival not in BESIDE:
                rows += [improvement_row("C11", quantity, f"F1, {NAMES[cell.channel]}", case, cell) for cell in cells]
                for cell in cells:
                    of_channel[cell.channel].append(cell)
            rows.append(cells_row("C11", quantity, case, cells))
    for words, case in enhancement_cases():
        rows.append(cells_row("C11", words, case, cells_of(results, case, CHANNELS), condition=f"{case.words}, as stated"))
    for rival in SWEPT_RIVALS:
        pair = (PAIR[0], rival)
        for case in (*outlier_sweep(pair), *grade_sweep(pair), *rate_sweep(results, pair)):
            words = several if rival == "single-kernel" else quantity
            rows.append(cells_row("C11", words, case, cells_of(results, case, CHANNELS)))
    verdicts = {NAMES[channel]: conjunction([cell.verdict for cell in cells]) for channel, cells in of_channel.items()}
    verdict, found = combine_many(verdicts)
    reason = (
        f"F1, RMSE, tuned with one budget; in a channel the attribution is supported only if the interval lies above 0 against each of "
        f"{', '.join(RIVALS[PAIR[0]])}. By channel: {found} {by_rival(of_channel)}"
    )
    return [*rows, without_interval("C11", quantity, rows[0].n, PAIR[0], verdict, reason)]


def enhancement_cases() -> list[tuple[str, Case]]:
    """The paper's other sentences on the kernels, headline only."""
    return [
        ("several bandwidths instead of one give adaptive sensitivity", Case("F1", (PAIR[0], "single-kernel-gain"))),
        ("multi-kernel criterion gives substantial tracking enhancement", HEADLINE),
    ]


def by_rival(of_channel: dict[str, Sequence[Cell]]) -> str:
    """How many channels the multi-kernel wins against each rival."""
    told = []
    for i, rival in enumerate(RIVALS[PAIR[0]]):
        words = [cells[i].verdict for cells in of_channel.values()]
        above = sum(word in (Verdict.REPLICATED, Verdict.DIRECTION_ONLY) for word in words)
        below = sum(word == Verdict.NOT_REPLICATED for word in words)
        told.append(f"{rival} {above} above 0, {below} below")
    return f"Of twelve intervals: {'; '.join(told)}."
