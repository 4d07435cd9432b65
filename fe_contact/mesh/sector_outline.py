"""Outline of one tooth sector in two four-sided blocks: the tooth, and the body below it.

Tooth and body part at the split points, one on the fillet of each flank. The line between them dips below the
straight one. The cuts are the radial edges of the sector.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from fe_contact.geometry import Toothing, ToothProfile
from fe_contact.mesh.curve_division import middles
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.types import FloatArray

DIP = 0.12  # depth of the dip in modules: the angles of the elements on its two sides are about equal

THIN = 0.25  # largest depth of the dip over the thickness of the rim

DEEP = 0.25  # height of body elements deep below the root, in parts of their depth

LEAN = 0.4  # least slope of the fillet at the split point: sine of its angle to the tooth's center line

LOWEST_SPLIT = 0.9  # lowest split point, in parts of the fillet's length from the form point

TAPER = 0.5  # largest height of body elements, in parts of the radius of their upper end

COAST = 1.5  # size of elements below the coast flank over that below the loaded flank


@dataclass(frozen=True)
class SectorOutline:
    """Divisions of one tooth sector; every other entry is a mid-side node, at the middle parameter."""

    profile: ToothProfile
    s: FloatArray
    """Flank coordinates of the loaded flank from the split point to the tip, m. Shape (k,)."""
    land: FloatArray
    """Flank coordinates from the middle of the tooth space to the split point, m. Shape (2 land_elements +
    1,).
    """
    across: FloatArray
    """Fractions across the tooth from the right flank (0) to the left one (1). Shape (p,)."""
    depth: FloatArray
    """Fractions from the root (0) to the bore (1). Shape (q,)."""
    web_rows: tuple[int, int] = (0, 0)
    """Rows of the web, as in `SectorGrid`."""

    @property
    def grid(self) -> SectorGrid:
        """The grid of its nodes: rows of the body and the tooth, columns between its divisions."""
        return SectorGrid(
            body_rows=len(self.depth) // 2,
            tooth_rows=len(self.s) // 2,
            land=len(self.land) // 2,
            across=len(self.across) // 2,
            inward=self.profile.gear.sign < 0,
            web_rows=self.web_rows,
        )

    @property
    def right_flank(self) -> FloatArray:
        """Points of the loaded flank, (k, 2)."""
        return self.profile.flank(self.s)

    @property
    def tip(self) -> FloatArray:
        """Points of the tip land from right to left, (p, 2)."""
        return self.profile.tip_land(self.across)

    @property
    def base(self) -> FloatArray:
        """Points between tooth and body from right to left, (p, 2)."""
        right, t = self.profile.flank(self.s[:1])[0], self.across[:, None]
        gear = self.profile.gear
        depth = gear.sign * min(DIP * gear.normal_module, THIN * gear.rim_thickness)
        dip = 4.0 * depth * t * (1.0 - t)  # a parabola, deepest at t = 1/2
        return np.asarray((1.0 - t) * right + t * right * [-1.0, 1.0] - dip * [0.0, 1.0])

    @property
    def right_land(self) -> FloatArray:
        """Points of the right half of the tooth space, (2 land_elements + 1, 2)."""
        return self.profile.flank(self.land)

    @property
    def body_top(self) -> FloatArray:
        """Points above the body from the right cut to the left one."""
        right, base = self.right_land, self.base
        return np.concatenate([right[:-1], base, (right * [-1.0, 1.0])[-2::-1]])

    @property
    def bore(self) -> FloatArray:
        """Points of the bore from the right cut to the left one."""
        half = 0.5 * self.profile.pitch_angle
        angle = np.linspace(half, -half, 2 * self.grid.columns + 1)
        return self.profile.gear.seat_radius * np.stack([np.sin(angle), np.cos(angle)], axis=-1)

    @property
    def circles(self) -> dict[int, FloatArray]:
        """Points of the hub's outside and the rim's inside, right to left; keys: row of elements above."""
        top, bottom = (np.arctan2(*p[::2].T) for p in (self.body_top, self.bore))
        circles = {}
        for row in self.web_rows:
            if -self.grid.body_rows < row < 0:
                depth = self.depth[-2 * row]  # rows count from the root, two divisions each
                angle = _with_middles((1.0 - depth) * top + depth * bottom)
                radius = np.linalg.norm(self.right_cut[-2 * row])
                circles[row] = radius * np.stack([np.sin(angle), np.cos(angle)], axis=-1)
        return circles

    @property
    def right_cut(self) -> FloatArray:
        """Points of the right cut from the root down to the bore, (q, 2)."""
        gear, angle = self.profile.gear, 0.5 * self.profile.pitch_angle
        radius = (1.0 - self.depth) * gear.root_radius + self.depth * gear.seat_radius
        return np.asarray(radius[:, None] * np.array([np.sin(angle), np.cos(angle)]))


def sector_outline(profile: ToothProfile, recipe: SectorRecipe) -> SectorOutline:
    """Divide the outline of one tooth sector."""
    gear = profile.gear
    split = _split_point(profile, recipe)
    half_width = profile.flank(np.array([0.5 * (profile.s_form + profile.s_tip)]))[0, 0]
    depth, web_rows = _body_divisions(gear, recipe)
    return SectorOutline(
        profile=profile,
        s=_with_middles(_flank_divisions(profile, split, recipe)),
        land=_with_middles(np.linspace(profile.s_space, split, recipe.land_elements + 1)),
        across=_with_middles(_tooth_divisions(half_width, recipe)),
        depth=_with_middles(depth),
        web_rows=web_rows,
    )


def _split_point(profile: ToothProfile, recipe: SectorRecipe) -> float:
    """Return the flank coordinate where tooth and body part.

    Below the waist of an undercut tooth the fillet rises steeply: there the point moves down to where the
    fillet leans outwards, so that the body's elements beside it keep their angles.
    """
    fractions = np.linspace(recipe.split, LOWEST_SPLIT, 41)
    lean = profile.gear.sign * profile.normal(profile.s_form - fractions * profile.fillet_length)[:, 1]
    enough = np.flatnonzero(lean >= LEAN)
    fraction = fractions[enough[0]] if len(enough) else LOWEST_SPLIT
    return float(profile.s_form - fraction * profile.fillet_length)


def _with_middles(x: FloatArray) -> FloatArray:
    out = np.empty(2 * len(x) - 1)
    out[::2], out[1::2] = x, middles(x)
    return out


def _graded(length: float, size: Callable[[float], float], start: float = 0.0) -> FloatArray:
    """Divide 0 .. length into parts of about size(start + x), x where a part begins."""
    x = [0.0]
    while x[-1] < length:
        x.append(x[-1] + size(start + x[-1]))
    if len(x) > 2 and x[-1] - length > 0.5 * (x[-1] - x[-2]):
        x.pop()  # less than half of the last part lies inside
    return np.array(x) * (length / x[-1])


def _flank_divisions(profile: ToothProfile, split: float, recipe: SectorRecipe) -> FloatArray:
    """Divide the flank from `split` to the tip, a corner on the form point, where the curvature jumps."""

    def size(x: float) -> float:
        return min(recipe.flank_size, recipe.tip_size + recipe.tip_growth * x)

    below = max(1, int(np.ceil((profile.s_form - split) / recipe.flank_size)))
    involute = profile.s_tip - _graded(profile.s_tip - profile.s_form, size)[::-1]
    return np.concatenate([np.linspace(split, profile.s_form, below + 1)[:-1], involute])


def _tooth_divisions(half_width: float, recipe: SectorRecipe) -> FloatArray:
    """Divide 0 .. 1 across a tooth: fine below the loaded flank, coarser below the other."""

    def size(x: float, factor: float) -> float:
        return min(recipe.depth_limit, factor * recipe.depth_size + recipe.depth_growth * x)

    loaded, coast = (_graded(half_width, partial(size, factor=factor)) for factor in (1.0, COAST))
    return np.concatenate([loaded, 2.0 * half_width - coast[-2::-1]]) / (2.0 * half_width)


def _body_divisions(gear: Toothing, recipe: SectorRecipe) -> tuple[FloatArray, tuple[int, int]]:
    """Divide 0 .. 1 from the root to the bore, and return the rows of the web (see `SectorGrid`).

    Deep in the body the field changes over its depth, and around a small bore over the radius. Rows end at
    the inside of the rim and at the outside of the hub.
    """

    def size(x: float) -> float:
        largest = max(recipe.body_limit, DEEP * x)
        return min(
            largest, recipe.body_size + recipe.body_growth * x, TAPER * (gear.root_radius - gear.sign * x)
        )

    depth, web = gear.body_depth, gear.web
    if web is None:
        return _graded(depth, size) / depth, (0, 0)
    rim, hub = gear.root_radius - web.outer_radius, gear.root_radius - web.inner_radius
    ends = [0.0, rim, hub, depth] if hub < depth else [0.0, rim, hub]  # a web may reach down to the bore
    x = [np.zeros(1)]
    for low, high in pairwise(ends):
        x.append(low + _graded(high - low, size, low)[1:])
    return np.concatenate(x) / depth, (-len(x[1]) - len(x[2]), -len(x[1]))
