"""Run the noise diagnostics on a scenario's residuals."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps

with steps.running(snakemake):
    steps.diagnose(steps.desk(snakemake), snakemake.wildcards.job)
