"""The request: checked, with the model and the effects that it calls for."""
