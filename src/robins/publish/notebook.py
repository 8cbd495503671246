"""Executing a notebook so that two runs give the same bytes."""

import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path

import nbformat
from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient

from robins.foundation.files import write_text

_ADDRESS = re.compile(r"0x[0-9a-f]{6,}")


class _ThisInterpreter(AsyncKernelManager):
    """Starts the kernel of this very interpreter: with no folder to look in, jupyter falls back on it."""

    def __init__(self, **settings):
        super().__init__(kernel_spec_manager=KernelSpecManager(kernel_dirs=[]), **settings)


def execute(source, target, workdir, environment: Mapping[str, str] | None = None, timeout: int = 600) -> None:
    """Execute the notebook `source` in `workdir` and write it, with its outputs, to `target`.

    The kernel is this very interpreter's, whatever kernels are installed under the name ``python3``.

    Parameters
    ----------
    source, target : Path
        Notebook without outputs; where the executed one goes (whole or not at all).
    workdir : Path
        The kernel's working directory.
    environment : mapping, optional
        Environment variables on top of this process's.
    timeout : int
        Seconds that one cell may take.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        A cell failed; nothing is written.
    """
    notebook = nbformat.read(source, as_version=4)
    client = NotebookClient(
        notebook,
        kernel_name="python3",
        kernel_manager_class=_ThisInterpreter,
        timeout=timeout,
        record_timing=False,
        extra_arguments=["--IPKernelApp.log_level=40"],  # else every kernel warns that its port on this machine is not encrypted
    )
    client.execute(env={**os.environ, **(environment or {})}, cwd=str(workdir))
    for text in strip(notebook):
        print(text, end="", file=sys.stderr)
    nbformat.validate(notebook)
    write_text(Path(target), nbformat.writes(notebook) + "\n")


def strip(notebook: nbformat.NotebookNode) -> list[str]:
    """Take out of `notebook`, in place, what differs between two runs or machines.

    Cell ids become their position, timestamps and memory addresses go, and of the interpreter only its language stays.

    Returns
    -------
    list of str
        What the cells wrote to standard error: warnings that name files of one machine do not belong in a publication.
    """
    notebook.metadata = nbformat.from_dict(
        {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python", "file_extension": ".py", "mimetype": "text/x-python", "pygments_lexer": "ipython3"},
        }
    )
    errors = []
    for position, cell in enumerate(notebook.cells):
        cell.id = f"cell-{position:03d}"
        cell.metadata.pop("execution", None)
        if cell.cell_type != "code":
            continue
        errors += [output.text for output in cell.outputs if _is_error_stream(output)]
        cell.outputs = [output for output in cell.outputs if not _is_error_stream(output)]
        for output in cell.outputs:
            _forget_addresses(output)
    return errors


def _is_error_stream(output) -> bool:
    return output.output_type == "stream" and output.name == "stderr"


def _forget_addresses(output) -> None:
    if "text" in output:
        output.text = _ADDRESS.sub("0x0", output.text)
    for kind, content in output.get("data", {}).items():
        if isinstance(content, str) and kind in ("text/plain", "text/html"):
            output.data[kind] = _ADDRESS.sub("0x0", content)
