"""A part whose material is not stated is of one steel in its table and in its run, by Python and by file."""

import pytest

from dynamics.shafts import BeamSection
from fe_contact import STEEL, Shaft
from lineofaction.gearbox.schemas.gear import MaterialInput
from lineofaction.gearbox.schemas.shafts import SectionInput


def in_si(young, poisson, density):
    return {"young": young, "poisson": poisson, "density": density}


def of_material(material):
    return in_si(material.youngs_modulus, material.poissons_ratio, material.density)


def shaft_of_table():
    return of_material(Shaft(length=0.2, position=0.1, diameter=0.03).material)


def shaft_of_run():
    section = BeamSection(length=0.2, outer_diameter=0.03)
    return in_si(section.youngs_modulus, section.poissons_ratio, section.density)


def section_of_scene_file():
    section = SectionInput(length_mm=200.0, outer_diameter_mm=30.0)
    return in_si(1e9 * section.youngs_modulus_gpa, section.poissons_ratio, section.density_kg_per_m3)


def gear_of_case_file():
    material = MaterialInput()
    return in_si(1e9 * material.youngs_modulus_gpa, material.poissons_ratio, STEEL.density)


@pytest.mark.parametrize("steel", [shaft_of_table, shaft_of_run, section_of_scene_file, gear_of_case_file])
def test_what_states_no_material_is_of_the_gears_steel(steel):
    assert steel() == pytest.approx(of_material(STEEL), rel=1e-15)
