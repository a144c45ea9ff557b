"""The two tiers of tests: `scripts/test` runs the quick one, `scripts/test --all` all there is.

A test is quick or thorough by what it finds. Quick are all tests of units, all about safety, and of
each outer level the few that prove its joint. A test or a set of its parameters may have the marker
`thorough` too.
"""

import re
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
IMPORT = re.compile(r"^\s*from ((?:pioneer3|tests)[\w.]*) import ", re.MULTILINE)
"""A module that a test imports from: parsing all tests takes 5 s."""


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
    "tests/unit/web/test_map_update.py": Part(
        "a robot that drives past all that has changed",
        {
            "test_the_page_shows_what_has_changed_and_asks_before_the_map_is_replaced": "the joint",
            "test_only_who_has_control_decides": "who may",
        },
    ),
    "tests/property": Part("codecs, kernels and limits against oracles, by a quarter of examples"),
    "tests/conformance": Part("frames and sessions that were recorded and captured"),
    "tests/architecture": Part("layers, names and pages"),
    "tests/architecture/test_distribution.py": Part(
        "building packages takes long",
        {"test_the_wheel_holds_all_of_the_package_and_nothing_else": "a file that was forgotten"},
    ),
    "tests/examples": Part("programs and words that people copy"),
    "tests/examples/test_lessons.py": Part(
        "each lesson drives for long; the examples beside them drive in the same way",
        {"test_the_programs_are_short": "words"},
    ),
    "tests/examples/test_from_aria.py": Part(
        "programs that drive for long",
        {
            "test_the_program_does_what_it_says[02_direct_motion]": "the calls that ARIA's have",
            "test_there_are_twelve_short_programs_and_the_page_leads_to_each": "words",
            "test_a_search_for_an_old_name_finds_the_page": "words",
            "test_the_new_names_of_the_page_exist": "words",
        },
    ),
    "tests/book": Part(
        "pages that are read to their end",
        {
            "test_a_page_does_what_it_says[program]": "the joint",
            "test_a_page_is_a_list_of_what_its_reader_does": "its comments",
            "test_a_comment_about_a_block_stands_before_it": "words of errors",
            "test_words_have_to_be_there_and_numbers_may_differ": "what a page promises",
        },
        packages=("cli", "web", "navigation"),
    ),
    "tests/e2e": Part("the driver against the firmware over faulty cables, in virtual time"),
    "tests/e2e/test_together.py": Part(
        "groups drive for long",
        {
            "test_a_leader_that_stops_suddenly_is_not_run_into": "safety",
            "test_a_robot_that_dies_on_the_way_stops_nobody_else_and_is_not_touched": "safety",
            "test_followers_of_a_leader_that_is_lost_stand_and_end": "safety",
        },
    ),
    "tests/e2e/test_calibrate.py": Part(
        "robots that drive squares for long",
        {
            "test_every_way_out_of_a_step_stops_the_robot": "safety",
            "test_a_stop_while_it_stands_between_two_legs_ends_the_step": "safety",
            "test_nothing_is_driven_where_something_is_near": "safety",
            "test_what_comes_in_the_way_ends_a_step": "safety",
        },
    ),
    "tests/e2e/test_traffic.py": Part(
        "robots that make way for each other",
        {"test_two_robots_that_meet_in_a_door_let_each_other_pass": "the joint"},
    ),
    "tests/e2e/test_follow.py": Part(
        "people who walk for long",
        {
            "test_nobody_is_touched_however_slow_the_link": "safety",
            "test_it_stands_still_before_somebody_who_does": "safety",
        },
    ),
    "tests/e2e/test_keeping_clear_with_laser.py": Part(
        "robots that drive for long; those with sonars alone are all in the quick tier",
        {
            "test_a_laser_that_is_lost_for_a_while_leaves_the_sonars": "safety",
            "test_a_stick_that_is_pushed_about_hits_nothing": "safety",
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
            "test_a_map_is_saved_whatever_ends_it[15]": "a way out",
            "test_a_map_without_walls_is_not_saved": "files",
            "test_without_the_extra_nav_a_sentence_names_it": "the other way in",
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
            "test_every_laser_is_sure_of_its_place_in_time[urg-04lx]": "the laser that sees least",
            "test_no_mode_touches_a_wall_of_the_map": "safety",
        },
    ),
    "tests/e2e/test_twin.py": Part(
        "a robot that drives for long",
        {
            "test_a_log_without_a_place_on_a_map_says_that_it_tells_nothing": "the other way out",
            "test_a_robot_is_simulated_by_its_own_file": "the joint",
        },
    ),
    "tests/e2e/test_calibrated.py": Part(
        "squares, both ways",
        {
            "test_a_square_ends_where_its_odometry_says[errors0-p3dx-sh-planar]": "the joint",
            "test_it_drives_straight_and_turns_as_much_as_is_asked": "commands",
            "test_the_speed_that_is_measured_is_the_true_one": "the other way",
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
    "tests/e2e/test_hostile_hosts.py": Part(
        "hundreds of hosts",
        {
            "test_a_flood_that_never_ends_gives_way_to_the_next_host": "a host at fault",
            "test_a_host_that_takes_nothing_is_cut_off": "a host at fault",
            "test_a_half_open_connection_gives_way_to_the_next_host": "a host at fault",
            "test_a_terminal_that_nobody_reads_loses_what_it_is_sent": "pseudo terminals",
            "test_a_cable_that_is_pulled_out_ends_the_connection_until_it_is_back": "a lost link",
        },
    ),
    "tests/e2e/test_demo_screen.py": Part(
        "a whole terminal each",
        {
            "test_what_matters_is_on_the_screen_at_any_size[80-24]": "the joint",
            "test_the_emergency_stop_is_shown_until_it_is_released": "safety",
            "test_a_lost_robot_is_shown_and_its_return_too": "a lost link",
        },
    ),
    "tests/e2e/test_demo_terminal.py": Part(
        "a process in a terminal each",
        {
            "test_it_starts_drives_and_quits_with_the_terminal_as_it_was": "the joint",
            "test_closing_the_window_stops_the_robot": "a way out",
            "test_a_terminal_that_freezes_stops_the_robot_in_time": "a way out",
            "TestPlain::test_lines_come_through_a_pipe_and_keys_too": "pipes",
        },
    ),
    "tests/e2e/test_keyboard.py": Part(
        "a process in a terminal each",
        {
            "test_a_held_arrow_moves_and_letting_go_stops": "the joint",
            "test_space_stops_although_the_key_would_act_on": "it stops",
            "test_what_is_latched_ends_when_no_key_comes": "safety",
            "test_any_key_stops_a_robot_that_wanders_and_k_as_hard_as_it_can": "it stops",
            "test_every_signal_leaves_the_terminal_as_it_was_and_stops": "a way out",
            "test_closing_the_window_stops_the_robot": "a way out",
        },
    ),
    "tests/e2e/test_commands.py": Part(
        "a process each",
        {
            "test_a_mistake_in_a_process_of_its_own": "the joint",
            "test_a_mistake_is_told_in_one_line": "words of errors",
            "test_a_malformed_file_is_named_with_line_and_field": "words of errors",
            "test_the_simulator_outlives_a_client_that_vanishes_while_driving": "a host at fault",
            "test_ctrl_c_while_a_command_starts_ends_it_quietly[asyncio-import]": "a way out",
            "test_run_tells_what_it_is_connected_to_and_serves_the_page": "the joint",
            "test_run_that_is_ended_while_driving_says_goodbye_to_the_robot": "a way out",
            "test_help_fits_and_names_every_command": "the joint",
        },
    ),
    "tests/e2e/test_sim_command.py": Part(
        "a process each",
        {
            "test_many_robots_have_a_line_and_a_port_each": "the joint",
            "test_a_serial_port_is_told_and_leads_to_the_robot": "pseudo terminals",
            "test_a_signal_ends_it_while_robots_drive": "a way out",
            "test_a_mistake_is_told_in_one_line": "words of errors",
        },
    ),
    "tests/e2e/test_old_emulator_faults.py": Part(
        "a hundred hosts and robots",
        {
            "test_a_robot_needs_no_name": "the joint",
            "test_motors_of_a_second_session_can_be_switched_on": "the joint",
            "test_an_empty_packet_does_no_harm": "a host at fault",
            "test_sigterm_ends_it_while_a_robot_drives": "a way out",
        },
    ),
    "tests/e2e/test_camera_pictures.py": Part(
        "pictures are rendered",
        {
            "test_a_box_is_seen_where_it_is_and_a_pan_moves_it": "the joint",
            "test_a_renderer_that_dies_is_started_again": "a fault",
            "test_what_is_missing_is_told_in_one_line": "words of errors",
        },
    ),
    "tests/e2e/test_class.py": Part(
        "a server each",
        {
            "test_each_student_sees_and_drives_the_own_robot_only": "safety",
            "test_a_program_comes_before_the_page_and_the_teacher_before_both": "safety",
            "test_a_paused_robot_stands_whoever_drives_it_and_goes_on_afterwards": "safety",
            "test_a_run_is_recorded_handed_in_and_played": "the joint",
        },
        packages=("web", "classroom"),
    ),
    "tests/e2e/test_slow_viewers.py": Part("memory is watched for long", NONE, packages=("web",)),
    "tests/e2e/test_fleet_screen.py": Part(
        "a whole terminal each",
        {
            "test_keys_choose_drive_and_stop": "the joint",
            "test_a_terminal_that_loses_the_focus_lets_go": "safety",
        },
    ),
    "tests/browser": Part("the real page in Chromium", NONE, packages=("web",)),
    "tests/browser/test_page.py": Part(
        "the page drives and stops",
        {
            "test_a_held_arrow_moves_and_letting_go_stops_within_300_ms": "it drives by keys",
            "test_a_pressed_button_drives_until_it_is_let_go": "it drives by touch",
            "test_space_stops_while_an_arrow_is_still_held": "it stops",
            "test_losing_the_page_stops_the_robot": "it stops",
            "test_the_emergency_stop_latches_until_it_is_reset": "it stops all",
        },
        packages=("web",),
    ),
    "tests/browser/test_keys.py": Part("keys alone, in a time of their own", packages=("web",)),
    "tests/browser/test_gamepad.py": Part("gamepads alone, likewise", packages=("web",)),
    "tests/browser/test_stick.py": Part("the stick alone, likewise", packages=("web",)),
    "tests/browser/test_tilt.py": Part("phones that are tilted, likewise", packages=("web",)),
    "tests/browser/test_stops.py": Part(
        "the page stops",
        {
            "test_k_is_the_emergency_stop": "it stops all",
            "test_space_stops_wherever_the_focus_is_and_presses_no_button": "it stops",
            "test_a_stop_that_cannot_be_sent_says_so_and_goes_out_first_on_reconnection": "safety",
        },
        packages=("web",),
    ),
    "tests/browser/test_failures.py": Part(
        "the page loses something",
        {
            "test_a_touch_that_the_system_takes_away_stops_the_robot": "safety",
            "test_a_server_that_ends_stops_the_robot_and_the_page_comes_back[killed]": "safety",
        },
        packages=("web",),
    ),
    "tests/browser/test_goto.py": Part(
        "the page goes to a place",
        {
            "test_the_robot_goes_there_and_the_page_says_so": "the joint",
            "test_ending_it_stops_the_robot": "it stops",
        },
        packages=("web",),
    ),
    "tests/browser/test_several.py": Part(
        "a page of several robots",
        {
            "test_keys_drive_the_robot_that_is_selected": "the joint",
            "test_the_emergency_stop_is_for_all_and_the_reset_for_one": "it stops all",
        },
        packages=("web",),
    ),
    "tests/browser/test_together.py": Part(
        "several robots at once",
        {"test_arrows_drive_all_that_are_chosen_and_space_stops_them": "it stops"},
        packages=("web",),
    ),
    "tests/browser/test_class.py": Part(
        "the pages of a class",
        {"test_two_students_join_by_one_link_and_drive_only_their_own": "the joint"},
        packages=("web", "classroom"),
    ),
    "tests/browser/test_people.py": Part(
        "several people",
        {"test_a_viewer_cannot_drive_but_stops_the_robot": "safety"},
        packages=("web",),
    ),
    "tests/browser/test_view3d.py": Part(
        "the view in three dimensions",
        {"test_the_emergency_stop_works_in_it": "it stops"},
        packages=("web",),
    ),
    "tests/ros1": Part("the real middleware of ROS 1 and its tools", NONE, packages=("ros",)),
    "tests/ros1/test_driving.py": Part(
        "a node obeys",
        {
            "test_one_message_moves_the_robot_for_the_timeout_only": "it obeys",
            "test_what_is_no_number_moves_nothing_and_is_told": "safety",
        },
        packages=("ros",),
    ),
    "tests/ros1/test_failures.py": Part(
        "a node stops",
        {
            "test_on_ctrl_c_the_robot_is_stopped_and_told_goodbye": "a way out",
            "test_a_publisher_that_pauses_stops_the_robot_and_drives_on": "safety",
            "test_after_a_kill_the_robot_stands_and_a_new_node_takes_over": "a way out",
        },
        packages=("ros",),
    ),
    "tests/ros1/test_topics.py": Part(
        "a node publishes",
        {"test_every_topic_is_rosarias_to_the_byte": "it publishes"},
        packages=("ros",),
    ),
    "tests/ros1/test_tcpros.py": Part("ROS 1's own protocols; cheap", packages=("ros",)),
    "tests/ros1/test_bags.py": Part("bags in ROS 1's own library; cheap", packages=("ros", "log")),
    "tests/ros1/test_navigation.py": Part(
        "a node navigates",
        {"test_actionlibs_clients_go_to_places": "goals"},
        packages=("ros",),
    ),
    "tests/ros2": Part("nodes as processes on real DDS and Zenoh", NONE, packages=("ros",)),
    "tests/ros2/test_node.py": Part(
        "a node on each middleware",
        {
            "test_every_topic_of_the_table_comes_with_its_type_and_qos[dds]": "it publishes",
            "test_commands_drive_and_silence_stops": "it obeys, and stops",
            "test_the_end_of_the_node_stops_the_robot_and_leaves_the_graph": "a way out",
        },
        packages=("ros",),
    ),
    "tests/ros2/test_foreign.py": Part(
        "a real ROS 2: each distribution once, each middleware once",
        {
            f"{test}[{node}]": proves
            for node in ("jazzy-dds", "kilted-rclpy")
            for test, proves in {
                "test_the_graph_has_the_node_and_its_topics_with_types_and_hashes": "it publishes",
                "test_commands_drive_and_silence_stops": "it obeys, and stops",
                "test_a_killed_program_leaves_a_robot_that_stands_and_may_come_back": "safety",
                "test_a_late_subscriber_gets_what_is_latched": "it publishes",
            }.items()
        },
        packages=("ros",),
    ),
    "tests/ros2/test_bags.py": Part(
        "a bag in a real ROS 2",
        {"test_rclpy_reads_the_numbers_of_the_log[jazzy]": "the joint"},
        packages=("ros", "log"),
    ),
    "tests/ros2/test_bridge.py": Part(
        "the bridge, in this process; cheap",
        packages=("ros",),
    ),
    "tests/ros2/test_zenoh.py": Part(
        "Zenoh itself",
        {
            "test_messages_arrive_whatever_the_quality_of_service": "the joint",
            "test_services_answer_ros_and_peers_with_keys_written_by_hand": "the joint",
            "test_a_killed_publisher_has_left": "safety",
            "test_a_wrong_password_is_refused_and_no_secret_is_shown": "security",
        },
        packages=("ros",),
    ),
    "tests/ros2/test_fleet.py": Part(
        "a fleet over ROS 2",
        {"test_all_are_stopped_at_once_however_they_are_reached[zenoh]": "safety"},
        packages=("ros", "fleet"),
    ),
    "tests/fleet": Part("computers with an sshd each", NONE, packages=("fleet", "bridge")),
    "tests/fleet/test_run.py": Part(
        "commands on all computers",
        {"test_lines_begin_with_the_robot_and_failures_give_the_exit_code": "the joint"},
        packages=("fleet",),
    ),
    "tests/fleet/test_bridge.py": Part(
        "a robot behind a network",
        {
            "test_a_robot_whose_operator_is_cut_off_stops_and_a_quiet_host_is_left_alone": "safety",
        },
        packages=("fleet", "bridge"),
    ),
}
"""By folder or file; the longest name that fits counts."""


MISNAMED = pytest.StashKey[list[str]]()
"""Names of the table that no collected test has."""


@cache
def part_of(file: str) -> Part:
    """Return the part to which a file of tests belongs.

    Raises:
        KeyError: The table has neither the file nor a folder above it.
    """
    return PARTS[max((each for each in PARTS if _is_below(file, each)), key=len, default="")]


def is_quick(item: pytest.Item) -> bool:
    """Return whether a test belongs to the quick tier."""
    file, _, test = item.nodeid.partition("::")
    return part_of(file).has(test) and item.get_closest_marker("thorough") is None


def tier_of(item: pytest.Item) -> str:
    """Return the name of the tier of a test."""
    return "quick" if is_quick(item) else "thorough"


def misnamed(items: Iterable[pytest.Item]) -> Iterator[str]:
    """Yield what the table names in the files of `items`, but is none of them."""
    files: dict[str, set[str]] = {}
    for item in items:
        file, _, test = item.nodeid.partition("::")
        files.setdefault(file, set()).add(test)
    for file, tests in files.items():
        for name in part_of(file).quick or ():
            if not any(_is_below(test, name) for test in tests):
                yield f"{file}::{name}"


def may_be_quick(path: Path) -> bool:
    """Return whether a file has quick tests; what has none need not be imported."""
    quick = part_of(path.relative_to(ROOT).as_posix()).quick
    return quick is None or bool(quick)


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
    packages = {f"src/pioneer3/{name}" for name in part_of(file).packages}
    return frozenset({file, str(Path(file).parent)} | packages | _imports(ROOT / file))


@cache
def _imports(path: Path) -> frozenset[str]:
    found: set[str] = set()
    for module in IMPORT.findall(path.read_text("utf-8")):
        first, *rest = module.split(".")
        if first == "pioneer3" and rest:
            found.add(f"src/pioneer3/{rest[0]}")
        helper = ROOT.joinpath(*module.split(".")).with_suffix(".py")
        if first == "tests" and helper.is_file():
            found |= {helper.relative_to(ROOT).as_posix()} | _imports(helper)
    return frozenset(found)


def _git(*words: str) -> str:
    """Return what git prints; nothing where this is no clone."""
    done = subprocess.run(
        ["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False
    )
    return done.stdout.strip()
