"""Putting all program text of a project into another dialect."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding.constant_values import ConstantValues
from plcopen_sfc.languages.binding.name_resolution import Resolver, Type
from plcopen_sfc.languages.binding.name_uses import Names
from plcopen_sfc.languages.binding.text_sites import Role, Site, SiteKind, TextSite, text_sites
from plcopen_sfc.languages.declarations.attributes import keep_typed_attributes
from plcopen_sfc.languages.expression_types import BIT_STRINGS, CALCULATING, ExpressionTypes
from plcopen_sfc.languages.il import statements as instruction_statements
from plcopen_sfc.languages.networks import body_statements, condition_reader, is_empty_network
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.s7_globals import local_tags, names_from_s7, names_in_s7
from plcopen_sfc.languages.s7_programs import names_of_programs
from plcopen_sfc.languages.s7_types import S7Types, s7_types
from plcopen_sfc.languages.st import (
    bare_condition,
    parse_body,
    parse_condition,
    parse_expression,
    render,
    transform,
    walk,
)
from plcopen_sfc.languages.st.literals import INTEGER_RANGES
from plcopen_sfc.languages.st.nodes import Assignment, Call, Expression, Member, Name, Node, Operation, Statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.languages.standard_blocks import Tool, standard_block
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.translation import (
    NameScope,
    Note,
    Rename,
    Renames,
    StepNotation,
    StepReferences,
    Translated,
    TranslationContext,
    is_foreign,
    translate,
)
from plcopen_sfc.languages.translation.arithmetic_translation import ArithmeticTranslator
from plcopen_sfc.languages.translation.call_translation import other_bits, other_rounding
from plcopen_sfc.languages.translation.renames import kept_renames
from plcopen_sfc.languages.translation.translation_context import TITLES, NameTable, Notes, family
from plcopen_sfc.model import (
    ActionAssociation,
    Interface,
    Pou,
    Project,
    SfcBody,
    SfcNetwork,
    Tag,
)
from plcopen_sfc.model.actions import SWITCHES
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.declaration import Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.sfc import BodyCondition, placed_conditions
from plcopen_sfc.model.types import (
    DerivedType,
    ElementaryType,
    EnumType,
    StringType,
    SubrangeType,
)
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.refactor.declaration_translation import TranslatedText, compute_constants, translate_declarations
from plcopen_sfc.refactor.direct_addresses import renumber_declared

_NOTATIONS = {
    Dialect.IEC: StepNotation.IEC,
    Dialect.CODESYS: StepNotation.CODESYS,
    Dialect.TWINCAT: StepNotation.CODESYS,
    Dialect.SCL: StepNotation.S7_GRAPH,
}


def translate_project(
    project: Project, target: Dialect, *, calls_actions: bool = False, addresses: Dialect | None = None
) -> list[TranslatedText]:
    """Put every body, condition and expression of `project` into `target`; gives what became of each.

    `calls_actions`: calls of actions and methods in SCL are no loss, since the writer puts others in their places.
    `addresses` is the dialect that direct addresses get, where it is not `target`.

    Text without a counterpart stays unchanged and is noted. Names that only SCL can write (with blanks, umlauts) get
    others, in the declarations as well. Declarations that a file keeps as text are left out: they are written from the
    variables.
    """
    source, target = project.dialect, Dialect(target)
    counting = (project.address_dialect, addresses or target)
    computed = compute_constants(project) if target is Dialect.SCL and source is not target else []
    computed += _number_bits(project, target)
    resolver = Resolver(project, source)
    globals_ = _Globals(
        *(s7_types(project), frozenset(_global_names(project)), resolver.functions, _other_names(project, target)),
        resolver,
        local_tags(project) if (source is Dialect.SCL) is not (target is Dialect.SCL) else {},
        calls_actions,
        counting,
    )
    texts = [
        text_site for text_site in text_sites(project) if text_site.is_program_text and not _names_a_step(text_site)
    ]
    renames = kept_renames(project) if target is Dialect.SCL else _names_of_results(project, source, target)
    contexts = _Contexts(project, target, renames, globals_)
    while True:  # a later text may need a name that an earlier one has used
        known = len(renames)
        results = [_translated(text_site, target, contexts) for text_site in texts]
        if len(renames) == known:
            break
    found = list(_boxes_of_other_types(project, source, target, globals_)) if source is not target else []
    found += computed
    for text_site, result in zip(texts, results, strict=True):
        changed = result.text != text_site.text
        if changed:
            text_site.put(result.text)
        found.append(TranslatedText(text_site.report_path, changed, result.notes))
    keep_typed_attributes(project)
    for text_site in text_sites(project):
        if text_site.reading is SiteKind.DECLARATIONS and not isinstance(text_site.key, int):
            setattr(text_site.holder, text_site.key, None)
    found += translate_declarations(project, renames, target)
    for path, severity, why in renumber_declared(project, *counting):
        found.append(TranslatedText(path, True, (Note(severity, why, (0, 0), 1, 1),), "address"))
    project.dialect = target
    return found


def _number_bits(project: Project, target: Dialect) -> list[TranslatedText]:
    """Write the numbers of bits that CODESYS names by constants, ``w.BB``: others have no such access."""
    if family(project.dialect) is not Dialect.CODESYS or family(target) is Dialect.CODESYS:
        return []
    resolver = Resolver(project, project.dialect)
    values = ConstantValues(resolver)
    may_have = re.compile(rf"\.\s*(?:{'|'.join(map(re.escape, values.names))})\b", re.IGNORECASE)
    found: list[TranslatedText] = []
    for text_site in list(text_sites(project)) if values.names else ():
        if not text_site.is_program_text or not may_have.search(text_site.text):
            continue
        parsed = text_site.parsed(project.dialect)
        if parsed.problems:
            continue
        notes = Notes(text_site.text)
        text_site.put(render(parsed, transform(parsed.tree, _bit_numbering(values, resolver, text_site.site, notes))))
        if notes.in_order():
            found.append(TranslatedText(text_site.report_path, changed=True, notes=notes.in_order()))
    return found


def _bit_numbering(values: ConstantValues, resolver: Resolver, site: Site, notes: Notes) -> Callable[[Node], Node]:
    def numbered(node: Node) -> Node:
        if not isinstance(node, Member) or node.name.identifier.isdecimal():
            return node
        if _elementary(resolver.type_of(node.base, site)) not in INTEGER_RANGES:
            return node
        number = values.number(node.name, site)
        if number is None or number < 0:
            notes.add(Severity.ERROR, f"the number of the bit {node.name.identifier} is not known", node)
            return node
        notes.add(Severity.INFO, f"bit {number}: the constant {node.name.identifier} names it in CODESYS alone", node)
        return replace(node, name=replace(node.name, identifier=str(number)))

    return numbered


def translate_foreign(project: Project, target: Dialect) -> list[TranslatedText]:
    """Put every text of `project` that `target` does not read into it: CODESYS for IEC 61131-3, or the reverse.

    The others stay as they are: tools of both read most of each other's text. Anything that only CODESYS has is noted.
    """
    resolver = Resolver(project, project.dialect)
    known = _Globals(s7_types(project), frozenset(_global_names(project)), resolver.functions, {}, None)
    found = _number_bits(project, target)
    plain = _Contexts(project, target, Renames(), known)
    typed = _Contexts(project, target, Renames(), replace(known, resolver=resolver))
    # by its header a file that a tool of CODESYS made, and that was converted for others
    of_codesys = project.header.product.casefold().startswith(("codesys", "twincat"))
    every = text_sites(project)
    for text_site in [each for each in every if each.is_program_text and not _names_a_step(each)]:
        if family(target) is Dialect.CODESYS and text_site.text.lstrip().startswith(":="):  # it compiles an expression
            text_site.put(bare_condition(text_site.text, project.dialect))
            found.append(TranslatedText(text_site.report_path, changed=True, notes=()))
        if family(target) is Dialect.IEC:
            found += _only_of_codesys(text_site, project.dialect, resolver)
        is_statements = text_site.reading is SiteKind.STATEMENTS
        is_own = not is_foreign(
            *(text_site.text, is_statements, project.dialect, target),
            enumerations=plain.enumerations,
            functions=resolver.functions,
        )
        if family(target) is Dialect.CODESYS and is_own:
            narrower = _without_widening(text_site, project.dialect, target, resolver) if of_codesys else None
            if narrower is not None:
                found.append(TranslatedText(text_site.report_path, changed=True, notes=()))
                text_site.put(narrower)
            elif _ROUNDS.search(text_site.text):
                notes = _translated(text_site, target, plain).notes
                found.append(TranslatedText(text_site.report_path, changed=False, notes=notes))
            continue  # all else that IEC 61131-3 has is left to CODESYS, whose files often are in TC6
        is_wider = family(target) is Dialect.IEC and bool(
            _calculates_otherwise(text_site, project.dialect, target, resolver)
        )
        has_types = is_wider or (family(target) is Dialect.CODESYS and "TRUNC" in text_site.text.upper())
        result = _translated(text_site, target, typed if has_types else plain)
        is_lost = any(note.severity is not Severity.INFO for note in result.notes)
        if is_wider or is_lost or not is_own:
            found.append(TranslatedText(text_site.report_path, result.text != text_site.text, result.notes))
            text_site.put(result.text)
    return [*found, *_rounding_boxes(every, project.dialect, target, resolver.functions)]


def _rounding_boxes(
    sites: Iterable[TextSite], source: Dialect, target: Dialect, functions: Collection[str]
) -> Iterator[TranslatedText]:
    for site in sites:
        is_box = site.key == "type_name" and isinstance(site.owner, Block) and site.text.casefold() not in functions
        tools = family(source), family(target)
        why = (other_rounding(site.text.upper(), *tools) or other_bits(site.text.upper(), *tools)) if is_box else ""
        if why:
            yield TranslatedText(site.report_path, changed=False, notes=(Note(Severity.WARNING, why, (0, 0), 1, 1),))


_ROUNDS = re.compile(r"REAL_TO_(?!L?REAL)|TO_U?[SDL]?INT\b|\bROUND\b", re.IGNORECASE)
"""Conversions of numbers with decimals, which CODESYS rounds otherwise than IEC 61131-3."""


def rename_pins(project: Project, target: Dialect) -> list[TranslatedText]:
    """Name inputs of flip-flops and counters as the target does: ``R`` of CTU is ``RESET`` in CODESYS."""
    sites = text_sites(project, {name.casefold() for name in _OTHER_PINS})
    if not any(each.key in ("name", "type_name") and each.text.upper() in _OTHER_PINS for each in sites):
        return []
    tool = Tool.CODESYS if family(target) is Dialect.CODESYS else None
    names = Names(project)
    edits: dict[int, tuple[TextSite, list[Edit]]] = {}
    for each in names.everything:
        reference, site = each.reference, each.text_site.site
        if isinstance(each.text_site.owner, Block) and reference.role is Role.PARAMETER:
            block = standard_block(each.text_site.owner.type_name)
        else:
            instance = reference.base if reference.base is not None else reference.callee
            block = names.resolver.standard_block_of(instance, site) if instance is not None else None
        new = block.pin_in(reference.name, tool) if block is not None and block.name in _OTHER_PINS else None
        if new is not None and new.casefold() != reference.name.casefold():
            edits.setdefault(id(each.text_site), (each.text_site, []))[1].append(Edit(*reference.span, new))
    for text_site, changes in edits.values():
        text_site.put(apply_edits(text_site.text, changes))
    paths = dict.fromkeys(text_site.report_path for text_site, _ in edits.values())
    return [TranslatedText(path, changed=True, notes=()) for path in paths]


_OTHER_PINS = frozenset({"SR", "RS", "CTU", "CTD", "CTUD"})
"""Function blocks whose inputs CODESYS names otherwise than IEC 61131-3."""


def texts_that_calculate_otherwise(project: Project, target: Dialect) -> Iterator[tuple[str, str]]:
    """Yield the paths of texts that give something else in CODESYS alone, and why; see `_differences`."""
    resolver = Resolver(project, project.dialect)
    for text_site in text_sites(project):
        if text_site.is_program_text:
            for why in _calculates_otherwise(text_site, project.dialect, target, resolver):
                yield text_site.report_path, why


def boxes_that_calculate_otherwise(project: Project, target: Dialect) -> Iterator[tuple[str, str]]:
    """Yield the paths of drawn logic and of instruction lists that do; see `texts_that_calculate_otherwise`."""
    source, resolver = project.dialect, Resolver(project, project.dialect)
    for path, pou, tree in (*_drawn(project, source), *_listed(project, source)):
        for why in _differences(tree, source, target, _with_types(TranslationContext(), Site(pou=pou), resolver)):
            yield path, why


def _calculates_otherwise(text_site: TextSite, source: Dialect, target: Dialect, resolver: Resolver) -> list[str]:
    """Return why the arithmetic of a text gives something else in `target`; see `_differences`."""
    if not _CALCULATES.search(text_site.text):
        return []
    parsed = text_site.parsed(source)
    if parsed.problems:
        return []
    return _differences(
        parsed.tree, source, target, _with_types(TranslationContext(), text_site.site, resolver, text_site)
    )


def _differences(tree: Node, source: Dialect, target: Dialect, context: TranslationContext) -> list[str]:
    """Return why arithmetic gives something else in `target`.

    Empty: CODESYS has 32 bits where IEC 61131-3 has the types of the operands.
    """
    notes = Notes("")
    is_wider = ArithmeticTranslator(family(source), family(target), context, notes).fitted(tree) is not tree
    return [*[""] * is_wider, *dict.fromkeys(note.reason for note in notes.in_order())]


def _without_widening(text_site: TextSite, source: Dialect, target: Dialect, resolver: Resolver) -> str | None:
    """Return a text of IEC 61131-3 without the conversions that CODESYS needs not, where these are the only ones.

    That is so if the way back widens the same operands: what was written from CODESYS comes back as it was.
    """
    if not _CALCULATES.search(text_site.text) or not _WIDENS.search(text_site.text):
        return None
    parsed = text_site.parsed(source)
    text = render(parsed, transform(parsed.tree, _narrowed))
    back = parse_body(text, target) if isinstance(parsed.tree, Statements) else parse_condition(text, target)
    if parsed.problems or back.problems or text == text_site.text:
        return None
    context = _with_types(TranslationContext(), text_site.site, resolver, text_site)
    widened = ArithmeticTranslator(family(target), family(source), context, Notes("")).fitted(back.tree)
    return text if render(back, widened) == text_site.text else None


def _narrowed(node: Node) -> Node:
    """Return a calculation with operands that are not converted to wider integers."""
    if not isinstance(node, Operation) or node.operator not in CALCULATING:
        return node
    operands = tuple(_operand_without_widening(each) for each in node.operands)
    same = all(a is b for a, b in zip(operands, node.operands, strict=True))
    return node if same else replace(node, operands=operands)


def _operand_without_widening(node: Expression) -> Expression:
    if isinstance(node, Call) and isinstance(node.callee, Name) and _WIDENS.fullmatch(f"{node.callee.identifier}("):
        value = node.arguments[0].value if len(node.arguments) == 1 else None
        return value if value is not None else node
    return node


_WIDENS = re.compile(r"U?S?INT_TO_U?[DL]INT\(")


def _only_of_codesys(text_site: TextSite, dialect: Dialect, resolver: Resolver) -> Iterator[TranslatedText]:
    """Note what stays in a text for IEC 61131-3 though only tools of CODESYS compile it."""
    if not _MAY_DIFFER.search(text_site.text):
        return
    parsed = text_site.parsed(dialect)

    def type_of(value: Expression) -> str:
        type_ = resolver.type_of(value, text_site.site)
        return type_.name.value if isinstance(type_, ElementaryType) else ""

    types = ExpressionTypes(Dialect.IEC, type_of)
    reasons: dict[str, tuple[int, int]] = {}
    for node in walk(parsed.tree):
        if why := _reason_of_codesys(node, types):
            reasons.setdefault(why, node.span or (0, 0))
    places = {why: Lines(text_site.text).place(span[0]) for why, span in reasons.items()}
    notes = tuple(Note(Severity.WARNING, why, span, *places[why]) for why, span in reasons.items())
    if notes:
        yield TranslatedText(text_site.report_path, changed=False, notes=notes)


_CALCULATES = re.compile(r"[-+*/]|\bMOD\b|TIME\b", re.IGNORECASE)
_MAY_DIFFER = re.compile(r"\.\d|[-+*/]|\bMOD\b", re.IGNORECASE)


def _reason_of_codesys(node: Node, types: ExpressionTypes) -> str:
    """Return why IEC 61131-3 does not have an expression of CODESYS; empty if it has."""
    if isinstance(node, Member) and node.name.identifier.isdecimal():
        return f"IEC 61131-3 has no bits of variables as .{node.name.identifier}: only tools of CODESYS compile it"
    if not isinstance(node, Operation) or node.operator not in CALCULATING:
        return ""
    kinds = (types.value(operand).type for operand in node.operands)
    bits = next((kind for kind in kinds if kind in BIT_STRINGS), "")
    return f"IEC 61131-3 has no {node.operator.value} of {bits}: only tools of CODESYS compile it" if bits else ""


def _names_of_results(project: Project, source: Dialect, target: Dialect) -> Renames:
    """Return the new names of functions that cannot keep theirs: their results have the same."""
    renames = Renames()
    if source is not Dialect.SCL:
        return renames
    functions = [p.name for p in project.pous if p.interface is not None and p.interface.return_type is not None]
    new = {name: renames.legal_name(NameScope.GLOBAL, name, (), target) for name in functions}
    results = [Rename(NameScope.LOCAL, name, other) for name, other in new.items() if name != other]
    return Renames([*renames, *results])


def _names_a_step(text_site: TextSite) -> bool:
    """True if a text is the bare name of a step: the target of ON and OFF (S7-GRAPH)."""
    holder = text_site.holder
    is_target = isinstance(holder, ActionAssociation) and text_site.key == "target"
    return is_target and holder.qualifier in SWITCHES


def _other_names(project: Project, target: Dialect) -> dict[str, tuple[str, ...]]:
    """Global names that are others in the target: those of variables of lists, and of programs that texts call."""
    if (project.dialect is Dialect.SCL) is (target is Dialect.SCL):
        return {}
    programs = names_of_programs(project)
    if target is Dialect.SCL:
        return names_in_s7(project) | {program.casefold(): (block,) for program, block in programs.items()}
    return names_from_s7(project) | {block.casefold(): (program,) for program, block in programs.items()}


def _global_names(project: Project) -> set[str]:
    """Global declarations of the project."""
    sections = [*project.global_sections()]
    names = {variable.name for section in sections for variable in section.variables}
    names |= {section.name for section in sections if section.name}
    return names | {thing.name for thing in project.objects()}


@dataclass(frozen=True, slots=True)
class _Globals:
    """The types of a project as S7 has them, its global names, the inputs of functions, and names of lists.

    `tags` are variables of POUs that are tags in S7. `resolver` tells the types of variables; None: arithmetic stays as
    it is. `calls_actions`: calls of actions and methods are no loss. `addresses`: the dialects of direct addresses,
    before and after.
    """

    types: S7Types
    names: frozenset[str]
    functions: Mapping[str, Sequence[str]]
    listed: dict[str, tuple[str, ...]]
    resolver: Resolver | None
    tags: dict[str, dict[str, Tag]] = field(default_factory=dict)
    calls_actions: bool = False
    addresses: tuple[Dialect, Dialect] | None = None


def _names_of_own_tags(pou: Pou | None, target: Dialect, known: _Globals) -> dict[str, tuple[str, ...]]:
    """Names of the variables of a POU that are tags in S7, as texts of the POU have them: there, or elsewhere."""
    tags = known.tags.get(pou.name.casefold(), {}) if pou is not None else {}
    if target is Dialect.SCL:
        return {name: (tag.name,) for name, tag in tags.items()}
    names = {variable.name.casefold(): variable.name for variable in pou.variables()} if pou is not None else {}
    return {tag.name.casefold(): (names[name],) for name, tag in tags.items()}


class _Contexts:
    """The contexts of the texts of a project. All texts of a chart, or of a POU around it, have one."""

    def __init__(self, project: Project, target: Dialect, renames: Renames, known: _Globals) -> None:
        self.source, self._target, self._renames, self._known = project.dialect, target, renames, known
        self.enumerations = NameTable.of(each.name for each in project.data_types if isinstance(each.type, EnumType))
        self._hidden = NameTable.of(known.names)
        self._made: dict[tuple[int, ...], tuple[int, TranslationContext]] = {}

    def of(self, text_site: TextSite) -> TranslationContext:
        """Return the context of a text."""
        site, renames = text_site.site, len(self._renames)
        scope = tuple(map(id, (site.pou, site.method, *site.charts)))
        made = self._made.get(scope)
        if made is None or made[0] != renames:  # a new name may be that of a step
            made = self._made[scope] = renames, self._make(site)
        context, known = made[1], self._known
        if known.resolver is None:
            return context
        return _with_types(context, site, known.resolver, text_site, calls_actions=known.calls_actions)

    def _make(self, site: Site) -> TranslationContext:
        known, source, target = self._known, self.source, self._target
        own = _names_of_own_tags(site.pou, target, known)
        names = [name for name in _locals(site) if target is not Dialect.SCL or name.casefold() not in own]
        steps = _steps(site, source, target, self._renames, names)
        declared = NameTable.of(names)
        hiding = None
        if source is Dialect.SCL and target is not Dialect.SCL:
            legal = (self._renames.legal_name(NameScope.LOCAL, name, declared, target) for name in declared.values())
            hiding = NameTable.of(legal)
        return TranslationContext(
            locals=declared,
            hiding=hiding,
            types=NameTable.of(_types(site)),
            enumerations=self.enumerations,
            renames=self._renames,
            steps=steps,
            s7_types=known.types,
            hidden=self._hidden,
            actions=NameTable.of(_parts_of(site.pou)),
            functions=known.functions,
            listed=known.listed | own,
            addresses=known.addresses or (source, source),
        )


def _translated(text_site: TextSite, target: Dialect, contexts: _Contexts) -> Translated:
    source, context = contexts.source, contexts.of(text_site)
    if text_site.site.transition is not None and (body := text_site.text.rstrip()).endswith(";"):
        expression = parse_condition(body[:-1], source)  # ``Ready;`` would be a call among statements
        if not expression.problems:
            found = translate(expression, target, context)
            return replace(found, text=f"{found.text};")
    return translate(text_site.parsed(source), target, context)


def _with_types(
    context: TranslationContext,
    site: Site,
    resolver: Resolver,
    text_site: TextSite | None = None,
    *,
    calls_actions: bool = False,
) -> TranslationContext:
    """`context` with the types of expressions at a site."""

    def type_of(node: Expression) -> str:
        return _elementary(resolver.type_of(node, site))

    def parameter_type(call: Call, position: int) -> str:
        return _elementary(resolver.parameter_type(call, position, site))

    def is_instance(callee: Expression) -> bool:
        found = resolver.called(callee, site)
        if found is None:
            return False
        if found.kind in (Kind.ACTION, Kind.METHOD):
            return calls_actions
        return isinstance(resolver.type_of(callee, site), Pou)

    wanted = ""
    holder = text_site.holder if text_site is not None and text_site.key == "value" else None
    if isinstance(holder, ActionAssociation) and holder.target is not None:
        wanted = type_of(parse_expression(holder.target, resolver.dialect).tree)
    functions = context.functions or resolver.functions
    return replace(
        context,
        functions=functions,
        type_of=type_of,
        parameter_type=parameter_type,
        wanted=wanted,
        is_instance=is_instance,
    )


def _boxes_of_other_types(
    project: Project, source: Dialect, target: Dialect, known: _Globals
) -> Iterator[TranslatedText]:
    """Say which boxes give something else in the target, as they stay: it calculates in other types."""
    assert known.resolver is not None  # noqa: S101
    for path, pou, tree in _drawn(project, source):
        notes = Notes("")
        context = _with_types(TranslationContext(), Site(pou=pou), known.resolver)
        fitted = ArithmeticTranslator(family(source), family(target), context, notes).fitted(tree)
        changed = [new for old, new in zip(tree.statements, fitted.statements, strict=True) if old is not new]
        for statement in changed:
            reason = f"its boxes calculate in other types in {TITLES[family(target)]}"
            same = " ".join(print_node(statement).split())
            notes.add(Severity.WARNING, f"{reason}, where `{same}` would give the same", (0, 0))
        if notes.in_order():
            yield TranslatedText(path, changed=False, notes=notes.in_order())


def _drawn(project: Project, dialect: Dialect) -> Iterator[tuple[str, Pou, Statements]]:
    """Yield the networks of a project as statements, with their paths in reports and their POUs."""
    for name, pou, body in project.bodies():
        if isinstance(body, FbdBody | LdBody):
            yield pou.report_path_of(name), pou, body_statements(body, dialect).tree
    for chart in project.charts():
        read = condition_reader(chart.chart, dialect, transitions=chart.pou.transitions)
        for label, condition in placed_conditions(chart.chart):
            found = read(condition) if isinstance(condition, BodyCondition | WiredCondition) else None
            if found is not None and found.tree is not None:
                last = Assignment(Name("condition"), found.tree)
                yield f"{chart.report_path} / {label}", chart.pou, Statements((*found.before, last))


def _listed(project: Project, dialect: Dialect) -> Iterator[tuple[str, Pou, Statements]]:
    """Yield the instruction lists that can be told in statements, as `_drawn`."""
    for name, pou, body in project.bodies():
        tree = instruction_statements(body.text, dialect) if isinstance(body, IlBody) else None
        if tree is not None:
            yield pou.report_path_of(name), pou, tree


def _elementary(type_: Type) -> str:
    """Return the name of an elementary type, or of that which another is made of; empty for others."""
    match type_:
        case ElementaryType(name=name):
            return name.value
        case SubrangeType(base=base):
            return _elementary(base)
        case EnumType(base=base):
            return "INT" if base is None else _elementary(base)
        case StringType(wide=wide):
            return "WSTRING" if wide else "STRING"
        case Pou(interface=Interface(return_type=result)) if result is not None:
            return _elementary(result)
    return ""


def _parts_of(pou: Pou | None) -> list[str]:
    """Return the names of the actions and methods of a POU."""
    if pou is None:
        return []
    return [*(action.name for action in pou.actions), *(method.name for method in pou.methods)]


def _interfaces(site: Site) -> Iterator[Interface]:
    if site.pou is not None and site.pou.interface is not None:
        yield site.pou.interface
    if site.method is not None and site.method.interface is not None:
        yield site.method.interface


def _locals(site: Site) -> list[str]:
    """All that the POU around has itself: its variables and its result, steps, actions and methods, and SFC flags.

    External variables are global: S7 has no declaration that brings them in.
    """
    if site.pou is None:
        return []
    sections = [section for interface in _interfaces(site) for section in interface.sections]
    names = [v.name for section in sections if section.kind is not SectionKind.EXTERNAL for v in section.variables]
    if site.pou.interface is not None and site.pou.interface.return_type is not None:
        names.append(site.pou.name)
    if site.method is not None and site.method.interface is not None and site.method.interface.return_type is not None:
        names.append(site.method.name)
    names += [step.name for chart in _charts(site) for step in chart.steps]
    return [*names, *_parts_of(site.pou), *sorted(site.pou.implicit_flags())]


def _charts(site: Site) -> Iterator[SfcNetwork]:
    """The charts whose steps a text can name: those around it, and those of its POU and of the actions of that."""
    yield from site.charts
    if site.pou is not None and not site.charts:
        for body in (*site.pou.bodies, *(action.body for action in site.pou.actions)):
            if isinstance(body, SfcBody):
                yield body.chart


def _types(site: Site) -> dict[str, str]:
    types: dict[str, str] = {}
    for interface in _interfaces(site):
        for variable in interface.variables():
            match variable.type:
                case ElementaryType(name=name):
                    types[variable.name] = name.value
                case DerivedType(name=name):
                    types[variable.name] = name
                case StringType(wide=wide):
                    types[variable.name] = "WSTRING" if wide else "STRING"
                case _:
                    pass
    return types


def _steps(
    site: Site, source: Dialect, target: Dialect, renames: Renames, declared: list[str]
) -> StepReferences | None:
    steps = [step for chart in _charts(site) for step in chart.steps]
    names = {step.name: step.name for step in steps}
    if source is Dialect.SCL and target is not Dialect.SCL:
        taken = {name.casefold() for name in declared}
        names = {name: renames.legal_name(NameScope.LOCAL, name, taken, target) for name in names}
    elif target is Dialect.SCL:
        names = {name: renames.old_name(NameScope.LOCAL, name) or name for name in names}
    if not names:
        return None
    disturbed = {s.name.casefold() for s in steps if not all(map(is_empty_network, s.conditions.values()))}
    return StepReferences(NameTable.of(names), _NOTATIONS[source], _NOTATIONS[target], disturbed=disturbed)
