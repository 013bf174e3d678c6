"""The garbage collector of a host: never off, and as it was when a call returns or fails."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Iterator
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.collector import collecting_rarely


class Ring:
    """An object that only the collector can free."""

    def __init__(self) -> None:
        self.me = self
        self.parts = [[] for _ in range(1000)]


FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"


def test_loading_leaves_the_collector_as_it_was():
    before = gc.get_threshold()
    sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml").read_all()
    with pytest.raises(sfc.SfcError):
        sfc.loads(b"<project/>", format="plcopen")
    assert gc.get_threshold() == before
    assert gc.isenabled()


def test_the_collector_is_never_off_and_threads_that_overlap_put_it_back():
    before = gc.get_threshold()
    inside, leave = threading.Event(), threading.Event()

    def other() -> None:
        with collecting_rarely():
            inside.set()
            leave.wait(10)

    thread = threading.Thread(target=other)
    with collecting_rarely():
        assert gc.isenabled()
        assert gc.get_threshold()[0] > before[0]
        thread.start()
        inside.wait(10)
    assert gc.get_threshold() != before  # the other thread is still inside
    leave.set()
    thread.join()
    assert gc.get_threshold() == before


def test_a_collector_that_the_host_has_switched_off_stays_off():
    before = gc.get_threshold()
    try:
        gc.set_threshold(0)
        with collecting_rarely():
            assert gc.get_threshold()[0] == 0
        assert gc.get_threshold()[0] == 0
    finally:
        gc.set_threshold(*before)


@pytest.fixture
def plain_collector() -> Iterator[None]:
    """The collector as a program starts with it: the tests have frozen what they begin with."""
    frozen, before = gc.get_freeze_count(), gc.get_threshold()
    gc.unfreeze()
    gc.set_threshold(700, 10, 10)
    yield
    gc.set_threshold(*before)
    if frozen:
        gc.freeze()


@pytest.mark.usefixtures("plain_collector")
def test_what_was_made_becomes_old_and_garbage_in_it_is_found():
    gc.collect()
    rings = []
    for _ in range(2000):
        with collecting_rarely():
            rings.append(weakref.ref(Ring()))
        assert gc.get_count()[0] < 500
    assert sum(ring() is not None for ring in rings) < 1500
    gc.collect()
    assert not any(ring() is not None for ring in rings)


@pytest.mark.usefixtures("plain_collector")
def test_objects_that_the_host_has_frozen_stay_so():
    gc.freeze()
    frozen = gc.get_freeze_count()
    with collecting_rarely():
        made = [[] for _ in range(2000)]
    assert gc.get_freeze_count() > frozen // 2  # some are freed meanwhile
    assert len(made) == 2000
