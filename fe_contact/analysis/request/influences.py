"""The influence of every effect of a request at its nominal load, from which all results take it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from fe_contact.analysis.request.request import Checked
from fe_contact.effects import ContactScene
from fe_contact.effects.influence.estimate import EstimatedInfluence, estimate_influence, estimate_influences
from fe_contact.effects.influence.influence import Influence

Influences = Mapping[str, Influence | None]


def estimated_influences(checked: Checked, names: Iterable[str] | None = None) -> dict[str, Influence | None]:
    """Estimate the influence of each effect of a request's model at its nominal load.

    Parameters
    ----------
    names : iterable of str, optional
        Effects; default all.

    Returns
    -------
    dict of str to Influence
        Influences at the highest load and the largest misalignment in size. None where the model with or the
        one without the effect does not exist, as a plane with what acts across the face, or where the springs
        of the estimate do not represent the effect.
    """
    chosen = [effect.name for effect in checked.request.registry] if names is None else list(names)
    neglected = [name for name in chosen if name in checked.request.neglected]
    assessed = [name for name in chosen if name not in neglected]
    influences = estimate_influences(checked.request.scene.at_nominal_load, checked.decision, assessed)
    for name in neglected:
        scene, choices = checked.assessing(name)
        influences[name] = estimate_influence(scene.at_nominal_load, choices, name)
    scene = checked.request.complete_scene
    return {
        name: None if influence is None else _influence(influence, scene)
        for name, influence in influences.items()
    }


def _influence(influence: EstimatedInfluence, scene: ContactScene) -> Influence:
    changes = (influence.mean, influence.peak_to_peak, influence.full.mean, influence.full.peak_to_peak)
    torque, misalignment = float(scene.torque[-1]), scene.largest_misalignment
    return Influence(torque, misalignment, *(float(values[-1]) for values in changes))
