"""Outline of the right half of one tooth with the ring of the body below it (of a ring gear: outside it).

The coordinate s runs along the flank, m: from the middle of the tooth space (`s_space`) over the end of the
root circle (`s_root`) and the form point (`s_form`) to the tip edge (`s_tip`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import ToothProfile
from fe_contact.mesh.curve_division import divide, middles, spread
from fe_contact.mesh.outline import Outline, Piece, arc, piece, radial_line
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.types import FloatArray

LARGEST_ARC = math.radians(12.0)
"""Largest arc of one quadratic edge, rad: the edge leaves its circle by less than 1e-5 of the radius."""
COARSE = 201
"""Points at which the element size is sampled inside the material, where it changes slowly."""
SNAP = 0.25
"""A piece shorter than this part of an element is joined to its neighbor."""
THINNEST = 0.01
"""Least thickness of a rim that limits the element size, in normal modules. A thinner rim counts as this."""


@dataclass(frozen=True)
class ToothOutline:
    """Right half of the sector of one tooth.

    Pieces: ``bottom`` (from the center line to the side), ``side`` (to the root), ``land`` (root circle) and
    ``fillet`` where they exist, ``flank`` (from the margin below the form point), ``tip``, ``center``;
    counter-clockwise, of a ring gear, whose bottom is outside, clockwise.
    """

    outline: Outline
    s: FloatArray
    """Flank coordinates of the nodes of the piece ``flank``, root to tip, m. Shape (k,)."""


def tooth_outline(profile: ToothProfile, bottom_radius: float, recipe: MeshRecipe) -> ToothOutline:
    """Divide the boundary of half a tooth sector.

    `bottom_radius`: radius of the sector's lower end, away from the tip, m.
    """
    margin, fillet = profile.s_form - recipe.flank_margin, _fillet_end(profile, recipe)
    s_low = margin if margin > fillet + SNAP * recipe.fillet_size else fillet
    ends = _flank_divisions(profile, s_low, recipe)
    flank = piece("flank", profile.flank, ends)
    surface = [*_root_pieces(profile, s_low, recipe), flank, _tip_piece(profile, recipe)]
    bottom, side, center = _inner_pieces(surface, 0.5 * profile.pitch_angle, bottom_radius, recipe)
    s = np.empty(2 * len(ends) - 1)
    s[::2], s[1::2] = ends, middles(ends)  # corner and mid-side nodes in turn
    return ToothOutline(Outline((bottom, side, *surface, center)), s)


def _rim_limit(profile: ToothProfile, recipe: MeshRecipe, s: FloatArray) -> FloatArray:
    """Return the largest element that a thin rim admits: its thickness at the root, growing away from it."""
    gear = profile.gear
    thickness = max(gear.rim_thickness, THINNEST * gear.normal_module)
    return thickness + recipe.growth * np.maximum(s - profile.s_root, 0.0)


def _flank_divisions(profile: ToothProfile, s_low: float, recipe: MeshRecipe) -> FloatArray:
    """Divide the flank from `s_low` to the tip edge.

    A corner is on the form point, where the curvature jumps, unless it is almost at `s_low`.
    """

    def size(s: FloatArray) -> FloatArray:
        target = np.minimum(recipe.flank_size, recipe.tip_size + recipe.growth * (profile.s_tip - s))
        return np.minimum(target, _rim_limit(profile, recipe, s))

    if profile.s_form - s_low < SNAP * recipe.flank_size:
        return divide(s_low, profile.s_tip, size)
    below, above = divide(s_low, profile.s_form, size), divide(profile.s_form, profile.s_tip, size)
    return np.concatenate([below[:-1], above])


def _root_pieces(profile: ToothProfile, s_low: float, recipe: MeshRecipe) -> list[Piece]:
    """Return the surface from the middle of the tooth space up to `s_low`: root land and fillet."""

    def size(s: FloatArray) -> FloatArray:
        target = np.minimum(recipe.fillet_size, recipe.flank_size + recipe.growth * (s_low - s))
        return np.minimum(target, _rim_limit(profile, recipe, s))

    bottom = _fillet_end(profile, recipe)
    land = [_land_piece(profile, s_low, recipe)] if bottom > profile.s_space else []
    if s_low <= bottom:
        return land
    return [*land, piece("fillet", profile.flank, divide(s_low, bottom, size)[::-1])]


def _fillet_end(profile: ToothProfile, recipe: MeshRecipe) -> float:
    """Return the s at which the fillet ends, m: at the root land, or past a land too short for an element."""
    long_enough = profile.s_root - profile.s_space > SNAP * recipe.fillet_size
    return profile.s_root if long_enough else profile.s_space


def _land_piece(profile: ToothProfile, s_low: float, recipe: MeshRecipe) -> Piece:
    """Return the root circle from the middle of the tooth space to the fillet."""
    largest = min(recipe.body_size, LARGEST_ARC * profile.gear.root_radius)

    def size(s: FloatArray) -> FloatArray:
        target = np.minimum(recipe.flank_size + recipe.growth * (s_low - s), largest)
        return np.minimum(target, _rim_limit(profile, recipe, s))

    return piece("land", profile.flank, divide(profile.s_root, profile.s_space, size)[::-1])


def _tip_piece(profile: ToothProfile, recipe: MeshRecipe) -> Piece:
    """Return the tip circle from the tip edge to the center line."""
    radius, edge = profile.gear.tip_radius, profile.tip_angle
    largest = min(recipe.body_size / radius, LARGEST_ARC)

    def size(angle: FloatArray) -> FloatArray:
        return np.minimum(recipe.tip_size / radius + recipe.growth * (edge - angle), largest)

    tip = piece("tip", arc(radius), divide(edge, 0.0, size))
    tip.nodes[0] = profile.flank(np.array([profile.s_tip]))[0]  # exactly the last node of the flank
    return tip


def _inner_pieces(
    surface: list[Piece], half_pitch_angle: float, bottom_radius: float, recipe: MeshRecipe
) -> list[Piece]:
    """Return bottom, side and center, which lie inside the material, sized by the distance to the surface."""
    sources = np.concatenate([p.nodes[1::2] for p in surface])  # mid-side node of every edge
    lengths = np.concatenate([p.edge_lengths for p in surface])
    width = half_pitch_angle * bottom_radius
    size = spread(sources, lengths, recipe.growth, max(recipe.body_size, width))
    root, tip = np.linalg.norm(surface[0].nodes[0]), np.linalg.norm(surface[-1].nodes[-1])
    side, center, bottom = radial_line(half_pitch_angle), radial_line(0.0), arc(bottom_radius)

    def bottom_size(angle: FloatArray) -> FloatArray:
        return np.minimum(size(bottom(angle)) / bottom_radius, LARGEST_ARC)

    def side_size(radius: FloatArray) -> FloatArray:
        return np.minimum(size(side(radius)), half_pitch_angle * radius)

    def center_size(radius: FloatArray) -> FloatArray:
        return np.minimum(size(center(radius)), half_pitch_angle * radius)

    return [
        piece("bottom", bottom, divide(0.0, half_pitch_angle, bottom_size, COARSE)),
        piece("side", side, divide(bottom_radius, float(root), side_size, COARSE)),
        piece("center", center, divide(float(tip), bottom_radius, center_size, COARSE)),
    ]
