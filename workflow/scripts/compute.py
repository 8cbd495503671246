"""Compute one job of a paper: a scenario, a variant or a study."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps

with steps.running(snakemake):
    steps.compute(steps.desk(snakemake), snakemake.wildcards.job)
