"""Names that only SCL can write."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.translation import NameScope, Rename, Renames, TranslationContext, translate_text
from plcopen_sfc.languages.translation.renames import KeptNames, keep_names, kept_names, kept_renames
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project

SCL, IEC = Dialect.SCL, Dialect.IEC
LOCAL, GLOBAL, MEMBER = NameScope.LOCAL, NameScope.GLOBAL, NameScope.MEMBER


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Motor 1", "Motor_1"),
        ("Füllstand", "Fuellstand"),
        ("Größe-ß", "Groesse_ss"),
        ("1.Ventil", "_1_Ventil"),
        ("a__b", "a_b"),
        ("Été", "Ete"),
        ("阀", "u9600"),
        ("%", "u0025"),
        ("IF", "IF_2"),
        ("Limit", "Limit_2"),
    ],
)
def test_names_become_legal(old: str, new: str) -> None:
    renames = Renames()
    assert renames.legal_name(LOCAL, old) == new
    assert list(renames) == [Rename(LOCAL, old, new)]
    assert renames.old_name(LOCAL, new) == old
    assert renames.legal_name(LOCAL, old.swapcase() if old.isascii() else old) == new


def test_names_of_one_kind_are_kept_beside_those_of_the_others() -> None:
    project = Project()
    keep_names(project, KeptNames.TRANSLATED, [("local", "a <b>", "a_b"), ("nowhere", "x", "y")])
    keep_names(project, KeptNames.DECLARED, [("Main.Fill_step", "Fill", "Fill_step")])
    assert [name for _, name, _ in kept_names(project, KeptNames.TRANSLATED)] == ["a <b>", "x"]
    assert list(kept_renames(project)) == [], "a scope that there is not"
    keep_names(project, KeptNames.TRANSLATED, [("local", "a <b>", "a_b")])
    assert list(kept_renames(project)) == [Rename(LOCAL, "a <b>", "a_b")]
    keep_names(project, KeptNames.TRANSLATED, [])
    assert kept_names(project, KeptNames.DECLARED) == [("Main.Fill_step", "Fill", "Fill_step")]
    assert project.extension_data is not None
    project.extension_data.data[0].content = "<names>[7]</names>"
    assert kept_names(project, KeptNames.DECLARED) == []
    keep_names(project, KeptNames.DECLARED, [])
    assert project.extension_data is None


def test_legal_names_stay_and_are_no_renames() -> None:
    renames = Renames()
    assert renames.legal_name(LOCAL, "Motor") == "Motor"
    assert renames.legal_name(LOCAL, "Step", target=Dialect.CODESYS) == "Step"
    assert renames.legal_name(MEMBER, "Len", target=Dialect.CODESYS) == "Len"
    assert len(renames) == 0


def test_two_names_never_become_one() -> None:
    renames = Renames()
    found = [renames.legal_name(LOCAL, name, {"a_b"}) for name in ("a b", "a-b", "a.b")]
    assert found == ["a_b_2", "a_b_3", "a_b_4"]
    assert renames.legal_name(GLOBAL, "a b") == "a_b"
    assert renames.legal_name(MEMBER, "a b") == "a_b_2"  # what is local is a member of instances


def test_a_new_name_that_is_taken_elsewhere_is_given_up() -> None:
    renames = Renames()
    assert renames.legal_name(MEMBER, "a b") == "a_b"
    assert renames.legal_name(LOCAL, "a b", {"a_b"}) == "a_b_2"
    assert renames.legal_name(MEMBER, "a b") == "a_b_2"
    assert len(renames) == 2  # so that whoever translates until nothing changes goes on


def test_parameters_are_called_as_in_the_interface() -> None:
    context = TranslationContext(locals=["Limit"])
    translate_text("#Limit := 1;", "statements", SCL, IEC, context)
    caller = TranslationContext(renames=context.renames)
    text = "#inst(Limit := 5); #x := #inst.LIMIT + LIMIT(MN := 1, IN := 2, MX := 3);"
    found = translate_text(text, "statements", SCL, IEC, caller)
    assert found.text == "inst(Limit_2 := 5); x := inst.Limit_2 + LIMIT(MN := 1, IN := 2, MX := 3);"


def test_a_global_name_like_the_new_one_of_a_local() -> None:
    found = translate_text('"a_b" AND #"a b"', "expression", SCL, IEC)
    assert found.text == "a_b_2 AND a_b"


def test_a_global_name_that_a_local_one_hides() -> None:
    context = TranslationContext()
    found = translate_text('"x" AND #x AND "X".y', "expression", SCL, IEC, context)
    assert found.text == "x_2 AND x AND x_2.y"
    assert "hidden by a local one" in found.notes[0].reason
    back = TranslationContext(locals=["x"], renames=context.renames)
    assert translate_text(found.text, "expression", IEC, SCL, back).text == '"x" AND #x AND "x".y'


def test_members_and_parameters_hide_nothing() -> None:
    found = translate_text('"Start" := "DB".Start AND "DB".Stop AND "F"(Start := "Stop");', "statements", SCL, IEC)
    assert found.text == "Start := DB.Start AND DB.Stop AND F(Start := Stop);"


def test_functions_are_not_renamed() -> None:
    context = TranslationContext()
    translate_text("x := LIMIT(MN := 1, IN := SQR(#r), MX := 3) + ROUND(#r);", "statements", SCL, IEC, context)
    assert list(context.renames) == []


def test_known_renames_are_used() -> None:
    context = TranslationContext(renames=Renames([Rename(GLOBAL, "Motor 1", "M1")]))
    assert translate_text('"motor 1".run', "expression", SCL, IEC, context).text == "M1.run"


_names = st.text(
    st.characters(exclude_categories=("Cs", "Cc", "Zl", "Zp"), exclude_characters='"'), min_size=1, max_size=6
)


@given(st.lists(st.tuples(st.sampled_from([LOCAL, GLOBAL, MEMBER]), _names), max_size=8))
def test_new_names_are_identifiers_and_lead_back(pairs: list[tuple[NameScope, str]]) -> None:
    renames = Renames()
    for scope, old in pairs:
        new = renames.legal_name(scope, old)
        parsed = parse_expression(new, IEC)
        assert parsed.problems == ()
        assert parsed.tree == n.Name(new)
        if new != old:
            assert (renames.old_name(scope, new) or "").casefold() == old.casefold()
    found = [(rename.scope is GLOBAL, rename.new.casefold()) for rename in renames]
    assert len(found) == len(set(found))
