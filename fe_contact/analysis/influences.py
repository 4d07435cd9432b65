"""The influence of every effect of a request at its nominal load: the one source of their sizes."""

from __future__ import annotations

from collections.abc import Iterable

from fe_contact.analysis.request import Checked
from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.worth import Influence, Worth, estimate_worth, estimate_worths


def estimated_influences(checked: Checked, names: Iterable[str] | None = None) -> dict[str, Influence | None]:
    """Estimate what leaving each effect out of a request's model changes at its nominal load.

    Parameters
    ----------
    checked : Checked
    names : iterable of str, optional
        Effects; default all.

    Returns
    -------
    dict of str to Influence
        At the highest load and the largest misalignment in size. None where one of the two states cannot be
        had, as a plane with what acts across the face, or the springs do not know it.
    """
    wanted = [effect.name for effect in EFFECTS] if names is None else list(names)
    spared = [name for name in wanted if name in checked.request.spared]
    own = [name for name in wanted if name not in spared]
    worths = estimate_worths(checked.request.scene.at_nominal_load, checked.decided, own, EFFECTS)
    for name in spared:
        scene, decided = checked.judging(name)
        worths[name] = estimate_worth(scene.at_nominal_load, decided, name, EFFECTS)
    asked = checked.request.whole_scene
    return {name: None if worth is None else _influence(worth, asked) for name, worth in worths.items()}


def _influence(worth: Worth, scene: ContactScene) -> Influence:
    """Return an estimate at the nominal load of a scene."""
    changes = (worth.mean, worth.peak_to_peak, worth.whole.mean, worth.whole.peak_to_peak)
    torque, misalignment = float(scene.torque[-1]), scene.largest_misalignment
    return Influence(torque, misalignment, *(float(values[-1]) for values in changes))
