"""Merge the papers' judged claims into one ledger."""

from snakemake.script import snakemake

from robins.papers import steps

with steps.running(snakemake):
    steps.merge_claims(steps.desks(snakemake))
