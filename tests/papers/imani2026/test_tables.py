"""Every table of the wing is what it promises, from fabricated results: its columns, its numbers, and failures as words."""

from zlib import crc32

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from robins.evaluate.ledger import COLUMNS, OVERALL
from robins.papers.imani2026.claims import CLAIMS
from robins.papers.imani2026.comparisons import PAIR, improvements
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.ensemble import headline, parameters
from robins.papers.imani2026.formulations import FORMULATIONS
from robins.papers.imani2026.methods import FAMILIES
from robins.papers.imani2026.options import OPTIONS
from robins.papers.imani2026.table_parts import SWEPT_FILTERS
from robins.papers.imani2026.tables import TABLES
from robins.papers.imani2026.tables_study import conventional
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Output, Results, Settings
from robins.publish import tables as writer
from robins.publish.tolerances import refuse_columns, refuse_tolerances

RUNS = 6
SETTINGS = Settings("smoke", 1, {"runs": RUNS, "tuning_runs": 2, "sweep_runs": RUNS, "fast_runs": RUNS, "bootstrap": 50}, OPTIONS)
BY_NAME = {table.name: table for table in TABLES}
MARKS = np.arange(30, 331, 30) * OPTIONS["rate_hz"]
ONE_RUN_LOST = "huber"
"""A filter that fails in run 0 of every formulation; `mk-raw` fails in all runs."""


def lost_runs(name: str) -> np.ndarray:
    """Which runs of a fabricated filter failed."""
    return np.full(RUNS, name == "mk-raw") | ((np.arange(RUNS) == 0) & (name == ONE_RUN_LOST))


def score_rows(name: str, channels=CHANNELS, **labels) -> pd.DataFrame:
    """Rows of a job: positive errors that depend on the labels; rmse^2 = mean^2 + sd^2."""
    generator = np.random.default_rng(crc32(repr((name, len(channels), labels)).encode()))
    mean, drift = generator.standard_normal((2, RUNS * len(channels)))
    sd = np.exp(0.3 * generator.standard_normal(mean.size))
    lost = np.repeat(lost_runs(name), len(channels))
    numbers = {"rmse": np.hypot(mean, sd), "mean": mean, "sd": sd, "drift": drift, "drift_integral": 330 * mean}
    return pd.DataFrame({
        **labels, "run": np.repeat(np.arange(RUNS), len(channels)), "channel": np.tile(channels, RUNS),
        **{key: np.where(lost, np.nan, values) for key, values in numbers.items()}, "failed": lost, "reason": np.where(lost, "lost", ""),
    })  # fmt: skip


def variant(name: str) -> Output:
    """A variant's job."""
    against = {"truth": CHANNELS, "interval": CHANNELS[3:9], "reference": CHANNELS}
    frames = [score_rows(name, channels, formulation=f, against=a) for f in FORMULATIONS for a, channels in against.items()]
    generator, failed, arrays = np.random.default_rng(crc32(name.encode())), lost_runs(name), {}
    for f in FORMULATIONS:
        found = {
            "nis": np.full(RUNS, np.nan) if name == "no-update" else 6 + generator.standard_normal(RUNS),
            "nees_attitude": generator.chisquare(3, (RUNS, len(MARKS))),
            "nees_bias": generator.chisquare(6, (RUNS, len(MARKS))),
            "position_rms": generator.chisquare(2, (RUNS, 3)),
            "position_final": generator.standard_normal((RUNS, 3)),
            "share_reduced": generator.random((RUNS, 6)),
        }
        for values in found.values():
            values[failed] = np.nan
        arrays |= {f"{f}.{key}": values for key, values in found.items()} | {f"{f}.failed": failed, f"{f}.marks": MARKS}
    return Output(pd.concat(frames, ignore_index=True), arrays)


def tuning(family: str) -> Output:
    """A tuning job: sixteen settings under each condition, one of which lost a run."""
    frames = []
    for condition in ("headline", "outliers"):
        scale, value = (values.ravel() for values in np.meshgrid([0.1, 1.0, 10.0, 100.0], [*FAMILIES[family].grid, 99.0], indexing="ij"))
        failed = np.arange(16) == 3
        frames.append(pd.DataFrame({
            "condition": condition, "noise_scale": scale, "parameter": FAMILIES[family].parameter, "value": value,
            "stage": ["grid"] * 9 + ["extension"] * 7, "objective": np.where(failed, np.inf, np.arange(16) - 1.5),
            "failed": failed.astype(int), "chosen": np.arange(16) == 5,
        }))  # fmt: skip
    return Output(pd.concat(frames, ignore_index=True))


def filter_rows(names, **labels) -> pd.DataFrame:
    """Rows of a study whose filters have names."""
    frames = [score_rows(name, **labels).assign(filter=name) for name in names]
    return pd.concat(frames, ignore_index=True)[[*labels, "filter", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]]


def labelled_rows(rows: list[dict]) -> pd.DataFrame:
    """Rows of a study whose filters have labels."""
    columns = ["run", "channel", "rmse", "mean", "drift", "failed", "reason"]
    return pd.concat([score_rows("any", **labels)[[*labels, *columns]] for labels in rows], ignore_index=True)


def study(name: str) -> pd.DataFrame:
    """The studies, with a few of their conditions."""
    if name == "outliers":
        zero = filter_rows(SWEPT_FILTERS, law="nig-zero-mean", sided="two-sided", rate=0.0, tuned="headline")
        return pd.concat([zero, filter_rows(SWEPT_FILTERS, law="nig-zero-mean", sided="two-sided", rate=0.02, tuned="outliers")])
    if name == "grades":
        return pd.concat([filter_rows(SWEPT_FILTERS, grade=grade) for grade in ("vehicle", "atomic-ideal")])
    if name == "rates":
        return pd.concat([filter_rows(SWEPT_FILTERS, rate_hz=rate, noise="equal-psd") for rate in (10, 100)])
    if name == "ablations":
        names = ("ekf", "ci-seq-nominal", "mk-norm-gain-nominal")
        return filter_rows(names, ablation="as designed", formulation="F0")
    if name == "scale":
        methods = [("mk-norm", 1.0), ("mk-norm", np.inf), ("mk-norm-gain", 0.01), ("ekf-r", 1e4), ("no-update", 0.0), ("ci-seq", 1.0)]
        cases = [(f, rate) for f, rate in (("F0", 0.0), ("F1", 0.0), ("F1", 0.1))]
        return labelled_rows([{"formulation": f, "rate": r, "method": m, "scale": s} for f, r in cases for m, s in methods])
    return labelled_rows([conventional(OPTIONS), {"method": "mk-norm-gain", "setting": "2 kernels"}])


def fabricated(name: str) -> Output:
    """What the job `name` might have left behind."""
    if name == "drive":
        return Output(parameters(headline(SETTINGS)))
    if name in VARIANTS:
        return variant(name)
    if name.startswith("tuning-"):
        return tuning(name.removeprefix("tuning-"))
    if name == "theory":
        return Output(pd.DataFrame({"quantity": ["q"], "expected": [0.05], "value": [0.051], "low": [0.05], "high": [0.052], "n": [10]}))
    return Output(study(name))


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
def frame_of(load):
    """``frame_of(name)``: a table that read what it says that it needs and nothing else, built once."""
    built = {}

    def frame(name) -> pd.DataFrame:
        if name not in built:
            built[name] = build(name, load)
        return built[name].copy()

    return frame


def build(name, load) -> pd.DataFrame:
    def allowed(job):
        assert job in BY_NAME[name].needs
        return load(job)

    ledger = fabricated_ledger() if "claims" in BY_NAME[name].needs else None
    return BY_NAME[name].build(Results(SETTINGS, pd.DataFrame(), allowed, ledger))


def fabricated_ledger() -> pd.DataFrame:
    """Two rows for every claim, one of them overall."""
    same = dict.fromkeys(COLUMNS, "") | {"paper": "imani2026", "location": "abstract", "reason": "so it is", "n": RUNS}
    return pd.DataFrame([
        same | {"claim_id": claim.claim_id, "condition": condition, "verdict": f"verdict, {condition}"}
        for claim in CLAIMS for condition in (OVERALL, "F0")
    ])  # fmt: skip


def rmse(load, name, formulation) -> np.ndarray:
    """RMSE against the truth, (runs, 12), by pivoting."""
    table = load(name).table
    table = table[(table["formulation"] == formulation) & (table["against"] == "truth")]
    return table.pivot(index="run", columns="channel", values="rmse")[list(CHANNELS)].to_numpy()


@pytest.mark.parametrize("name", BY_NAME)
def test_a_table_reads_what_it_needs_keeps_its_promises_and_survives_the_disk(name, frame_of, tmp_path):
    table, frame = BY_NAME[name], frame_of(name)
    writer.write(frame, table, tmp_path / "table.csv", RUNS)  # refuses NaN, wrong columns and double keys
    back = writer.read(tmp_path / "table.csv", table)
    assert refuse_columns(table) == [] and refuse_tolerances(table, back) == []
    assert table.size in ("", *SETTINGS.sizes)


@pytest.mark.parametrize("name", ["table-5", "extra-position", "extra-outliers"])
def test_a_table_is_the_same_when_built_again(name, frame_of, load):
    pd.testing.assert_frame_equal(frame_of(name), build(name, load), check_exact=True)


def test_the_registry_holds_every_table_once_with_the_papers_five_first():
    assert len(BY_NAME) == len(TABLES)
    assert [table.name for table in TABLES[:5]] == [f"table-{i}" for i in range(1, 6)]
    assert all(f"Table {i} were not in the text" in BY_NAME[f"table-{i}"].caption for i in range(1, 6))


def test_captions_of_random_tables_name_their_runs():
    for table in TABLES:
        if table.size in ("runs", "sweep_runs", "fast_runs") and table.name != "extra-theory":
            assert "Runs 0 to n - 1" in table.caption, table.name
        if table.size == "tuning_runs":
            assert "1000" in table.caption, table.name


def test_table_5_holds_ensemble_values_and_improvements_in_the_papers_units(frame_of, load):
    frame = frame_of("table-5").set_index("channel")
    better, worse = (np.sqrt(np.mean(rmse(load, name, "F1") ** 2, axis=0)) for name in PAIR)
    for i, channel in enumerate(CHANNELS):
        factor = 180 / np.pi if i >= 9 else 1.0
        assert frame.loc[channel, "rmse_ci"] == pytest.approx(factor * worse[i])
        assert frame.loc[channel, "rmse_mkmc"] == pytest.approx(factor * better[i])
        assert frame.loc[channel, "rmse_improvement"] == pytest.approx(100 * (1 - better[i] / worse[i]))
    assert list(frame["unit"]) == ["m/s"] * 3 + ["m/s^2"] * 3 + ["rad/s"] * 3 + ["deg"] * 3
    assert (frame[["n", "ci_failed", "mkmc_failed"]] == [RUNS, 0, 0]).all(axis=None)


def test_p_values_of_table_5_are_adjusted_by_holm_over_the_twelve_channels(frame_of, load):
    raw = improvements(Results(SETTINGS, pd.DataFrame(), load), *PAIR, "F1", "truth", "drift").p
    order = np.argsort(raw, kind="stable")
    stepped = np.minimum(1.0, np.maximum.accumulate(raw[order] * np.arange(12, 0, -1)))
    assert frame_of("table-5")["drift_p_holm"].to_numpy()[order] == pytest.approx(stepped)


def test_the_long_table_repeats_table_5_and_compares_intervals_where_there_are_some(frame_of):
    long = frame_of("extra-table-5")
    short = frame_of("table-5").set_index("channel")
    assert len(long) == 3 * 4 * (12 + 6 + 12)
    assert set(long.loc[long["against"] == "interval", "channel"]) == set(CHANNELS[3:9])
    for row in long[(long["formulation"] == "F1") & (long["against"] == "truth")].to_dict("records"):
        assert row["improvement_low"] == short.loc[row["channel"], f"{row['metric']}_improvement_low"]
        assert row["ci"] == short.loc[row["channel"], f"{row['metric']}_ci"]


@pytest.mark.parametrize("name", ["extra-filters", "extra-ratios", "extra-position", "extra-consistency", "extra-weights"])
def test_a_filter_that_fails_in_every_run_has_the_word_failed_and_no_number(name, frame_of):
    frame = frame_of(name)
    rows = frame[frame["filter"] == "mk-raw"]
    columns = [column.name for column in BY_NAME[name].columns if column.kind == "number" and column.name != "expected"]
    assert len(rows) and (rows[columns] == "failed").all(axis=None)
    assert (rows["failed"] == RUNS).all() and (rows["n"] == RUNS).all()
    assert set(rows["formulation"]) == set(FORMULATIONS)


def test_a_run_that_failed_is_counted_and_left_out_but_for_the_median(frame_of, load):
    row = frame_of("extra-filters").set_index(["formulation", "filter", "channel"]).loc["F1", ONE_RUN_LOST, "a_n"]
    values = rmse(load, ONE_RUN_LOST, "F1")[:, CHANNELS.index("a_n")]
    assert row["rmse"] == pytest.approx(np.sqrt(np.nanmean(values**2))) and (row["n"], row["failed"]) == (RUNS, 1)
    assert row["median"] == pytest.approx(np.median(np.where(np.isnan(values), np.inf, values)))


def test_position_errors_are_root_mean_squares_over_the_drive_and_absolute_means_at_its_end(frame_of, load):
    row = frame_of("extra-position").set_index(["formulation", "filter", "axis"]).loc["F2", "gate", "north"]
    arrays = load("gate").arrays
    assert row["rms"] == pytest.approx(np.sqrt(np.mean(arrays["F2.position_rms"][:, 1] ** 2)))
    assert row["final"] == pytest.approx(np.mean(np.abs(arrays["F2.position_final"][:, 1])))
    assert row["rms_low"] <= row["rms"] <= row["rms_high"]


def test_a_filter_without_updates_has_errors_but_no_innovations(frame_of):
    frame = frame_of("extra-consistency")
    assert set(frame.loc[frame["filter"] == "no-update", "quantity"]) == {"NEES attitude", "NEES biases"}
    assert "NIS" in set(frame.loc[frame["filter"] == "ekf", "quantity"])


def test_the_band_of_an_honest_filter_is_that_of_chi_square_over_the_surviving_runs(frame_of, load):
    row = frame_of("extra-consistency").set_index(["formulation", "filter", "quantity", "time"]).sort_index().loc["F1", ONE_RUN_LOST]
    found = row.loc["NEES biases", 150]
    values = load(ONE_RUN_LOST).arrays["F1.nees_bias"][1:, 4]
    assert found["mean"] == pytest.approx(values.mean())
    assert [found["honest_low"], found["honest_high"]] == pytest.approx(stats.chi2.ppf([0.025, 0.975], 6 * (RUNS - 1)) / (RUNS - 1))
    samples = 3300 * (RUNS - 1)
    assert row.loc["NIS", 330]["honest_high"] == pytest.approx(stats.chi2.ppf(0.975, 6 * samples) / samples)


def test_weights_are_shown_for_filters_that_have_some(frame_of, load):
    frame = frame_of("extra-weights")
    assert not {"ekf", "ekf-tuned", "ekf-r4", "no-update"} & set(frame["filter"])
    row = frame.set_index(["formulation", "filter", "sensor"]).loc["F0", "gate", "gyroscope"]
    assert row["share"] == pytest.approx(load("gate").arrays["F0.share_reduced"][:, 3:].mean())


def test_every_setting_of_the_tuning_is_published_and_one_is_chosen(frame_of):
    frame = frame_of("extra-tuning")
    assert len(frame) == len(FAMILIES) * 2 * 16
    assert ((frame["chosen"] == "chosen").groupby([frame["family"], frame["condition"]]).sum() == 1).all()
    assert ((frame["objective"] == "failed") == (frame["failed"] > 0)).all()
    budget = frame_of("extra-budget").set_index("family")
    assert (budget["settings"] == 16).all() and set(budget.index) == set(FAMILIES)
    chosen = frame[(frame["family"] == "gate") & (frame["condition"] == "headline") & (frame["chosen"] == "chosen")].iloc[0]
    value = f"{budget.loc['gate', 'headline_value']:.4g}"
    assert (budget.loc["gate", "headline_noise_scale"], value) == (chosen["noise_scale"], chosen["value"])


def test_a_tuned_variant_shows_its_frozen_setting_and_no_other_has_one(frame_of):
    frame = frame_of("extra-variants").set_index("filter")
    assert frame.loc["ekf-tuned", "parameter"] == "multiplier of Q"
    assert all((row["value"] == "") == (row["tuned"] == "") for _, row in frame.iterrows())


def test_sweeps_compare_every_filter_but_the_chi_square_filter_with_it(frame_of, load):
    frame = frame_of("extra-outliers")
    assert set(frame["filter"]) == set(SWEPT_FILTERS) - {"ci-seq"}
    row = frame.set_index(["rate", "filter", "channel"]).loc[0.02, "mk-norm", "pitch"]
    table = load("outliers").table
    table = table[(table["rate"] == 0.02) & (table["channel"] == "pitch")].set_index("filter")["rmse"]
    own, other = (np.sqrt(np.mean(table[name] ** 2)) for name in ("mk-norm", "ci-seq"))
    assert row["rmse"] == pytest.approx(np.degrees(own))
    assert row["ratio"] == pytest.approx(own / other)


def test_the_map_is_of_the_kernels_in_f1_and_an_infinite_scale_is_a_word(frame_of):
    frame = frame_of("extra-map")
    assert set(frame["method"]) == {"mk-norm", "mk-norm-gain"} and set(frame["scale"]) == {"1", "inf", "0.01"}
    assert set(frame["rate"]) == {0.0, 0.1}
    controls = frame_of("extra-scale")
    assert set(controls["method"]) == {"mk-norm", "mk-norm-gain", "ekf-r", "no-update", "ci-seq"}
    assert set(controls["formulation"]) == {"F0", "F1"}


def test_the_conventional_filter_has_a_ratio_of_one_to_itself(frame_of):
    frame = frame_of("extra-grids")
    assert (frame.loc[frame["setting"] == conventional(OPTIONS)["setting"], "ratio"] == 1.0).all()


def test_the_short_table_of_claims_holds_the_overall_verdict_of_each(frame_of):
    frame = frame_of("extra-claims")
    assert list(frame["claim_id"]) == [claim.claim_id for claim in CLAIMS]
    assert set(frame["verdict"]) == {f"verdict, {OVERALL}"}


def test_table_4_has_degrees_where_the_job_has_radians(frame_of):
    frame = frame_of("table-4").set_index("parameter")
    assert frame.loc["latitude", ["value", "unit"]].tolist() == [pytest.approx(38.06), "deg"]
    assert frame.loc["gyroscope noise, sd of a sample", ["value", "unit"]].tolist() == [pytest.approx(np.degrees(0.002)), "deg/s"]
    assert "rad" not in "".join(frame["unit"])
