"""The report on a result: what `loa report` shows, as JSON."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field


class ReportBody(BaseModel):
    """A report: main results, and sections with figures and tables."""

    title: str
    lead: str
    alarms: list[str]
    headlines: list[dict[str, str]]
    sections: list[dict[str, Any]] = Field(
        description="title, text, figures (key, title, caption, alternative, plot, table), tables, folded"
    )
