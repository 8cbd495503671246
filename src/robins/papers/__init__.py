"""One wing per paper, and the list of them.

`all_papers` finds the wings in this folder and those of installed plug-ins (entry-point group
``robins.papers``). Nothing above or below knows a paper by name.
"""

import importlib
import pkgutil
from functools import cache
from typing import TYPE_CHECKING

from robins import plugins
from robins.foundation.errors import InputError

if TYPE_CHECKING:
    from robins.papers.protocol import Paper


@cache
def all_papers() -> "dict[str, Paper]":
    """Every paper by key, in alphabetical order.

    Raises
    ------
    InputError
        Two papers have one key: a plug-in may not stand in for a paper of this package.
    """
    wings = [importlib.import_module(f"{__name__}.{m.name}") for m in pkgutil.iter_modules(__path__) if m.ispkg]
    found = [wing.PAPER for wing in wings] + [entry.load() for entry in plugins.found(plugins.PAPERS)]
    for paper in found:
        if sum(other.key == paper.key for other in found) > 1:
            raise InputError("robins.papers", paper.key, "two papers with this key", "one")
    return {paper.key: paper for paper in sorted(found, key=lambda paper: paper.key)}
