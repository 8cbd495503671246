"""Every table of the wing is what it promises, from fabricated results: its columns, its numbers, and failures as words."""

from itertools import permutations
from zlib import crc32

import numpy as np
import pandas as pd
import pytest

from robins.evaluate.ledger import COLUMNS as LEDGER_COLUMNS
from robins.evaluate.ledger import OVERALL
from robins.evaluate.published import read_published
from robins.papers.ghouneem2024 import ensemble, tables_tuning
from robins.papers.ghouneem2024.claims import CLAIMS
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.options import OPTIONS
from robins.papers.ghouneem2024.runs import CHANNELS, COLUMNS, COUNTS, MEASURES
from robins.papers.ghouneem2024.self_tuning import Statistics, radii
from robins.papers.ghouneem2024.studies import DATA_SHEET, PRIOR_ERROR, PRIORS
from robins.papers.ghouneem2024.table_parts import percent
from robins.papers.ghouneem2024.tables import TABLES
from robins.papers.ghouneem2024.theory import theory
from robins.papers.ghouneem2024.trajectories import KEY, TRAJECTORIES
from robins.papers.ghouneem2024.tune import CELLS, SETTINGS, belongs
from robins.papers.ghouneem2024.variants import BASELINES, NEW, VARIANTS
from robins.papers.protocol import Output, Results, Settings
from robins.publish import tables as writer
from robins.publish.tolerances import refuse_columns, refuse_tolerances

RUNS = 6
SIZES = {"runs": RUNS, "side_runs": RUNS, "in_sample_runs": 3, "tuning_runs": 2, "calibration_runs": RUNS, "bootstrap": 50}
OPTIONS_OF = Settings("smoke", 1, SIZES, OPTIONS)
BY_NAME = {table.name: table for table in TABLES}
ONE_LOST, ALL_LOST = "ekf-f-gate", "ekf-pi-st"
"""A variant that fails in its first run, and one that fails in all."""
FIRST = {"side_runs": 400, "calibration_runs": 0}
VERDICTS = {"east": ("direction only", "inconclusive")}
"""Verdicts against either EKF where they are not both ``replicated``."""


def score_rows(first: int = 100, runs: int = RUNS, **labels) -> pd.DataFrame:
    """Rows of a job: positive errors that depend on the labels; the fifth run never settles."""
    generator = np.random.default_rng(crc32(repr(sorted(labels.items(), key=str)).encode()))
    name = labels.get("variant", "")
    lost = np.full(runs, name == ALL_LOST or labels.get("weights") == "printed") | ((np.arange(runs) == 0) & (name == ONE_LOST))
    columns = {key: value for key, value in labels.items() if key != "variant"} | {"run": first + np.arange(runs)}
    for measure in (*MEASURES, *COUNTS[:3]):
        columns[measure] = np.where(lost, np.nan, np.exp(generator.standard_normal(runs)))
    columns["settled"] = np.where(np.arange(runs) == 4, np.inf, columns["settled"])
    columns |= {"fixes": 100, "rejected": np.where(lost, 0, generator.integers(0, 50, runs))}
    columns |= {"longest_rejection": np.where(lost, 0, generator.integers(0, 20, runs)), "failed": lost, "reason": np.where(lost, "x", "")}
    return pd.DataFrame(columns)[[*(key for key in labels if key != "variant"), *COLUMNS]]


def variant(name: str) -> Output:
    """A variant's job."""
    frozen = TRAJECTORIES if VARIANTS[name].composition.get("cell", "none") != "none" else ("none",)
    frames = [score_rows(variant=name, trajectory=place, frozen=own) for place in TRAJECTORIES for own in frozen]
    table = pd.concat(frames, ignore_index=True)
    return Output(table.assign(nis=np.nan) if name == "riss-only" else table)


def tuning(name: str) -> Output:
    """A tuning job: in each cell the last setting is chosen, the first lost a run; statistics with four negative means."""
    frames, arrays, generator = [], {}, np.random.default_rng(crc32(name.encode()))
    for place in TRAJECTORIES:
        for cell in CELLS:
            own = [setting for setting in SETTINGS if belongs(setting, cell)]
            count = np.arange(len(own))
            frames.append(pd.DataFrame({
                "trajectory": place, "cell": cell, "scale": [s.scale for s in own], "multiple": [s.multiple for s in own],
                "objective": np.where(count == 0, np.inf, -1.0 * count), "failed": (count == 0).astype(int), "chosen": count == count[-1],
            }))  # fmt: skip
        for source in ("mechanisation", "filtered"):
            values = np.exp(generator.standard_normal((3, 2, 7)))
            values[0] *= [-1, 1, -1, 1, -1, 1, -1]
            arrays |= {f"{place}.{source}.{field}": value for field, value in zip(Statistics._fields, values, strict=True)}
    return Output(pd.concat(frames, ignore_index=True), arrays)


def study_labels(name: str) -> list[dict]:
    """A few of the conditions of a study, without the trajectory."""
    alpha = OPTIONS["alpha"]
    if name == "calibration":
        return [{"filter": key} for key in ("ekf-pi", "ekf-pm", "riss-only")]
    if name == "in-sample":
        return [{"filter": key, "cell": cell} for key in ("ekf-pi", "ukf") for cell in ("none", *CELLS)]
    if name == "severity":
        return [{"severity": value, "filter": key} for value in (0.0, 1.0) for key in (*FILTERS, NEW)]
    if name == "cause":
        gated = [{"filter": "ukf", "gate": "integrity", "multiple": value} for value in (0.5, 2.0, 8.0, np.inf)]
        other = [{"filter": "physical", "gate": gate, "multiple": np.inf} for gate in ("none", "nis")]
        return [{"cause": "outages"} | row for row in (*gated, *other)]
    if name == "initialisation":
        return [{"azimuth_error": np.pi / 2, "prior": prior, "filter": key, "alpha": alpha} for prior in PRIORS for key in FILTERS]
    if name == "unscented":
        rows = [(alpha, "corrected", True), (alpha, "printed", True), (1.0, "corrected", True), (alpha, "corrected", False)]
        return [dict(zip(("alpha", "weights", "redrawn"), row, strict=True)) for row in rows]
    if name == "prior":
        return [{"azimuth_error": PRIOR_ERROR, "prior_scale": scale, "filter": key} for scale in (0.0, 1.0) for key in FILTERS]
    if name == "ablations":
        return [{"ablation": "as run", "filter": key} for key in (*FILTERS, "riss-only")]
    if name == "long-outage":
        return [{"filter": key, "multiple": value} for key in FILTERS for value in (0.5, np.inf)]
    return [{"level": level, "filter": key, "alpha": alpha} for level in ("st-ms", "ds") for key in ("ekf-f", "ukf")]


def study(name: str) -> Output:
    """A study over both trajectories."""
    size = {"in-sample": "in_sample_runs", "calibration": "calibration_runs"}.get(name, "side_runs")
    frames = [
        score_rows(FIRST.get(size, 100), SIZES[size], trajectory=place, **labels)
        for place in TRAJECTORIES for labels in study_labels(name)
    ]  # fmt: skip
    return Output(pd.concat(frames, ignore_index=True))


def jumps() -> Output:
    """The bad fix is rejected in every second run, the one after it in none."""
    rows = [("ukf", multiple, run, run % 2 == 0, False, run) for multiple in (4.0, 8.0) for run in range(RUNS)]
    return Output(pd.DataFrame(rows, columns=["filter", "multiple", "run", "rejected_jump", "rejected_next", "false_alarms"]))


def fabricated(name: str) -> Output:
    """What the job `name` might have left behind."""
    if name in TRAJECTORIES:
        return Output(ensemble.parameters(name))
    if name in VARIANTS:
        return variant(name)
    if name.startswith("tuning-"):
        return tuning(name)
    if name == "theory":
        return theory(OPTIONS_OF)
    if name == "cost":
        return Output(pd.DataFrame([{"ratio": 2.5, "least": 2.4, "greatest": 2.75, "rounds": 7}]))
    return jumps() if name == "jump" else study(name)


@pytest.fixture(scope="module")
def load():
    """The fabricated outputs, each made once."""
    made = {}

    def load(name):
        if name not in made:
            made[name] = fabricated(name)
        return made[name]

    return load


@pytest.fixture(scope="module")
def published(repository) -> pd.DataFrame:
    return read_published(repository / "data" / "published" / f"{KEY}.csv")


@pytest.fixture(scope="module")
def ledger(published) -> pd.DataFrame:
    """The row ``overall`` of every claim, and two rows for every published ratio, one against each EKF."""
    same = dict.fromkeys(LEDGER_COLUMNS, "") | {"paper": KEY, "location": "abstract", "reason": "so it is", "n": RUNS}
    rows = [same | {"claim_id": claim.claim_id, "condition": OVERALL, "verdict": "untestable"} for claim in CLAIMS]
    names = ("azimuth", "east velocity", "north velocity", "up velocity", "latitude", "longitude", "altitude")
    for place in ("T1", "T2"):
        for channel, name in zip(CHANNELS, names, strict=True):
            printed = published[published["quantity"] == f"{place} {name.capitalize()} RMSE, EKF"].iloc[0]
            words = VERDICTS.get(channel, ("replicated", "replicated"))
            own = same | {"claim_id": printed["claim_id"].split(";")[1], "quantity": f"{place} {name} RMSE ratio, New over EKF"}
            rows += [own | {"condition": "T1-frozen", "verdict": word} for word in words]
            rows.append(own | {"condition": "T2-frozen", "verdict": "not replicated"})
    return pd.DataFrame(rows)


@pytest.fixture(scope="module")
def build(load, published, ledger):
    """``build(name)``: a table that read what it says that it needs and nothing else."""

    def made(name) -> pd.DataFrame:
        def allowed(job):
            assert job in BY_NAME[name].needs, f"{name} reads {job}"
            return load(job)

        return BY_NAME[name].build(Results(OPTIONS_OF, published, allowed, ledger if "claims" in BY_NAME[name].needs else None))

    return made


@pytest.fixture(scope="module")
def frame_of(build):
    """`build`, each table once."""
    built = {}

    def frame(name) -> pd.DataFrame:
        if name not in built:
            built[name] = build(name)
        return built[name].copy()

    return frame


def scores(load, job: str, measure: str = "horizontal", **labels) -> np.ndarray:
    """A measure by run, NaN where it failed."""
    table = load(job).table
    for name, value in labels.items():
        table = table[table[name] == value]
    assert table["run"].is_unique
    return table.sort_values("run")[measure].to_numpy(float)


def geometric(values: np.ndarray) -> float:
    return float(np.exp(np.nanmean(np.log(values))))


@pytest.mark.parametrize("name", BY_NAME)
def test_a_table_reads_what_it_needs_keeps_its_promises_and_survives_the_disk(name, frame_of, tmp_path):
    table, frame = BY_NAME[name], frame_of(name)
    writer.write(frame, table, tmp_path / "table.csv", RUNS)  # refuses NaN, wrong columns and double keys
    back = writer.read(tmp_path / "table.csv", table)
    assert refuse_columns(table) == [] and refuse_tolerances(table, back) == []
    assert table.size in ("", *SIZES)
    assert not frame.astype(str).isin(["inf", "-inf", "nan"]).any(axis=None)


@pytest.mark.parametrize("name", ["table-2", "extra-attribution", "extra-cause"])
def test_a_table_is_the_same_when_built_again(name, frame_of, build):
    pd.testing.assert_frame_equal(frame_of(name), build(name), check_exact=True)


def test_the_registry_holds_every_table_once_with_the_papers_three_first():
    assert len(BY_NAME) == len(TABLES)
    assert [table.location for table in TABLES[:3]] == ["Table I", "Table II", "Table III"]
    assert {table.location for table in TABLES[3:]} == {"extra"}


def test_captions_of_random_tables_name_their_runs():
    words = {"runs": "uns 100", "side_runs": "uns 400", "tuning_runs": "1000", "calibration_runs": "Runs 0 to"}
    for table in TABLES:
        if table.size and table.name != "extra-claims":
            assert words[table.size] in table.caption, table.name


def test_tables_of_errors_count_runs_and_failures():
    without = {"table-1", "extra-jump", "extra-self-tuning", "extra-variants", "extra-claims"}
    for table in TABLES:
        names = {column.name for column in table.columns}
        if table.size and table.name not in without | {"table-2", "table-3"}:
            assert {"n", "failed"} <= names, table.name


@pytest.mark.parametrize(("name", "place", "azimuth"), [("table-2", "t1", 5.0632), ("table-3", "t2", 103.3814)])
def test_tables_2_and_3_hold_geometric_means_and_paired_ratios_in_the_papers_units(name, place, azimuth, frame_of, load):
    frame = frame_of(name).reset_index(drop=True)
    assert frame.loc[0, "published_ekf"] == azimuth
    assert list(frame["unit"]) == ["deg", "m/s", "m/s", "m/s", "m", "m", "m"]
    shown = {"ekf_pm": "ekf-pm", "ekf_pi": "ekf-pi", "ekf_f": "ekf-f"}
    for i, channel in enumerate(CHANNELS):
        factor = 180 / np.pi if channel == "azimuth" else 1.0
        new = scores(load, NEW, channel, trajectory=place, frozen="t1")
        leaked = scores(load, "in-sample", channel, trajectory=place, filter="ukf", cell="st-gate")
        assert frame.loc[i, "new"] == pytest.approx(factor * geometric(new))
        assert frame.loc[i, "in_sample"] == pytest.approx(factor * geometric(leaked))
        for column, filter_name in shown.items():
            old = scores(load, filter_name, channel, trajectory=place)
            assert frame.loc[i, column] == pytest.approx(factor * geometric(old))
            if column != "ekf_f":
                assert frame.loc[i, f"ratio_{column}"] == pytest.approx(geometric(new / old))
                assert frame.loc[i, f"ratio_{column}_low"] <= frame.loc[i, f"ratio_{column}"] <= frame.loc[i, f"ratio_{column}_high"]
    assert (frame["n"] == RUNS).all() and (frame["in_sample_n"] == 3).all()


def test_the_verdict_of_a_channel_is_the_headlines_against_both_baselines(frame_of):
    frame = frame_of("table-2").set_index("channel")
    assert frame.loc["longitude", ["claim", "verdict"]].tolist() == ["C6", "depends on assumption"]
    assert frame.loc["altitude", ["claim", "verdict"]].tolist() == ["C7", "replicated"]
    assert frame_of("table-3").set_index("channel").loc["latitude", "claim"] == "C8a"


def test_the_evidence_of_table_1_is_made_of_numbers_of_the_results(frame_of, load):
    frame = frame_of("table-1").set_index("feature")
    ratio = [geometric(scores(load, "ukf", trajectory=place) / scores(load, "ekf-f", trajectory=place)) for place in TRAJECTORIES]
    for value in ratio:
        assert f"{value:.4g} (T" in frame.loc["nonlinear RISS", "evidence"]
    assert frame.loc["computation", ["evidence", "n"]].tolist() == [
        "A step of the UKF takes 2.5 times as long (2.4 to 2.75 in single rounds).", 7,
    ]  # fmt: skip
    assert f"{2 * RUNS} of {2 * RUNS} at 0.1" in frame.loc["tuning", "evidence"]
    assert f"ukf {2 * (RUNS - 1)} of {2 * RUNS}" in frame.loc["convergence", "evidence"]


def test_without_a_benchmark_record_table_1_says_so(load, published):
    empty = {"cost": Output(pd.DataFrame(columns=["ratio"]))}
    frame = BY_NAME["table-1"].build(Results(OPTIONS_OF, published, lambda job: empty.get(job) or load(job)))
    assert frame.set_index("feature").loc["computation", "evidence"] == "No benchmark record is at hand."


def test_the_factorial_has_sixteen_cells_and_tuned_ones_with_both_settings(frame_of, load):
    frame = frame_of("extra-factorial")
    assert len(frame) == 2 * (4 + 12 * 2)
    row = frame.set_index(["trajectory", "variant", "frozen"]).loc["t2", NEW, "t1"]
    table = load(NEW).table
    table = table[(table["trajectory"] == "t2") & (table["frozen"] == "t1")]
    assert row["nis"] == pytest.approx(table["nis"].mean())
    assert row["rejected"] == pytest.approx((table["rejected"] / 100).mean())
    assert row["longest_rejection"] == table["longest_rejection"].max()


@pytest.mark.parametrize("name", ["extra-factorial", "extra-channels", "extra-consistency"])
def test_a_filter_that_fails_in_every_run_has_the_word_failed_and_no_number(name, frame_of):
    frame = frame_of(name)
    rows = frame[frame["variant"] == ALL_LOST]
    columns = [column.name for column in BY_NAME[name].columns if column.kind in ("number", "optional")]
    assert len(rows) and (rows[columns] == "failed").all(axis=None)
    assert (rows["failed"] == RUNS).all() and (rows["n"] == RUNS).all()


def test_a_run_that_failed_is_left_out_of_the_mean_and_infinite_in_the_quantiles(frame_of, load):
    row = frame_of("extra-factorial").set_index(["trajectory", "variant", "frozen"]).loc["t1", ONE_LOST, "t2"]
    values = scores(load, ONE_LOST, trajectory="t1", frozen="t2")
    assert np.isnan(values[0]) and row["mean"] == pytest.approx(geometric(values))
    everyone = np.sort(np.where(np.isnan(values), np.inf, values))
    assert row["median"] == everyone[2] and row["q90"] == "failed"
    assert (row["n"], row["failed"]) == (RUNS, 1)


def test_ratios_stand_beside_the_published_ones_and_have_their_own_number_of_runs(frame_of):
    frame = frame_of("extra-ratios").set_index(["trajectory", "settings", "over", "channel"]).sort_index()
    assert frame.loc[("t2", "T1-frozen", "ekf-pi", "horizontal"), "published"] == pytest.approx(0.284, abs=5e-4)
    assert (frame.xs("in sample", level="settings")["n"] == 3).all()


def test_controls_are_compared_with_the_method_under_both_settings(frame_of, load):
    row = frame_of("extra-controls").set_index(["trajectory", "control", "measure"]).loc["t1", "ekf-f-nis-recovery", "azimuth"]
    new, own = (
        scores(load, job, "azimuth", trajectory="t1", **more) for job, more in ((NEW, {"frozen": "t2"}), ("ekf-f-nis-recovery", {}))
    )
    assert row["new_t2"] == pytest.approx(geometric(new / own)) and row["mean"] == pytest.approx(np.degrees(geometric(own)))


def test_shapley_factors_are_means_over_all_orders_and_multiply_to_the_whole_change(frame_of, load):
    frame = frame_of("extra-attribution").set_index(["trajectory", "frozen", "from", "measure", "part"]).sort_index()
    found = frame.loc["t1", "t2", "ekf-pm", "horizontal"]

    def log_error(parts: frozenset) -> float:
        name = ("ukf" if "filter" in parts else "ekf-pm") + ("-st" if "self-tuning" in parts else "") + ("-gate" if "gate" in parts else "")
        return np.log(scores(load, name, trajectory="t1", **({"frozen": "t2"} if "-" in name.removeprefix("ekf-pm") else {}))).mean()

    parts = ("filter", "self-tuning", "gate")
    orders = list(permutations(parts))
    for part in parts:
        before = [frozenset(order[: order.index(part)]) for order in orders]
        gains = [log_error(chosen | {part}) - log_error(chosen) for chosen in before]
        assert found.loc[part, "factor"] == pytest.approx(np.exp(np.mean(gains)))
    assert found.loc[list(parts), "factor"].prod() == pytest.approx(found.loc["all", "factor"])
    assert (frame.xs("ekf-pi", level="from")["factor"] == "failed").all()  # a cell of it fails in every run


def test_the_shares_of_the_sum_of_squares_add_up_to_one(frame_of):
    frame = frame_of("extra-anova")
    sound = frame[frame["from"] == "ekf-pm"]
    totals = sound.groupby(["trajectory", "frozen"])["share"].apply(lambda share: share.astype(float).sum())
    assert totals.to_numpy() == pytest.approx(np.ones(4), abs=1e-3)
    assert set(frame.loc[frame["from"] == "ekf-pi", "share"]) == {"failed"}


def test_the_filter_is_split_into_change_of_model_and_transform(frame_of, load):
    frame = frame_of("extra-filter-split").set_index(["trajectory", "cell", "filter", "over"]).sort_index()
    assert len(frame) == 2 * 4 * 3
    own, other = (scores(load, name, trajectory="t1") for name in ("ukf", "ekf-f"))
    row = frame.loc["t1", "none", "ukf", "ekf-f"]
    assert row["ratio"] == pytest.approx(geometric(own / other))
    assert row["largest_horizontal"] == f"{100 * np.max(np.abs(own / other - 1)):.4g}"
    assert frame.loc[("t1", "st", "ekf-f", "ekf-pi"), "largest_horizontal"] == "failed"


def test_a_difference_as_small_as_rounding_is_words():
    assert [percent(value) for value in (0.12346, 1e-5, 9e-6, 0.0, -np.inf)] == ["12.35", "0.001", "below 0.001", "below 0.001", "failed"]


def test_the_gate_is_compared_with_the_same_filter_without_it(frame_of, load):
    frame = frame_of("extra-gate").set_index(["trajectory", "filter", "over", "frozen"]).sort_index()
    own, other = scores(load, ONE_LOST, trajectory="t2", frozen="t1"), scores(load, "ekf-f", trajectory="t2")
    row = frame.loc["t2", ONE_LOST, "ekf-f", "t1"]
    assert row["ratio"] == pytest.approx(geometric(own / other))
    assert row["twofold"] == (1 + np.sum(own[1:] > 2 * other[1:])) / RUNS
    assert (row["failed"], row["over_failed"], row["multiple"]) == (1, 0, "no gate")
    assert ("t1", "ekf-f-nis", "ekf-f-physical", "none") in frame.index


def test_causes_are_compared_with_no_gate_and_the_best_multiple_is_marked(frame_of, load):
    frame = frame_of("extra-cause").set_index(["trajectory", "cause", "filter", "gate", "multiple"]).sort_index()
    own = frame.loc["t1", "outages", "ukf", "integrity"]
    assert own.loc["no gate", "ratio"] == 1.0 and frame.loc[("t1", "outages", "physical", "none", "none"), "ratio"] == 1.0
    means = {value: geometric(scores(load, "cause", trajectory="t1", filter="ukf", multiple=value)) for value in (0.5, 2.0, 8.0, np.inf)}
    best = min(means, key=means.get)
    assert own.index[own["best"] == "best"].tolist() == [f"{best:g}" if np.isfinite(best) else "no gate"]


def test_what_becomes_of_a_bad_fix_is_counted_beside_the_thresholds(frame_of):
    row = frame_of("extra-jump").set_index(["filter", "multiple"]).loc["ukf", "4"]
    assert row[["prediction_limit", "jump_limit", "rejected_jump", "rejected_next"]].tolist() == [120.0, 160.0, 0.5, 0.0]
    assert row["false_alarms"] == pytest.approx(np.mean(range(RUNS)))


def test_a_long_outage_has_a_ratio_to_no_gate(frame_of):
    frame = frame_of("extra-long-outage")
    assert (frame.loc[frame["multiple"] == "no gate", "ratio"] == 1.0).all() and set(frame["multiple"]) == {"0.5", "no gate"}


def test_the_budget_names_settings_and_edges(frame_of):
    frame = frame_of("extra-budget").set_index(["filter", "trajectory", "cell"]).sort_index()
    row = frame.loc["ukf", "t1"]
    assert row["settings"].to_dict() == {"gate": 6, "st": 6, "st-gate": 36}
    assert row["at_edge"].to_dict() == {"gate": "multiple", "st": "scale", "st-gate": "scale, multiple"}
    assert row["scale"].to_dict() == {"gate": "data sheet", "st": "1e-10", "st-gate": "1e-10"}


def test_every_setting_is_published_once_with_the_cells_that_chose_it(frame_of):
    frame = frame_of("extra-tuning")
    chaotic = sum(setting.scale >= tables_tuning.CHAOTIC_SCALE for setting in SETTINGS)
    assert len(frame) == 2 * (len(FILTERS) * len(SETTINGS) - chaotic)
    own = frame[(frame["filter"] == "ekf-pi") & (frame["trajectory"] == "t2")].set_index(["scale", "multiple"])
    assert own.loc[("1e-10", "no gate"), "chosen_by"] == "st, st-gate" and own.loc[("data sheet", "no gate"), "chosen_by"] == "gate"
    assert (own["chosen_by"] != "").sum() == 2
    assert ((own["objective"] == "failed") == (own["failed"] > 0)).all()


def test_signed_means_are_shown_in_metres_and_radians_with_their_signs(frame_of, load):
    frame = frame_of("extra-self-tuning").set_index(["trajectory", "of", "state"]).sort_index()
    mean = load("tuning-ukf").arrays["t2.filtered.mean"].mean(axis=0)
    row = frame.loc["t2", "ukf", "latitude"]
    assert row["mean"] == pytest.approx(mean[0]) and row["mean_rad"] == pytest.approx(mean[0] / radii("t2")[0])
    assert row["taken"] == pytest.approx(np.sqrt(-row["mean_rad"]) * radii("t2")[0])  # rad^2 are rad, squared by nobody
    assert (row["negative"], row["negative_runs"], row["negatives"], row["n"]) == ("negative", 2, 4, 2)
    assert frame.loc["t2", "ukf", "azimuth"]["mean"] == pytest.approx(np.degrees(mean[6]))
    assert frame.loc["t2", "ukf", "up velocity"]["mean_rad"] == ""
    assert len(frame) == 2 * 5 * 7


def test_of_a_unscented_filter_without_a_scale_only_whether_it_diverges_is_said(frame_of, load):
    frame = frame_of("extra-literal").set_index(["trajectory", "level", "filter"])
    for level in ("st-ms", "ds"):
        row = frame.loc["t1", level, "ukf"]
        own, other = (scores(load, "literal", trajectory="t1", level=each, filter="ukf") for each in (level, "ds"))
        beyond = own > tables_tuning.DIVERGED * other
        assert row["diverged"] == ("every run" if beyond.all() else "some runs" if beyond.any() else "no run")
        assert row["ratio"] == ("" if level == "st-ms" else pytest.approx(geometric(own / other)))


def test_leakage_compares_in_sample_with_frozen_and_own_with_other_settings(frame_of, load):
    frame = frame_of("extra-leakage").set_index(["trajectory", "filter", "cell", "settings", "over", "measure"]).sort_index()
    leaked = scores(load, "in-sample", trajectory="t1", filter="ukf", cell="st-gate")
    frozen = scores(load, NEW, trajectory="t1", frozen="t1")
    row = frame.loc["t1", "ukf", "st-gate", "in sample", "T1-frozen", "horizontal"]
    assert row["ratio"] == pytest.approx(geometric(leaked / frozen[:3])) and row["n"] == 3
    row = frame.loc["t1", "ukf", "st-gate", "T2-frozen", "T1-frozen", "horizontal"]
    assert row["ratio"] == pytest.approx(geometric(scores(load, NEW, trajectory="t1", frozen="t2") / frozen))
    assert ("t2", "ekf-pi", "st", "in sample", "data sheet", "altitude") in frame.index
    assert "in sample" not in frame.xs("ekf-f", level="filter").index.get_level_values("settings")


def test_the_calibration_stands_beside_the_published_horizontal_error(frame_of, load):
    row = frame_of("extra-calibration").set_index(["trajectory", "filter"]).loc["t2", "ekf-pi"]
    assert row["target"] == pytest.approx(np.hypot(270.9458, 98.6208))
    median = np.sort(scores(load, "calibration", trajectory="t2", filter="ekf-pi"))[RUNS // 2 - 1]
    assert row["median"] == median and row["median_over_target"] == pytest.approx(median / row["target"])


def test_severity_has_ratios_to_both_readings_of_the_ekf(frame_of):
    frame = frame_of("extra-severity").set_index(["trajectory", "severity", "filter"]).sort_index()
    for name in BASELINES:
        assert (frame.xs(name, level="filter")[f"over_{name.replace('-', '_')}"] == 1.0).all()


def test_time_to_settle_is_a_median_over_all_runs_and_the_share_says_how_many_do(frame_of, load):
    row = frame_of("extra-initialisation").set_index(["trajectory", "prior", "filter"]).loc["t1", DATA_SHEET, "ukf"]
    times = scores(load, "initialisation", "settled", trajectory="t1", prior=DATA_SHEET, filter="ukf")
    assert row["settled"] == np.sort(times)[2] and row["share"] == pytest.approx(5 / 6) and row["azimuth_error"] == pytest.approx(90.0)


def test_the_centre_weight_is_that_of_the_brief_and_printed_weights_fail(frame_of):
    frame = frame_of("extra-unscented").set_index(["trajectory", "alpha", "weights", "redrawn"]).sort_index()
    printed = frame.loc["t1", 0.1, "printed", "redrawn"]
    assert printed["centre"] == pytest.approx(-296.01) and printed["mean"] == "failed" and printed["failed"] == RUNS
    assert frame.loc[("t1", 0.1, "corrected", "redrawn"), "centre"] == pytest.approx(-96.01)
    assert frame.loc[("t1", 1.0, "corrected", "redrawn"), "centre"] == pytest.approx(2.0)


def test_ablations_show_the_published_up_velocity_of_the_filter(frame_of):
    frame = frame_of("extra-ablations").set_index(["trajectory", "filter"])["published_v_up"]
    assert frame.loc["t1"].tolist() == [0.3549, 0.3549, 0.3549, 0.3532, ""] and frame.loc["t2", "ukf"] == 0.1981


def test_a_filter_without_updates_has_no_innovations(frame_of):
    frame = frame_of("extra-consistency").set_index("variant")
    assert set(frame.loc["riss-only", "nis"]) == {""} and "gps-only" not in frame.index
    honest = frame[["honest_nis", "honest_nees_position", "honest_nees_azimuth"]]
    assert (honest == [6, 3, 1]).all(axis=None) and set(frame["trajectory"]) == set(TRAJECTORIES)


def test_the_azimuths_level_stands_beside_what_it_may_mean(frame_of):
    row = frame_of("extra-azimuth").set_index(["trajectory", "filter"]).loc["t2", "ekf-pi"]
    assert row["share_of_turns"] == pytest.approx(0.0825, abs=5e-5)
    assert row["share_of_uniform"] == pytest.approx(103.3814 / 103.92, abs=5e-5)
    row = frame_of("extra-azimuth").set_index(["trajectory", "filter"]).loc["t2", NEW]
    assert row["published"] == 45.8807 and row["share_of_turns"] == pytest.approx(0.0162, abs=5e-5)


def test_parameters_have_degrees_where_the_jobs_have_radians(frame_of):
    frame = frame_of("extra-parameters").set_index("parameter")
    assert frame.loc["latitude of the origin", ["t1", "t2", "unit"]].tolist() == [pytest.approx(44.23), pytest.approx(51.05), "deg"]
    assert frame.loc["gyro resolution", "t1"] == pytest.approx(1 / 18)
    assert frame.loc["initial error, sd, azimuth", "t1"] == pytest.approx(5.0)
    assert frame.loc["outage, greatest length", ["t1", "t2"]].tolist() == [240.0, 300.0]
    assert not frame["unit"].str.contains("rad").any()


def test_variances_are_deviations_in_the_tables_units(frame_of):
    frame = frame_of("extra-variances").set_index(["set", "state"])
    assert frame.loc[("data sheet, whole state", "azimuth"), "process_sd"] == pytest.approx(1.3 * 0.0237 / 20)
    assert frame.loc[("data sheet, error state", "odometer acceleration"), "initial_sd"] == pytest.approx(0.12)
    assert frame.loc[("physical", "up velocity"), "process_sd"] == pytest.approx(0.3)


def test_a_tuned_variant_shows_both_frozen_settings_and_no_other_has_one(frame_of):
    frame = frame_of("extra-variants").set_index("variant")
    assert frame.loc[NEW, ["t1_scale", "t2_multiple"]].tolist() == ["1e-10", "no gate"]
    assert all((row["t1_scale"] == "") == (VARIANTS[name].composition.get("cell", "none") == "none") for name, row in frame.iterrows())


def test_the_short_table_of_claims_holds_the_overall_verdict_of_each(frame_of):
    frame = frame_of("extra-claims")
    assert list(frame["claim_id"]) == [claim.claim_id for claim in CLAIMS]
    assert set(frame["verdict"]) == {"untestable"}
