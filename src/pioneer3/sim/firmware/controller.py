"""The robot's controller: commands become motion, the world becomes reports.

With the other modules here and the accessories the only bridge between ARCOS and the simulated
world. Facts: protocol.md 2.7, 3, 4, 5, facts.md 12; where the old emulator is wrong (facts.md 9,
13), this follows the real firmware.
"""

from collections.abc import Callable
from dataclasses import replace
from math import degrees, inf

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.device import (
    Commanded,
    Device,
    Event,
    SessionClosed,
    SessionOpened,
    WatchdogExpired,
    WatchdogFed,
)
from pioneer3.arcos.reports import Config
from pioneer3.sim.accessories import Accessories
from pioneer3.sim.accessories.gauges import LOW
from pioneer3.sim.body import EMPTY, USUAL_ENCODERS, Body
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware.console import Console
from pioneer3.sim.firmware.instruments import Instruments
from pioneer3.sim.firmware.laser import InBandLaser
from pioneer3.sim.firmware.steering import steer
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import ClientMaps
from pioneer3.state import Identity
from pioneer3.units import DECIVOLT, MM, MS

CYCLE = 0.1
"""Pause between information packets [s]."""
SONAR_CYCLE = 0.04
"""CONFIG's value for sonars that fire all at once [s]; the usual one."""
NAME = "MobileSim"
"""By this name real ARIA programs know a simulator, and take its laser (protocol.md 2.6)."""
LONGEST_NAME = 40
"""Longest name of a robot that tells its own [letters]."""
SERIAL_NUMBER = "SIM"
"""By this AriaCoda knows a simulator (facts.md 13, row 12)."""
OWN_SERIAL_NUMBER = "SIMULATED"
"""Serial number of a robot with its own name; AriaCoda takes it for a real one."""
LARGEST_WORD = 9999
TOP_ACCELERATION_MM = 2000
"""Highest acceleration of one real P3-AT (protocol.md 5.1) [mm/s^2]."""
TOP_TURN_ACCELERATION_DEG = 300
"""Highest turn acceleration of one real P3-AT (protocol.md 5.1) [degrees/s^2]."""


class Firmware:
    """One robot's controller: feed it bytes and time, send :attr:`device`'s outgoing bytes.

    Attributes:
        identity: The names in its answers to SYNC2 and CONFIG.
        device: Its end of the session with a host; CONFIG keeps the watchdog from the start, which
            is in the host's own seconds, whatever this one has.
        console: Obeys commands to the simulator; has messages of hosts to the people there.
        on_map_changed: Called when a host has loaded another map, or failed to. By default this
            tells only that host; a server with several robots calls :meth:`tell` of each.
    """

    def __init__(
        self,
        world: World,
        body: Body,
        name: str = NAME,
        watchdog: float = 2.0,
        *,
        own_name: str = "",
        equipment: Equipment | None = None,
        client_maps: ClientMaps | None = None,
    ) -> None:
        """Begin without a session.

        `name` is the robot's for programs, `own_name` that among people, for :meth:`use_own_name`,
        by default its model's. `watchdog` is the silence of the host that stops the robot [s], 0
        for never. The equipment is by default that of the model, and hosts find the shipped maps
        and those here.
        """
        self.body = body
        body.set_encoders(body.model.encoders or USUAL_ENCODERS)  # those of its memory
        self._world = world
        self.identity = Identity(name=name, family=body.model.family, model=body.model.name)
        self._own_name, self._renamed = own_name or body.model.name, False
        self.device = Device(self.identity, watchdog)
        self.accessories = Accessories(body, equipment)
        self.on_map_changed: Callable[[reports.MapChanged], None] = self.tell
        self._nominal_watchdog = watchdog
        self._laser = InBandLaser(world, body)
        self._instruments = Instruments(world, body)
        self.console = Console(
            world=world,
            body=body,
            equipment=self.accessories.equipment,
            client_maps=client_maps or ClientMaps(),
            tell=self._map_changed,
        )
        self._next_report = 0.0

    @property
    def due(self) -> float:
        """When to call :meth:`tick` next [s]; `inf` while there is no session.

        Earlier calls do no harm. Commands of the host may make it earlier.
        """
        if not self.device.is_open:
            return inf
        return min(self._next_report, self.device.due, self.accessories.due)

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the host at `now` [s, monotonic]."""
        for event in self.device.receive(data, now):
            self._handle(event, now)

    def tell(self, report: reports.Report) -> None:
        """Send `report` to the host, if there is one."""
        self.device.send(report)

    def use_own_name(self) -> None:
        """Be called by its own name from the next session on, no longer as a simulator.

        Else ARIA reads the laser in the robot's stream, and never opens the port of another one
        (protocol.md 2.6).
        """
        self._renamed = True
        if not self.device.is_open:
            self._rename()

    def hang_up(self, now: float) -> None:
        """End the session: the host's link is gone for good."""
        for event in self.device.hang_up():
            self._handle(event, now)

    def tick(self, now: float) -> None:
        """Check the watchdog, and send the reports that are due."""
        for event in self.device.tick(now):
            self._handle(event, now)
        if not self.device.is_open:
            return
        self.accessories.tick(now)
        if now >= self._next_report - 1e-6:
            late = now - self._next_report > CYCLE
            self._next_report = now + CYCLE if late else self._next_report + CYCLE
            self._report(now)
        elif now >= self.accessories.due:
            self._answer(now)

    def information(self, now: float) -> reports.Sip:
        """Return the standard information packet for this moment."""
        return self._instruments.read(self.accessories.inputs(now))

    def _map_changed(self, change: reports.MapChanged) -> None:
        self.on_map_changed(change)

    def _report(self, now: float) -> None:
        """Send the standard report of a cycle with the streams around it."""
        self._instruments.feel()
        self._answer(now, cycle=True)
        self.device.send(self.information(now))
        self.device.send_frames(self._laser.frames())

    def _answer(self, now: float, *, cycle: bool = False) -> None:
        for report in self.accessories.reports(now, cycle=cycle):
            self.device.send(report)
        for report in self.console.reports(cycle=cycle):
            self.device.send(report)

    def _handle(self, event: Event, now: float) -> None:
        match event:
            case SessionOpened():
                self.body.reset_odometry()
                self._instruments.begin()
                self._next_report = now
                self.tick(now)
            case SessionClosed():
                self.body.session_ended()
                self._laser.off()
                self._instruments.hang_up()
                self.console.hang_up()
                self.accessories.hang_up()
                self._rename()
            case Commanded(command):
                self._obey(command, now)
            case WatchdogExpired():
                self.body.drive.held = True
            case WatchdogFed():
                self.body.drive.held = False

    def _rename(self) -> None:
        if self._renamed:
            name = self._own_name[:LONGEST_NAME].replace("\0", "?")
            told = name.encode("latin-1", "replace").decode("latin-1")
            self.identity = self.device.identity = replace(self.identity, name=told)

    def _obey(self, command: Command, now: float) -> None:
        """Carry out one command; ignore commands for missing devices, as a real robot does."""
        if not self.accessories.claims(command) and self._laser.obey(command):
            return
        if steer(self.body, command) or self._instruments.obey(command):
            return
        if self.accessories.obey(command, now) or self.console.obey(command):
            self._answer(now)
        elif isinstance(command, commands.RequestConfig) and self.body.model.controller == "ARCOS":
            self.device.send(self._configuration())

    def _configuration(self) -> Config:
        """Return CONFIG.

        The current limits are those in force, so that a host that set them reads them back. Fields
        that mean nothing to a simulator are 0, as from a robot without that equipment.
        """
        model, equipment = self.body.model, self.accessories.equipment
        encoders = self.body.encoders
        linear, angular = self.body.drive.linear, self.body.drive.angular
        sonar_cycle = self._world.realism.sonar.cycle or SONAR_CYCLE
        is_own = self._renamed and self.identity.name.lower() != NAME.lower()
        return Config(
            family=self.identity.family,
            model=self.identity.model,
            serial_number=OWN_SERIAL_NUMBER if is_own else SERIAL_NUMBER,
            four_motors=int(model.drive == "skid"),
            rotation_top_deg_s=_whole(degrees(model.max_turn_rate)),
            speed_top_mm_s=_whole(model.max_speed / MM),
            rotation_accel_top_deg_s2=TOP_TURN_ACCELERATION_DEG,
            accel_top_mm_s2=TOP_ACCELERATION_MM,
            pwm_max_raw=500,
            name=self.identity.name,
            sip_cycle_ms=_whole(CYCLE / MS),
            host_baud_code=0,
            aux1_baud_code=0,
            has_gripper=int(equipment.gripper),
            has_front_sonar=int(bool(model.sonars)),
            has_rear_sonar=int(len(model.sonars) > 8),
            low_battery_decivolts=_whole(LOW / DECIVOLT),
            rev_count_ticks=encoders.rev_count,
            watchdog_ms=_whole(self._nominal_watchdog / MS),
            normal_motor_packets=0,
            stall_pwm=0,
            stall_count_ms=0,
            joystick_speed_mm_s=0,
            joystick_rotation_deg_s=0,
            rotation_max_deg_s=_whole(degrees(angular.top)),
            speed_max_mm_s=_whole(linear.top / MM),
            rotation_accel_deg_s2=_whole(degrees(angular.acceleration)),
            rotation_decel_deg_s2=_whole(degrees(angular.deceleration)),
            rotation_kp_raw=40,
            rotation_kv_raw=20,
            rotation_ki_raw=0,
            accel_mm_s2=_whole(linear.acceleration / MM),
            decel_mm_s2=_whole(linear.deceleration / MM),
            translation_kp_raw=40,
            translation_kv_raw=30,
            translation_ki_raw=0,
            front_bumpers=model.front_bumpers,
            rear_bumpers=model.rear_bumpers,
            charger=0,
            sonar_cycle_ms=_whole(sonar_cycle / MS),
            autobaud=0,
            gyro_type=equipment.gyro_type,
            drift_factor_8192nds=encoders.drift_factor,
            aux2_baud_code=0,
            aux3_baud_code=0,
            ticks_per_mm=encoders.ticks_mm,
            shutdown_decivolts=_whole(EMPTY / DECIVOLT),
            firmware_version="S.0",
            gyro_cw_raw=0,
            gyro_ccw_raw=0,
            kinematics_delay_ms=0,
            lateral_speed_top_mm_s=0,
            lateral_accel_top_mm_s2=0,
            lateral_speed_max_mm_s=0,
            lateral_accel_mm_s2=0,
            lateral_decel_mm_s2=0,
            charge_threshold_raw=0,
        )


def _whole(value: float) -> int:
    return min(round(value), LARGEST_WORD)
