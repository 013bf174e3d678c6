"""Random projects for properties: every kind of object, texts of every kind that a file can hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st

from plcopen_sfc import model as m
from plcopen_sfc.languages.words import IEC_KEYWORDS

QUALIFIERS = [m.Qualifier(q) for q in ("N", "R", "S", "L", "D", "P", "P0", "P1", "SD", "DS", "SL", "DL")]

names = st.from_regex(r"[A-Za-zÄÖÜäöüß_][A-Za-z0-9_äöü]{0,5}", fullmatch=True).filter(
    lambda name: name.upper() not in IEC_KEYWORDS
)
characters = st.characters(blacklist_categories=("Cs", "Cc", "Cn"), blacklist_characters="\ufffe\uffff")
words = st.text(characters, min_size=1, max_size=6)
MARKS = r"""< > & " ' ]]> &amp; <!--x--> (*Ä*) --> -- IF„ß“ 😀 € { } \n %s plcopen_sfc{""".split()
awkward = st.sampled_from([*MARKS, "\n", "\n\n", "\t", "  ", " x", "x ", "a < b"])
texts = st.lists(words | awkward, min_size=1, max_size=4).map("".join)
"""Texts, with all that must be escaped somewhere."""
expressions = texts.filter(lambda text: text == text.strip() and bool(text))
times = st.sampled_from(["T#5s", "T#1h2m3s4ms", "tDelay", "t#0.5S"])


def maybe(strategy: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.none() | strategy


def unique(strategy: st.SearchStrategy[str], low: int, high: int) -> st.SearchStrategy[list[str]]:
    return st.lists(strategy, min_size=low, max_size=high, unique_by=str.casefold)


# -- types and values -------------------------------------------------------------------------------------------------

elementary = st.sampled_from([m.ElementaryType(name=name) for name in m.Elementary])
dimensions = st.builds(m.Dimension, lower=st.sampled_from(["0", "-5", "LOW"]), upper=st.sampled_from(["9", "HIGH"]))


def compound(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    members = st.builds(m.Variable, name=names, type=inner, comment=maybe(texts), initial=maybe(values))
    return st.one_of(
        st.builds(m.ArrayType, dimensions=st.lists(dimensions, min_size=1, max_size=2), base=inner),
        st.builds(m.StructType, members=st.lists(members, max_size=2)),
        st.builds(m.PointerType, base=inner),
        st.builds(m.SubrangeType, bounds=dimensions, base=elementary, unsigned=st.booleans()),
        st.builds(
            m.EnumType,
            values=st.lists(st.builds(m.EnumValue, name=names, value=maybe(expressions)), min_size=1, max_size=3),
            base=maybe(elementary),
        ),
    )


simple_values = st.builds(m.SimpleValue, text=maybe(expressions))
values: st.SearchStrategy[Any] = st.recursive(
    simple_values,
    lambda inner: (
        st.builds(
            m.ArrayValue,
            items=st.lists(
                st.builds(m.RepeatedValue, value=inner, repetitions=maybe(st.sampled_from(["1", "3"]))), max_size=2
            ),
        )
        | st.builds(m.StructValue, members=st.lists(st.builds(m.MemberValue, member=names, value=inner), max_size=2))
    ),
    max_leaves=3,
)
types: st.SearchStrategy[Any] = st.recursive(
    elementary
    | st.builds(m.StringType, wide=st.booleans(), length=maybe(st.sampled_from(["80", "LEN"])))
    | st.builds(m.DerivedType, name=names),
    compound,
    max_leaves=2,
)

# -- declarations -----------------------------------------------------------------------------------------------------

variables = st.builds(
    m.Variable, name=names, type=types, comment=maybe(texts), initial=maybe(values), address=maybe(st.just("%QX1.0"))
)
sections = st.builds(
    m.VariableSection,
    kind=st.sampled_from([kind for kind in m.SectionKind if kind.value not in ("constant", "return")]),
    name=maybe(names),
    constant=st.booleans(),
    retain=st.booleans(),
    variables=st.lists(variables, max_size=2),
    comment=maybe(texts),
)
interfaces = st.builds(
    m.Interface, return_type=maybe(types), sections=st.lists(sections, max_size=2), declaration=maybe(texts)
)

# -- bodies -----------------------------------------------------------------------------------------------------------


@st.composite
def logic(draw: Callable[..., Any], kinds: tuple[str, ...]) -> m.LogicNetwork:
    """A chain of elements, each wired to the one before it."""
    nodes: list[Any] = []
    for number, kind in enumerate(draw(st.lists(st.sampled_from(kinds), min_size=1, max_size=4))):
        wire = m.InputPin(connections=[m.Connection(source=number - 1)]) if number else None
        common = {"id": number, "position": (draw(st.integers(0, 99)), number), "comment": draw(maybe(texts))}
        edges = {"negated": draw(st.booleans()), "edge": draw(st.sampled_from(m.Edge))}
        out = m.OutputPin()
        if kind == "input":
            nodes.append(m.InputVariable(**common, **edges, expression=draw(expressions), output=out))
        elif kind == "output":
            nodes.append(m.OutputVariable(**common, **edges, expression=draw(expressions), input=wire))
        elif kind == "contact":
            nodes.append(m.Contact(**common, **edges, variable=draw(names), input=wire, output=out))
        elif kind == "coil":
            storage = draw(st.sampled_from(m.Storage))
            nodes.append(m.Coil(**common, **edges, storage=storage, variable=draw(names), input=wire, output=out))
        elif kind == "label":
            nodes.append(m.Label(**common, label=draw(names)))
        elif kind == "comment":
            nodes.append(m.CommentBox(**common, width=10, height=5, content=draw(texts)))
        else:
            parameter = m.BlockVariable(name="IN", input=wire, comment=draw(maybe(texts)))
            result = m.BlockVariable(name="OUT", output=out)
            parameters = m.BlockParameters(inputs=[parameter], outputs=[result])
            nodes.append(m.Block(**common, type_name=draw(names), instance=draw(maybe(names)), parameters=parameters))
    return m.LogicNetwork(nodes=nodes)


st_bodies = st.builds(m.StBody, text=texts, comment=maybe(texts))
il_bodies = st.builds(m.IlBody, text=texts)
fbd_bodies = st.builds(
    m.FbdBody, networks=logic(("input", "output", "block", "label", "comment")).map(lambda network: [network])
)
ld_bodies = st.builds(m.LdBody, networks=logic(("contact", "coil", "comment")).map(lambda network: [network]))
code = st.one_of(st_bodies, il_bodies, fbd_bodies, ld_bodies)

# -- charts -----------------------------------------------------------------------------------------------------------

conditions = st.one_of(
    st.builds(m.Expression, text=expressions, negated=st.booleans()),
    st.builds(m.NamedCondition, name=names, negated=st.booleans()),
    st.builds(m.BodyCondition, body=il_bodies | fbd_bodies | ld_bodies, name=maybe(names).map(lambda n: n or "")),
)


@st.composite
def charts(draw: Callable[..., Any], times_of_steps: bool = True) -> m.SfcNetwork:
    """A chart that can be drawn: a circle of steps with selections, jumps back and one simultaneous part."""
    own = draw(unique(names, 2, 6))
    chart = m.SfcNetwork()
    for number, name in enumerate(own):
        step = chart.add_step(name, initial=number == 0)
        step.comment = draw(maybe(texts))
        if times_of_steps:
            step.min_time, step.max_time = draw(maybe(times)), draw(maybe(times))
            step.entry_action, step.main_action = draw(maybe(names)), draw(maybe(names))
            step.exit_action = draw(maybe(names.map(lambda n: f"Motor.{n}")))
        for _ in range(draw(st.integers(0, 2))):
            step.actions.append(
                m.ActionAssociation(
                    id=chart.new_id(),
                    qualifier=draw(st.sampled_from(QUALIFIERS)),
                    target=draw(names),
                    body=draw(maybe(st_bodies)) if draw(st.integers(0, 3)) == 0 else None,
                    duration=draw(maybe(times)),
                    indicator=draw(maybe(names)),
                    comment=draw(maybe(texts)),
                )
            )
    steps = chart.steps
    for one, next_ in zip(steps, [*steps[1:], steps[0]], strict=True):
        transition = chart.add_transition(one, next_, draw(conditions))
        transition.comment = draw(maybe(texts))
        if draw(st.integers(0, 2)) == 0:
            chart.add_transition(one, draw(st.sampled_from(steps)), draw(conditions))
    if draw(st.booleans()) and len(own) > 2:
        left, right, after = (chart.add_step(f"{suffix}_{own[0]}_{len(own)}") for suffix in ("Li", "Re", "Zu"))
        chart.add_transition(steps[1], [left, right], draw(conditions))
        chart.add_transition([left, right], after, draw(conditions))
        chart.add_transition(after, steps[0], draw(conditions))
    return chart


sfc_bodies = st.builds(m.SfcBody, chart=charts())
bodies = st.one_of(code, sfc_bodies)

# -- projects ---------------------------------------------------------------------------------------------------------


@st.composite
def pous(draw: Callable[..., Any], name: str) -> m.Pou:
    return m.Pou(
        name=name,
        kind=draw(st.sampled_from([m.PouKind.PROGRAM, m.PouKind.FUNCTION_BLOCK, m.PouKind.FUNCTION])),
        comment=draw(maybe(texts)),
        interface=draw(interfaces),
        actions=[m.Action(name=n, body=draw(bodies)) for n in draw(unique(names, 0, 2))],
        transitions=[m.NamedTransition(name=n, body=draw(code)) for n in draw(unique(names, 0, 1))],
        methods=[m.Method(name=n, body=draw(code), interface=m.Interface()) for n in draw(unique(names, 0, 1))],
        bodies=[draw(bodies)],
        object_id=draw(maybe(st.uuids().map(str))),
    )


@st.composite
def projects(draw: Callable[..., Any]) -> m.Project:
    """A project with POUs, types and a configuration."""
    declared = [
        m.DataTypeDeclaration(name=name, type=draw(types), initial=draw(maybe(values)), comment=draw(maybe(texts)))
        for name in draw(unique(names, 0, 2))
    ]
    task = m.Task(name=draw(names), priority=draw(st.integers(0, 31)), interval=draw(maybe(times)))
    resource = m.Resource(name=draw(names), tasks=[task], global_variables=draw(st.lists(sections, max_size=1)))
    for section in resource.global_variables:
        section.kind = m.SectionKind.GLOBAL
    configuration = m.Configuration(name=draw(names), resources=[resource], comment=draw(maybe(texts)))
    return m.Project(
        name=draw(texts),
        header=m.FileHeader(company=draw(texts), product="Test", version="1", created="2024-01-31T08:30:00"),
        author=draw(maybe(texts)),
        comment=draw(maybe(texts)),
        data_types=declared,
        pous=[draw(pous(name)) for name in draw(unique(names, 1, 2))],
        configurations=draw(st.sampled_from([[], [configuration]])),
    )
