"""Commands of a client to the simulator itself (protocol.md 3.3, 5.13)."""

import logging
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import degrees

from pioneer3 import __version__
from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, SimOperation
from pioneer3.arcos.reports import MapChanged, Report, SimDevice, SimFlag, SimInfo, SimStat
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.accessories.base import HostRequest
from pioneer3.sim.body import Body
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.kernels.drives import V_OF_V, W_OF_W
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import ClientMaps
from pioneer3.units import MM, MS

log = logging.getLogger(__name__)

APPLICATION = "pioneer3"
NO_GEO_REFERENCE = -1
CODE_BYTES = 3
"""Before the text of an old MESSAGE (protocol.md 3.3)."""
E7 = 10_000_000
LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class StepTimes:
    """Durations of a step: simulated, wanted and measured [s]."""

    simulated: float
    wanted: float
    measured: float


@dataclass(slots=True, kw_only=True)
class Console:
    """Obeys the SIM commands of one robot's host; its last hundred texts for people are `messages`.

    `tell` takes MAP_CHANGED when the host has loaded, or failed to load, a map; the server sets
    `step_times`, those in SIMSTAT.
    """

    world: World
    body: Body
    equipment: Equipment
    client_maps: ClientMaps
    tell: Callable[[MapChanged], None]
    step_times: StepTimes = StepTimes(simulated=0.1, wanted=0.1, measured=0.1)
    messages: deque[str] = field(default_factory=lambda: deque(maxlen=100))
    _stat_request: HostRequest = field(default_factory=HostRequest)
    _wants_info: bool = False

    def obey(self, command: Command) -> bool:
        """Carry out `command`; return whether it was for the simulator."""
        match command:
            case commands.SimSetPose(x, y, heading):
                self.body.robot_in_world = Pose2(x, y, wrap(heading))
            case commands.SimReset():
                self.body.reset()
            case commands.RequestSimStat(how):
                self._stat_request.set(how)
            case commands.SimCtrl(operation, text):
                self._control(operation, (text or "").rstrip("\0"))
            case commands.SimMessage(text):
                self._show(text)
            case commands.Unknown(number, _) if number == commands.OldMessage.ID:
                meaning = commands.from_payload(commands.to_payload(command), simulator=True)
                if isinstance(meaning, commands.OldMessage):
                    self._show(meaning.data[CODE_BYTES:].decode("latin-1"))
            case commands.SimExit():
                log.info("%s: asks the simulator to end; refused", self.body.model.name)
            case commands.SimModelConfig():
                pass
            case _:
                return False
        return True

    def reports(self, *, cycle: bool) -> Sequence[Report]:
        """Return the requested reports: once, or before every standard report of a `cycle`."""
        due: list[Report] = []
        if self._wants_info:
            self._wants_info = False
            due.append(self._info())
            # an addition of ours: which map is in use, as if a person had just left it as it is
            name = _text(self.world.map.name)
            due.append(MapChanged(by_user=True, reloaded=0, file_name=name))
        if self._stat_request.due(cycle=cycle):
            due.append(self._stat())
        return due

    def hang_up(self) -> None:
        """Send no more reports; make a ghost a robot again."""
        self._stat_request, self._wants_info = HostRequest(), False
        self.body.ghost = False

    def _control(self, operation: SimOperation, text: str) -> None:
        match operation:
            case SimOperation.LOAD_MAP | SimOperation.LOAD_MASTER_MAP:
                self._load(text)
            case SimOperation.LOG_STATE:
                log.info("%s: %s%s", self.body.model.name, self._state(), f" {text!r}" * bool(text))
            case SimOperation.REQUEST_INFO:
                self._wants_info = True
            case SimOperation.GHOST:
                self.body.ghost = True

    def _load(self, name: str) -> None:
        try:
            found = self.client_maps.find(name)
            line_map = found.line_map()
            self.world.change_map(line_map, found.relief(line_map))
        except ConfigError as error:
            log.info("%s: asks for another map: %s", self.body.model.name, error)
            reloaded = 0
        else:
            log.info("%s: loads map %r", self.body.model.name, name)
            reloaded = 1
        self.tell(MapChanged(by_user=False, reloaded=reloaded, file_name=_text(name)))

    def _show(self, text: str) -> None:
        # a client's text must not look like lines of ours
        log.info("%s says %r", self.body.model.name, text)
        self.messages.append(text)

    def _state(self) -> str:
        body = self.body
        world, odom = body.robot_in_world, body.robot_in_odom
        speed, turn_rate = body.speeds
        return (
            f"at x={world.x:.3f} y={world.y:.3f} th={degrees(world.theta):.1f},"
            f" odometry x={odom.x:.3f} y={odom.y:.3f} th={degrees(odom.theta):.1f},"
            f" {speed:.3f} m/s {degrees(turn_rate):.1f} deg/s,"
            f" {body.battery.voltage:.1f} V, time {self.world.time:.1f} s"
        )

    def _stat(self) -> SimStat:
        pose, times = self.body.robot_in_world, self.step_times
        # by how much more the wheels see than is true, per way and per turn
        errors = self.body.drives.errors[:, self.body.number]
        way_error, turn_error = 1 / errors.item(V_OF_V) - 1, 1 / errors.item(W_OF_W) - 1
        flags = SimFlag.HAS_MAP if self.world.map.walls.size else SimFlag(0)
        if way_error or turn_error:
            flags |= SimFlag.HAS_ODOMETRY_ERROR
        return SimStat(
            flags=flags,
            step_ms=_milliseconds(times.simulated),
            interval_ms=_milliseconds(times.wanted),
            measured_ms=_milliseconds(times.measured),
            x_mm=_millimetres(pose.x),
            y_mm=_millimetres(pose.y),
            z_mm=0,
            heading_deg=round(degrees(pose.theta)),
            latitude_e7=0,
            longitude_e7=0,
            altitude_cm=0,
            gps_quality=NO_GEO_REFERENCE,
            odometry_error_x_e7=round(way_error * E7),
            odometry_error_y_e7=0,
            odometry_error_heading_e7=round(turn_error * E7),
        )

    def _info(self) -> SimInfo:
        fitted, model = self.equipment, self.body.model
        present = {
            "drive": True,
            "sonar": bool(model.sonars),
            "laser": True,
            "gripper": fitted.gripper,
            "compass": fitted.compass,
            "gyro": fitted.gyro_type > 0,
            "joystick": fitted.joystick,
            "camera": fitted.camera is not None,
        }
        return SimInfo(
            application=APPLICATION,
            version=__version__,
            flags=0,
            devices=tuple(
                SimDevice(name=kind, kind=kind, which=0, status=1)
                for kind, there in present.items()
                if there
            ),
        )


def _text(name: str) -> str:
    """Return as much of `name` as a text on the wire can be."""
    return name.partition("\0")[0]


def _milliseconds(seconds: float) -> int:
    return max(0, min(0xFFFF, round(seconds / MS)))


def _millimetres(metres: float) -> int:
    return max(LOWEST, min(HIGHEST, round(metres / MM)))
