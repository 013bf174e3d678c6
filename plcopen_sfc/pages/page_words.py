"""The words of pages in English and German. What comes from the project is shown as it is there."""

from __future__ import annotations

from plcopen_sfc.errors import ModelError, check_argument, nearest

_GERMAN = {
    "{} scans of {}, executed as in {}": "{} Zyklen von {}, ausgef\u00fchrt wie in {}",
    "Actions": "Aktionen",
    "Address": "Adresse",
    "Charts": "Ablaufketten",
    "Comment": "Kommentar",
    "Contents": "Inhalt",
    "Data types": "Datentypen",
    "Differences": "Unterschiede",
    "Declarations": "Deklarationen",
    "Findings": "Befunde",
    "Format": "Format",
    "Global variables": "Globale Variablen",
    "Initial value": "Anfangswert",
    "Name": "Name",
    "Permanent instructions": "permanente Anweisungen",
    "Project": "Projekt",
    "Report": "Bericht",
    "Run in both tools": "In beiden Werkzeugen ausgef\u00fchrt",
    "Search": "Suche",
    "Search (key /)": "Suche (Taste /)",
    "Section": "Bereich",
    "Simulation": "Simulation",
    "Step": "Schritt",
    "Steps": "Schritte",
    "Tag tables": "Variablentabellen",
    "Tags": "Variablen",
    "Tasks": "Tasks",
    "Tool": "Werkzeug",
    "Transitions": "Transitionen",
    "Type": "Typ",
    "Used in": "Verwendet in",
    "Values": "Werte",
    "a body in a form that is kept but not read": "ein Rumpf in einer Form, die erhalten, aber nicht gelesen wird",
    "action": "Aktion",
    "and {} more": "und {} weitere",
    "approximated": "angen\u00e4hert",
    "chart": "Ablaufkette",
    "condition missing": "Bedingung fehlt",
    "data block": "Datenbaustein",
    "dropped": "weggelassen",
    "error": "Fehler",
    "every {}": "alle {}",
    "extension data": "Erweiterungsdaten",
    "function": "Funktion",
    "function block": "Funktionsbaustein",
    "info": "Hinweis",
    "interlock": "Verriegelung",
    "kept": "erhalten",
    "line {}": "Zeile {}",
    "maximum time": "maximale Zeit",
    "method": "Methode",
    "minimum time": "minimale Zeit",
    "no differences": "keine Unterschiede",
    "no such chart": "keine solche Ablaufkette",
    "not executed": "nicht ausgef\u00fchrt",
    "nothing found": "nichts gefunden",
    "nothing was written": "es wurde nichts geschrieben",
    "one change back": "eine \u00c4nderung zur\u00fcck",
    "one change on": "eine \u00c4nderung weiter",
    "organization block": "Organisationsbaustein",
    "play": "abspielen",
    "priority {}": "Priorit\u00e4t {}",
    "program": "Programm",
    "supervision": "\u00dcberwachung",
    "the whole width": "ganze Breite",
    "translated": "\u00fcbersetzt",
    "transition": "Transition",
    "warning": "Warnung",
    "warning time": "Warnzeit",
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
        text = _GERMAN[english] if self.lang == "de" else english
        return text.format(*values) if values else text
