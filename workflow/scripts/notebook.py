"""Execute a notebook in the run's folder; it finds the results through the environment variables set here."""

from pathlib import Path

from robins.papers import steps
from robins.publish import notebook

with steps.running(snakemake):
    layout = steps.desks(snakemake)[0].layout
    environment = {"ROBINS_ENSEMBLE": layout.ensemble, "ROBINS_BUILD": layout.build, "ROBINS_RESULTS": layout.results}
    notebook.execute(Path(snakemake.input.source), Path(snakemake.output[0]), Path.cwd(), environment)
