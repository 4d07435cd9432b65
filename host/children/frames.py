"""Framed messages over a pipe between a child and its starter.

A frame is a line of JSON, its head, with a kind and a number of bytes, and then these bytes. Whoever passes
a body on need not read it.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, BinaryIO, Self

LONGEST_HEAD = 200
"""Bytes of a head, without the end of its line."""
Head = tuple[str, int]
"""Kind and length of the body."""


@dataclass(frozen=True)
class Frame:
    """One message."""

    kind: str
    body: bytes = b""

    @classmethod
    def of_json(cls, kind: str, content: Any) -> Self:
        """Return a frame whose body is plain JSON."""
        return cls(kind, json.dumps(content).encode())

    def as_json(self) -> Any:
        """Return what the body says as JSON."""
        return json.loads(self.body)

    @property
    def head(self) -> bytes:
        """The line before the body."""
        return json.dumps({"kind": self.kind, "length": len(self.body)}).encode() + b"\n"

    def write(self, stream: BinaryIO) -> None:
        """Send it now."""
        stream.write(self.head)
        stream.write(self.body)
        stream.flush()


def read_frame(stream: BinaryIO) -> Frame | None:
    """Wait for the next frame of a sender that is trusted; None: the stream ended before it or in it."""
    line = stream.readline()
    if not line.endswith(b"\n"):
        return None
    kind, length = _head(line)
    body = stream.read(length)
    return Frame(kind, body) if len(body) == length else None


class FrameBuffer:
    """Puts the pieces that come through a pipe together to frames; their sender may be led astray."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []
        self._missing = 0
        """Bytes that have to come before the next frame can be complete."""
        self.received = 0
        """Bytes so far."""
        self.broken = False
        """Whether what came is no frame; nothing behind it is one."""

    @property
    def partial(self) -> bool:
        """Whether the last frame is not complete."""
        return self.broken or any(self._pieces)

    def take(self, piece: bytes) -> list[Frame]:
        """Return the frames that are complete with another piece."""
        self.received += len(piece)
        self._pieces.append(piece)
        self._missing -= len(piece)
        if self.broken or self._missing > 0:
            return []
        content, start, frames = b"".join(self._pieces), 0, []
        while (head_end := self._head_end(content, start)) >= 0:
            try:
                kind, length = _head(content[start:head_end])
            except (ValueError, TypeError, KeyError):
                self.broken = True
                break
            end = head_end + 1 + length
            self._missing = end - len(content)
            if self._missing > 0:
                break
            frames.append(Frame(kind, content[head_end + 1 : end]))
            start = end
        self._pieces = [content[start:]] if start else [content]
        return frames

    def _head_end(self, content: bytes, start: int) -> int:
        """Return where the line of a head ends; -1: it has not come, or there is none."""
        end = content.find(b"\n", start, start + LONGEST_HEAD)
        if end < 0:
            self.broken = len(content) - start >= LONGEST_HEAD
            self._missing = 1
        return end


def _head(line: bytes) -> Head:
    """Return what a head says; ValueError, TypeError, KeyError: the line is none."""
    head = json.loads(line)
    kind, length = head["kind"], head["length"]
    if not isinstance(kind, str) or type(length) is not int or length < 0:
        raise ValueError("no head of a frame")
    return kind, length
