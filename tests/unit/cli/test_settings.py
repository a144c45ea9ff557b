"""Settings of navigation on the command line: the option, before the fleet file."""

from pathlib import Path

from pioneer3.cli.options import LinkOptions, NavigationOptions

FLEET = """\
[[robot]]
name = "bob"
address = "192.0.2.1"
navigation.planner.margin = 0.05
[robot.navigation.mapper]
cell = 0.05
"""


def test_a_setting_of_the_command_line_comes_before_that_of_the_fleet_file(tmp_path: Path) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(FLEET)
    bob = LinkOptions(robot="bob", fleet=path)
    found = NavigationOptions(set_=("planner.margin=9cm",)).settings(bob)
    assert (found.planner.margin, found.mapper.cell) == (0.09, 0.05)
    assert NavigationOptions().settings(bob).planner.margin == 0.05
    assert NavigationOptions().settings(LinkOptions(fleet=path)).planner.margin == 0.07
