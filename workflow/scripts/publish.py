"""Publish the tables or the figures of a paper."""

from snakemake.script import snakemake

from robins.papers import steps

with steps.running(snakemake):
    {"tables": steps.write_tables, "figures": steps.write_figures}[snakemake.params.stage](steps.desk(snakemake))
