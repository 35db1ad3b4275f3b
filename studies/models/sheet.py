"""Two pictures of each model side by side, and how much they differ."""
from PIL import Image, ImageChops, ImageDraw, ImageFont

BLOCK = 8
GAP = 4
LABEL = 14
# Of the 256 values of sRGB.
LIGHT = [x / 255 / 12.92 if x < 11 else ((x / 255 + 0.055) / 1.055) ** 2.4 for x in range(256)]


def opened(path):
    with Image.open(path) as image:
        return image.convert("RGB")


def mean(values):
    return sum(values) / len(values)


def lights(image):
    """Linear light, 0 .. 1, of each channel of each pixel. Noise has no share in means of it."""
    return [LIGHT[value] for value in image.tobytes()]


def encoded(light):
    """As sRGB, 0 .. 255."""
    return 255 * (12.92 * light if light <= 0.0031308 else 1.055 * light ** (1 / 2.4) - 0.055)


def blocks(image):
    """Of blocks of 8x8 pixels, in which noise is an eighth, the mean light as sRGB."""
    values, across = lights(image), image.width
    return [encoded(mean([values[3 * (y * across + x) + channel] for y in range(top, top + BLOCK)
                          for x in range(left, left + BLOCK)]))
            for top in range(0, image.height - BLOCK + 1, BLOCK) for left in range(0, across - BLOCK + 1, BLOCK)
            for channel in range(3)]  # fmt: skip


def difference(first, second):
    return mean([abs(a - b) for a, b in zip(first, second)])


def compare(ours, theirs):
    """The mean light of both pictures; the mean absolute difference of pixels and of blocks, in steps of sRGB."""
    a, b = opened(ours), opened(theirs)
    if a.size != b.size:
        raise ValueError(f"{ours} and {theirs} are not of one size")
    return mean(lights(a)), mean(lights(b)), difference(a.tobytes(), b.tobytes()), difference(blocks(a), blocks(b))


def side_by_side(ours, theirs):
    """Both, and four times the difference."""
    a, b = opened(ours), opened(theirs)
    sheet = Image.new("RGB", (3 * a.width + 2 * GAP, a.height), "white")
    for i, image in enumerate((a, b, ImageChops.difference(a, b).point(lambda x: min(4 * x, 255)))):
        sheet.paste(image, (i * (a.width + GAP), 0))
    return sheet


def contact_sheet(pairs):
    """Two models a row, each with its name above our picture and theirs."""
    pictures = [(name, opened(ours), opened(theirs)) for name, (ours, theirs) in pairs.items()]
    width, height = pictures[0][1].size
    cell = 2 * width + GAP
    rows = (len(pictures) + 1) // 2
    sheet = Image.new("RGB", (min(len(pictures), 2) * (cell + 3 * GAP) - 3 * GAP, rows * (height + LABEL + GAP) - GAP),
                      "white")
    draw = ImageDraw.Draw(sheet)
    for i, (name, ours, theirs) in enumerate(pictures):
        x, y = i % 2 * (cell + 3 * GAP), i // 2 * (height + LABEL + GAP)
        for image, left, words in ((ours, x, f"{name}, raypool"), (theirs, x + width + GAP, "Cycles")):
            draw.text((left, y + 1), words, fill="black", font=ImageFont.load_default())
            sheet.paste(image, (left, y + LABEL))
    return sheet
