"""From a REXS model to cases and a scene.

Whatever reads a value of a file raises `BadInput` that names component and attribute where it is none, is
missing and nothing follows instead, or contradicts others; what a stage raises costs that stage alone.
"""
