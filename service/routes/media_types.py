"""Representations of answers: media types, caching, headers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from starlette.datastructures import MutableHeaders
from starlette.types import Message, Send

from service.access.quotas import LIMIT, POLICY

JSON, CBOR, RAW = "application/json", "application/cbor", "application/octet-stream"
WAV = "audio/wav"
HTML = "text/html"
EVENT_STREAM = "text/event-stream"
PROBLEM = "application/problem+json"
OPENAPI = "application/vnd.oai.openapi+json;version=3.1"
NO_STORE = "no-store"
_REVALIDATED = "private, no-cache"
_TEXT, _ADDRESS = {"type": "string"}, {"type": "string", "format": "uri-reference"}
OF_ALL = ("X-Request-ID", POLICY, LIMIT)
"""Headers of every answer; `POLICY` and `LIMIT` only for callers whose key has shares (quotas)."""
OF_STATUS: Mapping[int, tuple[str, ...]] = {
    401: ("WWW-Authenticate",),
    403: ("WWW-Authenticate",),
    405: ("Allow",),
    415: ("Accept-Post",),
    429: ("Retry-After",),
    503: ("Retry-After",),
}
"""Headers of refusals by status, as HTTP has them (RFC 9110, RFC 6585; `Accept-Post`: W3C LDP, section 7.1).
"""
OF_VERSIONS = ("ETag", "Cache-Control", "Vary")
"""Headers of answers that a caller may store, also in the answer 304."""
HEADERS: dict[str, dict[str, Any]] = {
    name: {"description": text, "schema": schema}
    for name, text, schema in (
        ("X-Request-ID", "Identifier of the request, as the log has it", _TEXT),
        (
            POLICY,
            "Shares of the key: quota q, its unit qu, window w in s (draft-ietf-httpapi-ratelimit-headers)",
            _TEXT,
        ),
        (LIMIT, "What the key has left of its shares: r, and t, s until all is there again", _TEXT),
        (
            "WWW-Authenticate",
            "Bearer: send the access key in the header Authorization; the scope that it lacks",
            _TEXT,
        ),
        ("Allow", "Methods of the path", _TEXT),
        ("Accept-Post", "Types of body that are read", _TEXT),
        ("Retry-After", "Seconds after which to try again; left out: not by itself", {"type": "integer"}),
        ("Location", "Address of the job", _ADDRESS),
        ("Preference-Applied", "respond-async, where Prefer requests that", _TEXT),
        ("ETag", "Version of the answer; send it in If-None-Match", _TEXT),
        ("Cache-Control", "How long who may keep the answer", _TEXT),
        ("Vary", "Headers of the request on which the answer depends", _TEXT),
        ("Content-Digest", "SHA-256 of the body (RFC 9530)", _TEXT),
        ("Content-Location", "Address of the result", _ADDRESS),
        ("Result-Kind", "Kind of the result", _TEXT),
        ("Link", "Address of the result, its type and the name of the output as title (RFC 8288)", _TEXT),
    )
}


def media_type(header: str) -> str:
    """Return the type of a Content-Type header without its parameters."""
    return header.partition(";")[0].strip().lower()


@lru_cache(maxsize=256)
def negotiated(accept: str, offered: Sequence[str]) -> str | None:
    """Return the offered type that an Accept header prefers, None if it takes none of them.

    Of types of the same weight the one that the header names first is returned; of types by one range of the
    header, such as ``*/*``, the one offered first.
    """
    ranges = [_range(part) for part in accept.split(",") if part.strip()]
    if not ranges:
        return offered[0]
    # (weight, order in the header, order of offer, type): both orders count down, so the first is largest
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
    """Return the weight of a type by the most specific range that has it, and minus the range's index."""
    for name in (kind, f"{kind.partition('/')[0]}/*", "*/*"):
        for rank, (named, weight) in enumerate(ranges):
            if named == name:
                return weight, -rank
    return 0.0, 0


def for_one_caller(send: Send) -> Send:
    """Return `send` for answers that depend on the caller's key: no shared cache stores them.

    The caller's own cache may store them, but must ask the service before each use, so that a revoked key
    opens nothing. RFC 9111, sections 3.5, 5.2.2.4 and 5.2.2.7.
    """

    async def confidential(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(raw=message.setdefault("headers", []))
            if NO_STORE not in headers.get("cache-control", ""):
                headers["cache-control"] = _REVALIDATED
            headers.add_vary_header("Authorization")
        await send(message)

    return confidential


def described_headers(*names: str) -> dict[str, Any]:
    """Return references to headers, for an answer in the description."""
    return {name: {"$ref": f"#/components/headers/{name}"} for name in names}


def answer(description: str, *headers: str, **further: Any) -> dict[str, Any]:
    """Return a route's declaration of an answer; `further`: its ``model`` or its ``content``."""
    return {"description": description, **further, "headers": described_headers(*headers)}
