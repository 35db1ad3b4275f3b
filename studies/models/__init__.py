"""Ten glTF models, drawn by raypool and by Blender's Cycles (docs/studies/models.md)."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# The meshes and documents are those of make_scenes.py.
sys.path.append(str(ROOT / "examples/scenes"))
