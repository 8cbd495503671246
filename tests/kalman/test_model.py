"""The linear model and sensor, inside and outside compiled code."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import njit
from numba.core.errors import TypingError

from robins.kalman.model import linear_sensor, linearise, linearise_observation, observe, propagate


class Nothing(NamedTuple):
    """A model that nobody wrote kernels for."""

    a: float


@njit
def everything(model, sensor, x, u, F, Q, z, H):
    observe(sensor, x, u, z)
    linearise_observation(sensor, x, u, H)
    linearise(model, x, u, F, Q)
    propagate(model, x, u)


def in_python(model, sensor, x, u, F, Q, z, H):
    observe(sensor, x, u, z)
    linearise_observation(sensor, x, u, H)
    linearise(model, x, u, F, Q)
    propagate(model, x, u)


@pytest.mark.parametrize("call", [everything, in_python], ids=["compiled", "in python"])
def test_a_linear_system_is_its_matrices(problem, call):
    case = problem(3)
    x, u = case.x0[0].copy(), case.controls[0]
    F, Q, z, H = (np.full(shape, np.nan) for shape in ((4, 4), (4, 4), 3, (3, 4)))
    call(case.model, case.sensor, x, u, F, Q, z, H)
    np.testing.assert_allclose(z, case.sensor.H @ case.x0[0] + case.sensor.D @ u, rtol=1e-14)
    np.testing.assert_allclose(x, case.model.A @ case.x0[0] + case.model.B @ u, rtol=1e-13, atol=1e-14)
    for matrix, expected in ((F, case.model.A), (Q, case.model.Q), (H, case.sensor.H)):
        np.testing.assert_array_equal(matrix, expected)


def test_a_sensor_has_zeros_where_nothing_is_given_and_contiguous_arrays():
    sensor = linear_sensor(np.ones((4, 2), dtype=int).T, np.eye(2), inputs=3)
    shapes = {"H": (2, 4), "D": (2, 3), "R": (2, 2), "R_fixed": (2, 2), "C_update": (4, 2), "C_predict": (4, 2)}
    for name, shape in shapes.items():
        array = getattr(sensor, name)
        assert array.shape == shape and array.dtype == float and array.flags.c_contiguous
        assert name in ("H", "R") or not array.any()


@pytest.mark.parametrize("generic", [propagate, linearise, observe, linearise_observation])
def test_a_model_without_a_kernel_is_told_how_to_get_one(generic):
    arguments = {propagate: 2, linearise: 4, observe: 3, linearise_observation: 3}[generic]
    message = rf"Nothing has no kernel for {generic.__name__}; register one with implements\(\)"
    with pytest.raises(TypingError, match=message):
        generic(Nothing(1.0), *[np.zeros(1)] * arguments)


def test_a_missing_kernel_is_told_by_the_compiler_too():
    @njit
    def compiled(model, x):
        propagate(model, x, x)

    with pytest.raises(TypingError, match="Nothing has no kernel for propagate"):
        compiled(Nothing(1.0), np.zeros(1))
