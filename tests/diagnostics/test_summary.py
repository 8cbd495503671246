"""The one table of all diagnostics: its shape, its caveats and its refusals."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from robins.diagnostics import summary


def test_every_channel_has_every_test_in_the_documented_columns(rng):
    table = summary.diagnose("residuals", rng.standard_normal((300, 2)), 10.0, stats.norm(), generator=rng, channels=["u", "q"])
    assert tuple(table.columns) == summary.COLUMNS
    assert not table.duplicated(["series", "channel", "test"]).any()
    tests = table.groupby("channel", sort=False).test.apply(list)
    assert list(tests.index) == ["u", "q"]
    assert tests["u"] == tests["q"]
    assert tests["u"][:8] == [
        "shapiro-wilk",
        "kolmogorov-smirnov",
        "lilliefors",
        "jarque-bera",
        "skewness",
        "excess kurtosis",
        "autocorrelation lag 1",
        "ljung-box",
    ]
    assert table.statistic.notna().all()


def test_known_law_adds_its_test_and_its_absence_leaves_it_out(rng):
    table = summary.diagnose("noise", rng.standard_normal(100), 1.0, generator=rng)
    assert "kolmogorov-smirnov" not in set(table.test)
    assert set(table.channel) == {"0"}


def test_each_channel_can_have_a_law_of_its_own(rng):
    samples = np.column_stack([rng.standard_normal(3000), rng.laplace(size=3000)])
    table = summary.diagnose("noise", samples, 1.0, [stats.norm(), stats.laplace()], generator=rng).set_index(["channel", "test"])
    assert (table.xs("kolmogorov-smirnov", level="test").p_value > 1e-4).all()
    swapped = summary.diagnose("noise", samples, 1.0, [stats.laplace(), stats.norm()], generator=rng).set_index(["channel", "test"])
    assert (swapped.xs("kolmogorov-smirnov", level="test").p_value < 1e-4).all()


def test_p_values_of_a_series_with_memory_carry_a_warning(rng):
    noise = rng.standard_normal(501)
    note = summary.diagnose("walk", noise[1:] + 0.8 * noise[:-1], 1.0, generator=rng).set_index("test").note
    assert "autocorrelated" in note["shapiro-wilk"]
    assert "autocorrelated" not in note["skewness"]


def test_a_quantised_series_says_how_many_values_it_has(rng):
    note = summary.diagnose("counts", np.round(rng.standard_normal(500)), 1.0, generator=rng).set_index("test").note
    assert "quantised to" in note["lilliefors"]


def test_same_generator_state_gives_the_same_table():
    samples = np.random.default_rng(0).standard_normal((6000, 1))
    first, again = (summary.diagnose("noise", samples, 1.0, generator=np.random.default_rng(3)) for _ in range(2))
    pd.testing.assert_frame_equal(first, again, check_exact=True)


def test_a_bad_channel_is_named(rng):
    samples = np.column_stack([rng.standard_normal(50), np.full(50, 2.0)])
    with pytest.raises(ValueError, match="residuals, channel q: all 50 samples equal 2"):
        summary.diagnose("residuals", samples, 1.0, generator=rng, channels=["u", "q"])


def test_blanked_has_empty_text_where_a_test_has_no_number(rng):
    table = summary.diagnose("noise", rng.standard_normal(100), 1.0, generator=rng)
    blanked = summary.blanked(table).set_index("test")
    assert blanked.loc["skewness", "p_value"] == ""
    assert blanked.loc["shapiro-wilk", "p_value"] == table.set_index("test").loc["shapiro-wilk", "p_value"]
    assert not blanked.isna().any().any()
    assert blanked.statistic.dtype == float
