"""Say that everything has been run."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps

with steps.running(snakemake):
    steps.complete(steps.desks(snakemake))
