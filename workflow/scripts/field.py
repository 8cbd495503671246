"""Publish the tables and figures of the laser-gyro recording, and the manifest that lists them."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from pathlib import Path

from robins.field import lasergyro, psins
from robins.foundation.randomness import stream
from robins.papers import steps
from robins.publish import manifest, style, tables

with steps.running(snakemake):
    recording, folder = snakemake.input[0], Path(snakemake.output[0]).parent
    generator = stream(snakemake.params.seed, "field/laser-gyro/0/diagnose")
    entries = {}
    for name, frame in lasergyro.tables(recording, generator).items():
        tables.write_csv(frame, folder / "laser-gyro" / f"{name}.csv")
        entries[f"laser-gyro/{name}.csv"] = manifest.entry("field", None, snakemake.params.source)
    for name, figure in lasergyro.figures(recording).items():
        style.save(figure, folder / "laser-gyro" / f"{name}.png")
        entries[f"laser-gyro/{name}.png"] = manifest.entry("field", None, snakemake.params.source)
    provenance = {"source": psins.SOURCE, "sha256": psins.SHA256, "licence": psins.LICENCE, "seed": snakemake.params.seed}
    for path in snakemake.output:
        manifest.write_record(path, {"recording": provenance, "artefacts": entries})
