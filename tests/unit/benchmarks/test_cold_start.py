"""Time of imports, from the record that Python keeps of them."""

from benchmarks.cold_start import own_microseconds

RECORD = """\
import time: self [us] | cumulative | imported package
import time:       120 |        120 |   zipimport
a line of the program, import time: 7 | 8
import time:       300 |        420 | site
"""


def test_every_module_counts_what_it_took_by_itself():
    assert [own_microseconds(line) for line in RECORD.splitlines()] == [0, 120, 0, 300]
