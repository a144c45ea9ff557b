"""The geometry of a simulated camera, and the messages to the process that renders."""

import io
from math import cos, sin

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.sim.physics.renderer import (
    LENGTH,
    Answer,
    Failed,
    LoadScene,
    PictureRequest,
    TakePicture,
    axes,
    framed,
    serve,
)

LOAD = LoadScene(b"mjb", b"groups")
ANGLES = st.floats(-1.5, 1.5)
ASKED = TakePicture(camera="a/camera", qpos=b"12345678", people=b"", view=0.8, width=4, height=3)


@given(ANGLES, ANGLES)
def test_the_axes_are_a_rotation_that_looks_along_pan_and_tilt(pan: float, tilt: float) -> None:
    turned = axes(pan, tilt)
    assert turned.T @ turned == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turned) == pytest.approx(1.0)
    ahead = (cos(tilt) * cos(pan), cos(tilt) * sin(pan), sin(tilt))
    assert -turned[:, 2] == pytest.approx(ahead)
    assert turned[2, 0] == 0.0  # the horizon is level
    assert turned[2, 1] > 0.0  # the sky is above


def test_a_message_comes_out_as_it_went_in() -> None:
    for message in (LOAD, ASKED):
        data = framed(message)
        assert int.from_bytes(data[:LENGTH], "big") == len(data) - LENGTH
        decoded = msgspec.msgpack.decode(data[LENGTH:], type=LoadScene | TakePicture)
        assert decoded == message


def test_without_opengl_the_process_says_why_and_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing() -> None:
        raise ImportError("no libEGL")

    monkeypatch.setattr("pioneer3.sim.physics.renderer.SceneRenderer", missing)
    assert answers(ASKED) == [Failed("ImportError: no libEGL")]


def test_a_picture_that_cannot_be_is_refused_and_the_next_one_is_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Broken:
        asked = 0

        def load(self, world: LoadScene) -> None:
            assert world == LOAD

        def picture(self, asked: TakePicture) -> bytes:
            self.asked += 1
            if self.asked == 1:
                raise ValueError("no such camera")
            return b"jpeg"

    monkeypatch.setattr("pioneer3.sim.physics.renderer.SceneRenderer", Broken)
    said = answers(LOAD, ASKED, ASKED)[1:]
    assert said == [Failed("no such camera"), PictureRequest(b"jpeg")]


def answers(*requests: LoadScene | TakePicture) -> list[Answer]:
    """Return what the process says to these requests."""
    out = io.BytesIO()
    serve(io.BytesIO(b"".join(map(framed, requests))), out, "egl")
    said, data = list[Answer](), out.getvalue()
    while data:
        end = LENGTH + int.from_bytes(data[:LENGTH], "big")
        said.append(msgspec.msgpack.decode(data[LENGTH:end], type=Answer))
        data = data[end:]
    return said
