"""An executed notebook has the same bytes in every run."""

import sys

import nbformat
import pytest
from nbclient.exceptions import CellExecutionError
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from robins.publish import notebook

CODE = """import os, sys
from pathlib import Path
print(os.environ["ROBINS_RESULTS"], Path("here.txt").read_text(), sys.executable == os.environ["INTERPRETER"])
print("a warning", "of this machine", file=sys.stderr)
object()"""


@pytest.fixture
def source(tmp_path):
    nbformat.write(new_notebook(cells=[new_markdown_cell("# Title"), new_code_cell(CODE)]), tmp_path / "source.ipynb")
    (tmp_path / "here.txt").write_text("read")
    return tmp_path / "source.ipynb"


def test_it_is_executed_by_this_interpreter_and_twice_alike(source, tmp_path, capsys):
    environment = {"ROBINS_RESULTS": "results", "INTERPRETER": sys.executable}
    for name in ("a.ipynb", "b.ipynb"):
        notebook.execute(source, tmp_path / "out" / name, tmp_path, environment)
    content = (tmp_path / "out" / "a.ipynb").read_bytes()
    assert content == (tmp_path / "out" / "b.ipynb").read_bytes()
    assert b"results read True" in content
    assert b"<object at 0x0>" in content
    assert b"a warning of this machine" not in content
    assert "a warning of this machine" in capsys.readouterr().err
    assert str(tmp_path).encode() not in content


def test_a_cell_that_fails_is_an_error_and_writes_nothing(tmp_path):
    nbformat.write(new_notebook(cells=[new_code_cell("1 / 0")]), tmp_path / "source.ipynb")
    with pytest.raises(CellExecutionError, match="ZeroDivisionError"):
        notebook.execute(tmp_path / "source.ipynb", tmp_path / "out.ipynb", tmp_path)
    assert not (tmp_path / "out.ipynb").exists()


def test_ids_timestamps_and_versions_are_stripped():
    cell = new_code_cell("x", id="random", metadata={"execution": {"iopub.execute_input": "2026-01-01"}})
    book = new_notebook(cells=[cell], metadata={"language_info": {"name": "python", "version": "3.11.7"}})
    notebook.strip(book)
    assert book.cells[0].id == "cell-000"
    assert book.cells[0].metadata == {}
    assert "version" not in book.metadata.language_info
