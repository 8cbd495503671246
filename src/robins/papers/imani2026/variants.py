"""The registry of filters: each is a row, an ablation too.

"tuned" names the family whose tuning job gives the two knobs (`robins.papers.imani2026.methods.FAMILIES`); "start" overrides
where a fixed-point iteration begins. Other rows have the conventional settings of the configuration.
"""

from typing import NamedTuple


class Variant(NamedTuple):
    """What readers call it, its kind (`robins.papers.imani2026.palette`), and its composition."""

    label: str
    family: str
    composition: dict


VARIANTS = {
    "ekf": Variant("EKF", "ekf", {"method": "ekf"}),
    "ekf-tuned": Variant("EKF, tuned", "ekf", {"tuned": "ekf"}),
    "no-update": Variant("no update", "no-update", {"method": "no-update"}),
    "ekf-r4": Variant("EKF, R x 1e4", "inflated", {"method": "ekf", "decades": 4}),
    "ekf-r8": Variant("EKF, R x 1e8", "inflated", {"method": "ekf", "decades": 8}),
    "ci-seq": Variant("CI-RKF (tuned)", "chi-square", {"tuned": "ci-seq"}),
    "ci-seq-nominal": Variant("CI-RKF", "chi-square", {"method": "chi-square"}),
    "ci-marg": Variant("CI-RKF, marginal", "chi-square", {"method": "chi-square", "kind": "marginal"}),
    "ci-temp": Variant("CI-RKF, difference in time", "chi-square", {"method": "chi-square", "kind": "temporal"}),
    "ci-corr": Variant("CI-RKF, corrected (tuned)", "chi-square-corrected", {"tuned": "ci-corr"}),
    "ci-corr-nominal": Variant("CI-RKF, corrected", "chi-square-corrected", {"method": "chi-square", "correct": True}),
    "ci-nobar": Variant("CI-RKF, plain R", "as-printed", {"method": "chi-square-plain-r"}),
    "ci-sqrt": Variant("CI-RKF, root", "chi-square", {"method": "chi-square", "shape": "root"}),
    "ci-reject": Variant("CI-RKF, reject", "chi-square", {"method": "chi-square", "shape": "reject"}),
    "gate": Variant("gate (tuned)", "gated", {"tuned": "gate"}),
    "gate-nominal": Variant("gate, 95 %", "gated", {"method": "gate", "threshold": 1.959963984540054}),
    "single-kernel": Variant("single kernel, R / w (tuned)", "single-kernel", {"tuned": "single-kernel"}),
    "single-kernel-gain": Variant("single kernel, K W (tuned)", "single-kernel", {"tuned": "single-kernel-gain"}),
    "mk-norm": Variant("multi-kernel, R / w (tuned)", "multi-kernel", {"tuned": "mk-norm"}),
    "mk-norm-nominal": Variant("multi-kernel, R / w", "multi-kernel", {"method": "correntropy"}),
    "mk-norm-gain": Variant("MKMC-EKF (tuned)", "multi-kernel-gain", {"tuned": "mk-norm-gain"}),
    "mk-norm-gain-nominal": Variant("MKMC-EKF", "multi-kernel-gain", {"method": "correntropy", "on_gain": True}),
    "mk-raw": Variant("MKMC-EKF as printed", "as-printed", {"method": "correntropy-raw"}),
    "mk-li": Variant("fixed point, Li (tuned)", "fixed-point", {"tuned": "mk-li"}),
    "mk-li-warm": Variant("fixed point, Li, warm start", "fixed-point", {"tuned": "mk-li", "start": "warm"}),
    "mcc1": Variant("fixed point, Chen (tuned)", "fixed-point", {"tuned": "mcc1"}),
    "huber": Variant("Huber (tuned)", "huber", {"tuned": "huber"}),
    "huber-nominal": Variant("Huber, 1.345", "huber", {"method": "huber"}),
}
