"""German for what reports of conversions and lines of `diff` tell, by the English message.

Messages have places as `plcopen_sfc.pages.phrases` has them. A message that is not in the table stays English.
"""

from __future__ import annotations

import re
from functools import lru_cache

from plcopen_sfc.pages.phrases import Phrases, german_label
from plcopen_sfc.pages.verdict_words import Verdicts

_KINDS = {
    "access variables": "Zugriffsvariablen",
    "action": "Aktion",
    "action association": "Aktionszuordnung",
    "action associations": "Aktionszuordnungen",
    "action in place": "Aktion an Ort und Stelle",
    "action of the POU": "Aktion des Bausteins",
    "actions": "Aktionen",
    "activated steps": "aktivierte Schritte",
    "address": "Adresse",
    "attributes": "Attribute",
    "author": "Autor",
    "block": "Box",
    "Boolean actions": "boolesche Aktionen",
    "body": "Rumpf",
    "box": "Box",
    "branch": "Zweig",
    "call of a program": "Aufruf eines Programms",
    "chart": "Ablaufkette",
    "chart graph settings": "Einstellungen der Ablaufkette",
    "chart of an action": "Ablaufkette einer Aktion",
    "chart partial charts": "Teilpläne der Ablaufkette",
    "chart permanent post": "permanente Anweisungen nach der Ablaufkette",
    "chart permanent pre": "permanente Anweisungen vor der Ablaufkette",
    "chart sequences": "Ketten der Ablaufkette",
    "children": "untergeordnete Elemente",
    "code": "Code",
    "coil": "Spule",
    "comment": "Kommentar",
    "comments": "Kommentare",
    "company": "Firma",
    "condition": "Bedingung",
    "condition of the interlock": "Bedingung der Verriegelung",
    "condition of the transition": "Bedingung der Transition",
    "configuration": "Konfiguration",
    "constant": "konstant",
    "created": "erstellt",
    "data": "Daten",
    "data block": "Datenbaustein",
    "data blocks": "Datenbausteine",
    "data type": "Datentyp",
    "declaration": "Deklaration",
    "description": "Beschreibung",
    "drawn logic": "gezeichnete Logik",
    "duplicate": "Duplikat",
    "duration": "Dauer",
    "edge": "Flanke",
    "entries": "Einträge",
    "entry action": "Eingangsaktion",
    "entry step": "Eingangsschritt",
    "event": "Ereignis",
    "excluded": "von der Übersetzung ausgenommen",
    "exit action": "Ausgangsaktion",
    "exit step": "Ausgangsschritt",
    "extends": "Basistyp",
    "falling edge": "fallende Flanke",
    "FBD body": "FUP-Rumpf",
    "field": "Feld",
    "final scan": "letzter Durchlauf",
    "flag": "Merker",
    "flag of the initial step": "Merker des Initialschritts",
    "flags": "Merker",
    "folder": "Ordner",
    "forcing": "Zwangssteuerung",
    "foreign data": "fremde Daten",
    "global id": "globale Kennung",
    "global variable": "globale Variable",
    "global variables": "globale Variablen",
    "graphical element": "grafisches Element",
    "header": "Kopf",
    "hierarchy": "Hierarchie",
    "IL body": "AWL-Rumpf",
    "indicator": "Rückmeldevariable",
    "initial": "Initialschritt",
    "initial value": "Anfangswert",
    "inputs": "Eingänge",
    "instance": "Instanz",
    "interface": "Schnittstelle",
    "interlock": "Verriegelung",
    "interval": "Zykluszeit",
    "kind": "Art",
    "language": "Sprache",
    "LD body": "KOP-Rumpf",
    "logic": "Logik",
    "macro": "Makroschritt",
    "macro-step": "Makroschritt",
    "main action": "Hauptaktion",
    "max time": "Maximalzeit",
    "maximum time": "Maximalzeit",
    "member": "Element",
    "method": "Methode",
    "methods": "Methoden",
    "min time": "Minimalzeit",
    "minimum time": "Minimalzeit",
    "modified": "geändert",
    "name": "Name",
    "named transition": "benannte Transition",
    "namespace": "Namensraum",
    "negation": "Negation",
    "network": "Netzwerk",
    "networks": "Netzwerke",
    "nodes": "Knoten",
    "number": "Nummer",
    "object id": "Objektkennung",
    "operating input": "Bedieneingang",
    "order of actions": "Reihenfolge der Aktionen",
    "order of transitions": "Reihenfolge der Transitionen",
    "origin": "Herkunft",
    "outputs": "Ausgänge",
    "partial chart": "Teilplan",
    "partial charts": "Teilpläne",
    "permanent instruction after the sequence": "permanente Anweisung nach der Kette",
    "permanent instruction before the sequence": "permanente Anweisung vor der Kette",
    "persistent": "persistent",
    "place": "Platz",
    "position": "Position",
    "POU action": "Aktion des Bausteins",
    "POU instance": "Bausteininstanz",
    "priority": "Priorität",
    "product": "Produkt",
    "program": "Programm",
    "program instance": "Programminstanz",
    "property": "Eigenschaft",
    "qualifier": "Bestimmungszeichen",
    "resource": "Ressource",
    "result": "Ergebnis",
    "retain": "remanent",
    "search for stability": "Suche nach Stabilität",
    "section": "Bereich",
    "sections": "Bereiche",
    "sequence": "Kette",
    "sequences": "Ketten",
    "settings": "Einstellungen",
    "ST body": "ST-Rumpf",
    "start of several sequences": "Anfang mehrerer Ketten",
    "first scan": "erster Zyklus",
    "start values": "Startwerte",
    "static": "statisch",
    "step": "Schritt",
    "step action": "Schrittaktion",
    "step flag": "Schrittmerker",
    "step name": "Schrittname",
    "steps": "Schritte",
    "supervision": "Überwachung",
    "symbol": "Symbol",
    "symbols": "Symbole",
    "tag table": "Variablentabelle",
    "tag tables": "Variablentabellen",
    "tags": "Variablen",
    "target": "Ziel",
    "task": "Task",
    "text": "Text",
    "time": "Zeit",
    "title": "Titel",
    "transition": "Transition",
    "transitions": "Transitionen",
    "tree": "Baum",
    "trigger": "Auslöser",
    "type": "Typ",
    "undeclared name": "nicht deklarierter Name",
    "undeclared type": "nicht deklarierter Typ",
    "unused operating input": "unbenutzter Bedieneingang",
    "variable": "Variable",
    "variables": "Variablen",
    "version": "Version",
    "warning time": "Warnzeit",
}
"""Kinds of things and what is told of them; before a name they are the beginning of a place."""

_PARTS = {
    "a body in {}": "ein Rumpf in {}",
    "a network that cannot be executed: {}": "ein Netzwerk, das nicht ausgeführt werden kann: {}",
    "acknowledge_errors_required": "Quittierpflicht bei Fehlern",
    "active transitions only": "nur aktive Transitionen",
    "association": "Zuordnung",
    "bodies": "Rümpfe",
    "chart extension data": "Erweiterungsdaten der Ablaufkette",
    "constant expression": "konstanter Ausdruck",
    "constants": "Konstanten",
    "content extension data": "Erweiterungsdaten des Inhalts",
    "data types": "Datentypen",
    "dialect": "Dialekt",
    "elements": "Elemente",
    "exclude": "von der Übersetzung ausgenommen",
    "extension data": "Erweiterungsdaten",
    "ids": "Kennungen",
    "lock_operating_mode": "Betriebsartenwahl sperren",
    "monitoring": "Beobachtung",
    "network_language": "Sprache der Netzwerke",
    "permanent operation": "permanente Anweisung",
    "permanent_interlock_processing_in_manual_mode": "Verriegelungen im Handbetrieb bearbeiten",
    "permanent_post": "permanente Anweisungen nach der Kette",
    "permanent_pre": "permanente Anweisungen vor der Kette",
    "pous": "Bausteine",
    "selection": "Alternative",
    "SFC flag": "SFC-Merker",
    "skip_steps": "Schritte überspringen",
    "tag_tables": "Variablentabellen",
    "use defaults": "Vorgaben verwenden",
    "with_alarm_handling": "mit Alarmbehandlung",
    "a box": "eine Box",
    "action `{}`": "die Aktion `{}`",
    "an empty action": "eine leere Aktion",
    "the action in place": "die Aktion an Ort und Stelle",
    "function": "Funktion",
    "function block": "Funktionsbaustein",
    "nothing": "nichts",
    "tools that read the text": "Werkzeugen für Text",
    "TC6 tools": "TC6-Werkzeugen",
    "other tools": "anderen Werkzeugen",
    "the source": "der Quelle",
    "the POU": "Der Baustein",
    "the action of the POU": "Die Aktion des Bausteins",
    "stored value of {}": "gespeicherter Wert von {}",
    "order of transitions to": "Reihenfolge der Transitionen zu",
    "order of members": "Reihenfolge der Elemente",
    "order of {} variables": "Reihenfolge der Variablen von {}",
    "start value": "Startwert",
    "source": "Quelle",
    "the project": "das Projekt",
    "value": "Wert",
}
"""Parts of messages. Tools are in the dative: German puts them after `in` and `von`."""

_NOT_EXECUTED = {
    "the controller counts the bits of {} in words, {} in bytes: give it that of its byte": (
        "die Steuerung zählt die Bits von {} in Worten, {} in Bytes: geben Sie ihm die Adresse seines Bytes"
    ),
    "a source declares no tags and user constants: it must be in the project already": (
        "eine Quelle deklariert keine Variablen und Anwenderkonstanten: sie muss im Projekt vorhanden sein"
    ),
    "a source declares no tags and user constants: they must be in the project already": (
        "eine Quelle deklariert keine Variablen und Anwenderkonstanten: sie müssen im Projekt vorhanden sein"
    ),
    "no text expresses it; the undeclared name {} is in its place, so that the text does not compile": (
        "kein Text drückt das aus; an seiner Stelle steht der nicht deklarierte Name {}, so dass der Text sich "
        "nicht übersetzen lässt"
    ),
    "the source leaves open which one it is ({}), and no file says it: connect each instance": (
        "die Quelle lässt offen, welche Adresse es ist ({}), und keine Datei nennt sie: verbinden Sie jede Instanz"
    ),
    "variables of blocks have no address in S7: it is not connected to {}": (
        "Variablen von Bausteinen haben in S7 keine Adresse: sie ist nicht mit {} verbunden"
    ),
    "variables of blocks have no address in TIA Portal: it is connected to no input or output": (
        "Variablen von Bausteinen haben in TIA Portal keine Adresse: sie ist mit keinem Ein- oder Ausgang verbunden"
    ),
    "the type `{}` is declared neither in the source nor in {+}: convert the file that declares it "
    "as well, or replace it if it is of a library": (
        "der Typ `{}` ist weder in der Quelle noch in {} deklariert: wandeln Sie die Datei, die ihn deklariert, mit "
        "um, oder ersetzen Sie ihn, wenn er aus einer Bibliothek ist"
    ),
    "the name `{}` is declared neither in the source nor in {+}: convert the file that declares it "
    "as well, or replace it if it is of a library": (
        "der Name `{}` ist weder in der Quelle noch in {} deklariert: wandeln Sie die Datei, die ihn deklariert, mit "
        "um, oder ersetzen Sie ihn, wenn er aus einer Bibliothek ist"
    ),
    "the type `{}` is not declared in {+}": "der Typ `{}` ist in {} nicht deklariert",
    "the name `{}` is not declared in {+}": "der Name `{}` ist in {} nicht deklariert",
    "property `{}` is not declared in {+}": "die Eigenschaft `{}` ist in {} nicht deklariert",
    "variable `{}` is not declared in {+}": "die Variable `{}` ist in {} nicht deklariert",
    "global variable `{}` is not declared in {+}": "die globale Variable `{}` ist in {} nicht deklariert",
    "not declared in {+}: {&}": "nicht deklariert in {}: {}",
    "{+} `{}` is NOT executed in {+}": "{} `{}` wird in {} NICHT ausgeführt",
    "the action in place ({}) is NOT executed in {+}": "die Aktion an Ort und Stelle ({}) wird in {} NICHT ausgeführt",
    "the permanent instruction after the sequence is NOT executed in {+}": (
        "die permanente Anweisung nach der Kette wird in {} NICHT ausgeführt"
    ),
    "the permanent instruction before the sequence is NOT executed in {+}": (
        "die permanente Anweisung vor der Kette wird in {} NICHT ausgeführt"
    ),
    "the {}. body of the POU, `{+}`, is NOT executed in {+}": (
        "der {}. Rumpf des Bausteins, `{}`, wird in {} NICHT ausgeführt"
    ),
    "what is drawn beside the steps is NOT executed in {+}: `{}`": (
        "was neben den Schritten gezeichnet ist, wird in {} NICHT ausgeführt: `{}`"
    ),
    "what is drawn beside the steps acts, and is not written": (
        "was neben den Schritten gezeichnet ist, wirkt, und wird nicht geschrieben"
    ),
    "the actions of the step do not act while it is NOT active in {+}": (
        "die Aktionen des Schritts wirken in {} nicht, während er NICHT aktiv ist"
    ),
    "{} does not know what it is an instance of: {} is missing": "{} kennt den Typ dieser Instanz nicht: {} fehlt",
    "CoDeSys 2.3 has no enumeration with a type of its values: it does not compile": (
        "CoDeSys 2.3 hat keinen Aufzählungstyp mit einem Typ seiner Werte: es lässt sich nicht übersetzen"
    ),
    "CoDeSys 2.3 has no value of an enumeration by its type (`{}`): it does not compile": (
        "CoDeSys 2.3 kennt keinen Wert einer Aufzählung mit deren Typ (`{}`): es lässt sich nicht übersetzen"
    ),
    "CoDeSys 2.3 has no {} with the operand of its memory at a pin: it does not compile": (
        "CoDeSys 2.3 hat kein {} mit dem Operanden seines Speichers an einem Anschluss: es lässt sich nicht übersetzen"
    ),
    "CoDeSys 2.3 has no {}: it does not compile": "CoDeSys 2.3 hat kein {}: es lässt sich nicht übersetzen",
    "{+} is `{+}` in {+} instead of `{+}`": "{0} ist in {2} `{1}` statt `{3}`",
    "the {+} of {+} `{}` is `{+}` in {+} instead of `{+}`": "{0} von {1} `{2}` ist in {4} `{3}` statt `{5}`",
    "the {+} does something else in {+}: `{+}`": "{} hat in {} eine andere Wirkung: `{}`",
    "it is not known whether the {+} does the same in {+}: {+}": (
        "es ist nicht bekannt, ob {} in {} dasselbe bewirkt: {}"
    ),
    "the undeclared name {} is in its place, and the block does not compile: {+}": (
        "an ihrer Stelle steht der nicht deklarierte Name {}, und der Baustein lässt sich nicht übersetzen: {}"
    ),
    "function blocks or edges are in it, which a transition of S7-GRAPH cannot have": (
        "sie enthält Funktionsbausteine oder Flanken, die eine Transition von S7-GRAPH nicht haben kann"
    ),
    "TIA Portal does not have all elements of its network": "TIA Portal hat nicht alle Elemente ihres Netzwerks",
    "no network of LAD or FBD expresses {}": "kein Netzwerk in KOP oder FUP drückt {} aus",
    "{+}; no organization block is written that calls {}": (
        "{}; es wird kein Organisationsbaustein geschrieben, der {} aufruft"
    ),
    "it starts at a rising edge of {}": "sie startet bei einer steigenden Flanke von {}",
    "its interval is the variable {}": "ihre Zykluszeit ist die Variable {}",
    "the project has no program that it calls": "das Projekt hat kein Programm, das sie aufruft",
    "{} is not watched in {+}: SFCError is never set": "{} wird in {} nicht überwacht: SFCError wird nie gesetzt",
    "exceeding the maximum time {} is not reported in {+}": (
        "dass die Maximalzeit {} überschritten ist, wird in {} nicht gemeldet"
    ),
    "`{}` is not executed in {+}: {+}": "`{}` wird in {} nicht ausgeführt: {}",
    "`{}` is not executed: {+}": "`{}` wird nicht ausgeführt: {}",
    "it is not executed: {+}": "sie wird nicht ausgeführt: {}",
    "S7-GRAPH has no qualifier {}": "S7-GRAPH hat kein Bestimmungszeichen {}",
    "{} has no qualifier {}, and no standard tells what it does": (
        "{} hat kein Bestimmungszeichen {}, und keine Norm sagt, was es bewirkt"
    ),
    "{} has no action that acts while its step is not active": (
        "{} hat keine Aktion, die wirkt, während ihr Schritt nicht aktiv ist"
    ),
    "it acts while the step is not active, which S7-GRAPH cannot express": (
        "sie wirkt, während der Schritt nicht aktiv ist, was S7-GRAPH nicht ausdrücken kann"
    ),
    "{+}, and no function holds them: {+}": "{}, und keine Funktion nimmt sie auf: {}",
    "a row of S7-GRAPH assigns one operand; its statements are more than that": (
        "eine Zeile von S7-GRAPH weist einem Operanden zu; ihre Anweisungen sind mehr als das"
    ),
    "it is a network, and S7-GRAPH has no row for that": "sie ist ein Netzwerk, und S7-GRAPH hat dafür keine Zeile",
    "it uses data of the step {}, which no call passes; let the step set a variable (N), and use that in its place": (
        "sie benutzt Daten des Schritts {}, die kein Aufruf übergibt; lassen Sie den Schritt eine Variable setzen (N),"
        " und benutzen Sie diese"
    ),
    "it uses {}, which is no variable of the block": "sie benutzt {}, das keine Variable des Bausteins ist",
    "it calls what may write variables that its text does not name": (
        "sie ruft auf, was Variablen schreiben kann, die ihr Text nicht nennt"
    ),
    "its variable {} has a type that no parameter of a function may have": (
        "ihre Variable {} hat einen Typ, den kein Parameter einer Funktion haben kann"
    ),
    "it calls what nothing replaces: {}: {+}": "sie ruft auf, was nichts ersetzt: {}: {}",
    "nothing is passed to {}": "{} wird nichts übergeben",
    "it has no parameter for {}": "sie hat keinen Parameter für {}",
    "its body is no list of statements": "ihr Rumpf ist keine Folge von Anweisungen",
    "its tool calls it when an instance is made or goes": (
        "ihr Werkzeug ruft sie auf, wenn eine Instanz entsteht oder endet"
    ),
    "{} has a method {} too, and only the running program tells which one is called": (
        "auch {} hat eine Methode {}, und erst das laufende Programm zeigt, welche aufgerufen wird"
    ),
    "its network is no list of statements": "ihr Netzwerk ist keine Folge von Anweisungen",
    "{+} has no program in {+}": "{} hat in {} keinen Programmcode",
    "the block is empty and does nothing: SCL has no charts; `plcopen-sfc lower --to scl` makes code of them": (
        "der Baustein ist leer und tut nichts: SCL hat keine Ablaufketten; "
        "`plcopen-sfc lower --to scl` macht Code aus ihnen"
    ),
    "the block is empty and does nothing: SCL has programs in structured text only": (
        "der Baustein ist leer und tut nichts: SCL hat Programme nur in strukturiertem Text"
    ),
    "the block is empty and does nothing: it is in no language that is written for TIA Portal": (
        "der Baustein ist leer und tut nichts: er ist in keiner Sprache, die für TIA Portal geschrieben wird"
    ),
    "blocks of S7 have no actions: what calls it does not execute it": (
        "Bausteine von S7 haben keine Aktionen: was sie aufruft, führt sie nicht aus"
    ),
    "blocks of S7 have no methods: what calls it does not execute it": (
        "Bausteine von S7 haben keine Methoden: was sie aufruft, führt sie nicht aus"
    ),
    "blocks of {+} have no methods, and no function holds it: {+}": (
        "Bausteine von {} haben keine Methoden, und keine Funktion nimmt sie auf: {}"
    ),
    "blocks of {+} have no methods, and this calls one: {+}": (
        "Bausteine von {} haben keine Methoden, und dies ruft eine auf: {}"
    ),
    "it calls the action {}, which only its block executes": (
        "sie ruft die Aktion {} auf, die nur ihr Baustein ausführt"
    ),
    "{} is an instance, which functions do not get in {+}": (
        "{} ist eine Instanz, die Funktionen in {} nicht bekommen"
    ),
    "the method {} of {}": "die Methode {} von {}",
    "a type of numbers, which take the places of its values: matiec numbers enumerations from 0": (
        "ein Zahlentyp, dessen Zahlen an Stelle der Werte stehen: matiec nummeriert Aufzählungen von 0 an"
    ),
    "S7 has no actions and methods to call: {}": "S7 hat keine Aktionen und Methoden, die man aufrufen kann: {}",
    "`{}` is of the type {}, and an action is a Boolean variable in {+}": (
        "`{}` ist vom Typ {}, und eine Aktion ist in {} eine boolesche Variable"
    ),
    "S7-GRAPH has no {}: {+}": "S7-GRAPH hat kein {}: {}",
    "TC6 has no {}: {+}": "TC6 hat kein {}: {}",
    "matiec has no {}: {+}": "matiec hat kein {}: {}",
    "the chart neither obeys it nor sets it": "die Ablaufkette gehorcht ihm nicht und setzt es nicht",
    "a sequence goes on whenever its block is called": "eine Kette läuft weiter, sooft ihr Baustein aufgerufen wird",
    "it has {}, which the caller of the block operates, not the block": (
        "es hat {}, das der Aufrufer des Bausteins bedient, nicht der Baustein"
    ),
    "it has {}, which the caller of the block operates": "es hat {}, das der Aufrufer des Bausteins bedient",
    "it has S_NO, the number of the step": "es hat S_NO, die Nummer des Schritts",
    "nothing forgets an error there and lets the times of steps begin again": (
        "nichts vergisst dort einen Fehler und lässt die Zeiten der Schritte neu beginnen"
    ),
    "several of its steps may be active at a time, which no transition leaves together": (
        "mehrere seiner Schritte können zugleich aktiv sein, die keine Transition gemeinsam verlässt"
    ),
    "actions that it ends, stored or delayed ones, go on there": (
        "Aktionen, die es beendet, gespeicherte oder verzögerte, laufen dort weiter"
    ),
    "it is no variable of the block": "es ist keine Variable des Bausteins",
    "a condition that would obey it is no expression": "eine Bedingung, die ihm gehorchen müsste, ist kein Ausdruck",
    "the actions of the step {} go on there": "die Aktionen des Schritts {} laufen dort weiter",
    "S7-GRAPH has no macro-steps: the chart in it is not executed": (
        "S7-GRAPH hat keine Makroschritte: die Ablaufkette darin wird nicht ausgeführt"
    ),
    "S7-GRAPH has no partial charts: they are not executed": (
        "S7-GRAPH hat keine Teilpläne: sie werden nicht ausgeführt"
    ),
    "the step may be left before its minimum time {} in {+}": (
        "der Schritt kann in {1} vor seiner Minimalzeit {0} verlassen werden"
    ),
    "the interlock `{}` has no effect in {+}": "die Verriegelung `{}` hat in {} keine Wirkung",
    "the supervision `{}` does NOT hold the step in {+}": "die Überwachung `{}` hält den Schritt in {} NICHT",
    "the transition has no condition in {+} instead of `{}`": "die Transition hat in {} keine Bedingung statt `{}`",
    "the condition is in a form of its tool that is not read: {+} does not execute it": (
        "die Bedingung ist in einer Form ihres Werkzeugs, die nicht gelesen wird: in {} wird sie nicht ausgeführt"
    ),
    "`{}` does not start with its own values in {+}: {}": "`{}` beginnt in {} nicht mit eigenen Werten: {}",
    "the data block does not start with the values of its file in {+}, some of which are not read": (
        "der Datenbaustein beginnt in {} nicht mit den Werten seiner Datei, von denen einige nicht gelesen werden"
    ),
    "`{}` is not at {} in {+}": "`{0}` ist in {2} nicht auf {1}",
    "`{}` is no constant in {+}": "`{}` ist in {} keine Konstante",
    "nothing sets these outputs in {+}: {}": "nichts setzt diese Ausgänge in {}: {}",
    "variables of this name operate the sequence or show its state in {+}: {}": (
        "Variablen dieses Namens bedienen in {} die Kette oder zeigen ihren Zustand: {}"
    ),
    "the program of the {+}, `{}`, is NOT executed in {+}": "das Programm von {}, `{}`, wird in {} NICHT ausgeführt",
    "it has no initial step, and IEC 61131-3 demands one: it is not known how it runs in {+}": (
        "sie hat keinen Initialschritt, den IEC 61131-3 verlangt: es ist nicht bekannt, wie sie in {} abläuft"
    ),
    "a POU has one body in {+}: what is in the others ({}) is NOT executed": (
        "ein Baustein hat in {} einen Rumpf: was in den anderen ist ({}), wird NICHT ausgeführt"
    ),
    "the {+} does not extend `{}` in {+}: nothing of that is in it": (
        "{0} erweitert in {2} `{1}` nicht: nichts davon ist enthalten"
    ),
    "the {+} does not implement `{}` in {+}": "{0} implementiert in {2} `{1}` nicht",
    "the members of the UNION do not share their memory in {+}": (
        "die Elemente der UNION teilen sich in {} keinen Speicher"
    ),
    "each instance has a `{}` of its own in {+}: VAR_STAT is one for all": (
        "jede Instanz hat in {1} ein eigenes `{0}`: VAR_STAT ist eines für alle"
    ),
    "the program instance does not get its arguments in {+}: {}": (
        "die Programminstanz bekommt in {} ihre Argumente nicht: {}"
    ),
    "{} does not start at a rising edge of {} in {+}": "{0} startet in {2} nicht bei einer steigenden Flanke von {1}",
    "{} is a task of the kind {}: there is none in {+}": "{} ist eine Task der Art {}: in {} gibt es keine",
    "the program is a {+} in {+}, which nothing calls": "das Programm ist in {1} ein {0}, den nichts aufruft",
    "{+} `{}` is not in {+}": "{} `{}` gibt es in {} nicht",
    "only the tool of the source reads this: it is NOT executed in {+}": (
        "nur das Werkzeug der Quelle liest dies: in {} wird es NICHT ausgeführt"
    ),
    "the name `{}` is not declared in {+}: it is {+} of the library of its tool": (
        "der Name `{}` ist in {} nicht deklariert: er ist {} der Bibliothek seines Werkzeugs"
    ),
    "the type `{}` is not declared in {+}: it is {+} of the library of its tool": (
        "der Typ `{}` ist in {} nicht deklariert: er ist {} der Bibliothek seines Werkzeugs"
    ),
    "action `{}` ({}) is NOT executed in {+}": "die Aktion `{}` ({}) wird in {} NICHT ausgeführt",
    "the action in place is NOT executed in {+}": "die Aktion an Ort und Stelle wird in {} NICHT ausgeführt",
    "the {+} is NOT executed in {+}": "{} wird in {} NICHT ausgeführt",
    "{+} sets its variable to TRUE in {+} instead of `{}`": "{} setzt ihre Variable in {} auf TRUE statt auf `{}`",
    "{+} has the {+} `{}` in {+}, and none in the source": "{0} hat in {3} {1} `{2}`, in der Quelle nicht",
    "the {+} of the action in place is `{+}` in {+} instead of `{+}`": (
        "{0} der Aktion an Ort und Stelle ist in {2} `{1}` statt `{3}`"
    ),
    "the action in place runs as {+} in {+}, not as {+}": (
        "die Aktion an Ort und Stelle wird in {1} als {0} ausgeführt, nicht als {2}"
    ),
    "the action in place runs WITHOUT its {+} `{}` in {+}": (
        "die Aktion an Ort und Stelle wird in {2} OHNE {0} `{1}` ausgeführt"
    ),
    "the flag has no effect in {+}": "der Merker hat in {} keine Wirkung",
    "{} has no effect in {+}": "{} hat in {} keine Wirkung",
    "{} has no effect in {+}, and nothing in the project operates it": (
        "{} hat in {} keine Wirkung, und nichts im Projekt bedient es"
    ),
    "{} has no effect in {+}, and is inactive (--at-rest)": (
        "{} hat in {} keine Wirkung, und niemand bedient es, wie --at-rest angibt"
    ),
    "TIA Portal has no type like this one; written as {}, which does not compile": (
        "TIA Portal hat keinen solchen Typ; geschrieben als {}, was sich nicht übersetzen lässt"
    ),
    "TIA Portal has no such section": "TIA Portal hat keinen solchen Bereich",
    "TIA Portal has no such element: {}; the network is empty there": (
        "TIA Portal hat kein solches Element: {}; das Netzwerk ist dort leer"
    ),
    "TIA Portal cannot write this start value: the variable starts with the usual value of its type": (
        "TIA Portal kann diesen Startwert nicht schreiben: die Variable beginnt mit dem üblichen Wert ihres Typs"
    ),
    "{} is another place in {+}: one tool counts words where the other counts bytes": (
        "{} ist in {} eine andere Stelle: ein Werkzeug zählt Worte, wo das andere Bytes zählt"
    ),
    "{+}; left unchanged": "{}; bleibt, wie es ist",
    "a GRAFCET has no flags that operate or watch it": "ein GRAFCET hat keine Merker, die ihn bedienen oder überwachen",
    "IEC 60848 has no instructions that are always executed": (
        "IEC 60848 hat keine Anweisungen, die immer ausgeführt werden"
    ),
    "the target fires one of the transitions behind {&}, a GRAFCET all that are TRUE": (
        "das Ziel schaltet eine der Transitionen hinter {}, ein GRAFCET alle, die wahr sind"
    ),
    "with all inputs the target, which fires other transitions of a selection, does the same": (
        "mit allen Eingängen tut das Ziel, das andere Transitionen einer Alternative schaltet, dasselbe"
    ),
    "transitions of a GRAFCET have no order: two whose conditions are TRUE fire together (SEL01)": (
        "Transitionen eines GRAFCET haben keine Reihenfolge: zwei mit erfüllter Bedingung schalten zusammen (SEL01)"
    ),
    "a GRAFCET has no program beside its charts": "ein GRAFCET hat kein Programm neben seinen Plänen",
    "a GRAFCET declares no variables of a project": "ein GRAFCET deklariert keine Variablen eines Projekts",
    "variables of a GRAFCET do not keep their values over a power failure": (
        "Variablen eines GRAFCET behalten ihre Werte nicht über einen Spannungsausfall"
    ),
    "a GRAFCET declares no types": "ein GRAFCET deklariert keine Typen",
    "a GRAFCET declares inputs, outputs and internal variables only": (
        "ein GRAFCET deklariert nur Eingänge, Ausgänge und interne Variablen"
    ),
    "a comment begins with the quotation mark in the text of a GRAFCET": (
        "im Text eines GRAFCET beginnt mit dem Anführungszeichen ein Kommentar"
    ),
    "a GRAFCET is a chart, and executes no other POU": (
        "ein GRAFCET ist eine Ablaufkette und führt keinen anderen Baustein aus"
    ),
    "a GRAFCET gets no expansion for its steps: dissolve the macro-step": (
        "ein GRAFCET bekommt keine Expansion für seine Schritte: den Makroschritt auflösen"
    ),
    "IEC 60848 has none: write {} into the conditions that leave the step": (
        "IEC 60848 hat keine: {} in die Bedingungen schreiben, die den Schritt verlassen"
    ),
    "IEC 60848 has no action that does the same as {}": "IEC 60848 hat keine Aktion, die dasselbe tut wie {}",
    "IEC 60848 has no step actions": "IEC 60848 hat keine Schrittaktionen",
    "the body of the action is no structured text in one line": (
        "der Rumpf der Aktion ist kein strukturierter Text in einer Zeile"
    ),
    "a GRAFCET has no word for it; it is in a comment": (
        "ein GRAFCET hat kein Wort dafür; es steht in einem Kommentar"
    ),
    "{} has no such action of IEC 60848": "{} hat keine solche Aktion nach IEC 60848",
    "a .grafcet file has actions of IEC 60848 on variables only": (
        "eine .grafcet-Datei hat nur Aktionen nach IEC 60848 auf Variablen"
    ),
    "a .grafcet file has BOOL and integers only": "eine .grafcet-Datei hat nur BOOL und ganze Zahlen",
    "a .grafcet file has one GRAFCET": "eine .grafcet-Datei hat einen GRAFCET",
    "a .grafcet file has no place for it; it is in a comment": (
        "eine .grafcet-Datei hat dafür keinen Platz; es steht in einem Kommentar"
    ),
    "no text expresses it": "kein Text drückt es aus",
    "no fault holds a step of a GRAFCET": "keine Störung hält einen Schritt eines GRAFCET",
    "it is excluded or negated, and a GRAFCET executes it as it is": (
        "er ist ausgeschlossen oder negiert, und ein GRAFCET führt ihn aus, wie er ist"
    ),
    "it is excluded from the program, and a GRAFCET executes it": (
        "vom Programm ausgeschlossen, und ein GRAFCET führt es aus"
    ),
    "left unchanged: it is in the notation of GRAFCETs": (
        "bleibt, wie es ist: es ist in der Schreibweise von GRAFCETs"
    ),
    "left unchanged, because it cannot be read: {}": "bleibt, wie es ist, weil es nicht lesbar ist: {}",
    "{} has more digits than any type": "{} hat mehr Stellen als jeder Typ",
    "SCL has no function block {}: LAD and FBD have it as a box with an operand": (
        "SCL hat keinen Funktionsbaustein {}: KOP und FUP haben ihn als Box mit Operand"
    ),
    "IEC 61131-3 has no jumps": "IEC 61131-3 hat keine Sprünge",
    "IEC 61131-3 has no labels to jump to": "IEC 61131-3 hat keine Sprungmarken",
    "{+} `{}` runs as {+} in {+}, not as {+}": "{0} `{1}` wird in {3} als {2} ausgeführt, nicht als {4}",
    "{+} `{}` runs WITHOUT its {+} `{}` in {+}": "{0} `{1}` wird in {4} OHNE {2} `{3}` ausgeführt",
    "{} with a final scan": "{} mit letztem Durchlauf",
    "{+} `{}` is controlled otherwise in {+}: it also belongs to other steps": (
        "{} `{}` wird in {} anders gesteuert: sie gehört auch zu anderen Schritten"
    ),
    "{}: {+}, and charts of {} are nested branches: restructure it": (
        "{}: {}, und Ablaufketten von {} sind geschachtelte Verzweigungen: umstrukturieren"
    ),
    "waits for steps of branches that do not end together": "wartet auf Schritte von Zweigen, die nicht zusammen enden",
    "charts of CODESYS are nested branches from one start on, and this is in none of them": (
        "Ablaufketten von CODESYS sind geschachtelte Verzweigungen von einem Anfang aus, und dies ist in keiner"
    ),
    "the hierarchy is broken: {+}": "die Hierarchie ist fehlerhaft: {}",
    "{+}: lower the GRAFCET, which makes proven code of all of it": (
        "{}: den GRAFCET mit `lower` in Code umsetzen, dessen Verhalten bewiesen ist"
    ),
    "two steps are called {}: conditions could not tell them apart": (
        "zwei Schritte heißen {}: Bedingungen könnten sie nicht unterscheiden"
    ),
    "{} is ruled, and a step of it can be activated twice": (
        "{} wird gesteuert, und ein Schritt davon kann zweimal aktiviert werden"
    ),
    "the function block {} with the global instance {}: others name it or its variables": (
        "der Funktionsbaustein {} mit der globalen Instanz {}: andere nennen das Programm oder seine Variablen"
    ),
    "an instance": "eine Instanz",
    "it calls the instance {}, for tasks of {+}": "es ruft die Instanz {} auf, für Tasks von {}",
    "the program {}, which calls the instance": "das Programm {}, das die Instanz aufruft",
    "the program {}": "das Programm {}",
    "the flags of the chart wait for {}, too": "auch die Merker der Kette warten auf {}",
    "`{}` is a program: in {+} others can neither call it nor read its variables": (
        "`{}` ist ein Programm: in {} können andere es weder aufrufen noch seine Variablen lesen"
    ),
    "a program that no task of {} calls: give it one": "ein Programm, das keine Task von {} aufruft: eine zuweisen",
    "{} has no variables of its own in {+}: a program has one set of them for all its calls": (
        "{} hat in {} keine eigenen Variablen: ein Programm hat sie nur einmal für alle Aufrufe"
    ),
    "{} does not run every {} in {+}": "{0} läuft in {2} nicht alle {1}",
    "`{}` does not keep its value over a power failure in {+}": (
        "`{}` behält in {} seinen Wert bei Spannungsausfall nicht"
    ),
    "`{}` does not start as {} in {+}": "`{0}` beginnt in {2} nicht mit {1}",
    "{} would be retained, other variables of the block not: none is": (
        "{} wäre remanent, andere Variablen des Bausteins nicht: keine ist es"
    ),
    "it is a tag: whether it is retained is set for the memory of the controller": (
        "sie ist eine PLC-Variable: ob sie remanent ist, wird für den Speicher der Steuerung eingestellt"
    ),
    "it is a tag, which has no start value: it starts as FALSE or 0": (
        "sie ist eine PLC-Variable, die keinen Startwert hat: sie beginnt mit FALSE oder 0"
    ),
    "S7 has no such section: its variables have no addresses and values by it": (
        "S7 hat keinen solchen Bereich: seine Variablen bekommen daher keine Adressen und Werte"
    ),
    "SCL has no such declaration": "SCL hat keine solche Deklaration",
    "a {+} is called {} too: TIA Portal does not compile it": (
        "{} mit demselben Namen {}: TIA Portal übersetzt das nicht"
    ),
    "{} in {+}: {+} takes letters without accents, digits and single underscores": (
        "{} in {}: {} nimmt Buchstaben ohne Akzente, Ziffern und einzelne Unterstriche"
    ),
    "{} in {+}: {+} takes names of {} characters": "{} in {}: {} nimmt Namen von {} Zeichen",
    "{} in {}: a variable of the POU has its name": "{} in {}: eine Variable des Bausteins heißt so",
    "{} in {}: as in the file that it was converted from": "{} in {}: wie in der Datei, aus der umgewandelt wurde",
    "it keeps its name: {}": "der Name bleibt: {}",
    "{+} does not compile {}; it keeps its name: {}": "{} übersetzt {} nicht; der Name bleibt: {}",
    "it is unknown whether `{}` means what is called {} in {}": "unbekannt ist, ob `{0}` meint, was in {2} {1} heißt",
    "variable of the block": "eine Variable des Bausteins",
    "a body in {} cannot be written, and is not executed: the undeclared name {} is in its place": (
        "ein Rumpf in {} kann nicht geschrieben werden und wird nicht ausgeführt: an seiner Stelle steht der nicht "
        "deklarierte Name {}"
    ),
    "it names a variable with its list, which TC6 does not know: it does not compile": (
        "er nennt eine Variable mit ihrer Liste, die TC6 nicht kennt: er lässt sich nicht übersetzen"
    ),
    "TC6 {} has no place for it; other tools neither declare nor execute them": (
        "TC6 {} hat dafür keinen Platz; andere Werkzeuge deklarieren sie nicht und führen sie nicht aus"
    ),
}
"""Why something is not executed."""

_WRITTEN = {
    "never": "nie",
    "in every scan": "in jedem Zyklus",
    "only while its action is executed": "nur solange seine Aktion ausgeführt wird",
    "only while an association decides on it": "nur solange eine Zuordnung darüber entscheidet",
    "only while a step with it is active, before other actions": (
        "nur solange ein Schritt damit aktiv ist, vor anderen Aktionen"
    ),
}
_OTHERWISE = {
    "SFCError `SFCError` in {+}, none in the source": "SFCError wird in {} gesetzt, in der Quelle nicht",
    "{+} `{+}` in {+}, none in the source": "{} `{}` in {}, in der Quelle nicht",
    "the name `{}` is declared neither in the source nor in {+}, which does not compile it": (
        "der Name `{}` ist weder in der Quelle noch in {} deklariert, wo er sich nicht übersetzen lässt"
    ),
    "the type `{}` is declared neither in the source nor in {+}, which does not compile it": (
        "der Typ `{}` ist weder in der Quelle noch in {} deklariert, wo er sich nicht übersetzen lässt"
    ),
    "{} has variables of its own in {+}: in the source all calls of the program share them": (
        "{} hat in {} eigene Variablen: in der Quelle teilen sie sich alle Aufrufe des Programms"
    ),
    "{} is {} in {+} while the step is active, not {}: S7-GRAPH executes the rows S and R of an operand in their "
    "order; elsewhere R counts": (
        "{0} ist in {2} {1}, während der Schritt aktiv ist, nicht {3}: S7-GRAPH führt die Zeilen S und R eines "
        "Operanden in ihrer Reihenfolge aus; anderswo gilt R"
    ),
    **{
        f"{{}}: other code writes it, too; the chart does so {before} in the source, {after} in {{+}}": (
            f"{{}}: auch anderer Code schreibt das; die Kette tut es in der Quelle {frueher}, in {{}} {spaeter}"
        )
        for before, frueher in _WRITTEN.items()
        for after, spaeter in _WRITTEN.items()
    },
    "{} executes an {+} `{}` that the source does not": "{} führt {} `{}` aus, was die Quelle nicht tut",
    "{+} runs not once more in {+} after the step is left": (
        "{} wird in {}, nachdem der Schritt verlassen ist, nicht noch einmal ausgeführt"
    ),
    "action `{}` runs once more in {+} after the step is left": (
        "die Aktion `{}` wird in {}, nachdem der Schritt verlassen ist, noch einmal ausgeführt"
    ),
    "the action in place runs once more in {+} after the step is left": (
        "die Aktion an Ort und Stelle wird in {}, nachdem der Schritt verlassen ist, noch einmal ausgeführt"
    ),
    "the action in `{}` runs once more in {+} after the step is left": (
        "die Aktion in `{}` wird in {}, nachdem der Schritt verlassen ist, noch einmal ausgeführt"
    ),
    "set the cycle time of {} to {} in TIA Portal: its files have no place for it": (
        "die Zykluszeit von {} in TIA Portal auf {} einstellen: seine Dateien haben dafür keinen Platz"
    ),
    "set the priority of {} in TIA Portal: in the source it is {}": (
        "die Priorität von {} in TIA Portal einstellen: in der Quelle ist sie {}"
    ),
    "the target fires transitions once in a scan, code of `lower` until none can fire: flags are a scan late": (
        "das Ziel schaltet Transitionen einmal je Zyklus, Code von `lower`, bis keine mehr schalten kann: "
        "Merker kommen einen Zyklus später"
    ),
    "the target fires transitions once in a scan, code of `lower` until none can fire: "
    "{&} may be active where a GRAFCET only passes": (
        "das Ziel schaltet Transitionen einmal je Zyklus, Code von `lower`, bis keine mehr schalten kann: "
        "{} können aktiv sein, wo ein GRAFCET nur durchläuft"
    ),
    "S7-GRAPH tests no transition in its first scan: what is TRUE in that scan only is missed": (
        "S7-GRAPH prüft in seinem ersten Zyklus keine Transition: was nur in diesem TRUE ist, geht verloren"
    ),
    "terms have no times: `{}` is an input of this name there, as people declare it": (
        "Terme haben keine Zeiten: `{}` ist dort ein Eingang dieses Namens, wie man ihn eben anlegt"
    ),
    "{} is a time of an edge or of a time: no term has one, and no variable is one": (
        "{} ist eine Zeit von einer Flanke oder einer Zeit: kein Term hat eine, und keine Variable steht dafür"
    ),
    "it was in the notation of another tool; an edit writes it as the text of a GRAFCET": (
        "es war in der Schreibweise eines anderen Werkzeugs; eine Änderung schreibt es als Text eines GRAFCET"
    ),
    "where it leaves {}, stored actions miss it: they have not seen the step": (
        "wo er {} verlässt, versäumen das gespeicherte Aktionen: sie haben den Schritt nicht gesehen"
    ),
    "with all inputs the target, whose actions have not seen the initial step then, does the same": (
        "mit allen Eingängen tut das Ziel, dessen Aktionen den Initialschritt da nicht gesehen haben, dasselbe"
    ),
    "it leads to all initial steps: charts of the target have one, and the first scan passes with it": (
        "er führt zu allen Initialschritten: Ablaufketten des Ziels haben einen, und der erste Zyklus vergeht mit ihm"
    ),
    "{} executes a {+} `{}` that the source does not": "{} führt {} `{}` aus, was die Quelle nicht tut",
    "{} may execute other actions of the chart before it, which have variables in common with it": (
        "{} kann andere Aktionen der Ablaufkette davor ausführen, die gemeinsame Variablen mit ihr haben"
    ),
    "a timer, which sees that a step ends one scan later": (
        "eine Zeitfunktion, die das Ende eines Schritts einen Zyklus später sieht"
    ),
    "its variables are kept when the power fails, and not when the block is loaded again": (
        "seine Variablen bleiben bei Spannungsausfall erhalten, aber nicht, wenn der Baustein neu geladen wird"
    ),
    "S7-GRAPH wants it and a transition between two branches: what comes next is active one cycle later": (
        "S7-GRAPH verlangt ihn und eine Transition zwischen zwei Verzweigungen: "
        "was folgt, wird einen Zyklus später aktiv"
    ),
    "{+}; TIA Portal may refuse it": "{}; TIA Portal lehnt das vielleicht ab",
    "S7-GRAPH has no jump into or out of a simultaneous branch ({})": (
        "S7-GRAPH hat keinen Sprung in einen Simultanzweig oder aus ihm heraus ({})"
    ),
    "CODESYS has no negated step outputs; its importer may not see the negation": (
        "CODESYS hat keine negierten Schrittausgänge; sein Import sieht die Negation vielleicht nicht"
    ),
    "exports of CODESYS and TwinCAT have no macro-steps; their importers may not read it": (
        "Exporte von CODESYS und TwinCAT haben keine Makroschritte; der Import liest ihn vielleicht nicht"
    ),
    "S7-GRAPH does not execute an action once more after it has ended, as the final scan of IEC 61131-3 does": (
        "S7-GRAPH führt eine Aktion nicht noch einmal aus, nachdem sie beendet ist, wie es der letzte Durchlauf nach "
        "IEC 61131-3 tut"
    ),
    "IEC 61131-3 does not say which actions are executed first: it may be executed before others": (
        "IEC 61131-3 sagt nicht, welche Aktionen zuerst ausgeführt werden: sie kann vor anderen ausgeführt werden"
    ),
    "the chart of action `{}` begins a scan earlier or later in {+}: {+}, in the source {+}": (
        "die Ablaufkette der Aktion `{}` beginnt in {} einen Zyklus früher oder später: {}, in der Quelle {}"
    ),
    "a chart, transitions first": "eine Ablaufkette, Transitionen zuerst",
    "a chart, actions first": "eine Ablaufkette, Aktionen zuerst",
    "exceeding the maximum time {} sets SFCError in {+}, and does nothing in the source": (
        "dass die Maximalzeit {} überschritten ist, setzt in {} SFCError und bewirkt in der Quelle nichts"
    ),
    "CODESYS and TwinCAT offer {}": "CODESYS und TwinCAT bieten {}",
    "SFC131: this transition leads nowhere": "SFC131: diese Transition führt nirgendwohin",
    "SFC131: nothing leads on from this step": "SFC131: von diesem Schritt führt nichts weiter",
    "SFC132: a chart has one start; this is another": "SFC132: eine Ablaufkette hat einen Anfang, dies ist noch einer",
    "S7 calls instances, neither methods nor actions: this is right only if it is an instance": (
        "S7 ruft Instanzen auf, weder Methoden noch Aktionen: das stimmt nur, wenn es eine Instanz ist"
    ),
    "{} starts as {} in S7, and as {} in CODESYS": "{} beginnt in S7 mit {} und in CODESYS mit {}",
}
"""Why something is executed otherwise."""

_TRANSLATED = {
    "{+} in the source, here the expression {}": "in der Quelle {}, hier der Ausdruck {}",
    "logic drawn in the chart": "in der Ablaufkette gezeichnete Logik",
    "a negated condition": "eine negierte Bedingung",
    "a network": "ein Netzwerk",
    "a network of LD": "ein Netzwerk in KOP",
    "a network of FBD": "ein Netzwerk in FUP",
    "a tag, {} at {}": "eine PLC-Variable, {} auf {}",
    "its statements are the function {}, which a row calls": (
        "ihre Anweisungen sind die Funktion {}, die eine Zeile aufruft"
    ),
    "the entry action: the step has its statements, as other steps have this action too": (
        "die Eingangsaktion: der Schritt hat ihre Anweisungen, denn auch andere Schritte haben diese Aktion"
    ),
    "the exit action: the step has its statements, as other steps have this action too": (
        "die Ausgangsaktion: der Schritt hat ihre Anweisungen, denn auch andere Schritte haben diese Aktion"
    ),
    "the boxes drawn before conditions are called there, as if enabled transitions alone called them": (
        "die vor Bedingungen gezeichneten Boxen werden dort aufgerufen, als täten es nur freigegebene Transitionen"
    ),
    "it is the function {}, with the variables of the block that it uses": (
        "sie ist die Funktion {}, mit den Variablen des Bausteins, die sie benutzt"
    ),
    "functions are called in place of the methods {}": "statt der Methoden {} werden Funktionen aufgerufen",
    "a function block with the instance data block {&}; no task calls it, so no organization block does": (
        "ein Funktionsbaustein mit dem Instanz-DB {}; keine Task ruft ihn auf, also auch kein Organisationsbaustein"
    ),
    "a function block with the instance data block {&}": "ein Funktionsbaustein mit dem Instanz-DB {}",
    "the step {} is not active": "der Schritt {} ist nicht aktiv",
    "`{}` is a statement while the step is active, under the condition {}": (
        "`{}` ist eine Anweisung, während der Schritt aktiv ist, unter der Bedingung {}"
    ),
    "`{}` is a statement while the step is active": "`{}` ist eine Anweisung, während der Schritt aktiv ist",
    "`{}` is a statement once when the step becomes active": (
        "`{}` ist eine Anweisung, einmal, wenn der Schritt aktiv wird"
    ),
    "`{}` is a statement once when the step was left": (
        "`{}` ist eine Anweisung, einmal, wenn der Schritt verlassen wurde"
    ),
    "with what holds the step: {}": "mit dem, was den Schritt hält: {}",
    "an action of the POU, {}": "eine Aktion des Bausteins, {}",
    "the minimum time {} of the step {} is a part of the condition": (
        "die Minimalzeit {} des Schritts {} ist Teil der Bedingung"
    ),
    "the transitions that leave the step wait for {}": "die Transitionen, die den Schritt verlassen, warten auf {}",
    "its variables are of the type {}; its values are user constants": (
        "seine Variablen sind vom Typ {}; seine Werte sind Anwenderkonstanten"
    ),
    "its variables are of the type {}": "seine Variablen sind vom Typ {}",
    "it is a variable of the type {}, and values outside of {}..{} are no error": (
        "er ist eine Variable vom Typ {}, und Werte außerhalb von {}..{} sind kein Fehler"
    ),
    "it is a variable of the type {}": "er ist eine Variable vom Typ {}",
    "AND and OR that assign {}: flip-flops of other tools keep no state in a variable": (
        "AND und OR, die {} zuweisen: Flipflops anderer Werkzeuge halten ihren Zustand nicht in einer Variablen"
    ),
    "the text spells it {}": "im Text heißt er {}",
    "from {} into {}": "von {} nach {}",
    "bit {}: the constant {} names it in CODESYS alone": "Bit {}: die Konstante {} benennt es nur in CODESYS",
    "the number of the bit {} is not known": "die Nummer des Bits {} ist nicht bekannt",
    "the value of `{}`: TIA Portal takes no calculation here": (
        "der Wert von `{}`: TIA Portal nimmt hier keine Rechnung an"
    ),
    "TIA Portal takes a literal or one constant here, and the value of `{}` is not known": (
        "TIA Portal nimmt hier ein Literal oder eine einzelne Konstante an, und der Wert von `{}` ist nicht bekannt"
    ),
    "from instruction list into structured text": "von Anweisungsliste in strukturierten Text",
    "from instruction list into an expression": "von Anweisungsliste in einen Ausdruck",
    "from a drawing into structured text": "von einer Zeichnung in strukturierten Text",
    "`{}` in {+}: a name begins with no digit": "`{}` in {}: ein Name beginnt nicht mit einer Ziffer",
    "{} is {} in IEC 60848": "{} ist {} in IEC 60848",
    "nothing is executed in it and nothing leaves it: CODESYS leaves the step out": (
        "nichts wird darin ausgeführt und nichts verlässt ihn: CODESYS lässt den Schritt aus"
    ),
    "`{}` is left out: a later row of the step sets {}": "`{}` entfällt: eine spätere Zeile des Schritts setzt {}",
    "`{}` (event S1) is executed before rows above it that write {}; S7-GRAPH executes it after them": (
        "`{}` (Ereignis S1) wird vor darüberliegenden Zeilen ausgeführt, die {} schreiben; S7-GRAPH führt es danach aus"
    ),
    "`{}` (event S0) is executed before the next step drives {}; S7-GRAPH executes it after that": (
        "`{}` (Ereignis S0) wird ausgeführt, bevor der nächste Schritt {} ansteuert; S7-GRAPH führt es danach aus"
    ),
    "`{}` (event S0) is executed after the next step has written {}; S7-GRAPH executes it before that": (
        "`{}` (Ereignis S0) wird ausgeführt, nachdem der nächste Schritt {} geschrieben hat; S7-GRAPH führt es davor "
        "aus"
    ),
    "`{}` and the step {}, active too, write {} at other times than in S7-GRAPH": (
        "`{}` und der ebenfalls aktive Schritt {} schreiben {} zu anderen Zeiten als in S7-GRAPH"
    ),
    "`{}` is executed before the step {}, active too, drives {}; S7-GRAPH executes it after that": (
        "`{}` wird ausgeführt, bevor der ebenfalls aktive Schritt {} {} ansteuert; S7-GRAPH führt es danach aus"
    ),
    "a name begins with no digit": "ein Name beginnt nicht mit einer Ziffer",
    "the action {} of the step {}, which is executed in every scan": (
        "die Aktion {} des Schritts {}, die in jedem Zyklus ausgeführt wird"
    ),
    "the action {}, which is executed in every scan": "die Aktion {}, die in jedem Zyklus ausgeführt wird",
    "executed in every scan": "wird in jedem Zyklus ausgeführt",
    "{} is called {}: {} takes no such name": "{} heißt {}: {} erlaubt keinen solchen Namen",
    "the step is called {}: the name that it has is none there": ("der Schritt heißt {}: sein Name ist dort keiner"),
    "`Step.x` in {+} for the flag `Step`": "`Step.x` in {} für den Merker `Step`",
    "`{}` is the entry action of the step": "`{}` ist die Eingangsaktion des Schritts",
    "`{}` is the main action of the step": "`{}` ist die Hauptaktion des Schritts",
    "`{}` is the exit action of the step": "`{}` ist die Ausgangsaktion des Schritts",
    "`{}` has the qualifier {}": "`{}` hat das Bestimmungszeichen {}",
    "an association with qualifier {}, whose statements are executed only while the step is active": (
        "eine Zuordnung mit Bestimmungszeichen {}, deren Anweisungen nur ausgeführt werden, während der Schritt "
        "aktiv ist"
    ),
    "an association with qualifier {}": "eine Zuordnung mit Bestimmungszeichen {}",
    "an association with a pragma": "eine Zuordnung mit einem Pragma",
    "its assignments are rows of their own, and another one for the final scan": (
        "ihre Zuweisungen sind eigene Zeilen, und eine weitere für den letzten Durchlauf"
    ),
    "its assignments are rows of their own, and others for the final scan": (
        "ihre Zuweisungen sind eigene Zeilen, und weitere für den letzten Durchlauf"
    ),
    "its assignments are rows of their own": "ihre Zuweisungen sind eigene Zeilen",
    "networks behind the sequence control {}: no row means {} as its other steps have it": (
        "Netzwerke nach der Kette steuern {}: keine Zeile sagt {}, wie es seine anderen Schritte meinen"
    ),
    "networks behind the sequence control {}: no row means {}": (
        "Netzwerke nach der Kette steuern {}: keine Zeile sagt {}"
    ),
    "networks behind the sequence control its actions": "Netzwerke nach der Kette steuern seine Aktionen",
    "{} in the conditions that leave it": "{} in den Bedingungen, die ihn verlassen",
    "{} is {}: the same bytes: TwinCAT counts bytes, other tools count words or double words": (
        "{} ist {}: dieselben Bytes; TwinCAT zählt Bytes, andere Werkzeuge Wörter oder Doppelwörter"
    ),
    "{} is {}: the same bytes: S7 counts bytes, other tools count words or double words; S7 has the high byte first": (
        "{} ist {}: dieselben Bytes; S7 zählt Bytes, andere Werkzeuge Wörter oder Doppelwörter; bei S7 ist das obere "
        "Byte das erste"
    ),
    "{} has no counterpart: there a {} begins at every {} bytes": (
        "{} hat keine Entsprechung: dort beginnt ein Operand {} alle {} Byte"
    ),
    "what has an address is a variable of its own, and no parameter": (
        "was eine Adresse hat, ist eine eigene Variable und kein Parameter"
    ),
    "what has an address is a tag, and no parameter": "was eine Adresse hat, ist eine PLC-Variable und kein Parameter",
    "the organization block {} (OB{})": "der Organisationsbaustein {} (OB{})",
    "the step {} leads to it": "der Schritt {} führt zu ihm",
    "a permanent instruction assigns {}: the interlock of the step is that of another action": (
        "eine permanente Anweisung weist {} zu: die Verriegelung des Schritts ist die einer anderen Aktion"
    ),
    "the interlock of the step is that of another action, and {} is stored or delayed, too: let a step do one of it": (
        "die Verriegelung des Schritts ist die einer anderen Aktion, und {} wird auch gespeichert oder verzögert: "
        "einen Schritt nur eines davon tun lassen"
    ),
    "{} with a condition has no qualifier: lower the GRAFCET, which makes proven code of it": (
        "{} mit einer Bedingung hat kein Bestimmungszeichen: `lower` macht aus dem GRAFCET bewiesenen Code"
    ),
    "it has a condition of its own, and in S7-GRAPH only steps have one: give it a step of its own": (
        "sie hat eine eigene Bedingung, und in S7-GRAPH haben nur Schritte eine: ihr einen eigenen Schritt geben"
    ),
    "the action {} assigns {} in all steps that drive it": (
        "die Aktion {} weist {} in allen Schritten zu, die es ansteuern"
    ),
    "a global instance of {}": "eine globale Instanz von {}",
    "{} is expressed with the event {}": "{} ist mit dem Ereignis {} ausgedrückt",
    "on activation is {}: it stays so till it is reset": "bei Aktivierung ist {}: so bleibt es bis zum Rücksetzen",
    "it got a name, as S7-GRAPH requires": "sie hat einen Namen bekommen, wie S7-GRAPH ihn verlangt",
    "an IEC step, for which the library {} has to be in the project: {+}": (
        "ein IEC-Schritt, für den die Bibliothek {} im Projekt sein muss: {}"
    ),
    "in a form that no known export shows; see it after the import": (
        "in einer Form, die kein bekannter Export zeigt; nach dem Import ansehen"
    ),
    "the steps that it connects are loops with its condition": (
        "die Schritte, die sie verbindet, sind Schleifen mit ihrer Bedingung"
    ),
    "the transitions that lead to the step, and what activates it": (
        "die Transitionen, die zum Schritt führen, und was ihn aktiviert"
    ),
    "the transitions that leave the step, and what deactivates it": (
        "die Transitionen, die den Schritt verlassen, und was ihn deaktiviert"
    ),
    "the statements of the step that are executed while it is active": (
        "die Anweisungen des Schritts, die ausgeführt werden, während er aktiv ist"
    ),
    "the statements of the step that are executed once when it becomes active": (
        "die Anweisungen des Schritts, die einmal ausgeführt werden, wenn er aktiv wird"
    ),
    "the statements of the step that are executed once when it was left": (
        "die Anweisungen des Schritts, die einmal ausgeführt werden, wenn er verlassen wurde"
    ),
    "its steps are in the one chart": "seine Schritte sind in der einen Ablaufkette",
    "the main action: its statements run only while the step is active": (
        "die Hauptaktion: ihre Anweisungen laufen nur, während der Schritt aktiv ist"
    ),
    "the {+}, an action of the POU": "{}, eine Aktion des Bausteins",
    "the modes are variables, which the conditions read": "die Betriebsarten sind Variablen, die die Bedingungen lesen",
    "it got the standard parameters of S7-GRAPH": "er hat die Standardparameter von S7-GRAPH bekommen",
    "shown as text; the drawing in pragmas": "als Text gezeigt; die Zeichnung in Pragmas",
    "an output variable: FBD of TC6 has no coils": "eine Ausgangsvariable: FUP von TC6 hat keine Spulen",
    "transitions that are tried before all others": "Transitionen, die vor allen anderen geprüft werden",
    "transitions that are tried before those of the charts that it rules": (
        "Transitionen, die vor denen der gesteuerten Teilpläne geprüft werden"
    ),
    "the conditions of transitions obey it": "die Bedingungen der Transitionen gehorchen ihm",
    "the transition of the flags to the initial step is another one": (
        "die Transition der Merker zum Initialschritt ist eine andere"
    ),
    "it obeys the SFC flags of the chart": "sie gehorcht den SFC-Merkern der Kette",
    "its statements ask the SFC flags of the chart": "ihre Anweisungen fragen die SFC-Merker der Kette ab",
    "the conditions that leave it ask for its time, and for the flags": (
        "die Bedingungen, die ihn verlassen, fragen seine Zeit und die Merker ab"
    ),
    "statements that every scan executes set it, or ask for it": (
        "Anweisungen, die jeder Zyklus ausführt, setzen ihn oder fragen ihn ab"
    ),
    "statements that every scan executes set SFCError": "Anweisungen, die jeder Zyklus ausführt, setzen SFCError",
    "{} does not let the times of {} begin again, which it does in CODESYS": (
        "{} lässt die Zeiten von {} nicht neu beginnen, in CODESYS schon"
    ),
    "the times of {} go on during {}; in CODESYS nothing is executed, and all stays as it is": (
        "die Zeiten von {} laufen während {} weiter; in CODESYS wird nichts ausgeführt, und alles bleibt, wie es ist"
    ),
    "{} go on during {}": "{} laufen während {} weiter",
    "{} does not let it begin again, which it does in CODESYS": ("{} lässt sie nicht neu beginnen, in CODESYS schon"),
    "no step is active in the source": "in der Quelle ist kein Schritt aktiv",
    "one of them leads to the step {}": "eine davon führt zum Schritt {}",
    "nothing leads on from this step": "von diesem Schritt führt nichts weiter",
    "the step {} ends what it stores": "der Schritt {} beendet, was sie speichert",
    "it ends what is stored, and executes what the initial step does": (
        "er beendet, was gespeichert ist, und führt aus, was der Initialschritt ausführt"
    ),
    "as from the initial step": "wie vom Initialschritt aus",
    "its flag is FALSE {}, in CODESYS it is TRUE; nothing of the block reads it": (
        "sein Merker ist FALSE ({}), in CODESYS TRUE; nichts im Baustein liest ihn"
    ),
    "its flag is FALSE {}, in CODESYS it is TRUE": "sein Merker ist FALSE ({}), in CODESYS TRUE",
    "its time does not begin while the step {} is active in its place": (
        "seine Zeit beginnt nicht, solange an seiner Stelle der Schritt {} aktiv ist"
    ),
    "behind {} it does not store what it stores otherwise": "nach {} speichert er nicht, was er sonst speichert",
    "its time goes on during {}; in CODESYS nothing is executed, and all stays as it is": (
        "ihre Zeit läuft während {} weiter; in CODESYS wird nichts ausgeführt, und alles bleibt, wie es ist"
    ),
    "it goes on during {}": "sie läuft während {} weiter",
    "what holds transitions during {} may be computed before actions that the conditions read": (
        "was Transitionen während {} hält, wird vielleicht vor Aktionen berechnet, die die Bedingungen lesen"
    ),
    "what is kept of SFC flags may be computed before actions that the conditions read": (
        "was von SFC-Flags aufbewahrt wird, wird vielleicht vor Aktionen berechnet, die die Bedingungen lesen"
    ),
    "an action in place that is stored has no name by which it could be reset": (
        "eine gespeicherte Aktion ohne Namen lässt sich nicht zurücksetzen"
    ),
    "it is active instead of the initial step, and does nothing": (
        "er ist statt des Initialschritts aktiv und tut nichts"
    ),
    "it replaces an SFC flag, and is tried before the others": (
        "sie steht für einen SFC-Merker und wird vor den anderen geprüft"
    ),
    "a data block": "ein Datenbaustein",
    "tags and constants": "Variablen und Konstanten",
    "the networks that control actions": "die Netzwerke, die Aktionen steuern",
    "there is one organization block only": "es gibt nur einen Organisationsbaustein",
    "in the types of S7": "in den Typen von S7",
    "in the sections of S7": "in den Abschnitten von S7",
    "conditions tell which transition fires": "Bedingungen bestimmen, welche Transition schaltet",
    "it depends on the operating mode": "sie hängt von der Betriebsart ab",
    "rows and outputs that depend on it are statements; it does nothing else": (
        "Zeilen und Ausgänge, die von ihr abhängen, sind Anweisungen; sonst bewirkt sie nichts"
    ),
    "a network behind the sequence sets SFCError when a step is active longer than its maximum time": (
        "ein Netzwerk nach der Kette setzt SFCError, wenn ein Schritt länger als seine Maximalzeit aktiv ist"
    ),
    "statements compute its rising edges where something depends on them": (
        "Anweisungen bilden seine steigenden Flanken, wo etwas davon abhängt"
    ),
    "tabs are blanks": "Tabulatoren sind Leerzeichen",
    "of the configuration": "der Konfiguration",
    "a configuration with one resource": "eine Konfiguration mit einer Ressource",
    "it leads to all sequences: each step of branches that do not end together is one": (
        "er führt zu allen Ketten: jeder Schritt von Zweigen, die nicht zusammen enden, ist eine"
    ),
    "it leads to all sequences: a chart of the target begins with one step": (
        "er führt zu allen Ketten: eine Ablaufkette des Ziels beginnt mit einem Schritt"
    ),
    "the sequences begin": "die Ketten beginnen",
    "the list of global variables {}": "die Liste globaler Variablen {}",
    "its condition is the interlock of the step": "ihre Bedingung ist die Verriegelung des Schritts",
    "no step is active in {}": "in {} ist kein Schritt aktiv",
    "it ends the sequence": "sie beendet die Kette",
    "its step is excluded from the build": "ihr Schritt ist von der Übersetzung ausgenommen",
    "a permanent instruction before the sequences": "eine permanente Anweisung vor den Ketten",
    "in an action; the association in pragmas": "in einer Aktion; die Zuordnung in Pragmas",
    "a program of a task without a cycle time": "ein Programm einer Task ohne Zykluszeit",
    "calls pass it": "Aufrufe übergeben ihn",
    "without effect: all calls pass these inputs": "ohne Wirkung: alle Aufrufe übergeben diese Eingänge",
    "the calls of {} pass the start values of inputs, which the instance cannot have": (
        "die Aufrufe von {} übergeben die Startwerte von Eingängen, die die Instanz nicht haben kann"
    ),
    "{} has no library with it: its statements are in the file": (
        "{} hat keine Bibliothek damit: seine Anweisungen stehen in der Datei"
    ),
    "its statements are in place of the calls of it": "ihre Anweisungen stehen an Stelle ihrer Aufrufe",
    "with all inputs the target, which fires transitions once in a scan, does the same": (
        "mit allen Eingängen tut das Ziel, das Transitionen einmal je Zyklus schaltet, dasselbe"
    ),
    "with all inputs the target, which executes actions in another order, does the same": (
        "mit allen Eingängen tut das Ziel, das Aktionen in anderer Reihenfolge ausführt, dasselbe"
    ),
    "with all inputs the target, which writes variables of actions at other times, does the same": (
        "mit allen Eingängen tut das Ziel, das Variablen von Aktionen zu anderen Zeiten schreibt, dasselbe"
    ),
    "with all inputs the target, which calls a block for the chart of the action, does the same": (
        "mit allen Eingängen tut das Ziel, das für die Ablaufkette der Aktion einen Baustein aufruft, dasselbe"
    ),
    "it is kept as text: what it says has to be made in {}": "als Text behalten: was darin steht, ist in {} anzulegen",
    "it is of CoDeSys 2.3 alone, and no program": "nur in CoDeSys 2.3, und kein Programm",
    "a section that is not known: the controller may execute what it says": (
        "ein unbekannter Abschnitt: die Steuerung kann ausführen, was darin steht"
    ),
    "{} comes back as {}": "{} wird als {} wieder gelesen",
    "the written file has {}, and the source nothing": "die geschriebene Datei hat {}, die Quelle nichts",
    "// is no comment in {}, (* *) is": "// ist in {} kein Kommentar, (* *) ist einer",
    "{}: statements set them as in the automatic mode": "{}: Anweisungen setzen sie wie in der Betriebsart Automatik",
    "S7-GRAPH wants a transition behind every step: one that is never TRUE": (
        "S7-GRAPH verlangt nach jedem Schritt eine Transition: eine, die nie TRUE ist"
    ),
    "`{}` is left out: the event {} never happens in this step": (
        "`{}` entfällt: das Ereignis {} tritt in diesem Schritt nie ein"
    ),
    "a configuration with one resource; TC6 has no application": (
        "eine Konfiguration mit einer Ressource; TC6 hat keine Applikation"
    ),
    "a program of the resource": "ein Programm der Ressource",
    "a statement of the action that keeps the edges": "eine Anweisung der Aktion, die die Flanken bildet",
    "a statement of the permanent instruction that keeps the edges": (
        "eine Anweisung der permanenten Anweisung, die die Flanken bildet"
    ),
    "flip-flops of TIA Portal keep their state in a variable of type BOOL": (
        "Flipflops von TIA Portal halten ihren Zustand in einer Variablen vom Typ BOOL"
    ),
    "it is excluded from the build: a network that is never TRUE": (
        "sie ist von der Übersetzung ausgenommen: ein Netzwerk, das nie TRUE ist"
    ),
    "it is excluded from the build: it has no actions there, and is not left": (
        "er ist von der Übersetzung ausgenommen: er hat dort keine Aktionen und wird nicht verlassen"
    ),
    "it leads to the step {}, which does nothing": "sie führt zum Schritt {}, der nichts tut",
    "it stands for {&}": "sie steht für {}",
    "its chart is the block {}, which a row calls, and another one for the final scan": (
        "ihre Ablaufkette ist der Baustein {}, den eine Zeile aufruft, und eine weitere für den letzten Durchlauf"
    ),
    "its value is in the texts": "ihr Wert steht in den Texten",
    "members of a structure": "Elemente einer Struktur",
    "not while {} begins the sequence again": "nicht, während {} die Kette neu beginnt",
    "numbers instead of places": "Nummern statt Positionen",
    "onActivation is {} with an action": "bei Aktivierung ist {} mit einer Aktion",
    "onActivation is the event {}": "bei Aktivierung ist das Ereignis {}",
    "onDeactivation is {} with an action": "bei Deaktivierung ist {} mit einer Aktion",
    "onDeactivation is the event {}": "bei Deaktivierung ist das Ereignis {}",
    "steps are loops with `<Step>_rests`; where {} stay inactive, --at-rest {} keeps their sequences, as does {} "
    "where the manual mode is not used": (
        "Schritte sind Schleifen mit `<Step>_rests`; wo niemand {} bedient, erhält --at-rest {} ihre Ketten, ebenso {}"
        ", wo niemand in den Handbetrieb schaltet"
    ),
    "steps are loops with `<Step>_rests`; where {} stay inactive, --at-rest {} keeps their sequences": (
        "Schritte sind Schleifen mit `<Step>_rests`; wo niemand {} bedient, erhält --at-rest {} ihre Ketten"
    ),
    "the action {} of the step {} executes it, and the boxes drawn before conditions": (
        "die Aktion {} des Schritts {} führt sie aus, und die Boxen, die vor Bedingungen gezeichnet sind"
    ),
    "the action {} of the step {} executes it, and the boxes drawn before conditions; it follows its inputs at once, "
    "and the actions of steps a scan later than in the source": (
        "die Aktion {} des Schritts {} führt sie aus, und die Boxen, die vor Bedingungen gezeichnet sind; sie folgt "
        "ihren Eingängen sofort, und den Aktionen von Schritten einen Zyklus später als in der Quelle"
    ),
    "charts in actions show a new step one call later in CODESYS: where such an action ends just then, the step acts "
    "before it ends in TIA Portal, and when it begins again in CODESYS": (
        "Ablaufketten in Aktionen zeigen einen neuen Schritt in CODESYS einen Aufruf später: wo eine solche Aktion "
        "gerade endet, wirkt der Schritt in TIA Portal, bevor sie endet, und in CODESYS, wenn sie wieder beginnt"
    ),
    "{} is an edge of something that is no variable and no step: {}": (
        "{} ist eine Flanke von etwas, das weder Variable noch Schritt ist: {}"
    ),
    "the condition cannot be read: {}": "die Bedingung ist nicht lesbar: {}",
    "what it does cannot be read: {}": "was sie tut, ist nicht lesbar: {}",
    "the condition is FALSE: CODESYS leaves the transition out": (
        "die Bedingung ist FALSE: CODESYS lässt die Transition aus"
    ),
    "the global structure {}": "die globale Struktur {}",
    "the transition of INIT_SQ to the initial step is another one": (
        "die Transition von INIT_SQ zum Initialschritt ist eine andere"
    ),
    "{} is executed before {} in one scan, in the source the other way round ({})": (
        "{} wird in einem Zyklus vor {} ausgeführt, in der Quelle umgekehrt ({})"
    ),
    "{} is executed before {} in one scan, in the source the other way round ({}); {+}": (
        "{} wird in einem Zyklus vor {} ausgeführt, in der Quelle umgekehrt ({}); {}"
    ),
    "{} is executed after {} in one scan, in the source the other way round ({})": (
        "{} wird in einem Zyklus nach {} ausgeführt, in der Quelle umgekehrt ({})"
    ),
    "{} is executed after {} in one scan, in the source the other way round ({}); {+}": (
        "{} wird in einem Zyklus nach {} ausgeführt, in der Quelle umgekehrt ({}); {}"
    ),
    "and {} more": "und {} weitere",
    "and {} more; {+}": "und {} weitere; {}",
    "the orders of {} pairs of actions were compared, there are more pairs": (
        "die Reihenfolgen von {} Paaren von Aktionen wurden verglichen, es gibt mehr Paare"
    ),
    "values of enumerations without the name of their type, which CoDeSys 2.3 does not write": (
        "Werte von Aufzählungen ohne den Namen ihres Typs, den CoDeSys 2.3 nicht schreibt"
    ),
    "{} cannot express it; it is in a comment": "{} kann es nicht ausdrücken; es steht in einem Kommentar",
    "{} has no place for it": "{} hat dafür keinen Platz",
    "IEC text knows names only": "IEC-Text kennt nur Namen",
    "CODESYS tries transitions from left to right, and they are written in that order": (
        "CODESYS prüft Transitionen von links nach rechts, und sie sind in dieser Reihenfolge geschrieben"
    ),
    "no step has it and no program calls it: nothing executes it in the source either": (
        "kein Schritt hat sie und kein Programm ruft sie auf: auch in der Quelle führt sie nichts aus"
    ),
    "the first call of {} with FALSE is a falling edge in the source and none in {}": (
        "der erste Aufruf von {} mit FALSE ist in der Quelle eine fallende Flanke, in {} keine"
    ),
    "the first call of {} with FALSE is a falling edge in {} and none in the source": (
        "der erste Aufruf von {} mit FALSE ist in {} eine fallende Flanke, in der Quelle keine"
    ),
    "CODESYS calculates with 32 bits where {} may do it in the types of the operands": (
        "CODESYS rechnet mit 32 Bit, {} möglicherweise mit den Typen der Operanden"
    ),
    "{} calculates with 32 bits where the source does it in the types of the operands: a result that does not fit is"
    " not cut off": (
        "{} rechnet mit 32 Bit, die Quelle mit den Typen der Operanden: ein Ergebnis, das nicht passt, wird nicht"
        " abgeschnitten"
    ),
    "with all inputs the target, which calculates with other numbers of bits, does the same": (
        "mit allen Eingängen tut das Ziel, das mit anderen Bitzahlen rechnet, dasselbe"
    ),
    "with all inputs the target, which sees another first edge of F_TRIG, does the same": (
        "mit allen Eingängen tut das Ziel, das eine andere erste Flanke von F_TRIG sieht, dasselbe"
    ),
    "TIA Portal draws no texts in networks": "TIA Portal zeichnet keine Texte in Netzwerke",
}
"""Outcomes of things in the target."""

_CHANGED = {
    "added": "neu",
    "removed": "entfernt",
    "{} added": "{} neu",
    "{} removed": "{} entfernt",
    "added ({})": "neu ({})",
    "removed ({})": "entfernt ({})",
    "renamed, was {}": "umbenannt, hieß {}",
    "named {}": "benannt: {}",
    "moved {} -> {}": "verschoben {} -> {}",
    "no longer {+}": "nicht mehr {}",
    "after {}": "nach {}",
    "after ": "am Anfang",
    "differs in what is no text": "ist anders in dem, was kein Text ist",
    "{} means something else": "{} hat eine andere Bedeutung",
}
"""Changes that `diff` lists."""

GERMAN = {**_KINDS, **_PARTS, **_NOT_EXECUTED, **_OTHERWISE, **_TRANSLATED, **_CHANGED}


def german_place(path: str) -> str:
    """Return a path of a report with the kinds of things in German: ``POU Main / Schritt Fill``."""
    return " / ".join(map(_german_part, path.split(" / ")))


def _german_part(part: str) -> str:
    words = part.split(" ")
    for end in range(len(words), 0, -1):
        kind = " ".join(words[:end])
        if kind in _KINDS:
            name = " ".join(words[end:])
            return f"{_KINDS[kind]} {german_label(name) if kind == 'transition' else name}".rstrip()
    return part


_LINE = re.compile(r"line (\d+): ")
"""Beginnings of messages about program text of several lines."""


_RUN = ("it does something else after ", "it is not known to do the same")
"""Beginnings of what a run of both sides has shown."""


@lru_cache(maxsize=4096)
def german(message: str) -> str:
    """Return a message in German; itself where the table does not have it."""
    if message in GERMAN:
        return GERMAN[message]
    if message.startswith(_RUN):
        return german_verdict(message)
    if line := _LINE.match(message):
        return f"Zeile {line[1]}: {german(message[line.end() :])}"
    return _REPORTS(message)


_REPORTS = Phrases(GERMAN, german)
german_verdict = Verdicts(_REPORTS)
"""Return a line of a verdict in German, or why something was not reached; English stays what is not known."""
