"""The garbage collector of a host: never off, and as it was when a call returns or fails."""

from __future__ import annotations

import gc
import threading
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.collector import collecting_rarely

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
