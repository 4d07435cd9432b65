"""Bodies of force queries: JSON, CBOR, or raw columns of float64."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import cbor2
import numpy as np
from pydantic import ValidationError
from pydantic_core import to_json

from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.force_query import (
    ForceAnswer,
    check_columns,
    points_of_columns,
    points_of_model,
)
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.faults import fault_of, innermost
from lineofaction.gearbox.schemas.query import QueryInput, validity_words
from service.routes.media_types import CBOR, JSON, RAW

_WORDS = [validity_words(flags) for flags in range(16)]
_FLOAT64_ARRAY = 86  # RFC 8746: little-endian float64, the one tag a query may have
_DEEPEST = 2
_EMPTY_LIST = b"\x80"  # also a byte of numbers, but hardly of every other one


def points_of_json(body: bytes, _columns: Sequence[str]) -> FloatArray:
    """Read a query in JSON; raises `BadInput`."""
    try:
        return points_of_model(QueryInput.model_validate_json(body))
    except ValidationError as error:
        _refuse(error, "valid JSON")


def points_of_cbor(body: bytes, _columns: Sequence[str]) -> FloatArray:
    """Read a query in CBOR, of the same shape as in JSON; lists may be typed arrays; raises `BadInput`."""
    try:
        if body.count(_EMPTY_LIST) > len(body) // 4 + 16:
            raise ValueError("lists of nothing, which cost more than numbers")
        query = cbor2.loads(
            body,
            tag_hook=_typed_array,
            semantic_decoders=_NO_TAGS,
            max_depth=_DEEPEST,
            allow_duplicate_keys=False,
        )
        return points_of_model(QueryInput.model_validate(query))
    except ValidationError as error:
        _refuse(error, "valid CBOR")
    except (cbor2.CBORError, ValueError, MemoryError, RecursionError, OverflowError):
        advice = "Send a map of the names of the JSON body to numbers, arrays and typed arrays (tag 86)."
        raise BadInput.of("body", f"{len(body)} bytes", "valid CBOR without other tags", advice) from None


def points_of_raw(body: bytes, columns: Sequence[str]) -> FloatArray:
    """Read columns of little-endian float64, one after the other; raises `BadInput`."""
    check_columns(columns)
    width = 8 * len(columns)
    if not body or len(body) % width:
        bound = (
            f"{len(columns)} columns of equal length of 8-byte numbers: a multiple of {width} bytes above 0"
        )
        raise BadInput.of("body", f"{len(body)} bytes", bound, "Check the parameter columns.")
    return points_of_columns(np.frombuffer(body, "<f8").reshape(len(columns), -1), columns)


def as_json(answer: ForceAnswer) -> bytes:
    """Write an answer in JSON: the shortest decimals that give the same float64."""
    return to_json(_plain(answer))


def as_cbor(answer: ForceAnswer) -> bytes:
    """Write an answer in CBOR, of the same shape as in JSON."""
    return cbor2.dumps(_plain(answer))


def as_raw(answer: ForceAnswer) -> bytes:
    """Write force, stiffness and validity (sum of flags) as columns of little-endian float64."""
    return np.array(answer, dtype="<f8").tobytes()


READ: dict[str, Callable[[bytes, Sequence[str]], FloatArray]] = {
    JSON: points_of_json,
    CBOR: points_of_cbor,
    RAW: points_of_raw,
}
WRITE: dict[str, Callable[[ForceAnswer], bytes]] = {JSON: as_json, CBOR: as_cbor, RAW: as_raw}


def _plain(answer: ForceAnswer) -> dict[str, Any]:
    """Return an answer as lists, validities in words."""
    return {
        "force_n": answer.force_n.tolist(),
        "stiffness_n_per_um": answer.stiffness_n_per_um.tolist(),
        "validity": [_WORDS[flags] for flags in answer.validity.tolist()],
    }


def _refuse(error: ValidationError, form: str) -> NoReturn:
    """Raise what a query's model refused, a fault by fault."""
    faults = []
    for item in innermost(error.errors(include_url=False)):
        if item["type"] == "json_invalid":
            raise BadInput.of("body", None, form, f"{item['ctx']['error']}.") from None
        within = item["loc"] or item["type"] == "refused"
        faults.append(fault_of(item, QueryInput, item["loc"] if within else ["body"]))
    raise BadInput(faults) from None


def _typed_array(tag: Any, _immutable: bool) -> list[float]:
    """Read the one tag that a query may have."""
    if tag.tag != _FLOAT64_ARRAY or not isinstance(tag.value, bytes):
        raise ValueError("a tag that a query does not have")
    values: list[float] = np.frombuffer(tag.value, "<f8").tolist()
    return values


def _no_tag(_value: Any, _immutable: bool) -> NoReturn:
    """Refuse dates, big numbers, patterns, references: what the library would build of tagged values."""
    raise ValueError("a tag that a query does not have")


_BUILT_IN = (0, 1, 2, 3, 4, 5, 25, 28, 29, 30, 35, 36, 37, 52, 54, 100, 256, 258, 260, 261, 1004, 43000)
_NO_TAGS = dict.fromkeys(_BUILT_IN, _no_tag)
