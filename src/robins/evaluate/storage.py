"""A job's output on disk: the table as parquet, the arrays as npz, both with the job's metadata.

Both files are complete or absent: they are written beside their place and moved onto it together. Equal
contents give equal bytes.
"""

import json
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet

from robins.foundation.errors import InputError
from robins.foundation.files import replacing

ARRAYS_KEY = "__metadata__"
TABLE_KEY = b"robins"


def write_output(output, table_path, arrays_path, metadata: dict) -> None:
    """Write ``output.table`` and ``output.arrays``.

    Parameters
    ----------
    output : object
        With a ``table`` (DataFrame; its index is dropped) and ``arrays`` (mapping of names to arrays of
        numbers, booleans or text; no Python objects).
    table_path, arrays_path : path
        ``.parquet`` and ``.npz``.
    metadata : dict
        Seed range, configuration hash, package version: anything JSON can hold.
    """
    if ARRAYS_KEY in output.arrays:
        raise ValueError(f"the array name {ARRAYS_KEY} is taken")
    arrays = {name: np.asarray(array) for name, array in output.arrays.items()}
    if objects := [name for name, array in arrays.items() if array.dtype.hasobject]:
        raise ValueError(f"arrays of Python objects cannot be stored: {', '.join(objects)}")
    text = json.dumps(metadata, sort_keys=True)
    table = pa.Table.from_pandas(output.table, preserve_index=False)
    table = table.replace_schema_metadata({**(table.schema.metadata or {}), TABLE_KEY: text.encode()})
    with replacing(table_path) as new_table, replacing(arrays_path) as new_arrays:
        parquet.write_table(table, new_table)
        np.savez(new_arrays, **arrays, **{ARRAYS_KEY: np.array(text)})


def read_output(table_path, arrays_path) -> tuple[pd.DataFrame, dict[str, np.ndarray]]:
    """Read what `write_output` wrote.

    Raises
    ------
    InputError
        A file is missing or cannot be read, or the two were not written by the same run of a job.
    """
    table, text = read_table(table_path)
    try:
        with open(arrays_path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
            arrays_text = arrays.pop(ARRAYS_KEY).item()
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(arrays_path, "", f"an unreadable file ({error})", "arrays with metadata, as npz") from error
    if arrays_text != text:
        raise InputError(arrays_path, ARRAYS_KEY, arrays_text, f"{text} as in {Path(table_path).name}")
    return table.to_pandas(), arrays


def read_metadata(table_path) -> dict:
    """The metadata of a job's output, from its table. Raises `InputError` as `read_output` does."""
    return json.loads(read_table(table_path)[1])


def read_table(table_path) -> tuple[pa.Table, str]:
    """A parquet table and its metadata as JSON text."""
    try:
        table = parquet.ParquetFile(table_path).read()
        return table, table.schema.metadata[TABLE_KEY].decode()
    except (OSError, pa.ArrowException, KeyError, TypeError) as error:
        raise InputError(table_path, "", f"an unreadable file ({error})", "a table with metadata, as parquet") from error
