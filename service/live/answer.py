"""The answer to a question, made in one process and passed on by another, which does not read it.

An answer is a frame of one of five kinds. "answer": the body is the JSON for the caller; "problem": the body
is problem details. The others have no body. "defect": the log has the traceback; "memory": no memory was
left, and the process ends; "stopped": the caller does not want the answer any more.
"""

from __future__ import annotations

import importlib
import json
import traceback
from collections.abc import Callable
from typing import Any, TypeAlias

from pydantic_core import to_json

from host.children.frames import Frame
from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import ServiceError, last_part
from service.live.order import Json, LiveOrder, LiveWork

Note: TypeAlias = Callable[[], None]
Write: TypeAlias = Callable[[Json], bytes]
translated = on_demand("lineofaction.gearbox.convert.errors:translated")


def json_body(content: Json) -> bytes:
    """Return an answer as JSON, every number by the shortest decimals that give it.

    It is for small answers: a lack of memory ends the process. Raises `ValueError`: a number is not finite.
    """
    body: bytes = to_json(content, inf_nan_mode="constants")
    if any(word in body for word in (b"NaN", b"Infinity")):
        json.dumps(content, allow_nan=False)  # raises for a number, not for a text with the word
    return body


def json_body_or_memory_error(content: Json) -> bytes:
    """Return an answer as JSON, as `json_body` does, but raise `MemoryError` where memory is too small."""
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()


def answer_of(
    order: LiveOrder, *further: object, note: Note = traceback.print_exc, write: Write = json_body
) -> Frame:
    """Do the work of an order and return its answer; only errors meant for callers show their text.

    Parameters
    ----------
    order : LiveOrder
    *further : object
        Further arguments of the work after its inputs.
    note : callable
        Writes the exception being handled, a defect, into the log.
    write : callable
        Turns what the work returns into bytes.
    """
    try:
        module, _, name = order.entry.partition(":")
        work: LiveWork = getattr(importlib.import_module(module), name)
        return Frame("answer", write(work(order.inputs, *further)))
    except MemoryError:
        return Frame("memory")
    except Exception as error:  # noqa: BLE001 (a defect is logged by its traceback and reported by number)
        known = error if isinstance(error, ServiceError) else translated(error)
        if known is None:
            note()
            return Frame("defect")
        return problem(known)


def problem(error: ServiceError) -> Frame:
    """Return the answer that is an error."""
    return Frame.of_json("problem", error.as_json())


def propagated(answer: Frame) -> ServiceError:
    """Return the error in an answer that is a problem, as the process that found it reported it."""
    return _PropagatedError(answer.as_json())


class _PropagatedError(ServiceError):
    """A problem as another process found it."""

    def __init__(self, details: dict[str, Any]) -> None:
        self._details = details
        super().__init__(str(details["detail"]))

    @property
    def kind(self) -> str:
        return last_part(str(self._details["type"]))

    def as_json(self) -> dict[str, Any]:
        return self._details
