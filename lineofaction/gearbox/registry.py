"""The studies that the service offers: a row each.

Process, routes, result kind, client method, verb, report and example follow from the row and from the package
``lineofaction.gearbox.studies.NAME``, which is loaded when it is requested: its inputs and its `run`.
What it shows is in the file of its name in a subject of `lineofaction.report`.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

from lineofaction.gearbox.loading import LOADING

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.figures import Figures
    from lineofaction.gearbox.schemas.model import BoundaryModel
    from lineofaction.gearbox.studies.computation import Computation

    Work = Computation[Any, Any, Any, Any, Any]

NETCDF = "application/x-netcdf"
JSON = "application/json"


@dataclass(frozen=True)
class Study:
    """A row of the registry.

    Attributes
    ----------
    name : str
        Of package, process, verb and the client's method.
    subject : "case", "scene" or "case or scene"
        What is studied.
    title, action, description : str
        A noun, what the button of the page says, and an imperative sentence of what is done.
    example : str
        Arguments of the verb.
    kind : str
        Kind of the result, which is the process' output too.
    stages : tuple of (str, float)
        Stages of the work, in order, and their shares of the time.
    version : str
        Part of the result's content hash: another one, and stored results are computed again.
    folder : str
        Name of the files, but for their endings, that the verb writes to a folder; empty: it writes one file.
    from_file : bool
        Whether the inputs are a file of the verb and a mapping of the client, rather than options.
    bare : bool
        Whether the file of the inputs may be left out; all of them then have defaults.
    further : tuple of str
        Endings of files that the verb writes beside those of all studies. CSV can be printed too.
    several : bool
        Whether the verb takes several files.
    housed : bool
        Whether it is about a housing, which a scene then has by its solid.
    aliases : tuple of str
        Other names of the verb's option ``--output``.
    """

    name: str
    subject: Literal["case", "scene", "case or scene"]
    title: str
    action: str
    description: str
    example: str
    kind: str
    stages: tuple[tuple[str, float], ...]
    version: str = "2"
    folder: str = ""
    from_file: bool = False
    bare: bool = False
    further: tuple[str, ...] = ()
    several: bool = False
    housed: bool = False
    aliases: tuple[str, ...] = ()

    @property
    def argument(self) -> str:
        """Name of what is studied, as the client's method and the verb have it."""
        return "subject" if self.subject == "case or scene" else self.subject

    @property
    def package(self) -> str:
        """Name of its package, and of what belongs to it in Python."""
        return self.name.replace("-", "_")

    @property
    def endings(self) -> tuple[str, ...]:
        """Endings of the files that the verb writes."""
        return (".nc", ".json", ".png", ".html", *self.further)

    @property
    def inputs(self) -> type[BoundaryModel]:
        """Model of what is varied."""
        inputs: type[BoundaryModel] = self._part("", "Inputs")
        return inputs

    @property
    def run(self) -> Work:
        """Its work."""
        work: Work = self._part(".run", "RUN")
        return work

    @property
    def answer(self) -> type[Figures]:
        """Model of its figures."""
        figures: type[Figures] = self._part("", f"{self.name.title().replace('-', '')}Figures")
        return figures

    def _part(self, module: str, name: str) -> Any:
        """Load a module of the package; return what it offers."""
        with LOADING:
            return getattr(import_module(f"lineofaction.gearbox.studies.{self.package}{module}"), name)


STUDIES: dict[str, Study] = {
    study.name: study
    for study in (
        Study(
            "flank",
            "case",
            "Flank pressure",
            "Compute flank pressure",
            "Compute pressure, line load and gap on the flanks at one load: contact pattern and K_Hbeta.",
            "examples/palermo_spur_20_20.toml --torque 100 -o flank.nc",
            kind="flanks",
            stages=(("compliance", 0.9), ("contact", 0.1)),
            version="3",
        ),
        Study(
            "ablate",
            "case or scene",
            "Effects",
            "Toggle every effect",
            "Toggle each effect of a case or a scene: what it changes, what was estimated, what it costs.",
            "examples/palermo_spur_20_20.toml -o ablation.png",
            kind="ablation",
            stages=(("analysis", 0.1), ("ablation", 0.9)),
            version="4",
        ),
        Study(
            "frontier",
            "case or scene",
            "Accuracy frontier",
            "Run the accuracy study",
            "Study the accuracy of a case (ISO 6336 to fine finite elements) or a scene: error against time.",
            "examples/palermo_spur_20_20.toml -o frontier",
            kind="frontier",
            stages=(("analysis", 0.1), ("ladder", 0.9)),
            version="4",
            folder="frontier",
        ),
        Study(
            "sensitivity",
            "case",
            "Sensitivity",
            "Study the sensitivity",
            "Vary misalignment and center distance of a case at its highest load: peak-to-peak STE.",
            "examples/sensitivity_wind_turbine.toml -o sensitivity",
            kind="sensitivity",
            stages=(("tables", 1.0),),
            version="3",
            folder="sensitivity",
            further=(".csv",),
            several=True,
        ),
        Study(
            "root-stress",
            "case",
            "Tooth-root stress",
            "Compute the root stress",
            "Compute the stress of the tooth roots at one load: peaks, where they are, and their history.",
            "examples/palermo_spur_20_20.toml --torque 100 -o root.png",
            kind="root_stress",
            stages=(("compliance", 0.5), ("contact", 0.1), ("root stress", 0.4)),
            version="3",
            further=(".csv",),
            aliases=("--image",),
        ),
        Study(
            "optimize",
            "case",
            "Optimize the flanks",
            "Search better flanks",
            "Choose flank modifications for the least peak-to-peak STE over torques and scatter.",
            "examples/palermo_spur_20_20.toml examples/optimize_tip_relief.toml -o best",
            kind="optimization",
            stages=(("compliance", 0.2), ("search", 0.6), ("confirmation", 0.2)),
            version="4",
            folder="optimum",
            from_file=True,
            further=(".toml",),
        ),
        Study(
            "scatter",
            "case",
            "Tolerances",
            "Draw pairs within tolerances",
            "Draw pairs within tolerances (Monte Carlo): distribution of peak-to-peak STE with confidence "
            "bounds.",
            "examples/sensitivity_automotive.toml --samples 400 -o scatter.png",
            kind="scatter",
            stages=(("compliance", 0.2), ("samples", 0.7), ("confirmation", 0.1)),
            version="3",
        ),
        Study(
            "sweep",
            "case",
            "Maps",
            "Map the figures",
            "Map ripple, mesh harmonics, flank pressure and K_Hbeta over one or two of torque, alignment and "
            "flank modifications.",
            "examples/helical_ev_23_67.toml --over torque,tip_relief=0:16:2 -o map.html",
            kind="sweep",
            stages=(("compliance", 0.4), ("contact", 0.6)),
            version="1",
            further=(".csv",),
        ),
        Study(
            "modes",
            "scene",
            "Modes",
            "Find the modes",
            "Find natural modes about the loaded equilibrium, whirl modes over speed, and critical speeds.",
            "examples/palermo_scene.toml --speed-rpm 0:15000:250 -o modes.png",
            kind="modes",
            stages=(("analysis", 0.9), ("modes", 0.1)),
            version="3",
        ),
        Study(
            "response",
            "scene",
            "Forced response",
            "Find the response",
            "Find the linear response to the transmission error over speed: mesh and bearing forces by "
            "order.",
            "examples/palermo_scene.toml --speed-rpm 100:6000:25 -o response.png",
            kind="response",
            stages=(("analysis", 0.9), ("response", 0.1)),
            version="3",
        ),
        Study(
            "noise",
            "scene",
            "Noise",
            "Find the sound power",
            "Find the sound power of the housings over speed: dB(A) by order, third octaves, and which order "
            "is loudest where, through which mode, bearing and wall.",
            "scene.toml --speed-rpm 100:6000:25 -o noise.html",
            kind="noise",
            stages=(
                ("analysis", 0.3),
                ("response", 0.1),
                ("radiation", 0.05),
                ("models", 0.05),
                ("boundary elements", 0.1),
                ("band", 0.2),
                ("sensitivities", 0.2),
            ),
            version="5",
            further=(".vtu",),
            housed=True,
        ),
        Study(
            "vibration",
            "scene",
            "Vibration of the housing",
            "Find the vibration",
            "Find the vibration of a housing under its bearings over speed: points and surface by order, "
            "contributions, transfer functions, operating deflection.",
            "scene.toml --speed-rpm 500:3000:25 -o deflection.png",
            kind="vibration",
            stages=(("analysis", 0.9), ("response", 0.1)),
            version="3",
            further=(".csv", ".vtu"),
            housed=True,
        ),
        Study(
            "listen",
            "scene",
            "Sound of a run",
            "Listen to the run",
            "Hear a run through the housings of a scene: sound pressure at a microphone, with level, "
            "loudness and tones, or velocity of a point.",
            "run.nc --scene scene.toml --microphone 40,60,1000 -o run.wav",
            kind="recording",
            stages=(("sound", 1.0),),
            version="1",
            housed=True,
        ),
        Study(
            "steady",
            "scene",
            "Steady states",
            "Find the steady states",
            "Find periodic steady states at rising and falling speeds by shooting: stability, jumps, "
            "contact.",
            "scene.toml --speed-rpm 11000:13500:100 -o steady.png",
            kind="steady",
            stages=(("analysis", 0.4), ("up", 0.2), ("down", 0.2), ("branch", 0.2)),
            version="3",
        ),
        Study(
            "deflect",
            "scene",
            "Deflection",
            "Deflect the gearbox",
            "Deflect a scene under load cases: misalignment of each mesh by cause, K_Hbeta, contact pattern, "
            "transmission error, bearing loads.",
            "examples/flexible_shafts_scene.toml -o deflect",
            kind="deflection",
            stages=(("analysis", 0.5), ("deflection", 0.2), ("flanks", 0.3)),
            version="2",
            folder="deflection",
            from_file=True,
            bare=True,
            further=(".toml",),
        ),
        Study(
            "study",
            "scene",
            "Many scenes",
            "Run the study",
            "Run many scenes: a grid, a list or a Monte Carlo over anything a scene declares; maps, spread, "
            "what matters, worst cases.",
            "examples/palermo_scene.toml examples/study_torque_speed.toml -o study",
            kind="study",
            stages=(("analysis", 0.2), ("runs", 0.7), ("worst cases", 0.1)),
            folder="study",
            from_file=True,
        ),
    )
}
"""By name."""


def study_of(kind: str) -> Study | None:
    """Return the study whose results are of a kind, None if no study's are."""
    return next((study for study in STUDIES.values() if study.kind == kind), None)


def studies_of(subject: str) -> tuple[str, ...]:
    """Return the names of the studies of cases, or of scenes."""
    return tuple(study.name for study in STUDIES.values() if study.subject == subject)
