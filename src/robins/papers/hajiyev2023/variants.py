"""The registry of filters: each is a row that names a form of `estimators` and its options. An ablation is a row, not a filter."""

from typing import NamedTuple


class Variant(NamedTuple):
    """What readers call it, its family (`robins.publish.style`), and its composition: the form and the form's options."""

    label: str
    family: str
    composition: dict


VARIANTS = {
    "ckf": Variant("CKF", "classical", {"form": "classical"}),
    "ckf-inflated": Variant("CKF, inflated R", "inflated", {"form": "classical", "inflated": True}),
    "akf": Variant("AKF", "augmented", {"form": "augmented"}),
    "mdkf-printed": Variant("MDKF as printed", "differencing", {"form": "printed"}),
    "amdkf-printed": Variant("AMDKF as printed", "adaptive-differencing", {"form": "printed", "rule": "per-channel"}),
    "amdkf-gated": Variant("AMDKF, gated", "gated", {"form": "printed", "rule": "gated"}),
    "amdkf-scalar-trace": Variant("AMDKF, one factor (trace)", "scalar", {"form": "printed", "rule": "scalar-trace"}),
    "amdkf-scalar-mean": Variant("AMDKF, one factor (mean)", "scalar", {"form": "printed", "rule": "scalar-mean"}),
    "bh": Variant("BH (corrected)", "corrected", {"form": "corrected"}),
    "abh": Variant("ABH (corrected, adaptive)", "corrected-adaptive", {"form": "corrected", "rule": "per-channel"}),
    "aakf": Variant("AAKF", "augmented-adaptive", {"form": "augmented", "rule": "per-channel"}),
    "oracle": Variant("Oracle AKF", "oracle", {"form": "oracle"}),
    "mdkf-lagged": Variant("MDKF, one step late", "lagged", {"form": "late"}),
    "amdkf-lagged": Variant("AMDKF, one step late", "lagged", {"form": "late", "rule": "per-channel"}),
}
