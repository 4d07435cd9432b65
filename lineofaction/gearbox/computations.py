"""The computation of each study, loaded with its first use.

To load all takes several times as long as any verb needs to start. `FLANK` is `RUN` of
``lineofaction.gearbox.studies.flank.run``, and so on: editors read the types of a study from the imports.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lineofaction.gearbox.studies.ablate.run import RUN as ABLATE
    from lineofaction.gearbox.studies.change.run import RUN as CHANGE
    from lineofaction.gearbox.studies.complaint.run import RUN as COMPLAINT
    from lineofaction.gearbox.studies.deflect.run import RUN as DEFLECT
    from lineofaction.gearbox.studies.elastic_ring.run import RUN as ELASTIC_RING
    from lineofaction.gearbox.studies.flank.run import RUN as FLANK
    from lineofaction.gearbox.studies.force_waves.run import RUN as FORCE_WAVES
    from lineofaction.gearbox.studies.frontier.run import RUN as FRONTIER
    from lineofaction.gearbox.studies.listen.run import RUN as LISTEN
    from lineofaction.gearbox.studies.modes.run import RUN as MODES
    from lineofaction.gearbox.studies.noise.run import RUN as NOISE
    from lineofaction.gearbox.studies.optimize.run import RUN as OPTIMIZE
    from lineofaction.gearbox.studies.response.run import RUN as RESPONSE
    from lineofaction.gearbox.studies.root_stress.run import RUN as ROOT_STRESS
    from lineofaction.gearbox.studies.scatter.run import RUN as SCATTER
    from lineofaction.gearbox.studies.sensitivity.run import RUN as SENSITIVITY
    from lineofaction.gearbox.studies.steady.run import RUN as STEADY
    from lineofaction.gearbox.studies.study.run import RUN as STUDY
    from lineofaction.gearbox.studies.sweep.run import RUN as SWEEP
    from lineofaction.gearbox.studies.vibration.run import RUN as VIBRATION
else:
    from lineofaction.gearbox.loading import load

    def __getattr__(name: str) -> object:
        """Load the computation of a study by its name in capitals."""
        if not name.isupper():
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return load(f"lineofaction.gearbox.studies.{name.lower()}.run:RUN")


__all__ = [
    "ABLATE",
    "CHANGE",
    "COMPLAINT",
    "DEFLECT",
    "ELASTIC_RING",
    "FLANK",
    "FORCE_WAVES",
    "FRONTIER",
    "LISTEN",
    "MODES",
    "NOISE",
    "OPTIMIZE",
    "RESPONSE",
    "ROOT_STRESS",
    "SCATTER",
    "SENSITIVITY",
    "STEADY",
    "STUDY",
    "SWEEP",
    "VIBRATION",
]
