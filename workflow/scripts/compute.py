"""Compute one job of a paper: a scenario, a variant or a study."""

from snakemake.script import snakemake

from robins.papers import steps

with steps.running(snakemake):
    steps.compute(steps.desk(snakemake), snakemake.wildcards.job)
