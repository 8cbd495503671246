"""Every claim of the paper and the module whose rule judges it (brief, section 4).

The row ``overall`` is decided under the headline condition alone: settings frozen on tuning runs of the first trajectory, other runs,
the frozen environment, and always against both readings of the EKF. T2-frozen settings, settings in sample and other severities have
rows of their own, so that a reader sees on what a verdict depends.
"""

from collections.abc import Iterable
from functools import partial

from robins.papers.ghouneem2024.claims_parts import GATE_NEEDS, JOINT_NEEDS, TUNING_NEEDS, judge_gate, judge_joint, judge_self_tuning
from robins.papers.ghouneem2024.claims_ratios import (
    LEVEL_NEEDS,
    UNCHANGED_NEEDS,
    judge_azimuth,
    judge_levels,
    judge_ratio,
    judge_unchanged,
)
from robins.papers.ghouneem2024.claims_settings import SETTING_NEEDS
from robins.papers.ghouneem2024.claims_sigma_points import (
    CONVERGENCE_NEEDS,
    TRANSFORM_NEEDS,
    judge_convergence,
    judge_moments,
    judge_transform,
)
from robins.papers.ghouneem2024.claims_words import (
    INSPECTION_NEEDS,
    SMOOTH_NEEDS,
    judge_cost,
    judge_inspection,
    judge_prior,
    judge_smoothness,
)
from robins.papers.ghouneem2024.judging import MINIMUM
from robins.papers.protocol import Claim


def _claim(claim_id: str, statement: str, judge, needs: Iterable[str], size: str = "runs", minimum: int | None = None) -> Claim:
    module = getattr(judge, "func", judge).__module__
    least = MINIMUM.get(size, 0) if minimum is None else minimum
    return Claim(claim_id, statement, judge, tuple(dict.fromkeys(needs)), (module,), size, least)


def _ratio(claim_id: str, statement: str) -> Claim:
    return _claim(claim_id, statement, partial(judge_ratio, claim_id=claim_id), SETTING_NEEDS)


CLAIMS: tuple[Claim, ...] = (
    _claim("C1", "The RMSE of Table II, first trajectory.", partial(judge_levels, place="t1"), LEVEL_NEEDS, minimum=0),
    _claim("C2", "The RMSE of Table III, second trajectory.", partial(judge_levels, place="t2"), LEVEL_NEEDS, minimum=0),
    _ratio("C3", "First trajectory: the new method's azimuth RMSE is below the EKF's."),
    _ratio("C4", "First trajectory: its east and north velocities are better."),
    _claim("C5", "First trajectory: the up velocity is unchanged.", judge_unchanged, UNCHANGED_NEEDS),
    _ratio("C6", "First trajectory: its latitude and longitude are better."),
    _ratio("C7", "First trajectory: its altitude is better."),
    _ratio("C8a", "Second trajectory: its latitude is better."),
    _ratio("C8b", "Second trajectory: its longitude, east and north velocity and altitude are better."),
    _ratio("C8c", "Second trajectory: its up velocity is better."),
    _claim("C9", "Second trajectory: its azimuth is better, from a very high level.", judge_azimuth, SETTING_NEEDS),
    _claim("C10", "The UKF is better because it does not linearise.", judge_transform, TRANSFORM_NEEDS),
    _claim("C11", "Self-tuning improves accuracy and convergence.", judge_self_tuning, TUNING_NEEDS),
    _claim("C12", "The tuning is dynamic and in real time.", judge_inspection, INSPECTION_NEEDS, "", 0),
    _claim("C13", "The gate keeps bad fixes from the filter and improves it.", judge_gate, GATE_NEEDS),
    _claim("C14", "Sigma points facilitate convergence.", judge_convergence, CONVERGENCE_NEEDS, "side_runs"),
    _claim("C15", "The EKF is simple to compute, the UKF complex.", judge_cost, ("cost",), "", 0),
    _claim("C16", "The new method's track is smoother.", judge_smoothness, SMOOTH_NEEDS),
    _claim("C17", "The UKF has mean and covariance right up to the third order.", judge_moments, ("theory",), "", 0),
    _claim("C18", "Zero or tiny P0 impedes convergence.", judge_prior, ("prior",), "side_runs"),
    _claim("C19", "The gain comes from the three parts jointly.", judge_joint, JOINT_NEEDS),
)
"""Every claim, in the brief's order."""
