"""Run the noise diagnostics on a scenario's residuals."""

from snakemake.script import snakemake

from robins.papers import steps

with steps.running(snakemake):
    steps.diagnose(steps.desk(snakemake), snakemake.wildcards.job)
