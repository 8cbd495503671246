"""Where Numba keeps the compiled kernels, so that a second process compiles nothing and an edit is never served stale.

Numba stamps a cached function with the modification time of its own file only: after an edit in a
function that it *calls* from another file it would return the old result. The cache folder is
therefore named by a hash of every source of the package (relative path and bytes) and of every
installed plug-in (entry points, see `robins.plugins`): any edit opens a new, empty folder.
"""

import hashlib
import os
import re
import shutil
import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

import numba

from robins import plugins

KEPT_CACHES = 4
"""How many caches of earlier sources survive a pruning."""


def sources_digest(sources: dict[str, bytes]) -> str:
    """Sixteen hexadecimal digits that change with any name or byte of `sources` and with Numba's version."""
    digest = hashlib.sha256(f"numba {numba.__version__} python {sys.version_info[:3]}".encode())
    for name, content in sorted(sources.items()):
        digest.update(f"\0{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()[:16]


def package_sources() -> dict[str, bytes]:
    """Relative path and bytes of every Python source of the package and of the installed plug-ins."""
    root = Path(__file__).parent
    sources = {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*.py")}
    sources.update({f"plugin:{path}": path.read_bytes() for path in plugins.source_files()})
    return sources


def user_cache() -> Path:
    """The folder that holds all caches: ``$ROBINS_CACHE`` or the platform's user cache."""
    if override := os.environ.get("ROBINS_CACHE"):
        return Path(override).expanduser().absolute()
    base = Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")
    return Path(os.environ.get("XDG_CACHE_HOME") or base) / "robins"


def temporary_cache() -> Path:
    """A folder among the temporary files that later processes find again, unless somebody else owns it: caches hold code."""
    folder = Path(tempfile.gettempdir()) / f"robins-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder if folder.stat().st_uid == os.getuid() else Path(tempfile.mkdtemp(prefix="robins-"))


def prune(parent: Path, keep: Path) -> None:
    """Delete all but the `KEPT_CACHES` most recently used caches in `parent`; never `keep`, nor a folder that is not a cache.

    Other processes may prune at the same time, so a folder may vanish at any moment.
    """
    used = {}
    for folder in parent.iterdir():
        if folder != keep and re.fullmatch("[0-9a-f]{16}", folder.name):
            with suppress(FileNotFoundError):
                used[folder] = folder.stat().st_mtime
    for stale in sorted(used, key=used.get, reverse=True)[KEPT_CACHES:]:
        shutil.rmtree(stale, ignore_errors=True)


def activate() -> Path:
    """Point Numba at the cache of these sources and return it.

    A folder that cannot be written falls back to a temporary one with one warning.
    """
    digest = sources_digest(package_sources())
    folder = user_cache() / digest
    try:
        folder.mkdir(parents=True, exist_ok=True)
        folder.touch()
        with tempfile.TemporaryFile(dir=folder):
            pass
        prune(folder.parent, keep=folder)
    except OSError as error:
        folder = temporary_cache() / digest
        folder.mkdir(exist_ok=True)
        warnings.warn(f"cannot write the compile cache ({error}); using {folder}", RuntimeWarning, stacklevel=2)
    numba.config.CACHE_DIR = str(folder)
    return folder
