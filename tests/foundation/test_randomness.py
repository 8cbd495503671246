"""Named streams: what their numbers depend on, and that the configuration has no two alike."""

import inspect
from itertools import product

import numpy as np
import pytest
import yaml

from robins.foundation.randomness import standard_normals, stream
from robins.papers.hajiyev2023 import studies
from robins.papers.hajiyev2023.ensemble import STREAM
from robins.papers.hajiyev2023.scenario import KEY, draw, stream_names


def first(seed, name):
    """The first word of a stream: equal words mean equal streams for all that matters (64 bits)."""
    return int(stream(seed, name).bit_generator.random_raw())


def test_a_stream_depends_on_its_name_and_the_seed_and_on_nothing_else():
    names = [f"paper/scenario/{run}/sensor" for run in range(5)]
    forwards = {name: stream(7, name).standard_normal(4) for name in names}
    np.random.seed(0)
    backwards = {name: stream(7, name).standard_normal(4) for name in reversed(names)}
    for name in names:
        np.testing.assert_array_equal(forwards[name], backwards[name])


def test_another_name_or_another_seed_gives_another_stream():
    words = [first(seed, name) for seed in (0, 1, 2**40) for name in ("a/b/1/w", "a/b/2/w", "a/b/1/v", "a/c/1/w", "b/b/1/w", "a/b/1/w ")]
    assert len(set(words)) == len(words)


def test_a_negative_seed_is_refused():
    with pytest.raises(ValueError, match="non-negative"):
        stream(-1, "a/b/1/w")


def test_rows_of_normals_are_the_streams_of_their_names():
    names = ["a/b/1/w", "a/b/0/v"]
    draws = standard_normals(3, names, (2, 5))
    for row, name in zip(draws, names, strict=True):
        np.testing.assert_array_equal(row, stream(3, name).standard_normal((2, 5)))


def test_streams_are_standard_normal_and_uncorrelated():
    """Means, variances and correlations of 40 streams of 10 000 numbers, within five standard errors."""
    draws = standard_normals(1, [f"a/b/{run}/w" for run in range(40)], (10_000,))
    np.testing.assert_allclose(draws.mean(axis=1), 0.0, atol=5 / 100)
    np.testing.assert_allclose(draws.var(axis=1), 1.0, atol=5 * np.sqrt(2) / 100)
    np.testing.assert_allclose(np.corrcoef(draws) - np.eye(40), 0.0, atol=5 / 100)


@pytest.fixture(scope="module")
def configured(repository):
    """The configuration's seed and every stream name of the wing at `standard`."""
    config = yaml.safe_load((repository / "config" / "config.yaml").read_text())
    sizes = config["sizes"][KEY]["standard"]
    sets = sizes["specification_sets"]
    counts = {STREAM: max(sizes["runs"], sizes["sweep_runs"]), "specification": sets * sizes["specification_runs"]}
    names = [name for scenario, count in counts.items() for run in range(count) for name in stream_names(scenario, run)]
    names += [f"{KEY}/specification-parameters/{index}/multipliers" for index in range(sets)]
    names += [f"{KEY}/bootstrap/{n}/{what}" for n, what in product(range(sets), ("ratio", "difference", "median"))]
    names += [f"{KEY}/{STREAM}/0/diagnose-{series}" for series in ("process-noise", "measurement-noise", "differenced-noise")]
    return config["seed"], names


def test_no_two_streams_of_the_configuration_are_equal(configured):
    seed, names = configured
    assert len(names) > 50_000
    assert len(set(names)) == len(names)
    assert len({first(seed, name) for name in names}) == len(names)


def test_the_wing_reads_the_streams_that_the_test_above_names():
    draws = draw(1, STREAM, range(3, 4), 10)
    for name, array in zip(stream_names(STREAM, 3), draws, strict=True):
        np.testing.assert_array_equal(array[0], stream(1, name).standard_normal(array[0].shape))
    source = inspect.getsource(studies)
    assert 'draw(settings.seed, "specification", runs' in source and "/specification-parameters/{index}/multipliers" in source
