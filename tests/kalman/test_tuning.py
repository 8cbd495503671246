"""Covariance matching: its rules against numpy, and its limits."""

import numpy as np
import pytest

from robins.kalman.filter import run_filter
from robins.kalman.predict import Ekf
from robins.kalman.tuning import GATED, PER_CHANNEL, SCALAR_MEAN, SCALAR_TRACE, covariance_matching, matching
from robins.kalman.weights import weighting

RULES = {"per channel": PER_CHANNEL, "gated": GATED, "trace": SCALAR_TRACE, "mean": SCALAR_MEAN}
THRESHOLD = 1.5


def naive(rule, innovations, predicted, R, window, minimum):
    """Weights after the last of `innovations`, by the definition: hajiyev2023 equations (19)-(23)."""
    m = len(R)
    recent = innovations[-window:]
    if len(recent) < minimum:
        return np.ones(m)
    seen = sum(np.outer(d, d) for d in recent) / len(recent)  # (19)
    D = seen - predicted  # (21)
    if rule == SCALAR_TRACE:
        s = np.full(m, np.trace(D) / np.trace(R))
    elif rule == SCALAR_MEAN:
        s = np.full(m, np.mean(np.diag(D) / np.diag(R)))
    else:
        s = np.diag(D) / np.diag(R)
    if rule == GATED:
        s = np.where(np.diag(seen) > THRESHOLD * np.diag(predicted + R), s, 1.0)
    return 1 / np.maximum(1.0, s)  # (22), (23)


@pytest.mark.parametrize("minimum", [1, 4, 6])
@pytest.mark.parametrize("rule", RULES)
def test_every_rule_is_its_definition(rule, minimum, random_covariance):
    rng = np.random.default_rng(1)
    method = matching(6, 3, RULES[rule], THRESHOLD, minimum)
    memory, R = method.memory.copy(), np.diag([0.5, 1.0, 2.0])
    innovations, scaled = rng.normal(size=(40, 3)) * [3.0, 1.0, 2.0], 0
    for epoch in range(40):
        predicted, weights = 0.3 * random_covariance(rng, 3), np.ones(3)
        covariance_matching(innovations[epoch], predicted, R, method.parameters, memory, epoch, weights)
        expected = naive(RULES[rule], innovations[: epoch + 1], predicted, R, 6, minimum)
        np.testing.assert_allclose(weights, expected, rtol=1e-12)
        scaled += np.any(weights < 1.0)
    assert scaled > 10


def test_the_window_is_full_before_anything_is_scaled_unless_told_otherwise():
    assert matching(20, 3).parameters[3] == 20
    assert matching(20, 3, minimum=5).parameters[3] == 5


@pytest.mark.parametrize("rule", RULES)
def test_a_channel_without_noise_keeps_its_weight_and_harms_no_other(rule):
    method = matching(1, 2, RULES[rule], THRESHOLD)
    weights = np.ones(2)
    covariance_matching(np.array([5.0, 5.0]), np.eye(2), np.diag([0.0, 2.0]), method.parameters, method.memory.copy(), 0, weights)
    assert weights[0] == 1.0
    expected = 2 / (24 + 24) if rule == "trace" else 2 / 24
    assert weights[1] == pytest.approx(expected)


LIMITS = {
    "a window longer than the record": lambda rule: matching(1000, 3, rule, THRESHOLD),
    "an infinite threshold": lambda rule: matching(5, 3, GATED, np.inf),
}


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("limit", LIMITS)
def test_covariance_matching_has_the_plain_filter_as_its_limit(problem, rule, limit):
    case = problem(2)
    plain, limited, active = (
        run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)
        for method in (weighting("unit"), LIMITS[limit](RULES[rule]), matching(5, 3, RULES[rule], THRESHOLD))
    )
    np.testing.assert_allclose(limited.posterior, plain.posterior, rtol=0, atol=1e-10)
    np.testing.assert_allclose(limited.posterior_variance, plain.posterior_variance, rtol=0, atol=1e-10)
    assert np.abs(active.posterior - plain.posterior).max() > 0.01
