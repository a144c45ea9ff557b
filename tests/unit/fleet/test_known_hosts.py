"""The list of host keys is written as `ssh` writes it."""

import shutil
import subprocess
from pathlib import Path

import pytest

from pioneer3.fleet.key import hashed, hashes_names, remember

KEY = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIJQ0LQn7JEmGYlYx0ulUSvVGhxvxUPZkyBcHgX2nX2eO"


def test_names_stay_in_the_clear_where_they_are(tmp_path: Path) -> None:
    path = tmp_path / ".ssh/known_hosts"
    path.parent.mkdir()
    path.write_text(f"other {KEY}")
    remember(path, ("p3at-1", "p3at-1", "192.168.1.111"), f"{KEY} comment")
    assert path.read_text() == f"other {KEY}\np3at-1,192.168.1.111 {KEY}\n"


@pytest.mark.skipif(shutil.which("ssh-keygen") is None, reason="no ssh-keygen here")
def test_hashed_names_are_found_by_ssh_itself(tmp_path: Path) -> None:
    path = tmp_path / "known_hosts"
    path.write_text(f"# mine\n{hashed('other')} {KEY}\n")
    assert hashes_names(path.read_text())
    remember(path, ("p3at-1", "192.168.1.111"), KEY)
    assert "p3at-1" not in path.read_text()
    for name in ("p3at-1", "192.168.1.111", "other"):
        found = subprocess.run(
            ["ssh-keygen", "-F", name, "-f", path], capture_output=True, text=True, check=False
        )
        assert KEY in found.stdout, name


def test_a_known_hash() -> None:
    salt = bytes(range(20))
    assert hashed("host", salt) == hashed("host", salt)
    assert hashed("host", salt).startswith("|1|AAECAwQFBgcICQoLDA0ODxAREhM=|")
