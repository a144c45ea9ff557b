"""Spots of a laser agree with arrays of numpy, plain and compiled."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.arrays import Float
from pioneer3.jit import numba_version
from pioneer3.maps.materials import MATT, REFERENCE, REMISSION, Codes
from pioneer3.sim.kernels import Kernels, compiled_kernels
from pioneer3.sim.kernels.spots import EDGE, SLANT_NOISE

COUNT = 60
FAR, DARK = 30.0, 10.0
DIVERGENCE, SIZE = 2.6e-3, 0.01
APART = 1.5e-3
BANDS = np.array([[0.1, 10.0, 31.0], [0.01, 0.02, 0.05], [0.0, 1e-3, 0.0], [3e-3, 0.01, 0.03]])


def oracle(
    rays: tuple[Float, Codes], layout: tuple[int, int], chance: tuple[Float, Float]
) -> Float:
    """Return ranges [m] and intensities of all spots at once, shape (2, B)."""
    (ranges, codes), (per_step, aside), (shares, normals) = rays, layout, chance
    middle = aside + per_step * np.arange(len(shares))
    off = np.rint((DIVERGENCE + SIZE / ranges[middle].clip(min=1e-3)) / 2 / APART).astype(int)
    off = off.clip(1, aside)
    places = np.stack([middle, middle - off, middle + off])
    three = ranges[places]
    inverse = 1 / three.clip(min=1e-3)
    divided = abs(2 * inverse[0] - inverse[1] - inverse[2]) * three[0] ** 2 > EDGE
    tangent = (three[2] - three[1]) / (2 * off * APART * three[0].clip(min=1e-3))
    light = np.where(divided, 1.0, np.cos(np.arctan(tangent)))
    spread = np.where(divided, 0.0, abs(three[2] - three[1]))
    near, far, which = three.min(axis=0), three.max(axis=0), three.argmin(axis=0)
    filled = three - near <= (far - near) / 2
    near, which = np.where(filled[0], three[0], near), np.where(filled[0], 0, which)
    mixed = (filled.sum(axis=0) == 1) & (far < FAR)
    seen = np.where(divided, np.where(mixed, near + shares * (far - near), near), three[0])
    code = codes[places[np.where(divided, which, 0), np.arange(len(middle))]]
    intensity = REMISSION[code] * np.where(MATT[code], light, 1.0)
    lost = (seen >= FAR) | (seen > DARK * np.sqrt(intensity / REFERENCE))
    band = np.searchsorted(BANDS[0], seen).clip(max=BANDS.shape[1] - 1)
    _, systematic, share, sigma = BANDS[:, band]
    errors = np.hypot(2 * sigma, SLANT_NOISE * spread) * normals - 0.5 * (systematic + share * seen)
    return np.stack(
        [np.where(lost, np.inf, (seen + errors).clip(min=0.0)), np.where(lost, 0.0, intensity)]
    )


@pytest.fixture(scope="module", params=["plain", "compiled"])
def kernels(request: pytest.FixtureRequest) -> Kernels:
    if request.param == "plain":
        return Kernels(compiled=False)
    if not numba_version():
        pytest.skip("numba is not installed")
    return compiled_kernels()


@given(
    seed=st.integers(0, 2**32 - 1),
    per_step=st.integers(1, 8),
    aside=st.integers(1, 8),
    steps=st.integers(1, 30),
)
def test_spots_are_those_of_the_oracle(
    kernels: Kernels, seed: int, per_step: int, aside: int, steps: int
) -> None:
    rng = np.random.default_rng(seed)
    count = (COUNT - 1) * per_step + 1 + 2 * aside
    # surfaces of some rays each, smooth and slanted, near and out of range
    surface = np.arange(count) // steps
    ranges = rng.choice([0.0, 0.05, 1.0, 9.0, 15.0, FAR], surface[-1] + 1)[surface]
    ranges = (ranges + rng.choice([0.0, 1e-3, 0.03]) * np.arange(count)).clip(max=FAR)
    codes = rng.integers(0, len(MATT), surface[-1] + 1)[surface].astype(np.uint8)
    chance = rng.random(COUNT), rng.standard_normal(COUNT)
    read = np.empty((2, COUNT))
    kernels.spots(
        (ranges, codes),
        (per_step, aside, APART, DIVERGENCE, SIZE),
        (FAR, DARK, REFERENCE),
        (REMISSION, MATT),
        (BANDS, -0.5, 2.0),
        chance,
        read,
    )
    expected = oracle((ranges, codes), (per_step, aside), chance)
    np.testing.assert_allclose(read, expected, rtol=1e-9, atol=1e-12)
