"""What a REXS file may measure, and the error of one that cannot be read."""

from __future__ import annotations

from lineofaction.gearbox.problems import BadInput

MOST_BYTES = 64_000_000
"""Of a file, and of an archive's files together."""
MOST_ENTRIES = 300_000
"""Elements of XML; values, lists and tables of JSON. More numbers fit in base64.
300 000 elements take 170 MB."""
MOST_FILES = 1_000
MOST_DEPTH = 32
MOST_RATIO = 200
"""Bytes of an archive's files by bytes of the archive; models compress 20 to 50 times."""


def refused(place: str, value: object, bound: str, suggestion: str = "") -> BadInput:
    """Return the error of one fault at a place of the file."""
    return BadInput.of(place, value, bound, suggestion)
