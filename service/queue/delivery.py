"""In which form a caller wants the result of its job (OGC 18-062r2, clause 7.11.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Self

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import NETCDF

Response = Literal["raw", "document"]
Transmission = Literal["value", "reference"]


@dataclass(frozen=True)
class Delivery:
    """The form of a result.

    Attributes
    ----------
    response : str
        ``"raw"``: the result itself, or links in headers; ``"document"``: a JSON object by name of output.
    transmission : str
        ``"value"`` or ``"reference"``.
    """

    response: Response = "raw"
    transmission: Transmission = "value"

    @classmethod
    def of(cls, text: str) -> Self:
        """Return what `str` wrote."""
        response, _, transmission = text.partition(" ")
        return cls(response, transmission)  # type: ignore[arg-type]  # the table holds no others

    def __str__(self) -> str:
        return f"{self.response} {self.transmission}"


AS_IT_IS = Delivery()


def delivery(response: Response, transmission: Transmission | None, field: str) -> Delivery:
    """Return the form that was requested.

    Parameters
    ----------
    response, transmission
        As requested; a transmission that is left out is by value, but in a document by reference.
    field : str
        What the caller calls the transmission.

    Raises
    ------
    BadInput
        A result in a document by value: JSON does not hold netCDF.
    """
    if response == "document":
        if transmission == "value":
            bound = f"reference in a document: JSON does not hold {NETCDF}"
            raise BadInput.of(
                field, transmission, bound, 'Request the response "raw" to get the file itself.'
            )
        return Delivery(response, "reference")
    return Delivery(response, transmission or "value")
