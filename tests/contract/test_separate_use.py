"""The reader of REXS, rolling bearings and the compliance of teeth are imported without the rest."""

import subprocess
import sys

import pytest
from repository import ROOT

HOUSES = {"bounds", "dynamics", "fe_contact", "host", "lineofaction", "model_studies", "service"}
HEAVY = {"fastapi", "gmsh", "h5py", "httpx2", "matplotlib", "meshio", "numba", "numpy", "pandas", "plotly"}
HEAVY |= {"pydantic", "rich", "scipy", "skfem", "sqlalchemy", "typer", "xarray"}


@pytest.mark.parametrize(
    ("module", "houses", "packages"),
    [
        ("lineofaction.gearbox.rexs.files", {"lineofaction"}, set()),
        ("dynamics.bearings.catalog", {"bounds", "dynamics", "host"}, {"numpy"}),
        (
            "fe_contact.compliance",
            {"bounds", "fe_contact", "host", "model_studies"},
            {"numba", "numpy", "scipy"},  # numba loads SciPy
        ),
    ],
)
def test_a_part_is_imported_alone(module, houses, packages):
    code = f"import {module}, sys; print(*{{name.partition('.')[0] for name in sys.modules}})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    loaded = set(run.stdout.split())
    assert loaded & HOUSES == houses
    assert loaded & HEAVY == packages
