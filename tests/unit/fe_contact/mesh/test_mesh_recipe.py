"""Laws of mesh recipes."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path

import pytest

from fe_contact.compliance.cache import content_hash
from fe_contact.geometry import Gear
from fe_contact.mesh import MeshRecipe

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
ROOT = Path(__file__).parents[4]
STANDARD = MeshRecipe.standard(GEAR)


def test_refinement_divides_sizes_and_keeps_teeth_and_margin() -> None:
    fine = replace(STANDARD, real_teeth=5).refined(2.0)
    for name in ("flank_size", "tip_size", "fillet_size", "body_size", "growth"):
        assert getattr(fine, name) == pytest.approx(0.5 * getattr(STANDARD, name), rel=1e-15)
    assert (fine.real_teeth, fine.flank_margin) == (5, STANDARD.flank_margin)
    twice = STANDARD.refined(2.0).refined(2.0)
    assert twice.flank_size == pytest.approx(STANDARD.refined(4.0).flank_size, rel=1e-15)


def test_every_field_changes_the_hash() -> None:
    changed = {
        field.name: replace(STANDARD, **{field.name: 7 if field.name == "real_teeth" else 0.9 * value})
        for field in fields(STANDARD)
        for value in [getattr(STANDARD, field.name) or 1.0]
    }
    hashes = {content_hash(recipe.content()) for recipe in (*changed.values(), STANDARD)}
    assert len(hashes) == len(fields(STANDARD)) + 1


def test_hash_is_the_same_in_another_process() -> None:
    code = (
        "from fe_contact.compliance.cache import content_hash\nfrom fe_contact.mesh import MeshRecipe\n"
        f"recipe = MeshRecipe({STANDARD.flank_size!r}, {STANDARD.tip_size!r}, {STANDARD.fillet_size!r},"
        f" {STANDARD.body_size!r}, {STANDARD.flank_margin!r})\nprint(content_hash(recipe.content()))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert run.stdout.strip() == content_hash(STANDARD.content())
