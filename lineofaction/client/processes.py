"""The processes of a service, each an attribute of the client."""

from __future__ import annotations

from lineofaction.client.offers import offers
from lineofaction.client.process import Offered
from lineofaction.client.surface import Surface


class Processes(Surface):
    """The processes of a service: call one for its result, `submit` for a job, `map` for many.

    Their types are in ``processes.pyi``, which ``scripts/client_types.py`` writes.
    """


for _offer in offers().values():
    setattr(Processes, _offer.attribute, Offered(_offer))
