"""The fast frames of a sweep are those that the declarative codecs give."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import to_payload
from pioneer3.sim.firmware.laser import SweepFrames, packets
from tests.combinations import examples

WORD = st.integers(-0x8000, 0x7FFF)


@settings(max_examples=examples(150))
@given(
    total=st.one_of(st.integers(1, 100), st.sampled_from([181, 361, 541, 721])),
    extended=st.booleans(),
    pose=st.tuples(WORD, WORD, WORD),
    data=st.data(),
)
def test_a_sweep_is_the_same_bytes_however_it_is_written(
    total: int, extended: bool, pose: tuple[int, int, int], data: st.DataObject
) -> None:
    writer = SweepFrames(total, extended=extended)
    for _ in range(2):  # nothing of the sweep before may be left over
        seed = data.draw(st.integers(0, 2**32 - 1))
        ranges = np.random.default_rng(seed).integers(0, 0x10000, total, dtype=np.uint16)
        sweep = packets(pose, ranges.tolist(), extended=extended)
        expected = b"".join(encode(to_payload(packet)) for packet in sweep)
        assert writer.fill([number & 0xFFFF for number in pose], ranges) == expected
