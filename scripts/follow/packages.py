"""Words of rays and intersections, as docs/machine/architecture.md has them."""
import struct

RAY_WORDS, INTERSECTION_WORDS = 12, 21
ORIGIN, DIRECTION, LIMIT, PIXEL, COLOR, FLAGS, DISTANCE, BARYCENTRIC, NORMAL, MATERIAL, TRIANGLE = (
    0, 3, 6, 7, 8, 11, 12, 13, 15, 18, 19)  # fmt: skip
SHADOW = 1 << 31
MATERIAL_BYTES = 32


def to_float(word):
    return struct.unpack("<f", struct.pack("<I", word))[0]


def to_word(value):
    return struct.unpack("<I", struct.pack("<f", value))[0]


def words_of(value, count):
    """Of a bus: its lowest first."""
    return [value >> 32 * number & 0xFFFFFFFF for number in range(count)]


def floats(words, first, count=3):
    return [to_float(word) for word in words[first : first + count]]


def pixel_of(word):
    return word & 0xFFFF, word >> 16


def is_shadow(words):
    return bool(words[FLAGS] & SHADOW)


def depth_of(words):
    return words[FLAGS] & 0xFF


def name_of(words):
    """A pixel has one ray of each."""
    depth = depth_of(words)
    return f"shadow{depth}" if is_shadow(words) else "eye" if depth == 1 else f"reflection{depth}"


def full_name(words):
    depth = depth_of(words)
    kind = "shadow ray" if is_shadow(words) else "reflection ray"
    return "eye ray" if name_of(words) == "eye" else f"{kind} of depth {depth}"


def text(values):
    return " ".join(f"{value:.6g}" for value in values)


def ray_text(words):
    """A ray's words as text, a line for each beat of four words or so."""
    weight = "contribution" if is_shadow(words) else "throughput"
    return [
        f"origin {text(floats(words, ORIGIN))}",
        f"direction {text(floats(words, DIRECTION))}",
        f"limit {to_float(words[LIMIT]):.6g}, pixel {'%d,%d' % pixel_of(words[PIXEL])}, {weight} "
        f"{text(floats(words, COLOR))}, depth {depth_of(words)}" + (", shadow ray" if is_shadow(words) else ""),
    ]


def hit_text(words):
    return [
        f"t {to_float(words[DISTANCE]):.6g}, u {to_float(words[BARYCENTRIC]):.6g}, "
        f"v {to_float(words[BARYCENTRIC + 1]):.6g}, triangle {words[TRIANGLE]}",
        f"normal {text(floats(words, NORMAL))}, material record at byte {words[MATERIAL]}",
    ]


def beats_text(words):
    """Hexadecimal, four words a line: beat by beat."""
    return [f"words {first:>2} ..  {' '.join(f'{word:08x}' for word in words[first : first + 4])}"
            for first in range(0, len(words), 4)]  # fmt: skip
