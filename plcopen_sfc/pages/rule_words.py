"""German for what `check` tells: the messages of findings, and the hints of rules and findings.

Messages have places as `plcopen_sfc.pages.phrases` has them.
"""

from __future__ import annotations

from functools import lru_cache

from plcopen_sfc.pages.phrases import Phrases, german_label

_HINTS = {
    "Convert the value (REAL_TO_INT, TIME_TO_DINT), or compare it: n <> 0.": (
        "Den Wert umwandeln (REAL_TO_INT, TIME_TO_DINT) oder vergleichen: n <> 0."
    ),
    "Insert what is missing between them.": "Das Fehlende dazwischen einfügen.",
    "Mark the step in which the chart starts.": "Den Schritt kennzeichnen, in dem die Ablaufkette beginnt.",
    "Use the other kind of bar, or insert a step or a transition before or behind it.": (
        "Die andere Art der Verzweigung verwenden oder davor oder dahinter einen Schritt oder eine Transition einfügen."
    ),
    "Correct the target.": "Das Ziel berichtigen.",
    "Connect the step, or remove it with what follows it.": (
        "Den Schritt anschließen oder mit dem entfernen, was auf ihn folgt."
    ),
    "Let simultaneous branches meet in a simultaneous convergence, without jumps into them or out of them.": (
        "Simultanzweige in einer Simultanzusammenführung enden lassen, ohne Sprünge hinein oder heraus."
    ),
    "Let the branches of a selection meet in a selection convergence.": (
        "Die Zweige einer Alternative in einer Alternativzusammenführung enden lassen."
    ),
    "Add the transition that leads on, or a jump to the start.": (
        "Die weiterführende Transition ergänzen oder einen Sprung zum Anfang."
    ),
    "Look which branch the convergence waits for, and how that was left.": (
        "Prüfen, auf welchen Zweig die Zusammenführung wartet und wie er verlassen wurde."
    ),
    "Connect it to a step, or remove it with what follows it.": (
        "Sie an einen Schritt anschließen oder mit dem entfernen, was auf sie folgt."
    ),
    "Make the others ordinary steps, and reach them by a simultaneous divergence.": (
        "Die anderen zu gewöhnlichen Schritten machen und durch eine Simultanverzweigung erreichen."
    ),
    "Let the branches meet in one convergence; where one shall end early, let its last step wait for the others.": (
        "Die Zweige in einer Zusammenführung enden lassen; soll einer früher enden, wartet sein letzter Schritt dort."
    ),
    "Write {} for what this step does then.": "{} schreiben für das, was der Schritt dann tut.",
    "Write ON ACTIVATION {}, which is executed once, or the name of a BOOL alone.": (
        "ON ACTIVATION {} schreiben, das einmal ausgeführt wird, oder allein den Namen eines BOOL."
    ),
    "Add a step or a jump behind it.": "Dahinter einen Schritt oder einen Sprung ergänzen.",
    "Nothing, if the chart runs once. Else add the transition or jump that leads back.": (
        "Nichts, wenn die Ablaufkette einmal läuft. Sonst die Transition oder den Sprung zurück ergänzen."
    ),
    "Rename one of them.": "Einen davon umbenennen.",
    "Use letters, digits and underscores, a letter first.": (
        "Buchstaben, Ziffern und Unterstriche verwenden, zuerst einen Buchstaben."
    ),
    "Renumber one of them.": "Einem davon eine andere Nummer geben.",
    "Make the conditions exclude each other (a, NOT a AND b), or give the transitions priorities.": (
        "Die Bedingungen einander ausschließen lassen (a, NOT a AND b) oder den Transitionen Prioritäten geben."
    ),
    "Look at the conditions; write them as comparisons with constants, or give the transitions priorities.": (
        "Die Bedingungen prüfen; als Vergleiche mit Konstanten schreiben oder den Transitionen Prioritäten geben."
    ),
    "Change the order, or the condition of the first.": "Die Reihenfolge ändern oder die Bedingung der ersten.",
    "Number them in the order in which they shall be tried.": (
        "In der Reihenfolge nummerieren, in der sie geprüft werden sollen."
    ),
    "Add one; TRUE if it shall always fire.": "Eine ergänzen; TRUE, wenn die Transition immer schalten soll.",
    "Nothing, if the step is meant for one scan; else correct the condition.": (
        "Nichts, wenn der Schritt für einen Zyklus gedacht ist; sonst die Bedingung berichtigen."
    ),
    "Correct the condition, or remove the transition.": "Die Bedingung berichtigen oder die Transition entfernen.",
    "Write the variable in an action of the step before.": "Die Variable in einer Aktion des Schritts davor schreiben.",
    "Call the block in an action, or before the chart, and ask for its output. "
    "For times there is the time of the step.": (
        "Den Baustein in einer Aktion oder vor der Ablaufkette aufrufen und seinen Ausgang abfragen. "
        "Für Zeiten gibt es die Zeit des Schritts."
    ),
    "Ask for the step (X12) instead of what it writes.": "Den Schritt (X12) abfragen statt dessen, was er schreibt.",
    "Add the transition object, or correct its name.": "Das Transitionsobjekt ergänzen oder seinen Namen berichtigen.",
    "Correct the name.": "Den Namen berichtigen.",
    "Write a * b, a + b, /a, ↑a, [C1>3] or 3s/X2; a AND b, a OR b, NOT a mean the same.": (
        "a * b, a + b, /a, ↑a, [C1>3] oder 3s/X2 schreiben; a AND b, a OR b, NOT a bedeuten dasselbe."
    ),
    "Compare it: n <> 0, t > T#2s.": "Vergleichen: n <> 0, t > T#2s.",
    "Add the time.": "Die Zeit ergänzen.",
    "Use S and R, or the continuous action in every step.": (
        "S und R verwenden oder die kontinuierliche Aktion in jedem Schritt."
    ),
    "Add an action with R to the step in which it shall end.": (
        "In dem Schritt, in dem es enden soll, eine Aktion mit R ergänzen."
    ),
    "Let one place write the variable; let the steps set variables of their own, and join these.": (
        "Die Variable an einer Stelle schreiben; die Schritte setzen eigene Variablen, die dort verknüpft werden."
    ),
    "Remove the time, or use the qualifier that was meant.": (
        "Die Zeit entfernen oder das gemeinte Bestimmungszeichen verwenden."
    ),
    "Use the same time everywhere, or actions of their own.": "Überall dieselbe Zeit verwenden oder eigene Aktionen.",
    "Express it in another way: P1 is the event S1 of S7-GRAPH, SD a set action and a timer.": (
        "Es anders ausdrücken: P1 ist das Ereignis S1 von S7-GRAPH, SD eine gesetzte Aktion und ein Zeitglied."
    ),
    "Name the action, or remove the line.": "Die Aktion nennen oder die Zeile entfernen.",
    "Add the action, or correct the name.": "Die Aktion ergänzen oder den Namen berichtigen.",
    "Look where it is set; correct the name if it is another.": (
        "Prüfen, wo sie gesetzt wird; den Namen berichtigen, wenn eine andere gemeint ist."
    ),
    "Watch for the change: ↑a instead of a.": "Auf die Änderung achten: ↑a statt a.",
    "Use an action on event, or the value itself.": "Eine Aktion bei Ereignis verwenden oder den Wert selbst.",
    "Use a BOOL, or assign the value in an action.": (
        "Eine Variable vom Typ BOOL verwenden oder den Wert in einer Aktion zuweisen."
    ),
    "Put several of them into one action, or into a step that is active at the same time.": (
        "Mehrere davon in eine Aktion legen oder in einen Schritt, der gleichzeitig aktiv ist."
    ),
    "Let a step with the transition TRUE before it do what the initial step shall do.": (
        "Was der Initialschritt tun soll, in einen Schritt mit der Transition TRUE davor legen."
    ),
    "Add the event (S1: when the step becomes active), or name a step of this block.": (
        "Das Ereignis ergänzen (S1: wenn der Schritt aktiv wird) oder einen Schritt dieses Bausteins nennen."
    ),
    "Program the interlock or supervision, or remove the event.": (
        "Verriegelung oder Überwachung programmieren oder das Ereignis entfernen."
    ),
    "Remove one of them, or use P1 and P0.": "Eine davon entfernen oder P1 und P0 verwenden.",
    "End it with an R, or set it in code too: a P1 action with an assignment.": (
        "Mit R beenden oder auch im Code setzen: eine P1-Aktion mit einer Zuweisung."
    ),
    "Remove one of them, or rename it.": "Eine davon entfernen oder umbenennen.",
    "{} has a variable {} already": "{} hat schon eine Variable {}",
    "Give it a name of letters, digits and underscores that is no keyword.": (
        "Einen Namen aus Buchstaben, Ziffern und Unterstrichen geben, der kein Schlüsselwort ist."
    ),
    "{} is a keyword, which no tool takes as a name": "{} ist ein Schlüsselwort, das kein Werkzeug als Namen annimmt",
    "{} is a keyword, which a condition reads as such": "{} ist ein Schlüsselwort, das Bedingungen als solches lesen",
    "a condition does not read {} as one name": "eine Bedingung liest {} nicht als einen Namen",
    "Declare it, or correct the name.": "Ihn deklarieren oder berichtigen.",
    "Export them too, where names shall be checked and renamed with the chart.": (
        "Sie mit exportieren, wenn Namen geprüft und mit der Ablaufkette umbenannt werden sollen."
    ),
    "Remove it: `project.edit().remove_unused()` removes all of them.": (
        "Entfernen: `project.edit().remove_unused()` entfernt alle."
    ),
    "Let one transition of the circle wait for something else, such as an edge.": "Eine Transition des Kreises auf "
    "etwas anderes warten lassen, etwa auf eine Flanke.",
    "Ask for something that comes later, or for an edge: the next press of the button, not the same.": (
        "Etwas abfragen, das später kommt, oder eine Flanke: den nächsten Tastendruck, nicht denselben."
    ),
    "Correct one of the times.": "Eine der Zeiten berichtigen.",
    "Name the expansion, and give it an entry step E and an exit step S.": (
        "Die Expansion nennen und ihr einen Eingangsschritt E und einen Ausgangsschritt S geben."
    ),
    "Correct the name of the chart or of the step, or mark the steps that shall be activated.": (
        "Den Namen des Teilplans oder des Schritts berichtigen oder die zu aktivierenden Schritte kennzeichnen."
    ),
    "Make a step of the enclosed chart initial.": (
        "Einen Schritt des eingeschlossenen Teilplans zum Initialschritt machen."
    ),
    "Correct the name of the chart or the list of steps.": (
        "Den Namen des Teilplans oder die Liste der Schritte berichtigen."
    ),
    "Move the order into a chart of its own, above both.": "Den Befehl in einen eigenen Teilplan über beiden verlegen.",
    "Let the steps that give the orders exclude each other.": (
        "Die Schritte, die die Befehle geben, einander ausschließen lassen."
    ),
    "Rename the step.": "Den Schritt umbenennen.",
    "Name it in a step, or remove it.": "Ihn in einem Schritt nennen oder entfernen.",
    "Divide the chart into several blocks, or take parts of it out into blocks of their own.": (
        "Die Ablaufkette auf mehrere Bausteine verteilen oder Teile in eigene Bausteine legen."
    ),
    "Nothing, unless the chart becomes a classic flip-flop chain: lower it in another way, or insert a step.": (
        "Nichts, außer für eine klassische Kette von Speichergliedern: anders umsetzen oder einen Schritt einfügen."
    ),
    "Insert a step, if the step shall be entered again; remove the transition, if not.": (
        "Einen Schritt einfügen, wenn der Schritt erneut aktiv werden soll; sonst die Transition entfernen."
    ),
    "Write plcopen-sfc: ignore and the codes behind it, with commas between.": (
        "plcopen-sfc: ignore schreiben und dahinter die Kennzeichen, durch Kommas getrennt."
    ),
}
"""Hints of the rules: how to mend a breach."""

_MESSAGES = {
    "{+} is assigned to {+}: {}": "{} wird {} zugewiesen: {}",
    "{+} and {+}: {}": "{} und {}: {}",
    "{+} and {+} and {+}: {}": "{} und {} und {}: {}",
    "a condition is {+}: {}": "eine Bedingung ist {}: {}",
    "a CASE asks for {}: {}": "ein CASE fragt nach {}: {}",
    "AND of {+}: {}": "AND von {}: {}",
    "OR of {+}: {}": "OR von {}: {}",
    "XOR of {+}: {}": "XOR von {}: {}",
    "{} of {} is {+}, not {+}": "{} von {} ist {}, nicht {}",
    "a number": "eine Zahl",
    "an array": "ein Feld",
    "an instance": "eine Instanz",
    "{} is set here ({}), and step {} writes it continuously ({})": (
        "{} wird hier gesetzt ({}), und Schritt {} schreibt es kontinuierlich ({})"
    ),
    "{} is reset here ({}), and step {} writes it continuously ({})": (
        "{} wird hier zurückgesetzt ({}), und Schritt {} schreibt es kontinuierlich ({})"
    ),
    "{} is stored here ({}), and step {} writes it continuously ({})": (
        "{} wird hier gespeichert ({}), und Schritt {} schreibt es kontinuierlich ({})"
    ),
    "{} is set ({}), and nothing resets it": "{} wird gesetzt ({}), und nichts setzt es zurück",
    "{} is reset, and nothing sets it": "{} wird zurückgesetzt, und nichts setzt es",
    "the step sets {} ({}) and resets it: the reset wins": (
        "der Schritt setzt {} ({}) und setzt es zurück: das Rücksetzen überwiegt"
    ),
    "{} is assigned here, and stored ({}) in step {}": "{0} wird hier zugewiesen und in Schritt {2} gespeichert ({1})",
    "{} is written here and in step {}, and both can be active together": (
        "{} wird hier und in Schritt {} geschrieben, und beide können gleichzeitig aktiv sein"
    ),
    "{} is written here and in step {}, and both happen when {} is cleared": (
        "{} wird hier und in Schritt {} geschrieben, und beides geschieht, wenn {} schaltet"
    ),
    "{} is written here and in step {}, and {} and {} can be cleared together": (
        "{} wird hier und in Schritt {} geschrieben, und {} und {} können gleichzeitig schalten"
    ),
    "the qualifier {} needs a time": "das Bestimmungszeichen {} braucht eine Zeit",
    "the time {} has no effect with the qualifier {}": "die Zeit {} hat mit dem Bestimmungszeichen {} keine Wirkung",
    "{} has another time here ({}) than in step {}": "{} hat hier eine andere Zeit ({}) als in Schritt {}",
    "there is no qualifier {} here": "das Bestimmungszeichen {} gibt es hier nicht",
    "the association names no action and no variable": "die Zuordnung nennt weder Aktion noch Variable",
    "the POU has no action {}, the entry action of the step": (
        "der Baustein hat keine Aktion {}, die Eingangsaktion des Schritts"
    ),
    "the POU has no action {}, the main action of the step": (
        "der Baustein hat keine Aktion {}, die Hauptaktion des Schritts"
    ),
    "the POU has no action {}, the exit action of the step": (
        "der Baustein hat keine Aktion {}, die Ausgangsaktion des Schritts"
    ),
    "the step has {} associations": "der Schritt hat {} Aktionszuordnungen",
    "the initial step has an association": "der Initialschritt hat eine Aktionszuordnung",
    "the qualifier {} needs an event": "das Bestimmungszeichen {} braucht ein Ereignis",
    "{} names {}, which is no step of this block": "{} nennt {}: das ist kein Schritt dieses Bausteins",
    "the action depends on the interlock, and the step has none": (
        "die Aktion hängt von der Verriegelung ab, und der Schritt hat keine"
    ),
    "the event {} never comes: the step has no interlock": (
        "das Ereignis {} tritt nie ein: der Schritt hat keine Verriegelung"
    ),
    "the event {} never comes: the step has no supervision": (
        "das Ereignis {} tritt nie ein: der Schritt hat keine Überwachung"
    ),
    "the event of the action is no edge": "das Ereignis der Aktion ist keine Flanke",
    "the event {} never comes while step {} is active": (
        "das Ereignis {} tritt nie ein, solange der Schritt {} aktiv ist"
    ),
    "{} is no continuous action": "{} ist keine kontinuierliche Aktion",
    "the action has no event": "die Aktion hat kein Ereignis",
    "the condition of a continuous action is an edge": "die Bedingung einer kontinuierlichen Aktion ist eine Flanke",
    "{} is no BOOL but {}": "{} ist nicht vom Typ BOOL, sondern {}",
    "the minimum time {} is longer than the maximum time {}": "die Minimalzeit {} ist länger als die Maximalzeit {}",
    "the warning time {} is longer than the maximum time {}": "die Warnzeit {} ist länger als die Maximalzeit {}",
    "the step encloses {}, and there is no such chart": (
        "der Schritt schließt {} ein, und diesen Teilplan gibt es nicht"
    ),
    "{} is enclosed by {}, too": "{} wird auch von {} eingeschlossen",
    "{} has no step {} to activate": "{} hat keinen Schritt {}, der aktiviert werden könnte",
    "no step of {} has an activation link": "kein Schritt von {} ist als zu aktivierend gekennzeichnet",
    "the step is initial, and {}, which it encloses, has no initial step": (
        "der Schritt ist Initialschritt, und {}, den er einschließt, hat keinen Initialschritt"
    ),
    "the order forces {}, and there is no such chart": "der Befehl steuert {}, und diesen Teilplan gibt es nicht",
    "{} has no step {} to force": "{} hat keinen Schritt {}, der zu steuern wäre",
    "{} has no initial step to force": "{} hat keinen Initialschritt, der zu steuern wäre",
    "the order names no steps to force": "der Befehl nennt keine Schritte",
    "the chart is ruled by one that it rules itself": ("den Teilplan steuert einer, den er selbst steuert"),
    "step {} rules {} as well, and both can be active together": (
        "auch Schritt {} steuert {}, und beide können gleichzeitig aktiv sein"
    ),
    "{}: macro-step without expansion; {}": "{}: Makroschritt ohne Expansion",
    "{}: macro-step that contains itself; {}": "{}: Makroschritt, der sich selbst enthält",
    "{}: expansion without entry step; {}": "{}: Expansion ohne Eingangsschritt",
    "{}: expansion without exit step; {}": "{}: Expansion ohne Ausgangsschritt",
    "{}: expansion with several entry steps; {}": "{}: Expansion mit mehreren Eingangsschritten",
    "{}: expansion with several exit steps; {}": "{}: Expansion mit mehreren Ausgangsschritten",
    "the name of the macro-step does not begin with M": "der Name des Makroschritts beginnt nicht mit M",
    "the name of the entry step does not begin with E": "der Name des Eingangsschritts beginnt nicht mit E",
    "the name of the exit step does not begin with S": "der Name des Ausgangsschritts beginnt nicht mit S",
    "no step uses the chart {}: it is never active": "kein Schritt benutzt den Teilplan {}: er ist nie aktiv",
    "{} joins {&}, which were not forked together": "{} führt {} zusammen, die nicht gemeinsam begonnen haben",
    "{} joins {&}, of which only one can be active": "{} führt {} zusammen, von denen nur einer aktiv sein kann",
    "the branches of {&} at {} run together without a join": (
        "die Zweige von {} laufen bei {} ohne Zusammenführung ineinander"
    ),
    "the branches of {&} at {} run together without a join: {}": (
        "die Zweige von {} laufen bei {} ohne Zusammenführung ineinander: {}"
    ),
    "the branch of step {} at {} is connected with its outside": (
        "der Zweig von Schritt {} ist bei {} mit seiner Umgebung verbunden"
    ),
    "the branch of step {} at {} is connected with its outside: {}": (
        "der Zweig von Schritt {} ist bei {} mit seiner Umgebung verbunden: {}"
    ),
    "{} forks branches of which another transition forks some, too": (
        "{} beginnt Zweige, von denen eine andere Transition einige ebenfalls beginnt"
    ),
    "{} and {} lead to each other": "{} und {} führen zueinander",
    "the transition leads from {} to itself": "die Transition führt von {} zu ihm selbst",
    "{} sequences; a block has {} at most": "{} Ketten; ein Baustein hat höchstens {}",
    "{} steps; a block has {} at most": "{} Schritte; ein Baustein hat höchstens {}",
    "{} transitions; a block has {} at most": "{} Transitionen; ein Baustein hat höchstens {}",
    "{} branches; a block has {} at most": "{} Verzweigungen; ein Baustein hat höchstens {}",
    "{} alternative paths; a branch has {} at most": "{} Alternativzweige; eine Verzweigung hat höchstens {}",
    "{} simultaneous paths; a branch has {} at most": "{} Simultanzweige; eine Verzweigung hat höchstens {}",
    "{} names nothing that the project declares": "{} nennt nichts, was das Projekt deklariert",
    "{} names no type that the project declares": "{} nennt keinen Typ, den das Projekt deklariert",
    "{} is no parameter of {}": "{} ist kein Parameter von {}",
    "{} contains itself": "{} enthält sich selbst",
    "{} contains itself through {&}": "{} enthält sich selbst über {}",
    "{} names no step that the project declares": "{} nennt keinen Schritt, den das Projekt deklariert",
    "{} is no member of what is before it": "{} ist kein Element dessen, was davor steht",
    "Did you mean {}?": "Ist {} gemeint?",
    "Insert a step.": "Einen Schritt einfügen.",
    "Insert a transition.": "Eine Transition einfügen.",
    "declared elsewhere: {}": "an anderer Stelle deklariert: {}",
    "declared elsewhere: {} and {} more": "an anderer Stelle deklariert: {} und {} weitere",
    "nothing uses the action {}": "nichts verwendet die Aktion {}",
    "nothing uses the transition {}": "nichts verwendet die Transition {}",
    "nothing uses the variable {}": "nichts verwendet die Variable {}",
    "nothing uses the method {}": "nichts verwendet die Methode {}",
    "always true in a circle: {}": "immer wahr im Kreis: {}",
    "as long as the condition of {} is true, a circle fires without end: {}": "solange die Bedingung von {} wahr ist, "
    "schaltet ein Kreis ohne Ende: {}",
    "whenever the step is entered, a transition that leaves it is true already": (
        "wird der Schritt aktiv, ist eine Transition, die ihn verlässt, bereits wahr"
    ),
    "the step can never become active": "der Schritt kann nie aktiv werden",
    "{} would activate step {} while it is active: at the start the active steps are {&}": (
        "{} würde Schritt {} aktivieren, während er aktiv ist: am Anfang sind aktiv: {}"
    ),
    "{} would activate step {} while it is active: after {&} the active steps are {&}": (
        "{} würde Schritt {} aktivieren, während er aktiv ist: nach {} sind aktiv: {}"
    ),
    "the chart is too large to say which, but a step can be activated twice": (
        "die Ablaufkette ist zu groß, um zu sagen welcher, aber ein Schritt kann zweimal aktiviert werden"
    ),
    "{&} are never active together: the transition is never enabled": (
        "{} sind nie gleichzeitig aktiv: die Transition wird nie freigegeben"
    ),
    "nothing leads on from {&} together: at the start": "von {} zusammen führt nichts weiter: am Anfang",
    "nothing leads on from {&} together: after {&}": "von {} zusammen führt nichts weiter: nach {}",
    "from {&} no way leads back to {&}: at the start": "von {} führt kein Weg zurück zu {}: am Anfang",
    "from {&} no way leads back to {&}: after {&}": "von {} führt kein Weg zurück zu {}: nach {}",
    "the comment suppresses {}, and there is no such rule": "der Kommentar schaltet {} ab, aber das ist keine Regel",
    "the comment suppresses nothing: it names no rule": "der Kommentar schaltet nichts ab: er nennt keine Regel",
    "{+} leads to {+} without a step between": "{} führt zu {} ohne Schritt dazwischen",
    "{+} leads to {+} without a transition between": "{} führt zu {} ohne Transition dazwischen",
    "a transition": "eine Transition",
    "a step": "ein Schritt",
    "step {}": "Schritt {}",
    "transition {}": "Transition {}",
    "the jump to {}": "der Sprung zu {}",
    "the jump to nowhere": "der Sprung ins Leere",
    "{+} stands above a {+}, where {+} belong": "{} steht über einer {}, wo {} hingehören",
    "{+} stands below a {+}, where {+} belong": "{} steht unter einer {}, wo {} hingehören",
    "steps": "Schritte",
    "transitions": "Transitionen",
    "selection divergence": "Alternativverzweigung",
    "selection convergence": "Alternativzusammenführung",
    "simultaneous divergence": "Simultanverzweigung",
    "simultaneous convergence": "Simultanzusammenführung",
    "the transition leads from a step that does not exist": "die Transition kommt von einem Schritt, den es nicht gibt",
    "the transition leads to a step that does not exist": "die Transition führt zu einem Schritt, den es nicht gibt",
    "a jump leads to {}, which is no step of this chart": "ein Sprung führt zu {}: das ist kein Schritt dieser Kette",
    "another step of the chart is called {}, too": "auch ein anderer Schritt der Kette heißt {}",
    "the name {} is no identifier": "der Name {} ist kein Bezeichner",
    "the step has no name": "der Schritt hat keinen Namen",
    "the POU has an action of the same name": "der Baustein hat eine Aktion dieses Namens",
    "the POU has a transition of the same name": "der Baustein hat eine Transition dieses Namens",
    "the POU has a variable of the same name": "der Baustein hat eine Variable dieses Namens",
    "another step has the number {}, too": "auch ein anderer Schritt hat die Nummer {}",
    "another transition has the number {}, too": "auch eine andere Transition hat die Nummer {}",
    "a step of the block has the name {}, too": "auch ein Schritt des Bausteins heißt {}",
    "a transition of the block has the name {}, too": "auch eine Transition des Bausteins heißt {}",
    "no step is initial: it starts with its first step": "kein Schritt ist Initialschritt: sie beginnt mit dem ersten",
    "no step is initial: the chart never starts": "kein Schritt ist Initialschritt: die Ablaufkette beginnt nie",
    "no step of sequence {} is initial: it starts with its first step": (
        "kein Schritt der Kette {} ist Initialschritt: sie beginnt mit dem ersten"
    ),
    "a second initial step in one connected chart, besides {}": (
        "ein zweiter Initialschritt in einer zusammenhängenden Ablaufkette, neben {}"
    ),
    "no transition leaves the step: the chart stays in it": (
        "keine Transition verlässt den Schritt: die Ablaufkette bleibt in ihm"
    ),
    "the transition leads nowhere: what was active before it just ends": (
        "die Transition führt nirgendwohin: was vor ihr aktiv war, endet einfach"
    ),
    "no step leads to the transition": "kein Schritt führt zu der Transition",
    "it can be true together with {}, which leaves {} too": (
        "sie kann gleichzeitig mit {} wahr sein, die ebenfalls {} verlässt"
    ),
    "it can be true together with {}, which leaves {} too: {}": (
        "sie kann gleichzeitig mit {} wahr sein, die ebenfalls {} verlässt: {}"
    ),
    "it is unknown whether it excludes {}, which leaves {} too": (
        "ob sie {} ausschließt, die ebenfalls {} verlässt, ist nicht bekannt"
    ),
    "it is unknown whether it excludes {}, which leaves {} too: {+}": (
        "ob sie {} ausschließt, die ebenfalls {} verlässt, ist nicht bekannt: {}"
    ),
    "whenever its condition is true, one tried before it is: {} (from {})": (
        "immer wenn ihre Bedingung wahr ist, ist es auch eine vorher geprüfte: {} (von {})"
    ),
    "it has the priority {}, as {} has, which leaves {} too": (
        "sie hat die Priorität {} wie {}, die ebenfalls {} verlässt"
    ),
    "the transition has no condition": "die Transition hat keine Bedingung",
    "the condition {} is not Boolean: it is {+}": "die Bedingung {} ist nicht boolesch, sondern {}",
    "a number or a time": "eine Zahl oder eine Zeit",
    "of type {}": "vom Typ {}",
    "a structure": "eine Struktur",
    "a string": "eine Zeichenkette",
    "a value of an enumeration": "ein Wert einer Aufzählung",
    "{} is a step and no value: its flag is {}": "{} ist ein Schritt und kein Wert: sein Merker ist {}",
    "{} is a BOOL: it has no {}; AND is written * or . between blanks": (
        "{} ist ein BOOL und hat kein {}; UND schreibt man * oder . zwischen Leerzeichen"
    ),
    "the condition {} cannot be read: {}": "die Bedingung {} ist nicht lesbar: {}",
    "a dot in {} is that of a member, and a BOOL and a flag have none": (
        "ein Punkt in {} ist der eines Elements, und ein BOOL und ein Merker haben keines"
    ),
    "Write * or AND for the dot, or blanks beside it: a * b, a . b.": (
        "Für den Punkt * oder AND schreiben, oder Leerzeichen daneben: a * b, a . b."
    ),
    "what the action does, {}, cannot be read: {}": "was die Aktion tut, {}, ist nicht lesbar: {}",
    "Write a value or statements in structured text.": "Einen Wert oder Anweisungen in strukturiertem Text schreiben.",
    "the condition {} is always true": "die Bedingung {} ist immer wahr",
    "the condition {} is never true": "die Bedingung {} ist nie wahr",
    "the condition writes {}": "die Bedingung schreibt {}",
    "the condition calls {}, which keeps values between calls": (
        "die Bedingung ruft {} auf, das Werte von Aufruf zu Aufruf behält"
    ),
    "the condition reads {}, which the chart writes": "die Bedingung liest {}, das die Ablaufkette schreibt",
    "the POU has no transition and no variable {}": "der Baustein hat keine Transition und keine Variable {}",
    "{} asks for a step {}, and there is no such step": "{} fragt nach einem Schritt {}, den es nicht gibt",
}
"""Messages of findings, by their English."""

_READ = {
    "the condition of a transition is wired to nothing": "die Bedingung einer Transition ist mit nichts verbunden",
    "a transition has no condition": "eine Transition hat keine Bedingung",
    "no step leads to this transition": "kein Schritt führt zu dieser Transition",
    "nothing leads on from this step": "von diesem Schritt führt nichts weiter",
    "this transition leads nowhere": "diese Transition führt nirgendwohin",
    "a step leads here without a transition between": "ein Schritt führt ohne Transition dazwischen hierher",
    "{} leads to element {}, which does not exist": "{} führt zu Element {}, das es nicht gibt",
    "a connection leads to element {}, which does not exist": "eine Verbindung führt zu Element {}, das es nicht gibt",
    "localId {} is used twice in one body": "die localId {} wird in einem Rumpf zweimal verwendet",
    "<{}> has no usable localId": "<{}> hat keine brauchbare localId",
    "a connection has no id of the element that it leads to": (
        "eine Verbindung nennt nicht die id des Elements, zu dem sie führt"
    ),
    "the connections of the chart are kept but not understood: {}": (
        "die Verbindungen der Ablaufkette bleiben erhalten, sind aber nicht verständlich: {}"
    ),
    "an action block is wired to no step; it is kept in the file but not part of the chart": (
        "ein Aktionsblock ist mit keinem Schritt verbunden; er bleibt in der Datei, gehört aber nicht zur Ablaufkette"
    ),
    "{} is a second initial step, besides {}": "{} ist ein zweiter Initialschritt, neben {}",
    "the chart has no initial step": "die Ablaufkette hat keinen Initialschritt",
    "two steps have the name {}": "zwei Schritte heißen {}",
    "a step has no usable number": "ein Schritt hat keine brauchbare Nummer",
    "a transition has no usable number": "eine Transition hat keine brauchbare Nummer",
    "a branch is damaged": "eine Verzweigung ist beschädigt",
    "the number {} belongs to two steps": "die Nummer {} gehört zu zwei Schritten",
    "the number {} belongs to two transitions": "die Nummer {} gehört zu zwei Transitionen",
    "FROM names {}, which is no step of this chart": "FROM nennt {}: das ist kein Schritt dieser Ablaufkette",
    "TO names {}, which is no step of this chart": "TO nennt {}: das ist kein Schritt dieser Ablaufkette",
    "found {+}, expected {+}": "gefunden: {}, erwartet: {}",
    "found {+}, expected {+} in line {#}": "gefunden: {}, erwartet: {}, in Zeile {}",
    "found {+}, expected {+} for the {} in line {#}": "gefunden: {}, erwartet: {}, für {} in Zeile {}",
    "{} cannot stand here": "{} kann hier nicht stehen",
    "{} cannot stand here: structured text has {}: {} and then {}": (
        "{} kann hier nicht stehen: strukturierter Text hat {}: {}, dann {}"
    ),
    "{} cannot stand here: structured text has {}": "{} kann hier nicht stehen: strukturierter Text hat {}",
    "these statements belong to no step, action or transition": (
        "diese Anweisungen gehören zu keinem Schritt, keiner Aktion und keiner Transition"
    ),
    "the action belongs to no step: it is never executed, and left out where the file is written for another one": (
        "die Aktion gehört zu keinem Schritt: sie wird nie ausgeführt und fehlt, wo die Datei neu geschrieben wird"
    ),
    "the link joins no step with an action: it is never executed, and left out where the file is written for "
    "another one": (
        "der Link verbindet keinen Schritt mit einer Aktion: er wird nie ausgeführt und fehlt, wo die Datei neu "
        "geschrieben wird"
    ),
    "<{}> is a type of a kind that is not known; it is kept as it is": (
        "<{}> ist ein Typ einer unbekannten Art; er bleibt, wie er ist"
    ),
    "the network is damaged, and kept as it is: {}": "das Netzwerk ist beschädigt und bleibt, wie es ist: {}",
    "the keyword {}": "das Schlüsselwort {}",
    "{} or a name": "{} oder ein Name",
    "this is no declaration: {+}": "das ist keine Deklaration: {}",
    "variables in an action: they are those of the POU now": (
        "Variablen in einer Aktion: sie sind jetzt die des Bausteins"
    ),
    "objects that are kept in the file as they are, and nowhere else: {}": (
        "Objekte, die in der Datei erhalten bleiben, wie sie sind, und nirgends sonst: {}"
    ),
    "the file names no code page; taken as {}, which is a guess: {}": (
        "die Datei nennt keine Codepage; gelesen als {}, das ist eine Vermutung: {}"
    ),
    "not in UTF-8 and without a byte order mark; taken as {}": (
        "nicht in UTF-8 und ohne Byte-Reihenfolge-Marke; gelesen als {}"
    ),
    "the file has no byte order mark and is not in UTF-8; taken as {}, which is a guess": (
        "die Datei hat keine Byte-Reihenfolge-Marke und ist nicht in UTF-8; gelesen als {}, das ist eine Vermutung"
    ),
    "{+} (did you mean {}?)": "{} (gemeint {}?)",
    "{} is no qualifier of actions": "{} ist kein Bestimmungszeichen von Aktionen",
    "there is no step {}": "es gibt keinen Schritt {}",
    "{}: it is no duration, such as T#5s, and no expression; a time has a unit, such as 2s or T#1m30s": (
        "{}: das ist keine Dauer wie T#5s und kein Ausdruck; eine Zeit hat eine Einheit, etwa 2s oder T#1m30s"
    ),
}
"""Messages of readers about charts and files, by their English."""


@lru_cache(maxsize=4096)
def german_finding(message: str) -> str:
    """Return the message or the hint of a finding in German; itself where no translation is known."""
    return german_label(_PHRASES(message))


_PHRASES = Phrases({**_HINTS, **_MESSAGES, **_READ}, german_finding)
