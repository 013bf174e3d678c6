"""File formats, one package each, and the table that registers them.

* `format_interface`: the record `Format`, the classes of codecs, and `WriteOptions`. `registry`: the table of formats,
  and `format_named`.
* `file_recognition`: `recognise`, and formats that are recognised but not read.
* `xml`: common parts of XML formats; `text_codec`, `text_encoding`, `text_patch`, `declaration_blocks` and
  `remainder_comments`: of text formats; `provenance`: what was edited since it was read.
* The formats: `plcopen` and `codesys` (PLCopen XML), `codesys_export` and `twincat` (objects as `archives` reads them),
  `codesys23`, `simaticml`, `scl`, `iectext`, `grafcet`, `steplist` (XLSX and CSV), `symboltable` (SDF),
  `json_codec`. `matiec` adapts projects to its compiler.
"""
