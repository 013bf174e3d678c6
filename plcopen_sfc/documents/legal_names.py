"""Names that the tool of a target cannot have: steps called as variables, letters that are none of its identifiers."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Set
from typing import TYPE_CHECKING

from plcopen_sfc.errors import ModelError
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.languages.s7_types import is_system_data
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.languages.words import CODESYS23_KEYWORDS, CODESYS_KEYWORDS, free_name, identifier
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

_WORD = re.compile(r"(?!.*__)[^\W\d]\w*")
_STEP = re.compile(r"[^\W\d]\w*")
if TYPE_CHECKING:
    from plcopen_sfc.languages.translation.renames import KeptNames

_LONGEST = 125
"""The longest name of a block in TIA Portal; tags and parameters can have 128 characters (TIA Portal help)."""
_CUT = 120
"""The length of a name that replaces a longer one: a number may follow."""
_UNSPELLED = (Kind.INSTANCE, Kind.NAMESPACE)


def give_legal_names(
    copy: Project, kind: Format, report: ConversionReport, *, with_letters: bool, of_s7: bool = False
) -> None:
    """Rename what a copy declares under names that the tool of a target cannot have, or give it its own names back.

    CODESYS and S7 have a variable for each step: none may be called as another variable. Names in TIA Portal have a
    longest length. CODESYS, CoDeSys 2.3 and TwinCAT take letters without accents, which `with_letters` asks for, and no
    underscores behind each other (CODESYS V3 online help, "Identifiers"); a step in an export has them. Each has
    keywords of its own. The project keeps the names of the source, and what it declares gets them in other tools again,
    names that are keywords of CODESYS alone in CoDeSys 2.3 and TIA Portal too. `of_s7`: the source is of S7. Called
    before texts are translated, which a new name needs, and behind that, which the old one does.
    """
    from plcopen_sfc.languages.translation.renames import KeptNames, keep_names, kept_names  # noqa: PLC0415

    own, target = family(copy.dialect), family(kind.dialect) if kind.dialect is not None else Dialect.IEC
    is_later = kind.charts is not None and kind.charts.has_methods
    if own is Dialect.IEC and target is Dialect.IEC:
        _give_back(copy, (KeptNames.DECLARED, KeptNames.LATER), kind.tool, report)
    elif own is Dialect.IEC:
        done = _rename_each(copy, _illegal(copy, kind, with_letters), kind.tool, report, of_s7=of_s7)
        keep_names(copy, KeptNames.DECLARED, _rows(copy, done))
    elif own is Dialect.CODESYS and target is not Dialect.IEC:
        if target is Dialect.SCL or not is_later:
            _give_back(copy, (KeptNames.LATER,), kind.tool, report)
        if target is Dialect.CODESYS and (is_later or of_s7):
            words = _keywords(kind)
            wanted = {
                each: new for each, new in _illegal(copy, kind, with_letters).items() if each.name.upper() in words
            }
            done = _rename_each(copy, wanted, kind.tool, report, of_s7=of_s7)
            keep_names(copy, KeptNames.LATER, [*kept_names(copy, KeptNames.LATER), *_rows(copy, done)])


def _give_back(copy: Project, kinds: Collection[KeptNames], tool: str, report: ConversionReport) -> None:
    """Give declarations the names of their source that a project has kept, and forget these."""
    from plcopen_sfc.languages.translation.renames import keep_names, kept_names  # noqa: PLC0415

    old = {(path.casefold(), new): old for each in kinds for path, old, new in kept_names(copy, each)}
    found = {each: old.get((each.path.casefold(), each.name)) for each in (_declarations(copy) if old else ())}
    wanted = {each: (name, "as in the file that it was converted from") for each, name in found.items() if name}
    _rename_each(copy, wanted, tool, report, back=True)
    for each in kinds:
        keep_names(copy, each, ())


def _rows(copy: Project, done: Collection[tuple[Declaration, str]]) -> list[tuple[str, str, str]]:
    """Return what was renamed as rows to keep: the path, the old and the new name."""
    from plcopen_sfc.languages.binding import Names  # noqa: PLC0415  # brings the parser

    paths = {id(each.holder): each.path for each in (Names(copy).declarations() if done else ())}
    return [(paths[id(each.holder)], name, each.name) for each, name in done]


def _rename_each(
    copy: Project,
    wanted: Mapping[Declaration, tuple[str, str]],
    tool: str,
    report: ConversionReport,
    *,
    back: bool = False,
    of_s7: bool = False,
) -> list[tuple[Declaration, str]]:
    """Rename declarations together, or else one by one; those that were, with their old names.

    `back`: to names of the source, which nothing needs. `of_s7`: the source is of S7.
    """
    from plcopen_sfc.refactor.rename import rename_many, restore_names  # noqa: PLC0415

    rename, refused = (restore_names, Outcome.TRANSLATED) if back else (rename_many, Outcome.NOT_EXECUTED)
    places = _places(copy)
    done: list[tuple[Declaration, str]] = []
    for part in ([*wanted], *([each] for each in wanted)):
        old = [(each.name, places.get(id(each.holder), each.path)) for each in part]
        try:
            results = rename(copy, {each: wanted[each][0] for each in part})
        except ModelError as error:  # one that cannot be renamed keeps no other from it
            if len(part) == 1:
                [(name, place)] = old
                why = f"it keeps its name: {error.message}"
                report.add(refused, "name", place, why if back else f"{tool} does not compile {name}; {why}")
            continue
        for each, result, (name, place) in zip(part, results, old, strict=True):
            done.append((each, name))
            report.add(Outcome.TRANSLATED, "name", place, f"{each.name} in {tool}: {wanted[each][1]}")
            for undecided in result.undecided:
                if of_s7 and undecided.use.language == "declaration":
                    continue  # a part that only SCL has, which is kept for the way back
                why = f"it is unknown whether `{name}` means what is called {each.name} in {tool}"
                report.add(Outcome.NOT_EXECUTED, "code", undecided.use.path, why)
        if len(part) == len(wanted):
            break
    return done


def with_legal_names(project: Project, kind: Format, flavour: str) -> tuple[Project, dict[str, str], ConversionReport]:
    """Return `project` with names that the tools of a format can have, for code that is made of its charts.

    Steps keep their names, which only comments of the code have. The project itself where all can stay; also the new
    names of POUs by the old ones in lower case, and what was renamed.
    """
    from plcopen_sfc.refactor.rename import rename_many  # noqa: PLC0415

    report = ConversionReport()
    target, own = family(kind.dialect or project.dialect), family(project.dialect)
    spelled = bool(flavour) or (target is not own and Dialect.SCL in (own, target) and target is not Dialect.SCL)
    spelled = spelled or (own is Dialect.IEC and target is Dialect.CODESYS)
    if not spelled:
        return project, {}, report
    tool = flavour.capitalize() or kind.tool

    def wishes(project: Project) -> dict[Declaration, tuple[str, str]]:
        found = _legal(project, _declarations(project), tool, _keywords(kind), is_codesys=True, with_letters=True)
        return {each: new for each, new in found.items() if each.kind is not Kind.STEP}

    if not wishes(project):
        return project, {}, report
    copy = project.model_copy(deep=True)
    wanted = wishes(copy)
    places, old = _places(copy), {each: each.name for each in wanted}
    rename_many(copy, {each: new for each, (new, _) in wanted.items()})
    for each, (new, why) in wanted.items():
        report.add(Outcome.TRANSLATED, "name", places.get(id(each.holder), old[each]), f"{new} in {tool}: {why}")
    pous = {old[each].casefold(): new for each, (new, _) in wanted.items() if each.kind is Kind.POU}
    return copy, pous, report


def illegal_names(project: Project, kind: Format) -> Iterator[tuple[str, str]]:
    """Yield the paths of names that the tool of a format cannot have, each with the reason."""
    places = _places(project)
    for each, (_, why) in _illegal(project, kind, with_letters=True).items():
        yield places.get(id(each.holder), each.path), f"{kind.tool} does not compile {each.name}: {why}"


def _illegal(project: Project, kind: Format, with_letters: bool) -> dict[Declaration, tuple[str, str]]:
    """Return the declarations whose names the tool of a format cannot have, with new ones, and why; see `_legal`."""
    is_codesys = kind.dialect is not None and family(kind.dialect) is Dialect.CODESYS
    words = _keywords(kind)
    return _legal(project, _declarations(project), kind.tool, words, is_codesys=is_codesys, with_letters=with_letters)


def _keywords(kind: Format) -> Set[str]:
    """Return the words that are no names in the tool of a format; those of SCL are names in quotes."""
    if kind.charts is None or not kind.charts.is_codesys:
        return frozenset()
    return CODESYS_KEYWORDS if kind.charts.has_methods else CODESYS23_KEYWORDS


def _declarations(project: Project) -> list[Declaration]:
    """Return what a project declares, once each: VAR_EXTERNAL and instance data blocks repeat others."""
    from plcopen_sfc.languages.binding import Names  # noqa: PLC0415  # brings the parser

    names = Names(project)
    return list(dict.fromkeys(map(names.resolver.original, names.declarations())))


def _legal(
    project: Project,
    declared: list[Declaration],
    tool: str,
    keywords: Set[str],
    *,
    is_codesys: bool,
    with_letters: bool,
) -> dict[Declaration, tuple[str, str]]:
    """Return the names that things get, and why. `with_letters`: CODESYS gets other letters for those with accents."""
    clashing: set[int] = set()
    for chart in project.charts():
        variables = {each.name.casefold() for each in chart.pou.variables() if not is_system_data(each)}
        clashing |= {id(step) for step in chart.chart.steps if step.name.casefold() in variables}
    words = {each.casefold() for each in keywords}
    taken: dict[int, set[str]] = {}
    for each in declared:
        taken.setdefault(id(each.pou), set()).add(each.name.casefold())
    shared = taken.setdefault(id(None), set())
    found: dict[Declaration, tuple[str, str]] = {}
    for each in declared:
        wish, why = each.name, "a variable of the POU has its name"
        if each.kind is Kind.STEP and id(each.holder) in clashing:
            wish = f"{wish}_step"
        if each.kind is Kind.STEP and wish.isdecimal() and not with_letters:
            continue  # of a GRAFCET, whose steps get other names when it is put into a chart of IEC 61131-3
        is_spelled = wish.isascii() or not with_letters
        word = _STEP if each.kind is Kind.STEP else _WORD
        if is_codesys and not (is_spelled and word.fullmatch(wish)) and each.kind not in _UNSPELLED:
            wish, why = identifier(wish), f"{tool} takes letters without accents, digits and single underscores"
        if not is_codesys and len(wish) > _LONGEST:
            wish, why = wish[:_CUT], f"{tool} takes names of {_LONGEST} characters"
        if wish.casefold() in words and each.kind not in _UNSPELLED:
            why = f"{wish} is a keyword there"
        elif wish == each.name:
            continue
        others = set().union(*taken.values()) if each.pou is None else taken[id(each.pou)] | shared
        new = free_name(wish, (others - {each.name.casefold()}) | words)
        taken[id(each.pou)].add(new.casefold())
        found[each] = new, why
    return found


def _places(project: Project) -> Mapping[int, str]:
    """Return the paths in reports of POUs, of steps and of what POUs declare beside these, by the `id()` of each."""
    found = {id(pou): pou.report_path for pou in project.pous}
    for pou in project.pous:
        found |= {id(variable): f"{pou.report_path} / {variable.name}" for variable in pou.variables()}
        found |= {id(action): f"{pou.report_path} / action {action.name}" for action in pou.actions}
    for chart in project.charts():
        found |= {id(step): f"{chart.report_path} / step {step.name}" for step in chart.chart.steps}
    return found
