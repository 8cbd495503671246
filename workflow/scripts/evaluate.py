"""Judge the claims of a paper."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps

with steps.running(snakemake):
    steps.judge(steps.desk(snakemake))
