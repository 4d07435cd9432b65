"""The base of all boundary models: strict, closed, finite, frozen."""

from __future__ import annotations

from typing import NoReturn

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError

from lineofaction.gearbox.schemas.few_faults import with_few_faults


class BoundaryModel(BaseModel):
    """A table of the case or scene file, or a JSON body: unknown fields and NaN are refused."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type[BaseModel], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Stop looking when enough is wrong."""
        return with_few_faults(handler(source))


def refuse(field: str, value: object, bound: str, suggestion: str = "") -> NoReturn:
    """Raise the fault of `field` (relative to the model) from a validator over several fields."""
    raise PydanticCustomError(
        "refused",
        "must be {bound}",
        {"field": field, "value": value, "bound": bound, "suggestion": suggestion},
    )
