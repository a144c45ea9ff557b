"""The page for people who come from ARIA, and its programs, in a small room of the simulator."""

import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

from pioneer3 import BlockingRobot
from pioneer3.robot.devices import Devices

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/how-to/from-aria.md"
PROGRAMS = sorted((ROOT / "examples/from_aria").glob("*.py"))
ROOM = """2D-Map
LineMinPos: 0 0
LineMaxPos: 4000 3600
NumLines: 4
Resolution: 20
Cairn: RobotHome 1500 2500 0 "" ICON "Home"
Cairn: Goal 2300 1900 0 "" ICON "Desk"
Cairn: Goal 3300 700 0 "" ICON "Corner"
LINES
0 0 4000 0
4000 0 4000 3600
4000 3600 0 3600
0 3600 0 0
DATA
"""
"""A wall 1.1 m to the left of where robots begin, another one 2.5 m ahead."""
KEYS = {"05_teleop": "w s,q"}
PRINTS = {
    "01_simple_connect": r"x 0\.00 m, y 0\.00 m, th 0 deg, vel 0\.00 m/s, .* 13\.\d V",
    "02_direct_motion": r"heading -?0\.0",
    "03_square": r"back at x -?0\.0\d m, y -?0\.0\d m, th -?\d deg",
    "04_wander": r"wandered to Pose2\(x=(0\.[2-9]|1\.)",
    "05_teleop": r"'w': 0\.20 m/s, 0\.00 rad/s\n' ': 0\.00.*\n's': -0\.10 .*\n',': 0\.00",
    "06_goto": r"at 0\.4, 0\.0\nat 0\.4, 0\.3\nat 0\.0, 0\.0\n",
    "07_follow_wall": r"the wall is at (0\.[6-9]|1\.[01])",
    "08_stop_at_obstacle": r"stopped: 0\.[45]\d m of room",
    "09_sonar_and_laser": r"laser: 181 readings, -90 to 90 deg, nearest 1\.[01].*\nleft 1\.[01]",
    "10_gripper": r"are open\n.* are closed, beam broken: False\n.* are open, ",
    "11_map_goals": r"Desk: 2\.3, 1\.9 m\nCorner: 3\.3, 0\.7 m\nat Desk",
    "12_every_cycle": r"\d+: 13\.\d V(?s:.)*\n(1[5-9]|2\d) cycles",
}
"""What each program prints, among other things."""
OLD_NAMES = """
ArRobot ArRobotConnector ArSimpleConnector ArArgumentParser ArArgumentBuilder ArLaserConnector
ArSerialConnection ArTcpConnection ArPose ArPoseWithTime ArUtil ArMath ArTime ArLog ArConfig
ArFunctor ArFunctorC PyFunctor ArASyncTask ArMutex ArAction ArActionDesired ArActionGroup
ArResolver ArActionGoto ArActionGotoStraight ArActionConstantVelocity ArActionAvoidFront
ArActionAvoidSide ArActionBumpers ArActionLimiterForwards ArActionLimiterBackwards
ArActionLimiterTableSensor ArActionStallRecover ArActionStop ArActionTurn ArActionInput
ArActionRatioInput ArActionKeydrive ArActionJoydrive ArActionDriveDistance ArActionColorFollow
ArActionIRs ArActionTriangleDriveTo ArRangeDevice ArSonarDevice ArSonarReading ArBumpers ArIRs
ArForbiddenRangeDevice ArLaser ArSick ArLMS2xx ArUrg ArMap ArMapObject ArGripper ArPTZ ArVCC4
ArSonyPTZ ArDPPTU ArACTS_1_2 ArKeyHandler ArJoyHandler ArMode ArModeTeleop ArModeWander ArTCM2
ArAnalogGyro ArDataLogger ArNetServer ArServerBase ArClientBase ArPathPlanningTask
ArLocalizationTask ArSonarLocalizationTask ArCommands runAsync waitForRunExit stopRunning
disconnect lock unlock comInt com com2Bytes comStr enableMotors disableMotors areMotorsEnabled
enableSonar disableSonar setVel setVel2 setRotVel setHeading setDeltaHeading move isMoveDone
isHeadingDone stop getX getY getTh getPose getVel getRotVel getLeftVel getRightVel moveTo
getEncoderPose getBatteryVoltage getRealBatteryVoltage getStateOfCharge getSonarRange getNumSonar
getSonarReading getClosestSonarRange getClosestSonarNumber checkRangeDevicesCurrentPolar
checkRangeDevicesCumulativePolar checkRangeDevicesCurrentBox currentReadingPolar
isLeftMotorStalled isRightMotorStalled getStallValue getFlags getDigIn getDigOut getAnalog
setTransVelMax setRotVelMax setTransAccel setTransDecel setAbsoluteMaxTransVel
getAbsoluteMaxTransVel getRobotName getRobotType getRobotRadius addAction remAction addUserTask
addSensorInterpTask addRangeDevice addPacketHandler addConnectCB addDisconnectNormallyCB
addStabilizingCB clearDirectMotion deactivateExclusive sleep getTime findMapObject getMapObjects
readFile gripOpen gripClose liftUp liftDown getBreakBeamState pan tilt zoom panTilt panRel setGoal
haveAchievedGoal cancelGoal getRawReadings isConnected getCurrentBufferAsVector findRangeDevice
getOdometerDistance lockDevice attachKeyHandler logOptions parseArgs loadDefaultArguments
mSecSince liftStop setActionRobot activate deactivate getRawReadingsAsVector ArGlobalFunctor ArGPS
ArActionDeceleratingLimiter setMaxVel ArSensorReading isStalled
"""


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the map of the room, where a simulator's map is looked for."""
    folder = tmp_path_factory.mktemp("room")
    (folder / "room.map").write_text(ROOM)
    return folder


@pytest.fixture(scope="module")
def url(room: Path) -> Iterator[str]:
    """Run a simulator in which each program gets a fresh robot."""
    command = [sys.executable, "-m", "pioneer3", "sim", "-m", "room.map", "-R", "p3dx-sh"]
    with subprocess.Popen(
        [*command, "--fit", "gripper", "-p", "0"], cwd=room, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        yield process.stdout.readline().split()[-1]
        process.terminate()


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_the_program_does_what_it_says(path: Path, url: str, room: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(path), url],
        cwd=room,
        input=KEYS.get(path.stem, ""),
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert re.search(PRINTS[path.stem], done.stdout), done.stdout


def test_there_are_twelve_short_programs_and_the_page_leads_to_each() -> None:
    assert [path.stem for path in PROGRAMS] == sorted(PRINTS)
    page = PAGE.read_text()
    for path in PROGRAMS:
        assert len(path.read_text().splitlines()) <= 40, path
        assert f"[{path.name}](examples.md#from-aria-" in page


def test_a_search_for_an_old_name_finds_the_page() -> None:
    known = set(re.findall(r"\w+", PAGE.read_text()))
    assert [name for name in OLD_NAMES.split() if name not in known] == []


def test_the_new_names_of_the_page_exist() -> None:
    page = PAGE.read_text()
    named = set(re.findall(r"`(?:await )?robot\.(\w+)", page))
    assert named
    assert [name for name in named if not hasattr(BlockingRobot, name)] == []
    devices = set(re.findall(r"`robot\.devices\.(\w+)", page))
    assert [name for name in devices if not hasattr(Devices, name)] == []
    imported = re.findall(r"^from (pioneer3[\w.]*) import (.+)$", page, re.MULTILINE)
    actions = re.findall(r"`behaviors\.actions\.(\w+)", page)
    assert imported
    assert actions
    for module, names in [*imported, *(("pioneer3.behaviors.actions", name) for name in actions)]:
        for name in names.split(", "):
            assert hasattr(import_module(module), name), (module, name)
