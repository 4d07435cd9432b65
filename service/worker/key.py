"""Names of results: the hash of what decides them."""

from __future__ import annotations

import hashlib
from typing import Any

import rfc8785

from service.version import solver_version


def content_key(process: str, process_version: str, inputs: dict[str, Any]) -> str:
    """Return the SHA-256 of the RFC 8785 form of the normalized inputs and the versions, hexadecimal."""
    facts: dict[str, Any] = {
        "process": process,
        "process_version": process_version,
        "solver_version": solver_version(),
        "inputs": inputs,
    }
    return hashlib.sha256(rfc8785.dumps(facts)).hexdigest()
