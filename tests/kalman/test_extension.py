"""Models from outside: found by their type, compiled afresh and never cached."""

import sys
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba import njit

from robins.kalman import extension
from robins.kalman.extension import entry_point, implements, is_covered, kernel_of
from robins.kalman.model import LinearModel, propagate, propagate_linear


@pytest.fixture(autouse=True)
def fresh_registry(monkeypatch):
    """No loose end at the start of a test, none of its own at the end."""
    monkeypatch.setattr(extension, "_kernels", dict(extension._kernels))
    monkeypatch.setattr(extension, "_loose_ends", set())


@pytest.fixture
def move():
    """A small entry point of its own for each test."""

    @entry_point
    def move(model, x, u):
        propagate(model, x, u)

    return move


@pytest.fixture
def cart():
    """A model registered here, outside the package: position and velocity."""

    class Cart(NamedTuple):
        dt: float

    @implements(propagate, Cart)
    @njit
    def propagate_cart(model, x, u):
        x[0] += model.dt * x[1]
        x[1] += model.dt * u[0]

    return Cart(0.5)


LINEAR = LinearModel(np.array([[1.0, 0.5], [0.0, 1.0]]), np.array([[0.0], [0.5]]), np.zeros((2, 2)))


def moved(entry, model):
    x = np.array([1.0, 2.0])
    entry(model, x, np.array([3.0]))
    return x.tolist()


def cache_files():
    return {path for path in Path(numba.config.CACHE_DIR).rglob("*.nb?") if "move" in path.name}


def test_an_entry_point_with_kernels_of_the_package_is_cached(move):
    assert moved(move, LINEAR) == [2.0, 3.5]
    assert len(move.dispatcher.signatures) == 1
    assert any(path.suffix == ".nbi" for path in cache_files())


def test_a_model_from_outside_is_compiled_afresh_and_leaves_nothing_in_the_cache(move, cart):
    before = {path: path.stat().st_mtime_ns for path in cache_files()}
    assert moved(move, cart) == moved(move, LINEAR) == [2.0, 3.5]
    assert not move.dispatcher.signatures and not move.dispatcher.stats.cache_misses
    assert {path: path.stat().st_mtime_ns for path in cache_files()} == before


def test_a_model_may_come_after_the_first_call(move, cart):
    assert moved(move, LINEAR) == [2.0, 3.5]

    class Sled(NamedTuple):
        dt: float

    @implements(propagate, Sled)
    @njit
    def propagate_sled(model, x, u):
        x[0] -= model.dt

    assert moved(move, Sled(0.5)) == [0.5, 2.0]
    assert moved(move, cart) == [2.0, 3.5]


def test_a_second_kernel_for_a_type_is_refused(cart):
    with pytest.raises(ValueError, match="LinearModel has a kernel for propagate already"):
        implements(propagate, LinearModel)(propagate_linear)
    assert kernel_of("propagate", LINEAR) is propagate_linear


def test_covered_is_what_names_the_cache_folder():
    assert is_covered("robins.kalman.model")
    assert not is_covered("numpy")
    assert not is_covered(__name__)
    assert not is_covered("a module that nobody imported")
    assert not is_covered("sys") and "sys" in sys.modules  # built in: no file


def test_kernels_of_the_package_leave_no_loose_end_and_others_do(cart):
    extension.note_kernel(propagate_linear)
    assert len(extension._loose_ends) == 1 and "propagate_cart" in next(iter(extension._loose_ends))
    extension.note_kernel(propagate_linear, covered=False)
    assert len(extension._loose_ends) == 2
