"""The two tiers of tests: `scripts/test` runs the quick one, `scripts/test --all` all there is.

A test is quick or thorough by what it finds. Quick are all tests of units, all about safety, and of
each outer level the few that prove its joint. A parameter set may have the marker `thorough` too.
"""

import ast
import subprocess
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from zlib import crc32

import pytest

ROOT = Path(__file__).parents[1]
SHARES = 4
"""Runs of a share until each thorough test has had its turn."""
COMMITS = 20
"""What these last commits changed is tested in each share."""


@dataclass(frozen=True)
class Part:
    """The quick part of a folder or file.

    Attributes:
        reason: Why this part.
        quick: The tests of a file that are quick, each with what it proves; `None` for all there
            is in a file or folder.
        packages: Packages that its tests reach by commands, so that no import shows them.
    """

    reason: str
    quick: Mapping[str, str] | None = None
    packages: tuple[str, ...] = ()

    def has(self, test: str) -> bool:
        """Return whether a test, such as `test_a[1]`, is quick."""
        return self.quick is None or any(_is_below(test, name) for name in self.quick)


NONE: Mapping[str, str] = {}
PARTS: Mapping[str, Part] = {
    "tests/unit": Part("values in, values out: cheap, and the first to find a fault"),
    "tests/property": Part("codecs, kernels and limits against oracles, by a quarter of examples"),
    "tests/conformance": Part("frames and sessions that were recorded and captured"),
    "tests/architecture": Part("layers, names and pages"),
    "tests/architecture/test_distribution.py": Part(
        "building packages takes long",
        {"test_the_wheel_holds_all_of_the_package_and_nothing_else": "a file that was forgotten"},
    ),
    "tests/examples": Part("programs and words that people copy"),
    "tests/e2e": Part("the driver against the firmware over faulty cables, in virtual time"),
    "tests/e2e/test_together.py": Part(
        "groups drive for long",
        {
            "test_a_leader_that_stops_suddenly_is_not_run_into": "safety",
            "test_a_robot_that_dies_on_the_way_stops_nobody_else_and_is_not_touched": "safety",
            "test_followers_of_a_leader_that_is_lost_stand_and_give_up": "safety",
        },
    ),
    "tests/e2e/test_traffic.py": Part(
        "robots that make way for each other",
        {"test_two_robots_that_meet_in_a_door_let_each_other_pass": "the joint"},
    ),
    "tests/e2e/test_follow.py": Part(
        "people who walk for long",
        {
            "test_tracking_keeps_the_person": "the joint",
            "test_nobody_is_touched_however_slow_the_link": "safety",
            "test_it_stands_still_before_somebody_who_does": "safety",
        },
    ),
    "tests/e2e/test_wander.py": Part("it drives for long", {"test_it_meets_nothing": "safety"}),
    "tests/e2e/test_lasers.py": Part(
        "a driver and units at all their speeds",
        {
            "test_a_laser_scans_soon_and_at_its_own_rate": "the joint",
            "test_a_laser_that_is_back_scans_again": "a lost link",
            "test_a_robot_in_the_place_of_the_laser_is_left_alone": "safety",
            "test_leaving_ends_the_scans": "a way out",
        },
    ),
    "tests/e2e/test_map_build.py": Part(
        "robots that explore for long",
        {
            "test_a_stop_ends_the_exploration_also_while_it_looks_for_the_next_edge": "safety",
            "test_a_map_grows_while_a_program_drives": "the joint",
            "test_what_is_saved_is_read_again_as_it_was": "files",
            "test_a_map_is_saved_whatever_ends_it": "a way out",
        },
    ),
    "tests/e2e/test_navigation.py": Part(
        "robots that drive for long",
        {
            "test_it_drives_to_the_kitchen_by_name": "the joint",
            "test_a_robot_that_is_not_sure_where_it_is_does_not_go": "safety",
            "test_a_robot_that_was_carried_away_stops": "safety",
            "test_a_stop_ends_the_drive": "safety",
            "test_hands_on_the_stick_come_first": "safety",
            "test_a_laser_that_falls_silent_leaves_the_robot_standing": "safety",
        },
    ),
    "tests/e2e/test_simulated_time.py": Part(
        "worlds that are faster than hosts",
        {
            "test_the_same_bytes_at_the_same_ticks_give_the_same_bytes_at_any_pace": "the joint",
            "test_the_watchdog_counts_the_hosts_seconds_when_time_is_fast": "safety",
            "test_lock_step_waits_for_the_slowest_host": "the joint",
        },
    ),
    "tests/e2e/test_soak.py": Part("what only hours and many visits show", NONE),
    "tests/e2e/test_hostile_api.py": Part("thousands of requests", NONE, packages=("web",)),
    "tests/browser": Part("the real page in Chromium", NONE, packages=("web",)),
    "tests/browser/test_page.py": Part(
        "the page drives and stops",
        {
            "test_a_held_arrow_moves_and_letting_go_stops_within_300_ms": "it drives by keys",
            "test_space_stops_while_an_arrow_is_still_held": "it stops",
            "test_the_emergency_stop_latches_until_it_is_reset": "it stops all",
        },
        packages=("web",),
    ),
    "tests/ros1": Part("the real middleware of ROS 1 and its tools", NONE, packages=("ros",)),
    "tests/ros2": Part("nodes as processes on real DDS and Zenoh", NONE, packages=("ros",)),
    "tests/fleet": Part("computers with an sshd each", NONE, packages=("fleet", "bridge")),
}
"""By folder or file; the longest name that fits counts."""


def part_of(name: str) -> tuple[Part, str]:
    """Return the part to which a file or test belongs, and its name below that.

    Raises:
        KeyError: none; each folder of tests has to be in :data:`PARTS`.
    """
    where = max((each for each in PARTS if _is_below(name, each)), key=len, default="")
    return PARTS[where], name[len(where) :].lstrip("/:")


def is_quick(item: pytest.Item) -> bool:
    """Return whether a test belongs to the quick tier."""
    part, below = part_of(item.nodeid)
    return part.has(below) and item.get_closest_marker("thorough") is None


def may_be_quick(path: Path) -> bool:
    """Return whether a file has quick tests; what has none need not be imported."""
    part, _ = part_of(path.relative_to(ROOT).as_posix())
    return part.quick is None or bool(part.quick)


def _is_below(name: str, folder: str) -> bool:
    return name.startswith(folder) and name[len(folder) : len(folder) + 1] in {"", "/", ":", "["}


def share() -> frozenset[str]:
    """Return the files whose thorough tests have their turn at this commit.

    Those are all that lie near to what changed lately, and a part of the others that goes round.
    """
    turn = int(_git("rev-list", "--count", "HEAD") or 0)
    changed = _git("diff", "--name-only", f"HEAD~{min(COMMITS, turn - 1)}").split()
    files = [path.relative_to(ROOT).as_posix() for path in (ROOT / "tests").rglob("test_*.py")]
    return frozenset(turns(files, changed, turn))


def turns(files: Iterable[str], changed: Collection[str], turn: int) -> Iterator[str]:
    """Yield the test files that are near to what changed, and those whose turn it is."""
    for file in files:
        near = any(_is_below(each, reached) for reached in reach(file) for each in changed)
        if near or crc32(file.encode()) % SHARES == turn % SHARES:
            yield file


def reach(file: str) -> frozenset[str]:
    """Return the files and packages that a file of tests reaches, beginning with itself.

    Those are its folder, what it imports, directly or by other modules of the tests, and what its
    tests run as a command.
    """
    part, _ = part_of(file)
    packages = {f"src/pioneer3/{name}" for name in part.packages}
    return frozenset({file, str(Path(file).parent)} | packages | _imports(ROOT / file))


@cache
def _imports(path: Path) -> frozenset[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not isinstance(node, ast.ImportFrom) or not node.module:
            continue
        first, *rest = node.module.split(".")
        if first == "pioneer3" and rest:
            found.add(f"src/pioneer3/{rest[0]}")
        helper = ROOT.joinpath(*node.module.split(".")).with_suffix(".py")
        if first == "tests" and helper.is_file():
            found |= {helper.relative_to(ROOT).as_posix()} | _imports(helper)
    return frozenset(found)


def _git(*words: str) -> str:
    """Return what git prints; nothing where this is no clone."""
    done = subprocess.run(
        ["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False
    )
    return done.stdout.strip()
