"""What the housings of a scene cost beside what was predicted: facts of results, their figures, the table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from lineofaction.gearbox.convert.scene import TabledScene

Json = dict[str, Any]
Result = TypeVar("Result")


def with_housing_costs(compute: Callable[..., Result]) -> Callable[..., Result]:
    """Return the work of a study on a scene as one on a `TabledScene`, with the fact `reduction_cost`."""

    def computed(subject: TabledScene, *means: Any) -> Result:
        result: Any = compute(subject.scene, *means)
        whole: Result = replace(result, facts={**result.facts, "reduction_cost": reduction_costs(subject)})
        return whole

    return computed


def reduction_costs(subject: TabledScene) -> Json:
    """Return the fields of the `WorkCost` of reductions by housing; a file of modes may be without them."""
    return {name: asdict(body.cost) for name, body in subject.housings.items() if body.cost is not None}


def kept_costs(facts: Mapping[str, Any]) -> Json:
    """Return the costs of the reductions by housing; none of results of versions that did not know them."""
    return facts.get("reduction_cost") or {}
