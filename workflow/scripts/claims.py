"""Merge the papers' judged claims into one ledger."""

# ruff: noqa: F821
# Snakemake puts the object `snakemake` into the script.

from robins.papers import steps

with steps.running(snakemake):
    steps.merge_claims(steps.desks(snakemake))
