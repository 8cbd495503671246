"""From per-run errors to verdicts.

`metrics` turns error histories into one number a run, `intervals` puts an interval around what an
ensemble says, `consistency` asks whether a filter's covariance is honest, `published` reads what a paper
prints, `verdicts` holds the closed list of verdict words and the rules that choose between them, `ledger`
builds and validates the claim table, and `storage` keeps jobs' outputs on disk. Nothing here knows a
paper by name.
"""
