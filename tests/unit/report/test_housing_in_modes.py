"""The housing in the modes of a unit: the picture of the report, and what the page is sent."""

import base64
from dataclasses import replace

import numpy as np
import pytest
from housed_tubes import subject_of, tube_on

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ModalAnalysis, modal_analysis
from lineofaction.gearbox.studies.bodies import UNIT
from lineofaction.gearbox.studies.modes.run import RUN
from lineofaction.gearbox.studies.unit_bodies import bodies_of, surface_motion
from lineofaction.report.drawing.figure import Figure
from lineofaction.report.response.modes import PAGE
from lineofaction.report.unit_motion import motion_json


@pytest.fixture(scope="module")
def modes():
    """At rest and at 100 rad/s, with what a study keeps of the housing."""
    subject = subject_of(tube_on(None))
    found = modal_analysis(assemble(subject.scene), [0.0, 100.0])
    motion = surface_motion(subject, found.freedom)
    return replace(found, surface_motion=motion, metadata=found.metadata | {UNIT: bodies_of(subject)})


def pictures(modes: ModalAnalysis) -> list[Figure]:
    figures = [figure for section in PAGE.page(modes).sections for figure in section.figures]
    return [figure for figure in figures if figure.key == "modal_housing"]


@pytest.mark.law
def test_the_report_draws_the_lowest_mode_in_which_the_housing_has_a_third(modes):
    (figure,) = pictures(modes)
    columns = [name.startswith("case.") for name in modes.freedom]
    share = modes.natural_kinetic_energy[:, columns].sum(axis=1)
    number = int(figure.title.split("mode ")[1].split(" ")[0]) - 1
    assert share[number] > 1.0 / 3.0
    assert np.all((share[:number] < 1.0 / 3.0) | (modes.natural_frequency[:number] == 0.0))
    assert number > 0, "shafts move below it"
    sizes = [float(np.nanmax(panel.shade.z)) for panel in figure.content]
    assert 0.3 < max(sizes) <= 1.0, "of the largest motion"
    words = [panel.title for panel in figure.content]
    assert not any(char.isdigit() for title in words for char in title or ""), "a mode has no size"
    none = replace(modes, surface_motion=np.empty((0, 3, 0), dtype=np.float32))
    assert pictures(none) == []


@pytest.mark.law
def test_the_page_is_sent_the_surface_of_every_mode_with_its_shafts(modes):
    """At rest and whirling: mm, as complex as the mode."""
    shapes = [*modes.natural_shape, *modes.shape[np.isfinite(modes.frequency)]]
    assert len(shapes) > 2 * modes.natural_frequency.size
    for offered, shape in zip(RUN.motions(modes), shapes, strict=True):
        surface = motion_json(offered.made())["surface"]
        parts = [np.frombuffer(base64.b64decode(surface[name]), "<f4") for name in ("real", "imaginary")]
        expected = 1e3 * (modes.surface_motion @ shape).reshape(-1)
        size = np.abs(expected).max()
        np.testing.assert_allclose(parts[0] + 1j * parts[1], expected, atol=1e-6 * size)
        level = np.frombuffer(base64.b64decode(surface["level_db"]), "<f4")
        normal = np.frombuffer(base64.b64decode(surface["normal"]), "<f4").reshape(-1, 3)
        across = np.abs(np.sum(expected.reshape(-1, 3) * normal, axis=1))
        moves = across > 1e-4 * across.max()
        np.testing.assert_allclose(level[moves], 20.0 * np.log10(across[moves] / across.max()), atol=0.02)
        assert surface["level_re"] == "the largest"


def test_a_file_keeps_the_motion_of_the_surface(modes, tmp_path):
    modes.to_netcdf(tmp_path / "modes.nc")
    kept = ModalAnalysis.from_netcdf(tmp_path / "modes.nc")
    assert kept.surface_motion.dtype == np.float32
    np.testing.assert_array_equal(kept.surface_motion, modes.surface_motion)
