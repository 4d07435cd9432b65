"""``python -m service.cli`` is ``loa``."""

from service.cli.commands import main

if __name__ == "__main__":
    main()
