"""A wheelhouse is filled once, whole or not at all, and says what it could not get."""

import hashlib
import sys
import threading
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from pioneer3.classroom import wheelhouse
from pioneer3.classroom.wheelhouse import CONTENTS, Wheelhouse
from pioneer3.errors import ConfigError

WHEEL = "numpy-2.0-py3-none-any.whl"
CONTENT = b"a wheel"
UV = f"""\
#!{sys.executable}
import sys
from pathlib import Path
here = Path(__file__).parent
(here / "asked").open("a").write(" ".join(sys.argv) + "\\n")
if "windows" in " ".join(sys.argv):
    sys.exit("error: No solution found when resolving dependencies cause: Because numpy has none.")
answer = here / "answer"
if answer.exists():
    sys.exit(print(answer.read_text()))
print("error: dns error", file=sys.stderr)
sys.exit(2)
"""


class Index:
    """A uv that answers with a wheel of a server on loopback."""

    def __init__(self, folder: Path, url: str) -> None:
        self.folder, self.url = folder, url
        uv = folder / "uv"
        uv.write_text(UV)
        uv.chmod(0o755)
        (folder / WHEEL).write_bytes(CONTENT)
        self.answer(f"{url}/{WHEEL}")

    def answer(self, url: str, content: bytes = CONTENT) -> None:
        """Have uv name this address, for a file of this content."""
        sha256 = hashlib.sha256(content).hexdigest()
        wheel = f'{{ url = "{url}", size = {len(content)}, hashes = {{ sha256 = "{sha256}" }} }}'
        (self.folder / "answer").write_text(f'[[packages]]\nname = "numpy"\nwheels = [{wheel}]\n')

    @property
    def asked(self) -> int:
        """How often uv was run."""
        return len((self.folder / "asked").read_text().splitlines())


@pytest.fixture
def index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Index]:
    folder = tmp_path / "index"
    folder.mkdir()

    class Quiet(SimpleHTTPRequestHandler):
        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments, directory=str(folder))  # type: ignore[arg-type]

        def log_message(self, *_: object) -> None:
            pass

    monkeypatch.setattr(wheelhouse, "PYTHONS", ("3.12",))
    monkeypatch.setattr(
        wheelhouse, "SYSTEMS", {"Linux x86-64": "x86_64-linux", "Windows x86-64": "windows"}
    )
    monkeypatch.setattr(wheelhouse, "find_uv", lambda: str(folder / "uv"))
    with ThreadingHTTPServer(("127.0.0.1", 0), Quiet) as server:
        serving = threading.Thread(target=server.serve_forever, args=(0.01,))
        serving.start()
        yield Index(folder, f"http://127.0.0.1:{server.server_port}")
        server.shutdown()
        serving.join()


def opened(folder: Path, *, stopped: bool = False) -> tuple[dict[str, Path], list[str]]:
    lines: list[str] = []
    return Wheelhouse(folder, lines.append, lambda: stopped).open(), lines


def test_it_is_filled_once_and_then_asks_nobody(index: Index, tmp_path: Path) -> None:
    house = tmp_path / "wheels"
    files, lines = opened(house)
    assert files == {WHEEL: house / WHEEL}
    assert files[WHEEL].read_bytes() == CONTENT
    asked = index.asked
    (index.folder / "answer").unlink()
    again, told = opened(house)
    assert (again, index.asked) == (files, asked)
    assert told == [line for line in lines if line in told]
    assert "  for Linux x86-64 with Python 3.12" in told
    assert "  NOT for Windows x86-64 with Python 3.12: Because numpy has none." in told


def test_a_wheel_that_is_missing_is_loaded_again(index: Index, tmp_path: Path) -> None:
    house = tmp_path / "wheels"
    opened(house)
    (house / WHEEL).unlink()
    assert opened(house)[0].keys() == {WHEEL}


def test_what_was_damaged_on_its_way_is_not_kept(index: Index, tmp_path: Path) -> None:
    index.answer(f"{index.url}/{WHEEL}", b"another")
    with pytest.raises(ConfigError, match=r"numpy-2\.0-py3-none-any\.whl was damaged on its way"):
        opened(tmp_path / "wheels")
    assert list((tmp_path / "wheels").iterdir()) == []


@pytest.mark.parametrize("path", ["/evil.txt", "/.whl", "/a%5cb.whl"])
def test_what_has_no_name_of_a_wheel_is_refused(path: str, index: Index, tmp_path: Path) -> None:
    index.answer(f"{index.url}{path}")
    with pytest.raises(ConfigError, match="its wheel is on no index"):
        opened(tmp_path / "wheels")


def test_only_the_last_part_of_a_path_names_the_file(index: Index, tmp_path: Path) -> None:
    (index.folder / "evil.whl").write_bytes(CONTENT)
    index.answer(f"{index.url}/a%2f..%2fevil.whl")
    assert opened(tmp_path / "wheels")[0] == {"evil.whl": tmp_path / "wheels/evil.whl"}


def test_a_file_of_this_computer_is_no_wheel_of_an_index(index: Index, tmp_path: Path) -> None:
    index.answer(f"file://{index.folder}/{WHEEL}")
    with pytest.raises(ConfigError, match="its wheel is on no index"):
        opened(tmp_path / "wheels")


def test_without_a_network_what_is_there_is_handed_out(index: Index, tmp_path: Path) -> None:
    house = tmp_path / "wheels"
    opened(house)
    (house / CONTENTS).unlink()
    (index.folder / "answer").unlink()
    files, lines = opened(house)
    assert files.keys() == {WHEEL}
    assert lines[1].startswith(
        "WARNING: the wheelhouse is not complete: the package index does not"
    )
    with pytest.raises(ConfigError, match="the package index does not answer: error: dns error"):
        opened(tmp_path / "empty")


def test_a_class_that_is_ended_leaves_it(index: Index, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="it was ended before all wheels were there"):
        opened(tmp_path / "wheels", stopped=True)


def test_without_uv_the_error_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(wheelhouse, "find_uv", lambda: None)
    with pytest.raises(ConfigError, match="needs uv: python -m pip install uv"):
        opened(tmp_path / "wheels")
