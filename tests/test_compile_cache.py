"""The compile cache: a second process compiles nothing, no edit is served stale, and no folder that is not a cache is touched."""

import json
import os
import re
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import numba
import pytest

import robins
from robins import compile_cache, plugins

PACKAGE = Path(robins.__file__).parent

RUN = """
import gc, json, sys, warnings
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    import robins
import numba
import numpy as np
from numba.core.registry import CPUDispatcher
from robins.kalman.filter import run_filter
from robins.kalman.model import LinearModel, linear_sensor
from robins.kalman.predict import Ekf
from robins.kalman.weights import weighting
model, sensor = LinearModel(0.5 * np.eye(1), np.zeros((1, 1)), np.eye(1)), linear_sensor(np.eye(1), np.eye(1))
method = weighting("known", memory=np.array([[0.25]]))
arguments = np.zeros((1, 1)), np.eye(1), np.zeros((1, 1)), np.full((1, 1, 1), 6.0), np.ones(1, dtype=bool), 1, False
record = run_filter(Ekf(), model, sensor, method, *arguments)
used = [d for d in gc.get_objects() if isinstance(d, CPUDispatcher) and (d.stats.cache_misses or d.stats.cache_hits)]
mine = [d for d in used if d.py_func.__module__.startswith("robins")]
print(json.dumps({
    "package": robins.__file__, "cache": numba.config.CACHE_DIR, "warnings": [str(w.message) for w in caught],
    "posterior": record.posterior[0, 0, 0], "hits": sum(run_filter.dispatcher.stats.cache_hits.values()),
    "misses": sorted(d.py_func.__qualname__ for d in mine if d.stats.cache_misses),
}))
"""


def run(package_parent, cache):
    """What a process prints that filters one number with the package below `package_parent`."""
    environment = {**os.environ, "PYTHONPATH": str(package_parent), "ROBINS_CACHE": str(cache)}
    done = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert Path(result["package"]).is_relative_to(package_parent)
    return result


@pytest.fixture(scope="module")
def copied(tmp_path_factory):
    """A copy of the foundation and kalman floors, and a cache filled by a first process."""
    folder = tmp_path_factory.mktemp("copy")
    for part in ("foundation", "kalman"):
        shutil.copytree(PACKAGE / part, folder / "robins" / part, ignore=shutil.ignore_patterns("__pycache__"))
    for file in ("__init__.py", "compile_cache.py", "plugins.py"):
        shutil.copy(PACKAGE / file, folder / "robins")
    return folder, folder / "cache", run(folder, folder / "cache")


@pytest.mark.slow
def test_a_second_process_has_only_cache_hits(copied):
    folder, cache, first = copied
    second = run(folder, cache)
    assert "filter_records" in first["misses"] and first["hits"] == 0
    assert (second["misses"], second["hits"]) == ([], 1)
    assert second["posterior"] == first["posterior"] == pytest.approx(6 / 5)  # P = 1, R / w = 4
    assert second["warnings"] == [] and Path(second["cache"]).parent == cache


@pytest.mark.slow
def test_an_edit_in_a_file_that_the_filter_only_calls_is_never_served_stale(copied, tmp_path):
    """Numba alone would: it looks at the time of the caller's file only."""
    folder, cache, first = copied
    shutil.copytree(folder / "robins", tmp_path / "robins")
    weights = tmp_path / "robins" / "kalman" / "weights.py"
    text = weights.read_text()
    edited = text.replace("weights[i] = memory[epoch, i]", "weights[i] = memory[epoch, i] * 2")
    assert edited != text
    weights.write_text(edited)
    result = run(tmp_path, cache)
    assert result["posterior"] == pytest.approx(6 / 3)  # R / w = 2
    assert result["cache"] != first["cache"]
    assert run(folder, cache)["posterior"] == first["posterior"]


def test_the_digest_changes_with_every_name_and_every_byte():
    sources = {"a.py": b"x = 1", "b.py": b"y = 2"}
    variants = [sources, {"a.py": b"x = 2", "b.py": b"y = 2"}, {"c.py": b"x = 1", "b.py": b"y = 2"}, {"a.py": b"x = 1"},
                {"a.py": b"x = 1\0b.py\0", "b.py": b""}, {"a.py": b"y = 2", "b.py": b"x = 1"}, {}]  # fmt: skip
    digests = [compile_cache.sources_digest(variant) for variant in variants]
    assert len(set(digests)) == len(digests)
    assert all(re.fullmatch("[0-9a-f]{16}", digest) for digest in digests)
    assert compile_cache.sources_digest(dict(reversed(sources.items()))) == digests[0]


def test_the_digest_changes_with_the_version_of_numba(monkeypatch):
    before = compile_cache.sources_digest({})
    monkeypatch.setattr(numba, "__version__", "0.0")
    assert compile_cache.sources_digest({}) != before


def test_every_source_of_the_package_and_of_plugins_counts(tmp_path, monkeypatch):
    plugin = tmp_path / "weight.py"
    plugin.write_text("one")
    monkeypatch.setattr(plugins, "source_files", lambda: [plugin])
    sources = compile_cache.package_sources()
    files = {file.relative_to(PACKAGE).as_posix() for file in PACKAGE.rglob("*.py")}
    assert set(sources) == files | {f"plugin:{plugin}"}
    assert sources["kalman/update.py"] == (PACKAGE / "kalman" / "update.py").read_bytes()
    plugin.write_text("two")
    assert compile_cache.sources_digest(compile_cache.package_sources()) != compile_cache.sources_digest(sources)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """`activate` with a cache below `tmp_path`; Numba's own setting is put back afterwards."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", numba.config.CACHE_DIR)
    monkeypatch.setenv("ROBINS_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(compile_cache.tempfile, "tempdir", None)
    return tmp_path


def make_caches(folder, count):
    """`count` older caches, the first the oldest."""
    names = [f"{i:016x}" for i in range(count)]
    for age, name in enumerate(names):
        (folder / name).mkdir(parents=True)
        os.utime(folder / name, (1000 + age, 1000 + age))
    return names


def test_old_caches_are_pruned_and_nothing_else(here):
    folder = here / "cache"
    old = make_caches(folder, 7)
    (folder / "photographs").mkdir()
    (folder / "letter.txt").write_text("dear reader")
    active = compile_cache.activate()
    assert {p.name for p in folder.iterdir()} == {active.name, "photographs", "letter.txt", *old[-compile_cache.KEPT_CACHES :]}
    assert numba.config.CACHE_DIR == str(active)


def test_a_cache_that_is_used_again_is_young_again(here):
    active = compile_cache.activate()
    os.utime(active, (1, 1))
    make_caches(here / "cache", 7)
    assert compile_cache.activate() == active and active.is_dir()
    assert active.stat().st_mtime > 1007


def test_a_cache_that_another_process_prunes_meanwhile_is_no_error(here, monkeypatch):
    old = make_caches(here / "cache", 6)
    stat = Path.stat

    def vanishing(self, **options):
        if self.name == old[2]:
            raise FileNotFoundError(self)
        return stat(self, **options)

    monkeypatch.setattr(Path, "stat", vanishing)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert compile_cache.activate().parent == here / "cache"
    assert not (here / "cache" / old[0]).exists()


def test_a_cache_that_cannot_be_written_falls_back_to_a_temporary_one_with_one_warning(here, monkeypatch):
    """Below a regular file no folder can be made, not even by root."""
    (here / "file").write_text("")
    monkeypatch.setenv("ROBINS_CACHE", str(here / "file" / "cache"))
    with pytest.warns(RuntimeWarning, match="cannot write the compile cache") as caught:
        folder = compile_cache.activate()
    assert len(caught) == 1
    assert folder.is_dir() and folder.is_relative_to(here / "temporary") and str(folder) in str(caught[0].message)
    assert numba.config.CACHE_DIR == str(folder)


def test_a_temporary_cache_of_somebody_else_is_not_used(here, monkeypatch):
    mine = compile_cache.temporary_cache()
    assert mine == compile_cache.temporary_cache() and mine.stat().st_mode & 0o077 == 0
    monkeypatch.setattr(os, "getuid", lambda: 123_456)  # whoever that is: the folder of this name is made by us
    theirs = here / "temporary" / "robins-123456"
    assert compile_cache.temporary_cache() != theirs and theirs.is_dir()


def test_a_process_with_an_unwritable_cache_warns_once_and_computes(copied, tmp_path, monkeypatch):
    folder, cache, first = copied
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    fallback = tmp_path / f"robins-{os.getuid()}"
    shutil.copytree(cache, fallback)  # so that this process need not compile
    result = run(folder, tmp_path / "file")
    assert len(result["warnings"]) == 1 and "cannot write the compile cache" in result["warnings"][0]
    assert result["posterior"] == first["posterior"] and Path(result["cache"]).parent == fallback


@pytest.mark.parametrize(
    ("platform", "variables", "expected"),
    [
        ("linux", {"ROBINS_CACHE": "/somewhere/else", "XDG_CACHE_HOME": "/xdg"}, "/somewhere/else"),
        ("linux", {"XDG_CACHE_HOME": "/xdg"}, "/xdg/robins"),
        ("linux", {"XDG_CACHE_HOME": ""}, "/home/reader/.cache/robins"),
        ("darwin", {}, "/home/reader/Library/Caches/robins"),
    ],
)
def test_the_cache_is_an_absolute_user_folder(monkeypatch, platform, variables, expected):
    for name in ("ROBINS_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in {"HOME": "/home/reader", **variables}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "platform", platform)
    assert compile_cache.user_cache() == Path(expected)


def test_a_relative_override_is_made_absolute(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ROBINS_CACHE", "nearby")
    assert compile_cache.user_cache() == tmp_path / "nearby"
