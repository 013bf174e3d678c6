"""Everything in a project that a controller executes, as a tree of parts and their aspects.

What people and tools look at (titles, positions, ids, comments, vendor data) is left out, so that two trees differ only
where two machines may.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import cast

from plcopen_sfc.conversion.declared_values import (
    StartValues,
    add_kept,
    tell_acting_attributes,
    tell_acting_attributes_of_type,
    tell_declaration,
    tell_inheritance,
    tell_type,
)
from plcopen_sfc.conversion.executed_charts import ExecutedChartReader
from plcopen_sfc.conversion.executed_parts import (
    OPERATING_INPUT,
    PROGRAM_CALL,
    RESTING_INPUT,
    UNDECLARED,
    UNUSED_INPUT,
    Detail,
    Key,
    Part,
    plain_name,
    shown_name,
)
from plcopen_sfc.conversion.executed_tasks import TaskReader
from plcopen_sfc.conversion.meaning import (
    Meaning,
    Renaming,
    address_meaning,
    code_meaning,
    type_meaning,
)
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.name_uses import Occurrence
from plcopen_sfc.languages.binding.text_sites import Role
from plcopen_sfc.languages.declarations.attributes import typed_attributes
from plcopen_sfc.languages.declarations.kept_texts import bases_of, kept
from plcopen_sfc.languages.method_calls import KEPT_IN_METHODS
from plcopen_sfc.languages.networks.condition_reading import shown_named_condition
from plcopen_sfc.languages.networks.network_graph import without_places
from plcopen_sfc.languages.s7_globals import TABLE, is_retained, local_tags, type_named
from plcopen_sfc.languages.s7_programs import names_of_programs, unused_inputs
from plcopen_sfc.languages.s7_types import is_operand_of_s5, is_system_data, plain_type
from plcopen_sfc.languages.sfc_flag_uses import flags_at_rest, named_flags
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.translation.call_translation import has_function
from plcopen_sfc.languages.translation.renames import NameScope, Renames, kept_renames
from plcopen_sfc.model import types as t
from plcopen_sfc.model.base import Element, ForeignData
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.chart_settings import GRAPH_INPUTS, SfcFlag
from plcopen_sfc.model.declaration import NamedObject
from plcopen_sfc.model.dialect import STRING_LENGTHS, Dialect
from plcopen_sfc.model.network import Block, CommentBox, VendorElement
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, Method, NamedTransition, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, Step
from plcopen_sfc.model.text import MultilingualText, Text
from plcopen_sfc.model.text import plain as words_of
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.whole_numbers import whole_number


def executed(
    project: Project,
    profile: Profile | None = None,
    *,
    source: Project | None = None,
    compared_with: Part | None = None,
    detail: Detail = Detail.EXECUTED,
    at_rest: Collection[str] = (),
    addresses: Dialect | None = None,
) -> Part:
    """Everything that a controller executes of a project, under the rules of `profile`.

    `source` is the project as it was read, where its program text was put into another dialect and its tasks into
    other terms since: the rules of its tool apply to direct addresses, to tasks and to its own data. `compared_with` is
    the source of a conversion: the project may have structures in place of its lists of global variables, and instance
    data blocks and organization blocks in place of its programs and tasks, and functions in place of its actions.
    `detail`: whether more is listed than what is executed. Names that nothing declares are left out then. `at_rest` are
    the inactive inputs of sequencers, in upper case. `addresses` is the dialect of direct addresses, where
    it is not that of `source`.
    """
    rules = profile or default_profile(project)
    other = compared_with or Part("")
    reader = _Reader(project, rules, source or project, other, detail=detail, at_rest=at_rest, addresses=addresses)
    return reader.read()


class _Reader:
    def __init__(
        self,
        project: Project,
        profile: Profile,
        source: Project,
        compared_with: Part,
        *,
        detail: Detail,
        at_rest: Collection[str],
        addresses: Dialect | None,
    ) -> None:
        self.project = project
        self.profile = profile
        self.detail = detail
        self.at_rest = at_rest
        self.names = Names(project)
        self.dialect = project.dialect
        self.source = source
        tool_format = source.tool_format  # asks for all that was found wrong in the file
        self.is_of_codesys = tool_format == "codesys"
        self.tool = Dialect.TWINCAT if tool_format == "twincat" else source.dialect
        self.addresses = addresses or source.address_dialect
        self.whole = Part("")
        self._typed: Mapping[str, Sequence[str]] = {}
        self.lists = {s.name.casefold() for s in self.project.global_sections() if s.name}
        self.lists |= {block.name.casefold() for block in project.data_blocks}
        self.whole.lists = frozenset(self.lists)
        self.lists |= compared_with.lists | {s.name.casefold() for s in source.global_sections() if s.name}
        self.listed = _listed(project) if compared_with.listed is None else compared_with.listed
        self.whole.listed = self.listed
        self.values = _values(project, self.listed)
        self.own: frozenset[str] = frozenset()
        self.starts = StartValues(project, self._number)
        if project.dialect is Dialect.SCL:
            self.lists.add(TABLE.casefold())
        self.compared_with = compared_with
        self.structures = compared_with.lists
        self.whole.programs = frozenset(p.name.casefold() for p in project.pous if p.kind is PouKind.PROGRAM)
        # programs by the names of their instance data blocks: texts in SCL have those names before the blocks are made
        self.programs = {
            block.name.casefold(): (block.type_name or "").strip('"').casefold()
            for block in project.data_blocks
            if (block.type_name or "").strip('"').casefold() in compared_with.programs
        }
        if project.dialect is Dialect.SCL:
            self.programs |= {block.casefold(): name.casefold() for name, block in names_of_programs(project).items()}
        others = {key.name for key in compared_with.parts if key.kind == "POU"}
        self.added_functions = {
            pou.name.casefold(): pou
            for pou in project.pous
            if pou.kind is PouKind.FUNCTION and others and plain_name(pou.name) not in others
        }
        self.declared = {declaration.name.casefold(): declaration.type for declaration in project.data_types}
        self.tags = local_tags(project) if project.dialect is Dialect.SCL else {}
        self.global_names = {v.name.casefold() for section in self.project.global_sections() for v in section.variables}

    def read(self) -> Part:
        self._read()
        # meanings ask this reader later: parts that it kept would be garbage that only the collector can free
        whole, self.whole, self.compared_with = self.whole, Part(""), Part("")
        return whole

    def _read(self) -> None:
        self.names.text_sites()  # what looks for some words only has them then
        for declaration in self.project.data_types:
            # other types are compared where they are used, by what they stand for
            if isinstance(declaration.type, t.StructType) or self.detail:
                self._data_type(declaration)
        self._globals()
        tasks = TaskReader(
            self.project,
            self.source,
            self.whole,
            detail=self.detail,
            programs=self.programs,
            starts=self.starts,
            addresses=self.addresses,
            target=self.target,
        )
        tasks.read()
        for pou in self.project.pous:
            self._pou(pou)
        add_kept(self.whole, self.project, self.names.text_sites(), self.tool, with_code=bool(self.detail))
        drawn = [text_site.text for text_site in self.names.text_sites() if isinstance(text_site.holder, Block)]
        self.whole.boxes = frozenset(map(plain_name, drawn))
        if self.detail is Detail.WRITTEN:
            self._lists()
        if not self.detail:
            self._calls_of_programs(tasks)
            self._undeclared()

    def _data_type(self, declaration: t.DataTypeDeclaration) -> None:
        part = self.whole.add("type", declaration.name, declaration.report_path, declaration)
        tell_type(part, declaration.type, declaration)
        if self.detail is Detail.WRITTEN:
            tell_declaration(part, declaration)
        else:
            tell_acting_attributes_of_type(part, declaration)
        self.tell_comment(part, declaration)
        whole = t.Variable(name=declaration.name, type=declaration.type, initial=declaration.initial)
        if self.detail and isinstance(declaration.type, t.StructType):
            for member in declaration.type.members:
                self._variable(part, "member", member, VariableSection(), "")
        else:
            kind = declaration.type if self.detail else self._plain_type(declaration.type)
            part.tell("type", type_meaning(kind, self.dialect))
        if not self.detail or declaration.initial is not None:
            part.tell("initial value", self.starts.meaning(whole))

    def _undeclared(self) -> None:
        """Note the names that nothing declares, neither the project nor its tool."""
        # a source in another dialect may have operators of CODESYS: its tool does not have them, this one does
        dialect = self.dialect if self.compared_with.parts else Dialect.IEC
        for occurrence in self.names.undeclared():
            name = occurrence.reference.name
            own = occurrence.text_site.site.pou
            if name.upper() in _OF_OBJECTS or (own is not None and name.casefold() in self._inherited(own)):
                continue
            if own is not None and name.casefold() in {flag.casefold() for flag in own.implicit_flags()}:
                continue
            if name.casefold() in _RESULTS | self.global_names | self.programs.keys() or has_function(dialect, name):
                continue
            if own is not None and own.kind is PouKind.FUNCTION and name.casefold() == own.name.casefold():
                continue  # its result
            part = self.whole.add(UNDECLARED, name, occurrence.text_site.report_path)
            part.tell("name", Meaning.of(name.casefold(), name))
            part.is_called = _is_call(occurrence)

    def _inherited(self, own: Pou) -> set[str]:
        """Names that a POU of the source has from those that it extends: translated declarations do not tell that."""
        pous = {pou.name.casefold(): pou for pou in self.source.pous}
        source = pous.get(own.name.casefold())
        found: set[str] = set()
        for pou in bases_of(source, pous) if source is not None else ():
            found |= {each.name.casefold() for each in pou.variables()}
            found |= {action.name.casefold() for action in pou.actions}
            found |= {method.name.casefold() for method in pou.methods}
        return found

    def _calls_of_programs(self, tasks: TaskReader) -> None:
        """Note where a program is called or its variables are read, as in CODESYS: IEC 61131-3 has no such calls."""
        pous = {pou.name.casefold(): pou for pou in self.project.pous}
        programs = {block: pous[program] for block, program in self.programs.items() if program in pous}
        if self.source.dialect is Dialect.CODESYS:
            programs |= {key: pou for key, pou in pous.items() if pou.kind is PouKind.PROGRAM}
        found: set[tuple[str, str]] = set()
        for occurrence in self.names.occurrences(*programs) if programs else ():
            declaration, caller = occurrence.meaning.declaration, occurrence.text_site.site.pou
            program = programs[occurrence.reference.name.casefold()]
            place = (occurrence.text_site.report_path, program.name)
            holder = declaration.holder if declaration is not None else None
            is_block = occurrence.reference.name.casefold() in self.programs
            is_named = (is_block or holder is program) and caller not in (None, program)
            if caller is not None and caller.kind is PouKind.ORGANIZATION_BLOCK and tasks.replaces_task(caller):
                continue
            if is_named and place not in found and not isinstance(occurrence.text_site.holder, ForeignData):
                found.add(place)
                part = self.whole.add(PROGRAM_CALL, " ".join(place), f"{place[0]} / {PROGRAM_CALL} {program.name}")
                part.tell("program", Meaning.of(program.name.casefold(), program.name))

    def naming(self, result: str = "") -> Renaming:
        """Return how names in the POU that is read now become names that all tools could have.

        A global variable has no list, unless several have one of its name; a result is ``Ret_Val``. Meanings ask later.
        """
        own = self.own
        return lambda node: self._named(node, result, own)

    def _named(self, node: n.Node, result: str, own: Collection[str]) -> n.Node:
        if self.detail is Detail.WRITTEN:
            return node
        match node:
            case n.Member(n.Name(around), n.Literal() as value) if around.casefold() in self.lists:
                return value  # parts are rewritten before the whole: the name of a constant is its value by now
            case n.Member(n.Name(around), n.Name(name)):
                key, is_of_list = name.casefold(), around.casefold() in self.lists
                if is_of_list and self.listed.get(key, 0) < 2 and key not in own:
                    return node.name  # the value of a constant, or a name that one list has
                number = self.values.get(f"{around}.{key}".casefold())
                number = self.values.get(key, number) if is_of_list else number
                return n.Literal(number) if number is not None else node
            case n.Name(name):
                key = name.casefold()
                if key in self.values:
                    is_own = node.quoting is not n.Quoting.GLOBAL and key in own
                    return n.Name(name) if is_own else n.Literal(self.values[key])
                if key in self.programs:
                    return n.Name(self.programs[key])
                if result and key in (result.casefold(), "ret_val"):
                    return n.Name("Ret_Val")
                return n.Name(name) if node.quoting is not n.Quoting.NONE else node
        return node

    def _number(self, text: str) -> str:
        """Return the number of the value of an enumeration, or of the constant, that `text` names."""
        alone = self._without_lists(text)
        keys = (each.replace('"', "").replace("#", ".").casefold() for each in (text, alone))
        return next((self.values[key] for key in keys if key in self.values), alone)

    def _without_lists(self, text: str) -> str:
        """Return a constant expression that names global constants alone: some tools have no lists for them."""
        if "." not in text or _LITERAL.match(text):
            return text
        return _MEMBER.sub(lambda found: found[2] if found[1].casefold() in self.lists else found[0], text)

    def _plain_type(self, kind: t.DataType, depth: int = 0) -> t.DataType:
        """Return a type without other names for types and without initial values."""
        if isinstance(kind, t.DerivedType):
            declared = self.declared.get(kind.name.replace('"', "").casefold())
            stays = declared is None or isinstance(declared, t.StructType) or depth > _DEEPEST
            return plain_type(kind) if declared is None or stays else self._plain_type(declared, depth + 1)
        if isinstance(kind, t.StringType) and kind.length is None:
            # of a source in another dialect the length is written, unless the target has one of its own
            known = STRING_LENGTHS.get(self.dialect, STRING_LENGTHS[Dialect.CODESYS])
            return t.StringType(wide=kind.wide, length=known)
        if isinstance(kind, t.StringType) and kind.length is not None:
            return t.StringType(wide=kind.wide, length=self._number(kind.length))
        if isinstance(kind, t.EnumType):
            return kind.base or t.ElementaryType(name=t.Elementary.INT)
        if isinstance(kind, t.ArrayType):
            bounds = [
                t.Dimension(lower=self._number(each.lower), upper=self._number(each.upper)) for each in kind.dimensions
            ]
            return t.ArrayType(dimensions=bounds, base=self._plain_type(kind.base, depth + 1))
        if isinstance(kind, t.StructType):
            members = [
                t.Variable(name=shown_name(member.name), type=self._plain_type(member.type, depth + 1))
                for member in kind.members
            ]
            return t.StructType(members=members)
        return kind

    def code(self, body: Body | None, result: str = "") -> Meaning | None:
        """Return the meaning of a body."""
        if self.is_of_codesys and isinstance(body, FbdBody | LdBody):
            networks = [n.model_copy(update={"nodes": without_places(n.nodes)}) for n in body.networks]
            body = body.model_copy(update={"networks": networks})
        return code_meaning(body, self.dialect, self.naming(result))

    def tell_comment(self, part: Part, thing: Element) -> None:
        """Note the comment and the title of something, where they are wanted."""
        for aspect in ("title", "comment") if self.detail else ():
            self.tell_text(part, aspect, getattr(thing, aspect, None))

    def tell_text(self, part: Part, aspect: str, text: Text | None) -> None:
        """Note a text for people, in all its languages where that is wanted."""
        for language, words in _in_languages(text):
            if not language:
                part.tell(aspect, Meaning.of(words))
            elif self.detail is Detail.WRITTEN:
                part.tell(f"{aspect} in {language}", Meaning.of(words))

    def tell_networks(self, part: Part, body: Body | None, aspect: str = "networks", number: int = 0) -> None:
        """Note the titles and comments of networks or of text; `number`: the programs of the POU before this one."""
        if self.detail is not Detail.WRITTEN:
            return
        which = f" {number + 1}" if number else ""
        if isinstance(body, StBody | IlBody):
            self.tell_text(part, f"title of {'the code' if aspect == 'networks' else aspect}{which}", body.title)
        if not isinstance(body, FbdBody | LdBody):
            return
        lines = []
        for place, network in enumerate(body.networks, 1):
            texts = [network.title, network.comment]
            for node in network.nodes:
                if isinstance(node, CommentBox):
                    texts.append(node.content)
                elif isinstance(node, VendorElement) and node.element_type == "networktitle":
                    texts.append(node.alternative_text)
            words = " ".join(words for text in texts for _, words in _in_languages(text))
            lines += [f"{place}: {words}"] if words else []
        part.tell(f"comments of {aspect}{which}", Meaning.of(tuple(lines), "\n".join(lines) or "none"))

    def operation(self, pou: Pou, name: str, *, is_used: bool | None = None) -> str:
        """The kind of an input that operates the chart of a block: whether anything operates it, if not known."""
        if name.upper() in self.at_rest:
            return RESTING_INPUT
        if is_used is None:
            is_used = not unused_inputs(self.names, pou, [name], self._named_inputs)
        return OPERATING_INPUT if is_used else UNUSED_INPUT

    def flags_at_rest(self, pou: Pou, flags: Iterable[SfcFlag]) -> set[SfcFlag]:
        """Return those flags of the charts of a POU that nothing uses."""
        return flags_at_rest(self.project, pou, flags, self._named_flags)

    @cached_property
    def _named_inputs(self) -> frozenset[str]:
        """The inputs of sequencers that the project names, in lower case; looked for once, as it takes long."""
        return frozenset(each.reference.name.casefold() for each in self.names.occurrences(*GRAPH_INPUTS))

    @cached_property
    def _named_flags(self) -> frozenset[str]:
        return named_flags(self.names)

    def _type(self, kind: t.DataType) -> Meaning | None:
        return type_meaning(kind if self.detail is Detail.WRITTEN else self._plain_type(kind), self.dialect)

    def target(self, name: str) -> str:
        """Return the name of a variable without that of its list, and without the signs of S7."""
        name = name.replace('"', "").removeprefix("#")
        around, dot, rest = name.partition(".")
        return rest if dot and self.detail is not Detail.WRITTEN and around.casefold() in self.lists else name

    # -- variables

    def _globals(self) -> None:
        for section in self.project.global_sections():
            self._typed = typed_attributes(section.declaration)
            for variable in section.variables:
                if variable.name.casefold() in self.structures and isinstance(variable.type, t.StructType):
                    for member in _members(variable, variable.type):
                        self._variable(self.whole, "global variable", member, section, variable.name)
                else:
                    self._variable(self.whole, "global variable", variable, section, section.name or "")
        self._typed = {}
        for block in self.project.data_blocks:
            sections = sections_of(block.interface)
            unread = kept(block.extension_data).get("unread")
            if unread is not None:
                part = self.whole.add("start values", block.name, block.report_path)
                part.tell("start values", Meaning.of(" ".join(unread.split())))
            if block.name.casefold() in self.programs:
                continue
            if block.type_name is not None or block.kind is DataBlockKind.INSTANCE:
                kept_all = [is_retained(section, variable) for section in sections for variable in section.variables]
                around = VariableSection(retain=bool(kept_all) and all(kept_all))
                self._variable(self.whole, "global variable", _instance(block), around, "")
                continue
            for section in sections:
                for variable in section.variables:
                    self._variable(self.whole, "global variable", self._translated(variable), section, block.name)
        for table in self.project.tag_tables:
            for tag in table.tags:
                variable = t.Variable(name=tag.name, type=type_named(tag.type) or t.DerivedType(name=tag.type))
                part = self._variable(self.whole, "global variable", variable, VariableSection(), "")
                if self.detail is Detail.WRITTEN or not is_operand_of_s5(variable.type):
                    part.tell("address", address_meaning(tag.address, Dialect.SCL))
            for constant in table.constants:
                self._variable(self.whole, "global variable", constant, VariableSection(constant=True), "")

    def _translated(self, variable: t.Variable) -> t.Variable:
        """Return a member of a data block as texts name it that are translated already."""
        if self.dialect is Dialect.SCL or not len(self._renames):
            return variable
        type_ = variable.type
        if isinstance(type_, t.StructType):
            type_ = type_.model_copy(update={"members": [self._translated(member) for member in type_.members]})
        name = self._renames.new_name(NameScope.MEMBER, variable.name) or variable.name
        return variable.model_copy(update={"name": name, "type": type_})

    @cached_property
    def _renames(self) -> Renames:
        return kept_renames(self.project)

    def _lists(self) -> None:
        """Note the lists of global variables and the data blocks by what they declare."""
        lists: list[VariableSection | DataBlock] = [s for s in self.project.global_sections() if s.name]
        for thing in (*lists, *self.project.data_blocks):
            kind = "data block" if isinstance(thing, DataBlock) else "list of global variables"
            part = self.whole.add(kind, thing.name or "", f"{kind} {thing.name}", cast("NamedObject", thing))
            self.tell_comment(part, thing)
            typed = thing.declaration if isinstance(thing, VariableSection) else None
            tell_declaration(part, thing, typed_attributes(typed).get("", ()))
            declaring = thing.interface if isinstance(thing, DataBlock) else Interface(sections=[thing])
            names = [variable.name.casefold() for variable in declaring.variables()] if declaring is not None else []
            part.tell("variables", Meaning.of(frozenset(names)))

    def _local(self, part: Part, pou: Pou, kind: str, variable: t.Variable, section: VariableSection) -> None:
        """Note a variable of a POU; one that is a tag in S7 is global wherever it is."""
        tag = self.tags.get(pou.name.casefold(), {}).get(variable.name.casefold())
        if tag is None:
            self._variable(part, kind, variable, section, "")
        else:
            as_tag = variable.model_copy(update={"name": tag.name})
            self._variable(self.whole, "global variable", as_tag, section.model_copy(update={"name": None}), "")

    def _variable(self, owner: Part, kind: str, variable: t.Variable, section: VariableSection, around: str) -> Part:
        place = f"{around}.{variable.name}" if around and owner is self.whole else variable.name
        path = f"{kind} {place}" if owner is self.whole else f"{owner.path} / {variable.name}"
        part = owner.add(kind.removesuffix(" of a function"), variable.name, path, variable)
        is_listed = bool(self.detail) and isinstance(variable.type, t.StructType)
        part.tell("type", Meaning.of("STRUCT") if is_listed else self._type(variable.type))
        for member in variable.type.members if self.detail and isinstance(variable.type, t.StructType) else ():
            self._variable(part, "member", member, VariableSection(), "")
        if not is_listed or variable.initial is not None:
            part.tell("initial value", self.starts.meaning(variable))
        elements = variable.extension_data.elements if variable.extension_data is not None else []
        unread = [each for each in elements if "<StartValue" in each]
        if unread and variable.initial is None:
            part.tell("start values", Meaning.of(tuple(unread), "in a form that is not read"))
        tell_type(part, variable.type)
        part.tell("address", address_meaning(variable.address, self.addresses))
        if is_retained(section, variable):
            part.tell("retain", Meaning.of(True, "RETAIN"))
        if section.constant or section.kind is SectionKind.CONSTANT:
            part.tell("constant", Meaning.of(True, "CONSTANT"))
        if self.detail is Detail.WRITTEN:
            part.tell("list", Meaning.of(plain_name(around), around) if around else None)
            part.tell("persistent", Meaning.of(True, "PERSISTENT") if section.persistent else None)
            for name, value in variable.attributes.items():
                part.tell(name, Meaning.of(value))
        self._attributes(part, variable, variable.name.casefold())
        self.tell_comment(part, variable)
        edge = kept(variable.extension_data).get("edge")
        part.tell("edge", Meaning.of(edge) if edge else None)
        if owner is not self.whole:
            section_kind = SectionKind.LOCAL if section.kind is SectionKind.CONSTANT else section.kind
            if section_kind is SectionKind.INPUT and is_operand_of_s5(variable.type):
                section_kind = SectionKind.IN_OUT  # the block changes the timer or counter of its caller
            if section_kind is SectionKind.LOCAL and kind == "variable of a function":
                section_kind = SectionKind.TEMP  # a function keeps nothing
            part.tell("section", Meaning.of(section_kind.value))
            keyword = kept(section.extension_data).get("keyword")
            if keyword in KEPT_IN_METHODS:
                part.tell("static" if keyword == "VAR_STAT" else "kept", Meaning.of(True, keyword))
        return part

    def _attributes(self, part: Part, thing: Element, name: str, declaration: str | None = None) -> None:
        """Note the attributes of what is declared, `name` in the text at hand: all, or those that act."""
        typed = self._typed.get(name, ())
        if self.detail is Detail.WRITTEN:
            tell_declaration(part, thing, typed, declaration)
        else:
            tell_acting_attributes(part, thing, typed)

    # -- POUs

    def _pou(self, pou: Pou) -> None:
        """Add a POU: its declarations, bodies and methods, and the actions that its bodies do not bring along."""
        part = self.whole.add("POU", pou.name, pou.report_path, pou)
        self.own = self._hiding(pou)
        self.tell_comment(part, pou)
        is_program = pou.kind is PouKind.FUNCTION_BLOCK and pou.name.casefold() in self.programs.values()
        part.tell("kind", Meaning.of(PouKind.PROGRAM.value if is_program else pou.kind.value))
        typed = pou.interface.declaration if pou.interface is not None else None
        self._typed = typed_attributes(typed)
        if self.detail is Detail.WRITTEN:
            part.tell("number", Meaning.of(pou.number) if pou.number is not None else None)
        self._attributes(part, pou, "", typed)
        tell_inheritance(part, pou)
        if pou.interface is not None:
            self._result(part, pou.interface.return_type)
            for section in pou.interface.sections:
                # VAR_EXTERNAL declares nothing: a global variable that is missing is told as such
                is_told = section.kind is not SectionKind.EXTERNAL or self.detail is Detail.WRITTEN
                for variable in section.variables if is_told else ():
                    if section.kind is SectionKind.RETURN:
                        self._result(part, variable.type)
                    elif not is_system_data(variable):  # which TIA Portal makes of the chart
                        kind = "variable of a function" if pou.kind is PouKind.FUNCTION else "variable"
                        self._local(part, pou, kind, variable, section)
        for name in sorted(pou.implicit_flags()) if not self.detail else ():
            known = self.compared_with.parts.get(Key("POU", plain_name(pou.name)), Part("")).parts
            flag = Key("variable", plain_name(name))
            if flag in known and flag not in part.parts:  # one tool lists what the other declares unasked
                part.parts[flag] = known[flag]
        called: set[str] = set()
        programs = 0
        for body in pou.bodies:
            self._body(part, pou, body, pou.report_path, called, number=programs)
            programs += not isinstance(body, SfcBody)
        for method in pou.methods:
            inner = part.add("method", method.name, f"{pou.report_path} / method {method.name}")
            self.own = self._hiding(pou, method)
            inner.tell("code", self.code(method.body))
            self.own = self._hiding(pou)
            typed = method.interface.declaration if method.interface is not None else None
            self._typed = typed_attributes(typed)
            if self.detail is Detail.WRITTEN:
                self._result(inner, method.interface.return_type if method.interface is not None else None)
                self.tell_comment(inner, method)
            self._attributes(inner, method, "", typed)
            for section in sections_of(method.interface):
                for variable in section.variables:
                    self._variable(inner, "variable", variable, section, "")
        is_written = self.detail is Detail.WRITTEN
        for action in pou.actions:
            if is_written or action.name.casefold() not in called or isinstance(action.body, SfcBody):
                inner = part.add("action of the POU", action.name, f"{pou.report_path} / action {action.name}", action)
                self.tell_comment(inner, action)
                if action.body is not None:
                    self._body(inner, pou, action.body, inner.path, called)
        for named in pou.transitions if is_written else ():
            path = f"{pou.report_path} / named transition {named.name}"
            part.add("named transition", named.name, path, named).tell("code", self.code(self._as_text(named)))

    def _hiding(self, *owners: Pou | Method) -> frozenset[str]:
        """Return the variables that hide global ones of their names."""
        sections = (section for each in owners if each.interface is not None for section in each.interface.sections)
        inner = (section.variables for section in sections if section.kind is not SectionKind.EXTERNAL)
        names = frozenset(v.name.casefold() for variables in inner for v in variables)
        return names & (self.values.keys() | self.listed.keys())

    def _as_text(self, named: NamedTransition) -> Body | None:
        """The body of a transition object; as an expression where it is an archive of networks that is understood."""
        shown = shown_named_condition(named, self.dialect) if isinstance(named.body, OpaqueBody) else None
        return StBody(text=shown[0]) if shown is not None else named.body

    def _result(self, part: Part, kind: t.DataType | None) -> None:
        if not (isinstance(kind, t.DerivedType) and kind.name.casefold() == "void"):  # S7 has it for functions without
            part.tell("result", type_meaning(kind, self.dialect))

    def _body(self, part: Part, pou: Pou, body: Body, path: str, called: set[str], *, number: int = 0) -> None:
        """Note what a body does; `number`: the programs of the POU before it."""
        if isinstance(body, SfcBody):
            if body.chart.steps or body.chart.transitions or body.chart.partial_charts:
                ExecutedChartReader(self, pou, body.chart, path, called).read(part.add("chart", "", path))
        else:
            result = pou.name if pou.kind is PouKind.FUNCTION else ""
            meaning = self.code(body, result)
            part.tell(f"code {number + 1}" if number else "code", meaning)
            if self.detail is Detail.WRITTEN and meaning is not None:
                part.tell(f"language {number + 1}" if number else "language", Meaning.of(body.language))
            self.tell_networks(part, body, number=number)


def _in_languages(text: Text | None) -> Iterator[tuple[str, str]]:
    """Yield the words of a text, and those in further languages, each with its language; empty for the first one."""
    others = [*text.texts][1:] if isinstance(text, MultilingualText) else ()
    for language in ("", *others):
        words = " ".join(words_of(text, language).split())
        if words:
            yield language, words


def _members(variable: t.Variable, type_: t.StructType) -> Iterator[t.Variable]:
    """Yield the members of a structure as variables, with the values that it gives them."""
    values = variable.initial.members if isinstance(variable.initial, t.StructValue) else []
    given = {each.member.casefold(): each.value for each in values}
    for member in type_.members:
        yield member.model_copy(update={"initial": given.get(member.name.casefold(), member.initial)})


def _instance(block: DataBlock) -> t.Variable:
    """Return the variable that an instance data block is, with its start values."""
    given = (
        [variable for variable in block.interface.variables() if variable.initial is not None]
        if block.interface is not None
        else []
    )
    members = [t.MemberValue(member=each.name, value=each.initial) for each in given if each.initial is not None]
    type_name = (block.type_name or "").strip('"')
    return t.Variable(
        name=block.name, type=t.DerivedType(name=type_name), initial=t.StructValue(members=members) if members else None
    )


_DEEPEST = 32
"""No type is another name for another name .. more often: these name each other."""
_OF_OBJECTS = frozenset({"THIS", "SUPER"})
"""Names that no tool declares: languages have them, or translations report them."""
_RESULTS = frozenset({"trcoil", "ilcoil", "svcoil"})
"""Names of the results of the networks of S7-GRAPH."""


_MEMBER = re.compile(r"\b([^\W\d]\w*)\.([^\W\d]\w*)")
_LITERAL = re.compile(r"""\s*(?:\w+#)?['"]""")
"""A literal of characters, in which nothing is a name."""


def _values(project: Project, listed: Mapping[str, int]) -> dict[str, str]:
    """Return the numbers of values of enumerations and of global constants, by their names in lower case.

    A name that several lists have, by their number in `listed`, has the value of one with the name of that alone.
    """
    found: dict[str, str] = {}
    for declaration in project.data_types:
        number = -1
        for value in declaration.type.values if isinstance(declaration.type, t.EnumType) else ():
            given = (value.value or "").strip()
            size = whole_number(given.removeprefix("-"))
            number = number + 1 if size is None else -size if given.startswith("-") else size
            for name in (f"{declaration.name}.{value.name}", f"{declaration.name}_{value.name}"):
                found[name.casefold()] = str(number)
    groups = [(section.name or "", section.variables) for section in project.global_sections() if section.constant]
    groups += [("", table.constants) for table in project.tag_tables]
    for around, constants in groups:
        for constant in constants:
            if isinstance(constant.initial, t.SimpleValue) and constant.initial.text is not None:
                name = constant.name.casefold()
                found[f"{around}.{name}".casefold() if listed.get(name, 0) > 1 else name] = constant.initial.text
    return found


def _listed(project: Project) -> Counter[str]:
    """Count the lists that have a variable of a name, by the names in lower case."""
    lists = [section.variables for section in project.global_sections() if section.name]
    lists += [block.interface.variables() for block in project.data_blocks if block.interface is not None]
    return Counter(name for variables in lists for name in {variable.name.casefold() for variable in variables})


def _is_call(occurrence: Occurrence) -> bool:
    """True for the name of a function or a block, where it is called."""
    holder = occurrence.text_site.holder
    return occurrence.reference.role in (Role.ACTION, Role.CALL) and not isinstance(holder, ActionAssociation | Step)
