"""Limits of a body before it is read: the cost of reading depends on its parts, not on its bytes."""

from __future__ import annotations

from lineofaction.gearbox.problems import TooLarge
from service.routes.media_types import CBOR, RAW, media_type

_MOST = {b"{": (5_000, "tables"), b"[": (50_000, "lists"), b":": (50_000, "fields"), b"=": (50_000, "fields")}
"""Largest number of what each sign begins, in JSON or in the TOML that it carries.

A scene of a wind turbine has some hundred tables, two free-form flanks have a thousand lists, a reduced
housing six thousand. Numbers are not counted: a flank may have 250 000.
"""


class Extent:
    """The parts of one body, counted as its pieces come; of binary bodies nothing is counted."""

    def __init__(self, content_type: str) -> None:
        self._found = {} if media_type(content_type) in (CBOR, RAW) else dict.fromkeys(_MOST, 0)

    def add(self, piece: bytes) -> None:
        """Count the parts of a piece; raises `TooLarge`."""
        for sign in self._found:
            self._found[sign] += piece.count(sign)
            most, parts = _MOST[sign]
            if self._found[sign] > most:
                text = f"The body has more than {most} {parts}, the limit of this service. Send less at once."
                raise TooLarge(text)
