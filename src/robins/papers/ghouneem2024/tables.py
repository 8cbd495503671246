"""The wing's tables: the paper's three, what the study adds to them, and where everything comes from."""

from robins.papers.ghouneem2024.tables_factorial import FACTORIAL_TABLES
from robins.papers.ghouneem2024.tables_gate import GATE_TABLES
from robins.papers.ghouneem2024.tables_published import PUBLISHED_TABLES
from robins.papers.ghouneem2024.tables_register import REGISTER_TABLES
from robins.papers.ghouneem2024.tables_studies import STUDY_TABLES
from robins.papers.ghouneem2024.tables_tuning import TUNING_TABLES
from robins.papers.protocol import Table

TABLES: tuple[Table, ...] = (
    *PUBLISHED_TABLES, *FACTORIAL_TABLES, *GATE_TABLES, *TUNING_TABLES, *STUDY_TABLES, *REGISTER_TABLES,
)  # fmt: skip
"""Every table of the wing but the diagnostics, in the order of the report."""
