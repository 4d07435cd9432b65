"""Jobs that cannot end well: each must end in a stated status and leave the service as it was."""
