"""Theory, sweeps and the specification curve."""

from dataclasses import fields

import numpy as np
import pytest

from robins.evaluate.metrics import window_rms
from robins.papers.hajiyev2023 import studies
from robins.papers.hajiyev2023.as_printed import literal
from robins.papers.hajiyev2023.estimators import augmented, printed
from robins.papers.hajiyev2023.scenario import baseline
from robins.papers.hajiyev2023.studies import (
    ADAPTED,
    AUGMENTED,
    PLAIN,
    lag_one,
    pair_errors,
    specification,
    specification_parameters,
    sweep,
    sweep_settings,
    theory,
)
from robins.papers.protocol import Settings

SETTINGS = Settings("smoke", 1, {"runs": 8, "sweep_runs": 2, "specification_sets": 2, "specification_runs": 3}, {"plant": "f4c"})


def test_lag_one_of_a_moving_average_is_the_known_one():
    white = np.random.default_rng(2).standard_normal((400, 501, 1))
    assert lag_one(white[:, 1:] - white[:, :-1]).estimate == pytest.approx(-0.5, abs=0.01)


def test_lag_one_of_many_short_runs_is_not_biased_and_its_interval_covers_as_it_says():
    """An average of the runs' own ratios would be off by 0.03 here, far beyond its interval."""
    white = np.random.default_rng(3).standard_normal((2000, 13, 500))
    found = lag_one(white[:, 1:] - white[:, :-1])
    assert np.mean(found.estimate) == pytest.approx(-0.5, abs=0.001)
    covered = np.mean((found.low < -0.5) & (found.high > -0.5))
    assert covered == pytest.approx(0.95, abs=0.03), "500 channels: three standard errors"
    assert found.n == 2000


def test_theory_holds_the_correlation_and_the_loss_of_information():
    output = theory(SETTINGS)
    assert len(output.table) == 16
    assert ((output.table["value"] - output.table["theory"]).abs() < 0.1).all()
    loss = output.arrays["deg.information-loss"]
    np.testing.assert_allclose(loss[50], [2.103, 1.802, 1.005, 1.132, 1.000, 1.004, 1.029, 1.354], rtol=0, atol=5e-4)
    np.testing.assert_allclose(loss[50, 4:], output.arrays["rad.information-loss"][50, 4:], rtol=1e-9)
    assert output.arrays["deg.bh.no-v.innovation_autocorrelation"].shape == (21, 8)


def test_sweeps_are_those_of_the_brief():
    values = {}
    for name, label, value, _ in sweep_settings(baseline("deg")):
        values.setdefault(name, []).append(label if name == "multiplier" else value)
    assert values == {
        "window": [3, 5, 10, 15, 20, 30, 50],
        "multiplier": ["1, 1", "2, 1.25", "4, 2.5", "8, 5", "16, 10", "32, 20", "9, 6", "8, 1", "1, 5"],
        "duration": [10, 30, 70, 110],
        "tau": [2, 5, 20, 100, 500],
        "dt": [0.01, 0.02, 0.05, 0.1, 0.2],
        "sigma-v": [0.1, 1, 3],
        "sigma-w": [0.1, 1 / 3, 1, 3],
        "pitch-damping": [-0.4462],
    }


def test_each_sweep_changes_one_thing():
    base = baseline("rad")
    for name, label, _, parameters in sweep_settings(base):
        changed = [f.name for f in fields(base) if getattr(parameters, f.name) != getattr(base, f.name)]
        allowed = {"multiplier": {"multiplier_q", "multiplier_theta"}, "duration": {"fault_length"}}.get(name, {name.replace("-", "_")})
        assert set(changed) <= allowed, (name, label)


def test_the_score_moves_with_the_fault(problem):
    case = problem(3, fault_length=30)
    results = pair_errors({"mdkf-printed": printed(case.matrices, case.parameters)}, case.parameters, case.matrices, case.ensemble)
    errors = case.run(printed(case.matrices, case.parameters), "fault").posterior - case.ensemble.x
    np.testing.assert_allclose(results["mdkf-printed"][0], np.sqrt(np.sum(errors[:, 80:111] ** 2, axis=1) / 30), rtol=1e-12)


@pytest.fixture(scope="module")
def swept():
    return sweep(SETTINGS, "deg").table


def test_a_sweep_has_its_baseline_in_every_sweep(swept):
    """The settings that change nothing are the same computation."""
    base = {"window": "20", "multiplier": "8, 5", "duration": "70", "tau": "100", "dt": "0.1", "sigma-v": "1", "sigma-w": "1"}
    keys = ["run", "pair", "state", "numerator", "denominator"]
    frames = [swept[(swept["sweep"] == name) & (swept["setting"] == label)][keys].reset_index(drop=True) for name, label in base.items()]
    for frame in frames:
        assert frame.equals(frames[0]) and len(frame) == 2 * 2 * 8


def test_a_fault_of_factor_one_is_no_fault(swept, problem):
    case = problem(2, scenario="aircraft")
    rows = swept[(swept["setting"] == "1, 1") & (swept["pair"] == PLAIN)]
    errors = case.run(augmented(case.matrices, case.parameters), "healthy").posterior - case.ensemble.x
    np.testing.assert_allclose(rows["denominator"].to_numpy().reshape(2, 8), window_rms(errors, 80, 150, 70), rtol=1e-12)


def test_ablations_are_there_and_change_the_adaptive_filter(swept):
    rows = swept[swept["sweep"] == "ablation"]
    assert rows["setting"].unique().tolist() == ["partial window", "gated", "C = 0", "covariance unscaled"]
    plain = swept[(swept["sweep"] == "window") & (swept["setting"] == "20") & (swept["pair"] == ADAPTED)]
    for label, group in rows.groupby("setting"):
        same = np.allclose(group["denominator"], plain["denominator"], rtol=1e-12)
        assert same == (label != "C = 0")
        assert not np.allclose(group["numerator"], plain["numerator"], rtol=1e-6) or label == "partial window"


def test_unscaled_covariance_is_the_literal_filter(swept, problem):
    case = problem(2, scenario="aircraft")
    estimate, _ = literal(case.parameters, case.matrices, case.ensemble, "fault", 20, scale_covariance=False)
    rows = swept[swept["setting"] == "covariance unscaled"]
    expected = window_rms(estimate - case.ensemble.x, 80, 150, 70)
    np.testing.assert_allclose(rows["numerator"].to_numpy().reshape(2, 8), expected, rtol=1e-9)


def test_specification_sets_stay_in_their_ranges_and_branches_share_the_multipliers():
    base = {branch: baseline(branch) for branch in ("deg", "rad")}
    decades = {"sigma_w": 1.0, "sigma_v": 1.0, "sigma_lambda": 0.5, "sigma_0": 0.5}
    drawn = []
    for index in range(200):
        degrees, radians = (specification_parameters(SETTINGS, branch, index) for branch in base)
        assert (degrees.dt, degrees.tau, degrees.window) == (radians.dt, radians.tau, radians.window)
        assert 0.02 <= degrees.dt <= 0.2 and 5 <= degrees.tau <= 1000 and degrees.window in (5, 10, 20, 30, 50)
        for name, reach in decades.items():
            levels = np.array(getattr(degrees, name))
            assert getattr(degrees, name) == getattr(radians, name), "the same numbers, read in two units"
            driven = np.array(getattr(base["deg"], name)) > 0
            assert np.all(np.abs(np.log10(levels[driven] / np.array(getattr(base["deg"], name))[driven])) <= reach)
            assert not levels[~driven].any()
        drawn.append((np.log(degrees.dt / 0.02) / np.log(10), np.log(degrees.tau / 5) / np.log(200), degrees.window))
    dt, tau, window = np.array(drawn).T
    for uniform in (dt, tau):
        assert np.mean(uniform) == pytest.approx(0.5, abs=0.07) and np.std(uniform) == pytest.approx(12**-0.5, abs=0.04)
    assert set(window) == {5, 10, 20, 30, 50}


def test_specification_reports_geometric_means_over_its_runs_with_delayed_against_delayed():
    table = specification(SETTINGS, "deg").table
    assert len(table) == 2 * 3 * 8 and table["pair"].unique().tolist() == [ADAPTED, PLAIN, AUGMENTED]
    np.testing.assert_allclose(table["ratio"], np.exp(table["mean_log"]), rtol=1e-14)
    assert (table["n"] == 3).all() and (table["failed"] == 0).all()
    parameters = specification_parameters(SETTINGS, "deg", 1)
    matrices = studies.system(parameters)
    ensemble = studies.simulate(parameters, matrices, studies.draw(1, "specification", range(3, 6), parameters.steps))
    rmse = []
    for form, moment in ((augmented(matrices, parameters), "delayed"), (printed(matrices, parameters), "posterior")):
        record = studies.run(form, parameters, matrices, ensemble, "fault")
        rmse.append(window_rms(getattr(record, moment) - ensemble.x, 80, 150, 70))
    rows = table[(table["set"] == 1) & (table["pair"] == AUGMENTED)]
    np.testing.assert_allclose(rows["mean_log"], np.mean(np.log(rmse[0] / rmse[1]), axis=0), rtol=0, atol=1e-12)


def test_pairs_share_their_noise():
    """Paired: the ratio of a filter to itself is one in every run, whatever the noise."""
    base = baseline("deg")
    matrices = studies.system(base)
    ensemble = studies.simulate(base, matrices, studies.draw(1, "tests", range(3), base.steps))
    form = printed(matrices, base)
    results = pair_errors({"a": form, "b": form}, base, matrices, ensemble)
    np.testing.assert_array_equal(results["a"][0], results["b"][0])
