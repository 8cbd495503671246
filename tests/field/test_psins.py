"""The reader: a file of known content, the upstream file's own numbers, and everything that is refused."""

import hashlib

import numpy as np
import pandas as pd
import pytest

from robins.field import psins
from robins.foundation.errors import InputError


def test_counts_become_radians_and_metres_per_second(write_log, rows):
    recording = psins.read(write_log(rows))
    np.testing.assert_allclose(recording.angle_increments, np.radians(rows[:, :3] * np.array([0.1, 0.2, 0.3]) / 3600), rtol=1e-14)
    np.testing.assert_allclose(recording.velocity_increments, rows[:, 3:] * 125e-6 * 9.780327, rtol=1e-14)
    np.testing.assert_allclose(recording.rate_b, recording.angle_increments * 100, rtol=1e-14)
    np.testing.assert_allclose(recording.specific_force_b, recording.velocity_increments * 100, rtol=1e-14)


def test_time_stamps_are_the_ends_of_the_intervals(write_log, rows):
    recording = psins.read(write_log(rows))
    np.testing.assert_allclose(recording.time, 5 + 0.01 * np.arange(1, 51), rtol=1e-14)


def test_header_gives_place_and_yaw_in_radians(write_log, rows):
    recording = psins.read(write_log(rows))
    assert np.degrees([recording.latitude, recording.longitude, recording.yaw]) == pytest.approx([34.246048, 108.909664, -90.6])
    assert (recording.height, recording.interval) == (380.0, 0.01)


def test_part_of_a_recording_includes_both_of_its_ends(write_log, rows):
    part = psins.read(write_log(rows)).between(5.1, 5.2)
    np.testing.assert_allclose(part.time, 5 + 0.01 * np.arange(10, 21))
    np.testing.assert_allclose(part.velocity_increments, rows[9:20, 3:] * 125e-6 * 9.780327)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ("1 2 3 4 80", "row 58: found '1 2 3 4 80', expected 6 whole numbers"),
        ("1 2 3 4 5 80 7", "row 58"),
        ("1 2 3 x 5 80", "row 58: found '1 2 3 x 5 80'"),
        ("1 2 3 nan 5 80", "row 58"),
        ("1 2 3 0.5 5 80", "row 58"),
    ],
)
def test_a_bad_row_is_named_by_its_number_in_the_file(write_log, rows, bad, message):
    path = write_log(rows)
    path.write_text(path.read_text() + bad + "\n")
    row = path.read_text().splitlines().index(bad) + 1
    with pytest.raises(InputError, match=message.replace("58", str(row))):
        psins.read(path)


def test_a_file_cut_off_within_a_row_is_refused(write_log, rows):
    path = write_log(rows)
    path.write_bytes(path.read_bytes()[:-3])
    with pytest.raises(InputError, match="cut off"):
        psins.read(path)


@pytest.mark.parametrize("kept", [1, 3, 4, 5, 6])
def test_a_file_cut_off_within_its_header_is_refused(write_log, rows, kept):
    path = write_log(rows)
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:kept]))
    with pytest.raises(InputError, match="attitude|place|scale|data"):
        psins.read(path)


@pytest.mark.parametrize("wrong", [{"roll": "nan"}, {"roll": "level"}, {"interval": "0.0"}, {"interval": "-10.0"}, {"scale": "-125.0"}])
def test_an_impossible_header_is_refused(write_log, rows, wrong):
    with pytest.raises(InputError, match="unit.imu"):
        psins.read(write_log(rows, **wrong))


def test_accelerometers_in_another_unit_are_refused(write_log, rows):
    with pytest.raises(InputError, match="accelerometers: found a mean specific force of 9[78].* expected 9.78 within 1 %"):
        psins.read(write_log(rows, scale="12500.000"))


def test_gyros_of_a_moving_vehicle_are_refused(write_log, rows):
    with pytest.raises(InputError, match="gyros"):
        psins.read(write_log(rows + [0, 0, 1000, 0, 0, 0]))


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"t,dtheta\n", b"\xff\xfe"])
def test_another_kind_of_file_is_refused(tmp_path, content):
    path = tmp_path / "other.imu"
    path.write_bytes(content)
    with pytest.raises(InputError, match="PSINS log file"):
        psins.read(path)


def folder_with(tmp_path, content):
    path = tmp_path / psins.FOLDER / psins.NAME
    path.parent.mkdir()
    path.write_bytes(content)
    return tmp_path


@pytest.mark.parametrize("content", [None, b"% PSINS", bytes(psins.SIZE)], ids=["missing", "truncated", "altered"])
def test_a_wrong_recording_is_refused_in_one_line_that_says_where_to_get_it(tmp_path, content):
    folder = tmp_path if content is None else folder_with(tmp_path, content)
    with pytest.raises(InputError) as refusal:
        psins.locate(folder)
    message = str(refusal.value)
    found = {None: "no such file", b"% PSINS": "size: found 7 bytes"}.get(content, hashlib.sha256(bytes(psins.SIZE)).hexdigest())
    assert "\n" not in message
    for part in ("psins_rlg_static/lasergyro.imu", found, str(psins.SIZE), psins.SHA256, psins.SOURCE, "BSD-2-Clause"):
        assert part in message


def test_source_is_pinned_to_a_commit():
    assert psins.SOURCE == "https://github.com/WangShanpeng/PSINS/raw/c1706f136d1a8dc64245e851cc77c8cac00a94b6/data/lasergyro.imu"


def test_upstream_file_has_its_rows_rate_and_place(recording_path):
    recording = psins.read(recording_path)
    assert len(recording.time) == 184_718
    assert recording.time[[0, -1]] == pytest.approx([0.01, 1847.18])
    assert np.degrees([recording.latitude, recording.longitude]) == pytest.approx([34.246048, 108.909664])
    assert (recording.interval, recording.height) == (0.01, 380.0)


def test_upstream_file_reads_as_a_second_reader_does(recording_path):
    """pandas' own parser with factors written out: an independent way through the same text."""
    counts = pd.read_csv(recording_path, sep=r"\s+", header=None, skiprows=14).to_numpy()
    recording = psins.read(recording_path)
    np.testing.assert_allclose(recording.angle_increments, counts[:, :3] * (0.1 * np.pi / 648000), rtol=1e-14)
    np.testing.assert_allclose(recording.velocity_increments, counts[:, 3:] * 0.001222540875, rtol=1e-14)


def test_upstream_file_equals_its_tidy_conversion(recording_path):
    """Made from the same file by other code; columns t, dtheta_x..z, dv_x..z."""
    tidy = recording_path.parents[2] / "tidy" / psins.FOLDER / "imu_increments.parquet"
    if not tidy.is_file():
        pytest.skip(f"no tidy conversion beside the recordings: {tidy.name} under ../tidy/{psins.FOLDER}")
    expected = pd.read_parquet(tidy)
    recording = psins.read(recording_path)
    np.testing.assert_allclose(recording.time, expected["t"], rtol=1e-14)
    np.testing.assert_allclose(recording.angle_increments, expected[["dtheta_x", "dtheta_y", "dtheta_z"]], rtol=1e-14)
    np.testing.assert_allclose(recording.velocity_increments, expected[["dv_x", "dv_y", "dv_z"]], rtol=1e-14)
