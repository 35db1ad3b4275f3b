#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 raypool maintainers
"""Writes the three scenes of this folder, with their textures, the same every time: make_scenes.py [FOLDER]

courtyard  an evening: textures, smooth normals, vertex colours, cut-out leaves, lanterns, metal, glass and water
area-light a box after the Cornell box, with an area light, a glass ball and a block of brushed metal
features   an object for each thing that raypool reads of a glTF material
"""
import base64
import json
import math
import os
import random
import struct
import sys
import zlib

# ---- vectors


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scaled(a, s):
    return tuple(x * s for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return scaled(a, 1 / length)


def turned(axis, degrees):
    """A quaternion."""
    half = math.radians(degrees) / 2
    return [*scaled(unit(axis), math.sin(half)), math.cos(half)]


# ---- pictures


def png(path, width, rows, palette, alpha=None):
    """8-bit palette; rows are lists of palette indices, `alpha` has that of the first colours."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    raw = b"".join(b"\0" + bytes(row) for row in rows)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), 8, 3, 0, 0, 0)))
        file.write(chunk(b"PLTE", b"".join(bytes(color) for color in palette)))
        if alpha is not None:
            file.write(chunk(b"tRNS", bytes(alpha)))
        file.write(chunk(b"IDAT", zlib.compress(raw, 9)))
        file.write(chunk(b"IEND", b""))


def ramp(colors, steps):
    """Steps of a palette between colours (0 .. 255)."""
    result = []
    for i in range(steps):
        place = i * (len(colors) - 1) / (steps - 1)
        first = min(int(place), len(colors) - 2)
        share = place - first
        a, b = colors[first], colors[first + 1]
        result.append(tuple(round(x + (y - x) * share) for x, y in zip(a, b)))
    return result


class Noise:
    """Smooth values in 0 .. 1 that repeat after `period` in both directions."""

    def __init__(self, seed, period):
        numbers = random.Random(seed)
        self.period = period
        self.values = [[numbers.random() for _ in range(period)] for _ in range(period)]

    def __call__(self, x, y):
        period, values = self.period, self.values
        column, row = math.floor(x), math.floor(y)
        fx, fy = x - column, y - row
        fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
        c0, c1, r0, r1 = column % period, (column + 1) % period, row % period, (row + 1) % period
        top = values[r0][c0] + (values[r0][c1] - values[r0][c0]) * fx
        bottom = values[r1][c0] + (values[r1][c1] - values[r1][c0]) * fx
        return top + (bottom - top) * fy


def layered(seed, octaves, first=4):
    """Noise on 0 .. 1, of several sizes, that repeats."""
    layers = [(Noise(seed + i, first << i), first << i, 0.5**i) for i in range(octaves)]
    total = sum(weight for _, _, weight in layers)
    return lambda u, v: sum(noise(u * count, v * count) * weight for noise, count, weight in layers) / total


def limited(value):
    return min(max(value, 0.0), 1.0)


def draw(path, width, height, colors, steps, value):
    """`value` of (u, v) in 0 .. 1 is a place in the ramp of colours."""
    rows = [[int(limited(value((x + 0.5) / width, (y + 0.5) / height)) * (steps - 1) + 0.5) for x in range(width)]
            for y in range(height)]
    png(path, width, rows, ramp(colors, steps))


def textures(folder):
    """The textures, each once."""
    grain = layered(10, 5)
    tints = random.Random(11)
    tile = [[tints.random() for _ in range(4)] for _ in range(4)]

    def tiles(u, v):
        # Rows are shifted by half a tile.
        row = int(v * 4)
        x = u * 4 + 0.5 * (row % 2)
        column = int(x) % 4
        edge = min(x % 1, 1 - x % 1, v * 4 % 1, 1 - v * 4 % 1)
        worn = 0.02 + 0.025 * grain(u, v)
        if edge < worn:
            return 0.1 + 0.15 * grain(v, u)
        rise = limited((edge - worn) * 18)
        return (0.38 + 0.3 * tile[row][column] + 0.5 * (grain(u, v) - 0.5)) * (0.72 + 0.28 * rise)

    draw(folder + "/tiles.png", 256, 256, [(58, 50, 44), (128, 110, 92), (176, 158, 134), (214, 202, 180)], 40, tiles)

    stain = layered(20, 5)
    draw(folder + "/plaster.png", 256, 256, [(132, 84, 58), (196, 140, 98), (226, 184, 138), (238, 208, 168)], 32,
         lambda u, v: 0.62 + 0.9 * (stain(u, v) - 0.5) + 0.25 * (stain(v + 0.3, u) - 0.5))

    brick_tints = random.Random(30)
    brick = [[brick_tints.random() for _ in range(4)] for _ in range(8)]

    def bricks(u, v):
        row = int(v * 8)
        x = u * 4 + 0.5 * (row % 2)
        column = int(x) % 4
        edge = min(min(x % 1, 1 - x % 1) * 2, v * 8 % 1, 1 - v * 8 % 1)
        if edge < 0.07 + 0.06 * stain(v, u):
            return 0.85 + 0.2 * (grain(u, v) - 0.5)
        return 0.12 + 0.3 * brick[row][column] + 0.45 * (grain(u, v) - 0.4)

    draw(folder + "/bricks.png", 256, 256, [(84, 36, 26), (148, 66, 44), (178, 96, 66), (190, 176, 158)], 40, bricks)

    along = layered(40, 4)

    def wood(u, v):
        plank = int(u * 4)
        edge = min(u * 4 % 1, 1 - u * 4 % 1)
        if edge < 0.025:
            return 0.0
        rings = (u * 16 + 3.0 * along(u * 0.5 + plank * 0.25, v * 0.25)) % 1
        return 0.3 + 0.12 * plank % 0.3 + 0.3 * abs(rings - 0.5) + 0.5 * (along(u, v * 0.25 + plank * 0.3) - 0.5)

    draw(folder + "/wood.png", 256, 256, [(50, 28, 16), (110, 66, 36), (160, 104, 60), (196, 142, 90)], 32, wood)

    # A sprig: leaves on both sides of a stalk, on nothing.
    size = 128
    greens = ramp([(30, 62, 22), (62, 104, 40), (122, 150, 70)], 12)
    palette = [(62, 104, 40)] + greens + [(88, 66, 40)]
    rows = [[0] * size for _ in range(size)]
    leaves = [(64 + side * 6, 118 - 15 * i, side * (38 + 5 * i), 46 - 4 * i) for i in range(7) for side in (-1, 1)]
    leaves.append((64, 20, 0, 19))
    for x in range(size):
        for y in range(size):
            if abs(x - 64) < 2 and y > 16:
                rows[y][x] = 13
            for cx, cy, degrees, length in leaves:
                angle = math.radians(degrees)
                dx, dy = x - cx, cy - y
                far = dx * math.sin(angle) + dy * math.cos(angle)
                aside = dx * math.cos(angle) - dy * math.sin(angle)
                if not 0 <= far <= length:
                    continue
                share = far / length
                width = 0.24 * length * math.sin(math.pi * share**0.8)
                if abs(aside) < width:
                    vein = abs(aside) < 0.9
                    rows[y][x] = 1 + int(limited(0.25 + 0.5 * share + (0.25 if vein else 0.2 * aside / width)) * 11)
    png(folder + "/leaves.png", size, rows, palette, [0])

    cloud = layered(50, 5, 2)

    def sky(u, v):
        # v is 0 in the zenith and 1 at the horizon.
        wisps = limited((cloud(u, v) - 0.5) * 3.2) * limited(v * 2.5) * 0.32
        return v**1.6 + wisps * (0.4 + 0.6 * v)

    draw(folder + "/sky.png", 256, 128, [(34, 48, 96), (72, 92, 148), (146, 142, 168), (232, 172, 138),
                                         (255, 206, 140)], 96, sky)

    # Metallic-roughness: green is roughness, blue is metallic.
    scratch = layered(60, 4, 8)
    draw(folder + "/brushed.png", 128, 128, [(0, 40, 255), (0, 120, 255), (0, 200, 255)], 24,
         lambda u, v: scratch(u * 0.125, v))
    rows = [[0 if (x // 16 + y // 16) % 2 else 1 for x in range(64)] for y in range(64)]
    png(folder + "/inlay.png", 64, rows, [(0, 30, 255), (0, 200, 0)])
    glow = [(10, 4, 2), (255, 96, 16), (255, 220, 120)]
    draw(folder + "/glow.png", 64, 64, glow, 24,
         lambda u, v: 0.5 + 0.5 * math.sin(math.pi * 8 * v + 2 * math.sin(math.pi * 4 * u)))
    colors = [(196, 62, 52), (240, 232, 214), (46, 98, 140), (226, 168, 52)]
    rows = [[(x % 2) + 2 * (y % 2) for x in range(4)] for y in range(4)]
    png(folder + "/patches.png", 4, rows, colors)
    # An arrow that shows which way a texture lies.
    rows = [[1 if (abs(x - 32) < 6 and 24 < y < 58) or (8 < y <= 28 and abs(x - 32) < y - 6) else 0 for x in range(64)]
            for y in range(64)]
    png(folder + "/arrow.png", 64, rows, [(236, 226, 206), (40, 88, 120)])


# ---- meshes


class Mesh:
    """Triangles with positions, normals, texture coordinates and, where there are any, colours."""

    def __init__(self):
        self.positions, self.normals, self.texcoords, self.colors, self.triangles = [], [], [], [], []

    def vertex(self, position, normal, texcoord):
        self.positions.append(position)
        self.normals.append(normal)
        self.texcoords.append(texcoord)
        return len(self.positions) - 1

    def grid(self, columns, rows, vertex):
        """Of vertex(column, row) = position, normal, texcoord; triangles where they have area."""
        at = [[self.vertex(*vertex(column, row)) for column in range(columns + 1)] for row in range(rows + 1)]
        for row in range(rows):
            for column in range(columns):
                a, b = at[row][column], at[row][column + 1]
                c, d = at[row + 1][column + 1], at[row + 1][column]
                for triangle in ((a, b, c), (a, c, d)):
                    if len({self.positions[i] for i in triangle}) == 3:
                        self.triangles.append(triangle)
        return self

    def quad(self, corner, right, up, repeat=(1, 1)):
        normal = unit(cross(right, up))
        return self.grid(1, 1, lambda i, j: (add(corner, add(scaled(right, i), scaled(up, j))), normal,
                                             (i * repeat[0], (1 - j) * repeat[1])))

    def box(self, low, high, repeat=1.0):
        """Texture coordinates are metres times `repeat`."""
        for axis in range(3):
            one, two = (axis + 1) % 3, (axis + 2) % 3
            for side in (0, 1):
                corner = list(low)
                corner[axis] = (low, high)[side][axis]
                first, second = [0.0] * 3, [0.0] * 3
                first[one], second[two] = high[one] - low[one], high[two] - low[two]
                if axis == 1:
                    first, second = second, first
                if (side == 0) != (axis == 1):
                    corner = add(corner, first)
                    first = scaled(first, -1)
                lengths = [math.sqrt(sum(x * x for x in edge)) * repeat for edge in (first, second)]
                if axis == 0:  # y is upwards in both
                    first, second = second, scaled(first, -1)
                    corner = sub(corner, second)
                    lengths.reverse()
                self.quad(tuple(corner), tuple(first), tuple(second), lengths)
        return self

    def lathe(self, profile, segments, around=1.0, up=1.0):
        """A profile of (radius, height) upwards, turned about y. A point that is there twice makes an edge."""
        parts, start = [], 0
        for i in range(1, len(profile)):
            if profile[i] == profile[i - 1]:
                parts.append(profile[start:i])
                start = i
        parts.append(profile[start:])
        # With sines and cosines that are the same on both sides of the seam.
        circle = [(math.cos(2 * math.pi * (i % segments) / segments), math.sin(2 * math.pi * (i % segments) / segments))
                  for i in range(segments + 1)]
        total = sum(math.dist(a, b) for part in parts for a, b in zip(part, part[1:])) or 1
        passed = 0
        for part in parts:
            slopes, lengths = [], [passed]
            for i in range(len(part)):
                before, after = part[max(i - 1, 0)], part[min(i + 1, len(part) - 1)]
                slopes.append(unit((after[1] - before[1], before[0] - after[0])))
                if i > 0:
                    lengths.append(lengths[-1] + math.dist(part[i - 1], part[i]))

            def vertex(column, row):
                cosine, sine = circle[column]
                radius, height = part[row]
                out, rise = slopes[row]
                # Seen from outside, u is to the right.
                return ((radius * cosine, height, -radius * sine), (out * cosine, rise, -out * sine),
                        (around * column / segments, up * (1 - lengths[row] / total)))

            self.grid(segments, len(part) - 1, vertex)
            passed = lengths[-1]
        return self

    def ball(self, radius, segments, around=2.0, up=1.0):
        count = segments // 2
        points = [(radius * math.sin(math.pi * i / count), -radius * math.cos(math.pi * i / count))
                  for i in range(count + 1)]
        points[0], points[-1] = (0.0, -radius), (0.0, radius)
        return self.lathe(points, segments, around, up)

    def tube(self, path, radii, segments):
        """About a line of points, closed at neither end."""
        rings, side = [], None
        for i, point in enumerate(path):
            along = unit(sub(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)]))
            if side is None:
                side = unit(cross(along, (0.0, 0.0, 1.0) if abs(along[2]) < 0.9 else (1.0, 0.0, 0.0)))
            side = unit(sub(side, scaled(along, sum(x * y for x, y in zip(side, along)))))
            rings.append((point, side, cross(along, side), radii[i]))

        def vertex(column, row):
            point, first, second, radius = rings[row]
            angle = 2 * math.pi * (column % segments) / segments
            out = add(scaled(first, math.cos(angle)), scaled(second, math.sin(angle)))
            return add(point, scaled(out, radius)), out, (column / segments, row / 2)

        return self.grid(segments, len(path) - 1, vertex)

    def colored(self, color):
        """`color` of (position, normal): red, green, blue, linear."""
        self.colors = [color(position, normal) for position, normal in zip(self.positions, self.normals)]
        return self

    def flat(self):
        """Each triangle with vertices of its own, and no normals: they are the triangles' own."""
        result = Mesh()
        for triangle in self.triangles:
            for i in triangle:
                result.vertex(self.positions[i], self.normals[i], self.texcoords[i])
            count = len(result.positions)
            result.triangles.append((count - 3, count - 2, count - 1))
        result.normals = []
        return result

    def inward(self):
        self.triangles = [(a, c, b) for a, b, c in self.triangles]
        self.normals = [scaled(normal, -1) for normal in self.normals]
        return self


# ---- documents


class Document:
    def __init__(self, name):
        self.name = name
        self.buffer = bytearray()
        self.root = {"asset": {"version": "2.0", "generator": "make_scenes.py"}, "scene": 0, "scenes": [{"nodes": []}]}
        self.numbers = {}  # of the meshes, images and textures that are there

    def part(self, kind, value):
        self.root.setdefault(kind, []).append(value)
        return len(self.root[kind]) - 1

    def extension(self, name):
        used = self.root.setdefault("extensionsUsed", [])
        if name not in used:
            used.append(name)

    def accessor(self, values, kind, target=None):
        components = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[kind]
        integers = kind == "SCALAR"
        wide = integers and max(values) > 65535
        code, letter = ((5125, "I") if wide else (5123, "H")) if integers else (5126, "f")
        flat = values if integers else [x for value in values for x in value]
        while len(self.buffer) % 4:
            self.buffer.append(0)
        view = {"buffer": 0, "byteOffset": len(self.buffer)}
        self.buffer += struct.pack(f"<{len(flat)}{letter}", *flat)
        view["byteLength"] = len(self.buffer) - view["byteOffset"]
        if target is not None:
            view["target"] = target
        result = {"bufferView": self.part("bufferViews", view), "componentType": code, "count": len(values),
                  "type": kind}
        if target == 34962 and kind == "VEC3":
            rounded = [struct.unpack("<3f", struct.pack("<3f", *value)) for value in values]
            result["min"] = [min(value[i] for value in rounded) for i in range(components)]
            result["max"] = [max(value[i] for value in rounded) for i in range(components)]
        return self.part("accessors", result)

    def mesh(self, mesh, material):
        """The same mesh with several materials is in the buffer once."""
        if mesh not in self.numbers:
            attributes = {"POSITION": self.accessor(mesh.positions, "VEC3", 34962)}
            if mesh.normals:
                attributes["NORMAL"] = self.accessor(mesh.normals, "VEC3", 34962)
            attributes["TEXCOORD_0"] = self.accessor(mesh.texcoords, "VEC2", 34962)
            if mesh.colors:
                attributes["COLOR_0"] = self.accessor(mesh.colors, "VEC3", 34962)
            indices = self.accessor([i for triangle in mesh.triangles for i in triangle], "SCALAR", 34963)
            self.numbers[mesh] = {"attributes": attributes, "indices": indices}
        return self.part("meshes", {"primitives": [{**self.numbers[mesh], "material": material}]})

    def node(self, name, mesh=None, place=None, rotation=None, scale=None, **more):
        node = {"name": name, **more}

        def digits(numbers):
            return [round(number, 5) for number in numbers]

        if mesh is not None:
            node["mesh"] = mesh
        if place is not None:
            node["translation"] = digits(place)
        if rotation is not None:
            node["rotation"] = digits(rotation)
        if scale is not None:
            node["scale"] = digits(scale if isinstance(scale, tuple) else [scale] * 3)
        self.root["scenes"][0]["nodes"].append(self.part("nodes", node))

    def texture(self, name, wrap=10497, nearest=False, **transform):
        key = (name, wrap, nearest)
        if key not in self.numbers:
            image = self.numbers.get(name)
            if image is None:
                image = self.numbers[name] = self.part("images", {"uri": f"textures/{name}.png"})
            sampler = self.part("samplers", {"wrapS": wrap, "wrapT": wrap, "magFilter": 9728 if nearest else 9729})
            self.numbers[key] = self.part("textures", {"source": image, "sampler": sampler})
        info = {"index": self.numbers[key]}
        if transform:
            self.extension("KHR_texture_transform")
            info["extensions"] = {"KHR_texture_transform": transform}
        return info

    def material(self, name, color=(1, 1, 1), metallic=0.0, roughness=1.0, texture=None, rough_texture=None,
                 emission=None, strength=None, emission_texture=None, glass=None, ior=None, **more):
        pbr = {"baseColorFactor": [*color, 1.0] if len(color) == 3 else list(color), "metallicFactor": metallic,
               "roughnessFactor": roughness}
        if texture is not None:
            pbr["baseColorTexture"] = texture
        if rough_texture is not None:
            pbr["metallicRoughnessTexture"] = rough_texture
        material = {"name": name, "pbrMetallicRoughness": pbr, **more}
        if emission is not None:
            material["emissiveFactor"] = list(emission)
        if emission_texture is not None:
            material["emissiveTexture"] = emission_texture
        for extension, key, value in (("emissive_strength", "emissiveStrength", strength),
                                      ("transmission", "transmissionFactor", glass), ("ior", "ior", ior)):
            if value is not None:
                self.extension("KHR_materials_" + extension)
                material.setdefault("extensions", {})["KHR_materials_" + extension] = {key: value}
        return self.part("materials", material)

    def camera(self, name, eye, target, degrees):
        back = unit(sub(eye, target))
        right = unit(cross((0.0, 1.0, 0.0), back))
        up = cross(back, right)
        number = self.part("cameras", {"type": "perspective", "name": name,
                                       "perspective": {"yfov": math.radians(degrees), "znear": 0.01}})
        self.node(name, camera=number, matrix=[*right, 0, *up, 0, *back, 0, *eye, 1])

    def light(self, name, kind, color, intensity, **place):
        self.extension("KHR_lights_punctual")
        cone = place.pop("cone", None)
        light = {"name": name, "type": kind, "color": list(color), "intensity": intensity}
        if cone is not None:
            light["spot"] = {"innerConeAngle": cone[0], "outerConeAngle": cone[1]}
        lights = self.root.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(light)
        self.node(name, extensions={"KHR_lights_punctual": {"light": len(lights) - 1}}, **place)

    def write(self, folder, embed=False):
        buffer = {"byteLength": len(self.buffer)}
        if embed:
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.buffer).decode()
        else:
            buffer["uri"] = self.name + ".bin"
            with open(os.path.join(folder, self.name + ".bin"), "wb") as file:
                file.write(self.buffer)
        self.root["buffers"] = [buffer]
        with open(os.path.join(folder, self.name + ".gltf"), "w", encoding="utf-8") as file:
            json.dump(self.root, file, separators=(",", ":"))
            file.write("\n")


def rounded_block(width, height, depth, bevel):
    """A block with bevelled upper edges, which catch the light."""
    low, high = (-width / 2, 0.0, -depth / 2), (width / 2, height, depth / 2)
    mesh = Mesh().box(low, (high[0], height - bevel, high[2]))
    w, d, top = width / 2, depth / 2, height
    ring = [(-w, d), (w, d), (w, -d), (-w, -d)]
    inner = [(x - math.copysign(bevel, x), z - math.copysign(bevel, z)) for x, z in ring]
    for i in range(4):
        (x0, z0), (x1, z1) = ring[i], ring[(i + 1) % 4]
        (u0, v0), (u1, v1) = inner[i], inner[(i + 1) % 4]
        points = [(x0, top - bevel, z0), (x1, top - bevel, z1), (u1, top, v1), (u0, top, v0)]
        normal = unit(cross(sub(points[1], points[0]), sub(points[3], points[0])))
        at = [mesh.vertex(point, normal, (0.1 * j, 0.1 * j)) for j, point in enumerate(points)]
        mesh.triangles += [(at[0], at[1], at[2]), (at[0], at[2], at[3])]
    return mesh.quad((inner[0][0], top, inner[0][1]), (2 * (w - bevel), 0.0, 0.0), (0.0, 0.0, -2 * (d - bevel)),
                     (width, depth))


# ---- the courtyard


def courtyard(folder):
    scene = Document("courtyard")
    chance = random.Random(7)
    stone = scene.material("paving", texture=scene.texture("tiles"), roughness=0.6)
    plaster = scene.material("plaster", texture=scene.texture("plaster"))
    brick = scene.material("bricks", texture=scene.texture("bricks"))
    timber = scene.material("timber", texture=scene.texture("wood"), roughness=0.5)
    marble = scene.material("marble", roughness=0.35)
    clay = scene.material("clay", (0.55, 0.22, 0.11), roughness=0.9)
    bark = scene.material("bark", (0.16, 0.11, 0.07))
    foliage = scene.material("leaves", texture=scene.texture("leaves", 33071), alphaMode="MASK", alphaCutoff=0.5,
                             doubleSided=True)
    iron = scene.material("iron", (0.10, 0.10, 0.11), 1.0, 0.45)
    gold = scene.material("gold", (1.0, 0.72, 0.28), 1.0, 0.08)
    silver = scene.material("silver", (0.95, 0.95, 0.93), 1.0, 0.0)
    copper = scene.material("copper", (0.95, 0.55, 0.40), 1.0, 1.0, rough_texture=scene.texture("brushed"))
    glass = scene.material("glass", (1.0, 1.0, 1.0), roughness=0.0, glass=1.0, ior=1.5)
    emerald = scene.material("green glass", (0.55, 0.95, 0.70), roughness=0.0, glass=1.0, ior=1.5)
    water = scene.material("water", (0.80, 0.95, 0.97), roughness=0.0, glass=1.0, ior=1.33)
    flame = scene.material("lantern", (1, 1, 1), emission=(1.0, 0.56, 0.22), strength=24.0)
    sky = scene.material("sky", (0, 0, 0), emission=(1, 1, 1), strength=0.9,
                         emission_texture=scene.texture("sky", 33071))
    soil = scene.material("soil", (0.08, 0.06, 0.04))

    # Ground and walls.
    scene.node("paving", scene.mesh(Mesh().quad((-6, 0, 8), (12, 0, 0), (0, 0, -13), (5, 5.4)), stone))
    scene.node("field", scene.mesh(Mesh().quad((-40, -0.02, 40), (80, 0, 0), (0, 0, -80)), soil))
    walls = Mesh().quad((-6, 0.9, -5), (12, 0, 0), (0, 3.3, 0), (4, 1.1))
    walls.quad((-6, 0.9, 8), (0, 0, -13), (0, 3.3, 0), (4.3, 1.1))
    walls.quad((6, 0.9, -5), (0, 0, 13), (0, 3.3, 0), (4.3, 1.1))
    scene.node("walls", scene.mesh(walls, plaster))
    base = Mesh().quad((-6, 0, -4.93), (12, 0, 0), (0, 0.9, 0), (9, 0.7))
    base.quad((-5.93, 0, 8), (0, 0, -13), (0, 0.9, 0), (10, 0.7))
    base.quad((5.93, 0, -5), (0, 0, 13), (0, 0.9, 0), (10, 0.7))
    base.quad((-6, 0.9, -4.93), (12, 0, 0), (0, 0, -0.07)).quad((-5.93, 0.9, 8), (0, 0, -13), (-0.07, 0, 0))
    scene.node("base", scene.mesh(base, brick))
    scene.node("dome", scene.mesh(Mesh().lathe(
        [(38 * math.cos(math.pi * i / 20), 38 * math.sin(math.pi * i / 20) - 1) for i in range(10)] + [(0.0, 37.0)],
        32, 2, 1).inward(), sky))

    # A colonnade at the back wall, with beams to the wall.
    column = [(0.24, 0), (0.24, 0.1), (0.24, 0.1), (0.23, 0.13), (0.20, 0.15), (0.19, 0.2), (0.19, 0.2)]
    column += [(0.16 + 0.012 * math.sin(math.pi * i / 8) - 0.004 * i, 0.2 + 2.3 * i / 8) for i in range(9)]
    column += [(0.128, 2.5), (0.16, 2.53), (0.18, 2.58), (0.22, 2.6), (0.22, 2.6), (0.22, 2.7), (0.22, 2.7), (0.0, 2.7)]

    def shade(p, n):
        return scaled((0.82, 0.77, 0.68), 0.72 + 0.28 * limited(p[1] / 0.8) - 0.06 * math.sin(23 * p[1] + 3 * p[0]))

    pillar = scene.mesh(Mesh().lathe(column, 28).colored(shade), marble)
    for i in range(6):
        scene.node(f"column {i}", pillar, (-5 + 2 * i, 0, -3.2), turned((0, 1, 0), 40 * i))
    scene.node("architrave", scene.mesh(Mesh().box((-6, 2.7, -3.45), (6, 2.98, -2.95), 0.8), plaster))
    rafter = scene.mesh(Mesh().box((-0.07, 0, -2.1), (0.07, 0.16, 0.5), 0.7), timber)
    for i in range(13):
        scene.node(f"rafter {i}", rafter, (-5.7 + 0.95 * i, 2.98, -2.9))

    # The fountain.
    basin = [(1.25, 0), (1.25, 0.08), (1.25, 0.08), (1.15, 0.12), (1.12, 0.34), (1.2, 0.42), (1.22, 0.46), (1.2, 0.5),
             (1.12, 0.5), (1.08, 0.46), (1.05, 0.2), (1.0, 0.14), (0.0, 0.14)]

    def veins(p, n):
        return scaled((0.80, 0.79, 0.76), 0.86 + 0.14 * math.sin(6 * p[0] + 4 * math.sin(5 * p[2] + 3 * p[1])))

    scene.node("basin", scene.mesh(Mesh().lathe(basin, 48).colored(veins), marble), (0, 0, 0.2))

    def ripple(column, row):
        radius, angle = 1.06 * row / 6, -2 * math.pi * (column % 24) / 24
        slope = -0.12 * math.cos(9 * row / 6)
        return ((radius * math.cos(angle), 0.02 * math.sin(9 * row / 6), -radius * math.sin(angle)),
                unit((slope * math.cos(angle), 1.0, -slope * math.sin(angle))), (column / 24, row / 6))

    scene.node("water", scene.mesh(Mesh().grid(24, 6, ripple), water), (0, 0.42, 0.2))
    stem = [(0.2, 0.14), (0.16, 0.3), (0.1, 0.5), (0.09, 0.75), (0.14, 0.86), (0.36, 0.98), (0.46, 1.06), (0.48, 1.1),
            (0.44, 1.1), (0.3, 1.02), (0.08, 0.98), (0.07, 1.1), (0.09, 1.18), (0.0, 1.22)]
    scene.node("stem", scene.mesh(Mesh().lathe(stem, 32).colored(veins), marble), (0, 0, 0.2))
    scene.node("golden ball", scene.mesh(Mesh().ball(0.17, 32), gold), (0, 1.37, 0.2))

    # Balls.
    large, small = Mesh().ball(0.42, 48), Mesh().ball(0.2, 32)
    scene.node("silver ball", scene.mesh(large, silver), (-1.95, 0.42, 1.35))
    scene.node("glass ball", scene.mesh(large, glass), (1.5, 0.42, 1.75))
    scene.node("green ball", scene.mesh(small, emerald), (0.72, 0.2, 2.35))
    scene.node("copper ball", scene.mesh(Mesh().ball(0.3, 40), copper), (-1.05, 0.3, 2.25), turned((1, 0, 1), 50))
    scene.node("gold ball", scene.mesh(small, gold), (0.0, 0.2, 2.75))

    def glaze(p, n):
        stripes = limited(0.5 + 2.5 * math.sin(14 * p[1] + 1.5 * math.sin(4 * math.atan2(p[2], p[0]))))
        return add(scaled((0.03, 0.16, 0.34), limited(1.3 - p[1])), scaled((0.75, 0.62, 0.40), stripes * 0.5))

    vase = [(0.0, 0.0), (0.16, 0.0), (0.16, 0.0), (0.2, 0.06), (0.28, 0.26), (0.3, 0.44), (0.25, 0.62), (0.15, 0.76),
            (0.11, 0.86), (0.13, 0.95), (0.19, 1.0), (0.17, 1.0), (0.1, 0.92), (0.09, 0.8)]
    scene.node("vase", scene.mesh(Mesh().lathe(vase, 40).colored(glaze), scene.material("glaze", roughness=0.12)),
               (-3.3, 0, 0.4))

    # Two trees in pots, and creepers at the wall.
    pot = [(0.0, 0.0), (0.3, 0.0), (0.3, 0.0), (0.4, 0.5), (0.4, 0.5), (0.45, 0.5), (0.46, 0.6), (0.44, 0.62),
           (0.4, 0.6), (0.37, 0.52), (0.0, 0.52)]
    pot_mesh = scene.mesh(Mesh().lathe(pot, 36), clay)
    sprig = scene.mesh(Mesh().grid(1, 2, lambda i, j: (
        ((i - 0.5) * 0.3, 0.15 * j, 0.03 * (j == 1)), unit((i - 0.5, 0.2 * (j - 1), 1.0)), (i, 1 - j / 2))), foliage)
    for number, (x, z) in enumerate(((3.2, -0.6), (-4.4, -1.5))):
        scene.node(f"pot {number}", pot_mesh, (x, 0, z))
        wood = Mesh()
        tips = []
        trunk = [(0.06 * math.sin(2.2 * i / 6 + number), 0.5 + 0.24 * i, 0.05 * math.sin(3.1 * i / 6))
                 for i in range(7)]
        wood.tube(trunk, [0.075 - 0.005 * i for i in range(7)], 10)
        for branch in range(13):
            angle, steep = branch * 2.4, 0.5 + 0.6 * chance.random()
            start = trunk[3 + branch % 4]
            out = (math.cos(angle), steep, math.sin(angle))
            line = [add(start, add(scaled(out, 0.16 * i), (0, 0.02 * i * i, 0))) for i in range(5)]
            wood.tube(line, [0.034 - 0.006 * i for i in range(5)], 6)
            tips += line[1:]
        scene.node(f"tree {number}", scene.mesh(wood, bark), (x, 0, z))
        for i, tip in enumerate(tips * 5):
            about = add(tip, tuple(chance.gauss(0, 0.13) for _ in range(3)))
            axis = unit((chance.uniform(-1, 1), chance.uniform(-0.6, 1.2), chance.uniform(-1, 1)))
            scene.node(f"sprig {number} {i}", sprig, add(about, (x, 0.0, z)), turned(axis, chance.uniform(0, 360)),
                       chance.uniform(0.8, 1.3))
    for i in range(210):
        along = chance.random() ** 1.4
        x = -5.9 + 3.2 * along + chance.gauss(0, 0.12)
        y = 0.1 + (3.9 - 2.6 * along) * chance.random() ** 0.8
        scene.node(f"creeper {i}", sprig, (max(x, -5.95), y, -4.9 + 0.1 * chance.random()),
                   turned((chance.uniform(-0.3, 0.3), chance.uniform(-0.4, 0.4), 1), chance.uniform(100, 260)),
                   chance.uniform(0.8, 1.5))

    # A bench, and lanterns.
    bench = Mesh().box((-0.8, 0.42, -0.2), (0.8, 0.48, 0.2), 1.3).box((-0.7, 0, -0.17), (-0.6, 0.42, 0.17), 1.3)
    bench.box((0.6, 0, -0.17), (0.7, 0.42, 0.17), 1.3)
    scene.node("bench", scene.mesh(bench, timber), (3.9, 0, 1.9), turned((0, 1, 0), -72))
    light = scene.mesh(Mesh().lathe([(0.0, -0.11), (0.07, -0.09), (0.1, 0.0), (0.07, 0.09), (0.0, 0.11)], 12), flame)
    cage = Mesh().lathe([(0.13, 0.14), (0.15, 0.15), (0.06, 0.24), (0.02, 0.3), (0.0, 0.3)], 8)
    cage.lathe([(0.0, -0.17), (0.08, -0.16), (0.13, -0.14), (0.11, -0.12), (0.0, -0.12)], 8)
    for i in range(8):
        angle = math.pi * i / 4
        cage.tube([(0.125 * math.cos(angle), -0.14 + 0.28 * j, 0.125 * math.sin(angle)) for j in range(2)],
                  [0.008] * 2, 5)
    cage_mesh = scene.mesh(cage, iron)
    chain = scene.mesh(Mesh().tube([(0, 0.3, 0), (0, 0.62, 0)], [0.008] * 2, 5), iron)
    for i, x in enumerate((-4, -2, 0, 2, 4)):
        place = (x, 2.08, -3.2)
        for name, mesh in (("lantern", light), ("cage", cage_mesh), ("chain", chain)):
            scene.node(f"{name} {i}", mesh, place)
    scene.node("lantern on the ground", light, (-2.75, 0.17, 2.1), None, 0.9)
    scene.node("cage on the ground", cage_mesh, (-2.75, 0.17, 2.1))
    scene.light("evening", "point", (1.0, 0.78, 0.55), 16.0, place=(2.2, 4.6, 4.2))
    scene.camera("camera", (2.9, 1.85, 6.9), (-0.25, 1.02, -0.6), 37)
    scene.write(folder)


# ---- the box


def cornell(folder):
    box = Document("area-light")
    white = box.material("white", (0.73, 0.73, 0.73))
    size = 5.5
    shell = Mesh().quad((0, 0, 0), (size, 0, 0), (0, 0, -size)).quad((0, size, -size), (size, 0, 0), (0, 0, size))
    shell.quad((0, 0, -size), (size, 0, 0), (0, size, 0))
    box.node("shell", box.mesh(shell, white))
    box.node("left", box.mesh(Mesh().quad((0, 0, 0), (0, 0, -size), (0, size, 0)),
                              box.material("red", (0.63, 0.06, 0.05))))
    box.node("right", box.mesh(Mesh().quad((size, 0, -size), (0, 0, size), (0, size, 0)),
                               box.material("green", (0.12, 0.45, 0.10))))
    lamp = box.material("lamp", (0.0, 0.0, 0.0), emission=(1.0, 0.80, 0.52), strength=17.0)
    box.node("lamp", box.mesh(Mesh().quad((2.1, 5.495, -3.3), (1.3, 0, 0), (0, 0, 1.05)), lamp))
    steel = box.material("brushed metal", (0.93, 0.90, 0.85), 1.0, 0.22)
    box.node("block", box.mesh(rounded_block(1.65, 3.3, 1.65, 0.06), steel), (1.85, 0, -3.5), turned((0, 1, 0), 41))
    box.node("low block", box.mesh(rounded_block(1.5, 0.9, 1.5, 0.04), white), (3.7, 0, -1.85), turned((0, 1, 0), -17))
    glass = box.material("glass", (1, 1, 1), roughness=0.0, glass=1.0, ior=1.5)
    box.node("ball", box.mesh(Mesh().ball(0.72, 40), glass), (3.7, 1.62, -1.85))
    box.camera("camera", (2.75, 2.75, 8.05), (2.75, 2.72, 0.0), 38)
    box.write(folder, embed=True)


# ---- what is read of materials


def features(folder):
    scene = Document("features")
    ball, block = Mesh().ball(0.36, 40), Mesh().box((-0.32, 0.0, -0.32), (0.32, 0.64, 0.32), 1 / 0.64)
    panel = Mesh().quad((-0.36, 0.0, 0.0), (0.72, 0, 0), (0, 0.72, 0), (1, 1))
    wide = Mesh().quad((-0.36, 0.0, 0.0), (0.72, 0, 0), (0, 0.72, 0), (3, 3))
    # Its coordinates reach from -0.5 to 1.5, to show what is beyond a texture's edge.
    beyond = Mesh().grid(1, 1, lambda i, j: ((0.72 * i - 0.36, 0.72 * j, 0.0), (0.0, 0.0, 1.0),
                                             (2 * i - 0.5, 1.5 - 2 * j)))

    def rainbow(p, n):
        return tuple(0.5 + 0.5 * math.cos(6.28 * (p[1] * 1.2 + shift)) for shift in (0.0, 0.33, 0.67))

    colored = Mesh().ball(0.36, 40).colored(rainbow)
    make, texture = scene.material, scene.texture
    rows = [
        [
            ("base color", ball, make("base color", (0.70, 0.16, 0.10), roughness=0.8)),
            ("rough metal", ball, make("rough metal", (0.95, 0.64, 0.54), 1.0, 0.4)),
            ("smooth metal", ball, make("smooth metal", (0.98, 0.78, 0.36), 1.0, 0.05)),
            ("mirror", ball, make("mirror", (0.95, 0.95, 0.95), 1.0, 0.0)),
            ("varnish", ball, make("varnish", (0.05, 0.20, 0.12), 0.0, 0.05)),
            ("metallic-roughness texture", ball, make("inlay", (0.92, 0.84, 0.66), 1.0, 1.0,
                                                      rough_texture=texture("inlay", nearest=True))),
            ("vertex colors", colored, make("vertex colors", roughness=0.5)),
        ],
        [
            ("glass", ball, make("glass", roughness=0.0, glass=1.0, ior=1.5)),
            ("glass of index 2.4", ball, make("diamond", roughness=0.0, glass=1.0, ior=2.4)),
            ("colored glass", ball, make("colored glass", (0.35, 0.60, 0.95), roughness=0.0, glass=1.0)),
            ("half glass", ball, make("half glass", (0.90, 0.45, 0.55), roughness=0.1, glass=0.5)),
            ("alpha cut-out", panel, make("cut-out", texture=texture("leaves", 33071), alphaMode="MASK",
                                          doubleSided=True)),
            ("alpha blend", panel, make("blend", (0.15, 0.35, 0.75, 0.45), alphaMode="BLEND", doubleSided=True)),
            ("flat normals", Mesh().ball(0.36, 14).flat(), make("flat", (0.50, 0.55, 0.62), roughness=0.6)),
        ],
        [
            ("base color texture", block, make("texture", texture=texture("bricks"))),
            ("repeat", wide, make("repeat", texture=texture("arrow"))),
            ("clamp", beyond, make("clamp", texture=texture("arrow", 33071))),
            ("mirrored repeat", beyond, make("mirrored", texture=texture("arrow", 33648))),
            ("nearest filter", panel, make("nearest", texture=texture("patches", nearest=True))),
            ("linear filter", panel, make("linear", texture=texture("patches"))),
            ("texture transform", panel, make("transform", texture=texture(
                "arrow", scale=[2.0, 2.0], offset=[0.25, 0.5], rotation=0.6))),
        ],
        [
            ("emission", ball, make("emission", (0.1, 0.1, 0.1), emission=(0.9, 0.35, 0.12))),
            ("strong emission", Mesh().ball(0.14, 16), make("strong", (0, 0, 0), emission=(0.55, 0.75, 1.0),
                                                            strength=14.0)),
            ("emission texture", block, make("glow", (0.05, 0.05, 0.05), emission=(1, 1, 1), strength=1.5,
                                             emission_texture=texture("glow"))),
            ("texture times color", block, make("tinted", (0.45, 0.75, 0.50), texture=texture("wood"), roughness=0.4)),
            ("smooth normals", Mesh().lathe([(0.0, 0.0), (0.3, 0.0), (0.3, 0.0), (0.34, 0.1), (0.2, 0.3), (0.12, 0.45),
                                             (0.2, 0.6), (0.3, 0.66), (0.0, 0.7)], 40, 2, 1),
             make("smooth", (0.80, 0.76, 0.68), roughness=0.3)),
        ],
    ]
    stand = scene.mesh(rounded_block(0.86, 0.3, 0.86, 0.03), make("stand", (0.42, 0.42, 0.44), roughness=0.7))
    for row, objects in enumerate(rows):
        for column, (name, mesh, material) in enumerate(objects):
            x, y, z = (column - 3) * 1.05, 0.42 * (3 - row), 1.15 * (row - 3)
            scene.node("stand of " + name, stand, (x, y, z))
            lift = -min(position[1] for position in mesh.positions)
            scene.node(name, scene.mesh(mesh, material), (x, y + 0.3 + lift, z),
                       turned((0, 1, 0), -15) if mesh is block else None)
    # Instances: one mesh at each of some places.
    places = [(2 * 1.05 + 0.22 * (i % 3 - 1), 0.3 + 0.1 + 0.2 * (i // 9), 0.22 * (i // 3 % 3 - 1)) for i in range(27)]
    scene.extension("EXT_mesh_gpu_instancing")
    scene.node("stand of instances", stand, (2 * 1.05, 0, 0))
    scene.node("instances", scene.mesh(Mesh().ball(0.09, 16), make("beads", (0.85, 0.30, 0.22), roughness=0.25)),
               extensions={"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": scene.accessor(places, "VEC3")}}})
    # A mirrored node, which keeps its front.
    scene.node("stand of mirrored node", stand, (3 * 1.05, 0, 0))
    scene.node("mirrored node", scene.mesh(Mesh().quad((-0.36, 0.0, 0.0), (0.72, 0, 0), (0, 0.72, 0)),
                                           make("mirrored node", texture=texture("arrow"))), (3 * 1.05, 0.3, 0),
               turned((0, 0, 1), -25), (-1.0, 1.0, 1.0))

    room = Mesh().quad((-6, 0, 6), (12, 0, 0), (0, 0, -11), (6, 5.5)).quad((-6, 0, -5), (12, 0, 0), (0, 6, 0), (6, 3))
    room.quad((-6, 0, 6), (0, 0, -11), (0, 6, 0)).quad((6, 0, -5), (0, 0, 11), (0, 6, 0))
    room.quad((6, 0, 6), (-12, 0, 0), (0, 6, 0)).quad((-6, 6, -5), (12, 0, 0), (0, 0, 11))
    scene.node("room", scene.mesh(room, make("room", (0.62, 0.61, 0.60))))
    scene.node("ceiling lamp", scene.mesh(Mesh().quad((-2.5, 5.95, -1.5), (5, 0, 0), (0, 0, 3.0)),
                                          make("ceiling lamp", (0, 0, 0), emission=(1.0, 0.95, 0.88), strength=2.6)))
    scene.light("point light", "point", (1.0, 0.85, 0.65), 14.0, place=(3.5, 4.6, 3.0))
    scene.light("spot light", "spot", (0.65, 0.80, 1.0), 30.0, place=(-4.0, 4.8, 1.5),
                rotation=turned((-1.0, -0.55, -0.25), 62), cone=(0.15, 0.45))
    scene.light("directional light", "directional", (1.0, 0.95, 0.9), 0.25, rotation=turned((1, 0, 0), -70))
    scene.camera("camera", (0.0, 3.1, 5.9), (0.0, 0.75, -1.3), 44)
    scene.write(folder)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    os.makedirs(os.path.join(folder, "textures"), exist_ok=True)
    textures(os.path.join(folder, "textures"))
    for scene in (courtyard, cornell, features):
        scene(folder)


if __name__ == "__main__":
    main()
