"""One freedom with backlash as a gear pair, and its converged response, for the tests of dynamics.

x'' + 2 z x' + f(x) = Fm + Fa W^2 cos W t, f = x - 1 above 1, x + 1 below -1, else 0, z 0.05,
Fm 0.1, Fa 0.05; the rms values were converged independently to the digits given. The driven gear on a mesh
of stiffness k with a kinematic error e = A cos W t is this oscillator in x - 1 = (d - e) per unit, for
damping to the ground: (d - e)'' + 2 z (d - e)' + f = Fm - e'' - 2 z e', and the right-hand side is a cosine
of amplitude A W sqrt(W^2 + 4 z^2), wanted to be Fa W^2.
"""

from dataclasses import replace

import numpy as np
from geared_scenes import spring_table

from dynamics.assembly.assemble import assemble
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import GearBody, Inertia, Shaft

ZETA, MEAN, AMPLITUDE = 0.05, 0.1, 0.05
TEETH, SAMPLES = 20, 64
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


def excitation(frequency):
    """Amplitude of the kinematic error that makes the force Fa W^2."""
    return AMPLITUDE * frequency / np.hypot(frequency, 2.0 * ZETA)


def oscillator(frequency, periods=260):
    """Unit mass and stiffness: base radius 1 m, inertia 1 kg m^2, one tooth's pitch per period."""
    table = spring_table(1.0, excitation(frequency), positions=256)
    back = CoastFlank(2.0, 0.0, spring_table(1.0, -excitation(frequency), positions=256))
    gears = tuple(
        GearBody(f"g{k}", f"s{k}", 0.5, TEETH, 1.0, 0.1, 0.0, Inertia(1.0, 1.0, 1.0)) for k in range(2)
    )
    shafts = (Shaft("s0", 1.0), Shaft("s1", 1.0, (2.2, 0.0, 0.0)))
    speed = frequency / TEETH
    rate = SAMPLES * frequency / (2.0 * np.pi)
    scene = Scene(
        shafts,
        gears,
        (GearMesh("m", "g0", "g1", table, damping=0.0, coast=back),),
        (ImposedRotation("d", "s0", TimeLaw.constant(speed)),),
        duration=periods * 2.0 * np.pi / frequency,
        loads=(LoadTorque("l", "s1", TimeLaw.constant(MEAN)),),
        outputs=Outputs(sample_rate=rate, energy_audit=False),
        integration=Integration(tolerance=1e-6, largest_step=1.0),
    )
    system = assemble(scene)
    return replace(system, arrays=system.arrays.with_matrices(damping=np.array([[2.0 * ZETA]])))
