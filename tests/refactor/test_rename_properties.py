"""A rename never changes what a program means: random projects with few names, so that names collide all the time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import hypothesis.strategies as st
from hypothesis import HealthCheck, given, settings

import plcopen_sfc.model as m
from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.refactor.rename import rename
from tests.languages.binding.projects import chart, enum, interface, meanings, struct
from tests.strategies import maybe, unique
from tests.strategies import projects as odd_projects
from tests.sweeps import examples

WORDS = ["a", "b", "c", "S1", "S2", "Main", "FB", "P", "K"]
words = st.sampled_from(WORDS)
type_names = st.sampled_from(["INT", "BOOL", "TON", "FB", "P", "K", "Main", "Elsewhere"])


def chains(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.builds("{}.{}".format, inner, words),
        st.builds("{}({} := {}, {})".format, inner, words, inner, inner),
        st.builds("{}[{}]".format, inner, inner),
        st.builds("{}({} => {})".format, inner, words, words),
    )


operands = st.recursive(words, chains, max_leaves=4) | st.builds("{}#{}".format, words, words) | st.just("THIS^.a")
members = st.builds("{}.{}".format, words, st.sampled_from(["x", "T", "a", "S1"]))
values = operands | members | st.sampled_from(["'a'", "5", "(* a *) b", "T#5s"])
expressions = st.lists(values, min_size=1, max_size=3).map(" AND ".join)
statements = st.one_of(
    st.builds("{} := {};".format, operands, expressions),
    st.builds("{}({} := {}, {} => {});".format, operands, words, expressions, words, operands),
    st.builds("IF {} THEN {} := {}; END_IF // a S1".format, expressions, words, expressions),
    st.builds("CASE {} OF {}, {}: {} := {}; END_CASE".format, words, words, members, words, words),
    st.builds("{}();".format, words),
    st.builds("{} := ) {};".format, words, words),
)
programs = st.lists(statements, max_size=3).map("\n".join)
declared = st.builds(
    lambda names, types: "; ".join(f"{name}: {type_}" for name, type_ in zip(names, types, strict=False)),
    unique(words, 0, 3),
    st.lists(type_names, min_size=3, max_size=3),
)
sections = st.sampled_from(["input", "output", "external", "local"])


@st.composite
def pous(draw: Callable[..., Any], name: str) -> m.Pou:
    body: m.Body = m.StBody(text=draw(programs))
    if draw(st.booleans()):
        net = chart(" ".join(draw(unique(words, 1, 3))), *draw(st.lists(expressions, max_size=3)))
        for step in net.steps:
            step.entry_action = draw(maybe(operands))
            for target in draw(st.lists(operands, max_size=2)):
                step.actions.append(m.ActionAssociation(id=net.new_id(), target=target, duration=draw(maybe(words))))
        body = m.SfcBody(chart=net)
    elif draw(st.booleans()):
        node = m.Block(
            id=1,
            type_name=draw(words),
            instance=draw(maybe(operands)),
            parameters=m.BlockParameters(inputs=[m.BlockVariable(name=draw(words))]),
        )
        wire = m.Connection(source=1, pin=draw(words))
        contact = m.Contact(id=2, variable=draw(operands), input=m.InputPin(connections=[wire]))
        body = m.LdBody(networks=[m.LogicNetwork(nodes=[node, contact])])
    elif draw(st.booleans()):
        body = m.IlBody(text="\n".join(f"LD {draw(operands)}" for _ in range(draw(st.integers(0, 3)))))
    made = m.Pou(
        name=name,
        kind=draw(st.sampled_from([m.PouKind.PROGRAM, m.PouKind.FUNCTION_BLOCK, m.PouKind.FUNCTION])),
        interface=interface(**{draw(sections): draw(declared)}),
        bodies=[body],
        actions=[m.Action(name=n, body=m.StBody(text=draw(programs))) for n in draw(unique(words, 0, 2))],
        transitions=[m.NamedTransition(name=n, body=m.StBody(text=draw(programs))) for n in draw(unique(words, 0, 1))],
        methods=[
            m.Method(name=n, interface=interface(draw(declared)), body=m.StBody(text=draw(programs)))
            for n in draw(unique(words, 0, 1))
        ],
    )
    if draw(st.booleans()):
        assert made.interface is not None
        extends = draw(st.sampled_from(["", " EXTENDS Main", " EXTENDS FB"]))
        lines = [f"  {v.name} : {getattr(v.type, 'name', '')};" for v in made.interface.variables()]
        made.interface.declaration = "\n".join([f"FUNCTION_BLOCK {name}{extends}", "VAR // a", *lines, "END_VAR"])
    return made


@st.composite
def projects(draw: Callable[..., Any]) -> m.Project:
    globals_ = m.VariableSection(kind=m.SectionKind.GLOBAL, name=draw(st.sampled_from([None, "a", "G"])))
    globals_.variables = interface(draw(declared)).variables()
    return m.Project(
        pous=[draw(pous(name)) for name in draw(unique(st.sampled_from(["Main", "FB", "a"]), 1, 3))],
        data_types=[
            struct("P", draw(declared)),
            enum("K", " ".join(draw(unique(words, 1, 2)))),
        ],
        global_variables=[globals_],
    )


@settings(max_examples=examples(200), suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(st.data())
def test_names_mean_the_same_after_a_rename(data: st.DataObject) -> None:
    made = data.draw(projects())
    names = Names(made)
    what = names.resolver.original(data.draw(st.sampled_from(list(names.declarations()))))
    new = data.draw(st.sampled_from([*WORDS, "Neu", "x"]))
    before, original = meanings(made), made.model_copy(deep=True)
    old, uses = what.name, len(names.uses(what))
    try:
        result = rename(made, what, new)
    except ModelError:
        assert made == original
        return
    assert decided(meanings(made), before) == decided(before, before)
    assert len(Names(made).uses(what)) == uses
    assert len(result.changed) == (uses if new != old else 0)
    assert what.name == new
    try:
        rename(made, what, old)
    except ModelError:  # the old name hides something, or is there twice: a rename does not make such
        return
    assert made == original


def decided(found: list[tuple[object, bool]], before: list[tuple[object, bool]]) -> list[object]:
    """The meanings of the names that were not in doubt."""
    return [meaning for meaning, (_, doubt) in zip(found, before, strict=True) if not doubt]


@settings(max_examples=examples(60), suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(projects())
def test_looking_for_uses_changes_nothing(made: m.Project) -> None:
    before = made.model_copy(deep=True)
    names = Names(made)
    for declaration in names.declarations():
        for occurrence in names.uses(declaration):
            start, end = occurrence.reference.span
            assert occurrence.text_site.text[start:end].casefold() == declaration.name.casefold()
            assert occurrence.use.line >= 1
    assert made == before


@settings(max_examples=examples(60), suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(odd_projects(), st.data())
def test_odd_texts_are_no_reason_to_fail(made: m.Project, data: st.DataObject) -> None:
    """Texts with all that must be escaped somewhere, most of which no grammar reads."""
    before = meanings(made)
    what = Names(made).resolver.original(data.draw(st.sampled_from(list(Names(made).declarations()))))
    original = made.model_copy(deep=True)
    try:
        result = rename(made, what, "Zz9_Neu")
    except ModelError:
        assert made == original
        return
    assert what.name == "Zz9_Neu"
    assert decided(meanings(made), before) == decided(before, before)
    assert len(Names(made).uses(what)) == len(result.changed)
