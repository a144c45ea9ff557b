"""`python -m pioneer3` and the `pioneer3` and `p3` commands."""

from pioneer3.cli.main import main

if __name__ == "__main__":
    main()
