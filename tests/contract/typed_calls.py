"""What mypy makes of the rows of the registry: `scripts/check` runs it on this file, nothing calls it."""

from __future__ import annotations

from pathlib import Path
from typing import assert_type

import lineofaction as loa
from dynamics.linearize import ModalAnalysis
from fe_contact.analysis.studies.ablation import Ablation as CaseAblation
from fe_contact.ste import SteDatabase
from lineofaction.client import AsyncJob, AsyncLineOfActionClient, Job, LineOfActionClient
from lineofaction.gearbox.studies.deflect import DeflectFigures
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.studies.modes import ModesFigures

SCENE = Path("scene.toml")


def called(client: LineOfActionClient) -> None:
    """By the subject, the options, the file of the inputs."""
    assert_type(loa.modes(SCENE, speed_rpm=[1.0]), ModalAnalysis)
    assert_type(client.modes(SCENE, speed_rpm=[1.0], orders=3), ModalAnalysis)
    assert_type(client.deflect(SCENE), GearboxDeflection)
    assert_type(client.deflect(scene=SCENE, study={}), GearboxDeflection)
    assert_type(client.deflect.submit(SCENE), Job[GearboxDeflection, DeflectFigures])
    assert_type(client.analyze(SCENE), SteDatabase)
    assert isinstance(client.ablate(SCENE), CaseAblation)


def refused(client: LineOfActionClient) -> None:
    """Each by an error that mypy knows; it reports one that is not there."""
    client.modes(SCENE, speed=[1.0])  # type: ignore[call-arg]
    client.modes(SCENE, orders="all")  # type: ignore[arg-type]
    client.optimize(SCENE)  # type: ignore[call-arg]


async def awaited(client: AsyncLineOfActionClient) -> None:
    """The same rows, awaited."""
    assert_type(await client.modes(SCENE), ModalAnalysis)
    assert_type(await client.modes.submit(SCENE), AsyncJob[ModalAnalysis, ModesFigures])
