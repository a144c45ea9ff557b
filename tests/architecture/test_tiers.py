"""The tiers of tests: each test is in one, and each name in the table is that of a test."""

from pathlib import Path

import pytest

from tests.tiers import MISNAMED, PARTS, ROOT, SHARES, part_of, reach, turns

FILES = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "tests").rglob("test_*.py"))


def test_each_file_belongs_to_a_part() -> None:
    for file in FILES:
        part_of(file)


def test_parts_name_what_is_there_and_why() -> None:
    for where, part in PARTS.items():
        assert part.reason
        assert Path(ROOT, where).exists()
        for test, proves in (part.quick or {}).items():
            assert proves, test


def test_what_parts_name_is_there(request: pytest.FixtureRequest) -> None:
    assert request.config.stash[MISNAMED] == []


def test_in_as_many_shares_as_there_are_each_file_has_its_turn() -> None:
    shares = [set(turns(FILES, (), turn)) for turn in range(SHARES)]
    assert set().union(*shares) == set(FILES)
    assert sum(map(len, shares)) == len(FILES)
    assert max(map(len, shares)) < len(FILES) / 2


@pytest.mark.parametrize(
    ("file", "changed"),
    [
        ("tests/ros2/test_node.py", "src/pioneer3/ros/dds/backend.py"),
        ("tests/ros2/test_node.py", "tests/ros2/networks.py"),
        ("tests/browser/test_map.py", "src/pioneer3/web/static/main.js"),
        ("tests/browser/test_map.py", "src/pioneer3/sim/world.py"),
        ("tests/e2e/test_waits.py", "tests/support.py"),
    ],
)
def test_what_changed_has_its_turn_in_each_share(file: str, changed: str) -> None:
    for turn in range(SHARES):
        assert file in turns([file], {changed}, turn)


def test_what_is_far_from_a_change_waits_for_its_turn() -> None:
    assert "src/pioneer3/web" not in reach("tests/ros2/test_node.py")
