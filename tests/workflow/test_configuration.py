"""Reading and checking the configuration, without a workflow around it."""

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
