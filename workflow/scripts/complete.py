"""Say that everything has been run."""

from snakemake.script import snakemake

from robins.papers import steps

with steps.running(snakemake):
    steps.complete(steps.desks(snakemake))
