"""Files for the computers of students: the line to type, programs with an address, the wheel."""

import base64
import hashlib
import json
import re
import zipfile
from pathlib import Path

from pioneer3.classroom.downloads import HERE, Downloads, lesson_programs
from pioneer3.classroom.wheel import build_wheel
from pioneer3.distribution import own_files, version

NAME = f"pioneer3-{version()}-py3-none-any.whl"
ROBOT = "tcp://192.168.1.20:8103"


def downloads(*wheels: str) -> Downloads:
    named = {name: Path(name) for name in wheels}
    return Downloads(Path("somewhere") / NAME, 8080, named or None)


def test_one_line_installs_the_wheel_from_the_teachers_computer() -> None:
    line = downloads().command("192.168.1.20")
    assert line == f"pip install http://192.168.1.20:8080/{NAME}"


def test_with_a_wheelhouse_no_index_is_asked_and_the_host_is_trusted() -> None:
    words = downloads("numpy.whl").command("[fd00::1]").split()
    assert words[:2] == ["pip", "install"]
    assert "--no-index" in words
    assert words[words.index("--trusted-host") + 1] == "[fd00::1]"
    assert words[words.index("--find-links") + 1] == "http://[fd00::1]:8080/wheels/"


def test_the_page_of_links_names_each_wheel_in_a_way_that_browsers_and_pip_read() -> None:
    page = downloads("a-1+cpu-py3-none-any.whl").links()
    assert re.findall(r'href="(.+?)"', page) == [f"../{NAME}", "a-1%2Bcpu-py3-none-any.whl"]


def test_each_program_of_the_lessons_gets_the_address_of_the_students_robot() -> None:
    names = set(lesson_programs())
    assert {"square.py", "echoes.py", "keep_clear.py", "patrol.py"} <= names
    for name in names:
        text = downloads().program(name, ROBOT)
        assert ROBOT in text
        assert HERE not in text
        if name.endswith(".ipynb"):
            json.loads(text)
        else:
            compile(text, name, "exec")


def test_the_wheel_is_what_runs_here_and_its_record_is_right(tmp_path: Path) -> None:
    path = build_wheel(tmp_path)
    assert path.name == NAME
    with zipfile.ZipFile(path) as wheel:
        names = wheel.namelist()
        about = f"pioneer3-{version()}.dist-info"
        rows = [row.rsplit(",", 2) for row in wheel.read(f"{about}/RECORD").decode().splitlines()]
        for name, digest, size in rows[:-1]:
            data = wheel.read(name)
            sha = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            assert (digest, size) == (f"sha256={sha}", str(len(data)))
    assert [row[0] for row in rows] == names
    assert rows[-1] == [f"{about}/RECORD", "", ""]
    assert {name for name, _ in own_files()} <= set(names)
    assert {f"{about}/{name}" for name in ("METADATA", "WHEEL", "entry_points.txt")} <= set(names)
