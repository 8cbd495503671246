"""Plug-ins: what their entry points name and which sources they bring, without importing them."""

import sys

import pytest

from robins import plugins


@pytest.fixture
def distribution(tmp_path, monkeypatch):
    """``distribution(name, group, entry, listed, **sources)``: an installed distribution made of a few files."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def make(name, group, entry, listed, **sources):
        for module, text in sources.items():
            (tmp_path / f"{module}.py").write_text(text)
        information = tmp_path / f"{name}-1.0.dist-info"
        information.mkdir()
        (information / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (information / "entry_points.txt").write_text(f"[{group}]\n{entry}\n")
        (information / "RECORD").write_text("".join(f"{file},,\n" for file in listed))
        return tmp_path

    return make


def test_entry_points_are_sorted_by_name_whatever_is_installed_first(distribution):
    distribution("zeta", plugins.WEIGHTS, "b-weight = zeta_module", [])
    distribution("alpha", plugins.WEIGHTS, "a-weight = alpha_module\nc-weight = alpha_module", [])
    names = [entry.name for entry in plugins.found(plugins.WEIGHTS)]
    assert names == sorted(names) and {"a-weight", "b-weight", "c-weight"} <= set(names)


@pytest.mark.parametrize("group", [plugins.WEIGHTS, plugins.PAPERS])
def test_sources_are_listed_and_never_imported(distribution, group):
    folder = distribution("zeta", group, "z = zeta_module:thing", ["zeta_module.py", "zeta_helper.py", "notes.txt", "gone.py"],
                          zeta_module="raise RuntimeError", zeta_helper="raise RuntimeError")  # fmt: skip
    (folder / "notes.txt").write_text("")
    files = plugins.source_files()
    assert {(folder / "zeta_module.py").resolve(), (folder / "zeta_helper.py").resolve()} <= set(files)
    assert not {"notes.txt", "gone.py"} & {file.name for file in files}
    assert not {"zeta_module", "zeta_helper"} & set(sys.modules)


def test_a_module_that_its_distribution_does_not_list_is_found_where_it_would_be_imported_from(distribution):
    folder = distribution("zeta", plugins.WEIGHTS, "z = zeta_module", [], zeta_module="raise RuntimeError")
    assert (folder / "zeta_module.py").resolve() in plugins.source_files()


def test_an_entry_point_to_a_module_that_is_not_there_brings_no_source(distribution):
    before = plugins.source_files()
    distribution("zeta", plugins.WEIGHTS, "z = zeta_nowhere", [])
    assert plugins.source_files() == before


def test_distributions_without_an_entry_point_of_these_groups_bring_no_source(distribution):
    before = plugins.source_files()
    distribution("zeta", "console_scripts", "z = zeta_module:main", ["zeta_module.py"], zeta_module="")
    assert plugins.source_files() == before
