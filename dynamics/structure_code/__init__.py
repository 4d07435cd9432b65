"""Loops written out for the structure of one scene, and the machine code made of them."""
