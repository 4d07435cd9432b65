"""Comparisons with numbers of others: one file per case in `cases`, run by `loa validate`.

Adding a file adds a comparison; a file elsewhere is named by its path. What a file holds:
docs/measured-and-computed.md.
"""

from lineofaction.validation.case import CASES, ValidationCase, read_case
from lineofaction.validation.comparison import Comparison
from lineofaction.validation.run import Outcome, run_case
from lineofaction.validation.table import markdown

__all__ = ["CASES", "Comparison", "Outcome", "ValidationCase", "markdown", "read_case", "run_case"]
