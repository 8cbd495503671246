"""Collect the records of all artefacts into the manifest."""

from snakemake.script import snakemake

from robins.papers import steps

with steps.running(snakemake):
    steps.write_manifest(steps.desks(snakemake), snakemake.input)
