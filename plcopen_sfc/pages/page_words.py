"""The words of pages in English and German. What comes from the project is shown as it is there."""

from __future__ import annotations

from plcopen_sfc.errors import ModelError, check_argument, nearest
from plcopen_sfc.pages.report_words import GERMAN, german, german_place, german_verdict
from plcopen_sfc.pages.rule_words import german_finding

_GERMAN = {
    "(excluded)": "(ausgenommen)",
    "(logic)": "(Logik)",
    "(no condition)": "(keine Bedingung)",
    "(not wired)": "(nicht angeschlossen)",
    "Actions": "Aktionen",
    "Add what declares these names": "Erg\u00e4nzen, was diese Namen deklariert",
    "Add these data types": "Diese Datentypen erg\u00e4nzen",
    "Address": "Adresse",
    "Charts": "Ablaufketten",
    "Comment": "Kommentar",
    "Connect these variables to inputs and outputs": "Diese Variablen mit Ein- und Ausg\u00e4ngen verbinden",
    "Contents": "Inhalt",
    "Continues at {}": "Weiter bei {}",
    "Correct these program texts": "Diese Programmtexte korrigieren",
    "Create a task that calls this program": "Eine Task anlegen, die dieses Programm aufruft",
    "Create the task and call its programs": "Die Task anlegen und ihre Programme aufrufen",
    "Data types": "Datentypen",
    "Decide who operates these inputs (--at-rest)": "Entscheiden, wer diese Eing\u00e4nge bedient (--at-rest)",
    "Declarations": "Deklarationen",
    "Differences": "Unterschiede",
    "Enclosing step": "Einschlie\u00dfender Schritt",
    "Date": "Datum",
    "Files": "Dateien",
    "Findings": "Befunde",
    "From {}": "Von {}",
    "Function block diagram": "Funktionsplan",
    "Global variables": "Globale Variablen",
    "Import into {} and compile: not tried yet": "In {} importieren und \u00fcbersetzen: noch nicht versucht",
    "Initial enclosing step": "Einschlie\u00dfender Initialschritt",
    "Initial macro-step": "Makroschritt am Anfang",
    "Initial step": "Initialschritt",
    "Initial value": "Anfangswert",
    "Jump to {}": "Sprung zu {}",
    "Ladder diagram": "Kontaktplan",
    "Look at what differs": "Ansehen, was anders ist",
    "Losses": "Verluste",
    "Macro-step": "Makroschritt",
    "Make these variables retentive": "Diese Variablen remanent machen",
    "Name": "Name",
    "Permanent instructions": "Permanente Anweisungen",
    "Program the supervision of these times": "Die \u00dcberwachung dieser Zeiten programmieren",
    "Program these actions as blocks, and call them": "Diese Aktionen als Bausteine programmieren und aufrufen",
    "Program these conditions": "Diese Bedingungen programmieren",
    "Program these methods as blocks": "Diese Methoden als Bausteine programmieren",
    "Program what is not executed": "Programmieren, was nicht ausgef\u00fchrt wird",
    "Program what these SFC flags control": "Programmieren, was diese SFC-Flags steuern",
    "Project": "Projekt",
    "Replace this data type": "Diesen Datentyp ersetzen",
    "Report": "Bericht",
    "Run in both tools": "In beiden Werkzeugen ausgef\u00fchrt",
    "Search (key /)": "Suche (Taste /)",
    "Search": "Suche",
    "Section": "Bereich",
    "Sequential function chart": "Ablaufkette",
    "Set the cycle time of the task": "Die Zykluszeit der Task einstellen",
    "Set these start values": "Diese Startwerte eintragen",
    "Simulation": "Simulation",
    "Source": "Quelle",
    "Source transitions": "Quelltransitionen",
    "Step": "Schritt",
    "Step by step": "Schritt f\u00fcr Schritt",
    "Steps": "Schritte",
    "Tag tables": "Variablentabellen",
    "Tags": "Variablen",
    "Target": "Ziel",
    "Tasks": "Tasks",
    "Test the charts that were not shown to do the same": "Die Ablaufketten testen, deren Gleichheit nicht gezeigt ist",
    "Test the machine": "Die Maschine testen",
    "Timing diagram: {} scans of {}": "Zeitdiagramm: {} Zyklen von {}",
    "To do": "Zu tun",
    "Tool": "Werkzeug",
    "Transition {}": "Transition {}",
    "Transitions": "Transitionen",
    "Type": "Typ",
    "Used in": "Verwendet in",
    "Values": "Werte",
    "Verdict": "Urteil",
    "nowhere -> {}": "von nirgends -> {}",
    "{} -> nowhere": "{} -> nirgendwohin",
    "{} scans of {}, under the execution profile {}": "{} Zyklen von {}, nach dem Ausf\u00fchrungsprofil {}",
    "a body in a form that is kept but not read": "ein Rumpf in einer Form, die erhalten, aber nicht gelesen wird",
    "after {} too": "zugleich nach {}",
    "and {} more": "und {} weitere",
    "assignment": "Zuweisung",
    "outcome of comparison": "Ergebnis eines Vergleichs",
    "outcome of condition": "Ergebnis einer Bedingung",
    "part of condition": "Teil einer Bedingung",
    "approximated": "angen\u00e4hert",
    "conditional": "bedingt",
    "charts": "Ablaufketten",
    "condition missing": "Bedingung fehlt",
    "delayed": "verz\u00f6gert",
    "the same but for the scan of inputs": "gleich bis auf den Zyklus der Eingänge",
    "differs": "verschieden",
    "dropped": "weggelassen",
    "enclosed": "eingeschlossen",
    "encloses": "schlie\u00dft ein",
    "entry": "Eingangsaktion",
    "error": "Fehler",
    "every {}": "alle {}",
    "excluded": "ausgenommen",
    "exit": "Ausgangsaktion",
    "format": "Format",
    "expansion": "Expansion",
    "extension data": "Erweiterungsdaten",
    "external": "extern",
    "falling edge of {}": "fallende Flanke von {}",
    "forcing": "zwangssteuernd",
    "function block": "Funktionsbaustein",
    "function": "Funktion",
    "global": "global",
    "in_out": "Ein- und Ausgang",
    "info": "Hinweis",
    "input": "Eingang",
    "kept": "erhalten",
    "limited": "zeitbegrenzt",
    "line {}": "Zeile {}",
    "local": "lokal",
    "macro": "Makroschritt",
    "main": "Hauptaktion",
    "never possible": "nie m\u00f6glich",
    "not reached": "nicht erreicht",
    "no differences": "keine Unterschiede",
    "no such chart": "keine solche Ablaufkette",
    "not all was reached": "nicht alles wurde erreicht",
    "not compared": "nicht verglichen",
    "not executed": "nicht ausgef\u00fchrt",
    "nothing found": "nichts gefunden",
    "nothing was written": "es wurde nichts geschrieben",
    "on activation": "bei Aktivierung",
    "on deactivation": "bei Deaktivierung",
    "on event": "bei Ereignis",
    "one change back": "eine \u00c4nderung zur\u00fcck",
    "one change on": "eine \u00c4nderung weiter",
    "organization block": "Organisationsbaustein",
    "output": "Ausgang",
    "play": "abspielen",
    "priority {}": "Priorit\u00e4t {}",
    "rising edge of {}": "steigende Flanke von {}",
    "temp": "tempor\u00e4r",
    "the same": "gleich",
    "the same, a scan later": "gleich, einen Zyklus sp\u00e4ter",
    "written as it is, in the terms of the target": "so geschrieben, wie es ist, mit den Mitteln des Ziels",
    "written in other terms that do the same": "mit anderen Mitteln geschrieben, die dasselbe tun",
    "executed otherwise in the target: the reason names the difference": (
        "im Ziel anders ausgef\u00fchrt: der Grund nennt den Unterschied"
    ),
    "executed in the source, and not in the target": "in der Quelle ausgef\u00fchrt, im Ziel nicht",
    "kept in the file for the way back: no machine executes it": (
        "f\u00fcr den R\u00fcckweg in der Datei erhalten: keine Maschine f\u00fchrt es aus"
    ),
    "not in the written file": "nicht in der geschriebenen Datei",
    "fit / full size": "einpassen / volle Gr\u00f6\u00dfe",
    "Converted by": "Umgewandelt mit",
    "translated": "\u00fcbersetzt",
    "warning": "Warnung",
}


class Words:
    """The words of one language: ``en`` or ``de``. Raises `ModelError` for another."""

    def __init__(self, lang: str) -> None:
        check_argument(lang, str, "the language of a page is a text")
        if lang not in ("en", "de"):
            raise ModelError(f"pages have no language {lang!r}{nearest(lang, ('en', 'de'))}", hint="There are: en, de")
        self.lang = lang

    def __call__(self, english: str, *values: object) -> str:
        """Return the words, with `values` in their places."""
        text = (_GERMAN.get(english) or GERMAN[english]) if self.lang == "de" and english else english
        return text.format(*values) if values else text

    def heading(self, english: str) -> str:
        """Return words that begin with a capital letter."""
        text = self(english)
        return text[:1].upper() + text[1:]

    def message(self, english: str) -> str:
        """Return a message of a report; English where no translation of it is known."""
        return german(english) if self.lang == "de" else english

    def verdict(self, english: str) -> str:
        """Return a line of a verdict, or why something was not reached; English where no translation is known."""
        return german_verdict(english) if self.lang == "de" else english

    def place(self, path: str) -> str:
        """Return a path of a report: names as they are, the kinds of things in the language of the page."""
        return german_place(path) if self.lang == "de" else path

    def finding(self, english: str) -> str:
        """Return the message or the hint of a finding; English where no translation of it is known."""
        return german_finding(english) if self.lang == "de" else english
