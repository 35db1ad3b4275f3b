#!/usr/bin/env python3
"""Corpora as others use them: referee_test.py RAYPOOL CXX

Certificates are those of rational numbers in Python, which knows nothing of ours; the examples answer a corpus, and
count what the judge counts of their answers.
"""
import fractions
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "referee"
CASES = 1800
LARGEST = (1 << 128) - (1 << 103)  # the largest float, and half a unit in its last place


def run(*words):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"FAILED: {' '.join(map(str, words))} ends with {result.returncode}: {result.stderr}")
    return result.stdout


def exact(texts):
    """None where one is not a number."""
    values = [float.fromhex(text) for text in texts]
    finite = all(abs(value) < float("inf") for value in values)
    return [fractions.Fraction(value) for value in values] if finite else None


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def meeting(origin, direction, corners):
    """(t, how many of its edges the ray passes exactly), or None."""
    a, b, c = (minus(exact(corner), origin) for corner in corners)
    sides = [dot(direction, cross(p, q)) for p, q in ((b, c), (c, a), (a, b))]
    if sum(sides) == 0 or any(s < 0 for s in sides) and any(s > 0 for s in sides):
        return None
    normal = cross(minus(b, a), minus(c, a))
    return dot(normal, a) / dot(normal, direction), sides.count(0)


def below(t, limit):
    return limit == float("inf") or t < fractions.Fraction(limit)


def check_certificate(case):
    """What a certificate has of each triangle, by Python's own rational numbers; True if the case has a hit."""
    origin, direction, limit = exact(case["origin"]), exact(case["direction"]), float.fromhex(case["limit"])
    said = {hit["triangle"]: hit for hit in case["hits"]}
    is_ray = origin and direction and any(direction) and limit > 0
    for number, corners in enumerate(case["triangles"]):
        found, hit = is_ray and meeting(origin, direction, corners), said.pop(number, None)
        if hit:
            assert found, f"a hit of triangle {number} that there is not"
            assert fractions.Fraction(hit["exact"]) == found[0], "another t"
            assert ["inside", "edge", "corner"][found[1]] == hit["at"], "another place"
            rounded = float.fromhex(hit["t"])
            error = abs(found[0] - fractions.Fraction(min(rounded, 2.0 ** 128)))
            assert error <= fractions.Fraction(2.0 ** -150) or error * 2 ** 24 <= found[0] or found[0] >= LARGEST
        elif found:
            assert found[0] <= 0 or not below(found[0], limit), f"triangle {number} is missing"
    assert not said, "hits of triangles that do not exist"
    if not case["hits"]:
        assert case["miss"] and not case["allowed"]
        return False
    # The first hit inside a triangle is right, with all at the same time; what is behind it is not.
    times = {hit["triangle"]: fractions.Fraction(hit["exact"]) for hit in case["hits"]}
    inside = [times[hit["triangle"]] for hit in case["hits"]
              if hit["at"] == "inside" and below(times[hit["triangle"]], limit) and
              0 < float.fromhex(hit["t"]) < limit]
    if inside:
        assert not case["miss"]
        floats = {hit["triangle"]: hit["t"] for hit in case["hits"]}
        first = [number for number in times if times[number] == min(inside)]
        for number, t in times.items():
            if t > min(inside) and floats[number] != floats[first[0]]:
                assert number not in case["allowed"], "a triangle behind the first"
            if len(set(times.values())) == 1:
                assert number in case["allowed"]
    return True


def check_certificates(corpus):
    hits = 0
    for line in corpus.read_text().splitlines():
        case = json.loads(line)
        try:
            hits += check_certificate(case)
        except AssertionError as error:
            sys.exit(f"FAILED: case {case['case']}, {case['kind']}: {error}")
    assert hits > CASES // 3, hits
    print(f"{CASES} certificates, {hits} with a hit, are those of Python's rational numbers")


def row_of(table, name):
    """(false, lost, wrong)"""
    found = re.search(rf"^{name} +{CASES} +(\d+) +(\d+) +(\d+) ", table, re.M)
    assert found, table
    return tuple(map(int, found.groups()))


def check_example(raypool, corpus, name, command):
    answers = corpus.parent / f"{name}.jsonl"
    said = re.fullmatch(rf"{CASES} cases: (\d+) false, (\d+) lost, (\d+) wrong\n", run(*command, corpus, answers))
    counts = tuple(map(int, said.groups()))
    table = run(raypool, "referee", "--corpus", corpus, "--answers", answers, "--quiet")
    assert row_of(table, name) == counts, f"{name}: {counts}, but the table shows\n{table}"
    assert 0 < sum(counts) < CASES // 4, counts
    print(f"{name}: {counts[0]} false, {counts[1]} lost, {counts[2]} wrong, as in the table")
    return counts


def main():
    raypool, compiler = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        corpus = folder / "corpus.jsonl"
        run(raypool, "referee", "--cases", CASES, "--write", corpus)
        check_certificates(corpus)
        run(compiler, "-std=c++17", "-O1", EXAMPLES / "intersect.cpp", "-o", folder / "intersect")
        in_cpp = check_example(raypool, corpus, "in_cpp", [folder / "intersect"])
        in_python = check_example(raypool, corpus, "in_python", ["python3", EXAMPLES / "intersect.py"])
        assert in_cpp == in_python
        for example in EXAMPLES.iterdir():
            assert len(example.read_text().splitlines()) <= 75, example


main()
