"""Gathers the facts about the computers of a fleet, and derives the findings from them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pioneer3.doctor.facts import FAILED, UNREACHABLE, Finding, Level, failure, ok
from pioneer3.errors import RemoteError
from pioneer3.fleet.host_checks import Patient, findings
from pioneer3.fleet.host_facts import HostFacts, clock_of, parsed, question, reaches_ports
from pioneer3.fleet.run import Done, Outcome, on_each, output_of
from pioneer3.fleet.spec import Fleet, FleetRobot
from pioneer3.fleet.ssh import LOGIN, Login, accepts_passwords, connect


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """The findings about one robot's computer, and its facts; `None` if it was not reached."""

    robot: str
    facts: HostFacts | None
    findings: tuple[Finding, ...]

    @property
    def code(self) -> int:
        """0 unless something failed, else the exit code of the first failure."""
        return next((each.code for each in self.findings if each.level is Level.FAIL), 0)


async def gather(
    fleet: Fleet, robots: Sequence[FleetRobot], *, login: Login = LOGIN, thorough: bool = False
) -> tuple[dict[str, HostFacts], tuple[Outcome, ...]]:
    """Return the facts about all computers by the names of their robots, and how that went.

    If it is `thorough`, it tries the settings of their passwords and firewalls, too.
    """
    found: dict[str, HostFacts] = {}

    async def work(robot: FleetRobot) -> Done:
        async with connect(robot, login) as connection:
            facts = parsed(robot, await output_of(connection, question(robot, fleet)))
            offset, error = await clock_of(connection)
            facts = replace(facts, clock_offset=offset, clock_error=error)
            if thorough:
                reached = await reaches_ports(connection, robot.address)
                facts = replace(facts, open_ports=reached)
        if thorough:
            facts = replace(facts, passwords=await accepts_passwords(robot, login))
        if not facts.hostname:
            raise RemoteError("it does not answer questions of a shell: is the user's shell one?")
        found[robot.name] = facts
        return Done()

    outcomes = await on_each(robots, work)
    return {robot.name: found[robot.name] for robot in robots if robot.name in found}, outcomes


async def diagnose(
    fleet: Fleet, robots: Sequence[FleetRobot], *, login: Login = LOGIN
) -> tuple[Diagnosis, ...]:
    """Return a diagnosis of each robot's computer."""
    found, outcomes = await gather(fleet, robots, login=login, thorough=True)
    return tuple(
        _diagnosis(robot, fleet, found, outcome)
        for robot, outcome in zip(robots, outcomes, strict=True)
    )


def _diagnosis(
    robot: FleetRobot, fleet: Fleet, found: dict[str, HostFacts], outcome: Outcome
) -> Diagnosis:
    facts = found.get(robot.name)
    if facts is None:
        unreached = failure(check="ssh", found=outcome.why, code=UNREACHABLE)
        return Diagnosis(robot=robot.name, facts=None, findings=(unreached,))
    login = ok("ssh", f"{robot.user}@{robot.address}")
    patient = Patient(robot=robot, fleet=fleet, facts=facts, all_facts=found)
    return Diagnosis(robot=robot.name, facts=facts, findings=(login, *findings(patient)))


def exit_code(diagnoses: Sequence[Diagnosis]) -> int:
    """Return 0 unless something failed; 3 if no computer was reached; else the first failure's."""
    if diagnoses and all(each.facts is None for each in diagnoses):
        return UNREACHABLE
    codes = [each.code for each in diagnoses if each.code]
    return next((FAILED if code == UNREACHABLE else code for code in codes), 0)
