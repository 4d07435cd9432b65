"""What mypy makes of the rows of the registry: `scripts/check` runs it on this file, nothing calls it."""

from pathlib import Path
from typing import assert_type

import lineofaction as loa
from dynamics.linearize import ModalAnalysis
from fe_contact import Ablation as CaseAblation
from fe_contact import AnalysisOptions, SteDatabase, TableAxes, analyze
from lineofaction.client import AsyncJob, AsyncLineOfActionClient, Job, LineOfActionClient
from lineofaction.gearbox.studies.deflect import DeflectFigures
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.studies.modes import ModesFigures
from model_studies.workers import Workers

SCENE = Path("scene.toml")
GEAR = loa.Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
PAIR = loa.GearPair(GEAR, GEAR, 80e-3)


def called(client: LineOfActionClient) -> None:
    """By the subject, the options, the file of the inputs."""
    assert_type(client.modes(SCENE, speed_rpm=[1.0], orders=3), ModalAnalysis)
    assert_type(client.deflect(SCENE), GearboxDeflection)
    assert_type(client.deflect(scene=SCENE, study={}), GearboxDeflection)
    assert_type(client.deflect.submit(SCENE), Job[GearboxDeflection, DeflectFigures])
    assert_type(client.analyze(SCENE), SteDatabase)
    assert isinstance(client.ablate(SCENE), CaseAblation)


def analyzed() -> None:
    """A pair by keywords or by records, a case by its file."""
    assert_type(loa.analyze(PAIR, torques=[100.0], level="draft", cache=Path()), SteDatabase)
    assert_type(loa.analyze(PAIR, TableAxes([100.0]), AnalysisOptions(level="draft")), SteDatabase)
    assert_type(analyze(PAIR, torques=[100.0], tolerance=0.01), SteDatabase)
    assert_type(loa.analyze(SCENE, progress=print), SteDatabase)
    analyze(PAIR, torque=[100.0])  # type: ignore[call-arg]
    analyze(PAIR, torques=[100.0], positions="many")  # type: ignore[arg-type]
    loa.analyze(PAIR, torque=[100.0])  # type: ignore[call-overload]
    loa.analyze(SCENE, torques=[100.0])  # type: ignore[call-overload]


def studied(workers: Workers) -> None:
    """A study by its inputs, by a mapping of them, and with what any study takes."""
    assert_type(loa.modes(SCENE, speed_rpm=[1.0], orders=3), ModalAnalysis)
    assert_type(loa.modes(SCENE, {"speed_rpm": [1.0]}), ModalAnalysis)
    assert_type(loa.modes(SCENE, speed_rpm=[1.0], workers=workers, progress=print), ModalAnalysis)
    assert_type(loa.deflect(SCENE), GearboxDeflection)
    loa.modes(SCENE, speed=[1.0])  # type: ignore[call-overload]
    loa.modes(SCENE, orders="all")  # type: ignore[call-overload]


def read() -> None:
    """A file of a kind, a case or a scene with other values, any file."""
    assert_type(loa.read(SCENE, kind=loa.SteDatabase), SteDatabase)
    assert_type(loa.read(SCENE, {"run.duration_s": 1.0}, kind=loa.Scene), loa.Scene)
    assert_type(loa.read(SCENE, kind=loa.modes), ModalAnalysis)
    assert_type(loa.read(SCENE, kind=loa.deflect), GearboxDeflection)
    assert_type(loa.read(SCENE, {"run.duration_s": 1.0}), loa.Case | loa.Scene)
    content = loa.read(SCENE)
    assert isinstance(content, loa.SteDatabase)
    content.peak_to_peak(torque=100.0)
    content.no_such_field  # type: ignore[attr-defined] # noqa: B018
    loa.read(SCENE).peak_to_peak(torque=100.0)  # type: ignore[union-attr] # of a table alone
    loa.read(SCENE, kind="table")  # type: ignore[call-overload]


def refused(client: LineOfActionClient) -> None:
    """Each by an error that mypy knows; it reports one that is not there."""
    client.modes(SCENE, speed=[1.0])  # type: ignore[call-arg]
    client.modes(SCENE, orders="all")  # type: ignore[arg-type]
    client.response(SCENE)  # type: ignore[call-arg]


async def awaited(client: AsyncLineOfActionClient) -> None:
    """The same rows, awaited."""
    assert_type(await client.modes(SCENE), ModalAnalysis)
    assert_type(await client.modes.submit(SCENE), AsyncJob[ModalAnalysis, ModesFigures])
