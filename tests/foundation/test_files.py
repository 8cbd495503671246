"""Atomic writing: whole or not at all."""

import os
import stat

import pytest

from robins.foundation.files import current_umask, replacing, write_text


def test_text_is_written_whole_as_utf8_with_unix_line_ends(tmp_path):
    target = tmp_path / "deep" / "er" / "page.md"
    write_text(target, "σ\nv\n")
    assert target.read_bytes() == b"\xcf\x83\nv\n"
    assert [p.name for p in target.parent.iterdir()] == ["page.md"]


@pytest.mark.parametrize("interruption", [RuntimeError, KeyboardInterrupt])
def test_an_interrupted_write_leaves_the_old_file_and_no_temporary(tmp_path, interruption):
    target = tmp_path / "table.csv"
    write_text(target, "old")
    with pytest.raises(interruption), replacing(target) as temporary:
        temporary.write_text("half")
        raise interruption
    assert target.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["table.csv"]


def test_an_interrupted_first_write_leaves_nothing(tmp_path):
    with pytest.raises(RuntimeError), replacing(tmp_path / "table.csv") as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert not list(tmp_path.iterdir())


def test_the_old_file_stands_until_the_new_one_is_complete(tmp_path):
    target = tmp_path / "table.csv"
    write_text(target, "old")
    with replacing(target) as temporary:
        temporary.write_text("new")
        assert target.read_text() == "old"
        assert temporary.parent == target.parent and temporary.suffix == ".csv"
    assert target.read_text() == "new"


def test_a_new_file_has_the_mode_that_the_umask_allows(tmp_path):
    write_text(tmp_path / "page.md", "")
    assert stat.S_IMODE((tmp_path / "page.md").stat().st_mode) == 0o666 & ~current_umask()


def test_reading_the_umask_leaves_it_as_it_was():
    before = os.umask(0o027)
    try:
        assert (current_umask(), current_umask()) == (0o027, 0o027)
    finally:
        os.umask(before)
