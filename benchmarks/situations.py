"""How robots move with physics and on the plane: run as `python -m benchmarks.situations`.

Prints the table of docs/explanation/physics.md.
"""

from tests.situations import rows

HEAD = ("situation", "P3-AT, physics", "P3-DX, physics", "P3-AT, plane", "P3-DX, plane")


def main() -> int:
    """Print the table."""
    for line in (HEAD, ("---",) * len(HEAD)):
        print("|", " | ".join(line), "|")
    for what, figures in rows():
        print("|", " | ".join((what, *figures)), "|", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
