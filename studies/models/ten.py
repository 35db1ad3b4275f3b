"""The ten models: each function makes one, MODELS lists them."""
import math
import struct

from make_scenes import Mesh, add, cross, layered, limited, scaled, sub, turned, unit

from .document import CLAMP, FAN, MIRROR, REPEAT, STRIP, Model, Picture, downwards


def blend(a, b, share):
    return tuple(round(x + (y - x) * limited(share)) for x, y in zip(a, b))


def checker(u, v, count=8):
    return (int(u * count) + int(v * count)) % 2


def planks_picture():
    grain = layered(3, 4)

    def planks(u, v):
        edge = min(v * 5 % 1, 1 - v * 5 % 1)
        frame = min(u, 1 - u, v, 1 - v) < 0.09
        if not frame and edge < 0.05:
            return (40, 24, 14)
        rings = grain(v, u * 0.25) if frame and 0.09 < u < 0.91 else grain(u * 0.25, v)
        return blend((104, 64, 34), (206, 152, 92), 0.25 * frame + 0.2 + 0.8 * rings)

    return Picture("planks", 128, 128, planks, jpeg=True)


def arrow_picture():
    """An arrow upwards with a red spot at its top right: it shows every way in which a picture can lie wrong."""

    def arrow(u, v):
        if (u - 0.8)**2 + (v - 0.2)**2 < 0.012:
            return (200, 40, 40)
        if (abs(u - 0.5) < 0.1 and 0.35 < v < 0.9) or (0.12 < v <= 0.45 and abs(u - 0.5) < 0.9 * (v - 0.12)):
            return (40, 88, 120)
        if min(u, 1 - u, v, 1 - v) < 0.05:
            return (90, 140, 70)
        return (236, 226, 206)

    return Picture("arrow", 64, 64, arrow)


def crate():
    """Files beside the document, two primitives in a mesh, nearest and linear filter, JPEG and PNG, a turned node."""
    model = Model("crate", images="beside")
    tiles = Picture("tiles", 64, 64, lambda u, v: (168, 166, 158) if checker(u, v, 2) else (96, 104, 112))
    letters = Picture("label", 8, 8, lambda u, v: [(212, 60, 44), (242, 232, 208)][checker(u, v)])
    wood = model.material("planks", texture=model.texture(planks_picture()), roughness=0.8)
    label = model.material("label", texture=model.texture(letters, nearest=True), roughness=0.6)
    ground = model.material("tiles", texture=model.texture(tiles), roughness=0.5)
    model.floor(ground, repeat=12, wall=3.0)
    sides, top = Mesh(), Mesh()
    for turn in range(4):
        right = ((1, 0, 0), (0, 0, -1), (-1, 0, 0), (0, 0, 1))[turn]
        out = cross(right, (0, 1, 0))
        sides.quad(sub(scaled(out, 0.5), scaled(right, 0.5)), right, (0, 1, 0))
    top.quad((-0.5, 1, 0.5), (1, 0, 0), (0, 0, -1))
    both = model.part("meshes", {"primitives": [model.primitive(sides, wood), model.primitive(top, label)]})
    model.node("crate", both, (-0.35, 0, 0), turned((0, 1, 0), 28))
    model.node("small crate", both, (0.95, 0, 0.35), turned((0, 1, 0), -35), 0.6)
    model.node("upper crate", both, (-0.3, 1, 0.05), turned((0, 1, 0), 5), 0.45)
    model.light("sun", "directional", (1, 0.95, 0.85), 2.2, rotation=downwards(50, 48))
    model.light("fill", "point", (0.7, 0.8, 1), 3.0, place=(-2, 2.5, 2.5))
    model.camera("camera", (0.6, 1.7, 3.6), (0.1, 0.6, 0), 38)
    return model


def vase():
    """Smooth normals of a lathe, metallic-roughness texture, an area light."""
    model = Model("vase")
    bands = [(28, 62, 104), (232, 222, 196), (190, 140, 60)]

    def glaze(u, v):
        wave = 0.5 + 0.04 * math.sin(2 * math.pi * 10 * u)
        return bands[2] if abs(v - wave) < 0.06 else bands[(int(v * 9) + 1) % 2 if 0.2 < v < 0.85 else 0]

    def parts(u, v):
        gilded = abs(v - 0.5 - 0.04 * math.sin(2 * math.pi * 10 * u)) < 0.06
        return (0, 80, 255) if gilded else (0, 90 + 130 * (int(v * 9) % 2), 0)

    glazed = model.material("glaze", metallic=1, texture=model.texture(Picture("glaze", 256, 128, glaze)),
                            rough_texture=model.texture(Picture("parts", 256, 128, parts)))
    linen = model.material("linen", (0.55, 0.5, 0.42), roughness=0.9)
    model.floor(linen, wall=2.2)
    profile = []
    for i in range(41):
        height = i / 40
        radius = 0.24 + 0.24 * math.sin(math.pi * min(height * 1.15, 1.0))**1.3 * (1 - 0.35 * height)
        profile.append((radius, 1.5 * height))
    profile = [(0.0, 0.0), (0.24, 0.0), *profile, (profile[-1][0] - 0.03, 1.5)]
    profile += [(profile[-1][0] - 0.02, 1.3), (0.2, 1.1), (0.0, 1.0)]
    model.add("vase", Mesh().lathe(profile, 48), glazed, (-0.2, 0, 0))
    model.add("bowl", Mesh().lathe([(0.0, 0.02), (0.12, 0.0), (0.3, 0.1), (0.38, 0.24), (0.35, 0.24), (0.27, 0.12),
                                    (0.0, 0.06)], 40), glazed, (0.8, 0, 0.5))
    model.lamp("softbox", (-2.6, 2.4, 1.0), (0.9, 0, 1.2), (0.9, 1.4, -0.7), 9, (1, 0.96, 0.9))
    model.lamp("strip", (2.2, 0.4, 1.6), (0.3, 0, -0.9), (0, 1.8, 0), 2.5, (0.7, 0.85, 1))
    model.camera("camera", (0.3, 1.5, 3.9), (0.15, 0.68, 0), 33)
    return model


def spheres():
    """Metals and dielectrics, from smooth to rough, among what they can mirror."""
    model = Model("spheres")
    floor = Picture("chequer", 16, 16, lambda u, v: (196, 190, 180) if checker(u, v, 2) else (60, 66, 80))
    model.floor(model.material("chequer", texture=model.texture(floor, nearest=True), roughness=0.7), repeat=10, wall=3)
    ball = Mesh().ball(0.5, 40)
    metals = [("chrome", (0.78, 0.79, 0.8), 0.12), ("gold", (1.0, 0.72, 0.28), 0.25),
              ("copper", (0.93, 0.5, 0.37), 0.45)]
    others = [("lacquer", (0.6, 0.03, 0.04), 0.12), ("rubber", (0.05, 0.25, 0.1), 0.5),
              ("chalk", (0.8, 0.8, 0.78), 1.0)]
    for row, kinds in enumerate((metals, others)):
        for column, (name, color, roughness) in enumerate(kinds):
            material = model.material(name, color, metallic=1 - row, roughness=roughness)
            model.add(name, ball, material, (1.15 * (column - 1), 0.5, -0.55 + 1.2 * row))
    model.lamp("ceiling", (-1.5, 3.6, 1.5), (3, 0, 0), (0, 0, -2.5), 4)
    model.lamp("window", (-3.2, 0.3, 1.8), (0, 0, -2.2), (0, 1.8, 0), 2, (0.75, 0.85, 1))
    model.camera("camera", (0, 2.6, 4.9), (0, 0.42, 0), 34)
    return model


def leaves():
    """Cards with leaves cut out of them, under an area light and a small sun."""
    model = Model("leaves")

    def leaf(u, v):
        x, y = 2 * u - 1, 1 - v
        width = 0.8 * math.sin(math.pi * min(max(y, 0), 1)**0.8)**0.9
        ribs = abs((y * 7 - 2.2 * abs(x)) % 1 - 0.5) < 0.07 or abs(x) < 0.04
        notch = 0.12 * abs(math.sin(9 * math.pi * y))
        inside = 0.03 < y < 0.97 and abs(x) < width - notch * (width > notch)
        return (*((150, 178, 84) if ribs else blend((40, 92, 30), (86, 140, 48), y)), 255 if inside else 0)

    green = model.material("leaf", texture=model.texture(Picture("leaf", 128, 128, leaf, "RGBA"), (CLAMP, CLAMP)),
                           roughness=0.6, alphaMode="MASK", alphaCutoff=0.5, doubleSided=True)
    clay = model.material("pot", (0.6, 0.26, 0.14), roughness=0.85)
    earth = model.material("earth", (0.12, 0.08, 0.05))
    model.floor(model.material("table", (0.62, 0.56, 0.48), roughness=0.7), wall=2.0)
    model.add("pot", Mesh().lathe([(0.0, 0.0), (0.24, 0.0), (0.24, 0.0), (0.32, 0.42), (0.36, 0.42), (0.36, 0.5),
                                   (0.31, 0.5), (0.31, 0.42), (0.0, 0.42)], 32), clay)
    model.add("earth", Mesh().lathe([(0.31, 0.43), (0.0, 0.46)], 24), earth)
    card = Mesh().quad((-0.5, 0, 0), (1, 0, 0), (0, 1, 0))
    for i in range(9):
        around, lean = math.radians(360 / 9 * i + 11), math.radians(38 + 26 * (i % 2))
        half = [math.sin(around / 2), math.cos(around / 2)]
        tilt = [math.sin(lean / 2), math.cos(lean / 2)]
        # About y, then about the card's own x.
        rotation = [half[1] * tilt[0], half[0] * tilt[1], -half[0] * tilt[0], half[1] * tilt[1]]
        model.add(f"leaf {i}", card, green, (0.05 * math.sin(around), 0.45, 0.05 * math.cos(around)), rotation=rotation,
                  scale=(0.42, 0.85 + 0.15 * (i % 3), 1))
    model.light("sun", "directional", (1, 0.93, 0.8), 1.6, rotation=downwards(40, 50))
    model.lamp("window", (-2.4, 0.2, 2.2), (0, 0, -2.4), (0, 2, 0), 2, (0.75, 0.85, 1))
    model.camera("camera", (0.2, 1.9, 3.3), (0.05, 0.6, 0), 36)
    return model


def window():
    """Transmission with several indices, blended panes, an area light behind them."""
    model = Model("window")
    model.floor(model.material("plaster", (0.7, 0.68, 0.64)), wall=2.0)
    frame = model.material("lead", (0.16, 0.17, 0.19), metallic=1, roughness=0.5)
    colors = [(0.9, 0.15, 0.1), (0.95, 0.7, 0.15), (0.15, 0.55, 0.25), (0.15, 0.3, 0.85)]
    for i, color in enumerate(colors):
        x, low, width = (-1.29, -0.74)[i % 2], 0.11 + 0.62 * (i // 2), (0.48, 0.43)[i % 2]
        if i < 2:
            material = model.material(f"glass {i}", color, roughness=0, glass=1.0)
            model.add(f"pane {i}", Mesh().box((x, low, -0.03), (x + width, low + 0.55, 0.03)), material)
        else:
            material = model.material(f"film {i}", (*color, 0.5), roughness=0.9, alphaMode="BLEND", doubleSided=True)
            model.add(f"pane {i}", Mesh().quad((x, low, 0), (width, 0, 0), (0, 0.55, 0)), material)
    for low, high in (((-1.38, 0, -0.05), (-0.22, 0.1, 0.05)), ((-1.38, 1.29, -0.05), (-0.22, 1.38, 0.05)),
                      ((-1.38, 0.1, -0.05), (-1.3, 1.29, 0.05)), ((-0.3, 0.1, -0.05), (-0.22, 1.29, 0.05)),
                      ((-0.8, 0.1, -0.05), (-0.75, 1.29, 0.05)), ((-1.3, 0.67, -0.04), (-0.3, 0.72, 0.04))):
        model.add("bar", Mesh().box(low, high), frame)
    clear = model.material("crystal", roughness=0, glass=1.0, ior=1.5)
    dense = model.material("diamond", roughness=0, glass=1.0, ior=2.0)
    half = model.material("opal", (0.9, 0.55, 0.75), roughness=0.05, glass=0.5)
    model.add("crystal", Mesh().ball(0.36, 40), clear, (0.25, 0.36, 0.3))
    model.add("diamond", Mesh().ball(0.22, 40), dense, (0.75, 0.22, 0.95))
    model.add("opal", Mesh().ball(0.3, 40), half, (1.0, 0.3, 0.1))
    stripes = Picture("stripes", 32, 32, lambda u, v: (220, 208, 180) if int(u * 8) % 2 else (60, 84, 120))
    model.add("screen", Mesh().quad((-1.6, 0, -1.2), (3.2, 0, 0), (0, 1.5, 0), (2, 1)),
              model.material("stripes", texture=model.texture(stripes)))
    model.lamp("sky", (-1.6, 3, 1.6), (3.2, 0, 0), (0, 0, -3.0), 4.5)
    model.camera("camera", (0.1, 1.5, 3.9), (-0.1, 0.58, 0), 34)
    return model


def lamp():
    """Emission textures, emission that is stronger than 1, and a lamp that is nothing but a texture."""
    model = Model("lamp")

    def paper(u, v):
        rib = min(v * 10 % 1, 1 - v * 10 % 1) < 0.1
        middle = math.exp(-((v - 0.5) * 3.2)**2)
        flower = (u * 4 % 1 - 0.5)**2 + ((v - 0.5) * 2.2)**2 < 0.05
        color = (200, 40, 20) if flower else (255, 190, 96)
        return blend((20, 8, 2), color, 0.25 if rib else 0.3 + 0.7 * middle)

    digits = ("111101101111", "010110010111", "111011110111", "111011001111")
    shown = [digits[0], digits[1], digits[2], digits[3]]

    def clock(u, v):
        column, row = int(u * 16), int(v * 6)
        digit, x = divmod(column, 4)
        rows = [shown[digit][i * 3:i * 3 + 3] for i in range(4)]
        lit = 0 < row < 5 and x < 3 and rows[row - 1][x] == "1"
        return (255, 40, 20) if lit else (8, 4, 4)

    glow = model.material("paper", (0.8, 0.7, 0.5), emission=(1, 1, 1), strength=3,
                          emission_texture=model.texture(Picture("paper", 128, 64, paper)))
    face = model.material("clock", (0.05, 0.05, 0.05), roughness=0.4, emission=(1, 1, 1),
                          emission_texture=model.texture(Picture("clock", 64, 24, clock), (CLAMP, CLAMP), nearest=True))
    case = model.material("case", (0.3, 0.32, 0.36), roughness=0.35)
    bulb = model.material("bulb", (0.8, 0.8, 0.8), emission=(1, 0.75, 0.45), strength=30)
    model.floor(model.material("desk", (0.5, 0.38, 0.28), roughness=0.6), wall=1.2)
    model.add("lantern", Mesh().ball(0.5, 40, 1, 1), glow, (-0.6, 0.62, 0))
    model.add("foot", Mesh().lathe([(0.0, 0.0), (0.25, 0.0), (0.25, 0.0), (0.25, 0.08), (0.25, 0.08), (0.08, 0.16)],
                                   24), case, (-0.6, 0, 0))
    model.add("case", Mesh().box((0.35, 0, 0.15), (1.25, 0.42, 0.45)), case)
    model.add("clock", Mesh().quad((0.4, 0.05, 0.452), (0.8, 0, 0), (0, 0.32, 0)), face)
    model.add("bulb", Mesh().ball(0.09, 20), bulb, (0.75, 1.15, 0.2))
    model.camera("camera", (0.2, 1.35, 3.3), (0.05, 0.6, 0), 36)
    return model


def terrain():
    """Vertex colours as normalised bytes, 32-bit indices, smooth normals, a low sun."""
    model = Model("terrain")
    noise, count, size = layered(8, 5, 3), 64, 6.0

    def height(x, z):
        u, v = x / size + 0.5, z / size + 0.5
        shore = math.exp(-((u - 0.5)**2 + (v - 0.5)**2) * 7)
        return 4.2 * (noise(u * 0.98, v * 0.98) - 0.32) * shore

    positions, normals, colors = [], [], []
    for row in range(count + 1):
        for column in range(count + 1):
            x, z = size * (column / count - 0.5), size * (row / count - 0.5)
            y, step = height(x, z), 0.03
            normal = unit((height(x - step, z) - height(x + step, z), 2 * step,
                           height(x, z - step) - height(x, z + step)))
            positions.append((x, y, z))
            normals.append(normal)
            color = (0.45, 0.4, 0.25) if y < 0.08 else (0.16, 0.3, 0.08) if y < 0.55 else (0.3, 0.27, 0.24)
            if normal[1] < 0.6:
                color = (0.25, 0.2, 0.16)
            if y > 0.95 and normal[1] > 0.5:
                color = (0.85, 0.87, 0.9)
            colors.append([round(255 * x) for x in color] + [255])
    indices = []
    for row in range(count):
        for column in range(count):
            a = row * (count + 1) + column
            indices += [a, a + count + 1, a + count + 2, a, a + count + 2, a + 1]
    low = [min(p[i] for p in positions) for i in range(3)]
    high = [max(p[i] for p in positions) for i in range(3)]
    attributes = {"POSITION": model.values(positions, "VEC3", min=low, max=high),
                  "NORMAL": model.values(normals, "VEC3"),
                  "COLOR_0": model.values(colors, "VEC4", "ubyte", normalized=True)}
    land = model.material("land", roughness=0.95)
    model.node("land", model.part("meshes", {"primitives": [
        {"attributes": attributes, "indices": model.values([(i,) for i in indices], "SCALAR", "uint"),
         "material": land}]}))
    water = model.material("water", (0.02, 0.1, 0.16), roughness=0.15)
    model.add("water", Mesh().quad((-8, 0.02, 8), (16, 0, 0), (0, 0, -16)), water)
    model.light("sun", "directional", (1, 0.86, 0.66), 3.6, rotation=downwards(-60, 28))
    model.lamp("sky", (-9, 9, 9), (18, 0, 0), (0, 0, -18), 0.35, (0.6, 0.75, 1))
    model.camera("camera", (0.5, 3.2, 6.2), (0, 0.3, 0), 34)
    return model


def coordinates():
    """A card for each way in which a texture can lie: wrap modes, filters, transforms, a second set of coordinates."""
    model = Model("coordinates")
    arrow = arrow_picture()
    patches = Picture("patches", 4, 4, lambda u, v: ((220, 60, 50), (250, 240, 220), (50, 100, 160), (235, 175, 50))[
        int(u * 4) % 2 + 2 * (int(v * 4) % 2)])
    square, wide = Mesh().quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), Mesh()
    # Coordinates from -0.5 to 1.5.
    wide.quad((0, 0, 0), (1, 0, 0), (0, 1, 0))
    wide.texcoords = [(2 * u - 0.5, 2 * v - 0.5) for u, v in wide.texcoords]
    cards = [
        (square, model.texture(arrow)),
        (wide, model.texture(arrow)),
        (wide, model.texture(arrow, (CLAMP, CLAMP))),
        (wide, model.texture(arrow, (MIRROR, MIRROR))),
        (wide, model.texture(arrow, (REPEAT, CLAMP))),
        (square, model.texture(patches, nearest=True)),
        (square, model.texture(patches)),
        (square, model.texture(arrow, offset=[0.25, 0.1])),
        (square, model.texture(arrow, rotation=0.5)),
        (square, model.texture(arrow, scale=[2, 3])),
        (square, model.texture(arrow, (MIRROR, REPEAT), offset=[0.2, 0.3], rotation=-0.4, scale=[2.5, 1.5])),
    ]
    for i, (mesh, texture) in enumerate(cards):
        material = model.material(f"card {i}", texture=texture, roughness=1)
        model.add(f"card {i}", mesh, material, (1.15 * (i % 4) - 2.22, 2.35 - 1.15 * (i // 4), 0))
    # The last card has its texture at its second coordinates, which are normalised integers: turned by a quarter.
    material = model.material("second", texture=model.texture(arrow, coordinates=1), roughness=1)
    primitive = model.primitive(square, material)
    primitive["attributes"] = {**primitive["attributes"], "TEXCOORD_1": model.values(
        [(0, 0), (0, 65535), (65535, 0), (65535, 65535)], "VEC2", "ushort", normalized=True)}
    model.node("second", model.part("meshes", {"primitives": [primitive]}), (1.15 * 3 - 2.22, 0.05, 0))
    model.floor(model.material("wall", (0.35, 0.35, 0.37)), wall=0.3)
    model.light("sun", "directional", (1, 1, 1), 2.6, rotation=downwards(25, 30))
    model.camera("camera", (0, 1.7, 6.4), (0, 1.7, 0), 33)
    return model


def room():
    """Point, spot and directional light of KHR_lights_punctual in a room with a window."""
    model = Model("room")
    white = model.material("white", (0.75, 0.74, 0.7))
    red = model.material("red", (0.6, 0.14, 0.1))
    blue = model.material("blue", (0.12, 0.22, 0.5))
    oak = model.material("oak", texture=model.texture(planks_picture()), roughness=0.5)
    model.add("floor", Mesh().quad((-2, 0, 2), (4, 0, 0), (0, 0, -4), (4, 4)), oak)
    model.add("ceiling", Mesh().quad((-2, 2.6, -2), (4, 0, 0), (0, 0, 4)), white)
    model.add("back", Mesh().quad((-2, 0, -2), (4, 0, 0), (0, 2.6, 0)), white)
    model.add("right", Mesh().quad((2, 0, -2), (0, 0, 4), (0, 2.6, 0)), blue)
    # A wall about a window, through which the sun comes.
    for low, high in (((0, 2), (0, 0.9)), ((0, 2), (2.1, 2.6)), ((0, 0.5), (0.9, 2.1)), ((1.4, 2), (0.9, 2.1))):
        model.add("left", Mesh().quad((-2, high[0], -low[0] + 1), (0, 0, low[0] - low[1]),
                                      (0, high[1] - high[0], 0)), red)
    model.add("left front", Mesh().quad((-2, 0, 2), (0, 0, -1), (0, 2.6, 0)), red)
    model.add("left behind", Mesh().quad((-2, 0, -1), (0, 0, -1), (0, 2.6, 0)), red)
    table = Mesh().box((-0.6, 0.7, -0.35), (0.6, 0.76, 0.35))
    for x in (-0.55, 0.48):
        for z in (-0.3, 0.23):
            table.box((x, 0, z), (x + 0.07, 0.7, z + 0.07))
    model.add("table", table, oak, (0.5, 0, -0.4), rotation=turned((0, 1, 0), 20))
    model.add("jug", Mesh().lathe([(0, 0), (0.1, 0), (0.16, 0.12), (0.08, 0.3), (0.11, 0.36), (0.09, 0.36), (0.06, 0.3),
                                   (0, 0.1)], 32), white, (0.4, 0.76, -0.4))
    model.add("stool", Mesh().lathe([(0.24, 0), (0.24, 0.45), (0.24, 0.45), (0, 0.45)], 32), blue, (-0.9, 0, 0.3))
    model.light("bulb", "point", (1, 0.8, 0.55), 1.6, place=(0.5, 2.2, -0.4))
    model.light("spot", "spot", (0.8, 0.9, 1), 12, place=(1.6, 2.4, 1.4), rotation=downwards(30, 45),
                cone=(0.38, 0.42))
    model.light("sun", "directional", (1, 0.9, 0.7), 5, rotation=downwards(-78, 38))
    model.camera("camera", (0.25, 1.45, 5.0), (0, 1.1, 0), 36)
    return model


def smooth_normals(mesh, moved):
    """Of the vertices when each is at `moved` of its place: those of the triangles, by their areas."""
    sums = {p: (0.0, 0.0, 0.0) for p in mesh.positions}
    for triangle in mesh.triangles:
        a, b, c = (moved(mesh.positions[i]) for i in triangle)
        for i in triangle:
            sums[mesh.positions[i]] = add(sums[mesh.positions[i]], cross(sub(b, a), sub(c, a)))
    return [unit(sums[p]) for p in mesh.positions]


def everything():
    """A document with nodes below nodes, skin, morph targets, sparse and quantised accessors, strips, fans, mirrors."""
    model = Model("everything", images="inside")
    model.floor(model.material("floor", (0.5, 0.5, 0.48), roughness=0.8), wall=2.0)
    plain = model.material("plain", (0.75, 0.45, 0.2), roughness=0.6)
    green = model.material("green", (0.15, 0.5, 0.25), roughness=0.35)
    violet = model.material("violet", (0.4, 0.25, 0.65), roughness=0.3)
    marked = model.material("marked", texture=model.texture(arrow_picture()), roughness=0.7)
    bare = model.material("bare", (0.7, 0.2, 0.2), roughness=0.8, doubleSided=True)

    # Skin: a tube that bends at its middle, by joints below a node of their own.
    rings = 16
    tube = Mesh().tube([(0, i / rings, 0) for i in range(rings + 1)], [0.13] * (rings + 1), 20)
    primitive = model.primitive(tube, green)
    shares = [min(max((p[1] - 0.3) / 0.4, 0), 1) for p in tube.positions]
    primitive["attributes"] = {
        **primitive["attributes"],
        "JOINTS_0": model.values([(0, 1, 0, 0)] * len(shares), "VEC4", "ubyte"),
        "WEIGHTS_0": model.values([(round(255 * (1 - s)), 255 - round(255 * (1 - s)), 0, 0) for s in shares], "VEC4",
                                  "ubyte", normalized=True)}
    bend = model.part("nodes", {"name": "bend", "translation": [0, 0.5, 0], "rotation": turned((0, 0, 1), -55)})
    root = model.part("nodes", {"name": "root", "children": [bend], "translation": [-1.45, 0, 0.1]})
    binds = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1), (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.5, 0, 1)]
    skin = model.part("skins", {"joints": [root, bend], "inverseBindMatrices": model.values(binds, "MAT4")})
    model.root["scenes"][0]["nodes"].append(root)
    model.node("worm", model.part("meshes", {"primitives": [primitive]}), skin=skin)

    # Morph targets: a ball, wider and with a bump.
    ball = Mesh().ball(0.34, 32)
    primitive = model.primitive(ball, violet)

    def target(moved):
        moves = [sub(moved(p), p) for p in ball.positions]
        turns = [sub(b, a) for a, b in zip(ball.normals, smooth_normals(ball, moved))]
        return {"POSITION": model.values(moves, "VEC3", min=[min(m[i] for m in moves) for i in range(3)],
                                         max=[max(m[i] for m in moves) for i in range(3)]),
                "NORMAL": model.values(turns, "VEC3")}

    def bump(p):
        return (p[0], p[1] + 0.5 * math.exp(-25 * (p[0]**2 + p[2]**2)) * (p[1] > 0), p[2])

    primitive["targets"] = [target(lambda p: (1.6 * p[0], 0.7 * p[1], p[2])), target(bump)]
    model.node("morphed", model.part("meshes", {"primitives": [primitive], "weights": [0.5, 0.8]}), (-0.55, 0.32, 0.45))

    # A box that is there three times, once mirrored, in nodes below a turned one.
    box = model.part("meshes", {"primitives": [model.primitive(Mesh().quad((0, 0, 0), (0.5, 0, 0), (0, 0.5, 0)).quad(
        (0, 0.5, 0), (0.5, 0, 0), (0, 0, -0.3)).quad((0.5, 0, 0), (0, 0, -0.3), (0, 0.5, 0)), marked)]})
    children = [model.part("nodes", {"name": "first", "mesh": box}),
                model.part("nodes", {"name": "mirrored", "mesh": box, "translation": [1.25, 0, 0],
                                     "scale": [-1, 1, 1]}),
                model.part("nodes", {"name": "high", "mesh": box, "translation": [0.3, 0.52, 0],
                                     "scale": [0.6, 1.2, 0.6]})]
    cosine, sine = math.cos(0.3), math.sin(0.3)
    model.root["scenes"][0]["nodes"].append(model.part("nodes", {
        "name": "boxes", "children": children,
        "matrix": [cosine, 0, sine, 0, 0, 1, 0, 0, -sine, 0, cosine, 0, 0.15, 0, -0.35, 1]}))

    # A strip and a fan, without normals and indices.
    strip = [(0.13 * (i // 2), 0.35 * (i % 2), 0.12 * (i // 2 % 2)) for i in range(12)]
    fan = [(0, 0, 0)] + [(0.22 * math.cos(a), 0.22 * math.sin(a), -0.08) for a in
                         (2 * math.pi * i / 10 for i in range(11))]
    for name, points, mode, place in (("strip", strip, STRIP, (0.5, 0.0, 0.9)), ("fan", fan, FAN, (-0.1, 1.2, 0.2))):
        low, high = [min(p[i] for p in points) for i in range(3)], [max(p[i] for p in points) for i in range(3)]
        model.node(name, model.part("meshes", {"primitives": [
            {"attributes": {"POSITION": model.values(points, "VEC3", min=low, max=high)}, "mode": mode,
             "material": bare}]}), place)

    # A quantised pyramid whose top is moved by a sparse accessor.
    model.extension("KHR_mesh_quantization")
    model.root["extensionsRequired"] = ["KHR_mesh_quantization"]
    corners = [(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), (0, 0, 0)]
    faces = [(4, 1, 0), (4, 2, 1), (4, 3, 2), (4, 0, 3)]
    positions = model.values([[127 * x for x in p] for p in corners], "VEC3", "byte", min=[-127, 0, -127],
                             max=[127, 127, 127])
    model.root["accessors"][positions]["sparse"] = {
        "count": 1, "indices": {"bufferView": model.view(struct.pack("<H", 4)), "componentType": 5123},
        "values": {"bufferView": model.view(struct.pack("<3b", 0, 127, 0)), "byteOffset": 0}}
    model.node("pyramid", model.part("meshes", {"primitives": [
        {"attributes": {"POSITION": positions}, "material": plain,
         "indices": model.values([(i,) for face in faces for i in face], "SCALAR", "ubyte")}]}),
        (-1.35, 0, 0.95), scale=(0.25 / 127, 0.45 / 127, 0.25 / 127))

    model.light("sun", "directional", (1, 0.95, 0.85), 2.4, rotation=downwards(35, 45))
    model.light("fill", "point", (0.75, 0.85, 1), 4, place=(-2, 2.6, 2.5))
    model.camera("camera", (0.1, 1.7, 4.4), (-0.05, 0.55, 0), 36)
    return model


MODELS = {make.__name__: make for make in (crate, vase, spheres, leaves, window, lamp, terrain, coordinates, room,
                                           everything)}
