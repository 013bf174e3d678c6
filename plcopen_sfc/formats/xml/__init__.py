"""Common parts of XML formats: safe parsing, the text of a source file, minimal edits of it, and validation.

Public: `xml_parsing.parse_xml` and `decode_xml`, `source_patch.patch_xml`, `xml_codec.XmlCodec`,
`schema_validation.schema_findings`.

* `xml_parsing`: from bytes to a tree. `xml_codec`: from a tree to bytes, and the base of codecs.
* `source_patch`: puts edits into the source, with `source_tree` (positions in the text), `element_alignment` (which
  child is which) and `source_style` (new lines and changed text); `escaping`: character references.
* `extension_data`: markup and fields that the model or the format has no place for.
* `schema_validation`, `schema_explanation`: schema errors, and what to do about them.
"""
