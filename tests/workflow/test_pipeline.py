"""What each file is made from, what a change makes stale, and needs that nothing can satisfy."""

import re
from dataclasses import replace

import pandas as pd
import pytest

from robins.foundation.errors import InputError
from robins.papers import all_papers, pipeline
from robins.papers.protocol import Claim, Figure, Job, Output, Paper, Settings, Table

from .conftest import PLUGIN, ROOT

LAYOUT = pipeline.Layout(ROOT, "smoke")


def compute(settings):
    """Stands where a computation would."""
    return Output(pd.DataFrame())


def job(name, *needs, **definition):
    return Job(name, name, compute, (), definition, needs=needs)


def paper(**parts):
    """A chain: road - (its diagnostics) - grid - tuned; plain stands alone."""
    empty = dict.fromkeys(("tables", "figures", "claims", "equations", "assumptions"), ())
    chain = {
        "scenarios": (job("road"),),
        "variants": (job("plain"), job("tuned", "grid")),
        "studies": (job("grid", "road", "diagnose/road", width=3),),
    }
    return Paper("toy", "", "", "", "", **(empty | chain | parts))


def sources(wing):
    return pipeline.Sources(wing, Settings("smoke", 1, {}), PLUGIN / "toy.csv")


def stale(before, after):
    """Names of the results that are not what they were."""
    names = [*before.jobs, "diagnose/road"]
    return {name for name in names if sources(before).result(name) != sources(after).result(name)}


def refusal(wing):
    with pytest.raises(InputError) as refused:
        pipeline.check_needs(wing)
    return str(refused.value)


def test_the_files_that_a_job_needs_are_those_of_its_needs():
    wing = paper()
    build = "build/smoke/toy"
    assert LAYOUT.inputs(wing, [wing.jobs["plain"]]) == []
    assert LAYOUT.inputs(wing, [wing.jobs["tuned"]]) == [f"{build}/estimate/grid.parquet", f"{build}/estimate/grid.npz"]
    road = [f"{build}/simulate/road.parquet", f"{build}/simulate/road.npz", f"{build}/diagnose/road.parquet"]
    assert LAYOUT.inputs(wing, [wing.jobs["grid"]]) == road


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"studies": (job("grid", "road", "diagnose/road", width=4),)}, {"grid", "tuned"}),
        ({"scenarios": (job("road", length=2),)}, {"road", "diagnose/road", "grid", "tuned"}),
        ({"variants": (job("plain", window=9), job("tuned", "grid"))}, {"plain"}),
        ({"variants": (job("plain"), job("tuned"))}, {"tuned"}),
    ],
    ids=["tuning", "scenario", "stands alone", "a need less"],
)
def test_a_change_makes_a_job_stale_and_exactly_what_needs_it(changed, expected):
    assert stale(paper(), paper(**changed)) == expected


def test_what_needs_a_stale_job_is_a_stale_product():
    figure = Figure("figure-01", "", "", compute, ("tuned",), ())
    plain = replace(figure, needs=("plain",))
    before, after = sources(paper()), sources(paper(studies=(job("grid", "road", "diagnose/road", width=4),)))
    assert before.product(figure) != after.product(figure)
    assert before.product(plain) == after.product(plain)


def test_needs_that_can_be_made_in_some_order_are_accepted():
    table = Table("table-1", "", "", (), compute, ("tuned", "diagnose/road", "claims"), ())
    pipeline.check_needs(paper(tables=(table,), claims=(Claim("C1", "", compute, ("plain",), ()),)))


@pytest.mark.parametrize("wing", all_papers().values(), ids=lambda wing: wing.key)
def test_the_needs_of_every_wing_can_be_made(wing):
    pipeline.check_needs(wing)


def test_a_need_that_nobody_makes_is_refused():
    known = "expected one of diagnose/road, grid, plain, road, tuned"
    variants = (job("plain"), job("tuned", "gird"))
    assert refusal(paper(variants=variants)) == f"paper toy: needs of tuned: found 'gird', {known}"
    claim = Claim("C1", "", compute, ("claims",), ())
    assert refusal(paper(claims=(claim,))) == f"paper toy: needs of C1: found 'claims', {known}"
    assert refusal(paper(variants=(job("plain"), job("tuned", "claims")))) == f"paper toy: needs of tuned: found 'claims', {known}"


@pytest.mark.parametrize(
    ("parts", "names"),
    [
        ({"variants": (job("tuned", "tuned"),)}, ["tuned"]),
        ({"variants": (job("c", "b"),), "studies": (job("a", "c"), job("b", "a"))}, ["a", "b", "c"]),
        ({"scenarios": (job("road", "diagnose/road"),), "variants": (), "studies": ()}, ["diagnose/road", "road"]),
    ],
)
def test_jobs_that_need_each_other_are_refused(parts, names):
    before, circle, after = re.split(r"\((.+)\)", refusal(paper(**parts)))
    assert (before, after) == ("paper toy: needs: found a circle ", ", expected jobs that can be made one after the other")
    *once, last = circle.split(", ")  # each is needed by the next
    assert once[0] == last
    first = once.index(names[0])
    assert once[first:] + once[:first] == names
