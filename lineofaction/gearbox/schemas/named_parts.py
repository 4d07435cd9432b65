"""Parts of answers that are passed on as they are, and the schemas by which the description knows them."""

from __future__ import annotations

from typing import Any

from pydantic import GetJsonSchemaHandler
from pydantic_core import CoreSchema

from lineofaction.gearbox.schemas.model import _NAMED, Json


class Named:
    """Annotation of a JSON object that is passed on as it is: the description has its schema by name.

    Parameters
    ----------
    schema : str
        Name of a schema of requests, such as ``Case``, or of a model that `service.routes.openapi` adds.
    """

    def __init__(self, schema: str) -> None:
        self._schema = schema

    def __get_pydantic_json_schema__(self, _schema: CoreSchema, _handler: GetJsonSchemaHandler) -> Json:
        """Return the name of the schema, for `with_named`."""
        return {_NAMED: self._schema}


def with_named(part: Any) -> Any:
    """Return a part of the description with references in place of names."""
    if isinstance(part, list):
        return [with_named(entry) for entry in part]
    if not isinstance(part, dict):
        return part
    if _NAMED in part:
        return {"$ref": f"#/components/schemas/{part[_NAMED]}"} | {
            key: value for key, value in part.items() if key != _NAMED
        }
    return {key: with_named(value) for key, value in part.items()}
