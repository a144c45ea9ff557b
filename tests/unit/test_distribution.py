"""The way this package was installed, and what an optional part takes there."""

import sys
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from pioneer3 import distribution
from pioneer3.distribution import added_by, how_to_get, own_files, own_metadata


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of an environment that no clone belongs to."""
    monkeypatch.setattr(distribution, "SETUP", tmp_path / "nowhere")
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setattr(sys, "executable", f"{tmp_path}/bin/python")
    return tmp_path


def give_pip(monkeypatch: pytest.MonkeyPatch, *, there: bool) -> None:
    monkeypatch.setattr(distribution, "find_spec", lambda _: object() if there else None)


def test_in_a_clone_the_set_up_brings_every_extra() -> None:
    assert how_to_get("gym").endswith(f"run: {distribution.CLONE}/scripts/setup")


def test_pip_installs_the_packages_of_an_extra(
    installed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    give_pip(monkeypatch, there=True)
    command = f'"{installed}/bin/python" -m pip install "mujoco-core<5,>=4" "pyopengl>=3.1.7"'
    assert how_to_get("physics") == f"the extra `physics` is missing; run: {command}"


def test_an_environment_without_pip_is_one_of_uv(
    installed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    give_pip(monkeypatch, there=False)
    assert f'uv pip install --python "{installed}/bin/python" "gymnas' in how_to_get("gym")


def test_pipx_takes_packages_in_its_own_way(
    installed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    give_pip(monkeypatch, there=True)
    (installed / "pipx_metadata.json").write_text("{}")
    assert 'run: pipx inject pioneer3 "gymnasium>=' in how_to_get("gym")


def test_what_comes_by_itself_makes_the_page_whole() -> None:
    by_itself = {Requirement(line).name for line in distribution.requirements("pioneer3")}
    assert {"numba", "scipy", "zeroconf", "asyncssh", "packaging"} <= by_itself
    named = {Requirement(line).name for extra in ("nav", "fleet") for line in added_by(extra)}
    assert named - by_itself == {"rosbags"}


def test_its_files_are_those_that_run_here() -> None:
    names = {name for name, _ in own_files()}
    assert {"pioneer3/__init__.py", "pioneer3/web/static/index.html"} <= names
    assert not [name for name in names if "__pycache__" in name]
    about = dict(own_metadata())
    assert f"Version: {metadata.version('pioneer3')}\n" in about["METADATA"]
    assert "pioneer3 = pioneer3.__main__:main" in about["entry_points.txt"]
    assert "Apache License" in about["licenses/LICENSE"]
