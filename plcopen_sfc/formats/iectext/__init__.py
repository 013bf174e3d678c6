"""Textual IEC 61131-3, with sequential function charts.

* `iectext_codec`: the entry in the table of formats, and the place of each object in a text
* `text_outline`: units and their parts, found by keywords; `text_source`: a text that is read, with its findings,
  pragmas and layout; `text_printing`: the counterpart for writers
* `project_text`, `text_configurations`, `text_declarations`: these elements, read and written
* `pou_text_reader` and `pou_text_writer`, `chart_text_reader` and `chart_text_writer`: POUs and charts
* `drawings_in_pragmas`: FBD and LD beside the structured text that means the same
* `matiec_text`: the text that matiec compiles
"""
