"""``python -m lineofaction.cli`` is ``loa``."""

from lineofaction.cli.commands import main

if __name__ == "__main__":
    main()
