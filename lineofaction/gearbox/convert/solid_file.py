"""The file of a housing's solid as a scene holds it."""

from __future__ import annotations

from pathlib import Path

from dynamics.errors import InputError
from dynamics.solid_housing import MESH_SUFFIXES, STEP_SUFFIXES, check_mesh_content
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene_housings import HousingInput

STEP_BEGINS = b"ISO-10303-21"


def solid_file(housing: HousingInput) -> tuple[str, str, bytes]:
    """Return the field that holds the file of a solid, how its name ends, and what is in it.

    Raises
    ------
    BadInput
        Another kind of file, damaged content, or a mesh that names further files, which are not here.
    """
    field, suffixes = ("step_file", STEP_SUFFIXES) if housing.step_file else ("mesh_file", MESH_SUFFIXES)
    content = housing.step_file or housing.mesh_file
    assert content is not None  # the schema comes first
    suffix = Path(content.name).suffix.lower()
    if suffix not in suffixes:
        raise BadInput.of(f"{field}.name", content.name, f"a name that ends in {', '.join(suffixes)}")
    try:
        data = content.unpacked()
    except ValueError as error:
        length = f"{len(content.content)} characters"
        raise BadInput.of(f"{field}.content", length, str(error), "The client packs files.") from None
    if field == "step_file" and not data.lstrip().startswith(STEP_BEGINS):
        bound = f"a STEP file, which begins with {STEP_BEGINS.decode()}"
        raise BadInput.of(field, content.name, bound, "Export the solid as STEP (AP 214, AP 242).")
    if field == "mesh_file":
        try:
            check_mesh_content(content.name, data)
        except InputError as error:
            raise BadInput.of(field, content.name, str(error.bound), str(error.suggestion)) from None
    return field, suffix, data
