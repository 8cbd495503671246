"""The types that wings, evaluation and publication talk in."""

import numpy as np
import pandas as pd

from robins.papers.protocol import Job, Output, Paper, Results, Settings

SETTINGS = Settings("smoke", 1, {"runs": 8})


def job(name):
    return Job(name, name.title(), lambda settings: Output(pd.DataFrame({"runs": [settings.sizes["runs"]]})), ("module",))


def paper(**parts):
    empty = dict.fromkeys(("scenarios", "variants", "studies", "tables", "figures", "claims", "equations", "assumptions"), ())
    return Paper("key2024", "Title", "Citation", "10.1/x", "Summary", **(empty | parts))


def test_jobs_are_scenarios_variants_and_studies_by_name_in_that_order():
    wing = paper(studies=(job("sweep"),), scenarios=(job("flight"),), variants=(job("ekf"), job("ukf")))
    assert list(wing.jobs) == ["flight", "ekf", "ukf", "sweep"]
    assert wing.jobs["ukf"].compute(SETTINGS).table["runs"].tolist() == [8]


def test_a_job_that_needs_others_is_computed_from_their_results():
    tuned = Job("tuned", "Tuned", lambda settings, results: Output(2 * results.table("ekf")), ("module",), needs=("ekf",))
    made = Results(SETTINGS, pd.DataFrame(), lambda name: job(name).compute(SETTINGS))
    assert tuned.compute(SETTINGS, made).table["runs"].tolist() == [16]
    assert job("ekf").needs == ()


def test_results_load_a_job_once():
    asked = []

    def load(name):
        asked.append(name)
        return Output(pd.DataFrame({"name": [name]}), {"values": np.arange(3)})

    results = Results(SETTINGS, pd.DataFrame(), load)
    assert results.table("ekf").equals(pd.DataFrame({"name": ["ekf"]}))
    assert results.arrays("ekf")["values"].tolist() == [0, 1, 2]
    assert results.output("ekf") is results.output("ekf")
    assert results.table("ukf")["name"].tolist() == ["ukf"]
    assert asked == ["ekf", "ukf"]


def test_an_output_needs_no_arrays_and_shares_none():
    first, second = Output(pd.DataFrame()), Output(pd.DataFrame())
    first.arrays["x"] = np.zeros(1)
    assert second.arrays == {}
