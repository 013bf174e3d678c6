"""Lines of verdicts in German: whole sentences, whatever they are composed of, and code as it is."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.pages.phrases import german_table, german_tables

ENGLISH = re.compile(
    r"\b(?:the|and|or|of|is|are|which|needs?|never|not|reached|with|has|have|both|first|second|different|after|scans?|equal)\b"
)
"""English words that are neither German nor, in capitals, operators of code."""
LINES = (
    "given: situations in which forcing orders contradict each other are left out",
    "given: situations that never become stable are left out",
    "given: OFF_SQ, INIT_SQ at rest",
    "given: `cmd` written from outside as well",
    "given: actions of the second see the inputs and times of the scan before",
    "not reached: condition FC_Count: `x`: `n = 1` the code around it was not executed (proven)",
    "not reached: condition `x` needs `y`, never reached",
    "not reached: outcome of condition `x`: `y`: needs `Drill.x`, never reached",
    "equal (proof: 5 states, all inputs, scan time T#500ms)",
    "equal, second 1 scan later (proof: 5 states in 2 parts, all inputs, scan time T#500ms)",
    "given: the first scan of the second has no counterpart",
    "given: the second starts 2 scans later, and until then A, B at rest",
    "given: no transition is tested in the first scan, and A, B at rest in it",
    "not all was reached (1 step, 2 transitions), equal in 5 states, scan time T#1s (no proof: half of the time limit "
    "of 2 s was reached)",
    "no proof: elapsed times of steps are used otherwise than in comparisons with constants, all inputs tried for 7 "
    "scans",
    "not all steps are reached, equal (proof: 1 state, all inputs)",
    "with `cmd` written from outside as well: different after 2 scans (shortest input trace)",
    "no scan was run (no proof: the time limit of 2 s was reached)",
    "not all was reached, equal in 4 directed runs, 800 scans (no proof: more than 1,000 states)",
    "equal, first 1 scan later in 3 directed runs, 30 scans, scan time T#1ms (no proof: A is a text)",
    "different after 2 scans (shortest input trace, scan time T#250ms)",
    "different after 2 scans (an input trace, compared with the first 1 scan later, scan time T#250ms)",
    "what the report names as approximated is in it",
    "different after 2 scans; the same but for the inputs and times that actions see, and the first scan",
    "but for these: equal, second 1 scan later (proof: 5 states, all inputs)",
    "given: for the difference scans of T#10ms",
    "given: times that actions and transitions wait for were not compared in all situations",
    "with actions and transitions in the order of the source: equal (proof: 5 states, all inputs)",
    "given: the source is the grafcet from which its file was converted, and not what codesys executes of it "
    "(--as-tool)",
    "given: not reached with scans of T#5ms",
    "given: what calls it was not compared in all situations: POU Main",
    "given: what calls it was run with scans of T#5ms, T#10ms: POU Main",
    "in what both come to while inputs stay: equal (proof: 5 states, all inputs)",
    "given: compared is what both come to while the inputs of a scan stay, which they do until both rest",
    "given: compared is what both come to while the inputs of a scan stay",
    "where both test no transition of a chart in the scan that calls it first: equal (proof: 5 states, all inputs)",
    "given: scans of a side that is ahead of the other wait, and so do inputs until both rest",
    "given: what never rests with inputs that stay is left out",
    "not reached: step Release: needs `xQuit or b and c; d`, never reached",
    "not reached: steps A, B and 3 more: no transition leads to it from what was reached",
    "not reached: assignment F.x: y := 1: needs `a: b` and `c`, never TRUE (proven)",
    "not reached: action M: step A never executed it, needs `x` and T#2s to pass (D) and the event S1",
    "not reached: action M: needs step A, never entered or step B only resets it (proven)",
    "not reached: transition A -> B: `x` was never TRUE, as z kept its value (frozen)",
    "not reached: condition `x`: `y` can never decide it (proven)",
    "not reached: assignment `q := a > b` is never FALSE (proven)",
    "not reached for other reasons: 5",
    "not reached behind these steps: 2 steps, 1 transition",
    "covered on both sides: 5 of 6 steps, 4 of 6 transitions, 1 of 1 actions",
    "covered: 5 of 6 steps; 3 of 3 assignments, 4 of 4 outcomes of comparisons",
    "unreachable (proven)",
    "needs the event R1, which nothing registers (proven)",
    "needs `a AND b`, never reached (proven)",
    "needs `a`, never reached or needs the condition of T1, never reached",
    "it does something else after 3 scans: M is TRUE in the source and FALSE in CODESYS; A, B and 3 more "
    "differ, too; the cause is not known: look at transition A -> B, action X and action in place of step C: tools "
    "have an order of their own for what writes a variable in one scan",
    "it does something else after 3 scans: M is TRUE in the source and FALSE in CODESYS; the cause is not known",
    "it does something else after 3 scans: M is TRUE in the source and FALSE in CODESYS; CODESYS executes the actions "
    "of a scan in another order; the source fires all transitions together that can leave a step; CODESYS executes an "
    "action once more after its step is left; CODESYS writes variables that are actions at other times",
    "it does something else after 1 scan: M is TRUE in the source 1 scan before and FALSE in CODESYS; B "
    "differs, too; the source tests no transition in its first scan",
    "it does something else after 2 scans: M is TRUE in the source and FALSE in CODESYS; a cause is the "
    "condition of the transition at transition A -> B, which the report names; while `t` stays T#1s and "
    "`u` stays T#2s, both are equal (proof: 5 states, all inputs): tools differ in when they take up a "
    "new time of an action that runs",
    "it does something else after 1 scan: S1.X is TRUE in the source and FALSE in CODESYS; S2 differs, too; the "
    "cause is not known: look at transition S1 -> S2",
    "with actions and transitions in the order of TIA Portal: equal, first 1 scan later (proof: 14 states, all inputs)",
    "under the rules of beremiz: equal (proof: 5 states, all inputs)",
    "without its search for stability: equal (proof: 5 states, all inputs)",
    "where it passes no step: equal, second 1 scan later (proof: 7 states, all inputs)",
    "types that nothing declares have the members that are used of them",
    "not compared: it is only in one of the two",
    "only if something outside writes a, b; while they keep their start values, both do the same",
    "M is written in every scan in the source and only while its action is executed in CODESYS",
    "not compared: a, b and 3 more",
    "can never fire (proven)",
)


def english_in(text: str) -> list[str]:
    """The English words of a text, without those in code."""
    return ENGLISH.findall(re.sub("`[^`]*`", "", text))


@pytest.mark.parametrize("line", LINES)
def test_a_line_is_german_but_for_its_code(line: str) -> None:
    told = Words("de").verdict(line)
    assert english_in(told) == []
    assert re.findall("`[^`]*`", told) == re.findall("`[^`]*`", line)
    assert Words("en").verdict(line) == line


def test_a_tool_in_a_heading_is_in_the_nominative() -> None:
    assert Words("de")("tools that read the text") == "Werkzeuge für Text"
    assert Words("de")("CODESYS") == Words("en")("CODESYS") == "CODESYS"


def test_a_line_is_a_sentence() -> None:
    words = Words("de")
    told = words.verdict(
        "not all was reached (1 step), equal in 9 states, scan time T#1s "
        "(no proof: half of the time limit of 2 s was reached)"
    )
    assert told == (
        "nicht alles wurde erreicht (1 Schritt), gleich in 9 Zuständen, Zykluszeit T#1s "
        "(kein Beweis: die Hälfte des Zeitlimits von 2 s war erreicht)"
    )
    assert words.message("it does something else after 1 scan: M is TRUE in the source and FALSE in CODESYS") == (
        "es tut nach 1 Zyklus etwas anderes: M ist TRUE in der Quelle und FALSE in CODESYS"
    )
    assert words.verdict("scan  time  x  first: active  second: x") == "Zyklus  Zeit  x  erstes: aktiv  zweites: x"
    why = "not compared: not all of it is executed; change that in the source, or test it in CODESYS"
    assert words.verdict(why) == (
        "nicht verglichen: nicht alles davon wird ausgeführt; "
        "ändern Sie das in der Quelle, oder testen Sie sie in CODESYS"
    )
    assert words.verdict("more than 2,000 states") == "mehr als 2.000 Zustände"
    told = words.verdict("after 1000 evolutions with the same inputs transitions are still cleared")
    assert told == "nach 1000 Evolutionen mit denselben Eingängen schalten noch Transitionen"
    # names that are words of lists, and what is not known, stay as they are
    assert words.verdict("not compared: time, step and 2 more") == "nicht verglichen: time, step und 2 weitere"


TABLES = Path(__file__).resolve().parents[2] / "plcopen_sfc" / "pages" / "german"


@pytest.mark.parametrize("file", sorted(TABLES.iterdir()), ids=lambda file: file.stem)
def test_tables_have_each_message_once_and_german_with_values_that_it_has(file: Path) -> None:
    entries: list[tuple[str, str]] = []
    json.loads(file.read_text(encoding="utf-8"), object_pairs_hook=entries.extend)
    messages = [(english, german) for english, german in entries if isinstance(german, str)]
    assert len(messages) == len({english for english, _ in messages}) > 100
    assert sum(map(len, german_tables(file.stem).values())) == len(messages)
    for english, german in messages:
        german.format(*["value"] * len(re.findall(r"\{[+|&#.]?\}", english)))  # it asks for no value that there is not


def test_a_message_has_one_german_in_all_tables() -> None:
    told: dict[str, set[str]] = {}
    for english, german in (each for name in MESSAGES for each in german_table(name).items()):
        told.setdefault(english, set()).add(german)
    assert {english: german for english, german in told.items() if len(german) > 1} == {}


MESSAGES = ("reports", "rules", "runs", "verdicts")
