"""Titles, comments and names of lowered sequencers, besides those of all lowered code, in English and German."""

from __future__ import annotations

from collections.abc import Mapping

from plcopen_sfc.lowering.code_texts import GermanTexts, Texts


class GraphTexts:
    """English texts. `language` is their tag."""

    language = "en-US"
    before = "Permanent operations before the sequence"
    after = "Permanent operations after the sequence"
    commands = "Commands and operating mode"
    checks = "Interlocks and supervisions of the active steps"
    checks_behind = "Interlocks and supervisions"
    undisturbed = "Step times without disturbance"
    manual = "Steps switched by hand"
    start = "Start of the sequence"
    off = "End of the sequence"
    skips = "Steps that are skipped"
    again = "more_skipped"
    events = "Events of steps"
    switched = "Steps that actions switch on and off"
    reports = "Operating mode and errors"
    display = "Step displayed"
    shown_data = "Data of steps that other blocks read"
    mode = "operating_mode"
    mode_comment = "0: automatic, 1: manual, 2: inching, 3: automatic or step by step"
    permitted = "satisfied_switch"
    pushed = "all_switch"
    shown = "displayed_step"
    shown_comment = "number of the step displayed"
    shown_active = "displayed_step_active"
    any_active = "any_step_active"
    leaving_one = "Actions of the step that was left"
    acting_one = "Actions of the active step"
    checks_of: Mapping[str, str] = {
        "LS": "the interlock is satisfied",
        "LA": "an error, the interlock is not satisfied",
        "L1": "the interlock is not satisfied any more",
        "L0": "the interlock is satisfied again",
        "fault": "the supervision is satisfied now",
        "VS": "the supervision is satisfied",
        "VA": "a fault holds the step",
        "V1": "the supervision becomes satisfied",
        "V0": "the supervision is not satisfied any more",
        "A1": "the fault is acknowledged now",
        "acknowledged": "the fault is acknowledged",
    }
    timer_mode = "0: stopped, 1: extended pulse, 2: on-delay, 3: off-delay"
    first_cycle = "the sequence has not been started yet"

    def wanted_of(self, path: str) -> str:
        """Return the comment of the bit that a step is active at the start of the next cycle."""
        return f"step {path} is active at the start of the next cycle"

    def leaving(self, path: str) -> str:
        """Return the title of the code of a step that was left."""
        return f"Step {path}: actions when it is left"

    def acting(self, path: str) -> str:
        """Return the title of the code of a step."""
        return f"Step {path}: actions"

    def check(self, path: str, what: str) -> str:
        """Return the comment of the result of a step's check."""
        return f"step {path}: {self.checks_of[what]}"

    def timer(self, name: str) -> str:
        """Return the title of a timer's network."""
        return f"Timer {name}"


class GermanGraphTexts(GraphTexts):
    """German texts."""

    language = "de-DE"
    before = "Permanente Operationen vor der Kette"
    after = "Permanente Operationen nach der Kette"
    commands = "Befehle und Betriebsart"
    checks = "Verriegelungen und Überwachungen der aktiven Schritte"
    checks_behind = "Verriegelungen und Überwachungen"
    undisturbed = "Schrittzeiten ohne Störung"
    manual = "Von Hand geschaltete Schritte"
    start = "Start der Kette"
    off = "Ende der Kette"
    skips = "Übersprungene Schritte"
    again = "weitere_uebersprungen"
    events = "Ereignisse der Schritte"
    switched = "Schritte, die von Aktionen ein- und ausgeschaltet werden"
    reports = "Betriebsart und Fehler"
    display = "Angezeigter Schritt"
    shown_data = "Schrittdaten, die andere Bausteine lesen"
    mode = "betriebsart"
    mode_comment = "0: Automatik, 1: Hand, 2: Tippen, 3: Automatik oder Tippen"
    permitted = "erfuellte_schalten"
    pushed = "alle_schalten"
    shown = "angezeigter_schritt"
    shown_comment = "Nummer des angezeigten Schritts"
    shown_active = "angezeigter_schritt_aktiv"
    any_active = "ein_schritt_aktiv"
    leaving_one = "Aktionen des verlassenen Schritts"
    acting_one = "Aktionen des aktiven Schritts"
    checks_of: Mapping[str, str] = {
        "LS": "die Verriegelung ist erfüllt",
        "LA": "ein Fehler, die Verriegelung ist nicht erfüllt",
        "L1": "die Verriegelung ist nicht mehr erfüllt",
        "L0": "die Verriegelung ist wieder erfüllt",
        "fault": "die Überwachung ist jetzt erfüllt",
        "VS": "die Überwachung ist erfüllt",
        "VA": "eine Störung hält den Schritt",
        "V1": "die Überwachung wird erfüllt",
        "V0": "die Überwachung ist nicht mehr erfüllt",
        "A1": "die Störung wird quittiert",
        "acknowledged": "die Störung ist quittiert",
    }
    timer_mode = "0: angehalten, 1: verlängerter Impuls, 2: Einschaltverzögerung, 3: Ausschaltverzögerung"
    first_cycle = "die Kette wurde noch nicht gestartet"

    def wanted_of(self, path: str) -> str:
        """Return the comment of the bit that a step is active at the start of the next cycle."""
        return f"Schritt {path} ist zu Beginn des nächsten Zyklus aktiv"

    def leaving(self, path: str) -> str:
        """Return the title of the code of a step that was left."""
        return f"Schritt {path}: Aktionen beim Verlassen"

    def acting(self, path: str) -> str:
        """Return the title of the code of a step."""
        return f"Schritt {path}: Aktionen"

    def check(self, path: str, what: str) -> str:
        """Return the comment of the result of a step's check."""
        return f"Schritt {path}: {self.checks_of[what]}"

    def timer(self, name: str) -> str:
        """Return the title of a timer's network."""
        return f"Zeitglied {name}"


def graph_texts(texts: Texts) -> GraphTexts:
    """Return the texts in the language of `texts`."""
    return GermanGraphTexts() if isinstance(texts, GermanTexts) else GraphTexts()
