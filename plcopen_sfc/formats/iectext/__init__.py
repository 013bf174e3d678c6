"""Textual IEC 61131-3, with sequential function charts.

* `iectext_codec`: the entry in the table of formats, the place of each object in a text, and the text for matiec
* `text_outline`: units and their parts, found by keywords; `text_source`: a text that is read, with its findings,
  pragmas and layout; `text_printing`: the counterpart for writers, and FBD and LD beside structured text
* `project_text`, `text_declarations`: projects with their configurations, and declarations, read and written
* `object_declarations`: declarations of CODESYS V3 and TwinCAT 3, which have no end
* `pou_text_reader`, `chart_text_reader` and `pou_text_writer`: POUs and charts
"""
