"""Write the report from the results."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps
from robins.publish import report

with steps.running(snakemake):
    desks = steps.desks(snakemake)
    layout = desks[0].layout
    report.write(snakemake.output[0], {at.paper.key: at.paper for at in desks}, layout.results, layout.ensemble)
