"""`reference.c`, compiled into a temporary folder and called through ctypes."""

import ctypes
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.models import STATES, Drive

SOURCE = Path(__file__).with_name("reference.c")
FLAGS = ("-O3", "-march=native", "-shared", "-fPIC")
POINTER = ctypes.POINTER(ctypes.c_double)


def compiler() -> str | None:
    """Path of ``$CC``, gcc or cc; None on a machine without a C compiler."""
    return next((found for name in (os.environ.get("CC"), "gcc", "cc") if name and (found := shutil.which(name))), None)


class Reference:
    """The compiled reference, ready to run over one drive; `run` allocates nothing.

    After `run`: `states` ``(K, 9)``, `covariances` ``(K, 9, 9)`` and `nis` ``(K,)``, all after the update.

    Raises
    ------
    RuntimeError
        No compiler, or it refuses the source.
    """

    def __init__(self, drive: Drive):
        command = compiler()
        if command is None:
            raise RuntimeError("no C compiler")
        with tempfile.TemporaryDirectory() as folder:
            library = Path(folder) / "reference.so"
            made = subprocess.run([command, *FLAGS, str(SOURCE), "-lm", "-o", str(library)], capture_output=True, text=True)
            if made.returncode:
                raise RuntimeError(f"{command} failed: {made.stderr.strip().splitlines()[-1]}")
            self._function = ctypes.CDLL(str(library)).run_filter
        self._function.restype = ctypes.c_long
        model, epochs = drive.model, len(drive.controls)
        vehicle = np.array([model.dt, model.bias_decay, model.scale_decay, *model.noise])
        inputs = (vehicle, drive.sensor.H, drive.sensor.R, drive.x0, drive.P0, drive.controls, drive.measurements)
        self._inputs = [np.ascontiguousarray(array, float) for array in inputs]
        self.states, self.nis = np.empty((epochs, STATES)), np.empty(epochs)
        self.covariances = np.empty((epochs, STATES, STATES))
        outputs = (self.states, self.covariances, self.nis)
        pointers = [array.ctypes.data_as(POINTER) for array in (*self._inputs, *outputs)]
        self._arguments = (*pointers[:7], ctypes.c_long(epochs), *pointers[7:])

    def run(self) -> None:
        """Filter the whole drive."""
        if failed := self._function(*self._arguments):
            raise RuntimeError(f"the reference failed at epoch {failed - 1}")
