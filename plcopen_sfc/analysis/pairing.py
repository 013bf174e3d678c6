"""Common parts of two systems: inputs that are the same, what of both is compared, and in which scan.

Variables at direct addresses are what the machine is wired to: those at the same address belong together, whatever
their names are. All others do by their names.

Tools cut their scans at different places: CODESYS executes actions and then tests transitions, IEC 61131-3 tools and
S7-GRAPH the other way round. So the same chart does the same in both, but one of them does it a scan later.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from plcopen_sfc.analysis.systems import Observation, ProgramSystem
from plcopen_sfc.errors import ModelError, UnstableChartError, check_argument, shown
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.model.types import Elementary, ElementaryType, SimpleValue, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.semantics.charts.sfc_flags import COMMANDS, flags_in_use
from plcopen_sfc.semantics.profile import Evolution, Profile, ScanOrder
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.semantics.subjects import Subject, Watched, signal_of
from plcopen_sfc.whole_numbers import counted

_AUTOMATIC = (0, 1, -1, 2, -2)


@dataclass(frozen=True)
class Delay:
    """A constant delay of all that is compared.

    Args:
        scans: by how many scans the second is later; less than 0: the first is.
        late_start: the later side also begins as many scans later; inputs that operate a chart rest until then.
            Otherwise both begin together, and what the later
            side does in its first scans has no counterpart: it is not compared.
        retimed: the scans of a side that executes actions first are cut behind the actions: the transitions of one scan
            and the actions of the next see the same inputs and the same time. And no chart tests transitions in the
            first scan of the run.
        operated_later: inputs that operate a chart come a scan later on the side whose scans are not cut, but for
            `ASKED_FOR`: the other side computes in its actions what its transitions then ask for.
        in_sequence: compared are the values that each takes one after another, and not the scans in which it does; see
            `plcopen_sfc.analysis.sequences`. And no chart tests transitions in the first scan of the run.
        settled: compared is what both come to while inputs stay, behind every scan; see
            `plcopen_sfc.analysis.sequences`. Steps of a side that executes actions first are left as many scans behind
            their start as on the other side. Inputs rest in the first two scans where one tool alone tests no
            transition in its first scan. With `in_sequence`: inputs stay until both rest, and both run as they are.
    """

    scans: int = 0
    late_start: bool = False
    retimed: bool = False
    operated_later: bool = False
    in_sequence: bool = False
    settled: bool = False

    @property
    def queued(self) -> int:
        """The scans that observations of the earlier side wait for those of the later one; less than 0: of the first.

        Retimed sides are in step with the other side already, and those that are joined are not compared so.
        """
        return 0 if self.retimed or self.is_joined else self.scans

    @property
    def is_joined(self) -> bool:
        """True if both sides are not compared scan by scan; see `plcopen_sfc.analysis.sequences.Joined`."""
        return self.in_sequence or self.settled

    @property
    def is_held(self) -> bool:
        """True if no transition is tested in the first scan."""
        return self.retimed or (self.in_sequence and not self.settled)

    @property
    def is_apart(self) -> bool:
        """True if both sides are compared in different scans."""
        return self.queued != 0 or self.is_joined

    def __str__(self) -> str:
        """The delay, as ``second 1 scan later``; empty: there is none."""
        if not self.scans:
            return ""
        count = abs(self.scans)
        return f"{'second' if self.scans > 0 else 'first'} {counted(count, 'scan')} later"

    def notes(self, orders: Sequence[ScanOrder], operated: Sequence[str] = ()) -> tuple[str, ...]:
        """Return the notes on start, inputs and times; `orders`: the scan orders of the first and the second.

        `operated`: inputs that operate a chart. They rest while the earlier side runs alone, or transitions are not
        tested yet: an edge of that time would be lost.
        """
        later = "second" if self.scans > 0 else "first"
        count = abs(self.scans)
        if self.retimed:
            start = "no transition is tested in the first scan"
            start += f", and {', '.join(operated)} at rest in it" if operated else ""
            sides = [name for name, order in zip(("first", "second"), orders, strict=True) if order in _RETIMABLE]
            if not self.scans:
                return (start,)
            cut = [f"actions of the {side} see the inputs and times of the scan before" for side in sides]
            if self.operated_later:
                other = "second" if sides == ["first"] else "first"
                late = ", ".join(each for each in operated if each not in ASKED_FOR)
                cut.append(f"the {other} gets {late} 1 scan later")
            return (start, *cut)
        if self.in_sequence and not self.settled:
            return ("scans of a side that is ahead of the other wait, and so do inputs until both rest",)
        if self.settled:
            until = ", which they do until both rest" if self.in_sequence else ""
            return (f"compared is what both come to while the inputs of a scan stay{until}",)
        if not self.scans:
            return ()
        scans = "scan" if count == 1 else f"{count} scans"
        if self.late_start:
            start = f"the {later} starts {counted(count, 'scan')} later"
            return (f"{start}, and until then {', '.join(operated)} at rest",) if operated else (start,)
        return (f"the first {scans} of the {later} {'has' if count == 1 else 'have'} no counterpart",)

    def as_dict(self) -> dict[str, int | bool]:
        """Return the delay as plain data, for JSON."""
        return asdict(self)


NO_DELAY = Delay()
ASKED_FOR = frozenset({"ACK_EF", "S_SEL"})
"""The operating inputs that transitions of charts made of S7-GRAPH ask for themselves, without an action before."""
_RETIMABLE = frozenset({ScanOrder.ACTIONS_FIRST, ScanOrder.RETIMED})
_MOST_SCANS = 1_000
"""Scans of a delay: the outputs of as many are a part of each state."""


def delays(wanted: int | str | Delay | Iterable[int], profiles: Sequence[Profile]) -> tuple[Delay, ...]:
    """Return the delays to try, in this order, for a choice of ``delay=``. `profiles`: of the first and the second.

    Of each number of scans those are first that tell most: both sides as they are, begun together; one
    begun later; retimed. Raises `ModelError`.
    """
    if isinstance(wanted, Delay):
        return (wanted,)
    if wanted == "auto":
        wanted = _AUTOMATIC
    elif isinstance(wanted, str):
        raise ModelError(f"there is no delay {wanted!r}", hint='It is a number of scans, a range, or "auto".')
    if wanted == 0:
        return (NO_DELAY,)
    check_argument(wanted, (int, Iterable), "a delay is a number of scans, or several")
    tried = [wanted] if isinstance(wanted, int) else [*wanted]
    for each in tried:
        check_argument(each, int, "a delay is a number of scans")
        if abs(each) > _MOST_SCANS:
            hint = f"The longest has {_MOST_SCANS:,}."
            raise ModelError(f"a delay of {shown(each, 20)} scans is too long", hint=hint)
    numbers = sorted(tried, key=lambda each: (abs(each), -each))
    if not numbers:
        raise ModelError("there is no delay to try")
    return tuple(_forms(numbers, in_retiming(profiles)))


def in_retiming(profiles: Sequence[Profile]) -> int | None:
    """Return the scans that the second is later where scans are cut at the same place; None: that changes nothing."""
    actions_first = [each.order is not ScanOrder.TRANSITIONS_FIRST for each in profiles]
    if actions_first[0] == actions_first[1]:
        same = all(actions_first) or profiles[0].initial_situation_held == profiles[1].initial_situation_held
        return None if same else 0
    return 1 if actions_first[1] else -1


def _forms(numbers: Iterable[int], retimed_number: int | None) -> Iterator[Delay]:
    for number in numbers:
        yield Delay(number)
        if number:
            yield Delay(number, late_start=True)
        if number == retimed_number:
            yield Delay(number, retimed=True)
            if number:
                yield Delay(number, retimed=True, operated_later=True)


def retimed(profile: Profile) -> Profile:
    """Return a profile whose scans are cut behind the actions, if these come first."""
    return profile if profile.order is ScanOrder.TRANSITIONS_FIRST else replace(profile, order=ScanOrder.RETIMED)


_SEEN_OUTSIDE = frozenset({"output", "external"})


# -- inputs


def connect(
    left: ProgramSystem, right: ProgramSystem, names: Mapping[str, str], fixed: Mapping[str, Value]
) -> dict[str, Signal]:
    """Give both systems the same inputs; the inputs by the names of the left where it has them.

    `names`: of inputs of the right those in the left. `fixed`: inputs that keep a value, by their names in either.
    """
    keys = _input_keys(left, right)
    own_keys = {known: key for name, key in keys[0].items() for known in (name.casefold(), left.local_name(name))}
    renamed = {other.casefold(): own.casefold() for other, own in names.items()}
    constants = {own_keys.get(name.casefold(), name.casefold()): value for name, value in fixed.items()}
    constants |= {name.casefold(): value for name, value in fixed.items()}
    shared: dict[str, str] = {}
    signals: dict[str, Signal] = {}
    for system, own, rename in ((left, keys[0], {}), (right, keys[1], renamed)):
        own_names: dict[str, str] = {}
        own_fixed: dict[str, Value] = {}
        for name, signal in system.inputs.items():
            known = name.casefold(), system.local_name(name)
            theirs = next(filter(None, (_old_path(rename, each) for each in known)), None)
            key = own[name] if theirs is None else own_keys.get(theirs, theirs)
            constant = next((each for each in (key, *known) if each in constants), None)
            if constant is not None:
                own_fixed[name] = signal.accept(constants[constant])
                continue
            common = shared.setdefault(key, f"{name} of the second" if name in signals and key not in shared else name)
            own_names[name] = common
            before = signals.setdefault(common, signal)
            if signal.kind is SignalKind.ENUMERATION and _is_alike(before, signal):
                signals[common] = signal  # its values are those that mean something
            elif not _is_alike(before, signal):
                raise ModelError(f"the input {name} is a {before.type} in the first and a {signal.type} in the second")
        system.connect(own_names, own_fixed)
    return signals


def _old_path(renamed: Mapping[str, str], path: str) -> str | None:
    """Return the path in the other system of a variable, or of a member of one, that has another name there."""
    head = path
    while head not in renamed:
        head = head[: max(head.rfind("."), head.rfind("["), 0)]
        if not head:
            return None
    return renamed[head] + path[len(head) :]


def _input_keys(left: ProgramSystem, right: ProgramSystem) -> tuple[dict[str, str], dict[str, str]]:
    """Return a key for each input of both, equal for the same ones: an address that both have, else its name."""
    both = {left.addresses.get(name) for name in left.inputs} & {right.addresses.get(name) for name in right.inputs}

    def key(system: ProgramSystem, name: str) -> str:
        address = system.addresses.get(name)
        return f"{address}" if address is not None and address in both else system.local_name(name)

    return {name: key(left, name) for name in left.inputs}, {name: key(right, name) for name in right.inputs}


# -- outputs


def output_pairs(
    left: ProgramSystem, right: ProgramSystem, names: Mapping[str, str], *, delayed: bool
) -> list[tuple[str, Signal, str]]:
    """Return all single values that both have and that are no inputs: name and signal on the left, name on the right.

    VAR_IN_OUT are both, where one of the two writes them.
    `names`: of variables of the right those in the left, where they differ.
    `delayed`: the two see the inputs of different scans, and so do not give instances the same inputs.
    """

    def is_put_out(name: str, each: Watched) -> bool:
        return each.direction == "in_out" and any(s.writes(name) for s in (left, right) if name in s.variables)

    mine, theirs = (
        {n: each for n, each in s.variables.items() if not each.is_input or (not delayed and is_put_out(n, each))}
        for s in (left, right)
    )
    # Addresses come first: tools rename variables, but the wiring of the machine stays.
    placed = {right.addresses[name]: name for name in theirs if name in right.addresses}
    renamed = {other.casefold(): own.casefold() for other, own in names.items()}
    named = {_old_path(renamed, local) or local: name for name in theirs for local in [right.local_name(name)]}
    by_address = {name: placed[at] for name in mine if (at := left.addresses.get(name)) in placed and at is not None}
    taken = set(by_address.values())
    found = []
    for name, variable in mine.items():
        other = by_address.get(name) or named.get(left.local_name(name))
        if other is None or (name not in by_address and other in taken):
            continue
        # an address read as BOOL here and as part of a word there has no values to compare
        if name in by_address and theirs[other].signal.kind is not variable.signal.kind:
            continue
        found.append((name, variable.signal, other))
    # what is a variable of a list in one tool is a member of a data block in the other
    paired = [{name for name, _, _ in found}, {other for _, _, other in found}]
    loose, others = (
        {**{n: each for n, each in own.items() if n not in known and not each.is_input}, **system.members}
        for own, known, system in zip((mine, theirs), paired, (left, right), strict=True)
    )
    members = {_old_path(renamed, local) or local: path for path in others for local in [right.local_name(path)]}
    return found + [
        (path, member.signal, other)
        for path, member in loose.items()
        for other in [members.get(left.local_name(path))]
        if other is not None and _is_alike(others[other].signal, member.signal) and not (delayed and member.is_input)
    ]


def _is_alike(one: Signal, other: Signal) -> bool:
    """True if two signals have values that can be compared: S7 has numbers for the values of enumerations."""
    return len({SignalKind.INTEGER if each.kind is SignalKind.ENUMERATION else each.kind for each in (one, other)}) == 1


def unpaired(system: ProgramSystem, compared: Iterable[str]) -> list[str]:
    """Return the outputs and global variables of a system that are not among those that are compared."""
    names = {name.casefold() for name in compared}

    def is_seen(name: str, each: Watched) -> bool:
        return each.direction in _SEEN_OUTSIDE and name.casefold() not in names

    return [*(name for name, each in system.variables.items() if is_seen(name, each)), *system.large]


# -- steps


def step_observations(
    left: ProgramSystem, right: ProgramSystem, flags: Mapping[str, str] | None
) -> list[tuple[str, Observation, Observation]]:
    """Return observations of each step of `left` as active, on both sides. Raises `ModelError` for unknown names.

    `flags`: by the path of a step a variable of the other side (``X2``), what a variable must equal (``s = 2``), or the
    path of a step there. A path with ``._x`` means a step that will be active in the next scan (CODESYS).
    Where they are not given, equal step paths of two charts, and variables with usual names (``X_Fill``, ``Fill_X``,
    ``XFill``, ``Fill``, and ``X2`` for a step of number 2 or a name that ends so), tell.
    """
    bits = {path: 1 << index for index, path in enumerate(left.steps)}
    if flags is not None:
        found = []
        for given, text in flags.items():
            step = given.removesuffix("._x")
            path = next((each for each in bits if each.casefold() == step.casefold()), None)
            if path is None:
                raise ModelError(f"there is no step {step!r}", hint="There are: " + ", ".join(list(bits)[:20]))
            own = Observation(path, bit=bits[path], follows=step != given)
            found.append((path, own, _flag(right, text)))
        return found
    others = {path.casefold(): 1 << index for index, path in enumerate(right.steps)}
    usual = {
        name.casefold(): name
        for name, each in right.variables.items()
        if each.signal.kind is SignalKind.BOOL and not each.is_input
    }
    numbers = _numbers(left)
    recognised = []
    for path, bit in bits.items():
        own = Observation(path, bit=bit)
        if path.casefold() in others:
            recognised.append((path, own, Observation(path, bit=others[path.casefold()])))
            continue
        plain = path.replace(".", "_")
        names = [f"X_{plain}", f"{plain}_X", f"X{plain}", f"_{plain}", plain]
        if path in numbers:
            names += [f"X{numbers[path]}", f"X_{numbers[path]}"]
        flag = next((usual[name.casefold()] for name in names if name.casefold() in usual), None)
        if flag is not None:
            recognised.append((path, own, Observation(flag)))
    return recognised


def heed_instability(chart: ProgramSystem, code: ProgramSystem, *, is_first: bool) -> None:
    """End a scan as the chart's where code tells by a variable ``unstable`` that the chart would not become stable.

    `lower` writes such a variable (German: ``instabil``), with a number where the name is taken. A chart that makes one
    evolution in a scan cannot tell what becomes of a plan, the first of both, which is never stable. The other way
    round it does something, and the second chart fails.
    """
    searching = chart.profile.evolution is Evolution.UNTIL_STABLE and chart.instance.charts()
    has_charts = bool(code.instance.charts())
    chart.is_unanswered = bool(searching) and has_charts and is_first and code.profile.evolution is Evolution.SINGLE
    if not searching or has_charts:
        return
    for name, each in code.variables.items():
        if _UNSTABLE.fullmatch(name) and each.signal.kind is SignalKind.BOOL and not each.is_input:
            code.leave_out(name, UnstableChartError)


def heed_called(left: ProgramSystem, right: ProgramSystem) -> None:
    """Count what is executed of called POUs, but of those that are the same on both sides."""
    called = left.called_pous(), right.called_pous()
    for system, own, others in ((left, *called), (right, *called[::-1])):
        system.also_counted = frozenset(
            name for name, pou in own.items() if name not in others or not _are_alike(pou, others[name])
        )


def _are_alike(one: Pou, other: Pou) -> bool:
    if one is other:
        return True
    bodies = [
        [b.text for b in _texts(pou)] if all(isinstance(b, StBody) for b in _texts(pou)) else [] for pou in (one, other)
    ]
    if all(bodies):
        flat = [[" ".join(text.split()).casefold() for text in texts] for texts in bodies]
        return flat[0] == flat[1] and not any(differences(one.interface, other.interface))
    return not any(differences(one, other))


def _texts(pou: Pou) -> list[Any]:
    return [*pou.bodies, *(action.body for action in pou.actions), *(method.body for method in pou.methods)]


_UNSTABLE = re.compile(r"(unstable|instabil)(_?\d+)?", re.IGNORECASE)


def _flag(system: ProgramSystem, text: str) -> Observation:
    path, equals, value = text.partition("=")
    path = path.strip()
    if not equals and (path not in system.instance or signal_of(system.instance.type_of(path)) is None):
        for place, step in enumerate(system.steps):
            if path.casefold() in (step.casefold(), f"{step}.X".casefold()):
                return Observation(step, bit=1 << place)
    signal = signal_of(system.instance.type_of(path))
    if signal is None:
        raise ModelError(f"{path} is no single value, so it tells nothing of a step")
    known = _constants(system.subject.pou)
    return Observation(path, equals=signal.parse(known.get(value.strip(" #").casefold(), value)) if equals else None)


def _constants(pou: Pou) -> dict[str, str]:
    """Return the values of the constants of a POU as text, by their names in lower case."""
    return {
        variable.name.casefold(): variable.initial.text
        for section in sections_of(pou.interface)
        if section.constant or section.kind is SectionKind.CONSTANT
        for variable in section.variables
        if isinstance(variable.initial, SimpleValue) and variable.initial.text is not None
    }


def _numbers(system: ProgramSystem) -> dict[str, str]:
    """Return the number that a step has, or that its name ends with (``S3``), where no other step has the same."""
    chart = system.subject.pou.chart
    found: dict[str, str] = {}
    for step in chart.steps if chart is not None else ():
        ending = re.search(r"[0-9]+$", step.name)
        if step.number is not None:
            found[step.name] = str(step.number)
        elif ending is not None:
            found[step.name] = ending.group()
    counts = Counter(found.values())
    return {name: number for name, number in found.items() if counts[number] == 1}


def with_commands(chart: Subject, code: Subject, profile: Profile) -> tuple[Subject, Subject]:
    """Return a chart and its code with the local SFC flags of CODESYS that operate the chart as inputs.

    A visualisation writes them, or a call of the chart from elsewhere.
    """
    commands = _commands(chart, profile)
    if not commands:
        return chart, code
    return _with_inputs(chart, commands), _with_inputs(code, commands)


def _commands(chart: Subject, profile: Profile) -> dict[str, str]:
    """Return the SFC flags that operate a chart, or charts of actions beside it, by their names in lower case."""
    charts = [body.chart for _, _, body in chart.pou.named_bodies() if isinstance(body, SfcBody)]
    own = {v.name.casefold() for v in chart.pou.variables()}
    around = {v.name for section in chart.project.global_sections() for v in section.variables}
    around |= {tag.name for table in chart.project.tag_tables for tag in table.tags}
    around = {name.casefold() for name in around} - own
    known = own | around
    used = {flag for each in charts for flag in flags_in_use(each, profile, lambda name: name.casefold() in known)}
    names = sorted(flag.variable for flag in used & COMMANDS)
    return {name.casefold(): name for name in names if name.casefold() not in around}


def _with_inputs(subject: Subject, names: Mapping[str, str]) -> Subject:
    """Return the same with variables of these names as inputs, if they are local, or if only the tool declares them."""
    old = subject.pou.interface
    interface = old.model_copy(deep=True, update={"declaration": None}) if old is not None else Interface()
    declared = {variable.name.casefold() for variable in interface.variables()}
    inputs = [
        Variable(name=name, type=ElementaryType(name=Elementary.BOOL))
        for key, name in names.items()
        if key not in declared
    ]
    for section in interface.sections:
        if section.kind is SectionKind.LOCAL:
            # as locals they would keep their start values, and the proof would not reach what they do
            inputs += [v for v in section.variables if v.name.casefold() in names]
            section.variables = [v for v in section.variables if v.name.casefold() not in names]
    interface.sections.append(VariableSection(kind=SectionKind.INPUT, variables=inputs))
    return replace(subject, pou=subject.pou.model_copy(update={"interface": interface}))
