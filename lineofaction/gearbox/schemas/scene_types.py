"""Types that the tables of a scene file share."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict

Name = Annotated[str, Field(min_length=1, max_length=64)]
Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Point = Annotated[tuple[Coordinate, ...], Strict(False), Field(min_length=3, max_length=3)]
Acceleration = Annotated[float, Field(ge=-1e6, le=1e6)]
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Times = Annotated[tuple[Annotated[float, Field(ge=0.0, le=1e9)], ...], Strict(False)]
Numbers = Annotated[tuple[Number, ...], Strict(False)]
Course = Literal["linear", "smooth"]
Stiffness = Annotated[float, Field(ge=-1e15, le=1e15)]
SeatRow = Annotated[tuple[Stiffness, ...], Strict(False), Field(min_length=5, max_length=6)]
SeatRows = Annotated[tuple[SeatRow, ...], Strict(False)]
HousingRow = Annotated[tuple[Stiffness, ...], Strict(False), Field(min_length=3, max_length=6000)]
HousingRows = Annotated[tuple[HousingRow, ...], Strict(False)]
CouplingRow = Annotated[tuple[Number, ...], Strict(False), Field(min_length=6, max_length=6)]
CouplingRows = Annotated[tuple[CouplingRow, ...], Strict(False)]
