"""The driver of a camera against cameras on the network, good and bad."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest

from pioneer3 import mjpeg
from pioneer3.errors import ConfigError, DeviceError
from pioneer3.mjpeg import START, Credentials, authorization, parse_url
from pioneer3.navigation.connect import connect_async
from pioneer3.robot import camera_driver
from pioneer3.robot.camera_driver import CameraDriver
from pioneer3.robot.devices.pictures import decode
from pioneer3.state import Picture
from pioneer3.tasks import running
from tests.cameras import Script, fake_camera, films, jpeg_of, says
from tests.support import SimulatedRobot, until

pytestmark = pytest.mark.realtime

RED, BLUE = (200, 30, 30), (30, 30, 200)


@pytest.fixture(autouse=True)
def hurry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(camera_driver, "BACK_OFF", (0.02, 0.05))
    monkeypatch.setattr(camera_driver, "SILENCE", 0.3)
    monkeypatch.setattr(camera_driver, "LINGER", 0.1)


@asynccontextmanager
async def driven(url: str) -> AsyncIterator[CameraDriver]:
    driver = CameraDriver(url)
    async with running(driver.run()):
        yield driver


def color_of(picture: Picture) -> tuple[int, ...]:
    return tuple(decode(picture).pixels.mean(axis=(0, 1)).round().astype(int).tolist())


async def test_pictures_come_with_their_time_and_number() -> None:
    async with fake_camera(films(RED)) as camera, driven(camera.url) as driver:
        clock = asyncio.get_running_loop().time
        before = clock()
        first = await driver.picture()
        assert before <= first.stamp <= clock()
        second = await driver.picture(max_age=0.0)
        assert second.sequence > first.sequence
        assert color_of(second) == pytest.approx(RED, abs=4)
        assert driver.connected


async def test_a_young_picture_is_used_again_and_an_old_one_is_not() -> None:
    async with (
        fake_camera(films(RED, count=1), films(BLUE)) as camera,
        driven(camera.url) as driver,
    ):
        first = await driver.picture()
        assert await driver.picture(max_age=10.0) is first
        await asyncio.sleep(0.05)
        assert color_of(await driver.picture(max_age=0.01)) == pytest.approx(BLUE, abs=4)


async def test_it_connects_only_while_pictures_are_wanted() -> None:
    async with fake_camera(films(RED)) as camera, driven(camera.url) as driver:
        await asyncio.sleep(0.05)
        assert camera.requests == []
        await driver.picture()
        assert not camera.left.is_set()
        async with asyncio.timeout(5):
            await camera.left.wait()
        await until(lambda: not driver.connected)
        assert "is asked when" in driver.presence.reason
        await driver.picture(max_age=0.0)
        assert len(camera.requests) == 2


async def test_a_lost_camera_is_found_again() -> None:
    scripts = films(RED, count=2), says(b""), says(b"garbage\r\n\r\n"), films(BLUE)
    async with fake_camera(*scripts) as camera, driven(camera.url) as driver:
        async for picture in driver.values():
            if color_of(picture) == pytest.approx(BLUE, abs=4):
                break
        assert len(camera.requests) == 4


HEAD = mjpeg.stream_head()
PART = b"--pioneer3picture\r\nContent-Type: image/jpeg\r\n"


async def drips(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Send a byte of a header now and then, for ever."""
    writer.write(HEAD + PART)
    while not writer.is_closing():
        writer.write(b"x")
        await writer.drain()
        await asyncio.sleep(0.02)


async def floods(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Send a picture without end."""
    writer.write(HEAD + PART + b"\r\n" + START)
    while not writer.is_closing():
        writer.write(bytes(1 << 18))
        await writer.drain()


@pytest.mark.parametrize(
    ("script", "said"),
    [
        (says(b"", then_waits=True), "no picture for"),
        (says(HEAD, then_waits=True), "no picture for"),
        (says(b"SSH-2.0-x\r\n\r\n"), "does not speak HTTP"),
        (says(b"HTTP/1.0 404 Not Found\r\n\r\n"), "no such page"),
        (says(HEAD + PART + b"Content-Length: 1000000000\r\n\r\n"), "the most is 8 MB"),
        (says(HEAD + b"X: y\r\n" * 9000), "headers of more than"),
        (says(HEAD + mjpeg.part(b"no JPEG") * 3, then_waits=True), "no JPEG pictures: 3"),
        (says(HEAD + mjpeg.part(jpeg_of())[:200]), "closed the connection"),
        (says(HEAD + (PART + b"Content-Length: 0\r\n\r\n") * 9000), "more than 200 pictures a s"),
        (drips, "no picture for"),
        (floods, "the most is 8 MB"),
    ],
)
async def test_a_bad_camera_is_told_from_a_good_one_and_costs_no_memory(
    script: Script, said: str
) -> None:
    async with fake_camera(script) as camera, driven(camera.url) as driver:
        with pytest.raises(DeviceError, match=said):
            await driver.picture(patience=1.5)
        assert len(camera.requests) < 100


async def test_more_pictures_than_a_camera_sends_are_refused() -> None:
    flood = says(HEAD + mjpeg.part(jpeg_of()) * 5000, then_waits=True)
    async with fake_camera(flood) as camera, driven(camera.url) as driver:
        with driver.wanted():
            await until(lambda: "more than 200" in driver.presence.reason)
        assert driver.pictures < 1000


async def test_a_camera_that_is_not_there_is_named() -> None:
    async with driven("http://127.0.0.1:9/") as driver:
        with pytest.raises(DeviceError, match=r"127\.0\.0\.1:9.*refused"):
            await driver.picture(patience=0.3)


@pytest.mark.parametrize(
    ("challenge", "answer"),
    [
        ('Basic realm="AXIS"', b"Authorization: Basic cm9vdDpwYXNz\r\n"),
        ('Digest realm="AXIS", nonce="01ab", qop="auth"', b'Authorization: Digest username="root"'),
    ],
)
async def test_a_password_is_sent_when_the_camera_asks_for_it(
    challenge: str, answer: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    logins = tmp_path / "netrc"
    logins.write_text("machine 127.0.0.1 login root password pass\n")
    logins.chmod(0o600)
    monkeypatch.setenv("NETRC", str(logins))
    asks = f"HTTP/1.0 401 Unauthorized\r\nWWW-Authenticate: {challenge}\r\n\r\n".encode()
    async with fake_camera(says(asks), films(RED)) as camera, driven(camera.url) as driver:
        await driver.picture()
        assert b"Authorization" not in camera.requests[0]
        assert answer in camera.requests[1]
        assert "pass" not in f"{driver.url} {driver.presence}"


@pytest.mark.parametrize(
    ("challenge", "said"), [("Basic realm=x", "refuses the user or the pass"), ("NTLM", "'NTLM'")]
)
async def test_a_wrong_login_and_one_of_another_kind_are_told(
    challenge: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    logins = tmp_path / "netrc"
    logins.write_text("machine 127.0.0.1 login root password pass\n")
    logins.chmod(0o600)
    monkeypatch.setenv("NETRC", str(logins))
    asks = f"HTTP/1.0 401 Unauthorized\r\nWWW-Authenticate: {challenge}\r\n\r\n".encode()
    async with fake_camera(says(asks)) as camera, driven(camera.url) as driver:
        with pytest.raises(DeviceError, match=said):
            await driver.picture(patience=0.3)


async def test_a_login_that_others_may_read_is_told_and_a_missing_one_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asks = b"HTTP/1.0 401 Unauthorized\r\nWWW-Authenticate: Basic realm=x\r\n\r\n"
    monkeypatch.setenv("NETRC", str(tmp_path / "netrc"))
    async with fake_camera(says(asks), says(asks)) as camera, driven(camera.url) as driver:
        with pytest.raises(DeviceError, match=r"\.netrc"):
            await driver.picture(patience=0.3)
        (tmp_path / "netrc").write_text("machine 127.0.0.1 login")
        with pytest.raises(DeviceError, match="netrc"):
            await driver.picture(patience=1.0)


def test_a_digest_is_that_of_the_rfc() -> None:
    # RFC 7616, 3.9.1
    url, login = (
        parse_url("http://www.example.org/dir/index.html"),
        Credentials("Mufasa", "Circle of Life"),
    )
    challenge = (
        'Digest realm="http-auth@example.org", qop="auth, auth-int", algorithm=MD5, '
        'nonce="7ypf/xlj9XXwfDPEoM4URrv/xwf94BcCAzFZH4GiTo0v", '
        'opaque="FQhe/qaU925kfnzjCev0ciny7QMkPqMAFRtzCUYo5tdS"'
    )
    nonce = "f2/wE4q74E6zIJEtWaHKaf5wv/H5QzzpXusqGemxURZJ"
    assert 'response="8ca523f5e9506fed4657c9700eebdbec"' in authorization(
        url, login, challenge, nonce
    )
    secure = authorization(url, login, challenge.replace("MD5", "SHA-256"), nonce)
    assert "753927fa0e85d155564e2e272a28d1802ca10daf4496794697cf8db5856cb6c1" in secure


def test_a_broken_and_a_giant_picture_are_refused() -> None:
    torn = jpeg_of(size=(64, 64))
    giant = bytearray(torn)
    at = giant.index(b"\xff\xc0") + 5
    giant[at : at + 4] = b"\xff\xff\xff\xff"
    for data in (torn[:300] + mjpeg.END, START + b"nonsense" + mjpeg.END, bytes(giant)):
        with pytest.raises(DeviceError, match="picture"):
            decode(Picture(stamp=0.0, sequence=1, jpeg=data))


async def test_a_robot_gives_the_newest_image_and_turns_the_camera_as_before() -> None:
    async with (
        fake_camera(films(RED)) as camera,
        SimulatedRobot() as robot,
        connect_async(robot.open, camera=camera.url) as driver,
    ):
        image = await driver.devices.camera.image()
        assert image.pixels.shape == (24, 32, 3)
        assert image.pixels.dtype == np.uint8
        assert np.asarray(image) is image.pixels
        image.pixels[0, 0] = 0
        assert driver.devices.camera("vcc4") is driver.devices.camera.ptz("vcc4")
        async for picture in driver.devices.camera.pictures():
            assert picture.jpeg.startswith(START)
            break


async def test_without_a_camera_the_error_says_what_to_do() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        with pytest.raises(DeviceError, match="--camera"):
            await driver.devices.camera.image()
        with pytest.raises(ConfigError, match="MJPEG"):
            async with connect_async(robot.open, camera="cam"):
                pass
