# The front door: `snakemake --cores 2` computes, judges and publishes every paper of the registry.
#
# Everything is made from the registry (robins.papers) and config/config.yaml; no rule names a paper. Inputs are
# checked here, before anything is written. What each rule's result depends on is its parameter `source`, a hash of
# code, definitions, settings and files of the repository (robins.papers.pipeline): a comment reruns nothing, nor does a
# time stamp, which says nothing after a clone.

import os
import sys
from pathlib import Path

# Before NumPy is loaded, here and in every job: more threads would change the last bits and gain nothing at these sizes.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

from robins.evaluate.published import read_published
from robins.field import psins
from robins.foundation.errors import InputError
from robins.papers import all_papers, configuration, pipeline
from robins.publish.report import fingerprint
from robins.publish.sourcehash import source_hash

ROOT = Path(workflow.basedir)
CONFIG_FILE = ROOT / "config" / "config.yaml"

try:
    CONFIGURATION = configuration.load(
        CONFIG_FILE, workflow.config_settings.config, workflow.config_settings.configfiles
    )
    PAPERS = {key: all_papers()[key] for key in CONFIGURATION.papers}
    LAYOUT = pipeline.Layout(ROOT, CONFIGURATION.ensemble)
    SETTINGS = {key: configuration.settings_for(paper, CONFIGURATION) for key, paper in PAPERS.items()}
    for key, paper in PAPERS.items():
        pipeline.check_needs(paper)
        if paper.validate:
            paper.validate(SETTINGS[key])
        read_published(LAYOUT.published_numbers(paper))
    RECORDING = psins.locate(CONFIGURATION.recordings) if CONFIGURATION.recordings else None
except InputError as error:
    print(f"robins: {error}", file=sys.stderr)
    sys.exit(1)

if not RECORDING and workflow.is_main_process:  # said once, not again in every job of a cluster
    print(
        f"robins: no recordings, so {LAYOUT.results}/field/ stays as it is. To run this part, save {psins.SOURCE} "
        f"(sha256 {psins.SHA256}) as <folder>/{psins.FOLDER}/{psins.NAME} and say --config recordings=<folder>.",
        file=sys.stderr,
    )

SOURCES = {
    key: pipeline.Sources(paper, SETTINGS[key], LAYOUT.published_numbers(paper)) for key, paper in PAPERS.items()
}
# What readers see. Every output among these is an `update`: Snakemake deletes other outputs before a job starts, whereas
# these stay as they were when a job fails or is interrupted.
CLAIMS, MANIFEST, REPORT = (f"{LAYOUT.results}/{name}" for name in ("claims.csv", "manifest.json", "report.html"))
PRODUCTS = [LAYOUT.products(paper, stage) for paper in PAPERS.values() for stage in ("tables", "figures")]
RECORDS = [LAYOUT.record(stage, key) for key in PAPERS for stage in ("tables", "figures")]
NOTEBOOKS = LAYOUT.notebook_sources(PAPERS)
NOTEBOOK_TARGETS = [f"{LAYOUT.notebooks}/{name}.ipynb" for name in NOTEBOOKS]


configfile: str(CONFIG_FILE)


config.clear()  # the jobs get what has been checked, numbers as numbers
config.update(CONFIGURATION.values)


wildcard_constraints:
    paper="[a-z][a-z0-9]*",
    job="[a-z0-9-]+",


localrules:
    all,
    check,


include: "workflow/rules/simulate.smk"
include: "workflow/rules/diagnose.smk"
include: "workflow/rules/estimate.smk"
include: "workflow/rules/evaluate.smk"
include: "workflow/rules/field.smk"
include: "workflow/rules/publish.smk"
include: "workflow/rules/check.smk"


# It has to stand in this very file, and it asks for complete.json because results/ is versioned: in a fresh clone the
# results are there already, and only the intermediates behind that file make the science run.
rule all:
    default_target: True
    input:
        PRODUCTS,
        CLAIMS,
        MANIFEST,
        REPORT,
        NOTEBOOK_TARGETS,
        FIELD_TARGETS,
        rules.complete.output,
