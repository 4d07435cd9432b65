"""The ring gear of a planetary stage as an elastic ring on lugs, bolts, a spline or a press fit.

`annulus` is the ring, `ring_support` what holds it, `ring_compliance` its deflection in the meshes of the
planets, `ring_modes` its natural modes, `load_sharing` what the planets carry, and `side_lines` the orders
that a support puts beside the mesh frequency. The ring deflects in its plane.
"""
