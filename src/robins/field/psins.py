"""Reader of the PSINS laser-gyro recording: an inertial unit in a parked vehicle, 30.8 min at 100 Hz.

The file is the upstream one, byte for byte (`SOURCE`). It is text: comment lines that begin with ``%``, three header
lines of six numbers, then one line of six whole numbers for each sampling interval, the increments that the unit counted.

    header 1   pitch, roll, yaw [deg], east, north, up velocity [m/s]; yaw is positive from north to west
    header 2   latitude, longitude [deg], height [m], start [s], sampling interval [ms], unit of gravity [m/s^2]
    header 3   scale factors: three gyros [arcsec per count], three accelerometers [ug s per count]
    data       gyros right, forward, up; accelerometers right, forward, up

Body frame ``b`` is right-forward-up. A time stamp is the end of its interval.
"""

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from robins.foundation.errors import InputError

FOLDER, NAME = "psins_rlg_static", "lasergyro.imu"
"""Where the file lies under the folder of recordings."""

COMMIT = "c1706f136d1a8dc64245e851cc77c8cac00a94b6"
SOURCE = f"https://github.com/WangShanpeng/PSINS/raw/{COMMIT}/data/lasergyro.imu"
"""Public address of the file, pinned to a commit of the repository github.com/WangShanpeng/PSINS."""

LICENCE = "BSD-2-Clause"
"""Licence of the recording (Copyright 2009-2015 Gongmin Yan)."""

SIZE = 2665416
"""Size of the file in bytes."""

SHA256 = "5de921e75f690c91ce6b7d3e811e547e050c4f1d000f648f537a59521206ba4d"

HEADER_NAMES = ("attitude and velocity", "place and sampling", "scale factors")
CHANNELS = 6
ARCSECOND = np.pi / 180 / 3600
MICRO = 1e-6


class Recording(NamedTuple):
    """Increments of an inertial unit with what the header says of them, SI and radians.

    Attributes
    ----------
    time : array, shape (N,)
        End of each interval [s].
    angle_increments : array, shape (N, 3)
        Integrals of the angular rate about right, forward, up over the interval [rad].
    velocity_increments : array, shape (N, 3)
        Integrals of the specific force along right, forward, up [m/s].
    interval : float
        Sampling interval [s].
    latitude, longitude, height : float
        Place [rad, rad, m].
    yaw : float
        Yaw in the header [rad], positive from north to west; a rough value of the upstream author.
    """

    time: np.ndarray
    angle_increments: np.ndarray
    velocity_increments: np.ndarray
    interval: float
    latitude: float
    longitude: float
    height: float
    yaw: float

    @property
    def rate_b(self) -> np.ndarray:
        """Angular rate against inertial space, mean over each interval, shape (N, 3) [rad/s]."""
        return self.angle_increments / self.interval

    @property
    def specific_force_b(self) -> np.ndarray:
        """Specific force, mean over each interval, shape (N, 3) [m/s^2]."""
        return self.velocity_increments / self.interval

    def between(self, start: float, end: float) -> "Recording":
        """The part whose time stamps lie in `start` to `end` [s], both included."""
        inside = (self.time >= start - self.interval / 2) & (self.time <= end + self.interval / 2)
        return self._replace(
            time=self.time[inside],
            angle_increments=self.angle_increments[inside],
            velocity_increments=self.velocity_increments[inside],
        )


def locate(recordings_dir) -> Path:
    """The recording under the folder `recordings_dir`, verified by size and sha256.

    Raises
    ------
    InputError
        The file is missing, or its size or hash is not the upstream file's. The message says where to get it.
    """
    path = Path(recordings_dir) / FOLDER / NAME
    expected = f"{SIZE} bytes with sha256 {SHA256}, as at {SOURCE} ({LICENCE})"
    if not path.is_file():
        raise InputError(path, "", "no such file", expected)
    if (size := path.stat().st_size) != SIZE:
        raise InputError(path, "size", f"{size} bytes", expected)
    if (digest := hashlib.sha256(path.read_bytes()).hexdigest()) != SHA256:
        raise InputError(path, "sha256", digest, expected)
    return path


def read(path) -> Recording:
    """The recording in the PSINS file `path`.

    Raises
    ------
    InputError
        The file is not text of the form above, is cut off, or does not hold a unit at rest in its units (specific
        force within 1 % of the header's gravity, angular rate within 1 deg/s on average).
    """
    lines = read_lines(path)
    numbered = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("%")]
    header = [header_line(path, name, *line) for name, line in zip(HEADER_NAMES, padded(numbered[:3]), strict=True)]
    counts = read_counts(path, numbered[3:])
    attitude, place, scale = header
    interval, gravity = place[4] * 1e-3, place[5]
    if interval <= 0 or gravity <= 0 or (scale <= 0).any():
        raise InputError(path, "header", "a number that is not positive", "sampling interval, gravity and scale factors above zero")
    recording = Recording(
        time=place[3] + interval * np.arange(1, len(counts) + 1),
        angle_increments=counts[:, :3] * (scale[:3] * ARCSECOND),
        velocity_increments=counts[:, 3:] * (scale[3:] * MICRO * gravity),
        interval=interval,
        latitude=np.radians(place[0]),
        longitude=np.radians(place[1]),
        height=place[2],
        yaw=np.radians(attitude[2]),
    )
    check_rest(path, recording, gravity)
    return recording


def read_lines(path) -> list[str]:
    """The lines of a text file that ends with a whole line."""
    try:
        text = Path(path).read_text(encoding="ascii")
    except FileNotFoundError:
        raise InputError(path, "", "no such file", "a PSINS log file") from None
    except UnicodeDecodeError as error:
        raise InputError(path, f"byte {error.start}", "a byte that is not ASCII", "a PSINS log file, which is text") from None
    if not text.startswith("% PSINS"):
        raise InputError(path, "row 1", repr(text[:20]), "a PSINS log file, which begins with '% PSINS'")
    if not text.endswith("\n"):
        raise InputError(path, "last row", "no line end: the file is cut off", "whole lines")
    return text.splitlines()


def padded(lines: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Three header lines; a missing one is empty, with row number 0."""
    return [*lines, *[(0, "")] * (3 - len(lines))]


def header_line(path, name: str, row: int, line: str) -> np.ndarray:
    """The six numbers of a header line, shape (6,)."""
    try:
        values = np.array(line.split(), dtype=float)
    except ValueError:
        values = np.empty(0)
    if values.shape != (CHANNELS,) or not np.isfinite(values).all():
        raise InputError(path, f"row {row} ({name})" if row else name, repr(line), f"{CHANNELS} numbers")
    return values


def read_counts(path, lines: list[tuple[int, str]]) -> np.ndarray:
    """Counts of all intervals as float64, shape (N, 6)."""
    if not lines:
        raise InputError(path, "data", "no rows", f"rows of {CHANNELS} whole numbers")
    for row, line in lines:
        if len(line.split()) != CHANNELS:
            raise InputError(path, f"row {row}", repr(line), f"{CHANNELS} whole numbers")
    try:
        return np.array(" ".join(line for _, line in lines).split(), dtype=np.int64).reshape(-1, CHANNELS).astype(float)
    except ValueError:
        row, line = next((row, line) for row, line in lines if not all(word.lstrip("-").isdecimal() for word in line.split()))
        raise InputError(path, f"row {row}", repr(line), f"{CHANNELS} whole numbers") from None


def check_rest(path, recording: Recording, gravity: float) -> None:
    """Refuse increments whose units cannot be right for a parked vehicle."""
    force = np.linalg.norm(recording.specific_force_b.mean(axis=0))
    if abs(force / gravity - 1) > 0.01:
        raise InputError(path, "accelerometers", f"a mean specific force of {force:.4g} m/s^2", f"{gravity:.4g} within 1 %")
    rate = np.degrees(np.linalg.norm(recording.rate_b.mean(axis=0)))
    if rate > 1:
        raise InputError(path, "gyros", f"a mean angular rate of {rate:.3g} deg/s", "a parked vehicle, below 1 deg/s")
