"""Vibration of a housing of which frequency responses were measured, under the bearing forces of a scene."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bounds import engineering
from bounds.brief import brief
from bounds.types import BoolArray, FloatArray, Json
from dynamics.vibration import (
    Direction,
    MeasuredMobility,
    MeasuredVibration,
    bearing_shares,
    measured_vibration,
    vibration_level,
)
from dynamics.vibration.vibration_analysis import Shares
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.measured_housings import housing_mobility
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.excitations import order_names, with_scene_metadata
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.housings import bearing_forces
from lineofaction.gearbox.studies.vibration import Inputs, VibrationFigures
from lineofaction.gearbox.studies.vibration.figures import (
    Contributions,
    PointVelocity,
    contributions_of,
    root_mean_square,
)
from lineofaction.gearbox.units import RPM
from model_studies.record import under_key
from model_studies.result_record import ResultRecord

_NO_SHAPE = "Responses from seats to points hold no shapes of modes; a housing by its solid has them."


@brief
@dataclass(frozen=True)
class MeasuredHousingVibration(ResultRecord):
    """Vibration of a measured housing over speed, and through which bearings at one speed and order."""

    housing: str
    file: str
    """Name of the file of the responses."""
    lowest_frequency: float
    highest_frequency: float
    """`lowest_frequency`, `highest_frequency`: First and last line of the measurement, Hz."""
    response: tuple[Direction, ...]
    """Points and the axes of the file along which their motion was measured."""
    vibration: MeasuredVibration
    at_speed: int
    at_order: int
    """`at_speed`, `at_order`: Indices of the speed and the order of the shares."""
    bearing: tuple[str, ...]
    """e bearings at whose seats the measurement applied forces."""
    share: FloatArray
    """Share of each bearing, at this speed and order, in the mean square velocity of each point; NaN for a
    point at rest. Shape (e, k).
    """
    metadata: Json = field(default_factory=dict, metadata=under_key("facts"))
    """Metadata of the response as plain JSON."""

    @property
    def axes(self) -> dict[str, str]:
        """Return the measured axes of each point, as ``xz``."""
        return {
            name: "".join("xyz"[part.axis] for part in self.response if part.name == name)
            for name in self.vibration.point
        }

    @property
    def bearing_shares(self) -> Shares:
        """Return the shares of the bearings; there is no surface."""
        nothing = np.full(len(self.bearing), np.nan)
        return Shares(self.bearing, nothing, self.share.T, nothing)

    @property
    def omitted_forces(self) -> list[str]:
        """Return the names of the forces that no function carries."""
        return [str(part) for part in self.vibration.omitted]

    @property
    def omitted_part(self) -> FloatArray:
        """Return the part of the omitted forces in the sum of squared forces, by order, then by speed."""
        return self.vibration.omitted_force.T

    @property
    def omits_moments(self) -> bool:
        """Whether the bearings press moments on their seats."""
        return self.vibration.moments

    @property
    def orders_beyond(self) -> FloatArray:
        """Return the orders that leave the measured band at one speed or more."""
        return np.asarray(self.vibration.order[~np.all(self.vibration.covered, axis=0)])

    @property
    def left_out(self) -> list[str]:
        """Sentences on the parts that the responses replace, and on results that they cannot give."""
        vibration = self.vibration
        band = f"{engineering(self.lowest_frequency, 5)} to {engineering(self.highest_frequency, 5)} Hz"
        sentences = [
            f"{self.file} moves the points of {self.housing} in place of modes. The housing does not act "
            "back: the forces are those of the scene, with the stiffness that its bearings and other "
            "housings have.",
            "There are no modes, no surface, no deflection shape and no sound: the file holds functions "
            "from seats to points.",
        ]
        if outside := int(np.sum(~vibration.covered)):
            sentences.append(
                f"{outside} of {vibration.covered.size} pairs of speed and order lie outside the measured "
                f"band, {band}: they have no velocity and are not in the overall value."
            )
        sentences += [
            f"{name} was measured along {', '.join(axes)} of the file: its velocity holds no other direction."
            for name, axes in self.axes.items()
            if len(axes) < 3
        ]
        if vibration.omitted:
            maximum = engineering(100.0 * float(np.max(vibration.omitted_force)), 3)
            forces = ", ".join(self.omitted_forces)
            sentences.append(
                f"Forces without a measured function do not move the points: {forces}, up to {maximum} % of "
                "the sum of the squared forces."
            )
        if vibration.moments:
            sentences.append("The moments of the bearings on their seats do not move the points.")
        if vibration.floor:
            sentences.append("Orders of long tables that are not listed do not move the points.")
        return sentences


def chosen_measurement(subject: TabledScene, name: str | None) -> HousingInput | None:
    """Return the measured housing of a name; without a name the first, if no other has a surface or points.

    None: another kind of housing is looked at.
    """
    measured = [part for part in subject.inputs.housings if part.is_measured]
    if name is not None:
        return next((part for part in measured if part.name == name), None)
    modeled = any(body.surface is not None or body.points for body in subject.housings.values())
    return None if modeled or not measured else measured[0]


def measured_result(
    subject: TabledScene, housing: HousingInput, inputs: Inputs, means: Means
) -> MeasuredHousingVibration:
    """Return the vibration of a measured housing; effects are sized by the quantity of the scene.

    Raises `BadInput`: a mode is asked for, or nothing that is asked for lies inside the measured band.
    """
    if inputs.mode is not None:
        raise BadInput.of("mode", inputs.mode, "left out of a measured housing", _NO_SHAPE)
    assert housing.frf_file is not None  # the caller has chosen a measured one
    mobility = housing_mobility(housing)
    response = bearing_forces(subject, inputs, means)
    began = cpu_seconds()
    covered = mobility.covers(response.frequency)
    _require_band(covered, mobility, "run" if means.run is not None else "speed_rpm")
    with boundary_errors():
        vibration = measured_vibration(response, mobility)
        at_speed, at_order = _point_indices(vibration, mobility, inputs)
        shares = bearing_shares(response, mobility)[..., at_speed, at_order]
    metadata = response.metadata
    seconds = {**metadata["seconds"], "vibration": cpu_seconds() - began}
    result = MeasuredHousingVibration(
        housing=housing.name,
        file=housing.frf_file.name,
        lowest_frequency=float(mobility.frequency[0]),
        highest_frequency=float(mobility.frequency[-1]),
        response=mobility.response,
        vibration=vibration,
        at_speed=at_speed,
        at_order=at_order,
        bearing=mobility.bearings,
        share=shares,
        metadata={**metadata, "seconds": seconds},
    )
    return with_scene_metadata(result, subject)


def _require_band(covered: BoolArray, mobility: MeasuredMobility, field: str, value: object = None) -> None:
    """Refuse speeds or orders that lie outside the measured band as a whole; raises `BadInput`."""
    if np.any(covered):
        return
    low, high = (engineering(float(mobility.frequency[end]), 5) for end in (0, -1))
    bound = f"such that an order lies inside the measured band, {low} to {high} Hz"
    raise BadInput.of(field, value, bound, "Choose other speeds or more orders.")


def _point_indices(
    vibration: MeasuredVibration, mobility: MeasuredMobility, inputs: Inputs
) -> tuple[int, int]:
    """Return the indices of the speed and order to look at: the nearest, or where a point moves fastest."""
    candidates = np.ones(vibration.frequency.shape, dtype=bool)
    if inputs.at_rpm is not None:
        row = np.argmin(np.abs(vibration.speed - inputs.at_rpm * RPM))
        candidates &= (np.arange(vibration.speed.size) == row)[:, None]
        _require_band(candidates & vibration.covered, mobility, "at_rpm", inputs.at_rpm)
    if inputs.at_order is not None:
        candidates &= np.arange(vibration.order.size) == np.argmin(np.abs(vibration.order - inputs.at_order))
        _require_band(candidates & vibration.covered, mobility, "at_order", inputs.at_order)
    candidates &= vibration.covered
    size = np.where(candidates, vibration.rms.max(axis=0), -1.0)
    row, column = np.unravel_index(int(np.argmax(size)), size.shape)
    return int(row), int(column)


def measured_figures(result: MeasuredHousingVibration) -> Json:
    """Return the figures of a measured housing; None stands for values outside the measured band."""
    vibration, indices = result.vibration, (result.at_speed, result.at_order)
    return figures_of(
        VibrationFigures,
        result,
        vibration,
        result.metadata,
        order_name=order_names(vibration.order, result.metadata),
        natural_frequency=np.empty(0),
        highest_valid_frequency=result.highest_frequency,
        points={name: _point(vibration, k) for k, name in enumerate(vibration.point)},
        surface=None,
        contributions=Contributions(
            float(vibration.speed[indices[0]]),
            float(vibration.order[indices[1]]),
            float(vibration.frequency[indices]),
            bearings=contributions_of(result.bearing_shares, vibration.point),
            modes=[],
        ),
        measured=result,
    )


def _point(vibration: MeasuredVibration, point: int) -> PointVelocity:
    """Return the velocity of a point; NaN outside the measurement, in band and direction."""
    rms = vibration.rms[point]
    unlisted = np.full(vibration.speed.size, np.nan if vibration.floor else 0.0)
    level = np.where(vibration.covered, vibration_level(np.nan_to_num(rms)), np.nan)
    return PointVelocity(
        velocity=rms.T,
        velocity_xyz=np.swapaxes(root_mean_square(vibration.velocity[point]), 1, 2),
        overall=vibration.overall[point],
        left_out=unlisted,
        overall_error=unlisted,
        level=level.T,
    )
