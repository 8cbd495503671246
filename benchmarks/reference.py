"""`reference.c`, compiled for one system into a temporary folder and called through ctypes."""

import ctypes
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.models import Drive, Vehicle
from robins.kalman.predict import Ukf

SOURCE = Path(__file__).with_name("reference.c")
FLAGS = ("-O3", "-march=native", "-shared", "-fPIC")
POINTER = ctypes.POINTER(ctypes.c_double)


def compiler() -> str | None:
    """Path of ``$CC``, gcc or cc; None on a machine without a C compiler."""
    return next((found for name in (os.environ.get("CC"), "gcc", "cc") if name and (found := shutil.which(name))), None)


def definitions(drive: Drive) -> tuple[str, ...]:
    """The compiler's arguments that choose the system of `drive` and with it all sizes, and the prediction."""
    if not isinstance(drive.model, Vehicle):
        return '-DMODEL="strapdown.h"', f"-DAUGMENTED={int(drive.model.augmented)}"
    return ('-DMODEL="vehicle.h"',) + (("-DUNSCENTED",) if isinstance(drive.predictor, Ukf) else ())


def constants(drive: Drive) -> np.ndarray:
    """The fields of the struct Model, in its order."""
    model = drive.model
    if isinstance(model, Vehicle):
        return np.r_[model.dt, model.bias_decay, model.scale_decay, model.noise, drive.sensor.H.ravel()]
    earth = model.earth
    return np.r_[model.dt, model.decay, earth.gravity, earth.rate, earth.transport.ravel(), model.noise, model.transient]


class Reference:
    """The compiled reference, ready to run over one drive; `run` allocates nothing.

    After `run`: `states` ``(K, s)``, `covariances` ``(K, n, n)`` and `nis` ``(K,)``, all after the update.

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
            line = [command, *FLAGS, *definitions(drive), str(SOURCE), "-lm", "-o", str(library)]
            made = subprocess.run(line, capture_output=True, text=True)
            if made.returncode:
                raise RuntimeError(f"{command} failed: {made.stderr.strip().splitlines()[-1]}")
            self._function = ctypes.CDLL(str(library)).run_filter
        self._function.restype = ctypes.c_long
        inputs = (constants(drive), drive.predictor, drive.sensor.R, drive.x0, drive.P0, drive.controls, drive.measurements)
        self._inputs = [np.ascontiguousarray(array, float) for array in inputs]
        epochs = len(drive.controls)
        self.states, self.nis = np.empty((epochs, drive.x0.size)), np.empty(epochs)
        self.covariances = np.empty((epochs, *drive.P0.shape))
        outputs = (self.states, self.covariances, self.nis)
        pointers = [array.ctypes.data_as(POINTER) for array in (*self._inputs, *outputs)]
        self._arguments = (*pointers[:7], ctypes.c_long(epochs), *pointers[7:])

    def run(self) -> None:
        """Filter the whole drive."""
        if failed := self._function(*self._arguments):
            raise RuntimeError(f"the reference failed at epoch {failed - 1}")
