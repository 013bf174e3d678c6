"""Declarations between text and model: what is written is read back, in every dialect."""

from __future__ import annotations

import re
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc import model as m
from plcopen_sfc.languages.declarations import (
    read_declarations,
    write_data_type,
    write_listing,
    write_section,
    write_value,
)
from plcopen_sfc.languages.declarations.type_names import is_unreserved
from plcopen_sfc.model.dialect import Dialect
from tests import strategies as random_model
from tests.sweeps import examples

# -- what a text can say ----------------------------------------------------------------------------------------------

names = random_model.names.filter(is_unreserved)
lines = st.text("aäöZ09 .,:;'\"(){}<>&%$#-", min_size=1, max_size=9).map(str.strip).filter(bool)
comments = st.lists(lines, min_size=1, max_size=3).map("\n".join)
literals = st.sampled_from(["1", "-2.5", "16#FF", "T#5s", "'it$'s'", "TRUE", "MAX", "A.b", "N * 2 + 1"])
counts = st.sampled_from(["1", "N", "N - 1"])


def maybe(strategy: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.none() | strategy


simple = st.builds(m.SimpleValue, text=literals)
values: st.SearchStrategy[Any] = st.recursive(
    simple,
    lambda inner: (
        st.builds(
            m.ArrayValue,
            items=st.lists(
                st.builds(m.RepeatedValue, value=inner, repetitions=maybe(st.sampled_from(["2", "10"]))), max_size=3
            ),
        )
        | st.builds(
            m.StructValue, members=st.lists(st.builds(m.MemberValue, member=names, value=inner), min_size=1, max_size=2)
        )
    ),
    max_leaves=4,
)
bounds = st.builds(m.Dimension, lower=st.sampled_from(["0", "-5"]), upper=counts)
open_bounds = st.just(m.Dimension(lower="*", upper="*"))
integers = st.sampled_from([m.ElementaryType(name=name) for name in ("INT", "BYTE", "LINT")])


def compound(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    members = st.builds(m.Variable, name=names, type=inner, comment=maybe(comments), initial=maybe(values))
    enum_values = st.lists(st.builds(m.EnumValue, name=names, value=maybe(counts)), min_size=1, max_size=3)
    return st.one_of(
        st.builds(m.ArrayType, dimensions=st.lists(bounds | open_bounds, min_size=1, max_size=2), base=inner),
        st.builds(m.StructType, members=st.lists(members, max_size=2)),
        st.builds(m.PointerType, base=inner, reference=st.booleans()),
        st.builds(m.SubrangeType, bounds=bounds, base=integers),
        st.builds(m.EnumType, values=enum_values, base=maybe(integers)),
    )


types: st.SearchStrategy[Any] = st.recursive(
    random_model.elementary
    | st.builds(m.StringType, wide=st.booleans(), length=maybe(counts))
    | st.builds(m.DerivedType, name=names.filter(lambda name: name.upper() not in m.Elementary.__members__)),
    compound,
    max_leaves=3,
)
variables = st.builds(
    m.Variable,
    name=names,
    type=types,
    comment=maybe(comments),
    initial=maybe(values),
    address=maybe(st.sampled_from(["%QX1.0", "%I*"])),
)
KINDS = [m.SectionKind(kind) for kind in ("local", "temp", "input", "output", "inOut", "external", "global")]
sections = st.builds(
    m.VariableSection,
    kind=st.sampled_from(KINDS),
    constant=st.booleans(),
    retain=st.booleans(),
    nonretain=st.booleans(),
    persistent=st.booleans(),
    variables=st.lists(variables, max_size=3),
    comment=maybe(comments),
)
declarations = st.builds(m.DataTypeDeclaration, name=names, type=types, initial=maybe(values), comment=maybe(comments))
dialects = st.sampled_from([Dialect.IEC, Dialect.CODESYS, Dialect.SCL])


@pytest.mark.slow
@given(sections, dialects)
@settings(max_examples=examples(300), deadline=None)
def test_a_section_comes_back(section: m.VariableSection, dialect: Dialect) -> None:
    text = write_section(section, dialect)
    declared = read_declarations(text, dialect)
    assert declared.problems == ()
    assert declared.sections == [section], text


@pytest.mark.slow
@given(declarations, st.sampled_from([Dialect.IEC, Dialect.CODESYS]))
@settings(max_examples=examples(150), deadline=None)
def test_a_data_type_comes_back(declaration: m.DataTypeDeclaration, dialect: Dialect) -> None:
    text = write_data_type(declaration, dialect)
    declared = read_declarations(text, dialect)
    assert declared.problems == ()
    assert declared.types == [declaration], text


@given(declarations)
@settings(max_examples=examples(50), deadline=None)
def test_a_structure_comes_back_from_scl(declaration: m.DataTypeDeclaration) -> None:
    declaration.initial = None
    if not isinstance(declaration.type, m.StructType):
        declaration.type = m.StructType(members=[m.Variable(name="x", type=declaration.type)])
    declared = read_declarations(write_data_type(declaration, Dialect.SCL), Dialect.SCL)
    assert declared.problems == ()
    assert declared.types == [declaration]


@pytest.mark.slow
@given(random_model.sections, dialects)
@settings(max_examples=examples(300), deadline=None)
def test_whatever_the_model_holds_what_is_written_can_be_read(section: m.VariableSection, dialect: Dialect) -> None:
    text = write_section(section, dialect)
    declared = read_declarations(text, dialect)
    assert declared.problems == (), text
    (back,) = declared.sections
    assert [variable.name != "" for variable in back.variables] == [True] * len(section.variables)
    assert read_declarations(write_section(back, dialect), dialect).sections == [back]


@given(random_model.values)
def test_a_value_is_written_only_if_it_can_be_read(value: Any) -> None:
    text = write_value(value)
    if text:
        assert read_declarations(f"VAR x : INT := {text}; END_VAR").problems == ()


# -- single cases -----------------------------------------------------------------------------------------------------


def variable(text: str, dialect: Dialect = Dialect.CODESYS) -> m.Variable:
    declared = read_declarations(f"VAR {text} END_VAR", dialect)
    assert declared.problems == ()
    (found,) = declared.sections[0].variables
    return found


@pytest.mark.parametrize(
    ("text", "type_"),
    [
        ("x : bool;", m.ElementaryType(name="BOOL")),
        ("x : TIME_OF_DAY;", m.ElementaryType(name="TOD")),
        ("x : DATE_AND_TIME;", m.ElementaryType(name="DT")),
        ("x : STRING;", m.StringType()),
        ("x : STRING(80);", m.StringType(length="80")),
        ("x : WSTRING[LEN];", m.StringType(wide=True, length="LEN")),
        ("x : Lib.FB_X;", m.DerivedType(name="Lib.FB_X")),
        ("x : UINT(0..10);", None),
        ("x : POINTER TO ARRAY [1..2] OF INT;", None),
        ("x : REFERENCE TO INT;", m.PointerType(base="INT", reference=True)),
        ("x : (A, B := 5) BYTE;", None),
    ],
)
def test_types(text: str, type_: Any) -> None:
    found = variable(text)
    if type_ is not None:
        assert found.type == type_
    again = variable(write_section(m.VariableSection(variables=[found]), Dialect.CODESYS)[3:-7])
    assert again.type == found.type


def test_subranges_of_unsigned_types_are_unsigned() -> None:
    assert variable("x : UINT(0..10);").type == m.SubrangeType(
        bounds=m.Dimension(lower="0", upper="10"), base="UINT", unsigned=True
    )
    assert variable("x : INT(0..10);").type == m.SubrangeType(bounds=m.Dimension(lower="0", upper="10"), base="INT")


def test_the_values_of_codesys_2_need_no_brackets() -> None:
    value = variable("x : ARRAY [0..4] OF INT := 1, 2, 3(0);").initial
    assert isinstance(value, m.ArrayValue)
    assert [(item.repetitions, item.value) for item in value.items] == [
        (None, m.SimpleValue(text="1")),
        (None, m.SimpleValue(text="2")),
        ("3", m.SimpleValue(text="0")),
    ]


def test_a_call_in_an_array_is_a_repetition() -> None:
    value = variable("x : ARRAY [0..4] OF INT := [N(0)];").initial
    assert value == m.ArrayValue(items=[m.RepeatedValue(value="0", repetitions="N")])


def test_values_by_position_stay_as_they_are_written() -> None:
    assert variable('x : "UDT" := (1, (2, 3), ());', Dialect.SCL).initial == m.SimpleValue(text="(1, (2, 3), ())")


COMMENTED = """
// about the section
VAR_INPUT
    // long
    // story
    a : INT; // short
    (* b *) b, c : INT; (* both *) // really
    d : (* inside *) INT;

    // a headline

    e : STRUCT // of e
        f : INT; // f
    END_STRUCT;
    // last
END_VAR
"""


def test_every_comment_belongs_to_something() -> None:
    (section,) = read_declarations(COMMENTED).sections
    assert section.comment == "about the section\nlast"
    assert {variable.name: variable.comment for variable in section.variables} == {
        "a": "long\nstory\nshort",
        "b": "b\nboth\nreally",
        "c": "b\nboth\nreally",
        "d": "inside",
        "e": "a headline",
    }
    struct = section.variables[4].type
    assert isinstance(struct, m.StructType)
    assert struct.members[0].comment == "of e\nf"


@pytest.mark.parametrize(
    "text",
    [
        "VAR_STAT\n    x : INT;\nEND_VAR",
        "VAR_INPUT\n    x : BOOL R_EDGE;\nEND_VAR",
        "VAR PUBLIC\n    x : INT;\nEND_VAR",
        "VAR\n    {attribute 'hide'}\n    x : INT;\nEND_VAR",
        "VAR\n    x : FB(3, y := 4);\nEND_VAR",
        "VAR\n    x : UNION\n        y : INT;\n    END_UNION;\nEND_VAR",
        "VAR\n    AT %IX0.0 : BOOL;\nEND_VAR",
    ],
)
def test_what_has_no_field_in_the_model_is_carried_and_written_back(text: str) -> None:
    (section,) = read_declarations(text, Dialect.CODESYS).sections
    assert write_section(section, Dialect.CODESYS) == text


def test_a_comment_inside_a_value_stays_there() -> None:
    found = variable("x : INT := 1 + (* more *) 2; (* sum *)")
    assert (found.initial, found.comment) == (m.SimpleValue(text="1 + (* more *) 2"), "sum")


def test_what_does_not_parse_is_carried_and_written_back() -> None:
    declared = read_declarations("VAR\n    a : INT;\n    b ? INT;\n    c : INT;\nEND_VAR")
    (section,) = declared.sections
    assert [problem.message for problem in declared.problems] == ["'?' cannot stand here"]
    assert [variable.name for variable in section.variables] == ["a", "c"]
    assert "b ? INT;" in write_section(section)


def test_attributes_of_scl_are_fields() -> None:
    found = variable("x { S7_HMI := 'x y'; ExternalWritable := 'False' } : Bool;", Dialect.SCL)
    assert found.attributes == {"S7_HMI": "x y", "ExternalWritable": "False"}
    assert found.extension_data is None


@pytest.mark.parametrize("braces", ["{ S7_HMI := true }", "{ S7_HMI := 'it$'s' }", "{ a := '1'; a := '2' }", "{}"])
def test_other_braces_of_scl_are_carried(braces: str) -> None:
    found = variable(f"x {braces} : Bool;", Dialect.SCL)
    assert found.attributes == {}
    assert f"x {braces} : Bool;" in write_section(m.VariableSection(variables=[found]), Dialect.SCL)


def test_types_of_the_user_stand_in_quotes_in_scl_those_of_the_system_do_not() -> None:
    text = 'VAR\n   a : "Motor";\n   b : TON_TIME;\n   c : FB12;\n   d : Variant;\nEND_VAR'
    (section,) = read_declarations(text, Dialect.SCL).sections
    assert all(v.type.extension_data is None for v in section.variables if isinstance(v.type, m.DerivedType))
    assert write_section(section, Dialect.SCL) == text
    odd = re.sub('"Motor"', "Motor", text).replace("TON_TIME", '"TON_TIME"')
    assert write_section(read_declarations(odd, Dialect.SCL).sections[0], Dialect.SCL) == odd


def test_access_paths_and_configured_variables() -> None:
    access = "VAR_ACCESS\n    Level : r.p.x : INT READ_ONLY; (* seen *)\nEND_VAR"
    config = "VAR_CONFIG\n    r.p.y AT %IX0.0 : BOOL := TRUE;\nEND_VAR"
    one, other = read_declarations(access).items[0].thing, read_declarations(config).items[0].thing
    assert one.variables[0].direction is m.AccessDirection.READ_ONLY
    assert other.variables[0].address == "%IX0.0"
    assert (write_listing(one), write_listing(other)) == (access, config)
