"""Write the tables of declared fields in docs/case-file.md from the declarations.

Usage: case_file_page.py PAGE
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from fe_contact.flank.modification import FlankModification
from service.schemas.declared import Figure, figures

DECLARED = {kind.__name__: kind for kind in (FlankModification,)}
TABLE = re.compile(r"(<!-- fields of (\w+) -->\n).*?(<!-- end of fields -->)", re.DOTALL)
HEAD = "| field | meaning | accepted | default |\n|---|---|---|---|\n"


def page(text: str) -> str:
    """Return the page with its tables anew."""
    return TABLE.sub(lambda found: f"{found[1]}{table(DECLARED[found[2]])}{found[3]}", text)


def table(kind: type) -> str:
    """Return the table of the declared fields of a dataclass."""
    return HEAD + "".join(f"{row(figure)}\n" for figure in figures(kind))


def row(figure: Figure) -> str:
    """Return the row of a field."""
    cells = (
        f"`{figure.field}`",
        figure.what.description,
        accepted(figure),
        written(figure.own(figure.default)),
    )
    return f"| {' | '.join(cells)} |"


def accepted(figure: Figure) -> str:
    """Say what is accepted."""
    low, high = figure.limits.get("ge"), figure.limits.get("le")
    if low is None or high is None:
        return ", ".join(f'`"{name}"`' for name in figure.what.bound.names)
    return f"{low:.7g} to {high:.7g}"


def written(default: object) -> str:
    """Write a default as a case file has it."""
    return f"{default:.7g}" if isinstance(default, float) else f'`"{default}"`'


if __name__ == "__main__":
    file = Path(sys.argv[1])
    file.write_text(page(file.read_text("utf-8")), "utf-8")
