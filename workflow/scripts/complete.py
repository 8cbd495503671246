"""Say that everything has been run."""

from robins.papers import steps

with steps.running(snakemake):
    steps.complete(steps.desks(snakemake))
