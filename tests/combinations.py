"""Combinations of parameters and examples: enough of them always, all with `--all`."""

from collections.abc import Sequence
from itertools import combinations, product
from typing import Any

import pytest
from hypothesis import settings

Row = tuple[Any, ...]
Pair = tuple[int, Any, int, Any]


def pairwise(*choices: Sequence[Any]) -> list[Any]:
    """Return every combination of `choices` as a parameter set; most are marked `thorough`.

    Those that are not contain each pair of values of two parameters at least once: most faults that
    a combination shows need no more than two of its values.
    """
    rows = list(product(*choices))
    covering = _covering(rows)
    thorough = pytest.mark.thorough
    return [pytest.param(*row, marks=() if row in covering else thorough) for row in rows]


def examples(number: int) -> int:
    """Return how many examples stand for `number`: a quarter of it in the quick tier."""
    usual = settings.get_profile("thorough").max_examples
    return max(1, number * settings().max_examples // usual)


def _covering(rows: Sequence[Row]) -> set[Row]:
    """Return a few of `rows` that contain every pair; the richest first."""
    missing = {pair for row in rows for pair in _pairs(row)}
    chosen: set[Row] = set()
    while missing:
        row = max(rows, key=lambda row: len(missing & _pairs(row)))
        chosen.add(row)
        missing -= _pairs(row)
    return chosen


def _pairs(row: Row) -> set[Pair]:
    return {(i, row[i], j, row[j]) for i, j in combinations(range(len(row)), 2)}
