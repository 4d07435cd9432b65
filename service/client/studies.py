"""Studies of cases and scenes by a service: each submits, waits and fetches."""

from __future__ import annotations

from service.client.jobs import JobClient
from service.client.study_method import study_method
from service.registry import FORMER, STUDIES


class Studies(JobClient):
    """Studies of cases and scenes by a service: each submits, waits and fetches.

    There is a method for each row of `service.registry.STUDIES`. Their types are in ``studies.pyi``, which
    ``scripts/client_studies.py`` writes.
    """


for _method in map(study_method, STUDIES.values()):
    setattr(Studies, _method.__name__, _method)
for _former, _name in FORMER.items():
    setattr(Studies, _former, getattr(Studies, _name))
