"""Laws of external and internal pairs: kinematics, path of contact, backlash, forces (ISO 21771-1).

One set of formulas serves both kinds: the wheel's `sign`, which is the sign of its tooth number in the
standard, multiplies its base radius.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike

from bounds import LIMIT_SLACK, Declared, Kind, declared, described, up_to
from fe_contact.geometry.backlash import base_circle_backlash, working_pressure_angle
from fe_contact.geometry.path_of_contact import PathOfContact
from fe_contact.geometry.printed_data import backlash_rounding
from fe_contact.types import FloatArray

if TYPE_CHECKING:
    from fe_contact.geometry.gear import Gear
    from fe_contact.geometry.toothing import Toothing
    from fe_contact.shaft import Shafts


_DISTANCE = Declared(Kind.LENGTH, "m", up_to(1000.0), "Center distance a", 0.08)


@described
@dataclass(frozen=True)
class ParallelAxes:
    """Two gears on parallel axes; use `GearPair` or `InternalGearPair`. Gear 1 (`pinion`) drives gear 2.

    Without a `center_distance`, it is the one at which the gears would mesh without backlash if they had no
    thickness allowances: the allowances then make the backlash. `axial_offset`: distance in m of the wheel's
    mid-face from the pinion's, along the pinion's axis. `shafts`: shafts of pinion and wheel, each between
    two bearings; None: a rigid one.
    """

    pinion: Gear
    wheel: Toothing
    center_distance: float = declared(None, _DISTANCE)
    axial_offset: float = 0.0
    shafts: Shafts = (None, None)

    def at_center_distance(self, center_distance: float) -> Self:
        """Return the same gears at another distance in m; raises `InputError`: they do not mesh there."""
        return replace(self, center_distance=center_distance)

    # Kinematics

    @property
    def internal(self) -> bool:
        """Whether the wheel is a ring gear: both gears then turn the same way."""
        return self.wheel.sign < 0

    @cached_property
    def working_pressure_angle(self) -> float:
        """Transverse working pressure angle alpha_wt, rad."""
        return working_pressure_angle(self.pinion, self.wheel, self.center_distance)

    @property
    def base_helix_angle(self) -> float:
        """beta_b of the pinion, rad; > 0 is right hand. An external wheel's is the negative."""
        return self.pinion.base_helix_angle

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch p_bt, m."""
        return self.pinion.base_pitch

    @property
    def speed_ratio(self) -> float:
        """Transmission ratio i = omega_1 / omega_2 = z_2 / z_1, as a magnitude."""
        return self.wheel.teeth / self.pinion.teeth

    @property
    def operating_pitch_radii(self) -> tuple[float, float]:
        """d_w1 / 2 and d_w2 / 2, m: their sum, or difference of an internal pair, is the center distance."""
        cosine = math.cos(self.working_pressure_angle)
        return self.pinion.base_radius / cosine, self.wheel.base_radius / cosine

    @property
    def common_face(self) -> tuple[float, float]:
        """Ends of the common face, as distances from the pinion's mid-face, m."""
        half_1, half_2 = 0.5 * self.pinion.face_width, 0.5 * self.wheel.face_width
        return max(-half_1, self.axial_offset - half_2), min(half_1, self.axial_offset + half_2)

    @property
    def face_width(self) -> float:
        """Common face width, m."""
        low, high = self.common_face
        return high - low

    @property
    def common_face_center(self) -> float:
        """Middle of the common face, as a distance from the pinion's mid-face, m."""
        return 0.5 * sum(self.common_face)

    # Path of contact

    @cached_property
    def common_tangent(self) -> float:
        """Length a sin(alpha_wt) of the base circles' common tangent, m.

        It is the sum of both roll lengths of an external pair, l_2 less l_1 of an internal one.
        """
        return self.center_distance * math.sin(self.working_pressure_angle)

    @cached_property
    def path_of_contact(self) -> PathOfContact:
        """The points A to E of sharp tip edges as roll lengths on gear 1, m."""
        start = self.wheel.sign * (self.common_tangent - self.wheel.tip_roll_length)
        pitch_point = self.pinion.base_radius * math.tan(self.working_pressure_angle)
        return PathOfContact(start, pitch_point, self.pinion.tip_roll_length, self.base_pitch)

    @cached_property
    def active_path(self) -> PathOfContact:
        """A to E between the tip form circles: shorter where tips are rounded or chamfered."""
        start = self.wheel.sign * (self.common_tangent - self.wheel.tip_form_roll_length)
        pitch_point = self.path_of_contact.pitch_point
        return PathOfContact(start, pitch_point, self.pinion.tip_form_roll_length, self.base_pitch)

    @property
    def active_contact_ratio(self) -> float:
        """epsilon_alpha of the usable flanks, which end at the tip form circles."""
        return self.active_path.length / self.base_pitch

    @property
    def transverse_contact_ratio(self) -> float:
        """epsilon_alpha between the tip circles."""
        return self.path_of_contact.length / self.base_pitch

    @property
    def overlap_ratio(self) -> float:
        """epsilon_beta, from the common face width."""
        axial = self.face_width * math.sin(abs(self.pinion.helix_angle))
        return axial / (math.pi * self.pinion.normal_module)

    @property
    def total_contact_ratio(self) -> float:
        """epsilon_gamma = epsilon_alpha + epsilon_beta."""
        return self.transverse_contact_ratio + self.overlap_ratio

    def tilt_arm(self, roll_1: FloatArray | float, face: FloatArray | float) -> FloatArray:
        """Return the gap on the line of action by a tilt of the axes in the plane of action, m per rad.

        The axis of the tilt goes through the pitch point in the pinion's mid-face. `roll_1` are roll lengths
        of gear 1 on the line of action and `face` face positions, m. The gap is the face position less
        tan(beta_b) times the distance from the pitch point; it is also the arm of a force there about the
        axis.
        """
        distance = roll_1 - self.path_of_contact.pitch_point
        return np.asarray(face - math.tan(self.base_helix_angle) * distance)

    def roll_lengths(self, position: ArrayLike, pair_index: ArrayLike = 0) -> tuple[FloatArray, FloatArray]:
        """Roll lengths at which tooth pair `pair_index` touches on the line of action.

        Parameters
        ----------
        position : array_like
            Phase of the driving gear in transverse base pitches; 0 = pair 0 touches at the pitch point.
        pair_index : array_like of int, optional
            +1 is one pitch ahead, nearer to gear 1's tip; broadcast against `position`.

        Returns
        -------
        tuple of arrays
            l_1 and l_2 in m. Their sum (of an internal pair, their difference) is `common_tangent`. They are
            not limited to the path of contact.
        """
        phase = np.asarray(position, dtype=float) + np.asarray(pair_index)
        first = np.asarray(self.path_of_contact.pitch_point + phase * self.base_pitch, dtype=float)
        return first, self.mating_roll_length(first)

    def mating_roll_length(self, roll_length: ArrayLike) -> FloatArray:
        """Roll length l_2 in m of the wheel where the line of action has `roll_length` l_1 of the pinion."""
        first = np.asarray(roll_length, dtype=float)
        return np.asarray(self.common_tangent - self.wheel.sign * first, dtype=float)

    def position(self, roll_length: ArrayLike) -> FloatArray:
        """Position (not wrapped) at which pair 0 touches at `roll_length` of gear 1."""
        rolled = np.asarray(roll_length, dtype=float) - self.path_of_contact.pitch_point
        return np.asarray(rolled / self.base_pitch, dtype=float)

    def relative_curvature(self, roll_length: ArrayLike) -> FloatArray:
        """Transverse 1/l_1 + 1/l_2 in 1/m at `roll_length` of gear 1; 1/l_1 - 1/l_2 in a hollow ring."""
        first = np.asarray(roll_length, dtype=float)
        second = self.mating_roll_length(first)
        return np.asarray(1.0 / first + self.wheel.sign / second, dtype=float)

    # Clearance and backlash

    @property
    def tip_clearances(self) -> tuple[float, float]:
        """Distances in m from tip to root: of the pinion's tip and the wheel's root, then the reverse."""
        pinion, wheel, a = self.pinion, self.wheel, self.center_distance
        # distances of the wheel's circles from the pinion's axis, on the line between the axes
        root, tip = (wheel.sign * (a - radius) for radius in (wheel.root_radius, wheel.tip_radius))
        return root - pinion.tip_radius, tip - pinion.root_radius

    @property
    def transverse_base_backlash(self) -> float:
        """Backlash along the transverse line of action j_bt, m: r_b1 times gear 1's free turn.

        Data of a printed table may make gears jam by their rounding alone. Such gears have no backlash, or
        only that of their thickness allowances.
        """
        computed = base_circle_backlash(self.pinion, self.wheel, self.working_pressure_angle)
        return computed + self.rounding_jam

    @cached_property
    def rounding_jam(self) -> float:
        """Jam along the line of action by the rounding of printed data, m, >= 0 (`backlash_rounding`).

        First the gears are taken without their thickness allowances, since those are no part of the nominal
        geometry; where these do not jam, the gears as they are. 0 where the teeth do not jam, or jam by more
        than rounding can explain.
        """
        computed = base_circle_backlash(self.pinion, self.wheel, self.working_pressure_angle)
        largest = backlash_rounding(self.pinion, self.wheel, self.center_distance)
        largest += LIMIT_SLACK * self.center_distance
        allowances = self.pinion.thickness_allowance + self.wheel.thickness_allowance
        by_allowances = allowances * math.cos(self.pinion.transverse_pressure_angle)
        by_allowances /= math.cos(self.pinion.helix_angle)
        jams = (by_allowances - computed, -computed)
        return next((jam for jam in jams if 0.0 < jam <= largest), 0.0)

    @property
    def normal_backlash(self) -> float:
        """j_bn, m: the shortest distance between the rear flanks, j_bt cos(beta_b)."""
        return self.transverse_base_backlash * math.cos(self.base_helix_angle)

    @property
    def circumferential_backlash(self) -> float:
        """j_wt at the operating pitch circles (arc), m."""
        return self.transverse_base_backlash / math.cos(self.working_pressure_angle)

    # Forces

    def normal_force(self, torque: ArrayLike) -> FloatArray:
        """Total normal tooth force F_bn in N of `torque` in N m on gear 1."""
        arm = self.pinion.base_radius * math.cos(self.base_helix_angle)
        return np.asarray(np.asarray(torque, dtype=float) / arm, dtype=float)

    def torque(self, normal_force: ArrayLike) -> FloatArray:
        """Torque on gear 1 in N m of the total normal tooth force F_bn in N."""
        arm = self.pinion.base_radius * math.cos(self.base_helix_angle)
        return np.asarray(np.asarray(normal_force, dtype=float) * arm, dtype=float)

    def transverse_force(self, normal_force: ArrayLike) -> FloatArray:
        """F_bt in N: the normal force's part in the transverse plane, along the line of action."""
        cosine = math.cos(self.base_helix_angle)
        return np.asarray(np.asarray(normal_force, dtype=float) * cosine, dtype=float)

    def axial_force(self, normal_force: ArrayLike) -> FloatArray:
        """F_bx in N (magnitude): the normal force's part along the axes."""
        sine = abs(math.sin(self.base_helix_angle))
        return np.asarray(np.asarray(normal_force, dtype=float) * sine, dtype=float)
