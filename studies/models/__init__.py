"""Ten glTF models, drawn by raypool and by Blender's Cycles (docs/studies/models.md)."""
