"""PNG files of 8 bits a channel, as raypool writes them; and from light to those 8 bits (sim/scene/image.hpp)."""
import struct
import zlib

from .errors import FollowError

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def to_srgb8(linear):
    if linear <= 0:
        return 0
    if linear >= 1:
        return 255
    encoded = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return int(encoded * 255 + 0.5)


def to_fixed(value):
    """A contribution as the frame buffer adds it, in units of 2^-32."""
    return int(value * 2**32 + 0.5) if value > 0 else 0


def paeth(a, b, c):
    p = a + b - c
    return min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]


def read(path):
    """Rows of (red, green, blue)."""
    data = path.read_bytes()
    if data[:8] != SIGNATURE:
        raise FollowError(f"{path}: this is no PNG")
    place, packed = 8, b""
    while place < len(data):
        (length,), kind = struct.unpack_from(">I", data, place), data[place + 4 : place + 8]
        body = data[place + 8 : place + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
            if (depth, colour, interlace) != (8, 2, 0):
                raise FollowError(f"{path}: a picture of another kind than raypool writes")
        packed += body if kind == b"IDAT" else b""
        place += length + 12
    raw, rows, before = zlib.decompress(packed), [], bytes(3 * width)
    for y in range(height):
        kind, row = raw[y * (3 * width + 1)], bytearray(raw[y * (3 * width + 1) + 1 : (y + 1) * (3 * width + 1)])
        for x in range(3 * width):
            left, above, corner = row[x - 3] if x > 2 else 0, before[x], before[x - 3] if x > 2 else 0
            row[x] = (row[x] + (0, left, above, (left + above) // 2, paeth(left, above, corner))[kind]) & 255
        rows.append([tuple(row[3 * x : 3 * x + 3]) for x in range(width)])
        before = row
    return rows


def encode(rows):
    width = len(rows[0])
    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    return SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def enlarged(rows, pixel, factor, frame=(255, 221, 0)):
    """Each pixel a square, with a frame around one of them."""
    big = [[value for value in row for _ in range(factor)] for row in rows for _ in range(factor)]
    last_x, last_y = len(big[0]) - 1, len(big) - 1
    for ring in (1, 2):
        left, top = (max(0, number * factor - ring) for number in pixel)
        right = min(last_x, (pixel[0] + 1) * factor - 1 + ring)
        bottom = min(last_y, (pixel[1] + 1) * factor - 1 + ring)
        for x in range(left, right + 1):
            big[top][x] = big[bottom][x] = frame
        for y in range(top, bottom + 1):
            big[y][left] = big[y][right] = frame
    return big
