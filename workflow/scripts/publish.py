"""Publish the tables or the figures of a paper."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps

with steps.running(snakemake):
    {"tables": steps.write_tables, "figures": steps.write_figures}[snakemake.params.stage](steps.desk(snakemake))
