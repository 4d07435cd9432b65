"""The name of a result: a hash of everything that decides it."""

from __future__ import annotations

import hashlib

import rfc8785

from fe_contact.errors import InputError
from fe_contact.types import Json


def content_hash(case: Json, solver_version: str, schema_version: int) -> str:
    """SHA-256, in hex, of the canonical JSON (RFC 8785) of the case with solver and schema version.

    Equal content gives equal hashes whatever the order of keys or the spelling of numbers (1, 1.0, 1e0).

    Raises
    ------
    InputError
        If the case is not JSON: a foreign type, NaN or infinity, or an integer beyond 2^53.
    """
    identity: Json = {"case": case, "solver_version": solver_version, "schema_version": schema_version}
    try:
        canonical = rfc8785.dumps(identity)
    except (rfc8785.CanonicalizationError, RecursionError) as error:
        raise InputError("case", type(case).__name__, f"plain JSON ({error})") from error
    return hashlib.sha256(canonical).hexdigest()
