"""Findings about the robot that answered, and about the line to it."""

from collections.abc import Iterator
from functools import partial
from typing import Final

from pioneer3.doctor.facts import Finding, Heard, Level, LinkFacts, failure, ok, warning
from pioneer3.errors import Symptom
from pioneer3.links.serial import SPEEDS
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Snapshot
from pioneer3.units import DECIVOLT, MS

START_SPEED: Final = SPEEDS[0]
USUAL_CYCLE: Final = 0.1
"""Interval of information packets where CONFIG has none [s] (protocol.md 4.1)."""
SLOW = 0.85
"""Share of the expected reports below which there is a warning."""
VERY_SLOW = 0.5
"""Share of the expected reports below which there is a failure."""
NOISY = 0.001
"""Share of corrupt frames above which there is a warning."""
VERY_NOISY = 0.05
"""Share of corrupt frames above which there is a failure."""
_bad_line = partial(Finding, symptom=Symptom.LOSES_THE_LINK)


def check_speed(facts: LinkFacts) -> Iterator[Finding]:
    """Is the line at the speed at which robots start?"""
    if facts.info is None or facts.info.speed is None:
        return
    speed = facts.info.speed
    if speed == START_SPEED:
        yield ok("speed", f"{speed} baud")
        return
    yield warning(
        check="speed",
        found=f"{speed} baud; robots start at {START_SPEED}",
        meaning="An earlier program switched the robot and left it so, or its settings say so.",
        advice="Nothing to do: pioneer3 tries all speeds and remembers. Others need the robot "
        "switched off and on.",
        symptom=Symptom.NO_ANSWER,
    )


def check_session(facts: LinkFacts) -> Iterator[Finding]:
    """Was the robot free?"""
    if facts.info is None:
        return
    if not facts.streaming:
        yield ok("session", "the robot was waiting for a host")
        return
    yield warning(
        check="session",
        found="the robot was still serving an earlier session",
        meaning="Its last program did not close its session (crash, kill, cable pulled).",
        advice="Nothing to do: that session has been closed now.",
        symptom=Symptom.NO_ANSWER,
    )


def check_type(facts: LinkFacts) -> Iterator[Finding]:
    """Is it known what the robot's numbers mean?"""
    if facts.info is None:
        return
    model = facts.info.model
    if model.refusal is None:
        yield ok("type", f"{model.title} ({model.name})")
        return
    yield failure(
        check="type",
        found=model.title,
        meaning="It is not known what its numbers mean; a metre may be 0.4 or 1.3 m. Nothing drives"
        " it, and what it reports is in units that may be wrong.",
        advice="Say what it is at every command, as in pioneer3 doctor --model FILE.p: a model that"
        " ships (pioneer3 model show), or the parameter file that ARIA has for it.",
        symptom=Symptom.UNKNOWN_ROBOT,
    )


def check_config(facts: LinkFacts) -> Iterator[Finding]:
    """Did the robot send its configuration without errors?"""
    if facts.info is None:
        return
    config = facts.info.config
    if config is None:
        yield warning(
            check="config",
            found="the robot did not send its configuration",
            meaning=f"The usual values of {facts.info.model.title} are used for limits and alarms.",
            advice="Harmless with old firmware; else look at the checksums below.",
            symptom=Symptom.LOSES_THE_LINK,
        )
    elif facts.heard is not None and not facts.heard.config_trusted:
        yield warning(
            check="config",
            found="the configuration comes with a wrong checksum, each time the same",
            meaning="A known fault of some P3-DX-SH controllers. It is used all the same.",
            symptom=Symptom.LOSES_THE_LINK,
        )
    else:
        firmware = f", firmware {config.firmware_version}" if config.firmware_version else ""
        yield ok("config", f"serial number {config.serial_number or 'none'}{firmware}")


def check_reports(facts: LinkFacts) -> Iterator[Finding]:
    """Do the reports come as often as they should?"""
    heard = facts.heard
    if facts.info is None or heard is None:
        return
    told = facts.info.config.sip_cycle_ms if facts.info.config else None
    cycle = (told or 0) * MS or USUAL_CYCLE
    rate, share = heard.reports / heard.seconds, heard.reports * cycle / heard.seconds
    found = f"{rate:.1f} reports/s of {1 / cycle:.0f}, longest gap {heard.longest_gap:.2f} s"
    if heard.ended is not None:
        yield _bad_line(
            check="reports",
            level=Level.FAIL,
            found=f"the session broke off: {heard.ended}",
            meaning="The robot was switched off, the cable pulled, or the battery is empty.",
            advice="Look at the cable and the battery, then try again.",
        )
    elif share >= SLOW:
        yield ok("reports", found)
    else:
        yield _bad_line(
            check="reports",
            level=Level.WARN if share >= VERY_SLOW else Level.FAIL,
            found=found,
            meaning="Reports get lost, or the line is too slow for them.",
            advice="Look at the checksums below; avoid radio bridges and USB hubs.",
        )


def check_checksums(facts: LinkFacts) -> Iterator[Finding]:
    """Do the bytes arrive as they were sent?"""
    heard = facts.heard
    if facts.info is None or heard is None:
        return
    frames = heard.packets + heard.bad_checksums
    share = heard.bad_checksums / frames if frames else 0.0
    lost = f"{heard.bad_checksums} of {frames} frames spoilt, {heard.bytes_skipped} bytes lost"
    if share <= NOISY and not heard.bytes_skipped:
        yield ok("checksums", f"{frames} frames, all good")
        return
    yield _bad_line(
        check="checksums",
        level=Level.FAIL if share > VERY_NOISY else Level.WARN,
        found=lost,
        meaning="Bytes change or vanish between robot and computer; such frames are thrown away.",
        advice=_remedy(facts),
    )


def _remedy(facts: LinkFacts) -> str:
    chip = facts.port.chip if facts.port else None
    if chip is not None:
        return (
            f"Some USB adapters do that (this one: {chip}): try another make or computer; "
            "then a shorter cable, and screws tight on both ends."
        )
    if facts.is_serial:
        return "Try another cable, shorter and shielded; tighten the screws on both ends."
    return "Look at the serial cable at the far end of this connection."


def check_state(facts: LinkFacts) -> Iterator[Finding]:
    """Is the robot ready to drive?"""
    heard = facts.heard
    if facts.info is None or heard is None or heard.snapshot is None:
        return
    now = heard.snapshot
    yield _stop_button(now)
    yield from _motors(now)
    yield battery_finding(now, facts.info)
    yield from _sonar(heard, facts.info)
    yield from _faults(now)


def drive_finding(parting: str | None, held_up: str | None) -> Finding:
    """Do the wheels do what they are told? A drive was `held_up`, or parted from the twin's."""
    if parting is None and held_up is None:
        return ok("drive", "does what its simulated twin does")
    if parting is None:
        return warning(
            check="drive",
            found=f"could not be tried: {held_up}",
            advice="Make room, and begin again.",
            symptom=Symptom.DOES_NOT_MOVE,
        )
    return failure(
        check="drive",
        found=f"not as its simulated twin: {parting}",
        meaning="The wheels do not do what they are told.",
        advice="See that nothing holds the robot, then look at that wheel, its tyre and its motor.",
        symptom=Symptom.WRONG_DISTANCES,
    )


def _stop_button(now: Snapshot) -> Finding:
    if not now.motors.stop_button:
        return ok("stop button", "not pressed")
    return failure(
        check="stop button",
        found="pressed",
        meaning="The motors have no power: the robot will not move, whatever it is told.",
        advice="Turn or pull the red button until it comes out.",
        symptom=Symptom.EMERGENCY_STOP,
    )


def _motors(now: Snapshot) -> Iterator[Finding]:
    if now.motors.enabled:
        yield warning(
            check="motors",
            found="on, although they were told to be off",
            meaning="Somebody pressed the MOTORS button, or a joystick is in use.",
            symptom=Symptom.DOES_NOT_MOVE,
        )
    else:
        yield ok("motors", "off, as they should be now; the first command switches them on")
    if now.motors.stalled:
        sides = (("left", now.motors.left_stalled), ("right", now.motors.right_stalled))
        yield warning(
            check="stall",
            found=f"{' and '.join(side for side, stalled in sides if stalled)} wheels blocked",
            meaning="The robot pushes against something.",
            advice="Free it, or drive the other way.",
            symptom=Symptom.DOES_NOT_MOVE,
        )


def battery_finding(now: Snapshot, info: RobotInfo) -> Finding:
    """Is the battery charged?"""
    volts = now.battery.voltage
    shutdown = (info.config.shutdown_decivolts or 0) * DECIVOLT if info.config else 0.0
    found = f"{volts:.1f} V" + (f", {now.battery.charge:.0%}" if now.battery.charge else "")
    if 0 < volts <= shutdown:
        return failure(
            check="battery",
            found=found,
            meaning=f"At {shutdown:g} V the robot shuts down.",
            advice="Charge it, or put charged batteries in, one after the other.",
            symptom=Symptom.IT_BEEPS,
        )
    if now.battery.low:
        return warning(
            check="battery",
            found=f"{found}: low",
            meaning="The robot's own alarm level is reached; it beeps.",
            advice="Charge it soon.",
            symptom=Symptom.IT_BEEPS,
        )
    return ok("battery", found)


def _sonar(heard: Heard, info: RobotInfo) -> Iterator[Finding]:
    expected, got = len(info.model.sonars), len(heard.sonars)
    if not expected and not got:
        return
    if got >= expected:
        yield ok("sonar", f"{got} transducers")
        return
    missing = ", ".join(str(n) for n in range(expected) if n not in heard.sonars)
    yield warning(
        check="sonar",
        found=f"{got} of {expected} transducers, none from {missing}",
        meaning="No rear ring on this robot, a loose cable, or sonar switched off.",
        advice="A robot without rear ring needs nothing: its readings are just missing.",
        symptom=Symptom.SONAR_IS_WRONG,
    )


def _faults(now: Snapshot) -> Iterator[Finding]:
    if now.faults:
        yield warning(
            check="faults",
            found=", ".join(now.faults),
            meaning="The controller reports these about itself.",
            advice="Switch the robot off and on; if they stay, see the robot's manual.",
            symptom=Symptom.DOES_NOT_MOVE,
        )
