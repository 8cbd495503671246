"""Studies: the cases and filters that each promises, on runs of their own, and what must not differ between them."""

import numpy as np
import pytest

from robins.papers.ghouneem2024 import studies
from robins.papers.ghouneem2024.comparisons import values, variant
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.gps import ENVIRONMENTS
from robins.papers.ghouneem2024.in_sample import COMPARED
from robins.papers.ghouneem2024.runs import COLUMNS, MEASURES
from robins.papers.ghouneem2024.studies import ALPHAS, AZIMUTH_ERRORS, CAUSES, FIRST_SIDE_RUN, PRIOR_SCALES, SEVERITIES
from robins.papers.ghouneem2024.traces import SHOWN
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import CELLS
from robins.papers.ghouneem2024.variants import NEW

LABELS = {
    "calibration": ["trajectory", "filter"],
    "severity": ["trajectory", "severity", "filter"],
    "cause": ["trajectory", "cause", "filter", "gate", "multiple"],
    "initialisation": ["trajectory", "azimuth_error", "prior", "filter", "alpha"],
    "unscented": ["trajectory", "alpha", "weights", "redrawn"],
    "prior": ["trajectory", "azimuth_error", "prior_scale", "filter"],
    "ablations": ["trajectory", "ablation", "filter"],
    "literal": ["trajectory", "level", "filter", "alpha"],
    "long-outage": ["trajectory", "filter", "multiple"],
    "in-sample": ["trajectory", "filter", "cell", "scale", "multiple"],
}
SIDE = sorted(set(LABELS) - {"calibration", "in-sample"})


@pytest.mark.parametrize("name", LABELS)
def test_a_study_has_its_labels_and_a_score_for_each_run(results, settings, name):
    table, labels = results.table(name), LABELS[name]
    assert list(table.columns) == [*labels, *COLUMNS]
    keys = ["trajectory", "filter", "cell"] if name == "in-sample" else labels
    size = {"calibration": "calibration_runs", "in-sample": "in_sample_runs"}.get(name, "side_runs")
    first = {"calibration": 0, "in-sample": 100}.get(name, FIRST_SIDE_RUN)
    expected = set(range(first, first + settings().sizes[size]))
    for _, part in table.groupby(keys, dropna=False):
        assert part["run"].is_unique and set(part["run"]) == expected
    assert set(table["trajectory"]) == set(TRAJECTORIES)
    assert (table["failed"] == (table["reason"] != "")).all()
    errors = table[list(set(MEASURES) - {"settled"})].to_numpy()
    assert np.isnan(errors[table["failed"]]).all() and (errors[~table["failed"]] > 0).all()


def found(results, name, *labels):
    return set(results.table(name)[list(labels)].itertuples(index=False, name=None))


def test_studies_have_the_grids_of_the_brief(results):
    every = {(name,) for name in FILTERS}
    assert SEVERITIES == (0.0, 0.25, 0.5, 1.0) and PRIOR_SCALES == (0.0, 1e-4, 1e-2, 1.0) and ALPHAS == (1e-3, 0.1, 1.0)
    assert found(results, "severity", "severity") == {(value,) for value in SEVERITIES}
    assert found(results, "severity", "filter") == every | {(NEW,), ("ekf-f-nis-recovery",)}
    gates = {(name, "integrity", multiple) for name in FILTERS for multiple in (0.5, 2.0, 8.0, np.inf)}
    gates |= {("physical", gate, np.inf) for gate in ("none", "nis", "nis-recovery")}
    assert found(results, "cause", "filter", "gate", "multiple") == gates
    assert found(results, "cause", "cause") == {(cause,) for cause in CAUSES}
    np.testing.assert_allclose(np.degrees(AZIMUTH_ERRORS), [0, 30, 60, 90, 120, 150, 179])
    assert found(results, "initialisation", "filter", "alpha") == {(name, 0.1) for name in FILTERS} | {("ukf", 1.0)}
    points = {(alpha, weights, True) for alpha in ALPHAS for weights in ("corrected", "printed")}
    assert found(results, "unscented", "alpha", "weights", "redrawn") == points | {(0.1, "corrected", False)}
    assert found(results, "prior", "prior_scale", "filter") == {(scale, name) for scale in PRIOR_SCALES for name in FILTERS}
    literal = {(level, name) for level in ("ds", "st-inc") for name in FILTERS}
    literal |= {(level, name) for level in ("st-printed", "st-ms") for name in ("ekf-f", "ukf")}
    assert found(results, "literal", "level", "filter") == literal
    assert {("st-printed", "ukf", 1.0), ("st-ms", "ukf", 1.0)} <= found(results, "literal", "level", "filter", "alpha")


def test_ablations_change_one_reading_at_a_time(results):
    pairs = found(results, "ablations", "ablation", "filter")
    for ablation in ("as run", "tilt corrected", "tilt literal", "two dimensions"):
        assert {(ablation, name) for name in (*FILTERS, "riss-only")} <= pairs
    assert {filter for ablation, filter in pairs if ablation == "azimuth literal"} == {"riss-only", "ukf"}
    assert {filter for ablation, filter in pairs if ablation == "turn terms"} == {"ekf-pi"}
    assert {filter for ablation, filter in pairs if ablation == "odometer held"} == set(FILTERS)


def test_with_the_printed_sign_the_mechanisation_has_a_heading_without_information(results):
    """Its RMSE is that of a uniform error, half a turn over the root of three."""
    wrong = row_of(results, "ablations", ablation="azimuth literal", filter="riss-only")
    np.testing.assert_allclose(wrong["azimuth"], np.pi / np.sqrt(3.0), rtol=0.1)


def row_of(results, name, **labels):
    table = results.table(name)
    for label, value in labels.items():
        table = table[table[label] == value]
    return table.sort_values(["trajectory", "run"])


def test_the_same_case_in_two_studies_has_the_same_scores(results):
    """On side runs the plain filters are those of severity one, of the ablation that changes nothing and of `ds`."""
    for name in FILTERS:
        reference = row_of(results, "severity", severity=1.0, filter=name)
        others = [
            row_of(results, "ablations", ablation="as run", filter=name),
            row_of(results, "literal", level="ds", filter=name),
        ]
        for other in others:
            np.testing.assert_array_equal(other[list(MEASURES)], reference[list(MEASURES)])


def test_the_method_of_the_severity_study_has_the_frozen_settings_of_the_headline(results):
    tuned, plain = (row_of(results, "severity", severity=1.0, filter=name) for name in (NEW, "ukf"))
    assert (tuned["horizontal"].to_numpy() != plain["horizontal"].to_numpy()).any()


def test_a_clean_environment_has_no_trouble_and_each_cause_only_its_own(prepared):
    whole = ENVIRONMENTS["t2"]
    for cause, kept in (("misleading", "misleading"), ("multipath", "bursts"), ("outages", "outages")):
        alone = studies.only(whole, cause)
        for field in ("misleading", "bursts", "outages"):
            assert getattr(alone, field) == (getattr(whole, field) if field == kept else 0.0)
    assert not prepared("t2", 400, 0.0).fixes.cause.any()
    assert prepared("t2", 400, 0.0).fixes.epoch.size == 1500


def test_a_filter_that_is_certain_of_a_wrong_start_has_no_sigma_points(results):
    table = results.table("prior")
    certain = table[(table["prior_scale"] == 0.0)]
    assert (certain["failed"] == (certain["filter"] == "ukf")).all()
    assert set(certain.loc[certain["failed"], "reason"]) == {"no Cholesky factor or not finite at epoch 0"}


def test_settings_chosen_with_the_truth_of_a_run_are_never_worse_by_their_criterion_than_the_plain_filter(results):
    """Each run's own cells hold the filter without gate, or without a scale that helps; ``st-gate`` holds all of ``st``."""
    table = results.table("in-sample")
    assert set(table["filter"]) == set(COMPARED) and set(table["cell"]) == {"none", *CELLS}
    criterion = np.log(table[["azimuth", "v_east", "v_north", "v_up", "north", "east", "height"]]).mean(axis=1)
    wide = table.assign(criterion=criterion).pivot_table(index=["trajectory", "filter", "run"], columns="cell", values="criterion")
    assert (wide["gate"] <= wide["none"] + 1e-12).all() and (wide["st-gate"] <= wide["st"] + 1e-12).all()


# The figures' run.


def test_the_run_of_the_figures_is_the_median_by_its_ratio(results):
    table = results.table("traces")
    for place in TRAJECTORIES:
        row = table[table["trajectory"] == place].iloc[0]
        (new, failed), (old, lost) = (values(results, variant(name, place), "horizontal") for name in (NEW, "ekf-pi"))
        assert not (failed | lost).any()
        ratios = new / old
        assert row["ratio"] == pytest.approx(np.median(ratios)) and row["run"] == 100 + int(np.argsort(ratios)[1])


def test_traces_have_once_a_second_what_each_shown_filter_believed(results):
    arrays = results.arrays("traces")
    for place, seconds in (("t1", 1800), ("t2", 1500)):
        assert arrays[f"{place}.truth"].shape == (seconds + 1, 7)
        np.testing.assert_array_equal(arrays[f"{place}.time"], np.arange(seconds + 1))
        fixes = len(arrays[f"{place}.fixes"])
        assert arrays[f"{place}.fix_time"].shape == arrays[f"{place}.fix_cause"].shape == (fixes,)
        for name in SHOWN:
            assert arrays[f"{place}.{name}.estimate"].shape == arrays[f"{place}.{name}.deviation"].shape == (seconds + 1, 7)
            assert (arrays[f"{place}.{name}.deviation"] > 0).all() and arrays[f"{place}.{name}.rejected"].shape == (fixes,)
        assert not arrays[f"{place}.ekf-pi.rejected"].any()
