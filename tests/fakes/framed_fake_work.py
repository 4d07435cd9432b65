"""Work of a child process that answers each order with the same, or leaves."""

import os
import sys

from host.children.frames import read_frame


def work(descriptor: int) -> None:
    """Answer until the orders end."""
    orders = os.fdopen(0, "rb", closefd=False)
    with os.fdopen(descriptor, "wb") as channel:
        while (order := read_frame(orders)) is not None:
            if order.kind == "leave":
                os._exit(int(order.body))
            order.write(channel)


if __name__ == "__main__":
    work(int(sys.argv[1]))
