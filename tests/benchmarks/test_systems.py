"""The strapdown mechanisation that is timed: simulated with its own model, the same in every run, as large as it says."""

import numpy as np
import pytest

from benchmarks.reference import constants, definitions
from benchmarks.systems import strapdown_drive


@pytest.mark.parametrize(("augmented", "errors"), [(False, 15), (True, 21)])
def test_a_drive_has_one_number_more_in_the_state_than_in_its_error(augmented, errors):
    recorded = strapdown_drive(augmented, 20)
    assert recorded.P0.shape == (errors, errors) and recorded.x0.shape == (errors + 1,)
    assert recorded.truth.shape == (20, errors + 1) and recorded.measurements.shape == (20, 6)
    np.testing.assert_allclose(np.linalg.norm(recorded.truth[:, 6:10], axis=1), 1.0, rtol=1e-14)


def test_a_drive_is_the_same_in_every_run():
    np.testing.assert_array_equal(strapdown_drive(True, 20).measurements, strapdown_drive(True, 20).measurements)
    assert not np.array_equal(strapdown_drive(True, 20).measurements, strapdown_drive(True, 20, seed=2).measurements)


@pytest.mark.parametrize("augmented", [False, True])
def test_the_reference_is_compiled_for_the_system(augmented):
    recorded = strapdown_drive(augmented, 2)
    assert definitions(recorded)[1] == f"-DAUGMENTED={int(augmented)}"
    assert constants(recorded).size == 2 + 3 + 3 + 9 + recorded.P0.shape[0] + 6
