"""One evolution of a net, as the interpreter of charts makes it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from plcopen_sfc.semantics.charts.transition_firing import Move, choice
from plcopen_sfc.semantics.net import Competing, Net
from plcopen_sfc.semantics.profile import PROFILES
from plcopen_sfc.semantics.programs.runtime_types import Frame, Layout


def fire(net: Net, marking: int, true: int, competing: Competing = Competing.PRIORITY) -> tuple[int, int]:
    """The next marking and the transitions that fired, where `true` are those with a true condition."""
    choose = choice(replace(PROFILES["iec"], competing=competing))
    enabled = [net.transitions[index] for index in net.enabled(marking)]
    moves = [Move(t.pre, t.post, t.bit, partial(_is_true, true & t.bit), False, t.path) for t in enabled]
    cleared = choose(Frame(Layout(""), []), moves)
    return marking & ~cleared.left | cleared.entered, cleared.transitions


def _is_true(bit: int, _: Frame) -> bool:
    return bit != 0
