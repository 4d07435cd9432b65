"""The studies that the service offers: a row each.

Process, routes, result kind, client method, function, verb, report and example follow from the row and from
the package ``lineofaction.gearbox.studies.NAME``, which is loaded when it is requested: its inputs and its
computation. What it shows is in the file of its name in a subject of `lineofaction.report`.
"""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, Concatenate, Protocol, TypeVar

from lineofaction.gearbox import computations
from lineofaction.gearbox.study import F, P, Q, StudyOf, T, Takes

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.figures import Figures
    from lineofaction.gearbox.subjects import CaseLike, SceneLike, StudyLike

NETCDF = "application/x-netcdf"
JSON = "application/json"
SUFFIX = ".nc"
"""Ending of the files of results, which are netCDF."""
RESULTS = "/v1/results"
"""Path of the results on the service, before the hash of a result."""

__all__ = [
    "ablate",
    "change",
    "complaint",
    "deflect",
    "elastic_ring",
    "flank",
    "force_waves",
    "frontier",
    "listen",
    "modes",
    "noise",
    "optimize",
    "response",
    "root_stress",
    "scatter",
    "sensitivity",
    "steady",
    "study",
    "sweep",
    "vibration",
]
"""The studies as functions of `lineofaction`, by the names that an editor knows."""


T_co = TypeVar("T_co", covariant=True)
F_co = TypeVar("F_co", bound="Figures", covariant=True)


class _Work(Protocol[Q, T_co, F_co]):
    """A `Computation` by the members that determine the types of its study."""

    @property
    def inputs(self) -> Callable[Q, object]: ...
    @property
    def compute(self) -> Callable[..., T_co]: ...
    @property
    def answer(self) -> Callable[..., F_co]: ...


def _case(work: Callable[[], _Work[Q, T, F]]) -> Takes[Concatenate[CaseLike, Q], Q, T, F]:
    return Takes("case", work)


def _scene(work: Callable[[], _Work[Q, T, F]]) -> Takes[Concatenate[SceneLike, Q], Q, T, F]:
    return Takes("scene", work)


def _either(work: Callable[[], _Work[Q, T, F]]) -> Takes[Concatenate[CaseLike | SceneLike, Q], Q, T, F]:
    return Takes("case or scene", work)


def _as(call: Callable[P, None], work: Callable[[], _Work[Q, T, F]]) -> Takes[P, Q, T, F]:
    """Return the arguments of a study with a file of inputs, by the signature of an example function.

    Its first parameter names the subject; the second is the file, optional if it has a default.
    """
    subject, file = signature(call).parameters.values()
    name = subject.name.replace("_", " ")
    return Takes(name, work, from_file=True, bare=file.default is not Parameter.empty)


def _either_perhaps_file(case_or_scene: CaseLike | SceneLike, study: StudyLike = ...) -> None: ...


def _scene_and_file(scene: SceneLike, study: StudyLike) -> None: ...


def _scene_perhaps_file(scene: SceneLike, study: StudyLike = ...) -> None: ...


class Studies:
    """Every study: a function of the class, a process of a client that inherits from it."""

    # positional: arguments and computation, title, name of the command on the page, description, example
    flank = StudyOf(
        _case(lambda: computations.FLANK),
        "Flank pressure",
        "Compute flank pressure",
        "Compute pressure, line load and gap on the flanks at one load: contact pattern and K_Hbeta.",
        "examples/palermo_spur_20_20.toml --torque 100 -o flank.nc",
        group="pair",
        kind="flanks",
        stages=(("compliance", 0.6), ("contact", 0.1), ("errors", 0.3)),
        version="3",
    )
    ablate = StudyOf(
        _either(lambda: computations.ABLATE),
        "Effects",
        "Toggle every effect",
        "Toggle each effect of a case or a scene: what it changes, what was estimated, what it costs.",
        "examples/palermo_spur_20_20.toml -o ablation.png",
        group="trust",
        kind="ablation",
        stages=(("analysis", 0.1), ("ablation", 0.9)),
        version="4",
    )
    frontier = StudyOf(
        _either(lambda: computations.FRONTIER),
        "Accuracy frontier",
        "Run the accuracy study",
        "Study the accuracy of a case (ISO 6336 to fine finite elements) or a scene: error against time.",
        "examples/palermo_spur_20_20.toml -o frontier",
        group="trust",
        kind="frontier",
        stages=(("analysis", 0.1), ("ladder", 0.9)),
        version="4",
        folder="frontier",
    )
    sensitivity = StudyOf(
        _case(lambda: computations.SENSITIVITY),
        "Sensitivity",
        "Study the sensitivity",
        "Vary misalignment and center distance of a case at its highest load: peak-to-peak STE.",
        "examples/sensitivity_wind_turbine.toml -o sensitivity",
        group="design",
        kind="sensitivity",
        stages=(("tables", 1.0),),
        version="4",
        folder="sensitivity",
        further=(".csv",),
        several=True,
    )
    root_stress = StudyOf(
        _case(lambda: computations.ROOT_STRESS),
        "Tooth-root stress",
        "Compute the root stress",
        "Compute the stress of the tooth roots at one load: peaks, where they are, and their history.",
        "examples/palermo_spur_20_20.toml --torque 100 -o root.png",
        group="pair",
        kind="root_stress",
        stages=(("compliance", 0.5), ("contact", 0.1), ("root stress", 0.4)),
        version="3",
        further=(".csv",),
        aliases=("--image",),
    )
    optimize = StudyOf(
        _as(_either_perhaps_file, lambda: computations.OPTIMIZE),
        "Optimize the flanks",
        "Search better flanks",
        "Search flank modifications: of a case with a complaint for the lowest level of its order, of "
        "another case for the least peak-to-peak STE over torques and scatter, of a mesh of a scene for the "
        "least sound.",
        "examples/palermo_spur_20_20.toml examples/optimize_tip_relief.toml -o best",
        group="design",
        kind="optimization",
        stages=(
            ("analysis", 0.05),
            ("compliance", 0.15),
            ("deflection", 0.05),
            ("transfer functions", 0.05),
            ("radiation", 0.05),
            ("search", 0.5),
            ("confirmation", 0.15),
        ),
        version="8",
        folder="optimum",
        further=(".toml",),
    )
    scatter = StudyOf(
        _case(lambda: computations.SCATTER),
        "Tolerances",
        "Draw pairs within tolerances",
        "Draw pairs within tolerances (Monte Carlo): distribution of peak-to-peak STE with confidence "
        "bounds; share of pairs above a limit of an order, what decides, and the cheapest cure.",
        "examples/sensitivity_automotive.toml --samples 400 -o scatter.png",
        group="design",
        kind="scatter",
        stages=(
            ("compliance", 0.2),
            ("first order", 0.1),
            ("samples", 0.5),
            ("sidebands", 0.1),
            ("confirmation", 0.1),
        ),
        version="7",
    )
    sweep = StudyOf(
        _case(lambda: computations.SWEEP),
        "Maps",
        "Map the figures",
        "Map ripple, mesh harmonics, flank pressure and K_Hbeta over one or two of torque, alignment and "
        "flank modifications.",
        "examples/helical_ev_23_67.toml --over torque,tip_relief=0:16:2 -o map.html",
        group="pair",
        kind="sweep",
        stages=(("compliance", 0.4), ("contact", 0.6)),
        version="1",
        further=(".csv",),
    )
    change = StudyOf(
        _as(_scene_and_file, lambda: computations.CHANGE),
        "Change of flanks",
        "Compare the flanks",
        "Compare two flanks of a mesh by what is heard of a scene over one sample of tolerances: levels by "
        "order and load before and after, which pairs get louder, which deviation decides.",
        "scene.toml change.toml -o change.html",
        group="design",
        kind="change",
        stages=(("analysis", 0.2), ("transfer functions", 0.1), ("radiation", 0.1), ("pairs", 0.6)),
        version="4",
    )
    modes = StudyOf(
        _scene(lambda: computations.MODES),
        "Modes",
        "Find the modes",
        "Find natural modes about the loaded equilibrium, whirl modes over speed, and critical speeds.",
        "examples/palermo_scene.toml --speed-rpm 0:15000:250 -o modes.png",
        group="gearbox",
        kind="modes",
        stages=(("analysis", 0.9), ("modes", 0.1)),
        version="5",
    )
    response = StudyOf(
        _scene(lambda: computations.RESPONSE),
        "Forced response",
        "Find the response",
        "Find the linear response to the transmission error over speed: mesh and bearing forces by order.",
        "examples/palermo_scene.toml --speed-rpm 100:6000:25 -o response.png",
        group="gearbox",
        kind="response",
        stages=(("analysis", 0.9), ("response", 0.1)),
        version="3",
    )
    force_waves = StudyOf(
        _as(_scene_and_file, lambda: computations.FORCE_WAVES),
        "Force waves",
        "Find the force waves",
        "Find the force waves of an electric machine at a speed and torque: pressures by order, torque "
        "ripple, pull on the rotor, and the mesh orders that fall together with them.",
        "scene.toml motor.toml -o force_waves.html",
        group="gearbox",
        kind="force_waves",
        stages=(("analysis", 0.95), ("force waves", 0.05)),
        version="1",
        further=(".csv",),
    )
    complaint = StudyOf(
        _either(lambda: computations.COMPLAINT),
        "Complaint",
        "Find what it is",
        "Find which mesh and harmonic a complaint is, what else passes the same frequency, and the modes "
        "within reach.",
        "examples/palermo_scene.toml --frequency-hz 280 --speed-rpm 840 -o complaint.png",
        group="gearbox",
        kind="complaint",
        stages=(("analysis", 0.9), ("modes", 0.1)),
        version="2",
    )
    noise = StudyOf(
        _scene(lambda: computations.NOISE),
        "Noise",
        "Find the sound power",
        "Find the sound power of the housings over speed: dB(A) by order, third octaves, and which order "
        "is loudest where, through which mode, bearing and wall.",
        "scene.toml --speed-rpm 100:6000:25 -o noise.html",
        group="sound",
        kind="noise",
        stages=(
            ("analysis", 0.3),
            ("response", 0.1),
            ("radiation", 0.05),
            ("boundary elements", 0.1),
            ("models", 0.05),
            ("band", 0.2),
            ("sensitivities", 0.2),
        ),
        version="7",
        further=(".vtu",),
        housed=True,
    )
    vibration = StudyOf(
        _scene(lambda: computations.VIBRATION),
        "Vibration of the housing",
        "Find the vibration",
        "Find the vibration of a housing under its bearings over speed: points and surface by order, "
        "contributions, transfer functions, operating deflection.",
        "scene.toml --speed-rpm 500:3000:25 -o deflection.png",
        group="sound",
        kind="vibration",
        stages=(("analysis", 0.9), ("response", 0.1)),
        version="3",
        further=(".csv", ".vtu"),
        housed=True,
    )
    listen = StudyOf(
        _scene(lambda: computations.LISTEN),
        "Sound of a run",
        "Listen to the run",
        "Hear a run through the housings of a scene: sound pressure at a microphone, with level, "
        "loudness and tones, or velocity of a point.",
        "run.nc --scene scene.toml --microphone 40,60,1000 -o run.wav",
        group="sound",
        kind="recording",
        stages=(("radiation", 0.7), ("sound", 0.3)),
        version="2",
        housed=True,
    )
    steady = StudyOf(
        _scene(lambda: computations.STEADY),
        "Steady states",
        "Find the steady states",
        "Find periodic steady states at rising and falling speeds by shooting: stability, jumps, contact.",
        "scene.toml --speed-rpm 11000:13500:100 -o steady.png",
        group="gearbox",
        kind="steady",
        stages=(("analysis", 0.4), ("up", 0.2), ("down", 0.2), ("branch", 0.2)),
        version="3",
    )
    deflect = StudyOf(
        _as(_scene_perhaps_file, lambda: computations.DEFLECT),
        "Deflection",
        "Deflect the gearbox",
        "Deflect a scene under load cases: misalignment of each mesh by cause, K_Hbeta, contact pattern, "
        "transmission error, bearing loads.",
        "examples/flexible_shafts_scene.toml -o deflect",
        group="gearbox",
        kind="deflection",
        stages=(("analysis", 0.5), ("deflection", 0.2), ("flanks", 0.3)),
        version="2",
        folder="deflection",
        further=(".toml",),
    )
    elastic_ring = StudyOf(
        _case(lambda: computations.ELASTIC_RING),
        "Elastic ring gear",
        "Deflect the ring",
        "Deflect the ring gear of a planetary stage on lugs, bolts or a fit: deflection in the meshes, load "
        "sharing, modes, side lines of the mesh order.",
        "examples/internal_gear.toml --lugs 8 --lug-radial-n-per-m 2e8 "
        "--lug-tangential-n-per-m 2e8 -o ring.html",
        group="gearbox",
        kind="elastic_ring",
        stages=(("analysis", 0.8), ("ring", 0.2)),
        further=(".csv",),
        internal=True,
    )
    study = StudyOf(
        _as(_scene_and_file, lambda: computations.STUDY),
        "Many scenes",
        "Run the study",
        "Run many scenes: a grid, a list or a Monte Carlo over anything a scene declares; maps, spread, "
        "what matters, worst cases.",
        "examples/palermo_scene.toml examples/study_torque_speed.toml -o study",
        group="gearbox",
        kind="study",
        stages=(("analysis", 0.2), ("effects", 0.1), ("runs", 0.6), ("worst cases", 0.1)),
        folder="study",
    )


flank = Studies.flank.function
force_waves = Studies.force_waves.function
ablate = Studies.ablate.function
change = Studies.change.function
frontier = Studies.frontier.function
sensitivity = Studies.sensitivity.function
root_stress = Studies.root_stress.function
optimize = Studies.optimize.function
scatter = Studies.scatter.function
sweep = Studies.sweep.function
modes = Studies.modes.function
response = Studies.response.function
complaint = Studies.complaint.function
noise = Studies.noise.function
vibration = Studies.vibration.function
listen = Studies.listen.function
steady = Studies.steady.function
deflect = Studies.deflect.function
elastic_ring = Studies.elastic_ring.function
study = Studies.study.function

STUDIES: dict[str, StudyOf[..., ..., Any, Any]] = {
    row.name: row for row in vars(Studies).values() if isinstance(row, StudyOf)
}
"""Studies by their names."""
FUNCTIONS = {row.package: row.function for row in STUDIES.values()}
"""Functions of the studies by the names of their packages; the list above tells editors the same names."""

RESULT_KINDS = ("database", "run", *(study.kind for study in STUDIES.values()))
"""Kinds of results, by their names in the store and in the results of a job."""


def study_of(kind: str) -> StudyOf[..., ..., Any, Any] | None:
    """Return the study whose results are of a kind, None if no study's are."""
    return next((study for study in STUDIES.values() if study.kind == kind), None)


def studies_of(subject: str) -> tuple[str, ...]:
    """Return the names of the studies of cases, or of scenes."""
    return tuple(study.name for study in STUDIES.values() if study.takes.subject == subject)


def figures_model(kind: str) -> type[Figures]:
    """Return the model of the figures of a kind; the figures of an unknown kind are not declared."""
    from lineofaction.gearbox.schemas.figures import Figures, RunFigures, TableFigures  # noqa: PLC0415 (start-up time)

    study = study_of(kind)
    models: dict[str, type[Figures]] = {"database": TableFigures, "run": RunFigures}
    models |= {} if study is None else {kind: study.answer}
    return models.get(kind, Figures)
