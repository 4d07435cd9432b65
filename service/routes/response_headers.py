"""The headers of answers as the description has them: said once, referred to by their names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_TEXT, _ADDRESS = {"type": "string"}, {"type": "string", "format": "uri-reference"}

OF_ALL = ("X-Request-ID",)
"""Of every answer."""
OF_STATUS: Mapping[int, tuple[str, ...]] = {
    401: ("WWW-Authenticate",),
    403: ("WWW-Authenticate",),
    405: ("Allow",),
    415: ("Accept-Post",),
    429: ("Retry-After",),
    503: ("Retry-After",),
}
"""Of refusals, as HTTP has them (RFC 9110, RFC 6585; `Accept-Post`: W3C LDP, section 7.1)."""
OF_VERSIONS = ("ETag", "Cache-Control", "Vary")
"""Of what a caller may keep, also in the answer 304."""

HEADERS: dict[str, dict[str, Any]] = {
    name: {"description": text, "schema": schema}
    for name, text, schema in (
        ("X-Request-ID", "Identifier of the request, as the log has it", _TEXT),
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


def described_headers(*names: str) -> dict[str, Any]:
    """Return references to headers, for an answer in the description."""
    return {name: {"$ref": f"#/components/headers/{name}"} for name in names}
