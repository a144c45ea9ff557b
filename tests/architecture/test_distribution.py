"""What an index gets: the wheel and the source distribution, whole and with words of their own."""

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from email import message_from_bytes
from email.message import Message
from pathlib import Path

import pytest

from pioneer3 import __version__

ROOT = Path(__file__).parents[2]
BUILD = """
import sys, uv_build
print(getattr(uv_build, sys.argv[1])(sys.argv[2]))
"""
FROM_WHEEL = """
import sys
sys.path.insert(0, sys.argv.pop(1))
import pioneer3
assert pioneer3.__file__.startswith(sys.path[0]), pioneer3.__file__
from pioneer3.__main__ import main
main()
"""


def build(what: str, folder: Path) -> Path:
    """Build a `wheel` or an `sdist`; return where it is."""
    bin_ = Path(sys.executable).parent
    done = subprocess.run(
        [sys.executable, "-c", BUILD, f"build_{what}", str(folder)],
        cwd=ROOT,
        env={**os.environ, "PATH": f"{bin_}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=True,
    )
    return folder / done.stdout.split()[-1]


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with nothing but what the wheel installs."""
    folder = tmp_path_factory.mktemp("installed")
    with zipfile.ZipFile(build("wheel", tmp_path_factory.mktemp("dist"))) as wheel:
        wheel.extractall(folder)
    return folder


@pytest.fixture(scope="module")
def metadata(unpacked: Path) -> Message:
    (file,) = unpacked.glob("*.dist-info/METADATA")
    return message_from_bytes(file.read_bytes())


def files_of(folder: Path) -> set[str]:
    found = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)) for path in found if "__pycache__" not in path.parts}


def test_the_wheel_holds_all_of_the_package_and_nothing_else(unpacked: Path) -> None:
    assert files_of(unpacked / "pioneer3") == files_of(ROOT / "src/pioneer3")
    assert len(list(unpacked.iterdir())) == 2
    for pattern in ("web/static/index.html", "maps/office.map", "models/robots.toml"):
        assert [*(unpacked / "pioneer3").glob(pattern)], pattern


def test_the_source_distribution_holds_what_it_takes_to_go_on(tmp_path: Path) -> None:
    with tarfile.open(build("sdist", tmp_path)) as source:
        names = {name.partition("/")[2] for name in source.getnames()}
    wanted = {"README.md", "CHANGELOG.md", "LICENSE", "uv.lock", "scripts/setup", "pyproject.toml"}
    wanted |= {"docs/how-to/drive.md", "examples/01_hello_robot.py", "tests/conftest.py"}
    assert wanted <= names
    assert not [name for name in names if "__pycache__" in name or ".venv" in name]


def test_the_metadata_is_complete_and_the_version_one(metadata: Message) -> None:
    assert metadata["Version"] == __version__
    assert metadata["Author"] == "pioneer3 contributors"
    assert metadata["License-Expression"] == "Apache-2.0"
    assert metadata["Requires-Python"] == ">=3.11"
    assert set(metadata.get_all("Provides-Extra", [])) >= {"fast", "gym"}
    released = re.findall(r"^## \[(\d.*?)\] - \d{4}-\d\d-\d\d$", changelog(), re.MULTILINE)
    assert released[0] == __version__
    assert changelog().index("## [Unreleased]") < changelog().index(f"## [{__version__}]")


def changelog() -> str:
    return (ROOT / "CHANGELOG.md").read_text("utf-8")


def test_what_an_index_shows_links_to_nothing_that_it_cannot_resolve(metadata: Message) -> None:
    text = str(metadata.get_payload())
    assert text.startswith("# pioneer3")
    targets = re.findall(r"\]\(([^)]*)\)|(?:src|href)=\"([^\"]*)\"", text)
    assert [one or other for one, other in targets if not (one or other).startswith("http")] == []


def test_an_index_and_the_readme_show_the_same_program() -> None:
    readme, package = (
        re.findall(r"```python\n(.*?)```", (ROOT / name).read_text("utf-8"), re.DOTALL)
        for name in ("README.md", "docs/package.md")
    )
    assert readme == package


@pytest.mark.realtime
def test_the_wheel_runs_by_itself(unpacked: Path) -> None:
    command = [sys.executable, "-P", "-c", FROM_WHEEL, str(unpacked)]
    done = subprocess.run([*command, "--help"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "─ Start ─" in done.stdout
    shown = subprocess.run([*command, "map", "show", "lab"], capture_output=True, check=False)
    assert shown.returncode == 0
    arguments = ("run", "--sim-port", "0", "--web-port", "0")
    with subprocess.Popen([*command, *arguments], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert "SIMULATOR" in process.stdout.readline()
        process.terminate()
        assert process.wait(timeout=60) == 143
