"""The description of the service as a generator of requests takes it."""

from __future__ import annotations

import copy
from typing import Any

Json = dict[str, Any]

STATUS = {"$ref": "#/components/schemas/StatusInfo"}


def generators_description(document: Json) -> Json:
    """Return a document with the type of its events, and without the conditions of gears.

    OpenAPI 3.2 can state the type of server-sent events, 3.1 cannot. The generator multiplies conditions out:
    a dozen, such as a relief that needs its length, are beyond it. A test of the rules themselves holds them.
    """
    taken = copy.deepcopy(document)
    stream = taken["paths"]["/v1/jobs/{job_id}/events"]["get"]["responses"]["200"]["content"]
    stream["text/event-stream"] = {"itemSchema": _event()}
    for gear in ("GearInput", "WheelInput"):
        del taken["components"]["schemas"][gear]["allOf"]
    return taken


def _event() -> Json:
    """Return the schema of an event that is named status and holds a status document."""
    status = {"contentMediaType": "application/json", "contentSchema": STATUS}
    fields: Json = {"event": {"const": "status"}, "data": {"type": "string", **status}}
    return {"type": "object", "properties": fields, "required": list(fields)}
