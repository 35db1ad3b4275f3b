"""Imported before what studies use of scripts/, where the machine's own modules are."""
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "scripts"))
