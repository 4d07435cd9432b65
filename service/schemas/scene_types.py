"""Types that the tables of a scene file share."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict

Name = Annotated[str, Field(min_length=1, max_length=64)]
Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Times = Annotated[tuple[Annotated[float, Field(ge=0.0, le=1e9)], ...], Strict(False)]
Numbers = Annotated[tuple[Number, ...], Strict(False)]
Course = Literal["linear", "smooth"]
Row = Annotated[tuple[Number, ...], Strict(False)]
Stiffness = Annotated[float, Field(ge=-1e15, le=1e15)]
MatrixRow = Annotated[tuple[Stiffness, ...], Strict(False)]
MatrixRows = Annotated[tuple[MatrixRow, ...], Strict(False)]
Rows = Annotated[tuple[Row, ...], Strict(False)]
