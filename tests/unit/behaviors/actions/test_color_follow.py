from dataclasses import dataclass, field
from math import radians

import pytest

from pioneer3.behaviors.action import Desire
from pioneer3.behaviors.actions import ColorFollow, ColorPatch
from tests.unit.behaviors.support import seen, value


@dataclass
class Camera:
    blobs: dict[int, ColorPatch] = field(default_factory=dict)

    def largest(self, channel: int) -> ColorPatch | None:
        return self.blobs.get(channel)


@pytest.mark.parametrize(
    ("x", "degrees"),
    [(0.0, 0), (0.2, 0), (-0.2, 0), (0.5, -5), (-1.0, 10)],  # right of the middle is clockwise
)
def test_it_keeps_the_patch_in_the_middle(x: float, degrees: float) -> None:
    follow = ColorFollow(Camera({1: ColorPatch(x=x, stamp=0.0)}), moving=True)
    desire = follow.decide(seen(1.0))
    assert desire.v == 0.2
    assert desire.turn == pytest.approx(radians(degrees))


def test_it_stands_until_it_is_told_to_move() -> None:
    follow = ColorFollow(Camera({1: ColorPatch(x=0.5, stamp=0.0)}))
    assert (follow.decide(seen()).v, follow.decide(seen()).turn) == (0.0, 0.0)


def test_other_channels_are_other_colours() -> None:
    follow = ColorFollow(Camera({2: ColorPatch(x=0.5, stamp=0.0)}), moving=True)
    assert follow.decide(seen()).v == 0.0
    follow.channel = 2
    assert follow.decide(seen()).v == 0.2


def test_a_lost_patch_is_waited_for_or_looked_for_where_it_was() -> None:
    camera = Camera({1: ColorPatch(x=0.9, stamp=0.0)})
    follow = ColorFollow(camera, moving=True)
    assert follow.decide(seen(2.0)).v == 0.2
    assert follow.decide(seen(2.1)) == Desire(v=0.0, turn=0.0, reason="no blob in sight")
    follow.acquiring = True
    assert value(follow.decide(seen(2.2)), "w") == pytest.approx(-radians(10))
