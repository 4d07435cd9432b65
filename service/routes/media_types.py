"""The representation that a caller accepts and sends (RFC 9110, sections 8.3 and 12.5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

JSON, CBOR, RAW = "application/json", "application/cbor", "application/octet-stream"
WAV = "audio/wav"
PROBLEM = "application/problem+json"
OPENAPI = "application/vnd.oai.openapi+json;version=3.1"


def media_type(header: str) -> str:
    """Return the type of a Content-Type header without its parameters."""
    return header.partition(";")[0].strip().lower()


@lru_cache(maxsize=256)
def negotiated(accept: str, offered: Sequence[str]) -> str | None:
    """Return the offered type that an Accept header prefers, None if it takes none of them.

    Of types wanted equally the one the header names first is taken, then the one offered first.
    """
    ranges = [_range(part) for part in accept.split(",") if part.strip()]
    if not ranges:
        return offered[0]
    ranked = [(*_wanted(ranges, kind), -rank, kind) for rank, kind in enumerate(offered)]
    quality, *_, best = max(ranked)
    return best if quality > 0.0 else None


def _range(part: str) -> tuple[str, float]:
    """Return a media range with its weight; a weight that is no number counts as 1."""
    kind, *parameters = (piece.strip().lower() for piece in part.split(";"))
    weight = next((p[2:] for p in parameters if p.startswith("q=")), "1")
    try:
        return kind, min(max(float(weight), 0.0), 1.0)
    except ValueError:
        return kind, 1.0


def _wanted(ranges: Sequence[tuple[str, float]], kind: str) -> tuple[float, int]:
    """Return the weight of a type by the most specific range that names it, and its place from the end."""
    for name in (kind, f"{kind.partition('/')[0]}/*", "*/*"):
        for rank, (named, weight) in enumerate(ranges):
            if named == name:
                return weight, -rank
    return 0.0, 0
