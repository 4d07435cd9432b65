"""The report on a result: what `loa report` shows, as JSON."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.named import Named


class ReportTable(BaseModel):
    """A table, its cells as they are read."""

    caption: str
    head: list[str]
    rows: list[list[str]]


class ReportPlot(BaseModel):
    """What ``Plotly.newPlot`` takes."""

    data: list[dict[str, Any]] = Field(description="Traces of plotly.js")
    layout: dict[str, Any] = Field(description="Layout of plotly.js")


class ReportTrack(BaseModel):
    """A sound of a plot."""

    name: str
    query: dict[str, str] = Field(description="Query of /v1/results/{hash}/sound")
    time: list[float] = Field(description="s from its start")
    along: list[float] = Field(description="Where it then is on the horizontal axis")


class ReportSound(BaseModel):
    """What a plot shows, to listen to."""

    caption: str
    tracks: list[ReportTrack]


class ReportFigure(BaseModel):
    """A plot, with what stands in for it where it cannot be seen."""

    key: str
    title: str
    caption: str
    alternative: str = Field(description="The plot in words")
    plot: ReportPlot
    table: ReportTable | None = Field(description="Its numbers; null: none")
    sound: ReportSound | None = Field(None, description="The plot to listen to; null: it has no sound")


class ReportSection(BaseModel):
    """A part with its figures and tables."""

    title: str
    part: Literal["results", "effects", "accuracy", "input", "receipt"] = Field(
        description="Results, or how they were made"
    )
    text: str
    figures: list[ReportFigure]
    tables: list[ReportTable]
    folded: list[ReportTable] = Field(description="Tables that are shown on request")


class ReportBody(BaseModel):
    """A report: main results, and sections with figures and tables."""

    title: str
    lead: str
    alarms: list[str]
    headlines: list[dict[str, str]]
    sections: list[Annotated[dict[str, Any], Named("ReportSection")]]
