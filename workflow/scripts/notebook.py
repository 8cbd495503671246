"""Execute a notebook in the run's folder; it finds the results through the environment variables set here."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from pathlib import Path

from robins.papers import steps
from robins.publish import notebook

with steps.running(snakemake):
    desks = steps.desks(snakemake)
    layout = desks[0].layout
    source = layout.notebook_sources({at.paper.key: at.paper for at in desks})[snakemake.wildcards.name]
    environment = {"ROBINS_ENSEMBLE": layout.ensemble, "ROBINS_BUILD": layout.build, "ROBINS_RESULTS": layout.results}
    notebook.execute(source, Path(snakemake.output[0]), Path.cwd(), environment)
