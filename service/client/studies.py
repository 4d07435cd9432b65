"""Studies of cases and scenes by a service: each submits, waits and fetches."""

from __future__ import annotations

from service.client.jobs import JobClient
from service.client.study_method import FORMS, study_method
from service.registry import FORMER, STUDIES


class Studies(JobClient):
    """Studies of cases and scenes by a service: each submits, waits and fetches.

    Each row of `service.registry.STUDIES` has a method for the figures and one for the file. Their types are
    in ``studies.pyi``, which ``scripts/client_studies.py`` writes.
    """


for _study in STUDIES.values():
    for _ending in FORMS:
        setattr(Studies, f"{_study.package}{_ending}", study_method(_study, _ending))
for _former, _name in FORMER.items():
    setattr(Studies, _former, getattr(Studies, _name))
