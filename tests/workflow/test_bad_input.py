"""Bad input is refused before anything is written: one line, exit code 1."""

import pytest


def test_an_unknown_key_is_refused(fresh):
    assert fresh.refusal("colour=blue") == (
        "robins: --config: colour: found an unknown key, expected one of ensemble, seed, papers, recordings, sizes, options"
    )


def test_text_in_a_number_column_of_the_published_values_is_refused(fresh):
    fresh.edit("toy.csv", "1.5", "about 1.5")
    line = fresh.refusal()
    assert "toy.csv: line 2, column value: found 'about 1.5', expected a number" in line


def test_a_missing_recording_is_refused_with_the_way_to_get_it(fresh):
    line = fresh.refusal(f"recordings={fresh.folder / 'nowhere'}")
    assert "nowhere/psins_rlg_static/lasergyro.imu: found no such file, expected 2665416 bytes" in line
    assert "https://github.com/" in line


def test_a_truncated_recording_is_refused(fresh):
    folder = fresh.site / "recordings" / "psins_rlg_static"
    folder.mkdir(parents=True)
    (folder / "lasergyro.imu").write_text("% PSINS\n0 0 0 0 0 0\n")
    line = fresh.refusal(f"recordings={folder.parent}")
    assert "lasergyro.imu: size: found 20 bytes, expected 2665416 bytes" in line


@pytest.mark.parametrize("setting", ["papers=[nobody]", "papers=nobody"])
def test_an_unknown_paper_is_refused(fresh, setting):
    assert fresh.refusal(papers=setting).startswith("robins: --config: papers: found 'nobody', expected ")


def test_a_job_that_needs_what_nobody_makes_is_refused(fresh):
    fresh.edit("toy.py", 'needs=("tuning",)', 'needs=("trimming",)')
    assert fresh.refusal() == (
        "robins: paper toy: needs of tuned: found 'trimming', "
        "expected one of constant, diagnose/constant, plain, shrunk, theory, tuned, tuning"
    )


@pytest.mark.slow
def test_a_run_without_recordings_says_how_to_get_one_and_leaves_the_field_results(fresh):
    kept = fresh.folder / "results" / "field" / "laser-gyro" / "extra-allan.csv"
    kept.parent.mkdir(parents=True)
    kept.write_text("kept\n")
    run = fresh("--cores", "2", "results/toy/tables/table-1.csv")
    assert run.returncode == 0, run.stderr
    said = [line for line in run.stderr.splitlines() if line.startswith("robins: no recordings")]
    assert len(said) == 1
    assert "https://github.com/" in said[0] and "sha256 5de921e7" in said[0]
    assert kept.read_text() == "kept\n"
    assert [file.name for file in kept.parent.iterdir()] == ["extra-allan.csv"]
