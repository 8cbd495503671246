"""Studies: the cases that they promise, the same noise for every filter, and ends of a scale that are what they are called."""

import numpy as np
import pandas as pd
import pytest

from robins.kalman.weights import weighting
from robins.papers.imani2026 import ensemble, studies
from robins.papers.imani2026.ensemble import Case, headline, scores
from robins.papers.imani2026.methods import SWEPT, Method, Setting, tuned
from robins.papers.imani2026.sensors import GRADES, Outliers, Sensors, measure
from robins.papers.imani2026.studies import (
    GATES,
    KERNEL_SCALES,
    NOISE_DECADES,
    OUTLIER_RATES,
    SCALED,
    SCORE_COLUMNS,
    SINGLE_WIDTHS,
    grades,
    grid_methods,
    grids,
    outlier_cases,
    outliers,
    rates,
    runs_at,
    scale,
    scale_methods,
    swept,
    variant_name,
)
from robins.papers.imani2026.variants import VARIANTS

FILTERS = ["ekf-tuned", "ci-seq", "ci-corr", "gate", "single-kernel", "mk-norm", "mk-norm-gain", "mk-li"]
CHOSEN = {("gate", "headline"): (1.0, 4.5), ("gate", "outliers"): (10.0, 3.0), ("ekf", "headline"): (10.0, 1.0)}
"""What the tuning jobs of these tests chose, where it is not the usual setting."""


@pytest.fixture(scope="module")
def slow(settings):
    """Settings of a drive with one sample a second."""
    return settings(rate_hz=1, rates_hz=[1, 2], sweep_runs=2, fast_runs=1)


@pytest.fixture(scope="module")
def results(slow, tuned_results):
    return tuned_results(slow, CHOSEN)


@pytest.fixture(scope="module")
def swept_outliers(slow, results):
    return outliers(slow, results).table


@pytest.fixture(scope="module")
def scaled(slow, results):
    return scale(slow, results).table


def rmse(table, **where):
    """Root mean square errors by run and channel, of one filter under one condition."""
    for column, value in where.items():
        table = table[table[column] == value]
    return table.set_index(["run", "channel"])["rmse"].sort_index()


# Filters of the sweeps.


def test_the_filters_of_a_sweep_are_those_of_the_tuned_variants(slow, results):
    methods = swept(slow, results)
    assert list(methods) == FILTERS and all(name in VARIANTS for name in FILTERS)
    assert methods["gate"].weighting.parameters[0] == 4.5 and methods["ekf-tuned"].noise_scale == 10.0
    retuned = swept(slow, results, "outliers")
    assert retuned["gate"].noise_scale == 10.0 and retuned["gate"].weighting.parameters[0] == 3.0
    assert [variant_name(family) for family in SWEPT] == FILTERS


def test_fewer_runs_are_made_above_the_headline_s_rate(slow):
    assert [len(runs_at(slow, rate)) for rate in (1, 10, 50, 100)] == [2, 2, 1, 1]


# Outliers.


def test_outliers_come_in_every_law_side_and_rate(swept_outliers):
    labels = swept_outliers[["law", "sided", "rate", "tuned"]].drop_duplicates()
    assert len(labels) == 3 + 2 * 2 * 4 + 1
    for law in ("nig-zero-mean", "nig-zero-mode"):
        for sided in ("two-sided", "one-sided"):
            found = labels[(labels["law"] == law) & (labels["sided"] == sided) & (labels["tuned"] == "headline")]["rate"]
            assert sorted(found) == sorted(OUTLIER_RATES if sided == "two-sided" else OUTLIER_RATES[1:])
    assert labels[labels["law"] == "mixture"]["rate"].tolist() == [0.0]
    again = labels[labels["tuned"] == "outliers"]
    assert again[["law", "sided", "rate"]].to_numpy().tolist() == [["nig-zero-mean", "two-sided", 0.02]]
    assert list(swept_outliers.columns) == ["law", "sided", "rate", "tuned", *SCORE_COLUMNS]
    assert len(swept_outliers) == 20 * 8 * 2 * 12
    assert len(outlier_cases()) == 19


def test_without_outliers_a_sweep_is_the_headline_condition(slow, results, swept_outliers):
    alone = scores(headline(slow), range(2), {"gate": tuned("gate", slow.options, Setting(1.0, 4.5))})
    found = rmse(swept_outliers, law="nig-zero-mean", rate=0.0, filter="gate")
    pd.testing.assert_series_equal(found, rmse(alone), check_names=False)


def test_retuned_filters_see_the_same_outliers(slow, swept_outliers):
    """Families that chose the same settings twice score the same; the gate and the EKF did not."""
    where = {"law": "nig-zero-mean", "sided": "two-sided", "rate": 0.02}
    for name in FILTERS:
        frozen, again = (rmse(swept_outliers, **where, filter=name, tuned=condition) for condition in ("headline", "outliers"))
        assert frozen.equals(again) == (name not in ("gate", "ekf-tuned")), name


def test_outliers_of_a_lower_rate_are_among_those_of_a_higher_one(slow):
    """One noise below all of them: what differs between two rates are the samples that the higher one hits more."""
    case = headline(slow)
    samples = {rate: measure(1, case.scenario, range(1), case.driven, Sensors(outliers=Outliers(rate))).atomic for rate in OUTLIER_RATES}
    hit = {rate: values != samples[0.0] for rate, values in samples.items()}
    for lower, higher in zip(OUTLIER_RATES[1:], OUTLIER_RATES[2:], strict=False):
        assert np.all(hit[higher] | ~hit[lower]) and hit[higher].sum() > hit[lower].sum() > 0
        np.testing.assert_array_equal(samples[higher][hit[lower]], samples[lower][hit[lower]])


def test_all_filters_of_a_case_read_the_same_samples(slow, results, monkeypatch):
    """The samples are drawn once for each batch of runs, whatever the number of filters."""
    drawn, draw = [], ensemble.measure

    def listen(seed, scenario, runs, driven, sensors):
        drawn.append((scenario, tuple(runs), sensors))
        return draw(seed, scenario, runs, driven, sensors)

    monkeypatch.setattr(ensemble, "measure", listen)
    grades(slow, results)
    assert drawn == [("drive-1hz", (0, 1), sensors) for sensors in GRADES.values()]


# The scale.


def test_the_scale_runs_from_no_update_to_the_ekf(slow):
    found = {}
    for method, value in scale_methods(slow.options, dict.fromkeys(SCALED, 1.0), Method(weighting("unit"))):
        found.setdefault(method, []).append(value)
    assert found == {
        "mk-norm": list(KERNEL_SCALES), "mk-norm-gain": list(KERNEL_SCALES), "single-kernel": list(SINGLE_WIDTHS), "gate": list(GATES),
        "ekf-r": [10.0**k for k in NOISE_DECADES], "no-update": [0.0], "ci-seq": [1.0],
    }  # fmt: skip


def test_the_scale_has_f0_without_outliers_and_f1_with_them(scaled):
    assert list(scaled.columns) == ["formulation", "rate", "method", "scale", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]
    assert not scaled.duplicated(["formulation", "rate", "method", "scale", "run", "channel"]).any()
    assert scaled[scaled["formulation"] == "F0"]["rate"].unique().tolist() == [0.0]
    f1 = scaled[scaled["formulation"] == "F1"]
    for rate in OUTLIER_RATES:
        methods = set(f1[f1["rate"] == rate]["method"])
        assert methods == ({*scaled["method"]} if rate == 0.0 else {"mk-norm", "mk-norm-gain", "ci-seq"})


@pytest.mark.parametrize("formulation", ["F0", "F1"])
@pytest.mark.parametrize("method", ["mk-norm", "mk-norm-gain", "single-kernel"])
def test_an_infinite_scale_is_the_ekf(slow, scaled, formulation, method):
    noise = 1.0 if formulation == "F0" else CHOSEN.get((method, "headline"), (1.0,))[0]
    plain = rmse(scores(headline(slow), range(2), {"ekf": Method(weighting("unit"), noise)}, formulation))
    wide = rmse(scaled, formulation=formulation, rate=0.0, method=method, scale=np.inf)
    pd.testing.assert_series_equal(wide, plain, check_names=False, rtol=1e-12)


def test_an_ekf_with_a_huge_r_is_nearly_no_update(slow, scaled):
    """Nothing drives F1: what both leave is the whole velocity of the car."""
    none, barely = (rmse(scaled, formulation="F1", rate=0.0, method=m, scale=s) for m, s in (("no-update", 0.0), ("ekf-r", 1e8)))
    plain = rmse(scores(headline(slow), range(2), {"ekf": Method(weighting("unit"))}))
    assert np.all(np.abs(barely - none)[:, "v_e"] < 0.2 * np.abs(plain - none)[:, "v_e"])


# Grades and rates.


def test_grades_have_every_filter_and_a_better_grade_gives_better_rates(slow, results):
    table = grades(slow, results).table
    assert list(table.columns) == ["grade", *SCORE_COLUMNS]
    assert set(table["grade"]) == {"vehicle", "atomic-ideal"} and len(table) == 2 * 8 * 2 * 12
    vehicle, ideal = (rmse(table, grade=grade, filter="ekf-tuned") for grade in ("vehicle", "atomic-ideal"))
    assert np.all(ideal[:, "roll"] < vehicle[:, "roll"])


def test_rates_keep_the_noise_of_a_sample_or_its_density(slow, results):
    """At the headline's own ten hertz both are the same; below, a sample of equal density is quieter."""
    table = rates(slow, results).table
    assert list(table.columns) == ["rate_hz", "noise", *SCORE_COLUMNS]
    assert len(table) == 2 * 2 * 8 * 2 * 12
    at_ten = [Case(1, 10, Sensors(equal_psd=equal)).sensors.noise_sd(10) for equal in (False, True)]
    np.testing.assert_array_equal(*at_ten)
    sample, density = (rmse(table, rate_hz=1, noise=noise, filter="ekf-tuned") for noise in ("equal-sample", "equal-psd"))
    assert np.all(density[:, "roll"] < sample[:, "roll"])


# Grids.


def test_grids_vary_one_threshold_at_a_time_and_all_of_them_in_the_full_ensemble(slow, settings):
    names = list(grid_methods(slow))
    increments = [setting for method, setting in names if method == "chi-square"]
    assert len(increments) == len(set(increments)) == 3 * (3 + 3 + 3)  # beta; c0 and c1 without the configured pair
    assert "linear, beta 0.95, c0 1, c1 3" in increments and "reject, beta 0.95, c0 1, c1 inf" in increments
    assert [setting for method, setting in names if method == "mk-norm-gain"] == [f"{n} kernels" for n in (1, 2, 3, 4, 5)]
    full = [setting for method, setting in grid_methods(settings("full", rate_hz=1)) if method == "chi-square"]
    pairs = sum(c0 <= c1 for c0 in studies.FULL_LOWER for c1 in studies.FULL_UPPER)
    assert set(increments) <= set(full) and len(full) == 3 * 3 * pairs


def test_the_full_ensemble_has_fixed_points_over_the_widths_of_measurement_and_prior(slow, settings):
    assert not any(method == "mk-li" for method, _ in grid_methods(slow))
    found = {setting: method for (name, setting), method in grid_methods(settings("full", rate_hz=1)).items() if name == "mk-li"}
    assert len(found) == 3 * 4 * 2
    cold, warm = (found[f"width 1.5, prior 6, {start}"].weighting for start in ("cold", "warm"))
    assert cold.parameters[-1] == 1.5 and cold.iteration.prior[-1] == 6.0
    assert (cold.iteration.warm, warm.iteration.warm) == (False, True)


def test_grids_are_scored_for_each_setting(slow):
    table = grids(slow).table
    assert list(table.columns) == ["method", "setting", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]
    assert len(table) == len(grid_methods(slow)) * 1 * 12
    linear, same = (rmse(table, setting=f"{shape}, beta 0.95, c0 1, c1 inf") for shape in ("linear", "reject"))
    pd.testing.assert_series_equal(linear, same)  # without an upper bound nothing is rejected
