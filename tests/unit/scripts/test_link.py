"""`scripts/setup --link` and what the set-up says to type next."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SETUP = Path(__file__).parents[3] / "scripts/setup"
UV = """\
#!/bin/sh
mkdir -p .venv/bin
touch .venv/bin/python
"""


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """Return a copy of the project with a uv that sets up nothing, and an empty home."""
    folder = tmp_path / "a clone"
    (folder / "scripts").mkdir(parents=True)
    (folder / "home/.local/bin").mkdir(parents=True)
    shutil.copy(SETUP, folder / "scripts/setup")
    for name in ("pyproject.toml", "uv.lock"):
        (folder / name).write_text("something\n")
    uv = folder / "home/.local/bin/uv"
    uv.write_text(UV)
    uv.chmod(0o755)
    return folder


def set_up(clone: Path, *words: str, path: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", clone / "scripts/setup", *words],
        env={**os.environ, "HOME": str(clone / "home"), "PATH": f"{path}/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_set_up_ends_with_what_to_type_next(clone: Path) -> None:
    told = set_up(clone).stderr
    assert f"source {str(clone).replace(' ', chr(92) + ' ')}/.venv/bin/activate\n" in told
    assert told.endswith("/scripts/setup --link\n")
    assert set_up(clone).stderr == ""  # the second time all is there


def test_links_are_made_once_and_lead_here(clone: Path) -> None:
    folder = clone / "home/.local/bin"
    for _ in range(2):
        done = set_up(clone, "--link", path=f"{folder}:")
        assert (done.returncode, done.stderr.splitlines()[-1]) == (0, "Type: pioneer3 --help")
    for name in ("pioneer3", "p3"):
        assert (folder / name).readlink() == clone / ".venv/bin" / name


def test_a_folder_that_is_not_on_the_path_is_told(clone: Path) -> None:
    told = set_up(clone, "--link").stderr
    assert f"{clone}/home/.local/bin is not on your PATH" in told
    assert 'export PATH="$HOME/.local/bin:$PATH"' in told


@pytest.mark.parametrize("name", ["pioneer3", "p3"])
def test_what_somebody_else_put_there_stays(name: str, clone: Path) -> None:
    folder = clone / "home/.local/bin"
    (folder / name).write_text("mine\n")
    done = set_up(clone, "--link")
    assert done.returncode == 1
    assert f"{folder}/{name} is there already, and not from here" in done.stderr
    assert (folder / name).read_text() == "mine\n"
    assert {path.name for path in folder.iterdir()} == {"uv", name}


def test_a_wrong_word_shows_the_usage(clone: Path) -> None:
    done = set_up(clone, "--lnik")
    assert done.returncode == 2
    assert "Usage: scripts/setup" in done.stderr
