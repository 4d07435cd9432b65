"""The description with the type of server-sent events, which OpenAPI 3.2 can state and 3.1 cannot."""

from __future__ import annotations

import copy
from typing import Any

STATUS = {"$ref": "#/components/schemas/StatusInfo"}


def with_typed_events(document: dict[str, Any]) -> dict[str, Any]:
    """Return a document that says that each event is named status and holds a status document."""
    found = copy.deepcopy(document)
    stream = found["paths"]["/v1/jobs/{job_id}/events"]["get"]["responses"]["200"]["content"]
    status = {"contentMediaType": "application/json", "contentSchema": STATUS}
    fields = {"event": {"const": "status"}, "data": {"type": "string", **status}}
    event = {"type": "object", "properties": fields, "required": list(fields)}
    stream["text/event-stream"] = {"itemSchema": event}
    return found
