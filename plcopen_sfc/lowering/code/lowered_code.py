"""Lowered code before it is a body: its names and declarations, and networks of statements."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from operator import is_
from textwrap import dedent
from typing import NoReturn, TypeAlias

from plcopen_sfc.errors import Location, LoweringError, nearest
from plcopen_sfc.languages.memory_addresses import memory_address
from plcopen_sfc.languages.networks import Helper
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.languages.standard_blocks import S7_INSTANCES, Tool
from plcopen_sfc.languages.words import take_name, without_accents
from plcopen_sfc.lowering.code.boolean_logic import FALSE, assignment
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.lowering.lowering_options import LOCAL, LoweringRules
from plcopen_sfc.model import types as t
from plcopen_sfc.model.dialect import COUNTING_BYTES, Dialect
from plcopen_sfc.model.pou import DataBlock
from plcopen_sfc.model.project import Chart, Configuration, Project, Tag, TagTable
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import MultilingualText, Text
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of


class Naming:
    """Source of names that nothing else in the POU has. `taken` are all names that occur in it.

    `part` is behind those that are taken, as they are when the chart around has the same; numbers where that does not
    help. `ascii`: the target takes no other letters, and would get other names than the proof knows.
    """

    def __init__(self, dialect: Dialect, taken: Iterable[str], part: str = "", *, ascii: bool = False) -> None:
        self._part = part
        self._ascii = ascii
        self._local = n.Quoting.LOCAL if dialect is Dialect.SCL else n.Quoting.NONE
        self.taken = {name.casefold() for name in taken}
        self._numbers: dict[str, int] = {}

    def system_type(self, kind: t.DerivedType) -> t.DerivedType:
        """Return the type of instances of a standard function block in the dialect: ``TON_TIME`` in SCL."""
        name = S7_INSTANCES.get(kind.name) if self._local is n.Quoting.LOCAL else None
        return t.DerivedType(name=name) if name is not None else kind

    def fresh(self, wanted: str) -> str:
        """Return `wanted` as an identifier, with a number behind it if that is taken."""
        wanted = without_accents(wanted) if self._ascii else wanted
        name = candidate = _identifier(wanted)
        if self._part and name.casefold() in self.taken:
            name = candidate = _identifier(f"{wanted}_{self._part}")
        number = self._numbers.get(name.casefold(), 2)
        while candidate.casefold() in self.taken:
            candidate = f"{name}_{number}"
            number += 1
        self._numbers[name.casefold()] = number
        self.taken.add(candidate.casefold())
        return candidate

    def local(self, name: str) -> n.Name:
        """Return a name of the POU's interface as the dialect writes it."""
        return n.Name(name, self._local)


def _identifier(wanted: str) -> str:
    spelled = unicodedata.normalize("NFC", wanted)
    name = re.sub(r"_{2,}", "_", re.sub(r"\W", "_", spelled)).strip("_")
    return name if name and not name[0].isdigit() else f"x{name}"


def names_of(project: Project) -> set[str]:
    """Return the names of POUs, types, data blocks, tags, global variables and their lists, in lower case."""
    found = {pou.name for pou in project.pous} | {kind.name for kind in project.data_types}
    found |= {block.name for block in project.data_blocks}
    for table in project.tag_tables:
        found |= {tag.name for tag in table.tags} | {constant.name for constant in table.constants}
    for section in project.global_sections():
        found |= {section.name or "", *(variable.name for variable in section.variables)}
    return {name.casefold() for name in found}


BOOL = t.ElementaryType(name=t.Elementary.BOOL)
INT = t.ElementaryType(name=t.Elementary.INT)
TIME = t.ElementaryType(name=t.Elementary.TIME)
_LARGEST_INT = 32_767

_FIRST = re.compile(r"%?MX?(\d{1,9})\.([0-7])", re.IGNORECASE)
_BYTE = 8
_LAST_OF_S7 = 16_384 * _BYTE - 1
"""The last bit of the largest bit memory that a CPU of S7 has (S7-1500; that of S7-1200 has 4,096 or 8,192 bytes)."""


class FlagPlaces:
    """Declarations of the flags of one chart outside of its POU: as tags or global variables, or in a data block.

    `name` is that of the table, the list or the block; `tool` decides which of them. Partial charts can have addresses
    of their own (``G1=M20.0,G2=M24.0``). Raises `LoweringError` for a place that does not exist or that is taken.
    """

    def __init__(self, rules: LoweringRules, pou: str, project: Project, tool: Tool | None) -> None:
        self.tool = tool
        self.variables: list[t.Variable] = []
        self._pou = pou
        self._quoting = n.Quoting.GLOBAL if project.dialect is Dialect.SCL else n.Quoting.NONE
        self._surroundings = names_of(project)
        self.taken: dict[int, str] = {}
        # the next free bit of each chart; of the empty name: of all
        self._bits = _ranges(rules.flags)
        self.in_block = not self._bits
        if self._bits:
            known = {name.casefold() for chart in project.charts() for name in _names_of(chart)}
            unknown = next((name for name in self._bits if name and name not in known), "")
            if unknown:
                self._refuse(f"there is no chart {unknown!r} for flags{nearest(unknown, known)}")
            self.taken = dict(_taken_bits(project))
            self.name = take_name(f"{rules.texts.flag_list}_{pou}", self._surroundings)
        else:
            self.name = rules.flags
            address = memory_address(self.name, by_bytes=False)
            if re.fullmatch(r"[^\W\d]\w*", self.name) is None or (address is not None and address.area == "M"):
                hint = "There are: local, an address such as M20.0 or G1=M20.0,G2=M24.0, the name of a data block."
                self._refuse(f"{self.name!r} is no place for flags", hint)
            if self.name.casefold() in self._surroundings:
                self._refuse(f"there is something called {self.name} already")

    @property
    def have_values(self) -> bool:
        """True if flags have their values at the start: tags have none."""
        return self.in_block or self.tool is not Tool.S7

    @property
    def following(self) -> str:
        """Address behind the last flag; empty for flags without addresses."""
        bit = self._bits.get("")
        return f"M{bit // _BYTE}.{bit % _BYTE}" if bit is not None else ""

    @property
    def external(self) -> list[t.Variable]:
        """Variables that the POU must declare to see them (IEC 61131-3, VAR_EXTERNAL); tools do not ask for that."""
        if self.tool is not None:
            return []
        return [t.Variable(name=variable.name, type=variable.type) for variable in self.variables]

    def address_of(self, name: str) -> str:
        """Return the address of a flag as people write it (``M20.0``); empty where it has none."""
        found = next((v.address for v in self.variables if v.name == name and v.address), "")
        return found.replace("%MX", "M").removeprefix("%")

    def declare(self, wanted: str, path: str, naming: Naming, *, initial: bool, comment: Text | None) -> Expression:
        """Declare the flag of the step `path`, and return the expression that reads it."""
        is_member = self.in_block and self.tool is not None
        name = naming.fresh(wanted)
        if not is_member:
            name = take_name(name, self._surroundings)
        variable = t.Variable(name=name, type=BOOL, comment=comment)
        if initial and self.have_values:
            variable.initial = t.SimpleValue(text="TRUE")
        if self._bits:
            variable.address = self._next_address(name, path)
        self.variables.append(variable)
        if is_member:
            return n.Member(n.Name(self.name, self._quoting), n.Name(name))
        return n.Name(name, self._quoting)

    def put_into(self, project: Project) -> None:
        """Declare the flags in a project."""
        if self.tool is Tool.S7:
            self._put_into_s7(project)
            return
        section = VariableSection(kind=SectionKind.GLOBAL, name=self.name, variables=self.variables)
        if self.tool is Tool.CODESYS:
            lists = project.applications[0].global_variables if project.applications else project.global_variables
            lists.append(section)
            return
        if not project.configurations:
            project.configurations.append(Configuration(name="Configuration"))
        project.configurations[0].global_variables.append(section)

    def _put_into_s7(self, project: Project) -> None:
        if self.in_block:
            members = VariableSection(kind=SectionKind.LOCAL, variables=self.variables)
            project.data_blocks.append(DataBlock(name=self.name, interface=Interface(sections=[members])))
            return
        tags = [Tag(name=v.name, type="Bool", address=v.address, comment=v.comment) for v in self.variables]
        project.tag_tables.append(TagTable(name=self.name, tags=tags))

    def _next_address(self, name: str, path: str) -> str:
        parts = path.casefold().split(".")
        charts = [".".join(parts[:end]) for end in range(len(parts) - 1, 0, -1)]
        part = next((each for each in (*charts, self._pou.casefold(), "") if each in self._bits), None)
        if part is None:
            self._refuse(f"the flag {name} has no address: none is given for {self._pou} or a chart in it")
        bit = self._bits[part]
        if bit in self.taken:
            self._refuse(f"the address of the flag {name} belongs to {self.taken[bit]} already")
        if self.tool is Tool.S7 and bit > _LAST_OF_S7:
            hint = "S7-1500 has the largest bit memory, 16,384 bytes; smaller CPUs have less."
            self._refuse(f"no CPU of S7 has the address of the flag {name}: bit memory ends with M16383.7", hint)
        self._bits[part] = bit + 1
        self.taken[bit] = name
        place = f"{bit // _BYTE}.{bit % _BYTE}"
        return f"%M{place}" if self.tool is Tool.S7 else f"%MX{place}"

    def _refuse(self, message: str, hint: str = "") -> NoReturn:
        raise LoweringError(message, location=Location(path=self._pou), hint=hint)


def flags_of_several(flags: str, chart: Chart, following: str) -> str:
    """Return where the flags of one of several charts go: behind those before it, or into a block of their own."""
    if flags == LOCAL:
        return flags
    ranges = _ranges(flags)
    if "" in ranges:
        return following or flags
    if ranges:
        own = {name.casefold() for name in _names_of(chart)}
        return ",".join(each for each in flags.split(",") if each.partition("=")[0].strip().casefold() in own) or flags
    return f"{flags}_{chart.name.replace('.', '_')}"


def flags_of_part(flags: str, whole: SfcNetwork, part: SfcNetwork) -> str:
    """Return where the flags of `part` go, which may be a partial chart of `whole` that is lowered alone."""
    ranges = _ranges(flags)
    name = next((each.name.casefold() for each in whole.partial_charts if each.chart is part), "")
    if name not in ranges or not name:
        return flags
    return f"M{ranges[name] // _BYTE}.{ranges[name] % _BYTE}"


def _ranges(flags: str) -> dict[str, int]:
    """Return the first bit by the name of its chart, in lower case, the empty name for all; nothing for no address."""
    found: dict[str, int] = {}
    for each in flags.split(","):
        name, _, address = each.rpartition("=")
        first = _FIRST.fullmatch(address.strip())
        if first is None or (not name.strip() and "," in flags):
            return {}
        found[name.strip().casefold()] = int(first[1]) * _BYTE + int(first[2])
    return found


def _names_of(chart: Chart) -> Iterator[str]:
    """Yield the names that stand for a chart in `_ranges`: its own, those of its POU and its partial charts."""
    yield from (chart.name, chart.pou.name)
    yield from (partial.name for partial in chart.chart.partial_charts)


def _taken_bits(project: Project) -> Iterator[tuple[int, str]]:
    """Yield the bits of the memory that have names. Words have the number of a byte in S7 and TwinCAT."""
    in_bytes = project.address_dialect in COUNTING_BYTES
    named = [(tag.address, tag.name) for table in project.tag_tables for tag in table.tags]
    sections = [*project.global_sections()]
    for pou in project.pous:
        sections += sections_of(pou.interface)
    named += [(variable.address, variable.name) for section in sections for variable in section.variables]
    for address, name in named:
        found = memory_address(address or "", by_bytes=in_bytes)
        if found is not None and found.area == "M":
            yield from ((bit, name) for bit in range(found.start, found.start + found.width))


def integer(largest: int) -> t.ElementaryType:
    """Return the type of numbers up to `largest`: INT where it holds them, else DINT."""
    return INT if largest <= _LARGEST_INT else t.ElementaryType(name=t.Elementary.DINT)


StepValue: TypeAlias = Callable[[int], n.Expression]
"""Expression for something of a step, given by its index in the net."""


@dataclass(frozen=True)
class CodeNetwork:
    """Statements that belong together: a network of FBD and LD, a paragraph of ST.

    `inside` is the title in the branch of a step; mostly it needs none.
    """

    title: str
    statements: tuple[n.Statement, ...]
    comment: str = ""
    inside: str = ""


@dataclass
class LoweredCode:
    """Code that a lowering has made so far. `variables` and `constants` are local, `inputs` come from outside.

    `data_types` are new ones of the project. `drawn`: it becomes networks, all on `one_sheet` or each for itself, or
    instructions; `tool`: the tool that it is for, where that matters. `for_others`: exact code for a format, not for
    the project. `has_line_comments`: comments with ``//``. `is_textbook`: code in the classic style.
    `culture` (``de-DE``): the language of comments, where the target has another usual one.
    `operands`: variables in which boxes of S7 keep their state, with these boxes.
    `texts`: names of variables. `at_rest`: the values of inputs with which the code does what the chart does, in scans
    in which `left_out`, if there is one, is FALSE. `flags`: the place of step flags; None: among the local variables.
    `known_types`: the data types of the project, in lower case.
    """

    naming: Naming
    networks: list[CodeNetwork] = field(default_factory=list)
    variables: list[t.Variable] = field(default_factory=list)
    inputs: list[t.Variable] = field(default_factory=list)
    outputs: list[t.Variable] = field(default_factory=list)
    constants: list[t.Variable] = field(default_factory=list)
    data_types: list[t.DataTypeDeclaration] = field(default_factory=list)
    at_rest: dict[str, bool] = field(default_factory=dict)
    left_out: n.Expression | None = None
    drawn: bool = False
    one_sheet: bool = False
    tool: Tool | None = None
    for_others: bool = False
    has_line_comments: bool = True
    is_textbook: bool = False
    culture: str = ""
    operands: dict[n.Expression, str] = field(default_factory=dict)
    instances: Mapping[str, str] = field(default_factory=dict)
    flags: FlagPlaces | None = None
    first_scan: n.Name | None = None
    texts: Texts = field(default_factory=Texts)
    known_types: Collection[str] = ()
    _written: dict[int, tuple[tuple[n.Statement, ...], str]] = field(default_factory=dict)

    def keep_text(self, statements: tuple[n.Statement, ...], text: str) -> None:
        """Keep the text of statements, whose comments a tree does not have: it is written while they stay the same."""
        if statements and any(start in text for start in ("//", "(*", "/*")):
            self._written[id(statements[0])] = statements, dedent(text).strip("\n")

    def text_of(self, statements: Sequence[n.Statement]) -> tuple[int, str]:
        """Return how many of these statements have a text, and that text."""
        kept, text = self._written.get(id(statements[0]), ((), ""))
        same = len(kept) <= len(statements) and all(map(is_, kept, statements))
        return (len(kept), text) if same else (0, "")

    def change(self, changed: Callable[[n.Statement], n.Statement], begin: int = 0) -> None:
        """Change each statement of the networks from place `begin` on."""
        for place, network in enumerate(self.networks[begin:], begin):
            self.networks[place] = replace(network, statements=tuple(map(changed, network.statements)))

    def declare(self, wanted: str, kind: t.DataType = BOOL, *, initial: str | None = None, comment: str = "") -> n.Name:
        """Declare a local variable that is called `wanted`, if that is free, and return its name."""
        name = self.naming.fresh(wanted)
        if isinstance(kind, t.DerivedType):
            kind = self.naming.system_type(kind)
        value = t.SimpleValue(text=initial) if initial is not None else None
        self.variables.append(t.Variable(name=name, type=kind, initial=value, comment=self.caption(comment)))
        return self.naming.local(name)

    def caption(self, text: str) -> Text | None:
        """Return a title or comment as text of the model, if there is any."""
        return MultilingualText(texts={self.culture: text}) if text and self.culture else text or None

    def declare_constant(self, wanted: str, kind: t.DataType, value: str, comment: str) -> n.Name:
        """Declare a local constant that is called `wanted`, if that is free, and return its name."""
        name = self.naming.fresh(wanted)
        text = self.caption(comment)
        self.constants.append(t.Variable(name=name, type=kind, initial=t.SimpleValue(text=value), comment=text))
        return self.naming.local(name)

    @property
    def is_portable(self) -> bool:
        """True if it is for every tool of IEC 61131-3: edition 2, as in matiec, has no empty statement."""
        return self.for_others and self.tool is None

    @property
    def has_regions(self) -> bool:
        """True if it is for TIA Portal, whose editor folds regions and lists them."""
        return self.for_others and self.tool is Tool.S7

    @property
    def own_names(self) -> set[str]:
        """Names of the variables that it has declared, in lower case: no other code writes them."""
        return {variable.name.casefold() for variable in (*self.variables, *self.constants)}

    @property
    def needs_flat_statements(self) -> bool:
        """True if it becomes networks that hold no IF and CASE; those of CODESYS do, as the text of a box."""
        return self.drawn and self.tool is not Tool.CODESYS

    def beside(self) -> LoweredCode:
        """Return code for another block of the same target, with variables of its own."""
        return replace(
            self, networks=[], variables=[], inputs=[], constants=[], data_types=[], operands={}, first_scan=None
        )

    def declare_flag(self, wanted: str, path: str, *, initial: bool, comment: str) -> n.Expression:
        """Declare the flag of the step `path` in its place, and return the expression that reads it."""
        if self.flags is not None:
            return self.flags.declare(wanted, path, self.naming, initial=initial, comment=self.caption(comment))
        return self.declare(wanted, initial="TRUE" if initial else None, comment=comment)

    def first_scan_pulse(self) -> n.Name:
        """Return a variable that is TRUE until the end of the first scan; `end_first_scan` ends it."""
        if self.first_scan is None:
            self.first_scan = self.declare(self.texts.pulse, initial="TRUE")
        return self.first_scan

    def end_first_scan(self) -> None:
        """Append the end of that pulse, if it is used, behind everything else."""
        if self.first_scan is not None:
            self.add(self.texts.first_scan, [assignment(self.first_scan, FALSE)])

    def declare_as(self, name: str, kind: t.DataType) -> None:
        """Declare a local variable of this very name."""
        self.variables.append(t.Variable(name=name, type=kind))

    def declare_helpers(self, helpers: Iterable[Helper]) -> None:
        """Declare the variables that drawings need when they are read as text."""
        for helper in helpers:
            wanted = helper.type_name or "BOOL"
            known = t.Elementary.__members__.get(wanted)
            self.declare_as(helper.name, t.ElementaryType(name=known) if known else t.DerivedType(name=wanted))

    def declare_input(self, name: str, comment: str, kind: t.DataType = BOOL, *, at_rest: bool | None = None) -> n.Name:
        """Declare an input of this very name; `at_rest` is its value while it is not used."""
        self.inputs.append(t.Variable(name=name, type=kind, comment=self.caption(comment)))
        if at_rest is not None:
            self.at_rest[name] = at_rest
        return self.naming.local(name)

    def declare_output(self, wanted: str, comment: str) -> n.Name:
        """Declare a Boolean output that is called `wanted`, if that is free, and return its name."""
        name = self.naming.fresh(wanted)
        self.outputs.append(t.Variable(name=name, type=BOOL, comment=self.caption(comment)))
        return self.naming.local(name)

    def add(
        self,
        title: str,
        statements: Sequence[n.Statement],
        comment: str = "",
        *,
        place: int | None = None,
        inside: str = "",
    ) -> None:
        """Append a network, or put it at a place, if there is something in it."""
        if statements:
            network = CodeNetwork(title, tuple(statements), comment, inside)
            self.networks.insert(len(self.networks) if place is None else place, network)

    def add_each(self, title: str, parts: Sequence[CodeNetwork]) -> None:
        """Append parts that belong together: as networks of their own where they are drawn, else as one paragraph."""
        if self.drawn:
            self.networks += [part for part in parts if part.statements]
            return
        remarked = (((n.Remark(part.comment),) if part.comment else ()) + part.statements for part in parts)
        self.add(title, [*chain.from_iterable(remarked)])


_MARKS = re.compile(r"^\s*//+|\(\*+|\*+\)|/\*+|\*+/", re.MULTILINE)


def without_marks(text: str) -> str:
    """Return the text of comments without the marks that make them comments."""
    return _MARKS.sub(" ", text)
