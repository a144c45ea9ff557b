"""Reports, overheard and in one line."""

from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import (
    Config,
    Report,
    Sip,
    SipFlag,
    SonarReading,
    SyncEcho,
    SyncIdentity,
    to_payload,
)
from pioneer3.doctor.decoding_link import DecodingLink, described
from pioneer3.links.memory import null_modem


def test_a_report_is_its_id_its_class_and_what_it_carries() -> None:
    assert described(SyncEcho(1)) == "0x01 SyncEcho number=1"
    sip = Sip(
        flags=SipFlag.MOTORS_ENABLED | SipFlag.SONAR_1,
        sonar=(SonarReading(0, 512), SonarReading(1, 5000)),
    )
    line = described(sip)
    assert "flags=MOTORS_ENABLED+SONAR_1" in line
    assert "sonar=0:512,1:5000" in line
    assert "analog" not in line
    assert "extra" not in line


def test_texts_are_quoted_and_bytes_are_hex() -> None:
    line = described(SyncIdentity(name="a b", family="Pioneer", model="p3at", extra=b"\x01\xff"))
    assert line == "0x02 SyncIdentity name='a b' family='Pioneer' model='p3at' extra=01ff"


async def test_every_report_of_one_read_is_heard_and_the_bytes_pass_unchanged() -> None:
    heard: list[Report] = []
    ours, theirs = null_modem()
    link = DecodingLink(ours, lambda _, report: heard.append(report))
    config = Config(family="Pioneer", model="p3at-sh", serial_number="1")
    data = b"".join(encode(to_payload(report)) for report in (Sip(), config, SyncEcho(0)))
    await theirs.write(data)
    assert await link.read() == data
    assert [type(report) for report in heard] == [Sip, Config, SyncEcho]
    await link.write(b"x")
    assert await theirs.read() == b"x"
    await link.close()
    assert await theirs.read() == b""
