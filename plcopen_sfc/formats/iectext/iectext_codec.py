"""Textual IEC 61131-3: read and write whole files, and find the place of each object in its text.

One flavour is the text that matiec compiles, of a project that `formats.matiec` has fitted.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TypeAlias

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import EncodingError, Location
from plcopen_sfc.formats.declaration_blocks import section_places, type_places
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.iectext.pou_text_writer import POU_KEYWORDS
from plcopen_sfc.formats.iectext.project_text import dialect_of, read_project, write_project
from plcopen_sfc.formats.iectext.text_outline import POUS, PartKind, TextPart, outline
from plcopen_sfc.formats.iectext.text_source import INDENT, OWN_PRAGMA, TextSource, indented, is_own
from plcopen_sfc.formats.matiec.matiec_project import fit_project, pous_in_order
from plcopen_sfc.formats.matiec.matiec_statements import compilable_comments, plain_comment
from plcopen_sfc.formats.text_codec import TextCodec
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.formats.text_patch import BlockSpan, Key, WrittenBlock, numbered
from plcopen_sfc.languages.declarations import (
    read_declarations,
    write_data_type,
    write_section,
    write_type,
    write_value,
)
from plcopen_sfc.languages.pragmas import NotationError, parse_change
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st.declaration_nodes import Section, TypeDeclaration, TypeSection, VariableDeclaration
from plcopen_sfc.languages.st.lexer import Comment
from plcopen_sfc.languages.st.parsing import parse_declarations
from plcopen_sfc.languages.text_edits import without
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Task
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, SfcNetwork, Step, Transition
from plcopen_sfc.model.text import plain
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport


def compiled_text(project: Project) -> str:
    """Return the whole text."""
    units = [write_data_type(declaration, Dialect.IEC) for declaration in project.data_types]
    units += [_pou(pou) for pou in pous_in_order(project)]
    units += [_configuration(configuration) for configuration in project.configurations]
    return compilable_comments("\n\n".join(units) + "\n", Dialect.IEC)


def _comment(thing: Element, indent: str) -> str:
    text = plain(thing.comment).strip()
    return indented(f"(* {plain_comment(text)} *)", indent) + "\n" if text else ""


def _pou(pou: Pou) -> str:
    keyword = POU_KEYWORDS[pou.kind]
    head = f"{keyword} {pou.name}"
    interface = pou.interface
    if interface is not None and interface.return_type is not None:
        head += f" : {write_type(interface.return_type)}"
    parts = [_section(section) for section in interface.sections] if interface is not None else []
    body = pou.body
    if isinstance(body, SfcBody):
        parts += _chart(body.chart, pou)
    elif body is not None:
        parts.append(indented(_text(body), INDENT))
    return "\n".join([_comment(pou, "") + head, "\n\n".join(parts), f"END_{keyword}"])


def _text(body: Body) -> str:
    return body.text.strip("\n") if isinstance(body, StBody | IlBody) else ""


def _section(section: VariableSection, indent: str = INDENT) -> str:
    """Return a section of variables; external ones have their values where they are declared."""
    if section.kind is SectionKind.EXTERNAL:
        section = section.model_copy(deep=True)
        for variable in section.variables:
            variable.initial = variable.address = None
    return write_section(section, Dialect.IEC, indent)


# -- charts -----------------------------------------------------------------------------------------------------------


def _chart(chart: SfcNetwork, pou: Pou) -> Iterator[str]:
    """Steps first, then the transitions that name them, then the actions."""
    names = {step.id: step.name for step in chart.steps}
    yield from (_step(step) for step in chart.steps)
    yield from (_transition(transition, names) for transition in chart.transitions if transition.sources)
    for action in pou.actions:
        if action.body is not None:
            lines = indented(_text(action.body), INDENT * 2)
            yield f"{_comment(action, INDENT)}{INDENT}ACTION {action.name}:\n{lines}\n{INDENT}END_ACTION"


def _step(step: Step) -> str:
    keyword = "INITIAL_STEP" if step.initial else "STEP"
    lines = [f"{_comment(step, INDENT)}{INDENT}{keyword} {step.name}:"]
    lines += [f"{_comment(one, INDENT * 2)}{INDENT * 2}{_association(one)};" for one in step.actions]
    return "\n".join([*lines, f"{INDENT}END_STEP"])


def _association(found: ActionAssociation) -> str:
    arguments = [] if found.qualifier is Qualifier.NONE else [found.qualifier.value]
    arguments += [text for text in (found.duration, found.indicator) if text]
    return f"{found.target}({', '.join(arguments)})"


def _transition(transition: Transition, names: dict[int, str]) -> str:
    head = f"TRANSITION {transition.name}".rstrip()
    if transition.priority is not None and transition.priority >= 0:
        head += f" (PRIORITY := {transition.priority})"
    head += f" FROM {_steps(transition.sources, names)} TO {_steps(transition.targets, names)}"
    text = transition.condition.text if isinstance(transition.condition, Expression) else ""
    condition = indented(f":= {text};", INDENT * 2)
    return f"{_comment(transition, INDENT)}{INDENT}{head}\n{condition}\n{INDENT}END_TRANSITION"


def _steps(ids: list[int], names: dict[int, str]) -> str:
    found = [names[i] for i in ids if i in names]
    return found[0] if len(found) == 1 else f"({', '.join(found)})"


# -- configurations ---------------------------------------------------------------------------------------------------


def _configuration(configuration: Configuration) -> str:
    lines = [f"{_comment(configuration, '')}CONFIGURATION {configuration.name}"]
    lines += [_section(section) for section in configuration.global_variables]
    lines += [_resource(resource) for resource in configuration.resources]
    if configuration.config_variables is not None:
        lines.append(f"{INDENT}VAR_CONFIG")
        for variable in configuration.config_variables.variables:
            address = f" AT {variable.address}" if variable.address else ""
            value = f" := {write_value(variable.initial)}" if variable.initial is not None else ""
            lines.append(f"{INDENT * 2}{variable.path}{address} : {write_type(variable.type)}{value};")
        lines.append(f"{INDENT}END_VAR")
    return "\n".join([*lines, "END_CONFIGURATION"])


def _resource(resource: Resource) -> str:
    lines = [f"{INDENT}RESOURCE {resource.name} ON PLC"]
    lines += [_section(section, INDENT * 2) for section in resource.global_variables]
    lines += [_task(task) for task in resource.tasks]
    lines += [_instance(instance, f" WITH {task.name}") for task in resource.tasks for instance in task.instances]
    lines += [_instance(instance, "") for instance in resource.instances]
    return "\n".join([*lines, f"{INDENT}END_RESOURCE"])


def _task(task: Task) -> str:
    arguments = [f"SINGLE := {task.single}"] if task.single else []
    arguments += [f"INTERVAL := {task.interval}"] if task.interval else []
    return f"{INDENT * 2}TASK {task.name}({', '.join([*arguments, f'PRIORITY := {max(task.priority, 0)}'])});"


def _instance(instance: PouInstance, task: str) -> str:
    return f"{INDENT * 2}PROGRAM {instance.name}{task} : {instance.type_name};"


_ABOUT_THE_FILE = re.compile(r"\{\s*plcopen_sfc\s+(?:format\b|project\.dialect\b)")
"""Pragmas with facts that the tool of the file knows: they stay."""


def source_lines(text: str) -> dict[str, int]:
    """Return the line of each object in a text, by the path that a `ConversionReport` gives it."""
    project, src = read_project(text, None)
    finder = _Finder(src)
    units = (part for part in src.outline.parts if part.kind in POUS)
    for part, pou in zip(units, project.pous, strict=False):
        finder.note(part, f"POU {pou.name}", pou.bodies, pou)
    for part in src.outline.parts:
        if part.kind in (PartKind.TYPE, PartKind.VAR):
            finder.note_declared(part, "")
    return finder.found


class _Finder:
    def __init__(self, src: TextSource) -> None:
        self.found: dict[str, int] = {}
        self._src = src
        self._lines = Lines(src.text)

    def note(self, part: TextPart, path: str, bodies: list[Body], pou: Pou | None = None) -> None:
        """Note the line of a POU or an action, and those of the steps, transitions and actions in it."""
        self._put(path, part)
        chart = next((body.chart for body in bodies if isinstance(body, SfcBody)), None)
        steps = iter(chart.steps if chart is not None else ())
        labels = iter(chart.labels().values() if chart is not None else ())
        for inner in part.parts:
            if inner.kind is PartKind.STEP and (step := next(steps, None)) is not None:
                self._put(f"{path} / step {step.name}", inner)
            elif inner.kind is PartKind.TRANSITION and chart is not None and self._src.outline.leads(inner):
                label = next(labels, None)
                if label is not None:
                    self._put(f"{path} / transition {label}", inner)
            elif (
                inner.kind is PartKind.ACTION
                and pou is not None
                and (action := pou.find_action(inner.name)) is not None
            ):
                own = [action.body] if action.body is not None else []
                self.note(inner, f"{path} / action {action.name}", own)
            elif inner.kind is PartKind.VAR:
                self.note_declared(inner, path)

    def note_declared(self, part: TextPart, path: str) -> None:
        """Note the lines of the variables or the types in a part that declares some."""
        text = self._src.text[part.start : part.end]
        for section in parse_declarations(text, self._src.outline.dialect).tree.items:
            match section:
                case Section(variables=declared):
                    names = [name for each in declared if isinstance(each, VariableDeclaration) for name in each.names]
                    kind = ""
                case TypeSection(types=types):
                    names = [each.name for each in types if isinstance(each, TypeDeclaration)]
                    kind = "type "
                case _:
                    continue
            for name in names:
                line = self._lines.place(part.start + name.span[0])[0] if name.span is not None else None
                if line is not None:
                    self.found.setdefault(ObjectPath(path, f"{kind}{name.identifier}"), line)

    def _put(self, path: str, part: TextPart) -> None:
        self.found.setdefault(path, self._lines.place(part.start)[0])


Found: TypeAlias = tuple[tuple[Key, ...], tuple[int, int], "TextPart | None"]
"""Keys of a block, its place, and the part that it is, if its inside is looked into."""


def file_slices(project: Project, src: TextSource, before: WrittenBlock) -> BlockSpan:
    """Return the places of the blocks of `before`, which is `project` as text, in the text that it was read from."""
    found = list(_units(src))
    pous = iter(project.pous)
    inside = {id(part): next(pous) for _, _, part in found if part is not None}
    return _matched(src, ("project", ""), (0, len(src.text)), found, before, inside=inside)


def _units(src: TextSource) -> Iterator[Found]:
    position = _project_pragmas(src)
    yield (("head", ""),), (0, position), None
    for part in src.outline.parts:
        start = _above(src, position, part.start)
        span = (start, part.end)
        position = part.end
        if part.kind in POUS:
            yield ((part.kind.lower(), part.name),), span, part
        elif part.kind is PartKind.TYPE:
            tokens = src.outline.tokens(part.tokens)
            yield (("type", tokens[0].value if tokens else ""),), span, None
        elif part.kind is PartKind.VAR:
            yield (("global variables", ""),), span, None
        elif part.kind is PartKind.CONFIGURATION:
            yield (("configuration", part.name),), span, None
    start, end = _own_run(src, position, len(src.text))
    yield (("late", ""),), (start, end), None


def _project_pragmas(src: TextSource) -> int:
    """Return the end of the pragmas about the project at the start of the file."""
    end = 0
    limit = src.outline.parts[0].start if src.outline.parts else len(src.text)
    for comment in src.outline.comments(0, limit):
        if not is_own(comment) or _first_word(comment) not in ("project", "format"):
            break
        end = comment.span[1]
    return end


def _first_word(comment: Comment) -> str:
    try:
        change = parse_change(comment.text[:-1], comment.text.index("plcopen_sfc") + len("plcopen_sfc"))
    except NotationError:
        return ""
    return str(change.path[0])


def _above(src: TextSource, position: int, start: int) -> int:
    """Return the begin of the comments and pragmas that belong to the part at `start`."""
    first = next((c.span[0] for c in src.outline.comments(position, start)), start)
    return first if not src.text[position:first].strip() else src.attached(position, start)


def _own_run(src: TextSource, start: int, end: int) -> tuple[int, int]:
    """Return the pragmas of this package at the end of a place, without the blanks around them."""
    begin = src.core(start, end)[1]
    own = [c.span for c in src.outline.comments(begin, end) if is_own(c)]
    return (own[0][0], own[-1][1]) if own else (begin, begin)


# -- inside units -----------------------------------------------------------------------------------------------------


def _parts(
    src: TextSource, part: TextPart, start: int, thing: Pou | Action | Method | NamedTransition
) -> Iterator[Found]:
    """Yield the parts of a POU, an action or a method."""
    bodies = thing.bodies if isinstance(thing, Pou) else [thing.body]
    chart = next((body.chart for body in bodies if isinstance(body, SfcBody)), None)
    steps = iter(chart.steps if chart is not None else ())
    transitions = iter(chart.transitions if chart is not None else ())
    typed = getattr(getattr(thing, "interface", None), "declaration", None) is not None
    position = part.inside[0]
    sections = [inner for inner in part.parts if inner.kind is PartKind.VAR]
    if typed and sections:
        position = sections[-1].end
    yield (("head", ""),), (start, position), None
    last: list[Found] = []
    for number, inner in enumerate(part.parts):
        if inner.end <= position:
            continue
        if inner.kind is PartKind.LOOSE:
            above, end = _loose(src, part, number, position)
        else:
            above, end = _above(src, position, inner.start), inner.end
        position = end
        kind = inner.kind
        # an action in place is written behind its step or transition and belongs to it, so these wait for it in `last`
        if kind is PartKind.ACTION and last and _is_in_place(src, above, inner):
            keys, span, _ = last.pop()
            last.append((keys, (span[0], inner.end), None))
            continue
        yield from last
        last = []
        key: Key | None = None
        if kind is PartKind.STEP:
            step = next(steps, None)
            key = ("step", str(step.id)) if step is not None else None
        elif kind is PartKind.TRANSITION and src.outline.leads(inner):
            transition = next(transitions, None)
            key = ("transition", str(transition.id)) if transition is not None else None
        elif kind is PartKind.TRANSITION:
            name = next((t.value for t in src.outline.tokens(inner.tokens)), "")
            key = ("transition", name)
        elif kind is PartKind.VAR:
            key = ("section", "")
        elif kind is PartKind.LOOSE:
            key = ("body", "")
        elif kind is PartKind.PROPERTY:
            key = ("property", "")
        elif kind in (PartKind.ACTION, PartKind.METHOD):
            key = (kind.lower(), inner.name)
        if key is not None:
            container = inner if kind in (PartKind.ACTION, PartKind.METHOD) else None
            last = [((key,), (above, end), container)]
            if kind is not PartKind.STEP and key[0] != "transition":
                yield from last
                last = []
    yield from last
    late = _own_run(src, position, part.inside[1])
    yield (("late", ""),), late, None
    yield (("end", ""),), (part.inside[1], part.end), None


def _loose(src: TextSource, around: TextPart, number: int, position: int) -> tuple[int, int]:
    """Return the place of the statements of a POU with the comments before and behind them, which are in its body."""
    following = around.parts[number + 1].start if number + 1 < len(around.parts) else None
    end = src.core(position, around.inside[1])[1] if following is None else src.attached(position, following)
    start = src.core(position, end)[0]
    text = src.text[start:end]
    return start + len(text) - len(text.lstrip()), start + len(text.rstrip())


def _is_in_place(src: TextSource, start: int, part: TextPart) -> bool:
    return any(is_own(c) and _first_word(c) == "in_place" for c in src.outline.comments(start, part.start))


def _matched(
    src: TextSource,
    key: Key,
    span: tuple[int, int],
    found: list[Found],
    before: WrittenBlock,
    *,
    inside: dict[int, Pou],
) -> BlockSpan:
    """Slice for each part of `before`: where it was found, or an empty one behind that of the part before it."""
    keys = numbered([keys[0] for keys, _, _ in found if keys])
    places = dict(zip(keys, [(place, part) for keys_, place, part in found if keys_], strict=True))
    slices: list[BlockSpan] = []
    position = span[0]
    for piece in before.blocks:
        if piece.key not in places:
            slices.append(BlockSpan((piece.key,), (position, position)))
            continue
        place, part = places[piece.key]
        position = place[1]
        thing = inside.get(id(part)) if part is not None else None
        if part is not None and thing is not None:
            slices.append(_container(src, piece, place, part, thing))
        else:
            slices.append(BlockSpan((piece.key,), place, _variables_at(src, place) if piece.blocks else ()))
    return BlockSpan((key,), span, tuple(sorted(slices, key=lambda one: one.span)))


def _variables_at(src: TextSource, place: tuple[int, int]) -> tuple[BlockSpan, ...]:
    """Return the places of the head, the variables and the end of a section, or of a type that is a structure.

    Nothing where several are there.
    """
    declared = read_declarations(src.text[slice(*place)], src.outline.dialect)
    if declared.types:
        return type_places(src.text, declared, place[0])
    found = list(section_places(src.text, declared, place[0], src.outline.dialect))
    return found[0][2] if len(found) == 1 else ()


def _container(
    src: TextSource,
    piece: WrittenBlock,
    place: tuple[int, int],
    part: TextPart,
    thing: Pou | Action | Method | NamedTransition,
) -> BlockSpan:
    found = list(_parts(src, part, place[0], thing))
    actions = iter(getattr(thing, "actions", ()))
    methods = iter(getattr(thing, "methods", ()))
    slices = _matched(src, piece.key, place, found, piece, inside={})
    inner: list[BlockSpan] = []
    parts = {keys[0]: one for keys, _, one in found if keys and one is not None}
    by_key = {p.key: p for p in piece.blocks}
    for one in slices.spans:
        child = parts.get(one.keys[0])
        if child is None:
            inner.append(one)
            continue
        owner = next(actions if child.kind is PartKind.ACTION else methods, None)
        inner.append(one if owner is None else _container(src, by_key[one.keys[0]], one.span, child, owner))
    return BlockSpan(slices.keys, slices.span, tuple(inner))


_MOST_NULS = 8


class IecTextCodec(TextCodec):
    """Textual IEC 61131-3."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a text. Raises `FormatError`; faults inside of it are in the diagnostics."""
        source = self.decode(data)
        if source.text.count("\0") > len(source.text) // _MOST_NULS:
            hint = "UTF-16 needs a byte order mark."
            raise EncodingError("this is no text: it is full of NUL bytes", location=Location(file, 1, 1), hint=hint)
        project, src = read_project(source.text, file)
        if source.guessed:
            message = f"not UTF-8; taken as {source.encoding}, which is a guess"
            src.diagnostics.append(Diagnostic("IEC200", Severity.WARNING, message, Location(file)))
        return ReadResult(project, src.diagnostics)

    def without_own_comments(self, text: str) -> str:
        """Return a text without pragmas of this package, but for those about the file."""
        if OWN_PRAGMA.search(text) is None:
            return text
        comments = outline(text, dialect_of(text)).found.comments
        return without(text, [c.span for c in comments if is_own(c) and _ABOUT_THE_FILE.match(c.text) is None])

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """Return the line of each object in the text `content`, by the path that the report gives it."""
        return source_lines(self.decode(content).text)

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project by its objects."""
        return write_project(project, options, report)

    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        """Return the project in a file, its text, and the places of its objects in that."""
        source = self.decode(content)
        project, src = read_project(source.text, None)
        written = self.to_blocks(project, WriteOptions(), ConversionReport())
        return project, source, file_slices(project, src, written)

    def fit(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Change `project`, a copy, into one that matiec executes."""
        fit_project(project, options, report)

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a whole text; for matiec, of a project that was fitted."""
        if options.flavour:
            return compiled_text(project).encode()
        return (write_project(project, options, report).whole() + "\n").encode()


CODEC = IecTextCodec()
