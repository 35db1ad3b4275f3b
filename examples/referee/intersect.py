#!/usr/bin/env python3
"""An intersector of your own on a corpus of hard rays (docs/use/referee.md): intersect.py corpus.jsonl answers.jsonl

Replace meet(), which is Moeller and Trumbore's test in double.
"""
import json
import struct
import sys


def single(x):
    """Rounded to a float."""
    try:
        return struct.unpack("f", struct.pack("f", x))[0]
    except OverflowError:
        return float("inf") if x > 0 else float("-inf")


def vector(texts):
    return [float.fromhex(text) for text in texts]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def meet(origin, direction, a, b, c):
    """t where the ray meets the triangle, or -1."""
    edge1, edge2, start = minus(b, a), minus(c, a), minus(origin, a)
    p, q = cross(direction, edge2), cross(start, edge1)
    determinant = dot(edge1, p)
    if determinant == 0:
        return -1
    u, v = dot(start, p) / determinant, dot(direction, q) / determinant
    return dot(edge2, q) / determinant if u >= 0 and v >= 0 and u + v <= 1 else -1


def answer(case):
    found, best = {"hit": False}, float.fromhex(case["limit"])
    for number, corners in enumerate(case["triangles"]):
        t = single(meet(vector(case["origin"]), vector(case["direction"]), *map(vector, corners)))
        if 0 < t < best:
            found, best = {"hit": True, "triangle": number, "t": t.hex()}, t
    return found


def main():
    counts = {"false": 0, "lost": 0, "wrong": 0}
    with open(sys.argv[1]) as corpus, open(sys.argv[2], "w") as answers:
        for number, line in enumerate(corpus):
            case = json.loads(line)
            found = answer(case)
            print(json.dumps({"case": number, **found}), file=answers)
            if not found["hit"]:
                counts["lost"] += not case["miss"]
            elif not case["allowed"]:
                counts["false"] += 1
            else:
                counts["wrong"] += found["triangle"] not in case["allowed"]
    print(f"{number + 1} cases: " + ", ".join(f"{count} {name}" for name, count in counts.items()))


main()
