"""Child processes: their start, the messages between them and their starter, and their end.

`launcher` starts leaders of sessions, anew or forked from a warm process (`fork_server`); `child` sends them
orders and receives their answers, as `frames`. `json_child` runs a program on one request, on every system,
as a member of its starter's group. `environment` is what all of them inherit, `watch` what ends one that
takes too much.
"""
