"""The jobs whose cost is measured are such as the service takes, one of every process."""

from contextlib import closing

from named_run import RUN, put_named_run

from benchmarks.worker_cost import orders
from service.queue.machinery import job_machinery
from service.settings import Settings
from service.worker.process import default_registry


def test_every_process_has_an_order_that_its_checks_pass(tmp_path):
    offered, ordered = default_registry(), [*orders()]
    with closing(job_machinery(Settings(data_directory=tmp_path), offered, works=False)) as parts:
        put_named_run(parts.store)
        for _, name, inputs in ordered:
            process, named = offered[name], {"run": RUN} if name == "listen" else {}
            assert process.prepare(process.inputs.model_validate(inputs | named), parts.store)
    assert {name for _, name, _ in ordered} == set(offered)
    assert len({title for title, _, _ in ordered}) == len(ordered)
