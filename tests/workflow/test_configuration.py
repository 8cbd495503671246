"""Reading and checking the configuration, without a workflow around it."""

from dataclasses import replace
from pathlib import Path

import pytest

from robins.foundation.errors import InputError
from robins.papers import all_papers, configuration

from .conftest import ROOT

CONFIG = ROOT / "config" / "config.yaml"


def message(*arguments, **overrides) -> str:
    """What is said about a configuration that is refused."""
    with pytest.raises(InputError) as refused:
        configuration.load(*(arguments or [CONFIG]), overrides or None)
    return str(refused.value)


def beside_the_schema(folder: Path, text: str) -> Path:
    """A repository with this configuration and the schema of ours."""
    (folder / "config").mkdir()
    (folder / "workflow").mkdir()
    (folder / "workflow" / "schemas").symlink_to(ROOT / "workflow" / "schemas")
    path = folder / "config" / "config.yaml"
    path.write_text(text)
    return path


def test_the_committed_configuration_is_sound():
    loaded = configuration.load(CONFIG)
    assert (loaded.ensemble, loaded.recordings) == ("standard", None)
    assert loaded.papers == tuple(all_papers())


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        ({"ensemble": "huge"}, "--config: ensemble: found 'huge', expected smoke, standard or full"),
        ({"seed": -1}, "--config: seed: found -1, expected a whole number, zero or more"),
        ({"seed": 1.0}, "--config: seed: found 1.0, expected a whole number, zero or more"),
        ({"seed": True}, "--config: seed: found True, expected a whole number, zero or more"),
        ({"papers": []}, "--config: papers: found [], expected all, or a list of different paper keys"),
        ({"papers": ["nobody"]}, "--config: papers: found 'nobody', expected one of "),
        ({"recordings": 3}, "--config: recordings: found 3, expected a folder, or null"),
        ({"sizes": {"nobody": {}}}, "--config: sizes: found 'nobody', expected one of "),
        ({"options": {"nobody": {}}}, "--config: options: found 'nobody', expected one of "),
        (
            {"sizes": {"nobody": {"smoke": {"runs": "-5"}}}},
            "--config: sizes.nobody.smoke.runs: found -5, expected a whole number, one or more",
        ),
        ({"extra": 1}, "--config: extra: found an unknown key, expected one of ensemble, seed, "),
    ],
)
def test_a_mistake_is_named_with_its_place_and_what_was_expected(overrides, said):
    assert message(**overrides).startswith(said)


@pytest.fixture
def tuning(tmp_path, monkeypatch):
    """``tuning(**sizes)``: a configuration of a paper that tunes on its runs 1000, 1001, ... and has these `sizes` by itself."""
    known = next(iter(all_papers().values()))

    def make(**sizes):
        smoke = {"runs": 8, "sweep_runs": 4, "tuning_runs": 2, "bootstrap": 5000} | sizes
        paper = replace(known, key="tuned", sizes={"smoke": smoke}, first_runs={"tuning_runs": 1000})
        monkeypatch.setattr(configuration, "all_papers", lambda: {"tuned": paper})
        return path

    path = beside_the_schema(tmp_path, "ensemble: smoke\nseed: 1\npapers: all\n")
    return make


def sized(**sizes):
    """What the command line says about the sizes of that paper."""
    return {"sizes": {"tuned": {"smoke": sizes}}}


def test_no_reported_run_is_one_that_was_tuned_on(tuning):
    path = tuning()
    accepted = configuration.load(path, sized(runs=1000, tuning_runs=4000, bootstrap=9000))
    assert configuration.settings_for(configuration.all_papers()["tuned"], accepted).sizes["tuning_runs"] == 4000
    for name in ("runs", "sweep_runs"):
        with pytest.raises(InputError) as refused:
            configuration.load(path, sized(**{name: 1001}))
        expected = "expected at most 1000: tuning_runs are the runs from 1000 on"
        assert str(refused.value) == f"--config: sizes.tuned.smoke.{name}: found 1001, {expected}"


def test_a_configuration_file_with_too_many_runs_is_named(tuning, tmp_path):
    path = tuning()
    path.write_text(path.read_text() + "sizes: {tuned: {standard: {runs: 1200}}}\n")
    with pytest.raises(InputError) as refused:
        configuration.load(path)
    assert str(refused.value).startswith(f"{path}: sizes.tuned.standard.runs: found 1200, expected at most 1000: ")


def test_the_sizes_of_a_wing_itself_keep_reported_and_tuned_runs_apart(tuning):
    with pytest.raises(InputError, match=r"^robins\.papers\.tuned: sizes\.tuned\.smoke\.runs: found 2000, expected at most 1000"):
        configuration.load(tuning(runs=2000))


def test_a_first_run_of_no_size_is_refused(tuning, monkeypatch):
    path = tuning()
    paper = replace(configuration.all_papers()["tuned"], first_runs={"trimming_runs": 1000})
    monkeypatch.setattr(configuration, "all_papers", lambda: {"tuned": paper})
    with pytest.raises(InputError, match="^robins.papers.tuned: first_runs: found 'trimming_runs', expected one of bootstrap, runs, "):
        configuration.load(path)


def test_a_missing_key_is_named(tmp_path):
    path = beside_the_schema(tmp_path, "ensemble: smoke\npapers: all\n")
    assert message(path) == f"{path}: seed: found nothing, expected a whole number, zero or more"


def test_text_that_is_not_yaml_is_one_line(tmp_path):
    path = beside_the_schema(tmp_path, "ensemble: [smoke\nseed: 1\n")
    said = message(path)
    assert said.startswith(f"{path}: found ") and said.endswith("expected YAML") and "\n" not in said


def test_the_command_line_wins_and_merges_key_by_key(tmp_path):
    paper = next(iter(all_papers().values()))
    names = list(paper.sizes["smoke"])
    loaded = configuration.load(CONFIG, {"ensemble": "smoke", "sizes": {paper.key: {"smoke": {names[0]: 3}}}})
    settings = configuration.settings_for(paper, loaded)
    assert settings.ensemble == "smoke"
    assert settings.sizes[names[0]] == 3
    assert set(settings.sizes) == set(names)


def test_numbers_and_nulls_that_the_command_line_leaves_as_text_are_read():
    assert configuration.spoken({"runs": "5", "recordings": "null", "folder": "a: b", "papers": ["x"]}) == {
        "runs": 5,
        "recordings": None,
        "folder": "a: b",
        "papers": ["x"],
    }


def test_a_configuration_survives_the_way_to_a_job():
    loaded = configuration.load(CONFIG, {"recordings": "somewhere"})
    assert configuration.from_values(loaded.values, Path("elsewhere")) == loaded


def test_a_relative_folder_of_recordings_is_relative_to_the_repository():
    assert configuration.load(CONFIG, {"recordings": "somewhere"}).recordings == ROOT / "somewhere"


def test_the_digest_tells_settings_apart_but_not_where_recordings_lie():
    paper = next(iter(all_papers().values()))

    def digest(**overrides):
        return configuration.digest(configuration.settings_for(paper, configuration.load(CONFIG, overrides)))

    assert digest() == digest(recordings="elsewhere")
    assert digest() != digest(seed=1)
