"""The FMU as a file: valid, deterministic, rebuilt from its own sources, refused with one clear error."""

import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import fmu_instance
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from fmu_instance import Instance
from geared_scenes import BASE_RADIUS, gear_pair_scene, spring_table

from dynamics.engines import MeshElement, mesh_element
from dynamics.engines.fmu import export_fmu
from dynamics.engines.fmu.compiler import CompilerError, binary_folder, find_compiler
from dynamics.errors import InputError

fmpy = fmu_instance.fmpy


def test_fmpy_finds_no_fault_in_it(element, tmp_path):
    file = export_fmu(element, tmp_path / "m.fmu", name="stage_1")
    assert validate_fmu(str(file)) == []
    description = fmpy.read_model_description(str(file), validate=True)
    assert (description.fmiVersion, description.coSimulation.modelIdentifier) == ("2.0", "stage_1")
    found = fmpy.simulate_fmu(
        str(file), start_values={"displacement": 5e-6, "dte_from_angles": False}, stop_time=0.01
    )
    assert found["mesh_force"][-1] > 1000.0
    assert found["contact_state"][-1] == 1


def test_the_same_element_gives_the_same_bytes_and_another_one_another_guid(element, tmp_path):
    first, again = (export_fmu(element, tmp_path / f"{n}.fmu").read_bytes() for n in "ab")
    assert first == again
    guids = {
        fmpy.read_model_description(str(export_fmu(changed, tmp_path / "c.fmu", binary=False))).guid
        for changed in (
            element,
            replace(element, damping=1.0),
            replace(element, table=spring_table(4e8)),
            replace(element, base_helix_angle=0.0),
        )
    }
    assert len(guids) == 4


def test_it_can_be_rebuilt_from_its_own_sources(element, tmp_path):
    """As its description lists them, with warnings as errors, into the same binary."""
    file = export_fmu(element, tmp_path / "m.fmu")
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path / "unpacked")
    sources = tmp_path / "unpacked" / "sources"
    description = ElementTree.fromstring((tmp_path / "unpacked" / "modelDescription.xml").read_bytes())
    listed = [entry.attrib["name"] for entry in description.iter("File")]
    folder, ending = binary_folder()
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wno-sign-conversion"]
    flags = ["-O2", "-fPIC", "-shared", "-ffp-contract=off", "-s", "-I."]
    command = [*find_compiler(), *strict, *flags, "-o", f"m{ending}", *listed, "-lm"]
    subprocess.run(command, cwd=sources, check=True)
    shipped = tmp_path / "unpacked" / "binaries" / folder / f"gear_mesh{ending}"
    assert (sources / f"m{ending}").read_bytes() == shipped.read_bytes()


LAYOUT = """
#include <stdio.h>
#define N(name) printf(#name " %d\\n", (int)(name))
#define S(type) printf(#type " %zu\\n", sizeof(type))
#define O(field) printf(#field " %zu\\n", offsetof(fmi2CallbackFunctions, field))
int main(void) {
    N(fmi2True), N(fmi2False);
    N(fmi2OK), N(fmi2Warning), N(fmi2Discard), N(fmi2Error), N(fmi2Fatal), N(fmi2Pending);
    N(fmi2ModelExchange), N(fmi2CoSimulation);
    N(fmi2DoStepStatus), N(fmi2PendingStatus), N(fmi2LastSuccessfulTime), N(fmi2Terminated);
    S(fmi2Component), S(fmi2ValueReference), S(fmi2Real), S(fmi2Integer), S(fmi2Boolean), S(fmi2Byte);
    S(fmi2CallbackFunctions), O(logger), O(allocateMemory), O(freeMemory);
    O(stepFinished), O(componentEnvironment);
    puts(fmi2TypesPlatform), puts(fmi2Version);
}
"""


def test_its_interface_is_that_of_the_standards_header(element, tmp_path):
    """Signatures: the unit compiles against the header that FMPy ships. Layout: sizes and values agree."""
    standard = Path(fmpy.__file__).parent / "c-code"
    with zipfile.ZipFile(export_fmu(element, tmp_path / "m.fmu", binary=False)) as archive:
        archive.extractall(tmp_path)
    sources = tmp_path / "sources"
    (tmp_path / "layout.c").write_text(LAYOUT)
    found = []
    for headers in (
        ["-DFMI2_H", f"-I{standard}", "-include", "fmi2Functions.h"],
        [f"-I{sources}", "-include", "fmi2.h"],
    ):
        strict = [*find_compiler(), "-std=c99", "-Wall", "-Werror", *headers]
        subprocess.run([*strict, "-fsyntax-only", "fmi2_slave.c"], cwd=sources, check=True)
        subprocess.run([*strict, "-o", "layout", "layout.c"], cwd=tmp_path, check=True)
        found.append(subprocess.run([tmp_path / "layout"], capture_output=True, check=True).stdout)
    assert found[0] == found[1]
    assert len(found[0].splitlines()) == 28


@pytest.mark.law
def test_a_state_can_be_kept_and_taken_up_again(element, tmp_path):
    names = ("driver_angle", "driver_turns", "mesh_force", "dte_from_angles", "damping")
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start(dte_from_angles=False, driver_angle=0.1, driver_turns=5, displacement=5e-6)
        here = unit.get(*names)
        kept = unit.unit.getFMUState()
        frozen = unit.unit.serializeFMUState(kept)
        unit.set(driver_angle=0.2, driver_turns=6, displacement=1e-6, damping=7.0)
        assert unit.get(*names) != here
        unit.unit.setFMUState(kept)
        assert unit.get(*names) == here
        unit.unit.freeFMUState(kept)
        unit.unit.reset()
        assert unit.get("driver_angle", "mesh_force") == [0.0, 0.0]
        thawed = unit.unit.deSerializeFMUstate(frozen)
        unit.unit.setFMUState(thawed)
        assert unit.get(*names) == here
        unit.unit.freeFMUState(thawed)


def test_values_it_cannot_use_are_errors(element, tmp_path):
    with Instance(export_fmu(element, tmp_path / "m.fmu")) as unit:
        unit.start(displacement=5e-6, dte_from_angles=False)
        force = unit.get("mesh_force")
        for name, value in (
            ("driver_angle", float("nan")),
            ("damping", -1.0),
            ("damping_reach", 0.0),
            ("mesh_force", 1.0),
        ):
            with pytest.raises(FMICallException):
                unit.set(**{name: value})
        assert unit.get("mesh_force") == force


def test_a_table_that_is_not_its_own_is_refused(element, tmp_path):
    """The description of one pair, the table of another."""
    one = export_fmu(element, tmp_path / "one.fmu")
    other = export_fmu(replace(element, table=spring_table(4e8)), tmp_path / "other.fmu", binary=False)
    table = "resources/mesh_force_table.bin"
    with zipfile.ZipFile(other) as archive:
        foreign = archive.read(table)
    for name, content in (("foreign", foreign), ("cut", None), ("empty", b"")):
        mixed = tmp_path / f"{name}.fmu"
        with zipfile.ZipFile(one) as old, zipfile.ZipFile(mixed, "w") as new:
            for entry in old.namelist():
                own = old.read(entry)
                new.writestr(entry, own if entry != table else own[:-8] if content is None else content)
        with pytest.raises(Exception, match="instantiate"):
            Instance(mixed)
    with pytest.raises(Exception, match="instantiate"):
        Instance(one, guid="{another}")


def test_without_a_compiler_the_error_says_what_to_do_and_sources_can_be_written(
    element, tmp_path, monkeypatch
):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(InputError, match=r"CC = None: must be a C compiler on the path.*sources alone"):
        export_fmu(element, tmp_path / "m.fmu")
    assert not list(tmp_path.iterdir())
    file = export_fmu(element, tmp_path / "m.fmu", binary=False)
    with zipfile.ZipFile(file) as archive:
        assert not [name for name in archive.namelist() if name.startswith("binaries")]
        assert "sources/fmi2_slave.c" in archive.namelist()


def test_a_compiler_that_fails_is_quoted(element, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "cc -DTABLE_FILE_MISSING -include nowhere.h")
    with pytest.raises(CompilerError, match=r"nowhere\.h"):
        export_fmu(element, tmp_path / "m.fmu")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("path", "name", "field"), [("m.zip", "m", "path"), ("no/m.fmu", "m", "path"), ("m.fmu", "1m", "name")]
)
def test_paths_and_names_it_cannot_use(element, tmp_path, path, name, field):
    with pytest.raises(InputError, match=f"^{field} = "):
        export_fmu(element, tmp_path / path, name=name)


def test_an_element_checks_its_facts(element):
    with pytest.raises(InputError, match=r"base_radius\[1\].*Base pitches must agree"):
        MeshElement(element.table, (20, 20), (BASE_RADIUS, 1.01 * BASE_RADIUS))
    with pytest.raises(InputError, match="damping = -1"):
        replace(element, damping=-1.0)
    with pytest.raises(InputError, match="mesh = 'none'"):
        mesh_element(gear_pair_scene(), "none")
