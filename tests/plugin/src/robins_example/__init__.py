"""An example for contributors: the paper example2026 does not exist, its numbers are made up."""
