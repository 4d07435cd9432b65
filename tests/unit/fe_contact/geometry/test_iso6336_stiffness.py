from __future__ import annotations

from collections.abc import Callable

import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, GearPair, iso6336_stiffness
from fe_contact.material import Material


def test_mesh_stiffness_follows_from_single_stiffness_and_contact_ratio(
    make_gear: Callable[..., Gear],
) -> None:
    pair = GearPair(make_gear(teeth=23, helix_angle=0.3), make_gear(teeth=47, helix_angle=-0.3))
    stiffness = iso6336_stiffness(pair)
    expected = stiffness.single_stiffness * (0.75 * pair.transverse_contact_ratio + 0.25)
    assert stiffness.mesh_stiffness == pytest.approx(expected, rel=1e-14)
    assert stiffness.face_load_mesh_stiffness == pytest.approx(0.85 * expected, rel=1e-14)


def test_low_line_load_reduces_by_its_fourth_root_and_high_load_does_nothing(
    make_gear: Callable[..., Gear],
) -> None:
    pair = GearPair(make_gear(), make_gear())
    full = iso6336_stiffness(pair)
    reduced = iso6336_stiffness(pair, line_load=1e5 / 16.0)
    assert reduced.mesh_stiffness == pytest.approx(0.5 * full.mesh_stiffness, rel=1e-14)
    assert iso6336_stiffness(pair, line_load=2e5) == full
    with pytest.raises(InputError, match="line_load"):
        iso6336_stiffness(pair, line_load=0.0)


def test_modulus_enters_by_the_harmonic_mean(make_gear: Callable[..., Gear]) -> None:
    steel = GearPair(make_gear(), make_gear())
    soft = GearPair(make_gear(), make_gear(material=Material(70e9)))
    ratio = iso6336_stiffness(soft).single_stiffness / iso6336_stiffness(steel).single_stiffness
    assert ratio == pytest.approx(2.0 * 70.0 / (210.0 + 70.0), rel=1e-14)


def test_equal_gears_may_be_swapped_and_lengths_do_not_matter(make_gear: Callable[..., Gear]) -> None:
    # per unit width, stiffness is Pa: independent of the size of the gears
    pair = GearPair(make_gear(teeth=25), make_gear(teeth=25))
    large = GearPair(make_gear(teeth=25, normal_module=8e-3), make_gear(teeth=25, normal_module=8e-3))
    assert iso6336_stiffness(pair.swapped()) == iso6336_stiffness(pair)
    assert iso6336_stiffness(large).mesh_stiffness == pytest.approx(
        iso6336_stiffness(pair).mesh_stiffness, rel=1e-12
    )
