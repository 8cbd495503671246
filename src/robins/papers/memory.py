"""What is computed once for a `Results` and kept as long as it lives: several tables, figures and claims ask for the same."""

from collections.abc import Callable
from weakref import WeakKeyDictionary

from robins.papers.protocol import Results

_kept: WeakKeyDictionary[Results, dict] = WeakKeyDictionary()


def once(results: Results, key: tuple, make: Callable):
    """What `make` returns, made at the first call with this `key`."""
    kept = _kept.setdefault(results, {})
    if key not in kept:
        kept[key] = make()
    return kept[key]
