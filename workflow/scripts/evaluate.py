"""Judge the claims of a paper."""

from robins.papers import steps

with steps.running(snakemake):
    steps.judge(steps.desk(snakemake))
