"""A file inside a scene: its name, and its compressed content."""

from __future__ import annotations

import base64
import binascii
import zlib
from pathlib import Path
from typing import Self

from pydantic import Field

from lineofaction.gearbox.schemas.model import BoundaryModel

LARGEST = 64_000_000
"""Bytes of a file, or of all files of a request, unpacked."""
_LARGEST_TEXT = 24_000_000


class FileContentInput(BoundaryModel):
    """A file of the caller, written out: a service reads no files of its callers."""

    name: str = Field(
        min_length=1, max_length=255, description="Name of the file, with its ending", examples=["case.step"]
    )
    content: str = Field(
        min_length=1,
        max_length=_LARGEST_TEXT,
        description="Content of the file, compressed by zlib and written in Base64",
        examples=["eJwDAAAAAAE="],
    )

    @classmethod
    def of(cls, file: Path) -> Self:
        """Return the content of a file; raises OSError, and ValueError if it is too large."""
        if file.stat().st_size > LARGEST:
            raise ValueError(f"at most {LARGEST} bytes")
        return cls.packed(file.name, file.read_bytes())

    @classmethod
    def packed(cls, name: str, content: bytes) -> Self:
        """Return a file of a name that holds these bytes."""
        return cls(name=name, content=base64.b64encode(zlib.compress(content, 9)).decode("ascii"))

    def unpacked(self, maximum: int = LARGEST) -> bytes:
        """Return the bytes of the file; raises ValueError: damaged, or more than `maximum` bytes."""
        reader = zlib.decompressobj()
        try:
            data = reader.decompress(base64.b64decode(self.content, validate=True), maximum + 1)
        except (binascii.Error, zlib.error):
            raise ValueError("compressed by zlib and written in Base64") from None
        if len(data) > maximum or not reader.eof:
            raise ValueError(f"whole, and with all other files at most {LARGEST} bytes when unpacked")
        return data
