"""Framed messages over a pipe between a child and its starter.

A frame is a line of JSON, its head, with a kind and a number of bytes, and then these bytes. Whoever passes
a body on need not read it.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, BinaryIO, Self

LONGEST_HEAD = 200
"""Largest number of bytes of a head, without the end of its line."""
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
        """Return the body, read as JSON."""
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
    """Joins the pieces that come through a pipe to frames; their sender is not trusted."""

    def __init__(self) -> None:
        self._head: Head | None = None
        """Head of the frame whose body is awaited."""
        self._pieces: list[bytes] = []
        """Bytes behind that head, or behind the last frame."""
        self._waiting = 0
        """Number of these bytes."""
        self.received = 0
        """Number of all received bytes."""
        self.broken = False
        """Whether received bytes are no frame; no later byte is read as one."""

    @property
    def partial(self) -> bool:
        """Whether the last frame is not complete."""
        return self.broken or self._head is not None or self._waiting > 0

    def take(self, piece: bytes) -> list[Frame]:
        """Return the frames that are complete with another piece."""
        self.received += len(piece)
        frames: list[Frame] = []
        if not self.broken:
            self._pieces.append(piece)
            self._waiting += len(piece)
            while (frame := self._complete()) is not None:
                frames.append(frame)
        return frames

    def _complete(self) -> Frame | None:
        """Take the next frame from the pieces, if it is complete."""
        if self._head is None and not self._take_head():
            return None
        assert self._head is not None
        kind, length = self._head
        if self._waiting < length:
            return None
        content = b"".join(self._pieces)
        body = content if len(content) == length else content[:length]
        self._leave(content[length:])
        self._head = None
        return Frame(kind, body)

    def _take_head(self) -> bool:
        """Take the head of the next frame from the pieces; return whether it is there."""
        content = b"".join(self._pieces)
        end = content.find(b"\n", 0, LONGEST_HEAD)
        if end < 0:
            self._leave(content)
            self.broken = len(content) >= LONGEST_HEAD
            return False
        try:
            self._head = _head(content[:end])
        except (ValueError, TypeError, KeyError):
            self.broken = True
            return False
        self._leave(content[end + 1 :])
        return True

    def _leave(self, content: bytes) -> None:
        """Keep bytes that belong to the next frame."""
        self._pieces, self._waiting = [content] if content else [], len(content)


def _head(line: bytes) -> Head:
    """Return kind and length of a head; ValueError, TypeError, KeyError: the line is no head."""
    head = json.loads(line)
    kind, length = head["kind"], head["length"]
    if not isinstance(kind, str) or type(length) is not int or length < 0:
        raise ValueError("no head of a frame")
    return kind, length
