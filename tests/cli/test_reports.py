"""formats, info, validate, schema: what they print, as text and as JSON, and their exit codes."""

from __future__ import annotations

import json

import pytest

SOUND = ["codesys/sorting_conveyor.xml", "codesys/device_export.xml", "plcopen/filling_station_2.01.xml"]


def plain(text: str) -> bool:
    return "\x1b" not in text and not any("\u2500" <= sign <= "\u257f" for sign in text)


class TestReportFormats:
    def test_text(self, cli):
        outcome = cli("formats")
        assert outcome.code == 0
        assert plain(outcome.out)
        lines = outcome.out.splitlines()
        assert lines[0].split()[:3] == ["format", "extensions", "what"]
        assert {"codesys", "plcopen", "json"} <= {line.split()[0] for line in lines[1:] if line}
        assert "plcopen-2.01" in outcome.out
        assert outcome.err == ""

    def test_json(self, cli):
        formats = {each["name"]: each for each in json.loads(cli("formats", "--json").out)["formats"]}
        assert formats["plcopen"]["versions"] == ["1.01", "2.0", "2.01"]
        assert formats["iec-text"]["flavours"] == ["matiec"]


class TestSchema:
    def test_is_a_json_schema_of_the_model(self, cli):
        schema = json.loads(cli("schema").out)
        assert schema["title"] == "Project"
        assert "2020-12" in schema["$schema"]
        assert {"pous", "data_types"} <= schema["properties"].keys()


class TestInfo:
    def test_text(self, cli, fixtures):
        outcome = cli("info", "codesys/sorting_conveyor.xml")
        assert outcome.code == 0
        assert outcome.err == ""
        assert plain(outcome.out)
        assert "codesys (CODESYS V3 and TwinCAT 3 PLCopenXML, TC6 2.0)" in outcome.out
        assert "CODESYS V3.5 SP18 Patch 3" in outcome.out
        assert "UTF-8 with BOM, CRLF" in outcome.out
        row = next(line.split() for line in outcome.out.splitlines() if line.startswith("PLC_PRG "))
        assert row[:4] == ["PLC_PRG", "Init", "22", "25"]
        total = next(line.split() for line in outcome.out.splitlines() if line.startswith("3 charts"))
        assert total[2:4] == ["32", "36"]

    def test_text_is_the_same_every_time(self, cli, fixtures):
        assert cli("info", *SOUND).out == cli("info", *SOUND).out

    def test_json(self, cli, fixtures):
        outcome = cli("info", "--json", *SOUND)
        first, *others = json.loads(outcome.out)["files"]
        assert [first["file"], *(file["file"] for file in others)] == SOUND
        assert first["format"] == "codesys"
        assert first["tool"] == "CODESYS"
        assert first["totals"]["steps"] == 32
        chart = first["charts"][0]
        assert chart["name"] == "PLC_PRG"
        assert chart["initial_steps"] == ["Init"]
        assert (chart["selections"], chart["simultaneous_branches"], chart["jumps"]) == (3, 1, 3)
        assert (chart["action_associations"], chart["step_actions"]) == (20, 14)

    def test_charts_inside_of_macro_steps(self, cli, fixtures):
        charts = json.loads(cli("info", "--json", "plcopen/every_element_2.01.xml").out)["files"][0]["charts"]
        assert [chart["name"] for chart in charts] == ["Mixer", "Mixer / Heating", "Mixer.ACT_Sequence"]
        assert charts[0]["macro_steps"] == 1

    @pytest.mark.parametrize(
        ("file", "encoding"),
        [
            ("broken/umlauts_utf8.xml", "UTF-8, LF"),
            ("broken/umlauts_cp1252.xml", "CP1252, CRLF"),
            ("broken/umlauts_utf16.xml", "UTF-16-LE with BOM, CRLF"),
        ],
    )
    def test_encodings(self, cli, fixtures, file, encoding):
        assert encoding in cli("info", file).out

    def test_outlines_on_demand(self, cli, fixtures):
        assert "[[Init]]" in cli("info", "codesys/sorting_conveyor.xml").out
        assert "[[Init]]" not in cli("info", "--no-charts", "codesys/sorting_conveyor.xml").out
        assert "[[Init]]" not in cli("info", *SOUND).out
        assert "[[Init]]" in cli("info", "--charts", *SOUND).out

    def test_findings_go_to_standard_error(self, cli, fixtures):
        outcome = cli("info", "broken/two_initial_steps.xml")
        assert outcome.code == 1
        assert "StirTank" in outcome.out
        assert "SFC110" not in outcome.out
        assert outcome.err.startswith("broken/two_initial_steps.xml:150 (POU StirTank / step Stir): error SFC110: ")

    def test_one_bad_file_does_not_keep_the_others_from_being_read(self, cli, fixtures):
        outcome = cli("info", "--json", "broken/empty.xml", "codesys/sorting_conveyor.xml")
        assert outcome.code == 2
        bad, good = json.loads(outcome.out)["files"]
        assert bad["error"]["message"] == "the file is empty"
        assert good["totals"]["charts"] == 3
        assert "broken/empty.xml:1:1: the file is empty" in outcome.err

    def test_a_folder_without_documents_is_an_error(self, cli, tmp_path):
        outcome = cli("info", tmp_path)
        assert outcome.code == 2
        assert outcome.err.startswith(f"error: {tmp_path}: the folder has no document of simaticml")

    def test_patterns_that_the_shell_did_not_expand(self, cli, fixtures):
        files = json.loads(cli("info", "--json", "codesys/*.xml").out)["files"]
        assert [file["file"] for file in files] == [
            "codesys/device_export.xml",
            "codesys/distribution_belt.xml",
            "codesys/sorting_conveyor.xml",
        ]
        nothing = cli("info", "codesys/*.zip")
        assert nothing.code == 2
        assert "codesys/*.zip: no file matches this pattern" in nothing.err

    def test_a_saved_model(self, cli, fixtures, tmp_path):
        model = tmp_path / "model.json"
        assert cli("convert", "codesys/sorting_conveyor.xml", model, "--to", "json", "--quiet").code == 0
        outcome = cli("info", model)
        assert outcome.code == 0
        assert "json (the model itself" in outcome.out
        assert "[[Init]]" in outcome.out


class TestValidate:
    def test_sound_files(self, cli, fixtures):
        outcome = cli("validate", *SOUND[:2])
        assert outcome.code == 0
        assert outcome.out == "".join(f"{file}: valid\n" for file in SOUND[:2]) + "2 fine\n"
        assert outcome.err == ""

    def test_findings_are_the_result(self, cli, fixtures):
        outcome = cli("validate", "broken/jump_to_nowhere.xml")
        assert outcome.code == 1
        assert "broken/jump_to_nowhere.xml:250 (POU StirTank / jumpStep Waiting): error SFC103: " in outcome.out
        assert outcome.out.endswith("broken/jump_to_nowhere.xml: not valid (1 error)\n")
        assert outcome.err == ""

    @pytest.mark.slow
    def test_schema_errors_have_a_line_and_a_reason(self, cli, fixtures, tmp_path):
        text = (fixtures / "plcopen/filling_station_2.01.xml").read_text(encoding="utf-8")
        broken = tmp_path / "broken.xml"
        broken.write_text(text.replace('initialStep="true"', 'initialStep="maybe"', 1), encoding="utf-8")
        outcome = cli("validate", "--json", broken)
        assert outcome.code == 1
        (file,) = json.loads(outcome.out)["files"]
        assert file["valid"] is False
        finding = next(each for each in file["findings"] if each["code"].startswith("XSD"))
        line = text.splitlines()[finding["line"] - 1]
        assert 'initialStep="true"' in line
        assert finding["severity"] == "error"

    def test_quiet_prints_findings_only(self, cli, fixtures):
        assert cli("validate", "--quiet", *SOUND[:2]).out == ""
        assert len(cli("validate", "-q", "broken/jump_to_nowhere.xml").out.splitlines()) == 1

    def test_a_saved_model(self, cli, fixtures, tmp_path):
        model = tmp_path / "model.json"
        cli("convert", SOUND[0], model, "--to", "json", "--quiet")
        assert cli("validate", model).out == f"{model}: valid\n"

    def test_unreadable(self, cli, fixtures):
        outcome = cli("validate", "--json", "broken/truncated.xml", SOUND[0])
        assert outcome.code == 2
        bad, good = json.loads(outcome.out)["files"]
        assert (bad["valid"], bad["error"]["line"]) == (False, 168)
        assert good["valid"] is True
