"""The transmission error of a loaded pair at one position by CalculiX, on the mesh of the condensed peer."""

import re
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fe_contact import Material, Status
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus, peak_pressure
from fe_contact.mesh.quadratic_mesh import SIDES, rotated
from fe_contact.types import FloatArray, IntArray
from host import child_environment, ending_signal
from verification.full_contact import FullContactPoint, Resolution
from verification.full_contact.condensation.modified_flank import removed_at_roll
from verification.full_contact.condensation.placed_mesh import PlacedBody, placed_bodies
from verification.full_contact.condensation.sites import Range, contact_sites

# The mesh of one position: the driving gear turned towards its mate.


@dataclass(frozen=True)
class PlacedPair:
    """Two undeformed gears, driving and driven, the driving one `approach` (m) beyond the conjugate position.

    The driving gear turns clockwise; `meetings` are flanks of gear 1 and gear 2 that may touch.
    """

    gears: tuple[PlacedBody, PlacedBody]
    meetings: tuple[tuple[int, int], ...]
    approach: float


def placed_pair(pair: ParallelAxes, bodies: tuple[PlacedBody, PlacedBody], approach: float) -> PlacedPair:
    """Turn the driving gear of conjugate bodies; beyond the gap teeth overlap, and hold each other."""
    turns = (-approach / pair.pinion.base_radius, 0.0)
    first, second = (_placed(body, turn) for body, turn in zip(bodies, turns, strict=True))
    return PlacedPair((first, second), tuple((ahead, ahead) for ahead in bodies[0].strips), approach)


def no_load_gap(pair: ParallelAxes, position: float) -> float:
    """Return the least modified gap of the pairs on the path of contact, m: beyond it teeth overlap."""
    path = pair.path_of_contact
    reach = int(np.ceil(path.length / pair.base_pitch)) + 1
    roll_1, roll_2 = pair.roll_lengths(position, np.arange(-reach, reach + 1))
    on_path = (roll_1 >= path.start) & (roll_1 <= path.end)
    gap = removed_at_roll(pair.pinion, roll_1) + removed_at_roll(pair.wheel, roll_2)
    return float(np.min(gap[on_path]))


def _placed(body: PlacedBody, turn: float) -> PlacedBody:
    return replace(body, points=rotated(body.points - body.center, turn) + body.center)


def flank_sides(body: PlacedBody, ahead: int) -> IntArray:
    """Return the elements along a flank, and the number of their side that lies on it, (e, 2)."""
    triangles = body.triangles
    on_line = np.isin(triangles, body.strips[ahead].nodes)
    sides = []
    for number, (a, b) in enumerate(SIDES):
        elements = np.flatnonzero(on_line[:, a] & on_line[:, b] & on_line[:, 3 + number])
        sides.append(np.column_stack([elements, np.full(len(elements), number)]))
    return np.concatenate(sides)


# Input deck of CalculiX for one loaded position of a pair; units mm, N, MPa.


MM, MPA = 1e3, 1e-6
PER_LINE = 8
TURNING, HELD = "TURNING", "HELD"
"""Node sets that are printed: the turning of gear 1, and gear 2's bore."""


@dataclass(frozen=True)
class Loading:
    """The load of a placed pair: force on the base circle in N, base radius of gear 1 and face width in m.

    `penalty` is pressure over overlap in the contact, Pa/m.
    """

    materials: tuple[Material, Material]
    base_radius: float
    face_width: float
    transverse_force: float
    penalty: float


def input_deck(placed: PlacedPair, loading: Loading) -> str:
    gears, bodies = placed.gears, numbered_bodies(placed.gears)
    turning = bodies[-1].last_node + 1
    lines = ["*HEADING", "full contact of a gear pair, mm N MPa", "*NODE, NSET=ALL"]
    for gear, body in zip(gears, bodies, strict=True):
        lines += _nodes(gear.points, body)
    lines += [f"{turning},0.,0.,0.", f"*NSET, NSET={TURNING}", f"{turning}"]
    lines += [f"*NSET, NSET={HELD}", *_list(bodies[1].first_node + gears[1].bore_nodes)]
    for gear, body, material in zip(gears, bodies, loading.materials, strict=True):
        lines += _body(gear, body, material, loading.face_width)
    lines += _contact(placed, bodies, loading.penalty)
    lines += _rigid_bore(gears[0], bodies[0], turning, loading.base_radius)
    lines += ["*BOUNDARY", f"{HELD},1,2", f"{TURNING},2,3"]
    return "\n".join([*lines, *_step(loading.transverse_force), ""])


@dataclass(frozen=True)
class NumberedBody:
    """Numbers of one gear's nodes and elements in the deck."""

    name: str
    first_node: int
    first_element: int
    last_node: int


def numbered_bodies(gears: Sequence[PlacedBody]) -> tuple[NumberedBody, ...]:
    """Return the numbers of the gears, one after the other, from 1."""
    node, element, bodies = 1, 1, []
    for count, gear in enumerate(gears, start=1):
        bodies.append(NumberedBody(f"GEAR{count}", node, element, node + len(gear.points) - 1))
        node, element = node + len(gear.points), element + len(gear.triangles)
    return tuple(bodies)


def _nodes(points: FloatArray, body: NumberedBody) -> Iterable[str]:
    rows = (points * MM).tolist()
    return (f"{body.first_node + i},{_number(x)},{_number(y)},0." for i, (x, y) in enumerate(rows))


def _body(gear: PlacedBody, body: NumberedBody, material: Material, face_width: float) -> list[str]:
    rows = (gear.triangles + body.first_node).tolist()
    return [
        f"*ELEMENT, TYPE=CPE6, ELSET={body.name}",
        *(f"{body.first_element + i},{','.join(map(str, row))}" for i, row in enumerate(rows)),
        f"*MATERIAL, NAME={body.name}",
        "*ELASTIC",
        f"{_number(material.youngs_modulus * MPA)},{_number(material.poissons_ratio)}",
        f"*SOLID SECTION, ELSET={body.name}, MATERIAL={body.name}",
        _number(face_width * MM),
    ]


def _contact(placed: PlacedPair, bodies: Sequence[NumberedBody], penalty: float) -> list[str]:
    """Surfaces of the teeth that may touch, and what acts between them."""
    lines: list[str] = []
    for number, meeting in enumerate(placed.meetings):
        for gear, body, tooth in zip(placed.gears, bodies, meeting, strict=True):
            lines.append(f"*SURFACE, NAME={body.name}FLANK{number}, TYPE=ELEMENT")
            lines += [
                f"{body.first_element + e},S{side + 1}" for e, side in flank_sides(gear, tooth).tolist()
            ]
    lines += ["*SURFACE INTERACTION, NAME=FLANKS", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
    lines.append(_number(penalty * MPA / MM))
    for number in range(len(placed.meetings)):
        lines.append("*CONTACT PAIR, INTERACTION=FLANKS, TYPE=SURFACE TO SURFACE")
        lines.append(f"{bodies[1].name}FLANK{number},{bodies[0].name}FLANK{number}")
    return lines


def _rigid_bore(gear: PlacedBody, body: NumberedBody, turning: int, base_radius: float) -> list[str]:
    """Tie the bore to the turning node: clockwise, u = (y, -x) theta, linear as displacements are small."""
    arms = ((gear.points[gear.bore_nodes] - gear.center) / base_radius).tolist()
    lines = []
    for node, (x, y) in zip((gear.bore_nodes + body.first_node).tolist(), arms, strict=True):
        lines += ["*EQUATION", "2", f"{node},1,1.,{turning},1,{_number(-y)}"]
        lines += ["*EQUATION", "2", f"{node},2,1.,{turning},1,{_number(x)}"]
    return lines


def _step(transverse_force: float) -> list[str]:
    """One static step, and what `result_file` reads."""
    load = ["*CLOAD", f"{TURNING},1,{_number(transverse_force)}"]
    prints = [f"*NODE PRINT, NSET={TURNING}", "U", f"*NODE PRINT, NSET={HELD}", "RF"]
    return ["*STEP, INC=100", "*STATIC", "1.,1.", *load, *prints, "*END STEP"]


def _list(numbers: IntArray) -> Iterable[str]:
    return (",".join(map(str, numbers[i : i + PER_LINE].tolist())) for i in range(0, len(numbers), PER_LINE))


def _number(value: float) -> str:
    """Write a number in the 20 characters that CalculiX reads of a field: it cuts off what is longer."""
    return f"{value:.12e}"


# CalculiX as a child process: one deck, one thread, its limits, and how it ended.


PROGRAM = "ccx"
WALL_OVER_CPU = 20.0
"""Wall seconds that a CPU second may take on a busy machine before the run counts as hung."""
_LIMITED = 'ulimit -S -t "$1"; exec "$2" -i job'  # the limit ends it even where its parent is gone


@dataclass(frozen=True)
class Run:
    """The end of a run; NOT_COMPUTED past its limit or where it did not start."""

    status: Status
    reason: str
    iterations: int
    printed: str


def find_calculix() -> str | None:
    return shutil.which(PROGRAM)


def version_of(program: str) -> str:
    process = subprocess.run([program, "-v"], capture_output=True, text=True, timeout=60.0, check=False)
    stated = re.search(r"Version\s+(\S+)", process.stdout)
    return f"CalculiX {stated.group(1)}" if stated else "CalculiX"


def run_calculix(program: str, deck: str, folder: Path, cpu_limit: float) -> Run:
    """Run a deck in an empty folder, for at most these CPU seconds, 20 times as much by the clock."""
    (folder / "job.inp").write_text(deck, encoding="ascii")
    command = ("sh", "-c", _LIMITED, "sh", f"{max(1, round(cpu_limit))}", program)
    threads = dict.fromkeys(("OMP_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER", "NUMBER_OF_CPUS"), "1")
    try:
        child = subprocess.run(
            command,
            cwd=folder,
            env=child_environment(**threads),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=WALL_OVER_CPU * cpu_limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Run(Status.NOT_COMPUTED, f"no result within {WALL_OVER_CPU * cpu_limit:.0f} s", 0, "")
    except OSError as error:
        return Run(Status.NOT_COMPUTED, f"cannot be started ({error})", 0, "")
    return _ended(child, folder, cpu_limit)


def _ended(child: subprocess.CompletedProcess[str], folder: Path, cpu_limit: float) -> Run:
    iterations = len(re.findall(r"^ iteration \d+", child.stdout, re.MULTILINE))
    if ending_signal(child.returncode) == "SIGXCPU":
        return Run(Status.NOT_COMPUTED, f"no result within {cpu_limit:.0f} CPU s", iterations, "")
    if child.returncode != 0 or "Job finished" not in child.stdout:
        return Run(Status.ITERATION_LIMIT, _complaint(child), iterations, "")
    return Run(Status.CONVERGED, "", iterations, (folder / "job.dat").read_text(encoding="ascii"))


def _complaint(child: subprocess.CompletedProcess[str]) -> str:
    error = re.search(r"\*ERROR(.*?)(?:\n\s*\n|\Z)", child.stdout, re.DOTALL)
    message = " ".join(error.group(1).split()).removeprefix(":").strip() if error else "no error printed"
    return f"exit code {child.returncode}: {message}"


# The .dat file of CalculiX: the rotation of gear 1 and the reactions of gear 2's bore.


_HEAD = re.compile(r"^\s*(displacements|forces)\s.*for set (\S+) and time", re.MULTILINE)


@dataclass(frozen=True)
class Printed:
    """One position: turning (m) beyond the approach, and the shaft's forces (b, 2) on nodes of the bore."""

    turning: float
    nodes: IntArray
    reactions: FloatArray

    def moment(self, points: FloatArray, about: FloatArray) -> float:
        """Moment in N m, counter-clockwise, of the reactions at their nodes' points (b, 2) about a point."""
        arms = points - about
        return float(np.sum(arms[:, 0] * self.reactions[:, 1] - arms[:, 1] * self.reactions[:, 0]))


def read_printed(text: str) -> Printed:
    """Return the last values that were printed; `ValueError`: something is missing, or no number."""
    blocks: dict[tuple[str, str], str] = {}
    heads = list(_HEAD.finditer(text))
    ends = [*(head.start() for head in heads), len(text)][1:]
    for head, end in zip(heads, ends, strict=True):
        blocks[head.group(1), head.group(2)] = text[text.index("\n", head.end()) : end]
    try:
        turning, held = _rows(blocks["displacements", TURNING]), _rows(blocks["forces", HELD])
    except KeyError as error:
        raise ValueError(f"CalculiX printed no {' of '.join(error.args[0])}") from None
    if len(turning) != 1 or not np.all(np.isfinite(held)) or not np.all(np.isfinite(turning)):
        raise ValueError("CalculiX printed no finite result")
    return Printed(float(turning[0, 1]) / MM, held[:, 0].astype(np.int64), held[:, 1:3])


def _rows(block: str) -> FloatArray:
    """Node number and three components in each row, (n, 4)."""
    return np.array([[float(word) for word in line.split()] for line in block.splitlines() if line.strip()])


OVERLAP_PART = 1e-4
"""Of the deflection that the overlap of the penalty may take: 1 nm in 10 um."""
START_PART = 0.01
"""Of the deflection by which teeth overlap at the start: more costs iterations, none leaves gear 1 loose."""
REACHED = 2.0
"""Deflections by which teeth off the path of contact may come to touch."""
MESH_MODULUS = 20e9 / 210e9
"""Deflection of steel teeth, about 20 N/(mm um), over the modulus of elasticity: a first guess."""


def solve_position(
    program: str,
    pair: ParallelAxes,
    normal_force: float,
    position: float,
    cpu_limit: float,
    resolution: Resolution | None = None,
) -> FullContactPoint:
    """Solve one position (base pitches, by the driven gear) on a mesh of its own, the condensed peer's.

    The torque is that of gear 1; `MeshError`: there is no mesh.
    """
    phase = position - round(position)
    line_load = normal_force / pair.face_width
    guess = line_load / (MESH_MODULUS * pair.pinion.material.youngs_modulus)
    gap = no_load_gap(pair, phase)
    held = Range((line_load, line_load), gap + REACHED * guess)
    fineness = resolution or Resolution()
    bodies = placed_bodies(pair, phase, contact_sites(pair, phase, held, fineness), fineness)
    placed = placed_pair(pair, bodies, gap + START_PART * guess)
    loading = _loading(pair, normal_force, guess)
    with TemporaryDirectory(prefix="full_contact_") as folder:
        run = run_calculix(program, input_deck(placed, loading), Path(folder), cpu_limit)
    if not run.status.usable:
        return _failed(run)
    return _point(pair, placed, loading, position, run)


def _loading(pair: ParallelAxes, normal_force: float, deflection: float) -> Loading:
    """Return the load, with a penalty that the peak pressure of Hertz makes yield a given part."""
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    radius = 1.0 / float(pair.relative_curvature(pair.path_of_contact.pitch_point))
    pressure = float(peak_pressure(normal_force / pair.face_width, radius, modulus))
    return Loading(
        materials=(pair.pinion.material, pair.wheel.material),
        base_radius=pair.pinion.base_radius,
        face_width=pair.face_width,
        transverse_force=float(pair.transverse_force(normal_force)),
        penalty=pressure / (OVERLAP_PART * deflection),
    )


def _point(
    pair: ParallelAxes, placed: PlacedPair, loading: Loading, position: float, run: Run
) -> FullContactPoint:
    try:
        printed = read_printed(run.printed)
    except ValueError as error:
        return _failed(Run(Status.ITERATION_LIMIT, str(error), run.iterations, ""))
    driving, driven = placed.gears
    points = driven.points[printed.nodes - numbered_bodies(placed.gears)[1].first_node]
    torque = loading.transverse_force * loading.base_radius
    lag = placed.approach + printed.turning
    return FullContactPoint(
        position=position + lag / pair.base_pitch,
        transmission_error=lag,
        status=Status.CONVERGED,
        reason="",
        iterations=run.iterations,
        residual=printed.moment(points, driving.center) / torque - 1.0,
        torque_ratio=abs(printed.moment(points, driven.center)) / torque,
    )


def _failed(run: Run) -> FullContactPoint:
    return FullContactPoint.failed(run.status, run.reason, run.iterations)
