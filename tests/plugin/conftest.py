"""The example is a distribution of its own. Its tests need it installed; tests/test_contributing.py does that and runs them."""

collect_ignore = ["tests"]
