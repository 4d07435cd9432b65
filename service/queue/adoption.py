"""Computations that an older version of the program entered are named anew; those of a newer one are left.

The name of a result holds the version of the program that makes it. During an upgrade servers and schedulers
of two versions share the job table: a scheduler that ran the other's computation as it stands would store its
own result under the other's name.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

import structlog

from lineofaction.gearbox.problems import BadInput, NoSuchProcess
from lineofaction.gearbox.schemas.reading import validated
from service.queue.claims import Claim, Claims
from service.store import ResultStore
from service.worker.process import Registry

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class Adoption:
    """Makes claimed computations of older programs this program's.

    Attributes
    ----------
    claims : Claims
    registry : Registry
    store : ResultStore
        To look up what the inputs name.
    workspaces : Path
        Folder of the workspaces: what the older program left of such a computation is of no use.
    """

    claims: Claims
    registry: Registry
    store: ResultStore
    workspaces: Path

    def adopted(self, claim: Claim) -> Claim | None:
        """Return a claim to run: this one, or with the inputs and the name that this program gives its work.

        None: another computation in flight is the same work, and its jobs wait for that; or the inputs are no
        longer accepted, and the computation has failed.
        """
        if claim.program == self.claims.program:
            return claim
        shutil.rmtree(self.workspaces / claim.id, ignore_errors=True)
        try:
            process, store = self.registry[claim.process], self.store.within(claim.project)
            inputs = process.prepare(validated(process.inputs, claim.inputs), store)
        except (BadInput, NoSuchProcess) as error:
            text = f"Version {self.claims.program} of the program refuses this job of an older one. {error}"
            self.claims.fail(claim, text, [fault.as_json() for fault in error.faults])
            return None
        adopted = self.claims.adopt(claim, process.key(inputs), inputs)
        facts = {"computation": claim.id, "entered_by": claim.program, "former_key": claim.key}
        logger.info("computation adopted", **facts, key=process.key(inputs), merged=adopted is None)
        return adopted
