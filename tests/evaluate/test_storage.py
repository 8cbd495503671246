"""Storage: the round trip, equal bytes, and what an interrupted write leaves."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pyarrow.parquet as parquet
import pytest

from robins.evaluate.storage import read_metadata, read_output, write_output
from robins.foundation.errors import InputError

METADATA = {"seeds": [0, 999], "config": "0123abcd", "version": "0.1.0"}


@pytest.fixture
def output():
    table = pd.DataFrame(
        {"branch": ["deg", "rad"], "run": [0, 1], "rmse": [0.1, np.nan], "failed": [False, True], "reason": ["", "not finite"]}
    )
    arrays = {"deg.fault.truth0": np.linspace(0, 1, 6).reshape(3, 2), "deg.count": np.array(5), "names": np.array(["u", "theta"])}
    return SimpleNamespace(table=table, arrays=arrays)


@pytest.fixture
def paths(tmp_path):
    return tmp_path / "job" / "ckf.parquet", tmp_path / "job" / "ckf.npz"


def test_what_is_written_is_read_back(output, paths):
    write_output(output, *paths, METADATA)
    table, arrays = read_output(*paths)
    pd.testing.assert_frame_equal(table, output.table)
    assert list(arrays) == list(output.arrays)
    for name, expected in output.arrays.items():
        assert arrays[name].dtype == expected.dtype
        np.testing.assert_array_equal(arrays[name], expected)
    assert read_metadata(paths[0]) == METADATA


def test_metadata_stand_in_both_files(output, paths):
    write_output(output, *paths, METADATA)
    assert b'"config": "0123abcd"' in parquet.read_schema(paths[0]).metadata[b"robins"]
    with np.load(paths[1]) as file:
        assert '"config": "0123abcd"' in file["__metadata__"].item()


def test_an_output_without_arrays_and_with_an_empty_table_survives(paths):
    empty = pd.DataFrame({"run": np.zeros(0, dtype=int)})
    write_output(SimpleNamespace(table=empty, arrays={}), *paths, {})
    table, arrays = read_output(*paths)
    pd.testing.assert_frame_equal(table, empty)
    assert arrays == {} and read_metadata(paths[0]) == {}


def test_equal_outputs_are_equal_bytes_whatever_the_order_of_the_metadata(output, paths, tmp_path):
    write_output(output, *paths, METADATA)
    again = tmp_path / "again.parquet", tmp_path / "again.npz"
    write_output(output, *again, dict(reversed(METADATA.items())))
    for first, second in zip(paths, again, strict=True):
        assert first.read_bytes() == second.read_bytes()


def test_an_interrupted_write_leaves_both_old_files_and_nothing_else(output, paths, monkeypatch):
    write_output(output, *paths, METADATA)
    before = [path.read_bytes() for path in paths]
    output.table["rmse"] = [7.0, 8.0]

    def interrupted(path, *args, **kwargs):
        path.write_bytes(b"half of a fi")
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_output(output, *paths, METADATA)
    assert [path.read_bytes() for path in paths] == before
    assert sorted(paths[0].parent.iterdir()) == sorted(paths)


def test_python_objects_and_the_reserved_name_are_refused_and_nothing_is_written(output, paths):
    for name, array in (("objects", np.array([{}, []], dtype=object)), ("__metadata__", np.zeros(1))):
        bad = SimpleNamespace(table=output.table, arrays={name: array})
        with pytest.raises(ValueError, match=name):
            write_output(bad, *paths, METADATA)
    assert not paths[0].exists() and not paths[1].exists()


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("damage", ["missing", "truncated", "empty", "foreign"])
def test_a_file_that_cannot_be_read_is_named(output, paths, which, damage):
    write_output(output, *paths, METADATA)
    victim = paths[which]
    if damage == "missing":
        victim.unlink()
    elif damage == "foreign":  # a good file of its kind, without our metadata
        output.table.to_parquet(victim) if which == 0 else np.savez(victim, x=1)
    else:
        victim.write_bytes(victim.read_bytes()[: 100 if damage == "truncated" else 0])
    with pytest.raises(InputError) as caught:
        read_output(*paths)
    assert caught.value.file == victim


def test_files_of_two_different_runs_do_not_go_together(output, paths, tmp_path):
    write_output(output, *paths, METADATA)
    other = tmp_path / "other.parquet", tmp_path / "other.npz"
    write_output(output, *other, METADATA | {"config": "changed"})
    with pytest.raises(InputError, match="changed"):
        read_output(paths[0], other[1])
