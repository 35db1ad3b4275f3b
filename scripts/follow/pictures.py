"""Pictures of a journey: the frame with its pixel, the rays in time and space, and signals around four events."""
from diagrams.svg import WIDTH, Picture

from . import packages, picture
from .walk import ORDERED
from .waveform import Signals
from .way import way_picture

BEATS = ("c0", "c1", "c2", "c3", "c4", "c0")
BLOCKS = {"unit": "c0", "ray_pool": "c1", "traverser": "c2", "intersection_pool": "c3", "frame_port": "c4"}


def number_text(value, _):
    return str(value)


def while_high(wave, valid, text):
    """Nothing where the bus is not valid."""
    return lambda value, cycle: text(value, cycle) if wave.value(valid, cycle) else ""


def coloured(cycles):
    """A beat in each of these cycles."""
    return {cycle: BEATS[number % len(BEATS)] for number, cycle in enumerate(cycles)}


def beat_text(cycles):
    beats = {cycle: f"beat {number}" for number, cycle in enumerate(cycles)}
    return lambda _, cycle: beats.get(cycle, "")


def beat_notes(words, said):
    """`said`: of each beat."""
    return [f"beat {number}: {' '.join(f'{word:08x}' for word in words[4 * number : 4 * number + 4])}: {text}"
            for number, text in enumerate(said)]  # fmt: skip


def ray_said(words):
    numbers = [f"{packages.to_float(word):.6g}" for word in words]
    return [
        f"origin {' '.join(numbers[:3])}, direction x {numbers[3]}",
        f"direction y {numbers[4]}, z {numbers[5]}, limit {numbers[6]}, pixel {'%d,%d' % packages.pixel_of(words[7])}",
        f"{'contribution' if packages.is_shadow(words) else 'throughput'} {' '.join(numbers[8:11])}, "
        f"depth {packages.depth_of(words)}",
    ]


def export_picture(wave, life):
    sent, read = life.export.cycles, life.read.cycles
    kept = sent[-1] + 1
    rows = [
        ("export_valid", "export_valid", None, coloured(sent)),
        ("export_ready", "export_ready", None, coloured(sent)),
        ("export_data", "export_data", beat_text(sent), coloured(sent)),
        ("export_last", "export_last", None, {sent[-1]: BEATS[2]}),
        ("outcome_valid", "outcome_valid", None, {kept: "c4"}),
        ("ray_valid", "ray_valid", None, coloured(read)),
        ("ray_data", "ray_data", beat_text(read), coloured(read)),
        ("ray_place", "ray_place", while_high(wave, "ray_valid", number_text), {cycle: "c4" for cycle in read}),
    ]
    title = f"The {packages.full_name(life.words)} leaves the unit, and the ray pool hands it to the traverser"
    return Signals(wave, title, range(life.export.offered - 2, read[-1] + 3), rows,
                   beat_notes(life.words, ray_said(life.words))).picture  # fmt: skip


def node_picture(wave, walk, title):
    """The first node of a walk."""
    visit = walk.visits[0]
    asked, given, tested = ({cycle: colour} for cycle, colour in zip((visit.asked, visit.given, visit.tested), BEATS))
    ordered = {visit.tested + ORDERED: BEATS[3]}
    name = walk.name

    def boxes(value, _):
        return " ".join(str(number) for number in range(4) if value >> number & 1) or "none"

    rows = [
        ("asked", name("asked"), None, asked),
        ("asked_line", name("asked_line"), while_high(wave, name("asked"), number_text), asked),
        ("given_q", name("given_q"), None, given),
        ("number", name("number"), while_high(wave, name("given_q"), number_text), given),
        ("boxes_valid", name("boxes_valid"), None, tested),
        ("met", name("met"), while_high(wave, name("boxes_valid"), boxes), tested),
        ("node_valid_q", name("node_valid_q"), None, ordered),
        ("children", name("children"), while_high(wave, name("node_valid_q"), number_text), ordered),
    ]
    nearest = wave.value(name("nearest"), visit.tested + ORDERED)
    notes = [f"lane {walk.lane}, slot {walk.slot}; met: numbers of the boxes; children: how many of them"]
    if visit.nearest:
        notes.append(f"the nearest is {visit.nearest}: {nearest:08x}")
    return Signals(wave, title, range(visit.asked - 3, visit.tested + ORDERED + 3), rows, notes).picture


def triangle_picture(wave, walk, title):
    """The first triangles of a walk, as many as follow each other."""
    tests = [test for test in walk.tests if test.begun < walk.tests[0].ended]
    begun, ended = ({getattr(test, when): BEATS[number % len(BEATS)] for number, test in enumerate(tests)}
                    for when in ("begun", "ended"))  # fmt: skip
    name = walk.name
    rows = [
        ("test_valid_o", name("test_valid_o"), None, begun),
        ("test_ready_i", name("test_ready_i"), None, begun),
        ("test_number_o", name("test_number_o"), while_high(wave, name("test_valid_o"), number_text), begun),
        ("result_valid_i", name("result_valid_i"), None, ended),
        ("result_number_i", name("result_number_i"), while_high(wave, name("result_valid_i"), number_text), ended),
        ("result_hit_i", name("result_hit_i"), None, ended),
    ]
    notes = [f"triangle {test.number}: {f'hit at t {test.t:.6g}' if test.hit else 'no better hit'}" for test in tests]
    return Signals(wave, title, range(tests[0].begun - 2, tests[-1].ended + 3), rows, notes).picture


def launch_picture(wave, life):
    launch, level = life.launch, (1 << wave.constant("LEVEL_BITS")) - 1
    mine = {cycle: "c0" for cycle in range(launch.offered, launch.cycle + 1)}
    shown = while_high(wave, "launch_valid", number_text)
    rows = [
        ("available, normal", "available", lambda value, _: str(value & level), {}),
        ("reserve_valid", "reserve_valid", None, {launch.reserved: "c3"}),
        ("reserve_count", "reserve_count", while_high(wave, "reserve_valid", number_text), {launch.reserved: "c3"}),
        ("launch_valid", "launch_valid", None, mine),
        ("launch_ready", "launch_ready", None, mine),
        ("launch_pc", "launch_pc", shown, mine),
        ("launch_threads", "launch_threads", shown, mine),
        ("launch_import", "launch_import", shown, mine),
        ("import_request_valid", "import_request_valid", None, {}),
    ]
    notes = [f"launch {launch.number}: {launch.kernel} begins at PC {launch.pc}; import 1: of normal intersections"]
    return Signals(wave, f"The controller launches the kernel for what the {packages.full_name(life.words)} has hit",
                   range(launch.offered - 9, launch.cycle + 6), rows, notes).picture  # fmt: skip


def import_picture(wave, life):
    come = life.come.cycles
    rows = [
        ("import_request_valid", "import_request_valid", None, {life.asked: "c4"}),
        ("import_request_ready", "import_request_ready", None, {life.asked: "c4"}),
        ("import_beat_valid", "import_beat_valid", None, coloured(come)),
        ("import_beat_data", "import_beat_data", beat_text(come), coloured(come)),
    ]
    words = life.come.words
    hit = [f"t {packages.to_float(words[12]):.6g}, u {packages.to_float(words[13]):.6g}, "
           f"v {packages.to_float(words[14]):.6g}, normal x {packages.to_float(words[15]):.6g}",
           f"normal y {packages.to_float(words[16]):.6g}, z {packages.to_float(words[17]):.6g}, "
           f"material at {words[18]}, triangle {words[19]}", "word 20 is 0"]  # fmt: skip
    return Signals(wave, f"What the {packages.full_name(life.words)} has hit comes into the unit",
                   range(life.asked - 2, come[-1] + 3), rows,
                   beat_notes(words, ray_said(words) + hit)).picture  # fmt: skip


def frame_picture(wave, life, pixel):
    came = life.contribution[0]
    gone = life.spans[-1].end - 1
    text = f"{pixel[0]},{pixel[1]}"

    def pixel_text(value, _):
        return "%d,%d" % packages.pixel_of(value)

    def color_text(value, _):
        return " ".join(f"{packages.to_float(word):.3g}" for word in packages.words_of(value, 3))

    rows = [
        ("unit_frame_valid", "unit_frame_valid", None, {came: "c4"}),
        ("unit_frame_pixel", "unit_frame_pixel", while_high(wave, "unit_frame_valid", pixel_text), {came: "c4"}),
        ("unit_frame_color", "unit_frame_color", while_high(wave, "unit_frame_valid", color_text), {came: "c4"}),
        ("frame_valid_o", "frame_valid_o", None, {gone: "c4"}),
        ("frame_pixel_o", "frame_pixel_o", while_high(wave, "frame_valid_o", pixel_text), {gone: "c4"}),
        ("frame_color_o", "frame_color_o", while_high(wave, "frame_valid_o", color_text), {gone: "c4"}),
    ]
    notes = [f"for pixel {text}: {' '.join(f'{word:08x}' for word in life.contribution[2])}: red, green, blue "
             + packages.text([packages.to_float(word) for word in life.contribution[2]])]  # fmt: skip
    return Signals(wave, f"The contribution of the {packages.full_name(life.words)} goes to the frame buffer",
                   range(came - 1, gone + 3), rows, notes).picture  # fmt: skip


def time_picture(journey, pixel):
    lives = list(journey.lives.values())
    spans = [span for life in lives for span in life.spans]
    first, last = min(span.begin for span in spans), max(span.end for span in spans)
    left, row, top = 100, 34, 62
    per_cycle = (WIDTH - left - 20) / (last - first)
    drawn = Picture(
        top + row * len(lives) + 40, f"raypool: where the rays of pixel {pixel[0]},{pixel[1]} were, and when"
    )
    drawn.text(16, 24, f"Where the rays of pixel {pixel[0]},{pixel[1]} were, in which cycle", "part")
    x = 16
    for block, colour in BLOCKS.items():
        drawn.rectangle(x, 36, 16, 14, colour, 3)
        drawn.text(x + 22, 47, block, "part")
        x += 22 + 7.7 * len(block) + 22
    step = next(step for scale_ in (10, 100, 1000, 10000, 100000) for step in (scale_, 2 * scale_, 5 * scale_)
                if step * per_cycle > 70)  # fmt: skip
    for cycle in range(-(-first // step) * step, last + 1, step):
        at = left + (cycle - first) * per_cycle
        drawn.shapes.append(f'<path d="M{at:.1f} {top} V{top + row * len(lives) + 6}" class="grid"/>')
        if at < WIDTH - 30:
            drawn.text(at, top + row * len(lives) + 22, str(cycle), "wide", "middle")
    for number, life in enumerate(lives):
        y = top + row * number
        drawn.text(16, y + 22, life.name, "part")
        for span in life.spans:
            begin, width = left + (span.begin - first) * per_cycle, max(3, (span.end - span.begin) * per_cycle)
            drawn.rectangle(round(begin, 1), y + 6, round(width, 1), 22, BLOCKS[span.block], 3)
            words = f"unit {life.launch.unit}" if span.block == "unit" else span.block
            if len(words) * 6.3 + 6 < width:
                drawn.text(begin + width / 2, y + 21, words, "wide", "middle")
    return drawn


def draw_pictures(options, frame, chip, journey, tree, materials):
    """Those that this pixel has; their names."""
    eye = journey.lives["eye"]
    drawn = {"time": time_picture(journey, options.pixel), "way": way_picture(journey, tree, materials)}
    if eye.read:
        drawn["export"] = export_picture(chip.wave, eye)
        if eye.walk.visits:
            title = f"The {packages.full_name(eye.words)} comes to node {eye.walk.visits[0].node}"
            drawn["node"] = node_picture(chip.wave, eye.walk, title)
        if eye.walk.tests:
            title = f"Triangles for the {packages.full_name(eye.words)}, in the pipe"
            drawn["triangle"] = triangle_picture(chip.wave, eye.walk, title)
    if eye.come:
        drawn["launch"] = launch_picture(chip.wave, eye)
        drawn["import"] = import_picture(chip.wave, eye)
    added = [life for life in journey.lives.values() if life.contribution and life.come]
    if added:
        drawn["frame"] = frame_picture(chip.wave, added[-1], options.pixel)
    frame.out.mkdir(parents=True, exist_ok=True)
    for old in ("frame", "import", "launch", "triangle", "node", "export"):  # of another pixel
        (frame.out / f"{old}.svg").unlink(missing_ok=True)
    for name, one in drawn.items():
        (frame.out / f"{name}.svg").write_text(one.svg(), encoding="utf-8")
    rows = picture.read(frame.folder / "image.png")
    factor = max(1, 640 // len(rows[0]))
    (frame.out / "pixel.png").write_bytes(picture.encode(picture.enlarged(rows, options.pixel, factor)))
    return ["pixel.png"] + [f"{name}.svg" for name in drawn]
