"""Ranges of guessed figures of a scene, and whether the sound is computed over them."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.studied import RANGES, Factors


def _range(low: float, high: float, text: str) -> Factors:
    described = f"{text}: lowest and highest factor on what the scene states"
    field: Factors = Field(
        default=(low, high), min_length=2, max_length=2, description=described, examples=[[low, high]]
    )
    return field


class NoiseRanges(BoundaryModel):
    """Whether levels have bands and sensitivities, and the ranges that the bands are over."""

    band: bool = Field(
        default=True,
        description="Whether levels have a band in dB over the ranges below: some 40 responses",
        examples=[False],
    )
    sensitivities: bool = Field(
        default=False,
        description="Whether to find what 1 dB costs: in damping and stiffness, three responses each, and in "
        "tip relief and crowning of meshes with a case, whose contact is solved again three times each, and "
        "heard by the transfer functions of the scene",
        examples=[True],
    )
    housing_damping: Factors | None = Field(
        default=None,
        min_length=2,
        max_length=2,
        description="Damping of the housings: lowest and highest factor on what the scene states; left out: "
        "0.4, 2 of the usual one, a guess; 0.7, 1.4 where the scene states another; 0.85, 1.2 where it has "
        "measured modal_damping",
        examples=[[0.4, 2.0]],
    )
    housing_frequency: Factors = _range(0.97, 1.01, "Natural frequencies of the housings (mesh, walls)")
    mount_stiffness: Factors = _range(0.5, 2.0, "Stiffness and damping of the mounts at the feet")
    bearing_stiffness: Factors = _range(0.7, 1.4, "Stiffness of the bearings, but of rows by their geometry")
    mesh_damping: Factors = _range(0.5, 2.0, "Damping of the meshes")

    @model_validator(mode="after")
    def _about_one(self) -> Self:
        """Refuse ranges of factors that do not contain 1, the value of the scene."""
        for name in RANGES:
            low, high = getattr(self, name) or (1.0, 1.0)
            if not low <= 1.0 <= high:
                remedy = "1 is what the scene states; 1, 1 varies nothing."
                refuse(name, [low, high], "two factors, the first at most 1, the second at least 1", remedy)
        return self
