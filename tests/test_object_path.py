"""Paths of objects: made of parts, printed once, and asked for what they are in."""

from __future__ import annotations

import copy
import pickle

import pytest

from plcopen_sfc.object_path import ObjectPath


def test_a_path_is_its_text_and_knows_its_parts():
    path = ObjectPath("POU Main", "", "step S3") / "action Valve"
    assert path == "POU Main / step S3 / action Valve"
    assert path.parts == ("POU Main", "step S3", "action Valve")
    assert (path.owner, path.last, path.around) == ("POU Main", "action Valve", "POU Main / step S3")
    assert [*path.outwards()] == [path, "POU Main / step S3", "POU Main"]
    assert path.inside("POU Main") == "step S3 / action Valve"


def test_a_name_with_a_slash_in_it_stays_one_part():
    path = ObjectPath("POU In / Out", "step S1")
    assert path.owner == "POU In / Out"
    assert path.around == "POU In / Out"
    for again in (copy.deepcopy(path), pickle.loads(pickle.dumps(path)), ObjectPath.of(path)):  # noqa: S301  # our own
        assert again == path
        assert again.parts == path.parts


@pytest.mark.parametrize(
    ("path", "other", "is_in"),
    [("POU A / step S", "POU A", True), ("POU A", "POU A", True), ("POU AB / step S", "POU A", False),
     ("POU A", "POU A / step S", False)],
)  # fmt: skip
def test_a_path_is_in_another_by_whole_parts(path, other, is_in):
    assert ObjectPath.of(path).is_in(other) is is_in


def test_nothing_has_no_parts():
    assert ObjectPath.of(None) == ObjectPath.of("") == ObjectPath()
    assert (ObjectPath().owner, ObjectPath().last, [*ObjectPath().outwards()]) == ("", "", [])
