"""Conversion of a REXS model to cases and a scene.

A reader of a value raises `BadInput` with component and attribute: the value is invalid, contradicts others,
or is missing and follows from nothing else. An error in one stage leaves the other stages computable.
"""
