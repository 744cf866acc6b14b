"""`python -m panokit` is the `panokit` command."""

from panokit.cli.main import main

if __name__ == "__main__":
    raise SystemExit(main())
