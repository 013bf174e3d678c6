"""German for what comparisons tell: verdicts, what was not reached and why, and differences with their causes.

Such a text is composed: of clauses with "; " between, of lists, and of alternatives with " or ". So it is translated in
parts. Messages have places as `plcopen_sfc.pages.phrases` has them.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from plcopen_sfc.pages.phrases import Phrases

_HEADS = {
    ".. the row above {#} more time, up to scan {#}": ".. die Zeile darüber noch {} Mal, bis Zyklus {}",
    ".. the row above {#} more times, up to scan {#}": ".. die Zeile darüber noch {} Mal, bis Zyklus {}",
    ".. the {#} rows above {#} more time, up to scan {#}": ".. die {} Zeilen darüber noch {} Mal, bis Zyklus {}",
    ".. the {#} rows above {#} more times, up to scan {#}": ".. die {} Zeilen darüber noch {} Mal, bis Zyklus {}",
    ".. {#} rows are not shown here": ".. {} Zeilen sind hier nicht gezeigt",
    "equal": "gleich",
    "equal in {#} states": "gleich in {} Zuständen",
    "equal in {#} directed runs": "gleich in {} gerichteten Läufen",
    "equal in 1 state": "gleich in 1 Zustand",
    "equal in 1 directed run": "gleich in 1 gerichteten Lauf",
    "{+} in 1 state": "{} in 1 Zustand",
    "{+} in 1 directed run": "{} in 1 gerichteten Lauf",
    "{+} in {#} states": "{} in {} Zuständen",
    "{+} in {#} directed runs": "{} in {} gerichteten Läufen",
    "first {#} scan later": "das erste {} Zyklus später",
    "first {#} scans later": "das erste {} Zyklen später",
    "second {#} scan later": "das zweite {} Zyklus später",
    "second {#} scans later": "das zweite {} Zyklen später",
    "{+} (proof: {+})": "{} (Beweis: {})",
    "{+} (no proof: {+})": "{} (kein Beweis: {})",
    "1 state": "1 Zustand",
    "{#} states": "{} Zustände",
    "{#} states in {#} parts": "{} Zustände in {} Teilen",
    "1 scan": "1 Zyklus",
    "{#} scans": "{} Zyklen",
    "scan time {}": "Zykluszeit {}",
    "all inputs": "alle Eingänge",
    "all inputs tried for 1 scan": "alle Eingänge für 1 Zyklus versucht",
    "{+}, all inputs tried for 1 scan": "{}, alle Eingänge für 1 Zyklus versucht",
    "all inputs tried for {#} scans": "alle Eingänge für {} Zyklen versucht",
    "{+}, all inputs tried for {#} scans": "{}, alle Eingänge für {} Zyklen versucht",
    "no scan was run": "kein Zyklus wurde ausgeführt",
    "not all was reached ({+}), {+}": "nicht alles wurde erreicht ({}), {}",
    "not all was reached, {+}": "nicht alles wurde erreicht, {}",
    "not all was compared ({+}), {+}": "nicht alles wurde verglichen ({}), {}",
    "not all was compared, {+}": "nicht alles wurde verglichen, {}",
    "different after {#} scan ({+})": "verschieden nach {} Zyklus ({})",
    "different after {#} scans ({+})": "verschieden nach {} Zyklen ({})",
    "shortest input trace": "kürzeste Eingangsfolge",
    "an input trace": "eine Eingangsfolge",
    "compared with the {+}": "verglichen: {}",
    "not compared: not all of it is executed; change that in the source, or test it in {+}": (
        "nicht verglichen: nicht alles davon wird ausgeführt; ändern Sie das in der Quelle, oder testen Sie sie in {}"
    ),
    "not compared: in {+} it is no chart of an action, and its POU runs what is in its place": (
        "nicht verglichen: in {} ist sie keine Kette einer Aktion, und ihr Baustein führt aus, was an ihrer Stelle ist"
    ),
    "not compared: nothing in {+} has its name; test it there": (
        "nicht verglichen: in {} ist nichts mit diesem Namen; testen Sie sie dort"
    ),
    "without its search for stability: {+}": "ohne seine Suche nach Stabilität: {}",
    "with actions and transitions in the order of {}: {+}": (
        "mit Aktionen und Transitionen in der Reihenfolge von {}: {}"
    ),
    "under the rules of {}: {+}": "nach den Regeln von {}: {}",
    "types that nothing declares have the members that are used of them": (
        "Typen, die nichts deklariert, haben die Elemente, die von ihnen benutzt werden"
    ),
    "not compared: nothing declares the type `{}` of its variables; convert the file that does as well": (
        "nicht verglichen: nichts deklariert den Typ `{}` seiner Variablen; konvertieren Sie die Datei dazu, die es tut"
    ),
    "not compared: tasks are not run": "nicht verglichen: Tasks werden nicht ausgeführt",
    "not compared: it is only in one of the two": "nicht verglichen: es ist nur in einem von beiden",
    "not compared: no run ends and starts again": "nicht verglichen: kein Lauf endet und beginnt wieder",
    "not compared: no run shows at which terminal or in which memory a variable is": (
        "nicht verglichen: kein Lauf zeigt, an welcher Klemme oder in welchem Speicher eine Variable liegt"
    ),
    "not compared: it is run only where it is called, and nothing calls it": (
        "nicht verglichen: es läuft nur, wo es aufgerufen wird, und nichts ruft es auf"
    ),
    "not compared: the two have nothing in common that could be compared": (
        "nicht verglichen: die beiden haben nichts gemeinsam, was sich vergleichen ließe"
    ),
    "not compared: {&}": "nicht verglichen: {}",
    "not run: the time limit was reached": "nicht ausgeführt: das Zeitlimit war erreicht",
    "not run: the two have nothing in common that could be compared": (
        "nicht ausgeführt: die beiden haben nichts gemeinsam, was sich vergleichen ließe"
    ),
    "not run: {}": "nicht ausgeführt: {}",
    "what the report names as approximated is in it": "was der Bericht angenähert nennt, ist darin enthalten",
    "the same but for the inputs that actions see, and the first scan: {+}": (
        "dasselbe bis auf die Eingänge, die Aktionen sehen, und den ersten Zyklus: {}"
    ),
    "else {+}": "sonst {}",
    "it is not known to do the same": "ob es dasselbe tut, ist nicht bekannt",
    "only if something outside writes {}": "nur wenn etwas außerhalb {} schreibt",
    "while they keep their start values, both do the same": "solange sie ihre Startwerte behalten, tun beide dasselbe",
}
"""The first lines of verdicts."""

_REASONS = {
    "half of the time limit of {} s was reached": "die Hälfte des Zeitlimits von {} s war erreicht",
    "half of what was left of the time limit of {} s was reached": (
        "die Hälfte des Rests vom Zeitlimit von {} s war erreicht"
    ),
    "the time limit of {} s was reached": "das Zeitlimit von {} s war erreicht",
    "interrupted": "abgebrochen",
    "more than {#} states": "mehr als {} Zustände",
    "more than {#} scans to search": "mehr als {} Zyklen zu durchsuchen",
    "elapsed times of steps are used otherwise than in comparisons with constants": (
        "Zeiten von Schritten werden anders als in Vergleichen mit Konstanten verwendet"
    ),
    "all inputs were tried, but {+}": "alle Eingänge wurden versucht, aber {}",
    "both end with an error: {}": "beide enden mit einem Fehler: {}",
    "{} kept their values": "{} behielten ihre Werte",
    "{} at rest": "{} in Ruhe",
    "situations that never become stable are left out": "Situationen, die nie stabil werden, sind ausgelassen",
    "situations in which forcing orders contradict each other are left out": (
        "Situationen, in denen sich Zwangssteuerungen widersprechen, sind ausgelassen"
    ),
    "what follows {} is left out": "was auf {} folgt, ist ausgelassen",
    "REAL inputs are finite numbers": "REAL-Eingänge sind endliche Zahlen",
    "the first begins when the second has passed its initial step": (
        "das erste beginnt, wenn das zweite seinen Initialschritt verlassen hat"
    ),
    "no transition is tested in the first scan": "im ersten Zyklus wird keine Transition geprüft",
    "no transition is tested in the first scan, and {} at rest in it": (
        "im ersten Zyklus wird keine Transition geprüft, dabei {} in Ruhe"
    ),
    "actions of the first see the inputs and times of the scan before": (
        "Aktionen des ersten sehen die Eingänge und Zeiten des vorigen Zyklus"
    ),
    "actions of the second see the inputs and times of the scan before": (
        "Aktionen des zweiten sehen die Eingänge und Zeiten des vorigen Zyklus"
    ),
    "the first starts {#} scan later": "das erste beginnt {} Zyklus später",
    "the first starts {#} scans later": "das erste beginnt {} Zyklen später",
    "the second starts {#} scan later": "das zweite beginnt {} Zyklus später",
    "the second starts {#} scans later": "das zweite beginnt {} Zyklen später",
    "and until then {} at rest": "bis dahin {} in Ruhe",
    "{+}, and until then {} at rest": "{}, bis dahin {} in Ruhe",
    "the first scan of the first has no counterpart": "der erste Zyklus des ersten hat kein Gegenstück",
    "the first scan of the second has no counterpart": "der erste Zyklus des zweiten hat kein Gegenstück",
    "the first {#} scans of the first have no counterpart": "die ersten {} Zyklen des ersten haben kein Gegenstück",
    "the first {#} scans of the second have no counterpart": "die ersten {} Zyklen des zweiten haben kein Gegenstück",
    "only the first has {}": "nur das erste hat {}",
    "inputs that keep their values: {}": "Eingänge, die ihre Werte behalten: {}",
    "arrays of more than {#} elements are not compared: {}": (
        "Felder mit mehr als {} Elementen werden nicht verglichen: {}"
    ),
    "nothing of what they write is compared": "nichts von dem, was sie schreiben, wird verglichen",
    "results of {} may tell them apart, but none that was tried does": (
        "Ergebnisse von {} können sie unterscheiden, aber keines, das versucht wurde, tut es"
    ),
    "an input is used in a way that cannot be followed": (
        "ein Eingang wird so verwendet, dass es sich nicht verfolgen lässt"
    ),
    "{} is put out": "{} wird ausgegeben",
    "{} is a text": "{} ist ein Text",
    "{} can have no value": "{} kann keinen Wert haben",
    "{} is compared with {}": "{} wird mit {} verglichen",
    "{} is compared with more than {#} values": "{} wird mit mehr als {} Werten verglichen",
    "values of {} are compared with each other": "Werte von {} werden miteinander verglichen",
    "{} is used otherwise than in comparisons with constants": (
        "{} wird anders als in Vergleichen mit Konstanten verwendet"
    ),
    "{} is not known, and is called in other scans on both sides": (
        "{} ist nicht bekannt und wird auf beiden Seiten in anderen Zyklen aufgerufen"
    ),
    "{} is not known, and its value is of a type that is not known": (
        "{} ist nicht bekannt, und sein Wert hat einen unbekannten Typ"
    ),
    "{} is not known, and its value is no truth value": "{} ist nicht bekannt, und sein Wert ist kein Wahrheitswert",
    "too many terms are compared in a scan": "in einem Zyklus werden zu viele Terme verglichen",
    "terms are compared outside of a scan": "außerhalb eines Zyklus werden Terme verglichen",
    "too much is calculated in a scan": "in einem Zyklus wird zu viel berechnet",
    "a number that is calculated must be known": "eine berechnete Zahl muss bekannt sein",
    "a number is used together with what is no number": "eine Zahl wird mit etwas verwendet, was keine Zahl ist",
}
"""Why there is no proof, and what one holds for."""

_COVERAGE = {
    "{#} of {#} steps": "{} von {} Schritten",
    "{#} of {#} transitions": "{} von {} Transitionen",
    "{#} of {#} actions": "{} von {} Aktionen",
    "{#} of {#} assignments": "{} von {} Zuweisungen",
    "{#} of {#} parts of conditions": "{} von {} Teilen von Bedingungen",
    "{#} of {#} outcomes of comparisons": "{} von {} Ergebnissen von Vergleichen",
    "{#} of {#} outcomes of conditions": "{} von {} Ergebnissen von Bedingungen",
    "1 step": "1 Schritt",
    "1 transition": "1 Transition",
    "1 action": "1 Aktion",
    "1 assignment": "1 Zuweisung",
    "1 part of condition": "1 Teil einer Bedingung",
    "1 outcome of comparison": "1 Ergebnis eines Vergleichs",
    "1 outcome of condition": "1 Ergebnis einer Bedingung",
    "{#} steps": "{} Schritte",
    "{#} transitions": "{} Transitionen",
    "{#} actions": "{} Aktionen",
    "{#} assignments": "{} Zuweisungen",
    "{#} parts of conditions": "{} Teile von Bedingungen",
    "{#} outcomes of comparisons": "{} Ergebnisse von Vergleichen",
    "{#} outcomes of conditions": "{} Ergebnisse von Bedingungen",
    "nothing to be reached": "nichts zu erreichen",
    "covered: {+}": "erreicht: {}",
    "covered on both sides: {+}": "auf beiden Seiten erreicht: {}",
    "not reached for other reasons: {#}": "aus anderen Gründen nicht erreicht: {}",
    "not reached behind these steps: {+}": "hinter diesen Schritten nicht erreicht: {}",
    "unknown, taken as functions of what they are given: {}": (
        "unbekannt, als Funktionen dessen betrachtet, was sie bekommen: {}"
    ),
    "frozen, because nothing writes them and they are declared as no inputs: {}": (
        "unverändert, weil nichts sie schreibt und sie nicht als Eingänge deklariert sind: {}"
    ),
    "{+} (proven)": "{} (bewiesen)",
    "unreachable": "nicht erreichbar",
    "can never fire": "kann nie schalten",
    "no transition leads to it from what was reached": "keine Transition führt vom Erreichten dorthin",
    "{+}, never reached": "{}, nie erreicht",
    "needs {&}, never reached": "braucht {}, nie eingetreten",
    "needs the condition of {}, never reached": "braucht die Bedingung von {}, nie eingetreten",
    "needs {&}, never TRUE": "braucht {}, nie TRUE",
    "needs step {}, never entered": "braucht Schritt {}, nie aktiviert",
    "needs step {}, unreachable": "braucht Schritt {}, nicht erreichbar",
    "needs the event R1, which nothing registers": "braucht das Ereignis R1, das nichts registriert",
    "step {} only resets it": "Schritt {} setzt sie nur zurück",
    "step {} never executed it": "Schritt {} hat sie nie ausgeführt",
    "step {} never executed it, needs {+}": "Schritt {} hat sie nie ausgeführt, braucht {}",
    "{} to pass ({})": "Ablauf von {} ({})",
    "the event {}": "das Ereignis {}",
    "step {} is left before {} has passed": "Schritt {} wird verlassen, bevor {} abgelaufen ist",
    "its time {} is over at once": "ihre Zeit {} ist sofort vorbei",
    "the code around it is never executed": "worin sie steht, wird nie ausgeführt",
    "the code around it was not executed": "worin sie steht, wurde nicht ausgeführt",
    "was never executed": "wurde nie ausgeführt",
    "{}: action in place": "{}: Aktion an Ort und Stelle",
    "{}: entry action": "{}: Eingangsaktion",
    "{}: main action": "{}: Hauptaktion",
    "{}: exit action": "{}: Ausgangsaktion",
    "is never {}": "ist nie {}",
    "was never {}": "war nie {}",
    "was never {}, as {} kept its value (frozen)": "war nie {}, da {} seinen Wert behielt",
    "was never {}, as {} kept their values (frozen)": "war nie {}, da {} ihre Werte behielten",
    "can never decide it": "kann nie entscheiden",
    "never decided it": "hat nie entschieden",
    "never decided it, as {} kept its value (frozen)": "hat nie entschieden, da {} seinen Wert behielt",
    "never decided it, as {} kept their values (frozen)": "hat nie entschieden, da {} ihre Werte behielten",
}
"""Coverage: reached, not reached, and why."""

_DIFFERENCES = {
    "{} is {} in the first and {} in the second": "{} ist {} im ersten und {} im zweiten",
    "{} is {} in the first {#} scan before and {} in the second": (
        "{} ist {} im ersten {} Zyklus zuvor und {} im zweiten"
    ),
    "{} is {} in the first {#} scans before and {} in the second": (
        "{} ist {} im ersten {} Zyklen zuvor und {} im zweiten"
    ),
    "{} is {} in the first and {} in the second {#} scan before": (
        "{} ist {} im ersten und {} im zweiten {} Zyklus zuvor"
    ),
    "{} is {} in the first and {} in the second {#} scans before": (
        "{} ist {} im ersten und {} im zweiten {} Zyklen zuvor"
    ),
    "{} is {} in the source and {} in {+}": "{} ist {} in der Quelle und {} in {}",
    "{} is {} in the source {#} scan before and {} in {+}": "{} ist {} in der Quelle {} Zyklus zuvor und {} in {}",
    "{} is {} in the source {#} scans before and {} in {+}": "{} ist {} in der Quelle {} Zyklen zuvor und {} in {}",
    "{} is {} in the source and {} in {+} {#} scan before": "{} ist {} in der Quelle und {} in {} {} Zyklus zuvor",
    "{} is {} in the source and {} in {+} {#} scans before": "{} ist {} in der Quelle und {} in {} {} Zyklen zuvor",
    "{} differs, too": "auch {} ist anders",
    "{&} differ, too": "auch {} sind anders",
    "a cause is the {+}, which the report names": "eine Ursache nennt der Bericht: {}",
    "a cause is the {+} at {+}, which the report names": "eine Ursache nennt der Bericht: {} bei {}",
    "{+}: tools have an order of their own for what writes a variable in one scan": (
        "{}: Werkzeuge haben ihre eigene Reihenfolge für das, was in einem Zyklus eine Variable schreibt"
    ),
    "look at {+}": "siehe {}",
    "{#} more": "{} weitere",
    "step {}": "Schritt {}",
    "transition {}": "Transition {}",
    "action in place": "Aktion an Ort und Stelle",
    "action {}": "Aktion {}",
    "action in place of step {}": "Aktion an Ort und Stelle von Schritt {}",
    "entry action of step {}": "Eingangsaktion von Schritt {}",
    "main action of step {}": "Hauptaktion von Schritt {}",
    "exit action of step {}": "Ausgangsaktion von Schritt {}",
    "{} is written {+} in the source and {+} in {+}": "{} wird {} in der Quelle und {} in {} geschrieben",
    "in every scan": "in jedem Zyklus",
    "only while its action is executed": "nur während der Ausführung seiner Aktion",
    "only while an association decides on it": "nur wenn eine Aktionszuordnung darüber entscheidet",
    "`{#}` stays {}": "`{}` {} bleibt",
    "while {+}, both are {+}: {+}": "solange {}, sind beide {}: {}",
    "while {+}, both are {+} (proof: {+}): {+}": "solange {}, sind beide {} (Beweis: {}): {}",
    "while {+}, both are {+} (no proof: {+}): {+}": "solange {}, sind beide {} (kein Beweis: {}): {}",
    "while {+}: {+}": "solange {}: {}",
    "equal as far as they ran": "gleich, soweit sie liefen",
    "tools differ in when they take up a new time of an action that runs": (
        "wann die neue Zeit einer laufenden Aktion gilt, ist anders"
    ),
    "{} executes the actions before the transitions, and so sees other inputs in them": (
        "{} führt die Aktionen vor den Transitionen aus und sieht darin andere Eingänge"
    ),
    "the source executes the actions before the transitions, and so sees other inputs in them": (
        "die Quelle führt die Aktionen vor den Transitionen aus und sieht darin andere Eingänge"
    ),
    "{} tests no transition in its first scan": "{} prüft im ersten Zyklus keine Transition",
    "the start is no activation of the initial step in the source: what begins with that is not executed": (
        "der Start ist in der Quelle keine Aktivierung des Anfangsschritts: was damit beginnt, wird nicht ausgeführt"
    ),
    "the start is no activation of the initial step in {}: what begins with that is not executed": (
        "der Start ist in {} keine Aktivierung des Anfangsschritts: was damit beginnt, wird nicht ausgeführt"
    ),
    "the source tests no transition in its first scan": "die Quelle prüft im ersten Zyklus keine Transition",
}
"""Differences and their causes."""

_HEAD = {"scan": "Zyklus", "time": "Zeit", "first: ": "erstes: ", "second: ": "zweites: ", "active": "aktiv"}
"""Columns of the table of a difference."""
_COLUMNS = re.compile(r"^scan|(?<=^scan  )time|(?<=  )(?:first|second): |(?<=first: )active\b|(?<=second: )active\b")
_CODE = re.compile("`[^`]*`")
_NUMBERED = re.compile(r"`(\d+)`")
_MISSED = re.compile(
    "not reached: (step|transition|action|assignment|part of condition|outcome of comparison|outcome of condition)(s?) "
    "(.+): ([^:]+)",
    re.DOTALL,
)
_DECIDED = re.compile(
    "not reached: (transition|assignment|condition) (.+) "
    "((?:is|was) never (?:TRUE|FALSE).*|can never decide it.*|never decided it.*|the code around it .*|needs [^:]*)",
    re.DOTALL,
)
_OTHERWISE = re.compile(r"it does something else after (\d+) scan(s?): (.+)", re.DOTALL)
_MORE = re.compile(r" and (\d+) more$")
_MISSED_KINDS = {
    "step": ("Schritt", "Schritte"),
    "transition": ("Transition", "Transitionen"),
    "action": ("Aktion", "Aktionen"),
    "assignment": ("Zuweisung", "Zuweisungen"),
    "condition": ("Bedingung", "Bedingungen"),
    "part of condition": ("Teil einer Bedingung", "Teile von Bedingungen"),
    "outcome of comparison": ("Ergebnis eines Vergleichs", "Ergebnisse von Vergleichen"),
    "outcome of condition": ("Ergebnis einer Bedingung", "Ergebnisse von Bedingungen"),
}


class Verdicts:
    """German for lines of verdicts and reasons of them. `other` translates what is in it besides, such as tools."""

    def __init__(self, other: Callable[[str], str]) -> None:
        self._other = other
        table = {**_HEADS, **_REASONS, **_COVERAGE, **_DIFFERENCES}
        self._phrases = Phrases(table, self._clauses)

    def __call__(self, line: str) -> str:
        """Return a line in German, code in backquotes as it is; what is not known stays English."""
        if line.startswith("scan  time"):  # the head of a table
            return _COLUMNS.sub(lambda found: _HEAD[found[0]], line)
        codes: list[str] = []

        def number(found: re.Match[str]) -> str:
            codes.append(found[0])
            return f"`{len(codes) - 1}`"

        told = self._clauses(_CODE.sub(number, line))
        return _NUMBERED.sub(lambda found: codes[int(found[1])], told)

    def _clauses(self, text: str) -> str:
        return "; ".join(self._clause(clause) or self._other(clause) for clause in _divided(text, "; "))

    def _clause(self, text: str) -> str | None:
        """Return a clause in German; None where it is not known."""
        if found := _DECIDED.fullmatch(text):
            return f"nicht erreicht: {_MISSED_KINDS[found[1]][0]} {found[2]} {self._clauses(found[3])}"
        if found := _MISSED.fullmatch(text):
            names = _MORE.sub(r" und \1 weitere", found[3])
            if found[1] == "action":
                names = ", ".join(map(self._phrases, names.split(", ")))
            return f"nicht erreicht: {_MISSED_KINDS[found[1]][bool(found[2])]} {names}: {self._clauses(found[4])}"
        if found := _OTHERWISE.fullmatch(text):
            return f"es tut nach {found[1]} Zyk{'len' if found[2] else 'lus'} etwas anderes: {self._clauses(found[3])}"
        lists = (self._listed(text, mark, german) for mark, german in _MARKS)
        return next(filter(None, lists), None) or self._phrases.find(text)

    def _listed(self, text: str, mark: str, german: str) -> str | None:
        """Return a list in German; None where it is none, or something in it is not known."""
        parts = _divided(text, mark)
        told = [self._clause(part) for part in parts] if len(parts) > 1 else [None]
        return None if None in told else german.join(filter(None, told))


_MARKS = ((" or ", " oder "), (" and ", " und "), (", ", ", "))


def _divided(text: str, mark: str) -> list[str]:
    """Return the parts that a mark divides outside of parentheses."""
    parts, depth = [""], 0
    for piece in re.split(rf"([()]|{mark})", text):
        depth += {"(": 1, ")": -1}.get(piece, 0)
        if piece == mark and depth <= 0:
            parts.append("")
        else:
            parts[-1] += piece
    return parts
