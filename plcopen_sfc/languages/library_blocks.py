"""Function blocks in structured text, for tools that do not have them: of libraries of CODESYS, and flip-flops in SCL.

BLINK is of the library Util, which projects use for lamps. It does what the simulation does for it
(`semantics.programs.block_execution`); a test runs both.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from plcopen_sfc.languages.binding.text_sites import text_sites
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.standard_blocks import Tool, standard_block
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, Variable, used_types
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

_HAVE_UTIL = frozenset({"codesys", "codesys-export", "codesys23"})
"""Formats whose tool has the library Util."""
_BLINK = """(* BLINK of the library Util of CODESYS: OUT is TRUE for TIMEHIGH, FALSE for TIMELOW, and so on *)
IF NOT #ENABLE THEN
    #Running := FALSE;
ELSE
    IF #OUT THEN
        #Phase := #TIMEHIGH;
    ELSE
        #Phase := #TIMELOW;
    END_IF;
    #Elapsed(IN := #Running, PT := #Phase);
    IF NOT #Running OR #Elapsed.Q THEN
        #OUT := NOT #Running OR NOT #OUT;
        #Running := TRUE;
        (* the next phase begins now *)
        IF #OUT THEN
            #Phase := #TIMEHIGH;
        ELSE
            #Phase := #TIMELOW;
        END_IF;
        #Elapsed(IN := FALSE, PT := #Phase);
        #Elapsed(IN := TRUE, PT := #Phase);
    END_IF;
END_IF;"""


def library_blocks(project: Project) -> list[Pou]:
    """Return the blocks of libraries that a project of CODESYS uses, in its dialect."""
    if project.tool_format not in _HAVE_UTIL or any(pou.name.casefold() == "blink" for pou in project.pous):
        return []
    variables = [variable for pou in project.pous for variable in pou.variables()]
    variables += [variable for section in project.global_sections() for variable in section.variables]
    variables += [Variable(name=each.name, type=each.type) for each in project.data_types]
    is_used = any(name.casefold() == "blink" for variable in variables for name in used_types(variable.type))
    return [_blink(project.dialect)] if is_used else []


def _blink(dialect: Dialect) -> Pou:
    """Return BLINK as a function block."""
    boolean, time = ElementaryType(name=Elementary.BOOL), ElementaryType(name=Elementary.TIME)
    timer = DerivedType(name="TON_TIME" if dialect is Dialect.SCL else "TON")
    sections: dict[SectionKind, list[tuple[str, DataType]]] = {
        SectionKind.INPUT: [("ENABLE", boolean), ("TIMELOW", time), ("TIMEHIGH", time)],
        SectionKind.OUTPUT: [("OUT", boolean)],
        SectionKind.LOCAL: [("Running", boolean), ("Phase", time), ("Elapsed", timer)],
    }
    interface = Interface(
        sections=[
            VariableSection(kind=kind, variables=[Variable(name=name, type=type_) for name, type_ in declared])
            for kind, declared in sections.items()
        ]
    )
    text = _BLINK if dialect is Dialect.SCL else _BLINK.replace("#", "")
    return Pou(name="BLINK", kind=PouKind.FUNCTION_BLOCK, interface=interface, bodies=[StBody(text=text)])


FLIP_FLOPS = frozenset({"RS", "SR"})
_SET = {"SR": "{set} OR NOT {reset} AND Q1", "RS": "NOT {reset} AND ({set} OR Q1)"}


def put_flip_flops(project: Project) -> list[tuple[str, str]]:
    """Declare flip-flops that texts of `project` call as function blocks of their own: SCL has none.

    Boxes of LAD and FBD have them, with an operand: instances of which texts use nothing but the output stay. Returns
    the paths of the variables, with the names of their types.
    """
    own = {pou.name.upper() for pou in project.pous}
    found = [(pou, flip_flop_instances(pou, FLIP_FLOPS - own)) for pou in project.pous]
    if not any(instances for _, instances in found):
        return []
    called: dict[int, set[str]] = {id(pou): set() for pou, _ in found}
    instances_of = {id(pou): instances for pou, instances in found}
    boxes: dict[int, set[str]] = {id(pou): set() for pou, _ in found}
    for text_site in text_sites(project):
        pou = text_site.site.pou
        if pou is None or not text_site.is_program_text:
            continue
        tree = text_site.parsed(project.dialect).tree
        is_box = isinstance(text_site.holder, Block) and text_site.key == "instance"
        (boxes if is_box else called)[id(pou)].update(more_than_outputs(tree, instances_of[id(pou)]))
    blocks: dict[str, Pou] = {}
    taken = {thing.name.casefold() for thing in project.objects()}
    changed: list[tuple[str, str]] = []
    for pou, instances in found:
        for name in sorted(called[id(pou)] - boxes[id(pou)]):
            kind = next(iter(used_types(instances[name].type))).upper()
            if kind not in blocks:
                blocks[kind] = _flip_flop(kind, take_name(f"IEC_{kind}", taken), project.dialect)
            instances[name].type = DerivedType(name=blocks[kind].name)
            changed.append((f"{pou.report_path} / {instances[name].name}", blocks[kind].name))
    project.pous = [*project.pous, *blocks.values()]
    return changed


def flip_flop_instances(pou: Pou, types: frozenset[str]) -> dict[str, Variable]:
    """Return the variables of a POU that are instances of `types`, by their names in lower case."""
    derived = ((v, v.type) for v in pou.variables() if isinstance(v.type, DerivedType))
    return {v.name.casefold(): v for v, type_ in derived if type_.name.upper() in types}


def more_than_outputs(tree: n.Node, instances: Mapping[str, Variable]) -> Iterator[str]:
    """Yield the names of flip-flops of which a text uses more than their output."""
    nodes = list(walk(tree))
    fine = {id(node.base) for node in nodes if is_output(node, instances) and isinstance(node, n.Member)}
    members = {id(node.name) for node in nodes if isinstance(node, n.Member | n.Argument)}
    for node in nodes:
        if isinstance(node, n.Name) and id(node) not in fine | members and node.identifier.casefold() in instances:
            yield node.identifier.casefold()


def is_output(node: n.Node, instances: Mapping[str, Variable]) -> bool:
    """True for the output ``Q1`` of one of these flip-flops."""
    if isinstance(node, n.Member) and isinstance(node.base, n.Name) and node.name.identifier.upper() in ("Q1", "Q"):
        return node.base.identifier.casefold() in instances
    return False


def _flip_flop(kind: str, name: str, dialect: Dialect) -> Pou:
    """Return a flip-flop as a function block, with the pins that texts of a dialect name."""
    block = standard_block(kind)
    assert block is not None  # noqa: S101  # IEC 61131-3 has both
    pins = ["S1", "R"] if kind == "SR" else ["S", "R1"]
    if family(dialect) is Dialect.CODESYS:
        pins = [block.tool_pin(pin, Tool.CODESYS) for pin in pins]
    boolean = ElementaryType(name=Elementary.BOOL)
    sections = [
        VariableSection(kind=SectionKind.INPUT, variables=[Variable(name=pin, type=boolean) for pin in pins]),
        VariableSection(kind=SectionKind.OUTPUT, variables=[Variable(name="Q1", type=boolean)]),
    ]
    text = f"Q1 := {_SET[kind].format(set=pins[0], reset=pins[1])};"
    return Pou(
        name=name,
        kind=PouKind.FUNCTION_BLOCK,
        interface=Interface(sections=sections),
        bodies=[StBody(text=text)],
    )
