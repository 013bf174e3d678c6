"""File formats, one package each, and the table that registers them.

* `format_interface`: the record `Format`, the classes of codecs, and `WriteOptions`. `registry`: the table of formats,
  and `format_named`.
* `file_recognition`: `recognise`, and formats that are recognised but not read.
* `xml` and `text_patch`: common parts of XML and text formats; `provenance`: what was edited since it was read.
* The formats: `plcopen`, `codesys`, `simaticml`, `scl`, `iectext`, `grafcet`, `json_codec`. `matiec` adapts projects to
  its compiler.
"""
