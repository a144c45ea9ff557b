"""The lab's thirteen modes and ARIA's two, in the order in which ARIA lists them (facts.md 8.2).

========  ==================================================================================
module    contents
========  ==================================================================================
sensors   sonars, bumpers and the laser (facts.md 8.7, 8.8, 8.11)
reports   the configuration, the flags
position  driving distances and turning right angles (facts.md 8.9)
driving   driving with keys, guarded and not, and by itself (facts.md 8.3, 8.4)
devices   the gripper, the compass and the input and output lines (facts.md 8.5, 8.10, 8.14)
camera    a pan-tilt-zoom camera by hand: its make, its port, then its keys (facts.md 8.6)
acts      driving after a colour that ACTS sees (facts.md 8.12)
========  ==================================================================================
"""

from pioneer3.behaviors.modes import Wander
from pioneer3.demo.mode import Description
from pioneer3.demo.modes.acts import acts
from pioneer3.demo.modes.camera import camera
from pioneer3.demo.modes.devices import gripper, io, tcm2
from pioneer3.demo.modes.driving import by_itself, teleop, unguarded
from pioneer3.demo.modes.position import position
from pioneer3.demo.modes.reports import command, config, status
from pioneer3.demo.modes.sensors import bumps, laser, sonar

KEYS = ("up, down: speed ±5 %", "left, right: turn a little", "space: stop", "e: motors on")

MODES: tuple[Description, ...] = (
    Description(
        key="t",
        name="teleop",
        hint="stops before obstacles",
        needs="sonars",
        help=KEYS,
        by_hand=True,
        make=teleop,
    ),
    Description(
        key="u",
        name="unguarded teleop",
        label="unguarded",
        hint="**nothing** keeps it from hitting things and people",
        help=("NOTHING KEEPS IT FROM HITTING THINGS AND PEOPLE", *KEYS),
        by_hand=True,
        make=unguarded,
    ),
    Description(
        key="w",
        name=Wander.name(),
        hint="with ARIA's wander group",
        needs="sonars",
        help=("it drives about by itself until another mode",),
        make=by_itself(Wander(preset="aria")),
    ),
    Description(
        key="l",
        name="laser",
        hint="nearest and farthest; its points in the ring",
        needs="a laser (`--laser PORT`), or a simulator's own",
        help=("1-9: choose the laser", "z: raw readings or not", "l: connect again"),
        make=laser,
    ),
    Description(
        key="b",
        name="bumps",
        hint="which bumpers touch",
        needs="segments in CONFIG, or in the robot's model",
        help=("front: left to right", "rear: right to left"),
        make=bumps,
    ),
    Description(
        key="s",
        name="sonar",
        hint="ranges",
        needs="sonars in the robot's model",
        help=("1: all", "2: 0-7", "3: 8-15", "4, 5: 16-23, 24-31"),
        make=sonar,
    ),
    Description(
        key="p",
        name="position",
        hint="drives distances, turns right angles, **unguarded**",
        needs="gyro columns: CONFIG's GyroType 1",
        help=(
            "UNGUARDED, INTO WHAT IS IN THE WAY",
            "up, down: drive",
            "left, right: turn 90°",
            "page up, down: ±0.5 m",
            "space: stop",
            "r: here is 0, 0, 0",
            "x: both or either",
            "z: gyro off, only, on",
        ),
        make=position,
    ),
    Description(
        key="c",
        name="camera",
        hint="pan, tilt, zoom",
        needs="Sony or Canon on AUX1 or AUX2; it answers or not",
        help=(
            "up, down: tilt 3°",
            "left, right: pan 5°",
            "z, x: zoom ±1 %",
            "space: centre, zoom out",
            "e: exercise until a key",
        ),
        make=camera,
    ),
    Description(
        key="d",
        name="command",
        hint="any number, past limits and guards",
        help=(
            "MOTION COMMANDS GO PAST LIMITS AND GUARDS",
            "digits, space, -: type",
            "enter: send",
            "32 10 -10: a command, then nothing, an integer or two bytes",
        ),
        by_hand=True,
        make=command,
    ),
    Description(
        key="o",
        name="report robot config",
        label="config",
        hint="the configuration, asked for anew",
        help=("o: ask again", "up, down: scroll"),
        make=config,
    ),
    Description(
        key="f",
        name="detailed status/error flags",
        label="status",
        hint="every flag by name",
        needs="safety states: MTX robots only",
        help=("f: ask again",),
        make=status,
    ),
    Description(
        key="i",
        name="io",
        hint="digital and analog lines",
        help=("bits: bit 0 first", "a/d: volts"),
        make=io,
    ),
    Description(
        key="m",
        name="tcm2",
        hint="compass",
        needs="its packets, or a heading in the standard report",
        help=(
            "0: off",
            "1: in the standard report",
            "2: one packet",
            "3: packets",
            "4: user calibration",
            "5: auto calibration",
            "6: stop calibration",
            "7: soft reset",
        ),
        make=tcm2,
    ),
    Description(
        key="a",
        name="acts",
        hint="drives after a colour",
        needs="an ACTS server (`--acts tcp://HOST:5001`)",
        help=("1-8: channel", "z: drive after it", "space: stop", "x: look for what is lost"),
        make=acts,
    ),
    Description(
        key="g",
        name="gripper",
        hint="opens, closes, lifts",
        needs="CONFIG's HasGripper, or its own answer",
        help=(
            "up, down: lift",
            "right, left: open, close",
            "space: halt",
            "e: exercise until a key",
        ),
        make=gripper,
    ),
)
