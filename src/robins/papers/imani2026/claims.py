"""Every claim of the paper and the module whose rule judges it (brief, section 3.2).

The row ``overall`` is decided under the headline condition alone: tuned filters in F1 against the truth, 10 Hz, zero-mean
normal-inverse-Gaussian gyro noise, no outliers. Other formulations, settings, noise and rates have rows of their own, so that a
reader sees on what a verdict depends.
"""

from collections.abc import Iterable
from functools import partial

from robins.papers.imani2026.claims_attribution import EKF_NEEDS, KERNEL_NEEDS, judge_kernels, judge_moderate
from robins.papers.imani2026.claims_errors import judge_angles, judge_domains, judge_drift, judge_means
from robins.papers.imani2026.claims_navigation import judge_position, judge_rates
from robins.papers.imani2026.claims_numbers import judge_largest, judge_velocity
from robins.papers.imani2026.claims_theory import judge_increment, judge_moments, judge_normality
from robins.papers.imani2026.judging import MINIMUM, STUDIES, VARIANT_NEEDS
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Claim

COMPARED = (*VARIANT_NEEDS, *STUDIES)
SWEEP = MINIMUM["sweep_runs"]


def _claim(claim_id: str, statement: str, judge, needs: Iterable[str], size: str = "runs", minimum: int | None = None) -> Claim:
    module = getattr(judge, "func", judge).__module__
    return Claim(claim_id, statement, judge, tuple(needs), (module,), size, MINIMUM["runs"] if minimum is None else minimum)


CLAIMS: tuple[Claim, ...] = (
    _claim("C1", "The MKMC-EKF's velocity RMSE is 37 % to over 99 % below the CI-RKF's.", judge_velocity, COMPARED),
    _claim(
        "C2", "Its acceleration RMSE is up to 99 % below.", partial(judge_largest, claim_id="C2", group="acceleration"), COMPARED
    ),
    _claim(
        "C3", "Its angular-rate RMSE is up to 99 % below.", partial(judge_largest, claim_id="C3", group="angular rate"),
        (*COMPARED, "theory"),
    ),
    _claim("C4", "RMSE, mean error and final drift of the Euler angles are all lower.", judge_angles, COMPARED),
    _claim("C5", "The gyro's residuals have skewness 2.64 and excess kurtosis 19.91.", judge_moments, ("drive", "theory"), minimum=0),
    _claim("C6", "Tests reject that the residuals are normal.", judge_normality, ("theory",)),
    _claim("C7", "The MKMC-EKF is better than the CI-RKF in all domains.", judge_domains, COMPARED),
    _claim("C8", "With the MKMC-EKF the final drift is near zero.", judge_drift, COMPARED),
    _claim("C9", "The mean error is dramatically lower.", judge_means, COMPARED),
    _claim("C10", "The CI-RKF is a moderate improvement on the EKF.", judge_moderate, (*EKF_NEEDS, *STUDIES)),
    _claim("C11", "The improvement is due to several kernels.", judge_kernels, (*KERNEL_NEEDS, "ci-seq", *STUDIES)),
    _claim("C12", "Position drift is reduced.", judge_position, VARIANTS, minimum=0),
    _claim("C13", "The filter copes with atomic sensors' 1 to 10 Hz.", judge_rates, ("drive", "rates"), "sweep_runs", SWEEP),
    _claim("C14", "The chi-square increment (30) has one degree of freedom.", judge_increment, ("theory",), "", 0),
)  # fmt: skip
"""Every claim, in the brief's order."""
