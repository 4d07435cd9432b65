"""The main flow: gear pair in, STE database out; and what happens on its flanks."""
