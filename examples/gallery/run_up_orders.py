"""
Which order is loud in a run-up?
================================

Overall level and mesh orders of a bearing force. ``loa.simulate("scene.toml")`` runs it in time.
"""

import lineofaction as loa

run = loa.read("results/run_up.nc", kind=loa.RunResult)
run.plot("levels")
print(run)
