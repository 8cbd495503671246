"""Judge the claims of a paper."""

from snakemake.script import snakemake

from robins.papers import steps

with steps.running(snakemake):
    steps.judge(steps.desk(snakemake))
