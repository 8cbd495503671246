"""The wing's tables: the paper's five, what the study adds to them, and where everything comes from."""

from robins.papers.imani2026.tables_errors import ERROR_TABLES
from robins.papers.imani2026.tables_register import REGISTER_TABLES
from robins.papers.imani2026.tables_study import STUDY_TABLES
from robins.papers.imani2026.tables_words import WORD_TABLES
from robins.papers.protocol import Table

TABLES: tuple[Table, ...] = (*WORD_TABLES, *ERROR_TABLES, *STUDY_TABLES, *REGISTER_TABLES)
"""Every table of the wing but the diagnostics, in the order of the report."""
