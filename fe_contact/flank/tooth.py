"""The properties that a modification reads of the gear whose flanks it changes."""

from __future__ import annotations

from typing import Protocol


class Tooth(Protocol):
    """Sizes of a gear's teeth, lengths in m and angles in rad; `fe_contact.geometry` has the gears."""

    @property
    def sign(self) -> int:
        """-1 for a ring gear, else 1."""

    @property
    def normal_module(self) -> float:
        """Normal module m_n."""

    @property
    def face_width(self) -> float:
        """Face width b."""

    @property
    def base_radius(self) -> float:
        """Base radius r_b."""

    @property
    def base_helix_angle(self) -> float:
        """Helix angle at the base circle, beta_b; > 0: right hand."""

    @property
    def base_thickness_half_angle(self) -> float:
        """Half the angle of a tooth at the base circle."""

    @property
    def form_radius(self) -> float:
        """d_Ff / 2: where involute and fillet meet."""

    @property
    def form_roll_length(self) -> float:
        """Roll length at the form radius."""

    @property
    def tip_radius(self) -> float:
        """d_a / 2."""

    @property
    def tip_roll_length(self) -> float:
        """Roll length at the tip radius."""

    def roll_length(self, radius: float) -> float:
        """Roll length at a radius from the base radius on."""
