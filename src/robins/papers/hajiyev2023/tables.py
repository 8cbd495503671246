"""The wing's tables: the paper's one, what the study adds to it, and where everything comes from."""

from robins.papers.hajiyev2023.questions import QUESTIONS
from robins.papers.hajiyev2023.tables_errors import ERROR_TABLES
from robins.papers.hajiyev2023.tables_register import REGISTER_TABLES
from robins.papers.hajiyev2023.tables_study import STUDY_TABLES
from robins.papers.protocol import Table

TABLES: tuple[Table, ...] = (*ERROR_TABLES, *QUESTIONS, *STUDY_TABLES, *REGISTER_TABLES)
"""Every table of the wing but the diagnostics, in the order of the report."""
