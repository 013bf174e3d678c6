"""The standard function blocks while a program runs: flip-flops, edges, counters and timers (ed. 3, 6.6.3.5).

Of the library Util of CODESYS there is BLINK, which projects use for lamps.

Every block is a function of the slots of its instance. Timers keep the instant at which they were started in a slot
of the type INSTANT, so that a snapshot does not depend on when it is taken.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs.runtime import Processor
from plcopen_sfc.semantics.programs.runtime_types import BOOL, INSTANT, Direction, Frame, Layout, ScalarType, elementary

Run = Callable[[Frame], None]

# The slots `v[0]`, `v[1]`, .. are the pins of a block in the order of `_BISTABLE`, `_COUNTERS` and `_TIMER_PINS`: RS
# has S, R1 and Q1.


def reset_dominant(frame: Frame) -> None:
    """RS of IEC 61131-3: S, R1."""
    v = frame.v
    v[2] = not v[1] and (v[0] or v[2])


def set_dominant(frame: Frame) -> None:
    """SR of IEC 61131-3: S1, R."""
    v = frame.v
    v[2] = v[0] or (not v[1] and v[2])


def rising(frame: Frame) -> None:
    """R_TRIG. The first call with TRUE is an edge (ed. 3, table 44, note)."""
    v = frame.v
    v[1] = v[0] and not v[2]
    v[2] = v[0]


def falling(frame: Frame) -> None:
    """F_TRIG. The first call with FALSE is an edge (ed. 3, table 44, note)."""
    v = frame.v
    v[1] = not v[0] and not v[2]
    v[2] = not v[0]


def falling_s7(frame: Frame) -> None:
    """F_TRIG of S7, which compares with the state of the last call, at first FALSE (TIA Portal help)."""
    v = frame.v
    v[1] = not v[0] and v[2]
    v[2] = v[0]


def count_up(frame: Frame, greatest: int) -> None:
    """CTU."""
    v = frame.v
    if v[1]:
        v[4] = 0
    elif v[0] and not v[5] and v[4] < greatest:
        v[4] += 1
    v[5] = v[0]
    v[3] = v[4] >= v[2]


def count_down(frame: Frame, least: int) -> None:
    """CTD."""
    v = frame.v
    if v[1]:
        v[4] = v[2]
    elif v[0] and not v[5] and v[4] > least:
        v[4] -= 1
    v[5] = v[0]
    v[3] = v[4] <= 0


def count_up_down(frame: Frame, least: int, greatest: int) -> None:
    """CTUD. Edges of both inputs in one call count nothing (ed. 3, table 45)."""
    v = frame.v
    up, down = v[0] and not v[8], v[1] and not v[9]
    v[8], v[9] = v[0], v[1]
    if v[2]:
        v[7] = 0
    elif v[3]:
        v[7] = v[4]
    elif up and not down and v[7] < greatest:
        v[7] += 1
    elif down and not up and v[7] > least:
        v[7] -= 1
    v[5] = v[7] >= v[4]
    v[6] = v[7] <= 0


def on_delay(frame: Frame, now: int, unit: int) -> None:
    """TON. Once Q is TRUE it stays so until IN is FALSE, whatever happens to PT."""
    v = frame.v
    if not v[0]:
        v[2], v[3], v[4] = False, 0, None
    elif not v[2]:
        if v[4] is None:
            v[4] = now
        elapsed = (now - v[4]) // unit * unit
        if elapsed >= v[1]:
            v[2], v[3], v[4] = True, max(v[1], 0), None
        else:
            v[3] = elapsed


def off_delay(frame: Frame, now: int, unit: int) -> None:
    """TOF."""
    v = frame.v
    if v[0]:
        v[2], v[3], v[4] = True, 0, None
    elif v[2]:
        if v[4] is None:
            v[4] = now
        elapsed = (now - v[4]) // unit * unit
        if elapsed >= v[1]:
            v[2], v[3], v[4] = False, max(v[1], 0), None
        else:
            v[3] = elapsed


def pulse(frame: Frame, now: int, unit: int) -> None:
    """TP. While the pulse lasts, IN does nothing; ET stays at PT until IN is FALSE."""
    v = frame.v
    if v[0] and not v[5] and not v[2]:
        v[2], v[4] = True, now
    v[5] = v[0]
    if v[2]:
        elapsed = (now - v[4]) // unit * unit
        if elapsed >= v[1]:
            v[2], v[3], v[4] = False, max(v[1], 0), None
        else:
            v[3] = elapsed
    if not v[2] and not v[0]:
        v[3] = 0


def accumulate(frame: Frame, now: int, unit: int) -> None:
    """TONR of S7: adds up the time that IN is TRUE until R."""
    v = frame.v
    if v[5]:
        v[2], v[3], v[4] = False, 0, None
    elif not v[0]:
        v[4] = None
    else:
        if v[4] is None:
            v[4] = now
        elapsed = (now - v[4]) // unit * unit
        v[4] += elapsed
        v[3] = min(v[3] + elapsed, max(v[1], 0))
    if not v[5]:
        v[2] = v[2] or v[3] >= v[1]


def blink(frame: Frame, now: int, unit: int) -> None:  # noqa: ARG001
    """BLINK of the library Util of CODESYS: OUT is TRUE for TIMEHIGH, then FALSE for TIMELOW, and so on.

    While ENABLE is FALSE, OUT keeps its value (CODESYS, Util, BLINK). Each rising edge of ENABLE begins with TRUE.
    """
    v = frame.v
    if not v[0]:
        v[4] = None
    elif v[4] is None:
        v[3], v[4] = True, now
    elif now - v[4] >= (v[2] if v[3] else v[1]):
        v[3], v[4] = not v[3], now


_TIMERS: dict[str, Callable[[Frame, int, int], None]] = {
    "TON": on_delay,
    "TOF": off_delay,
    "TP": pulse,
    "TONR": accumulate,
}
_COUNTERS = {
    "CTU": "CU:BOOL R:BOOL PV > Q:BOOL CV - M1:BOOL",
    "CTD": "CD:BOOL LD:BOOL PV > Q:BOOL CV - M1:BOOL",
    "CTUD": "CU:BOOL CD:BOOL R:BOOL LD:BOOL PV > QU:BOOL QD:BOOL CV - M1:BOOL M2:BOOL",
}
_BISTABLE = {
    "RS": ("S:BOOL R1:BOOL > Q1:BOOL", reset_dominant),
    "SR": ("S1:BOOL R:BOOL > Q1:BOOL", set_dominant),
    "R_TRIG": ("CLK:BOOL > Q:BOOL - M:BOOL", rising),
    "F_TRIG": ("CLK:BOOL > Q:BOOL - M:BOOL", falling),
}
_TIMER_PINS = "IN:BOOL PT:TIME > Q:BOOL ET:TIME - START:INSTANT"
_BLINK_PINS = "ENABLE:BOOL TIMELOW:TIME TIMEHIGH:TIME > OUT:BOOL - START:INSTANT"
_S7_TYPES = re.compile(
    r"(?P<block>TONR|TON|TOF|TP)_(?P<time>L?TIME)|IEC_(?P<timer>L?TIMER)"
    r"|(?P<counter>CTUD|CTU|CTD)_(?P<of>[US]?S?[ID]?[IL]?NT)|IEC_(?P<any>[US]{0,2}D?)COUNTER",
    re.IGNORECASE,
)


@dataclass(frozen=True, slots=True)
class BlockType:
    """A standard function block: its layout and what a call does. `methods`: what S7 calls on an instance by name."""

    layout: Layout
    run: Run | None
    methods: dict[str, Run]


class BlockTypes:
    """The standard function blocks of a dialect; `of_matiec`: those of its library."""

    def __init__(self, dialect: Dialect, processor: Processor, *, of_matiec: bool) -> None:
        self._dialect = dialect
        self._of_matiec = of_matiec
        self._processor = processor
        self._made: dict[str, BlockType | None] = {}

    def find(self, name: str) -> BlockType | None:
        """The block of this name, those of S7 too (``TON_TIME``, ``IEC_TIMER``, ``CTU_DINT``); None: there is none."""
        key = name.upper()
        if key not in self._made:
            self._made[key] = self._make(key)
        return self._made[key]

    def of_layout(self, layout: Layout) -> BlockType | None:
        """Return the block whose instances have this layout."""
        return next((made for made in self._made.values() if made is not None and made.layout is layout), None)

    def _make(self, name: str) -> BlockType | None:
        if name in _BISTABLE:
            pins, run = _BISTABLE[name]
            if name == "F_TRIG" and self._dialect is Dialect.SCL:
                run = falling_s7
            return BlockType(_layout(name, pins, BOOL, BOOL), run, {})
        if name in _TIMERS:
            return self._timer(name, name, self._type("TIME"))
        if name in ("LTON", "LTOF", "LTP"):
            return self._timer(name, name[1:], self._type("LTIME"))
        if name in _COUNTERS:
            codesys = self._dialect in (Dialect.CODESYS, Dialect.TWINCAT)
            return self._counter(name, name, self._type("WORD" if codesys else "INT"))
        if name == "BLINK":
            time = self._type("TIME")
            return BlockType(_layout(name, _BLINK_PINS, time, time), self._timed(blink, time.unit), {})
        found = _S7_TYPES.fullmatch(name)
        if found is None:
            return None
        if found["block"]:
            return self._timer(name, found["block"], self._type(found["time"]))
        if found["timer"]:
            return self._timer(name, "", self._type(found["timer"].removesuffix("R")))
        if found["counter"]:
            type_ = elementary(found["of"], self._dialect)
            return self._counter(name, found["counter"], type_) if type_ is not None else None
        type_ = elementary(
            {"US": "USINT", "S": "SINT", "U": "UINT", "D": "DINT", "UD": "UDINT"}.get(found["any"], "INT")
        )
        return self._counter(name, "", type_) if type_ is not None else None

    def _type(self, name: str) -> ScalarType:
        found = elementary(name, self._dialect)
        assert found is not None  # noqa: S101  # names of our own
        return found

    def _timer(self, name: str, kind: str, time: ScalarType) -> BlockType:
        # an IEC_TIMER is started as any of the four: it has the input R of TONR and the memory of the others
        more = {"TONR": "R:BOOL", "": "R:BOOL LAST:BOOL"}.get(kind, "LAST:BOOL")
        layout = _layout(name, f"{_TIMER_PINS} {more}", time, time)
        if kind:
            run = self._timed(_TIMERS[kind], time.unit)
            return BlockType(layout, run, {kind: run})
        methods = {kind: self._timed(run, time.unit) for kind, run in _TIMERS.items()}
        methods["TP"] = self._timed(_pulse_of_any, time.unit)
        return BlockType(layout, None, methods)

    def _timed(self, run: Callable[[Frame, int, int], None], unit: int) -> Run:
        processor = self._processor
        return lambda frame: run(frame, processor.now, unit)

    def _counter(self, name: str, kind: str, type_: ScalarType) -> BlockType:
        least, greatest = type_.least, type_.greatest
        runs: dict[str, Run] = {
            "CTU": lambda frame: count_up(frame, greatest),
            "CTD": lambda frame: count_down(frame, least),
            "CTUD": lambda frame: count_up_down(frame, least, greatest),
        }
        if self._of_matiec:  # they end at PV and at 0
            runs["CTU"] = lambda frame: count_up(frame, frame.v[2])
            runs["CTD"] = lambda frame: count_down(frame, 0)
            runs["CTUD"] = lambda frame: count_up_down(frame, 0, frame.v[4])
        if kind:
            return BlockType(_layout(name, _COUNTERS[kind], type_, type_), runs[kind], {kind: runs[kind]})
        layout = _layout(name, f"{_COUNTERS['CTUD']} Q:BOOL", type_, type_)
        methods = {
            "CTU": lambda frame: _any_counter(frame, least, greatest, up=True),
            "CTD": lambda frame: _any_counter(frame, least, greatest, up=False),
            "CTUD": runs["CTUD"],
        }
        return BlockType(layout, None, methods)


def _pulse_of_any(frame: Frame, now: int, unit: int) -> None:
    """TP on an IEC_TIMER, which has one slot more."""
    v = frame.v
    v[5], v[6] = v[6], v[5]
    pulse(frame, now, unit)
    v[5], v[6] = v[6], v[5]


def _any_counter(frame: Frame, least: int, greatest: int, *, up: bool) -> None:
    """CTU or CTD on an IEC_COUNTER, which has the slots of both; the output Q of the call is one of QU and QD."""
    v = frame.v
    if up:
        v[1] = v[3] = False
    else:
        v[0] = v[2] = False
    count_up_down(frame, least, greatest)
    v[10] = v[5] if up else v[6]


def _layout(name: str, pins: str, value: ScalarType, time: ScalarType) -> Layout:
    """Return a layout from pins: inputs > outputs - hidden ones."""
    layout = Layout(name)
    layout.is_instance = True
    direction, hidden = Direction.INPUT, False
    for pin in pins.split():
        if pin in ">-":
            direction, hidden = (Direction.OUTPUT, False) if pin == ">" else (Direction.LOCAL, True)
            continue
        pin_name, _, type_name = pin.partition(":")
        type_ = {"": value, "TIME": time, "INSTANT": INSTANT, "BOOL": BOOL}[type_name]
        made = layout.add(pin_name, type_, direction, hidden=hidden)
        made.initial = "False" if type_ is BOOL else "None" if type_ is INSTANT else "0"
    standard = standard_block(name)
    for tool in standard.tools.values() if standard is not None else ():
        for iec, own in tool.pins.items():
            layout.by_name.setdefault(own.casefold(), layout.by_name[iec.casefold()])
    if "r" in layout.by_name and name.startswith("TON"):
        layout.by_name["r"].direction = Direction.INPUT
        layout.by_name["r"].hidden = False
    return layout
