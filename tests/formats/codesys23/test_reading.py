"""Exports of CoDeSys 2.3: what is read, that they come back byte for byte, and what is wrong with damaged ones."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.cli.summary import summarise
from plcopen_sfc.errors import FormatError
from plcopen_sfc.model.body import IlBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import BodyCondition
from tests.corpus import ROOT, corpus_files, require_corpus

BELT = ROOT / "fixtures" / "codesys23" / "distribution_belt.EXP"
HEADER = "(* @NESTEDCOMMENTS := 'Yes' *)\r\n(* @PATH := '' *)\r\n"


def chart(text: str, declarations: str = "", actions: str = "") -> m.Project:
    """Read a program with the chart `text`."""
    lines = f"PROGRAM Main\nVAR\n{declarations}\nEND_VAR\n(* @END_DECLARATION := '0' *)\n{text}\nEND_PROGRAM\n{actions}"
    return sfc.loads(f"{HEADER}{lines}".encode("cp1252"), format="codesys23")


def found(project: m.Project) -> list[tuple[str, int | None]]:
    return [(each.code, each.location.line) for each in project.diagnostics]


def test_the_belt_comes_back_and_is_read_whole() -> None:
    data = BELT.read_bytes()
    project = sfc.loads(data)
    assert sfc.dumps(project) == data
    assert [found.code for found in project.diagnostics] == ["EXP200"]
    assert summarise("belt.EXP", project).encoding == "CP1252"
    assert [pou.name for pou in project.pous] == ["Ablauf", "Eingabe", "PLC_PRG", "Meldung"]
    assert [type(pou.body) for pou in project.pous[1:]] == [IlBody, StBody, OpaqueBody]
    assert project.pou("Ablauf").comment == "Band mit drei Plätzen: Teil holen, warten, pendeln, abgeben"
    assert [each.name for each in project.data_types] == ["Auftrag"]
    (globals_,) = project.global_variables
    assert (globals_.name, len(globals_.variables)) == ("Globale_Variablen", 12)
    body = project.pou("Meldung").body
    assert isinstance(body, OpaqueBody)
    assert body.content.startswith("_CFC_BODY\n_ELEMENT\n")


def test_the_chart_of_the_belt() -> None:
    belt = sfc.load(BELT).pou("Ablauf").chart
    assert belt is not None
    assert [step.name for step in belt.initial_steps] == ["Bereit"]
    step = belt.step("Abtransport")
    assert (step.max_time, step.min_time, belt.step("Bereit").comment) == ("t#20s", "t#500ms", "wartet auf ein Teil")
    action = belt.step("Zu_Platz3").main_action
    assert isinstance(action, StBody)
    assert action.text == "H1_Bereit := FALSE;\nBand_Rechts := TRUE;"
    assert isinstance(belt.step("Warten").main_action, IlBody)
    assert belt.step("Pendel_Zaehlen").main_action == "Zaehlen"
    assert [belt.label(each) for each in belt.outgoing(belt.step("Pruefen"))] == [
        "Pruefen -> Pendel_Hin",
        "Pruefen -> Abtransport",
    ]
    assert belt.transition("Warten -> Zurueck").condition == Expression(text="Wartezeit.Q")


@pytest.mark.corpus
def test_real_files_come_back_and_are_understood() -> None:
    require_corpus()
    files = {path.name: path.read_bytes() for path in corpus_files("codesys23")}
    projects = {name: sfc.loads(data) for name, data in files.items()}
    assert len(files) == 5
    assert all(sfc.dumps(projects[name]) == data for name, data in files.items())
    assert not [each for project in projects.values() for each in project.diagnostics if each.severity == "error"]
    tasks = projects["CALLBACK_MAIN_TASK.EXP"].pous[0].chart
    assert tasks is not None
    assert (len(tasks.steps), len(tasks.transitions), len(tasks.transitions[0].targets)) == (8, 3, 6)
    assert all(isinstance(step.main_action, StBody) for step in tasks.steps)
    main = projects["PLC_PRG.EXP"].pous[0]
    assert [action.name for action in main.actions] == ["acIndicator", "acInit", "acMB"]
    comments = {each.name: each.comment for each in main.variables()}
    assert comments["bath"] == "массив ФБ ванн"  # the letters tell the code page


def test_steps_with_associations() -> None:
    text = (
        "INITIAL_STEP Init:\nEND_STEP\nTRANSITION FROM Init TO Run:=\nTRUE\nEND_TRANSITION\n"
        "STEP Run:\nPump(N);\nValve( D , t#2s );\nEND_STEP\nTRANSITION FROM Run TO Init:=\nDone;\nEND_TRANSITION"
    )
    read = chart(text).pous[0].chart
    assert read is not None
    assert [(each.target, each.qualifier, each.duration) for each in read.step("Run").actions] == [
        ("Pump", m.Qualifier.N, None),
        ("Valve", m.Qualifier.D, "t#2s"),
    ]
    assert read.transitions[1].condition == Expression(text="Done")
    # a call that gets a variable, unless its name is one of an action or of a BOOL
    for declarations, count in (("n : INT;", 0), ("n : INT; pump, valve : BOOL;", 2)):
        other = chart(text, declarations).pous[0].chart
        assert other is not None
        assert len(other.step("Run").actions) == count


def test_actions_of_steps_and_conditions_in_other_languages() -> None:
    text = (
        "INITIAL_STEP Init:\n_LD_BODY\n_NETWORKS : 0\nEND_STEP\n(* @SFCMAXTIME := '' *)\n"
        "TRANSITION FROM Init TO (A,B):= \n_LD_BODY\n_NETWORKS : 1\nit's\nEND_TRANSITION\n"
        "STEP A:\n(* END_STEP\nEND_STEP *)\nx := 1;\nEND_STEP\nSTEP B:\nB_work();\nEND_STEP\n"
        "TRANSITION Back FROM (A,B) TO Init:= \nLD x\nAND y\nEND_TRANSITION"
    )
    actions = "ACTION A_entry:\nx := 0;\nEND_ACTION\nACTION b_exit:\nEND_ACTION\nACTION B_work:\ny;\nEND_ACTION\n"
    read = chart(text, actions=actions).pous[0].chart
    assert read is not None
    first, last = (each.condition for each in read.transitions)
    assert isinstance(first, BodyCondition)
    assert isinstance(first.body, OpaqueBody)
    assert isinstance(last, BodyCondition)
    assert isinstance(last.body, IlBody)
    assert (read.transitions[1].name, len(read.transitions[1].sources)) == ("Back", 2)
    a, b = read.step("A"), read.step("B")
    assert (a.entry_action, a.exit_action, b.entry_action, b.exit_action) == ("A_entry", None, None, "B_exit")
    # one that only calls another is that one, unless something else names it
    actions = "ACTION A_entry:\nB_work();\nEND_ACTION\nACTION B_work:\ny;\nEND_ACTION\n"
    project = chart(text, actions=actions)
    other = project.pous[0].chart
    assert other is not None
    assert other.step("A").entry_action == "B_work"
    assert [action.name for action in project.pous[0].actions] == ["B_work"]
    assert chart(text, actions=actions.replace("y;", "A_entry();")).pous[0].actions[0].name == "A_entry"
    assert isinstance(a.main_action, StBody)
    assert a.main_action.text.startswith("(* END_STEP")
    assert b.main_action == "B_work"


@pytest.mark.parametrize(
    ("text", "code", "line", "message"),
    [
        ("STEP A:\nx := 1;\nSTEP B:\nEND_STEP", "EXP102", 8, "END_STEP of the step A is missing"),
        ("STEP A:\nEND_STEP\nTRANSITION FROM A TO A:=\nTRUE", "EXP102", 10, "END_TRANSITION of this transition"),
        ("STEP A:\nEND_STEP\nTRANSITION A TO A:=\nTRUE\nEND_TRANSITION", "EXP103", 10, "TRANSITION FROM steps TO"),
        ("STEP A:\nEND_STEP\nx := 1;", "EXP104", 10, "belongs to no step"),
        ("STEP A:\nEND_STEP\nTRANSITION FROM A TO C:=\nTRUE\nEND_TRANSITION", "EXP105", 10, "called C"),
        ("STEP A:\nEND_STEP\n(* @SFCCOMMENT := 'x *)\n", "EXP108", 10, "SFCCOMMENT of the step A"),
        ("x := 1\ny := 2;", "EXP110", 9, ""),
    ],
)
def test_faults_in_bodies_have_a_place(text: str, code: str, line: int, message: str) -> None:
    project = chart(text)
    assert found(project)[0] == (code, line)
    assert message in project.diagnostics[0].message
    assert project.diagnostics[0].location.path == "POU Main"


TWO_STEPS = "INITIAL_STEP A:\nEND_STEP\nTRANSITION FROM A TO B:=\nTRUE\nEND_TRANSITION\nSTEP B:\nEND_STEP\n"
BACK = "TRANSITION FROM B TO A:=\nFALSE\nEND_TRANSITION"


@pytest.mark.parametrize(("word", "commented"), [("STEP B", "(* b *)STEP B"), (BACK, f"(* STEP Q: *) {BACK} (* e *)")])
def test_comments_may_share_a_line_with_an_element(word: str, commented: str) -> None:
    project = chart((TWO_STEPS + BACK).replace(word, commented))
    assert not project.diagnostics
    assert project.pou("Main").chart == chart(TWO_STEPS + BACK).pou("Main").chart
    before = sfc.dumps(project)
    project.rename("Main.B", "C")
    assert sfc.dumps(project) == re.sub(rb"\bB\b", b"C", before)


@pytest.mark.parametrize(
    ("header", "commented"),
    [
        ("STEP B:", "STEP (* of (* B *) *) B (* : *) :"),
        ("INITIAL_STEP A:", "INITIAL_STEP(* A *) A:"),
        ("TRANSITION FROM B TO A:=", "TRANSITION (* x *) FROM B TO A:="),
        ("TRANSITION FROM B TO A:=", "TRANSITION FROM (* y *) B (* TO *) TO(* z *)A (* end *) :="),
        ("TRANSITION FROM A TO B:=", "TRANSITION FROM A TO (* two\r\n lines *) B:="),
    ],
)
def test_comments_in_the_header_of_an_element(header: str, commented: str) -> None:
    text = (TWO_STEPS + BACK).replace(header, commented)
    project = chart(text)
    assert not project.diagnostics
    assert project.pou("Main").chart == chart(TWO_STEPS + BACK).pou("Main").chart
    body = project.pou("Main").body
    assert isinstance(body, m.SfcBody)
    assert str(body.comment).count("(*") == commented.count("(*")
    before = sfc.dumps(project)
    project.rename("Main.B", "C")
    assert sfc.dumps(project) == re.sub(rb"(?<!of \(\* )\bB\b", b"C", before)


def test_a_variable_may_be_called_like_an_element() -> None:
    project = chart("Transition := Step + 1;", "Transition, Step : INT;")
    assert not project.diagnostics
    assert isinstance(project.pou("Main").body, StBody)


def test_comments_that_do_not_nest_in_their_project_are_told() -> None:
    lines = "PROGRAM Main\nVAR END_VAR\n(* @END_DECLARATION := '0' *)\n; (* a (* b *)\n; (* '(*' *)\nEND_PROGRAM\n"
    project = sfc.loads(f"{HEADER}{lines}".replace("'Yes'", "'No'").encode(), format="codesys23")
    assert [each.location.line for each in project.diagnostics if "NESTEDCOMMENTS" in each.message] == [6]
    plain = sfc.loads(f"{HEADER}{lines}".replace("'Yes'", "'No'").replace("a (*", "a").encode(), format="codesys23")
    assert not plain.diagnostics


def test_a_rename_tells_what_could_not_be_read() -> None:
    project = chart(TWO_STEPS + BACK.replace(" TO ", " THEN "))
    (found,) = project.rename("Main.B", "C").undecided
    assert (found.use.path, found.use.line) == ("POU Main", project.diagnostics[0].location.line)
    assert not chart(TWO_STEPS + BACK).rename("Main.B", "C").undecided


ONE_LINE = [
    "TYPE T : (a, b := 5); (* no end; END_TYPE *) END_TYPE\n(* @END_DECLARATION := '0' *)",
    "TYPE T : STRUCT x : INT; END_STRUCT END_TYPE\n(* @END_DECLARATION := '0' *)",
    "(* @GLOBAL_VARIABLE_LIST := 'G' *)\nVAR_GLOBAL x : INT; END_VAR\n(* @OBJECT_END := 'G' *)",
    "FUNCTION F : INT VAR_INPUT x : INT; END_VAR\n(* @END_DECLARATION := '0' *)\nF := x; END_FUNCTION",
]


@pytest.mark.parametrize("text", ONE_LINE)
def test_objects_may_end_in_the_line_of_their_last_statement(text: str) -> None:
    header = "(* @NESTEDCOMMENTS := 'Yes' *)\n(* @PATH := '' *)\n"
    data = f"\n{header}{text}\n\n{header}TYPE Last : BOOL;\nEND_TYPE\n".encode()
    project = sfc.loads(data)
    assert not [each for each in project.diagnostics if each.code == "EXP101"]
    assert "Last" in {each.name for each in project.data_types}
    assert len([*project.pous, *project.data_types, *project.global_variables]) == 2
    assert sfc.dumps(project) == data


def test_a_file_that_ends_too_early_and_one_with_an_unknown_section() -> None:
    whole = BELT.read_bytes()
    cut = sfc.loads(whole[: whole.index(b"STEP Pruefen")], path="cut.EXP")
    assert [each.code for each in cut.diagnostics] == ["EXP200", "EXP101", "EXP105"]
    assert "END_PROGRAM of PROGRAM Ablauf is missing" in cut.diagnostics[1].message
    assert cut.diagnostics[1].location.line == 18
    kept = sfc.loads(whole + b"WEIGHTS\r\n_A: 1\r\n", path="more.EXP")
    assert [each.message for each in kept.diagnostics if each.code == "EXP107"] == [
        "a section that begins with WEIGHTS is not known; it is kept as it is"
    ]
    # the next object is not swallowed by one without an end
    two = whole.replace(b"END_PROGRAM\r\nACTION", b"ACTION")
    assert [pou.name for pou in sfc.loads(two).pous] == ["Ablauf", "Eingabe", "PLC_PRG", "Meldung"]


@pytest.mark.parametrize(
    ("line", "lost"), [("(* @OBJECTFLAGS := '0, 8' *)", "Auftrag"), ("(* @SYMFILEFLAGS := '2048' *)", "Ablauf")]
)
def test_a_comment_without_end_is_told_where_it_begins(line: str, lost: str) -> None:
    text = BELT.read_bytes().decode("cp1252")
    cut = sfc.loads(text.replace(line, line[: len(line) // 2], 1).encode("cp1252"))
    assert lost not in {each.name for each in (*cut.pous, *cut.data_types)}
    assert {"PLC_PRG", "Meldung"} < {each.name for each in cut.pous}
    [found] = [each for each in cut.diagnostics if each.code == "EXP101"]
    assert (found.location.line, found.message[:26]) == (
        text[: text.index(line)].count("\n") + 1,
        "this comment has no end, s",
    )


@pytest.mark.parametrize(
    ("section", "outcome"),
    [
        ("TASK_CONFIGURATION\r\nMain\r\n", "not executed"),
        ("(* @PATH := '' *)\r\nVAR_CONFIG\r\nPLC_PRG.x AT %IX0.0 : BOOL;\r\nEND_VAR\r\n", "not executed"),
        ("RESOURCE\r\nTASK Main\r\nEND_RESOURCE\r\n", "not executed"),
        ("PLC_CONFIGURATION\r\n_GLOBAL\r\nPLC_END\r\n", "extension data"),
        ("_ALARMCONFIG\r\n_END\r\n", "extension data"),
        ("WEIGHTS\r\n_A: 1\r\n", "approximated"),
    ],
)
def test_sections_that_are_kept_are_told_in_conversions(section: str, outcome: str) -> None:
    data = HEADER.encode() + b"PROGRAM PLC_PRG\r\nEND_PROGRAM\r\n\r\n" + section.encode()
    project = sfc.loads(data, path="x.EXP")
    assert sfc.dumps(project) == data
    items = sfc.convert(project, "codesys", partial=True).report.items
    assert [item.outcome for item in items if item.what == "section"] == [outcome]


@pytest.mark.parametrize(
    ("comment", "page", "found"),
    [
        ("Zähler für Größe", "cp1252", "cp1252"),
        ("12 m³, 3 m³/h, 4 m³h, café, cœur, 5 £, ¿qué?", "cp1252", "cp1252"),
        ("счётчик деталей", "cp1251", "cp1251"),
        ("лічильник деталей, які їдуть", "cp1251", "cp1251"),
        ("Błąd pompy, zamknięty zawór", "cp1250", "cp1250"),
        ("příliš žluťoučký kůň", "cp1250", "cp1250"),
        ("Größe", "utf-8", "utf-8"),
    ],
)
def test_code_pages_are_found_and_kept(comment: str, page: str, found: str) -> None:
    data = f"{HEADER}PROGRAM A\r\nVAR\r\n\tx:INT;\t(* {comment} *)\r\nEND_VAR\r\nx := 1;\r\nEND_PROGRAM\r\n".encode(
        page
    )
    project = sfc.loads(data)
    assert project.pous[0].variables()[0].comment == comment
    assert f"taken as {found}" in project.diagnostics[0].message
    body = project.pous[0].body
    assert isinstance(body, StBody)
    body.text = "x := 2;"
    assert sfc.dumps(project) == data.replace(b"x := 1", b"x := 2")


def test_a_code_page_can_be_named_and_is_kept() -> None:
    start, end = f"{HEADER}PROGRAM A\r\nVAR\r\n\tx:INT;\t(* ", " *)\r\nEND_VAR\r\nx := 1;\r\nEND_PROGRAM\r\n"
    data = f"{start}Błąd pompy{end}".encode("cp1250")
    project = sfc.loads(data, format="codesys23-cp1250")
    assert not project.diagnostics
    assert project.pous[0].variables()[0].comment == "Błąd pompy"
    project.pous[0].variables()[0].comment = "Błąd wież"
    assert sfc.dumps(project) == f"{start}Błąd wież{end}".encode("cp1250")
    assert sfc.dumps(project, format="codesys23") == sfc.dumps(project)
    other = sfc.dumps(sfc.loads(sfc.dumps(project, format="iec-text")), format="codesys23-cp1250")
    assert "Błąd wież".encode("cp1250") in other
    assert sfc.loads(other).pous[0].variables()[0].comment == "Błąd wież"
    with pytest.raises(sfc.SfcError, match="16#81 is no character of the code page cp1252") as refused:
        sfc.loads(start.encode() + b"\x81" + end.encode(), format="codesys23-cp1252")
    assert refused.value.location.line


def test_a_guessed_code_page_says_how_sure_it_is() -> None:
    start, end = f"{HEADER}PROGRAM A\r\nVAR\r\n\tx:INT;\t(* ", " *)\r\nEND_VAR\r\nEND_PROGRAM\r\n"
    mixed = start.encode() + "счётчик".encode("cp1251") + " Zähler, Größe, Stück".encode("cp1252") + end.encode()
    project = sfc.loads(mixed)
    assert "64% of its letters beyond ASCII are in runs" in project.diagnostics[0].message
    (found,) = [each for each in project.diagnostics if each.code == "EXP204"]
    assert (found.location.line, found.location.column) == (5, 20)
    assert "'Zдhler' is 'Zähler' in cp1252: the file mixes code pages" in found.message
    assert sfc.dumps(project) == mixed
    for text, page in [
        ("Az időegység és a hőmérséklet hűtővíz előtt", "cp1250"),  # ő and ű: õ and û in 1252
        ("Brûleur, contrôle, goût, sûr", "cp1252"),
        ("Rõhk ja õli, pump töötab, küte väljas", "cp1252"),
        ("Condições, botões, pressão", "cp1252"),
        ("Botões, condições", "cp1252"),
    ]:
        named = sfc.loads(f"{start}{text}{end}".encode(page))
        assert (named.pous[0].variables()[0].comment, named.diagnostics[0].message.split()[8]) == (text, f"{page},")
    western = sfc.loads(f"{start}Zähler, Größe{end}".encode("cp1252"))
    assert "100% of its letters beyond ASCII are alone or in pairs" in western.diagnostics[0].message
    assert [each.code for each in western.diagnostics] == ["EXP200"]
    central = sfc.loads(f"{start}Błąd pompy, łącznik, żółty, główny, zawór{end}".encode("cp1250"))
    assert (
        "cp1250, which is a guess: 40% of its letters beyond ASCII are inside words with ł"
        in central.diagnostics[0].message
    )
    assert [each.code for each in central.diagnostics] == ["EXP200"]
    pasted = sfc.loads(start.encode() + "Größe".encode("cp1252") + " Zähler".encode() + end.encode())
    assert "in utf-8" in next(each.message for each in pasted.diagnostics if each.code == "EXP204")


@pytest.mark.parametrize(
    ("text", "page", "byte"),
    [
        ("счётчик деталей на ленте", "cp1251", b"\x98"),
        ("Błąd pompy, zamknięty zawór", "cp1250", b"\x81"),
        ("Zähler für Größe", "cp1252", b"\x81"),
        ("plain", "cp1252", b"\x81"),
    ],
)
@pytest.mark.parametrize("own", ["", "(* {{plcopen_sfc code_page := '{}'}} *)\r\n"], ids=["guessed", "named"])
def test_a_damaged_byte_does_not_change_the_code_page(text: str, page: str, byte: bytes, own: str) -> None:
    start, end = f"{HEADER}PROGRAM A\r\nVAR\r\n\tx:INT;\t(* ", " *)\r\nEND_VAR\r\nx := 1;\r\nEND_PROGRAM\r\n"
    data = f"{start}{text}, ".encode(page) + b"a" + byte + b"b" + f"{end}{own.format(page)}".encode()
    project = sfc.loads(data)
    assert (project.pous[0].variables()[0].comment or "").startswith(text)
    guessed = [each.message for each in project.diagnostics if each.code == "EXP200"]
    assert all(f"taken as {page}, which is a guess: " in message for message in guessed)
    assert bool(guessed) is not bool(own)
    (damage,) = [each for each in project.diagnostics if each.code != "EXP200"]
    assert f"the byte 16#{byte[0]:02X} is no character of the code page {page}" in damage.message
    assert (damage.code, damage.location.line, damage.location.column) == ("EXP205", 5, 12 + len(text) + 3)
    assert sfc.dumps(project) == data
    body = project.pous[0].body
    assert isinstance(body, m.StBody)
    body.text = "x := 2;"
    edited = sfc.dumps(project)
    assert b"a" + byte + b"b" in edited
    assert own or edited == data.replace(b"x := 1", b"x := 2")
    project.pous[0].variables()[0].comment = "\x80"
    with pytest.raises(sfc.SfcError, match="is not in the code page"):
        sfc.dumps(project)


@pytest.mark.parametrize("number", range(6))
def test_damaged_files_are_read_and_come_back(number: int) -> None:
    """A file that ends early, lacks a line, or has one twice: never an error of Python, and no byte is lost.

    `partial`, as an edit may not fit into such a text, and a transition that leads nowhere is not written again.
    """
    data = BELT.read_bytes()
    lines = data.splitlines(keepends=True)
    at = (number * 41 + 5) % len(lines)
    damaged = (
        data[: len(data) * (number + 1) // 7],
        b"".join(lines[:at] + lines[at + 1 :]),
        b"".join([*lines[:at], lines[at], *lines[at:]]),
    )
    for each in damaged:
        project = sfc.loads(each, format="codesys23")
        assert sfc.dumps(project) == each
        if project.pous:
            project.pous[0].comment = "neu"
            assert sfc.loads(sfc.dumps(project, partial=True), format="codesys23").pous[0].comment == "neu"


def test_instance_addresses_in_a_pou_are_told() -> None:
    section = "VAR_CONFIG\n\tMain.fb.y AT %QX0.0 : BOOL;\nEND_VAR\n"
    declared = f"PROGRAM Main\nVAR\n\tx : BOOL;\nEND_VAR\n{section}"
    project = sfc.loads(f"(* @PATH := '' *)\n{declared}(* @END_DECLARATION := '0' *)\nEND_PROGRAM\n".encode())
    (found,) = project.diagnostics
    assert (found.code, found.location.line) == ("EXP111", 6)
    assert "VAR_CONFIG" in found.message
    project.pous[0].variables()[0].comment = "kept"
    assert section.encode() in sfc.dumps(project)


@pytest.mark.slow
def test_a_file_that_is_cut_off_anywhere_tells_so() -> None:
    """Between objects nothing did, where pragmas or the comment behind a list were cut."""
    data = BELT.read_bytes()
    ends = [found.end() for found in re.finditer(rb"^(?:END_\w+|\*\)|\(\* @END_DECL.*?\*\))\r$", data, re.MULTILINE)]
    cuts = [*range(data.index(b"PROGRAM"), data.index(b"LIBRARY"), 17), data.index(b"NumOfGVLs"), len(data) - 5]
    for cut in cuts:
        project = sfc.loads(data[:cut], format="codesys23")
        told = {each.code for each in project.diagnostics} - {"EXP200"}
        is_between = any(end - 1 <= cut and not data[end:cut].strip() for end in ends)
        assert told or is_between, data[:cut][-60:]
        assert sfc.dumps(project) == data[:cut]


def test_steps_of_one_name_and_missing_ones_stay_in_the_text_of_a_chart() -> None:
    """An edit left the missing step out of the transition, and nothing told that."""
    steps = "INITIAL_STEP A:\nEND_STEP\nSTEP B:\nEND_STEP\nSTEP B:\nEND_STEP\n"
    moves = "TRANSITION FROM A TO (B,C):=\nTRUE\nEND_TRANSITION\nTRANSITION FROM (C,B) TO A:=\nTRUE\nEND_TRANSITION\n"
    moves += "TRANSITION FROM D TO A:=\nTRUE\nEND_TRANSITION\n"
    text = f"PROGRAM Main\nVAR\nEND_VAR\n(* @END_DECLARATION := '0' *)\n{steps}{moves}END_PROGRAM\n"
    project = sfc.loads(text.encode(), format="codesys23")
    codes = [each.code for each in project.diagnostics]
    assert codes == ["EXP106", "EXP105", "EXP105", "EXP105"]
    project.pous[0].chart.step("A").name = "Z"
    expected = text.replace("FROM A", "FROM Z").replace("TO A", "TO Z").replace("STEP A", "STEP Z")
    assert sfc.dumps(project, partial=True).decode() == expected


@pytest.mark.parametrize(
    ("action", "condition", "lines"),
    [
        ("q := ;", "a", [6]),
        ("q := a;\nq := b", "a", [7]),
        ("LD a\nST", "a", [7]),
        ("", "a AND", [8]),
        ("", "LD a\nAND( b", [9]),
        ("q := a;", "LD a\nAND( b\nOR c\n)", []),
    ],
)
def test_texts_in_charts_are_checked_like_those_of_programs(action: str, condition: str, lines: list[int]) -> None:
    parts = [
        "PROGRAM Main\nVAR\na, b, c, q : BOOL;\nEND_VAR\nINITIAL_STEP Wait:",
        *([action] if action else []),
        "END_STEP\nTRANSITION FROM Wait TO Wait:=",
        f"{condition}\nEND_TRANSITION\nEND_PROGRAM\n",
    ]
    data = "\n".join(parts).replace("\n", "\r\n").encode()
    project = sfc.loads(data, format="codesys23")
    found = [(each.code, each.location.line) for each in project.diagnostics]
    assert found == [("EXP110", line) for line in lines]
    assert sfc.dumps(project) == data
    if lines:
        with pytest.raises(sfc.DamagedSourceError):
            sfc.dumps(project, format="codesys")


LATER_WORDS = ("Continue", "JMP", "And_Then", "OR_ELSE", "Var_Stat")


@pytest.mark.parametrize("word", [*LATER_WORDS, "Property", "Final", "Union"])
def test_keywords_of_codesys_v3_are_names_here(word: str) -> None:
    declared = f"zz, {word} : INT;\n{word}_a, {word} AT %MW4 : INT; (* x *)\narr : ARRAY[0..3] OF INT;"
    declared = declared.replace(f"zz, {word} :", "zz :")
    body = """@ := zz + @ + 5;
arr[@ MOD 4] := -@;
IF @ > 3 AND zz = @ THEN @ := @ - arr[@ MOD 2]; END_IF;
FOR @ := @ TO 9 BY 2 DO zz := LIMIT(1, @, 2); IF @ = 7 THEN EXIT; END_IF; END_FOR
CASE @ OF 7: zz := (@); END_CASE
WHILE @ > 8 DO @ := 3; END_WHILE"""
    project = chart(body.replace("@", word), declared)
    assert not found(project)
    assert [*sfc.simulate(project, pou="Main", scans=1, record=["zz"])["zz"]] == [7]
    written, report = sfc.convert(project, "codesys")
    assert any(f"{word} is a keyword there" in each.why for each in report.items)
    assert [each.name for each in sfc.loads(written).pou("Main").variables()][2] == f"{word}_2"
    assert [each.name for each in sfc.loads(sfc.convert(project, "iec-text")[0]).pou("Main").variables()][2] == word
    project.rename(f"Main.{word}", "Other")
    assert word not in re.findall(r"\w+", sfc.dumps(project).decode())


@pytest.mark.parametrize("word", [*LATER_WORDS, "Method", "Property", "Type", "Reference", "Retain", "Abstract"])
def test_an_edit_of_a_variable_with_such_a_name_leaves_the_name(word: str) -> None:
    project = chart(f"{word} := 1;", f"a : INT;\n{word} : INT;")
    before = sfc.dumps(project).decode()
    project.pou("Main").variables()[1].comment = "counts"
    assert sfc.dumps(project).decode() == before.replace(f"{word} : INT;", f"{word} : INT; (* counts *)")


@pytest.mark.parametrize(
    "text",
    ["CONTINUE;", "JMP Mark;", "x := a AND_THEN b;", "x := a OR_ELSE NOT b;", "x := (a) OR_ELSE TRUE AND_THEN b;"],
)
def test_what_only_codesys_v3_compiles_is_no_name(text: str) -> None:
    source = "{plcopen_sfc format := 1}\n{plcopen_sfc project.dialect := 'codesys'}\nPROGRAM Main\n"
    source += f"VAR i : INT; x, a, b : BOOL; END_VAR\nFOR i := 1 TO 2 DO {text} END_FOR; Mark: ;\nEND_PROGRAM\n"
    project = sfc.loads(source.encode(), format="iec-text")
    assert not project.diagnostics
    _, report = sfc.convert(project, "codesys23", partial=True)
    assert any("CoDeSys 2.3 has no" in each.why for each in report.losses)


@pytest.mark.parametrize("data", [b"", b" \r\n\r\n"], ids=["empty", "blank"])
def test_an_empty_export_is_not_asked_for_as_xml(data: bytes, tmp_path: Path) -> None:
    """CoDeSys 2.3 exports no XML."""
    path = tmp_path / "export.EXP"
    path.write_bytes(data)
    with pytest.raises(FormatError) as caught:
        sfc.load(path)
    assert "Export" in caught.value.hint
    assert "XML" not in caught.value.hint
