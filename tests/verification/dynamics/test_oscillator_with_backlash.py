"""One freedom with backlash: rms of the response against converged numbers, both branches.

x'' + 2 z x' + f(x) = Fm + Fa W^2 cos W t, f = x - 1 above 1, x + 1 below -1, else 0, z 0.05,
Fm 0.1, Fa 0.05; the rms values were converged independently to the digits given. The driven gear on a mesh
of stiffness k with a kinematic error e = A cos W t is this oscillator in x - 1 = (d - e) per unit, for
damping to the ground: (d - e)'' + 2 z (d - e)' + f = Fm - e'' - 2 z e', and the right-hand side is a cosine
of amplitude A W sqrt(W^2 + 4 z^2), wanted to be Fa W^2.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import spring_table

from dynamics.bodies import GearBody, Inertia, Shaft, TimeLaw
from dynamics.forces import CoastFlank, GearMesh, LoadTorque
from dynamics.integrators import integrate, static_equilibrium
from dynamics.joints import ImposedRotation
from dynamics.system import Integration, Outputs, Scene
from dynamics.system.assemble import assemble

ZETA, MEAN, AMPLITUDE = 0.05, 0.1, 0.05
PERIODS, SAMPLES = 260, 64
# frequency: rms of the AC part after an up-sweep, after a down-sweep
CONVERGED = {
    0.5: (0.011759, 0.011759),
    0.7: (0.033653, 0.033653),
    0.75: (0.044803, 0.224724),
    0.8: (0.061357, 0.202258),
    0.85: (0.181301, 0.181301),
    1.0: (0.133083, 0.133083),
    1.2: (0.094212, 0.094212),
    1.6: (0.057716, 0.057716),
}


def oscillator(frequency):
    """Unit mass and stiffness: base radius 1 m, inertia 1 kg m^2, one tooth's pitch per period."""
    excitation = AMPLITUDE * frequency / np.hypot(frequency, 2.0 * ZETA)
    table = spring_table(1.0, excitation, positions=256)
    back = CoastFlank(2.0, 0.0, spring_table(1.0, -excitation, positions=256))
    teeth = 20
    gears = tuple(
        GearBody(f"g{k}", f"s{k}", 0.5, teeth, 1.0, 0.1, 0.0, Inertia(1.0, 1.0, 1.0)) for k in range(2)
    )
    shafts = (Shaft("s0", 1.0), Shaft("s1", 1.0, (2.2, 0.0, 0.0)))
    speed = frequency / teeth
    rate = SAMPLES * frequency / (2.0 * np.pi)
    scene = Scene(
        shafts,
        gears,
        (GearMesh("m", "g0", "g1", table, damping=0.0, coast=back),),
        (ImposedRotation("d", "s0", TimeLaw.constant(speed)),),
        duration=PERIODS * 2.0 * np.pi / frequency,
        loads=(LoadTorque("l", "s1", TimeLaw.constant(MEAN)),),
        outputs=Outputs(sample_rate=rate, energy_audit=False),
        integration=Integration(tolerance=1e-6, largest_step=1.0),
    )
    system = assemble(scene)
    return replace(system, arrays=system.arrays._replace(damping=np.array([[2.0 * ZETA]])))


def settled_rms(frequency, state):
    """rms of d - e over the last periods, and the state (q, v) to go on with at the same phase."""
    system = oscillator(frequency)
    start = static_equilibrium(system)
    if state is not None:
        start = replace(start, displacement=state[0])
    run = integrate(system, start, system.scene.integration, velocity=None if state is None else state[1])
    phase = 2.0 * np.pi * np.arange(run.time.size) / SAMPLES
    excitation = AMPLITUDE * frequency / np.hypot(frequency, 2.0 * ZETA)
    deflection = run.q @ system.arrays.direction[0] - excitation * np.cos(phase)
    last = deflection[-20 * SAMPLES :]
    whole = (run.time.size - 1) // SAMPLES * SAMPLES
    return float(np.std(last)), (run.q[whole].copy(), run.v[whole].copy())


def sweep(frequencies):
    """Response at each frequency, started from the state left by the one before."""
    found, state = {}, None
    for frequency in frequencies:
        found[frequency], state = settled_rms(frequency, state)
    return found


@pytest.mark.parametrize("branch", [0, 1], ids=["up", "down"])
def test_both_branches_of_the_response(branch, record_figure):
    order = sorted(CONVERGED) if branch == 0 else sorted(CONVERGED, reverse=True)
    found = sweep(order)
    errors = {w: found[w] / CONVERGED[w][branch] - 1.0 for w in order}
    worst = max(map(abs, errors.values()))
    name = f"oscillator with backlash, rms, {'up' if branch == 0 else 'down'}-sweep, worst"
    record_figure(name, 100.0 * worst, "at most 0.5 %", "%", "converged numbers")
    assert worst < 0.005, errors


@pytest.mark.parametrize(
    ("path", "jump", "falls"),
    [((0.75, 0.8), 0.8285, False), ((0.85, 0.75), 0.7080, True)],
    ids=["up", "down"],
)
def test_the_response_jumps_where_its_branch_ends(path, jump, falls):
    """Just before the converged frequency it stays on its branch, 0.003 behind it is on the other."""
    state = None
    for frequency in path:
        _, state = settled_rms(frequency, state)
    step = -0.003 if falls else 0.003
    before, state = settled_rms(jump - step, state)
    behind, _ = settled_rms(jump + step, state)
    assert (before > 0.15) is falls
    assert (behind > 0.15) is not falls
