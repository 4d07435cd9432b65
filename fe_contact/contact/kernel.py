"""Decorators of the loops over one contact point, which other loops call.

A kernel allocates nothing: it writes into the arrays that it is given. numba then counts no references to
them. Each count is a locked instruction; with it, the solution of a point takes up to three times as long.
"""

from __future__ import annotations

from host.loops import inner

kernel = inner(error_model="numpy", _nrt=False)
kernel_of_sums = inner(fastmath={"reassoc", "contract"}, _nrt=False)
"""The same for a sum of products that may be taken in any order, as side by side in vector registers."""
