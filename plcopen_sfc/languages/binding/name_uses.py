"""Uses of the things that a project declares: in bodies of every language, in charts and in declarations."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from itertools import chain

from plcopen_sfc.errors import ModelError, check_argument
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding.name_resolution import Resolver, Type, Untyped
from plcopen_sfc.languages.binding.name_sites import (
    Reference,
    in_declarations,
    in_expression,
    in_instructions,
    in_kept_texts,
    in_networks,
    in_property,
    in_repeated_list,
    in_statements,
    unread,
)
from plcopen_sfc.languages.binding.symbols import NOTHING, Binding, Level
from plcopen_sfc.languages.binding.text_sites import Role, Site, SiteKind, TextSite, text_sites
from plcopen_sfc.languages.grafcet_conditions import OVERLINE
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.standard_blocks import StandardBlock, Tool
from plcopen_sfc.languages.words import CODESYS_KEYWORDS, is_plain, objection
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.owners import Owned
from plcopen_sfc.model.pou import Method, Pou, PouKind
from plcopen_sfc.model.project import Project, Tag
from plcopen_sfc.model.sfc import ActionAssociation
from plcopen_sfc.model.types import DerivedType, StructType, Variable
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Use


def references(text_site: TextSite, dialect: Dialect) -> Iterator[Reference]:
    """Yield every name in the text of a text site."""
    text = text_site.text
    if isinstance(text_site.holder, ActionAssociation) and text_site.key == "target" and is_plain(text):
        yield Reference(text, (0, len(text)), text_site.role)  # also what is a keyword elsewhere: ``Continue``
    elif text_site.reading is SiteKind.EXPRESSION:
        yield from in_expression(text, text_site.role, dialect)
    elif text_site.reading is SiteKind.NAME:
        yield Reference(text, (0, len(text)), text_site.role)
    elif text_site.reading is SiteKind.FOREIGN:
        yield from unread(text, 0, "it is in data that only another tool reads")
    else:
        yield from _READERS[text_site.reading](text, dialect)


_READERS = {
    SiteKind.STATEMENTS: in_statements,
    SiteKind.INSTRUCTIONS: in_instructions,
    SiteKind.DECLARATIONS: in_declarations,
    SiteKind.REPEATED: in_repeated_list,
    SiteKind.KEPT: in_kept_texts,
    SiteKind.PROPERTY: in_property,
    SiteKind.NETWORKS: in_networks,
}


@dataclass(frozen=True, slots=True, eq=False)
class Occurrence:
    """A name in a text of the project, and what it means there."""

    text_site: TextSite
    reference: Reference
    meaning: Binding

    @property
    def use(self) -> Use:
        """The place, for people."""
        text, start = self.text_site.text, self.reference.span[0]
        if self.text_site.reading is SiteKind.KEPT:  # which no person has written
            return Use(self.text_site.path, "declaration", self.reference.span, 1, 1, self.reference.name)
        line, column = Lines(text).place(start)
        return Use(
            self.text_site.path,
            self.text_site.language,
            self.reference.span,
            line,
            column,
            text.splitlines()[line - 1].strip(),
        )

    def refers_to(self, declaration: Declaration) -> bool:
        """True if it means this declaration."""
        return self.meaning.declaration == declaration

    def may_refer_to(self, declaration: Declaration) -> bool:
        """True if it could be this declaration, and nothing tells."""
        meaning = self.meaning
        if not meaning.doubt:
            return False
        if meaning.candidates is not None:
            return declaration in meaning.candidates
        if self.reference.callee is not None:
            return declaration.kind in (Kind.VARIABLE, Kind.MEMBER)
        return declaration.kind is not Kind.TRANSITION or self.text_site.reading is SiteKind.FOREIGN


def by_text(found: Iterable[Occurrence]) -> list[list[Occurrence]]:
    """Return the occurrences of each text, in the order of the text."""
    text_sites = grouped(((id(each.text_site.holder), each.text_site.key), each) for each in found)
    return [sorted(own, key=lambda each: each.reference.span) for own in text_sites.values()]


_FEW_WORDS = 100
"""Words that are looked for in a text before it is parsed: to look for more takes as long as to parse most texts."""


class Names:
    """The names of a project: what is declared, and where it is used. Edits of the project make it wrong."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.dialect = dialect_of(project)
        self.resolver = Resolver(project, self.dialect)
        self._text_sites: dict[tuple[frozenset[str], frozenset[int]], list[TextSite]] = {}
        self._by_path: dict[str, dict[str, list[Declaration]]] = {}

    def after_edits(self) -> Names:
        """Return the names of the project again, after texts and names in it have changed but nothing else."""
        following = Names(self.project)
        following._text_sites = self._text_sites
        return following

    def occurrences(self, *words: str, of: Collection[Declaration] = ()) -> Iterator[Occurrence]:
        """Yield every name site of one of `words`, in upper or lower case, with its meaning.

        `of`: only places matter that may mean one of these. Steps and transitions are not looked for where another
        POU has the same word on its own, or nearly every chart would be read for ``Init``.
        """
        keys = frozenset(word.casefold() for word in words)
        local = all(each.kind in (Kind.STEP, Kind.TRANSITION) and each.pou is not None for each in of)
        homes = [each.pou for each in of if each.pou is not None] if of and local else None
        for text_site in self.text_sites(keys, homes) if keys else ():
            text = text_site.text.casefold().replace(OVERLINE, "")
            if len(keys) > _FEW_WORDS or any(key in text for key in keys):
                for reference in self._references(text_site):
                    if reference.name.casefold() in keys:
                        yield Occurrence(text_site, reference, self.resolver.meaning(reference, text_site))

    def occurrences_in(self, text_site: TextSite) -> Iterator[Occurrence]:
        """Yield every name in one text, with its meaning."""
        for reference in self._references(text_site):
            yield Occurrence(text_site, reference, self.resolver.meaning(reference, text_site))

    def _references(self, text_site: TextSite) -> Iterator[Reference]:
        for reference in references(text_site, self.dialect):
            yield self._step_of_flag(reference, text_site.site) or reference

    def _step_of_flag(self, reference: Reference, site: Site) -> Reference | None:
        """Return the step that a name in a GRAFCET is the flag of: ``X12`` (IEC 60848:2013, 4.3 and 7.4)."""
        is_flag = reference.role is Role.VALUE and reference.base is None and reference.callee is None
        if not is_flag or reference.name[:1] not in ("X", "x") or reference.unread or not self.is_in_grafcet(site):
            return None
        if self.resolver.lookup(reference, site) is not NOTHING:  # a variable
            return None
        start, end = reference.span
        letter = 1 + reference.overlined
        step = replace(reference, name=reference.name[1:], span=(start + letter, end), access="x")
        meaning = self.resolver.lookup(step, site)
        found = meaning.candidates or (meaning.declaration,)
        return step if any(each is not None and each.kind is Kind.STEP for each in found) else None

    def is_in_grafcet(self, site: Site) -> bool:
        """True for a text of a GRAFCET: in its conditions a dot is AND, and `X12` is the flag of a step."""
        return self._is_of_grafcet or any(chart.partial_charts for chart in site.charts)

    @cached_property
    def _is_of_grafcet(self) -> bool:
        return self.project.tool_format.startswith("grafcet")  # asks for all that was found wrong in the file

    def objection_to(self, declaration: Declaration, name: str) -> str:
        """Return why a name cannot be that of a declaration; empty if it can. Steps of a GRAFCET may have numbers."""
        pou = declaration.pou
        if declaration.kind is Kind.STEP and pou is not None and name.isascii() and name.isdecimal():
            chart = pou.chart
            if self.is_in_grafcet(Site(pou, charts=(chart,) if chart is not None else ())):
                return ""
        return self.objection(name)

    def objection(self, name: str) -> str:
        """Return why something new cannot have a name; empty if it can.

        What a file of CODESYS has already may be a keyword of another version: ``JMP``, ``Property``.
        """
        if self.dialect in (Dialect.CODESYS, Dialect.TWINCAT) and name.upper() in CODESYS_KEYWORDS:
            return "it is a keyword"
        return objection(name, self.project.dialect)

    @cached_property
    def everything(self) -> list[Occurrence]:
        """Every name in every text."""
        return [each for text_site in self.text_sites() for each in self.occurrences_in(text_site)]

    def undeclared(self, pou: Pou | None = None) -> Iterator[Occurrence]:
        """Yield the names in program text, of all POUs or of `pou`, that are no members and that nothing declares.

        Each where it is first.
        """
        found: set[str] = set()
        declared: set[tuple[Site, Role, str]] = set()
        # what extends something unknown: names may be declared there
        open_ended = {id(each) for each in self.project.pous if self.resolver.scopes.extends_unknown(each)}
        for text_site in self.text_sites():
            own = text_site.site.pou
            if not text_site.is_program_text or (pou is not None and own is not pou) or id(own) in open_ended:
                continue
            for reference in self._references(text_site):
                name = reference.name.casefold()
                is_member = reference.base is not None or reference.callee is not None
                if is_member or name in found or (text_site.site, reference.role, name) in declared:
                    continue
                meaning = self.resolver.meaning(reference, text_site)
                if meaning.declaration is not None and not _is_own_name(reference, meaning.declaration, own):
                    declared.add((text_site.site, reference.role, name))
                elif not meaning.doubt:
                    found.add(name)
                    yield Occurrence(text_site, reference, meaning)

    def undeclared_types(self) -> Iterator[Occurrence]:
        """The names of types that nothing declares, but for those of libraries by their paths: each where it is first.

        In S7 the types of the controller have no quotes.
        """
        found: set[str] = set()
        for text_site in self.text_sites():
            if text_site.role is not Role.TYPE or not isinstance(text_site.holder, DerivedType | Tag):
                continue
            for reference in self._references(text_site):
                name, is_quoted = reference.name.casefold(), text_site.text.startswith('"')
                of_controller = self.dialect is Dialect.SCL and not is_quoted
                if name in found or of_controller or name != text_site.text.strip('"').casefold():
                    continue
                meaning = self.resolver.meaning(reference, text_site)
                is_known = meaning.declaration is not None or meaning.doubt
                if not is_known and self.resolver.settled(DerivedType(name=name), "") is Untyped.ELSEWHERE:
                    found.add(name)
                    yield Occurrence(text_site, reference, meaning)

    def undeclared_members(self) -> Iterator[Occurrence]:
        """The names that a type, a list or a block, which the project declares or which is standard, does not have.

        They are behind dots, or name parameters in calls.
        """
        scopes = self.resolver.scopes
        for occurrence in self.everything:
            reference, meaning, site = occurrence.reference, occurrence.meaning, occurrence.text_site.site
            if meaning.declaration is not None or meaning.doubt:
                continue
            type_: Type | Method
            if reference.base is not None:
                type_ = self.resolver.type_of(reference.base, site, reference.name)
                block = self.resolver.standard_block_of(reference.base, site)
            elif reference.callee is not None and reference.name.upper() not in ("EN", "ENO"):
                type_ = self.resolver.called_type(reference.callee, site)
                block = self.resolver.standard_block_of(reference.callee, site)
            else:
                continue
            if block is not None:
                if not self._has_pin(block, reference.name):
                    yield occurrence
            elif isinstance(type_, Level | StructType | Pou | Method) and not scopes.extends_unknown(type_):
                yield occurrence

    def _has_pin(self, block: StandardBlock, name: str) -> bool:
        """True if a block has an input or output of this name in the tool of the project; of S7 there are versions."""
        dialect = self.project.dialect
        own = block.pin_in(name, Tool.CODESYS if dialect in (Dialect.CODESYS, Dialect.TWINCAT) else None)
        return own is not None and (dialect is Dialect.SCL or own.casefold() == name.casefold())

    def unused(self, *, callable_elsewhere: bool = False) -> list[Declaration]:
        """The actions, named transitions and local variables that nothing in the project names, as far as can be told.

        A name of which it is not known what it means counts for everything of this name. Variables that the tool uses
        itself are left out: those of steps, SFC flags, data of S7-GRAPH, and those with an address. So are actions
        where the project has no task, unless `callable_elsewhere`: it is a part of another, which may call them.
        """
        with_actions = callable_elsewhere or any(each.tasks or each.instances for each in self.project.resources())
        used: set[Declaration] = set()
        doubtful: set[str] = set()
        for each in self.everything:
            if each.reference.declares or each.reference.role in (Role.HEAD, Role.OBJECT):
                continue
            if (found := each.meaning.declaration) is not None:
                if found.holder is not each.text_site.site.transition:  # its body gives it its value
                    used.add(found)
            elif each.meaning.doubt:
                doubtful.add(each.reference.name.casefold())
        return [
            each
            for each in self.declarations()
            if _is_for_text(each) and each not in used and each.name.casefold() not in doubtful
            if with_actions or each.kind is not Kind.ACTION
        ]

    def text_sites(self, words: frozenset[str] = frozenset(), homes: Collection[Pou] | None = None) -> list[TextSite]:
        """Every text that may name something; with `words`, in charts that mention one of them: see `text_sites`."""
        key = words, frozenset(map(id, homes or ()))
        if homes is None and _EVERY in self._text_sites:
            key = _EVERY  # more than is asked for, but it is there
        if key not in self._text_sites:
            self._text_sites[key] = list(text_sites(self.project, words, homes))
        return self._text_sites[key]

    def uses(self, declaration: Declaration) -> list[Occurrence]:
        """Return every use of a declaration."""
        found = self.occurrences(declaration.name, of=(declaration,))
        return [each for each in found if each.refers_to(declaration)]

    def declarations(self, wanted: Callable[[Pou], bool] = lambda _: True) -> Iterator[Declaration]:
        """Everything that is declared and that a name can mean, but for what is in POUs that are not wanted."""
        return self._in(self.levels(wanted))

    def _in(self, levels: Iterable[Level]) -> Iterator[Declaration]:
        seen: set[Declaration] = set()
        for level in levels:
            for declaration in level:
                if declaration not in seen:
                    seen.add(declaration)
                    yield declaration

    def levels(self, wanted: Callable[[Pou], bool] = lambda _: True) -> Iterator[Level]:
        """Yield every scope of the project, but for those of POUs that are not wanted."""
        scopes = self.resolver.scopes
        yield from scopes.every_place()
        for pou in filter(wanted, self.project.pous):
            yield scopes.pou(pou)
            for method in pou.methods:
                yield scopes.method(pou, method)
        yield from scopes.every_type()
        yield from (scopes.data_block(block) for block in self.project.data_blocks)

    def levels_with(self, declaration: Declaration) -> Iterator[Level]:
        """Yield every scope that may have `declaration`: for a step or a transition those of its POU."""
        pou = declaration.pou
        if declaration.kind in (Kind.STEP, Kind.TRANSITION) and pou is not None:
            yield self.resolver.scopes.pou(pou)
            for method in pou.methods:
                yield self.resolver.scopes.method(pou, method)
        else:
            yield from self.levels()

    def declaration_of(self, thing: Model) -> Declaration:
        """Return the declaration of an object of the model: a step, a variable, a POU .. Raises `ModelError`."""
        owner: object = thing
        while isinstance(owner, Owned) and not isinstance(owner, Pou):
            owner = owner.owner
        is_inside = isinstance(owner, Pou) and owner is not thing and owner.project is self.project
        near = self.resolver.scopes.pou(owner) if is_inside and isinstance(owner, Pou) else ()
        for declaration in chain(near, self.declarations()):
            if id(thing) in map(id, declaration.holders):
                return declaration
        raise ModelError(f"the project declares no such {type(thing).__name__}")

    def find(self, path: str) -> list[Declaration]:
        """Return the declarations of this path (``Main.S3``); case does not matter."""
        head = path.casefold().partition(".")[0]
        if head not in self._by_path:
            found = self._by_path[head] = {}
            # what is in a POU has its name in front: the charts of others stay unread
            for declaration in self.declarations(lambda pou: pou.name.casefold() == head):
                found.setdefault(declaration.path.casefold(), []).append(declaration)
        return self._by_path[head].get(path.casefold(), [])


_EVERY: tuple[frozenset[str], frozenset[int]] = frozenset(), frozenset()


def _is_own_name(reference: Reference, declaration: Declaration, own: Pou | None) -> bool:
    """True if a program or function block names itself where a value is expected: only a function is one, its result.

    ``Pump.x`` is a variable of it, ``Pump()`` a call.
    """
    if own is None or own.kind is PouKind.FUNCTION or declaration.holder is not own:
        return False
    return reference.role is Role.VALUE and not reference.access


def _is_for_text(declaration: Declaration) -> bool:
    """True if nothing but text of the project can use what is declared: an action, a condition, a local variable."""
    pou, holder = declaration.pou, declaration.holder
    if pou is None:
        return False
    if not isinstance(holder, Variable):
        return id(holder) in {id(each) for each in (*pou.actions, *pou.transitions)}
    own = any(holder is each for kind in _LOCAL for each in pou.variables(kind))
    type_ = holder.type.name if isinstance(holder.type, DerivedType) else ""
    return own and not holder.address and not _OF_TOOLS.fullmatch(type_) and holder.name.casefold() not in _FLAGS


_LOCAL = (SectionKind.LOCAL, SectionKind.TEMP)
_OF_TOOLS = re.compile(r"G7_\w+|SFC(?:Step|Action)Type", re.IGNORECASE)
"""Types of variables that S7-GRAPH, and CODESYS on demand, declare for themselves."""
_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)


def find_uses(project: Project, what: Declaration | Model | str) -> list[Use]:
    """Every place of `project` that names `what`: a declaration, an object of the model, or a path such as ``Main.S3``.

    The place of the declaration itself is not among them. Raises `ModelError` where the project declares no such thing,
    or several.
    """
    check_argument(what, (Declaration, Model, str), 'uses needs a path ("Main.S3") or an object of the model')
    names = Names(project)
    if isinstance(what, str):
        what = unique_declaration(names, what)
    elif isinstance(what, Model):
        what = names.declaration_of(what)
    what = names.resolver.original(what)
    return [occurrence.use for occurrence in names.uses(what)]


def unique_declaration(names: Names, path: str) -> Declaration:
    """Return the declaration of this path. Raises `ModelError` where there is none, or more than one."""
    found = list(dict.fromkeys(names.resolver.original(declaration) for declaration in names.find(path)))
    if len(found) == 1:
        return found[0]
    if found:
        kinds = ", ".join(declaration.kind for declaration in found)
        raise ModelError(
            f"several things are called {path!r}: {kinds}",
            hint="In a script, give the object itself instead of its path.",
        )
    last = path.rpartition(".")[2].casefold()
    paths = sorted({d.path for d in names.declarations()})
    alike = [p for p in paths if p.rpartition(".")[2].casefold() == last] or get_close_matches(path, paths)
    raise ModelError(f"the project declares no {path!r}", hint=f"There is: {', '.join(alike[:10])}" if alike else "")


def dialect_of(project: Project) -> Dialect:
    """Return the dialect in which the texts of a project are read.

    CODESYS has all signs of IEC 61131-3, and more; only SCL reads the same signs in another way.
    """
    return Dialect.SCL if project.dialect is Dialect.SCL else Dialect.CODESYS
