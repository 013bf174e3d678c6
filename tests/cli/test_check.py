"""check and rules: what they print as text, JSON and SARIF, configuration, exit codes."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.checks import all_rules
from plcopen_sfc.analysis.checks.rule_table import catalogue

PRESS = "twincat/press_station.xml"
SOUND = "codesys/sorting_conveyor.xml"
WRONG = "broken/jump_to_nowhere.xml"


@pytest.fixture
def place(fixtures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of its own, with two files, to put a configuration beside them."""
    (tmp_path / "line").mkdir()
    shutil.copy(fixtures / PRESS, tmp_path / "line" / "press.xml")
    shutil.copy(fixtures / WRONG, tmp_path / "wrong.xml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def found_codes(outcome: Any) -> list[str]:
    files = json.loads(outcome.out)["files"]
    return [finding["code"] for file in files for finding in file.get("findings", ())]


class TestText:
    def test_findings_have_file_line_path_and_hint(self, cli, fixtures):
        outcome = cli("check", WRONG)
        assert outcome.code == 1
        lines = outcome.out.splitlines()
        at = next(i for i, line in enumerate(lines) if "STR05" in line)
        assert lines[at].startswith("broken/jump_to_nowhere.xml:")
        assert "(POU StirTank / transition Drain -> nowhere): error STR05: a jump leads to 'Waiting'" in lines[at]
        assert lines[at + 1].startswith("  Correct")
        assert lines[-1].startswith("broken/jump_to_nowhere.xml: ")

    def test_a_sound_file(self, cli, fixtures):
        outcome = cli("check", SOUND, "--select", "STR")
        assert (outcome.code, outcome.err) == (0, "")
        assert outcome.out == f"{SOUND}: nothing found\n"

    def test_quiet_prints_findings_only(self, cli, fixtures):
        lines = cli("check", "-q", WRONG, SOUND, "--select", "STR05").out.splitlines()
        assert len(lines) == 1
        assert "STR05" in lines[0]

    def test_what_the_reader_says_goes_to_standard_error_but_not_twice(self, cli, fixtures):
        outcome = cli("check", "broken/connection_to_nothing.xml", WRONG)
        assert "SFC102" in outcome.err
        assert "SFC103" not in outcome.err + outcome.out  # STR05 says it

    def test_an_unreadable_file_does_not_keep_the_others_from_it(self, cli, fixtures):
        outcome = cli("check", "broken/truncated.xml", WRONG)
        assert outcome.code == 2
        assert "truncated.xml" in outcome.err
        assert "STR05" in outcome.out


class TestExitCodes:
    @pytest.mark.parametrize(
        ("select", "fail_on", "code"),
        [
            ("STR01", None, 1),
            ("STR01", "error", 1),
            ("STR01", "never", 0),
            ("STR02", None, 0),
        ],
    )
    def test_errors(self, cli, fixtures, select, fail_on, code):
        more = ["--fail-on", fail_on] if fail_on else []
        assert cli("check", PRESS, "--select", select, *more).code == code

    def test_severities_below_the_limit_do_not_fail(self, cli, fixtures):
        usual = cli("check", PRESS, "--select", "STR09", "--profile", "grafcet")
        assert "info STR09" in usual.out
        assert usual.code == 0
        assert cli("check", PRESS, "--select", "STR09", "--profile", "grafcet", "--fail-on", "info").code == 1

    @pytest.mark.parametrize(
        "arguments",
        [
            ("--select", "STR99"),
            ("--select", ""),
            ("--select", ","),
            ("--ignore", "NOPE"),
            ("--profile", "graph5"),
            ("--fail-on", "bad"),
            ("--format", "xml"),
        ],
    )
    def test_what_is_unknown_is_wrong_usage(self, cli, fixtures, arguments):
        outcome = cli("check", SOUND, *arguments)
        assert outcome.code == 2
        assert outcome.out == ""
        assert "there is no" in outcome.err


class TestJson:
    def test_findings_with_place_and_hint(self, cli, fixtures):
        [file] = json.loads(cli("check", WRONG, "--json", "--select", "STR05").out)["files"]
        [finding] = file["findings"]
        assert file["file"] == finding["file"] == WRONG
        assert finding["path"] == "POU StirTank / transition Drain -> nowhere"
        assert {"code", "severity", "message", "line", "hint"} <= finding.keys()
        assert cli("check", WRONG, "--format", "json").out == cli("check", WRONG, "--json").out

    def test_files_that_cannot_be_read_have_their_error(self, cli, fixtures):
        outcome = cli("check", "broken/truncated.xml", WRONG, "--json")
        first, second = json.loads(outcome.out)["files"]
        assert outcome.code == 2
        assert first["error"]["type"] == "XmlSyntaxError"
        assert second["findings"]


class TestSelectedRules:
    def test_several_codes(self, cli, fixtures):
        together = cli("check", PRESS, "--json", "--select", "STR01,STR09")
        assert sorted(set(found_codes(together))) == ["STR01", "STR09"]
        apart = cli("check", PRESS, "--json", "--select", "STR01", "--select", "STR09")
        assert apart.out == together.out

    def test_ignored(self, cli, fixtures):
        assert "STR09" not in found_codes(cli("check", PRESS, "--json", "--ignore", "STR09"))

    def test_the_profile_decides(self, cli, fixtures):
        assert "warning STR09" in cli("check", PRESS, "--profile", "iec", "--select", "STR09").out


class TestConfiguration:
    def test_of_the_folder_above(self, cli, place):
        (place / "pyproject.toml").write_text('[tool.plcopen_sfc]\nselect = ["STR09"]\n', encoding="utf-8")
        assert set(found_codes(cli("check", "line/press.xml", "--json"))) == {"STR09"}

    def test_the_nearest_one_counts_and_one_without_the_table_does_not(self, cli, place):
        (place / "pyproject.toml").write_text('[tool.plcopen_sfc]\nselect = ["STR09"]\n', encoding="utf-8")
        nearer = place / "line" / "pyproject.toml"
        nearer.write_text('[tool.plcopen_sfc]\nselect = ["STR01"]\n', encoding="utf-8")
        assert set(found_codes(cli("check", "line/press.xml", "--json"))) == {"STR01"}
        nearer.write_text('[project]\nname = "x"\n', encoding="utf-8")
        assert set(found_codes(cli("check", "line/press.xml", "--json"))) == {"STR09"}

    def test_of_a_folder_is_also_that_in_it(self, cli, place, fixtures):
        shutil.copytree(fixtures / "simaticml", place / "blocks")
        (place / "blocks" / "pyproject.toml").write_text('[tool.plcopen_sfc]\nselect = ["SEL03"]\n', encoding="utf-8")
        assert set(found_codes(cli("check", place / "blocks", "--json"))) == {"SEL03"}

    def test_options_replace_it(self, cli, place):
        (place / "pyproject.toml").write_text(
            '[tool.plcopen_sfc]\nselect = ["STR09"]\nprofile = "iec"\nfail-on = "error"\n', encoding="utf-8"
        )
        assert cli("check", "line/press.xml").code == 0
        assert cli("check", "line/press.xml", "--fail-on", "warning").code == 1
        assert cli("check", "line/press.xml", "--profile", "codesys").code == 1
        assert set(found_codes(cli("check", "line/press.xml", "--json", "--select", "STR01"))) == {"STR01"}

    def test_each_file_has_its_own(self, cli, place):
        (place / "line" / "pyproject.toml").write_text('[tool.plcopen_sfc]\nignore = ["STR"]\n', encoding="utf-8")
        found = found_codes(cli("check", "line/press.xml", "wrong.xml", "--json", "--select", "STR05,STR01"))
        assert found == ["STR05"]

    def test_externals_are_declared_elsewhere_and_all_others_here(self, cli, place):
        project = sfc.Project(name="Part", dialect="codesys")
        do = [("N Act", "GVL_Io.xGo := fbAxis.xDone AND xOther;")]
        project.add_program("Main", sfc.step("S1", actions=do, initial=True), "a", sfc.jump("S1"))
        sfc.save(project, place / "part.xml", format="codesys")
        assert [each.code for each in sfc.check(project, select=["VAR"])] == ["VAR02"]
        (place / "pyproject.toml").write_text(
            '[tool.plcopen_sfc]\nexternals = ["GVL_*", "FBAXIS"]\nselect = ["VAR01", "VAR02"]\n', encoding="utf-8"
        )
        outcome = cli("check", "part.xml")
        assert outcome.code == 1
        assert [line.split(": ", 2)[2] for line in outcome.out.splitlines() if "VAR0" in line] == [
            "'xOther' names nothing that the project declares"
        ]

    @pytest.mark.parametrize(
        "text",
        [
            '[tool.plcopen_sfc]\nselekt = ["STR"]\n',
            '[tool.plcopen_sfc]\nselect = "STR"\n',
            '[tool.plcopen_sfc]\nselect = ["STR99"]\n',
            '[tool.plcopen_sfc]\nfail-on = "sometimes"\n',
            '[tool.plcopen_sfc]\nprofile = "graph5"\n',
            "[tool.plcopen_sfc\n",
            "[tool]\nplcopen_sfc = 1\n",
        ],
    )
    def test_what_is_wrong_in_it_is_told(self, cli, place, text):
        (place / "pyproject.toml").write_text(text, encoding="utf-8")
        outcome = cli("check", "wrong.xml")
        assert outcome.code == 2
        assert outcome.err.startswith("error: ")
        assert "bug" not in outcome.err
        assert "pyproject.toml" in outcome.err


REGION = ({"startLine": int, "startColumn": int}, ["startLine"])
LOCATIONS = [
    (
        {
            "physicalLocation": ({"artifactLocation": ({"uri": str}, ["uri"]), "region": REGION}, []),
            "logicalLocations": [({"fullyQualifiedName": str}, [])],
        },
        [],
    )
]
TEXT = ({"text": str}, ["text"])
LEVEL = ("none", "note", "warning", "error")
LOG: Any = (
    {
        "$schema": str,
        "version": ("2.1.0",),
        "runs": [
            (
                {
                    "tool": (
                        {
                            "driver": (
                                {
                                    "name": str,
                                    "version": str,
                                    "rules": [
                                        (
                                            {
                                                "id": str,
                                                "shortDescription": TEXT,
                                                "fullDescription": TEXT,
                                                "help": TEXT,
                                                "defaultConfiguration": ({"level": LEVEL}, []),
                                            },
                                            ["id"],
                                        )
                                    ],
                                },
                                ["name"],
                            )
                        },
                        ["driver"],
                    ),
                    "columnKind": ("utf16CodeUnits", "unicodeCodePoints"),
                    "invocations": [
                        (
                            {
                                "executionSuccessful": bool,
                                "toolExecutionNotifications": [
                                    ({"level": LEVEL, "message": TEXT, "locations": LOCATIONS}, ["message"])
                                ],
                            },
                            ["executionSuccessful"],
                        )
                    ],
                    "results": [
                        (
                            {
                                "ruleId": str,
                                "ruleIndex": int,
                                "level": LEVEL,
                                "message": TEXT,
                                "locations": LOCATIONS,
                                "partialFingerprints": {"*": str},
                            },
                            ["message"],
                        )
                    ],
                },
                ["tool"],
            )
        ],
    },
    ["version", "runs"],
)
"""The part of the schema of SARIF 2.1.0 that we use: objects with their properties and required ones, enumerations."""


def conforms(value: Any, schema: Any, path: str = "$") -> None:
    """Compare a value with a schema like the one above."""
    if isinstance(schema, list):
        assert isinstance(value, list), path
        for index, item in enumerate(value):
            conforms(item, schema[0], f"{path}[{index}]")
    elif isinstance(schema, dict) or (isinstance(schema, tuple) and isinstance(schema[0], dict)):
        properties, required = schema if isinstance(schema, tuple) else (schema, [])
        assert isinstance(value, dict), path
        assert set(required) <= value.keys(), path
        for key, item in value.items():
            assert key in properties or "*" in properties, f"{path}.{key}"
            conforms(item, properties.get(key, properties.get("*")), f"{path}.{key}")
    elif isinstance(schema, tuple):
        assert value in schema, path
    else:
        assert type(value) is schema, path


def test_github_shows_findings_beside_their_lines(cli, fixtures, tmp_path):
    odd = tmp_path / "a,b.csv"
    odd.write_text("Step,Next,Condition\nA,A,x\nB,B,100% AND y\n", encoding="utf-8")
    lines = cli("check", odd, "broken/truncated.xml", "--format", "github").out.splitlines()
    assert all(
        re.match(r"::(error|warning|notice) file=[^:]*,title=[A-Z]", line) or "cannot be read" in line for line in lines
    )
    assert any("a%2Cb.csv" in line for line in lines)
    assert lines[-1].startswith("::error file=broken/truncated.xml,line=")
    assert all(line.startswith("::") for line in lines), "a hint is in the line of its finding"


class TestSarif:
    def test_says_what_the_standard_knows(self, cli, fixtures):
        conforms(json.loads(cli("check", PRESS, WRONG, "broken/truncated.xml", "--format", "sarif").out), LOG)
        with pytest.raises(AssertionError, match="colour"):
            conforms({"version": "2.1.0", "runs": [], "colour": 1}, LOG)

    def test_is_a_log_of_one_run(self, cli, fixtures):
        log = json.loads(cli("check", PRESS, WRONG, "--format", "sarif").out)
        assert log["version"] == "2.1.0"
        [run] = log["runs"]
        driver = run["tool"]["driver"]
        assert driver["name"] == "plcopen-sfc"
        assert [rule["id"] for rule in driver["rules"]] == [rule.code for rule in all_rules()]
        assert run["invocations"] == [{"executionSuccessful": True}]
        assert run["results"]
        for result in run["results"]:
            assert driver["rules"][result["ruleIndex"]]["id"] == result["ruleId"]
            assert result["level"] in ("error", "warning", "note")
            assert result["message"]["text"]
            [location] = result["locations"]
            assert location["physicalLocation"]["artifactLocation"]["uri"] in (PRESS, WRONG)
            assert location["physicalLocation"]["region"]["startLine"] > 0
            assert location["logicalLocations"][0]["fullyQualifiedName"].startswith("POU ")
            assert result["partialFingerprints"]["objectPath/v1"].isalnum()

    def test_unreadable_files_are_notifications(self, cli, fixtures):
        outcome = cli("check", "broken/truncated.xml", "--format", "sarif")
        [run] = json.loads(outcome.out)["runs"]
        [invocation] = run["invocations"]
        assert outcome.code == 2
        assert invocation["executionSuccessful"] is False
        [notification] = invocation["toolExecutionNotifications"]
        assert notification["level"] == "error"
        assert "truncated" in notification["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]

    def test_file_names_are_uris(self, cli, place):
        (place / "wrong.xml").rename(place / "Anlage ä#1.xml")
        log = json.loads(cli("check", "Anlage ä#1.xml", "--format", "sarif", "--select", "STR05").out)
        [result] = log["runs"][0]["results"]
        assert result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "Anlage%20%C3%A4%231.xml"
        log = json.loads(cli("check", place / "Anlage ä#1.xml", "--format", "sarif", "--select", "STR05").out)
        uri = log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
        assert uri.startswith("file:///")
        assert uri.endswith("/Anlage%20%C3%A4%231.xml")


class TestRules:
    def test_list(self, cli):
        outcome = cli("rules")
        assert outcome.code == 0
        assert [line.split()[0] for line in outcome.out.splitlines()[1:]] == [rule.code for rule in all_rules()]

    def test_explained(self, cli):
        outcome = cli("rules", "str09")
        assert outcome.code == 0
        assert "STR09 Every step is left" in outcome.out
        assert "INITIAL_STEP" in outcome.out

    def test_json(self, cli):
        rules = json.loads(cli("rules", "--json", "STR").out)["rules"]
        assert {rule["code"][:3] for rule in rules} == {"STR"}

    def test_markdown(self, cli):
        assert cli("rules", "--markdown").out == catalogue(all_rules())

    def test_unknown(self, cli):
        assert cli("rules", "STR99").code == 2


@pytest.mark.slow
def test_validate_for_a_tool_tells_what_it_would_not_do(cli, fixtures):
    assert cli("validate", "simaticml/FB_Drill.xml", "--for", "tia-V16").code == 0
    told = cli("validate", "simaticml/FB_Drill.xml", "--for", "twincat", "--json")
    (file,) = json.loads(told.out)["files"]
    assert (told.code, file["valid"]) == (1, False)
    assert {"IMP001", "IMP002", "IMP004"} == {finding["code"] for finding in file["findings"]}
    assert cli("validate", "simaticml/FB_Drill.xml", "--for", "eplan").code == 2
