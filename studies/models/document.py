"""A glTF document in the making: what examples/scenes/make_scenes.py writes, and images, GLB and every accessor."""
import base64
import io
import json
import pathlib
import struct

from make_scenes import Document, Mesh, turned
from PIL import Image

REPEAT, CLAMP, MIRROR = 10497, 33071, 33648
NEAREST, LINEAR = 9728, 9729
STRIP, FAN = 5, 6
# Of glTF's component types: the code, and the letter of struct.
FORMATS = {"byte": (5120, "b"), "ubyte": (5121, "B"), "short": (5122, "h"), "ushort": (5123, "H"), "uint": (5125, "I"),
           "float": (5126, "f")}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Picture:
    """An image of a model: encoded as PNG or JPEG from pixels, `pixel` of (u, v) in 0 .. 1 with v downwards."""

    def __init__(self, name, width, height, pixel, mode="RGB", jpeg=False):
        self.name = name
        self.kind = "jpeg" if jpeg else "png"
        image = Image.new(mode, (width, height))
        image.putdata([pixel((x + 0.5) / width, (y + 0.5) / height) for y in range(height) for x in range(width)])
        file = io.BytesIO()
        if jpeg:
            image.save(file, "JPEG", quality=90)
        else:
            image.save(file, "PNG", optimize=True)
        self.data = file.getvalue()


class Model(Document):
    """Images are files beside it ("beside"), in data URIs ("inside") or in buffer views ("view")."""

    def __init__(self, name, images="view"):
        super().__init__(name)
        self.root["asset"]["generator"] = "studies/models"
        self.images = images
        self.files = {}

    def view(self, data):
        while len(self.buffer) % 4:
            self.buffer.append(0)
        view = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data)}
        self.buffer += data
        return self.part("bufferViews", view)

    def values(self, values, kind, number="float", normalized=False, **more):
        """An accessor of any component type; elements of integers are padded to 4 bytes, as vertices must be."""
        code, letter = FORMATS[number]
        size = struct.calcsize("<" + letter) * COMPONENTS[kind]
        padding = 0 if kind == "SCALAR" else -size % 4
        packed = b"".join(struct.pack(f"<{COMPONENTS[kind]}{letter}", *value) + bytes(padding) for value in values)
        view = self.view(packed)
        if padding:
            self.root["bufferViews"][view]["byteStride"] = size + padding
        accessor = {"bufferView": view, "componentType": code, "count": len(values), "type": kind, **more}
        if normalized:
            accessor["normalized"] = True
        return self.part("accessors", accessor)

    def primitive(self, mesh, material):
        """Of a mesh that may have more primitives."""
        self.mesh(mesh, material)
        return self.root["meshes"].pop()["primitives"][0]

    def add(self, name, mesh, material, place=None, **more):
        self.node(name, self.mesh(mesh, material), place, **more)

    def image(self, picture):
        if picture.name not in self.numbers:
            mime = "image/" + picture.kind
            if self.images == "view":
                image = {"bufferView": self.view(picture.data), "mimeType": mime}
            elif self.images == "inside":
                image = {"uri": f"data:{mime};base64," + base64.b64encode(picture.data).decode()}
            else:
                image = {"uri": f"{picture.name}.{picture.kind}"}
                self.files[image["uri"]] = picture.data
            self.numbers[picture.name] = self.part("images", {"name": picture.name, **image})
        return self.numbers[picture.name]

    def texture(self, picture, wrap=(REPEAT, REPEAT), nearest=False, coordinates=0, **transform):
        key = (picture.name, wrap, nearest)
        if key not in self.numbers:
            filters = NEAREST if nearest else LINEAR
            sampler = self.part("samplers", {"wrapS": wrap[0], "wrapT": wrap[1], "magFilter": filters,
                                             "minFilter": filters})
            self.numbers[key] = self.part("textures", {"source": self.image(picture), "sampler": sampler})
        info = {"index": self.numbers[key]}
        if coordinates:
            info["texCoord"] = coordinates
        if transform:
            self.extension("KHR_texture_transform")
            info["extensions"] = {"KHR_texture_transform": transform}
        return info

    def camera(self, name, eye, target, degrees):
        super().camera(name, eye, target, degrees)
        self.root["cameras"][-1]["perspective"]["aspectRatio"] = 4 / 3

    def lamp(self, name, corner, right, up, radiance, color=(1, 1, 1)):
        """A rectangle that shines evenly."""
        material = self.material(name, (0, 0, 0), emission=color, strength=radiance)
        self.add(name, Mesh().quad(corner, right, up), material)

    def floor(self, material, half=6.0, repeat=1, wall=None):
        """Ground at height 0, and a wall `wall` behind the origin."""
        self.add("floor", Mesh().quad((-half, 0, half), (2 * half, 0, 0), (0, 0, -2 * half), (repeat, repeat)),
                 material)
        if wall is not None:
            self.add("wall", Mesh().quad((-half, 0, -wall), (2 * half, 0, 0), (0, 2 * half, 0), (repeat, repeat)),
                     material)

    def write(self, folder, embed=False):
        """As .glb where images are in buffer views, else as .gltf; returns the path."""
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        while len(self.buffer) % 4:
            self.buffer.append(0)
        buffer = {"byteLength": len(self.buffer)}
        self.root["buffers"] = [buffer]
        if self.images == "view":
            text = json.dumps(self.root, separators=(",", ":")).encode()
            text += b" " * (-len(text) % 4)
            path = folder / f"{self.name}.glb"
            path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self.buffer))
                             + struct.pack("<I4s", len(text), b"JSON") + text
                             + struct.pack("<I4s", len(self.buffer), b"BIN\0") + self.buffer)
            return path
        if self.images == "inside":
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.buffer).decode()
        else:
            buffer["uri"] = f"{self.name}.bin"
            self.files[buffer["uri"]] = bytes(self.buffer)
        for name, data in self.files.items():
            (folder / name).write_bytes(data)
        path = folder / f"{self.name}.gltf"
        path.write_text(json.dumps(self.root, indent=1) + "\n")
        return path


def downwards(azimuth, height):
    """The rotation of a light that shines from `azimuth` degrees right of the viewer, `height` above the horizon."""
    def product(a, b):
        ax, ay, az, aw = a
        bx, by, bz, bw = b
        return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]
    return product(turned((0, 1, 0), azimuth), turned((1, 0, 0), -height))
