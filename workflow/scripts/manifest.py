"""Collect the records of all artefacts into the manifest."""

from robins.papers import steps

with steps.running(snakemake):
    steps.write_manifest(steps.desks(snakemake), snakemake.input.records)
