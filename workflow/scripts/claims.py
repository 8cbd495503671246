"""Merge the papers' judged claims into one ledger."""

from robins.papers import steps

with steps.running(snakemake):
    steps.merge_claims(steps.desks(snakemake))
