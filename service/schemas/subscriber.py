"""Who is told about a job (OGC 18-062r2, clause 7.11.4 and the class callback), and what came of it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.model import BoundaryModel

Uri = Annotated[str, Field(max_length=2000, examples=["https://hooks.example.com/loa?case=12"])]


class Subscriber(BoundaryModel):
    """Addresses that are called about a job; the service lists the origins that it calls."""

    successUri: Uri | None = Field(None, description="Gets the document of the results")  # noqa: N815
    failedUri: Uri | None = Field(None, description="Gets the problem of a job without result")  # noqa: N815
    inProgressUri: Uri | None = Field(None, description="Gets the status of a job that runs")  # noqa: N815

    @property
    def uris(self) -> dict[str, str]:
        """Addresses by event."""
        named = {"inProgress": self.inProgressUri, "success": self.successUri, "failed": self.failedUri}
        return {event: uri for event, uri in named.items() if uri is not None}


class WebhookState(BaseModel):
    """What came of a call about a job."""

    event: Literal["inProgress", "success", "failed"]
    state: Literal["waiting", "delivered", "skipped", "given up"]
    attempts: int = Field(ge=0)
    message: str = Field(description="Of the last attempt")
