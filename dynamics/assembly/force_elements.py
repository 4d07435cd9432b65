"""All force elements of a model: flanks, loads, rotating frames, couplings, bearings."""

from __future__ import annotations

from dynamics.arrays.elements import Element
from dynamics.assembly.flank_elements import flank_elements
from dynamics.assembly.frame_couplings import frame_coupling_elements
from dynamics.assembly.housed_bearings import housed_bearing_elements, housed_bearings
from dynamics.assembly.load_elements import force_course_elements, unbalance_elements
from dynamics.assembly.model import Model
from dynamics.assembly.phases import repeating_phases
from dynamics.assembly.rotating_frame_elements import rotating_frame_elements
from dynamics.assembly.spatial_elements import spatial_elements
from dynamics.assembly.speed_elements import speed_elements
from dynamics.forces.element_laws import ElementLaws
from dynamics.mechanism.bearing_elements import bearing_elements, tilt_lever


def force_elements(model: Model) -> tuple[tuple[Element, ...], ElementLaws]:
    """Return the driving flanks of all meshes, everything else, bearings last, and their laws."""
    mechanism, flanks = model.mechanism, model.flanks
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    plain = flank_elements(scene, rotors, kinematics.mesh_sense, mechanism.lines, flanks)
    in_space, spatial = spatial_elements(model, plain)
    by_speed, speed = speed_elements(scene, rotors, kinematics)
    in_frames, rotating_frame = rotating_frame_elements(model)
    phase = len(scene.meshes) + len(repeating_phases(scene, kinematics))
    passing = [part.name for part in scene.rolling_bearings if part.name in mechanism.passing]
    on_bearings, bearing_laws = bearing_elements(
        scene.laws_with(mechanism.passing),
        rotors,
        mechanism.bearings,
        mechanism.bearing_duty,
        {name: phase + index for index, name in enumerate(passing)},
    )
    across, frame = frame_coupling_elements(scene, rotors, tilt_lever(scene))
    applied, course = force_course_elements(mechanism)
    eccentric, unbalance = unbalance_elements(mechanism)
    housed, linear_bearing = housed_bearing_elements(mechanism, housed_bearings(mechanism))
    laws = ElementLaws(
        flank=flanks.law,
        speed_torque=speed,
        spatial_flank=spatial,
        rotating_frame=rotating_frame,
        frame_coupling=frame,
        applied_force=course,
        unbalance=unbalance,
        linear_bearing=linear_bearing,
        **bearing_laws,
    )
    others = (*by_speed, *applied, *eccentric, *in_frames, *across, *housed)
    return (*in_space, *others, *on_bearings), laws
