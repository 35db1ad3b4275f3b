#!/usr/bin/python3
"""The models of make models: studies/tests/models_test.py RAYPOOL. Their files keep the rules of glTF, have everything
that raypool reads of it, and are drawn without a warning. It needs no Blender."""
import base64
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "studies"))
from PIL import Image  # noqa: E402

from models.document import COMPONENTS, FORMATS  # noqa: E402
from models.sheet import compare, contact_sheet, side_by_side  # noqa: E402
from models.ten import MODELS  # noqa: E402

RAYPOOL = ""
LETTERS = {code: letter for code, letter in FORMATS.values()}
SIGNATURES = {"image/png": b"\x89PNG\r\n", "image/jpeg": b"\xff\xd8\xff"}


class File:
    """A document and its buffer, as the file has them."""

    def __init__(self, path):
        self.path = path
        data = path.read_bytes()
        if path.suffix == ".glb":
            magic, version, length, size, kind = struct.unpack_from("<4sII I4s", data)
            assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
            self.root = json.loads(data[20:20 + size])
            self.buffer = data[28 + size:]
        else:
            self.root = json.loads(data)
            self.buffer = self.resource(self.root["buffers"][0]["uri"])

    def resource(self, uri):
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.path.parent / uri).read_bytes()

    def view(self, number):
        view = self.root["bufferViews"][number]
        return self.buffer[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]

    def image(self, image):
        return self.view(image["bufferView"]) if "bufferView" in image else self.resource(image["uri"])

    def values(self, number):
        accessor = self.root["accessors"][number]
        data, count = self.view(accessor["bufferView"]), COMPONENTS[accessor["type"]]
        form = f"<{count}{LETTERS[accessor['componentType']]}"
        stride = self.root["bufferViews"][accessor["bufferView"]].get("byteStride", struct.calcsize(form))
        values = [struct.unpack_from(form, data, i * stride) for i in range(accessor["count"])]
        sparse = accessor.get("sparse")
        if sparse:
            at = struct.unpack_from("<H", self.view(sparse["indices"]["bufferView"]))[0]
            values[at] = struct.unpack_from(form, self.view(sparse["values"]["bufferView"]))
        return values


def extensions_of(part):
    """Names of all extensions below a part of a document."""
    if isinstance(part, list):
        return set().union(*map(extensions_of, part))
    if not isinstance(part, dict):
        return set()
    own = set(part.get("extensions", ()))
    return own.union(*(extensions_of(inner) for inner in part.values()))


class Models(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.files = {name: File(make().write(cls.folder / name)) for name, make in MODELS.items()}

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_there_are_ten_and_each_is_the_same_every_time(self):
        self.assertEqual(len(MODELS), 10)
        for name, file in self.files.items():
            self.assertEqual(MODELS[name]().write(self.folder / "again").read_bytes(), file.path.read_bytes(), name)

    def test_accessors_lie_in_their_views_and_have_their_bounds(self):
        for name, file in self.files.items():
            self.assertLessEqual(file.root["buffers"][0]["byteLength"], len(file.buffer))
            for number, accessor in enumerate(file.root["accessors"]):
                values = file.values(number)
                for key, choose in (("min", min), ("max", max)):
                    for i, bound in enumerate(accessor.get(key, ())):
                        self.assertAlmostEqual(bound, choose(value[i] for value in values), 5, f"{name} {number}")

    def test_attributes_are_of_one_length_and_indices_in_range(self):
        for name, file in self.files.items():
            for primitive in (part for mesh in file.root["meshes"] for part in mesh["primitives"]):
                counts = {file.root["accessors"][number]["count"] for number in primitive["attributes"].values()}
                self.assertEqual(len(counts), 1, name)
                if "indices" in primitive:
                    self.assertLess(max(file.values(primitive["indices"]))[0], counts.pop(), name)

    def test_images_are_what_their_type_says(self):
        for name, file in self.files.items():
            for image in file.root.get("images", ()):
                data = file.image(image)
                ending = image.get("uri", "").partition(";")[0].rpartition(".")[2]
                kind = image.get("mimeType") or ("image/" + ending if "/" not in ending else ending[5:])
                self.assertTrue(data.startswith(SIGNATURES[kind]), f"{name}: {image['name']}")

    def test_extensions_are_declared(self):
        for name, file in self.files.items():
            used = set(file.root.get("extensionsUsed", ()))
            # That of quantised positions says nothing elsewhere.
            self.assertEqual(extensions_of(file.root) | (used & {"KHR_mesh_quantization"}), used, name)

    def test_together_they_have_everything_that_is_read(self):
        have = set()
        for file in self.files.values():
            root = file.root
            have |= set(root) | set(root.get("extensionsUsed", ()))
            have |= {light["type"] for light in
                     root.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", ())}
            for material in root["materials"]:
                have |= set(material) | set(material["pbrMetallicRoughness"]) | {material.get("alphaMode")}
            for sampler in root.get("samplers", ()):
                have |= {sampler["wrapS"], sampler["wrapT"], sampler["magFilter"]}
            for primitive in (part for mesh in root["meshes"] for part in mesh["primitives"]):
                have |= set(primitive) | set(primitive["attributes"]) | {("mode", primitive.get("mode", 4))}
            have |= {data[:3] for data in map(file.image, root.get("images", ()))}
            have |= {("sparse", "sparse" in accessor) for accessor in root["accessors"]}
        wanted = {
            "skins", "cameras", "point", "spot", "directional", "targets", "MASK", "BLEND", None, 9728, 9729, 10497,
            33071, 33648, "NORMAL", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0", "JOINTS_0", "WEIGHTS_0", "indices",
            ("mode", 4), ("mode", 5), ("mode", 6), ("sparse", True), b"\x89PN", b"\xff\xd8\xff", "baseColorTexture",
            "metallicRoughnessTexture", "emissiveFactor", "emissiveTexture", "KHR_lights_punctual",
            "KHR_materials_emissive_strength", "KHR_materials_transmission", "KHR_materials_ior",
            "KHR_texture_transform", "KHR_mesh_quantization",
        }  # fmt: skip
        self.assertEqual(wanted - have, set())

    def test_raypool_draws_each_without_a_warning(self):
        for name, file in self.files.items():
            out = self.folder / name / "out"
            done = subprocess.run([RAYPOOL, "sim", file.path, "--engine", "native", "--shaders", "path", "--size",
                                   "16x12", "--depth", "3", "--samples", "2", "--quiet", "--out", out], cwd=ROOT,
                                  capture_output=True, text=True, check=False, timeout=120)  # fmt: skip
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            with Image.open(out / "image.png") as image:
                bright = sum(max(pixel) > 8 for pixel in image.convert("RGB").getdata())
            self.assertGreater(bright, 16 * 12 // 4, f"{name} is dark")


class Sheets(unittest.TestCase):
    def test_differences_are_those_of_the_pictures(self):
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            a = Image.new("RGB", (16, 8), (10, 20, 30))
            b = a.copy()
            b.putpixel((0, 0), (10, 20, 222))
            for name, image in (("a.png", a), ("b.png", b)):
                image.save(folder / name)
            pair = (folder / "a.png", folder / "b.png")
            ours, theirs, pixels, blocks = compare(*pair)
            self.assertEqual(pixels, 192 / 3 / 128)
            # The blue of one pixel of one of the two blocks, in light.
            blue = [((x / 255 + 0.055) / 1.055) ** 2.4 for x in (30, 222)]
            self.assertAlmostEqual(theirs - ours, (blue[1] - blue[0]) / 3 / 128)
            light = blue[0] + (blue[1] - blue[0]) / 64
            self.assertAlmostEqual(blocks, (255 * (1.055 * light ** (1 / 2.4) - 0.055) - 30) / 3 / 2)
            self.assertEqual(side_by_side(*pair).getpixel((2 * (16 + 4), 0)), (0, 0, 255))
            self.assertEqual(contact_sheet({"one": pair}).size[0], 2 * 16 + 4)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: models_test.py RAYPOOL")
    RAYPOOL = sys.argv.pop(1)
    unittest.main()
