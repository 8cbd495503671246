"""A generator for each test of this floor."""

import numpy as np
import pytest


@pytest.fixture
def rng():
    """A fresh generator, the same in every run."""
    return np.random.default_rng(20230)
