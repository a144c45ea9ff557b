"""Checks a robot by all that was heard of it, row by row of the table. Pure."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

from pioneer3.names import printable
from pioneer3.ros.checks.endpoints import (
    EndpointSides,
    endpoint_faults,
    missing,
    service_rows,
    sides,
)
from pioneer3.ros.checks.expectations import Expectation, expectations
from pioneer3.ros.checks.facts import (
    ORDER,
    CheckFault,
    CheckReport,
    CheckRow,
    ReportPart,
    RobotFacts,
    Sample,
    fail,
    warn,
)
from pioneer3.ros.checks.timing import StampedMessage, rate, rate_faults, stamp_faults
from pioneer3.ros.checks.transforms import (
    TransformTree,
    child_faults,
    description_faults,
    fixed_faults,
    frame_faults,
    moving_faults,
    tree_of,
)

MOST: Final = 4
"""Faults of the fields of one topic that are told."""
STARTING: Final = 1.5
"""A device may take this long to begin when somebody listens [s]."""


def check(facts: RobotFacts) -> CheckReport:
    """Return the report of a robot."""
    table = list(expectations(facts))
    names = {each.row: each.name for each in table}
    tree = tree_of(facts, names["tf"], names["tf_static"], names["odom"])
    known = set(names.values())
    rows = (
        _node_row(facts),
        *(_topic_row(each, tree, known, facts) for each in table),
        *service_rows(facts),
    )
    seconds = max((facts.listened(name) for name in facts.heard), default=0.0)
    return CheckReport(node=printable(facts.node.full), seconds=seconds, rows=rows)


def _node_row(facts: RobotFacts) -> CheckRow:
    count = facts.graph.nodes.count(facts.node.full)
    faults = []
    if count > 1:
        faults.append(
            fail(
                f"{count} nodes have this name",
                advice="end the one that was forgotten, or give each robot a --namespace",
            )
        )
    if facts.simulated_time and not any(
        sample.now is not None for stream in facts.heard.values() for sample in stream.samples
    ):
        faults.append(fail("it takes the time of /clock, and nobody publishes that"))
    clock = ", time of /clock" if facts.simulated_time else ""
    return CheckRow(
        part=ReportPart.NODE,
        name=printable(facts.node.full),
        expected="one node of this name",
        found=f"{count}{clock}",
        faults=tuple(faults),
    )


def _topic_row(
    expected: Expectation, tree: TransformTree, known: set[str], facts: RobotFacts
) -> CheckRow:
    there = sides(expected, facts)
    row = CheckRow(
        part=ReportPart(expected.direction.value),
        name=expected.name,
        expected=_promise(expected),
        found="absent",
    )
    if not there.robot:
        if not expected.required:
            return replace(row, absent=expected.optional)
        return replace(row, faults=(missing(expected, facts, known),))
    faults = list(endpoint_faults(expected, there, facts))
    if not expected.is_published:
        count = len(there.others)
        found = f"subscribed, {count or 'no'} publisher{'' if count == 1 else 's'}"
        return _with(row, faults, found=found)
    if not any(each.type_name == expected.type_name for each in there.robot):
        return _with(row, faults, found=printable(there.robot[0].type_name))
    samples = _counted(expected, there, facts)
    faults += _silence(expected, samples, there, facts)
    faults += _faults_heard(expected, samples, tree, facts)
    timed = _timed(expected, samples, tree)
    measured = rate(timed) if expected.rate or not expected.latched else None
    return _with(row, faults, found=_found(samples, measured, there, facts), rate=measured)


def _faults_heard(
    expected: Expectation, samples: Sequence[Sample], tree: TransformTree, facts: RobotFacts
) -> Iterator[CheckFault]:
    """Yield the faults of messages that came."""
    stream = facts.heard.get(expected.name)
    if stream is not None and stream.unreadable:
        yield fail(
            f"it sends bytes that are no {expected.type_name}", example=f"{stream.unreadable} times"
        )
    timed = _timed(expected, samples, tree)
    if expected.rate is not None and timed:
        listened = facts.listened(expected.name)
        yield from rate_faults(
            timed, expected.rate, listened, ended=facts.ended, optional=bool(expected.optional)
        )
    if not expected.latched and expected.row != "tf":
        yield from _stamps(samples)
    yield from _counted_faults(samples)
    yield from _frames(expected, samples, tree)
    match expected.row:
        case "tf":
            yield from moving_faults(tree, facts) if samples else ()
        case "tf_static":
            yield from fixed_faults(tree)
        case "robot_description" if samples:
            yield from description_faults(tree, samples[-1].text)


def _silence(
    expected: Expectation, samples: Sequence[Sample], there: EndpointSides, facts: RobotFacts
) -> Iterator[CheckFault]:
    if samples or expected.may_be_silent:
        return
    longest = STARTING if expected.rate is None else 2 / expected.rate
    if facts.listened(expected.name) < longest and not expected.latched:
        return
    tell = warn if expected.optional and not expected.device else fail
    if expected.latched and all(each.qos.transient_local for each in there.robot):
        yield tell("a late subscriber hears nothing", advice="has it been published, and kept?")
        return
    yield tell("it is silent", advice="has the node lost its robot, or the robot this part?")


def _counted(expected: Expectation, there: EndpointSides, facts: RobotFacts) -> Sequence[Sample]:
    """Return the messages that count: of a topic that others share, those of the robot's node."""
    samples = facts.samples(expected.name)
    if not expected.own:
        return samples
    gids = {each.gid for each in there.robot}
    return [each for each in samples if each.sender in gids]


def _timed(
    expected: Expectation, samples: Sequence[Sample], tree: TransformTree
) -> Sequence[Sample]:
    """Return the messages that the rate is that of: on `tf` those with the robot's pose."""
    if expected.row != "tf":
        return samples
    with_pose = [
        each for each in samples if any(part.child in tree.bases for part in each.transforms)
    ]
    return with_pose or samples


def _stamps(samples: Iterable[Sample]) -> Iterator[CheckFault]:
    by_sender: dict[bytes, list[StampedMessage]] = {}
    for each in samples:
        if each.stamp is not None:
            by_sender.setdefault(each.sender, []).append(StampedMessage(each.stamp, each.now))
    for stamped in by_sender.values():
        yield from stamp_faults(stamped)


def _counted_faults(samples: Sequence[Sample]) -> Iterator[CheckFault]:
    """Yield the faults in fields, each once, with the number of messages that have it."""
    counts = Counter(fault for sample in samples for fault in sample.faults)
    for fault, count in counts.most_common(MOST):
        share = f"{count} of {len(samples)} messages"
        example = f"{fault.example}; {share}" if fault.example else share
        yield replace(fault, example=example if len(samples) > 1 else fault.example)
    if len(counts) > MOST:
        yield warn(f"{len(counts) - MOST} more faults in its fields")


def _frames(
    expected: Expectation, samples: Sequence[Sample], tree: TransformTree
) -> Iterator[CheckFault]:
    if expected.frame is None:
        usual = []
    else:  # a robot's own name of its base counts as well
        every = (tree.frames, replace(tree.frames, base=tree.body or tree.frames.base))
        usual = [expected.frame(frames) for frames in every]
    for used in dict.fromkeys(each.frame for each in samples if each.frame is not None):
        yield from frame_faults(tree, used, usual, reachable=expected.row != "odom")
    if expected.row == "odom":  # whose transform is a matter of `tf`
        for used in dict.fromkeys(each.child for each in samples):
            yield from child_faults(tree, used)


def _promise(expected: Expectation) -> str:
    latched = "latched" if expected.latched else ""
    every = f"{expected.rate:g} Hz" if expected.rate else ""
    return ", ".join(filter(None, (expected.type_name, latched, every)))


def _found(
    samples: Sequence[Sample], measured: float | None, there: EndpointSides, facts: RobotFacts
) -> str:
    if not samples:
        return "nothing came"
    messages = f"{len(samples)} message{'' if len(samples) == 1 else 's'}"
    parts = [messages if measured is None else f"{measured:.1f} Hz"]
    parts += sorted({each.frame for each in samples if each.frame})[:1]
    others = sorted({each.node for each in there.robot if each.node != facts.node.full})
    parts += [f"by {each}" for each in others if each][:1]
    return printable(", ".join(parts))


def _with(
    row: CheckRow, faults: Iterable[CheckFault], *, found: str, rate: float | None = None
) -> CheckRow:
    """Return `row` with its faults, each once, the worst first."""
    once = sorted(dict.fromkeys(faults), key=lambda fault: -ORDER.index(fault.level))
    return replace(row, found=found, rate=rate, faults=tuple(once))
