"""Small projects for tests of names, written as text where that is shorter."""

from __future__ import annotations

from plcopen_sfc import model as m
from plcopen_sfc.languages.binding import Names


def variables(text: str) -> list[m.Variable]:
    """Variables from ``a: BOOL; fb: FB_Motor := 5``."""
    found = []
    for part in filter(None, (p.strip() for p in text.split(";"))):
        name, _, rest = part.partition(":")
        type_, _, initial = rest.partition(":=")
        found.append(
            m.Variable.model_validate({"name": name.strip(), "type": type_.strip(), "initial": initial.strip() or None})
        )
    return found


def interface(text: str = "", **sections: str) -> m.Interface:
    """An interface with the variables of `text` as locals; further sections by their kind."""
    kinds = {m.SectionKind.LOCAL: text} | {m.SectionKind(kind): more for kind, more in sections.items()}
    return m.Interface(
        sections=[m.VariableSection(kind=k, variables=variables(more)) for k, more in kinds.items() if more]
    )


def pou(
    name: str,
    text: str = "",
    declared: str = "",
    *,
    kind: m.PouKind = m.PouKind.PROGRAM,
    actions: dict[str, str] | None = None,
    **sections: str,
) -> m.Pou:
    """A POU with a body in ST and actions in ST."""
    return m.Pou(
        name=name,
        kind=kind,
        interface=interface(declared, **sections),
        bodies=[m.StBody(text=text)],
        actions=[m.Action(name=n, body=m.StBody(text=t)) for n, t in (actions or {}).items()],
    )


def block(
    name: str, text: str = "", declared: str = "", *, actions: dict[str, str] | None = None, **sections: str
) -> m.Pou:
    """A function block with a body in ST."""
    return pou(name, text, declared, kind=m.PouKind.FUNCTION_BLOCK, actions=actions, **sections)


def chart(steps: str, *conditions: str) -> m.SfcNetwork:
    """A chart that is a circle of steps; conditions without a text are TRUE."""
    made = m.SfcNetwork()
    own = [made.add_step(name, initial=not number) for number, name in enumerate(steps.split())]
    for number, step in enumerate(own):
        condition = conditions[number] if number < len(conditions) else "TRUE"
        made.add_transition(step, own[(number + 1) % len(own)], condition)
    return made


def sfc(name: str, steps: str, *conditions: str, declared: str = "", actions: dict[str, str] | None = None) -> m.Pou:
    """A program that is a chart."""
    made = pou(name, "", declared, actions=actions)
    made.bodies = [m.SfcBody(chart=chart(steps, *conditions))]
    return made


def struct(name: str, members: str) -> m.DataTypeDeclaration:
    return m.DataTypeDeclaration(name=name, type=m.StructType(members=variables(members)))


def enum(name: str, values: str) -> m.DataTypeDeclaration:
    return m.DataTypeDeclaration(name=name, type=m.EnumType(values=[m.EnumValue(name=v) for v in values.split()]))


def global_list(name: str, text: str) -> m.VariableSection:
    return m.VariableSection(kind=m.SectionKind.GLOBAL, name=name, variables=variables(text))


def project(*things: m.Pou | m.DataTypeDeclaration | m.VariableSection) -> m.Project:
    return m.Project(
        pous=[t for t in things if isinstance(t, m.Pou)],
        data_types=[t for t in things if isinstance(t, m.DataTypeDeclaration)],
        global_variables=[t for t in things if isinstance(t, m.VariableSection)],
    )


def meanings(made: m.Project) -> list[tuple[object, bool]]:
    """The meaning of every name of a project, in order: the object, and whether that is in doubt."""
    return [
        (
            occurrence.meaning.declaration and id(occurrence.meaning.declaration.holder),
            bool(occurrence.meaning.doubt),
        )
        for occurrence in Names(made).everything
    ]
