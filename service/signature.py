"""Signatures of webhooks as of Standard Webhooks 1.0.0: HMAC SHA-256 over identifier, time and body."""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac

PREFIX = "whsec_"


def secret_bytes(secret: str) -> bytes:
    """Return the key of a written secret; raises ValueError unless it is 24 to 64 bytes in base64."""
    try:
        key = base64.b64decode(secret.removeprefix(PREFIX), validate=True)
    except binascii.Error:
        raise ValueError("secret") from None
    if not secret.startswith(PREFIX) or not 24 <= len(key) <= 64:
        raise ValueError("secret")
    return key


def signed_headers(key: bytes, identifier: str, timestamp: int, body: bytes) -> dict[str, str]:
    """Return the headers of a signed call; `timestamp` is in seconds since 1970."""
    content = b".".join((identifier.encode(), str(timestamp).encode(), body))
    digest = base64.b64encode(hmac.new(key, content, hashlib.sha256).digest()).decode()
    return {
        "webhook-id": identifier,
        "webhook-timestamp": str(timestamp),
        "webhook-signature": f"v1,{digest}",
    }
