"""Collect the records of all artefacts into the manifest."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps

with steps.running(snakemake):
    steps.write_manifest(steps.desks(snakemake), snakemake.input)
