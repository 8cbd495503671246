"""The manifest holds what any machine reproduces; run-info.json holds the rest."""

import hashlib
import json

from robins.publish import manifest


def written(folder, source="a" * 64):
    manifest.write_record(folder / "one.json", {"p/tables/t.csv": manifest.entry("tables", 1000, source, 12)})
    manifest.write_record(folder / "two.json", {"p/figures/f.png": manifest.entry("figures", None, "b" * 64)})
    (folder / "requirements.lock").write_text("numpy==2.4.6\n")
    records = [folder / "one.json", folder / "two.json"]
    manifest.write_manifest(folder / "manifest.json", records, folder / "requirements.lock", {"seed": 1, "sizes": {}}, {"seed": 1})
    return json.loads((folder / "manifest.json").read_text())


def test_it_collects_what_the_rules_recorded(tmp_path):
    content = written(tmp_path)
    assert content["artefacts"]["p/tables/t.csv"] == {"rule": "tables", "n": 1000, "source_hash": "a" * 64, "cells": 12}
    assert content["artefacts"]["p/figures/f.png"] == {"rule": "figures", "n": None, "source_hash": "b" * 64}
    assert list(content["artefacts"]) == sorted(content["artefacts"])
    assert content["lock_hash"] == hashlib.sha256(b"numpy==2.4.6\n").hexdigest()
    assert content["seeds"] == {"seed": 1}


def test_its_source_hash_changes_with_any_artefacts(tmp_path):
    assert written(tmp_path)["source_hash"] != written(tmp_path, "c" * 64)["source_hash"]


def test_two_writings_give_the_same_bytes_and_no_path_of_the_machine(tmp_path):
    written(tmp_path)
    first = (tmp_path / "manifest.json").read_bytes()
    written(tmp_path)
    assert (tmp_path / "manifest.json").read_bytes() == first
    assert str(tmp_path).encode() not in first


def test_it_names_the_versions_of_the_packages_that_change_numbers():
    versions = manifest.versions()
    assert {"python", "numpy", "scipy", "numba", "matplotlib"} <= set(versions)
    assert versions["python"].count(".") == 1


def test_run_info_has_the_hash_of_every_file_and_the_machine(tmp_path):
    (tmp_path / "results" / "p").mkdir(parents=True)
    (tmp_path / "results" / "p" / "t.csv").write_bytes(b"x\n")
    manifest.write_run_info(tmp_path / "run-info.json", tmp_path, tmp_path / "results")
    content = json.loads((tmp_path / "run-info.json").read_text())
    assert content["sha256"] == {"p/t.csv": hashlib.sha256(b"x\n").hexdigest()}
    assert content["commit"] == ""  # no repository there
    assert content["blas"]["name"] and content["machine"]
