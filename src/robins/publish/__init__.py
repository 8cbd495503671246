"""From results to readers: figures, tables, the report, the manifest and the check that the code still makes them."""
