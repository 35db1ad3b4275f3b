"""The cycle chart: in which stage each instruction of two warps is, from a run of rtl/ in tb/icarus/stage_trace.v."""
import pathlib
import subprocess

from .svg import DiagramError, Picture

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = ROOT / "tb/icarus/stages.asm"
LEFT, CELL, ROW = 196, 20, 22
ROUTINES = [  # stages with the module that does them
    (
        "instruction routine",
        [
            ("PCStack", "pc_stack"),
            ("IArb", "fetch_arbiter"),
            ("ICache", "instruction_cache"),
            ("IBuf", "instruction_buffer"),
        ],
    ),
    ("data routine", [("RegFile", "ram_2r1w"), ("Dispatch", "dispatcher"), ("ALUEx", "its ALU"), ("WriBack", "warp")]),
]


def run(command, **options):
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, **options)
    if result.returncode != 0:
        raise DiagramError(f"{command[0]} failed: {result.stderr.strip() or result.stdout.strip()}")
    return result.stdout


def trace(raypool, folder):
    """What the RTL did: a set of (cycle, warp, stage, PC), cycles from 0 on."""
    folder.mkdir(parents=True, exist_ok=True)
    words, bench = folder / "stages.hex", folder / "stage_trace.vvp"
    run([raypool, "asm", PROGRAM, "-o", words])
    verilog = sorted((ROOT / "rtl").glob("*/*.v"))
    run(["iverilog", "-g2005", "-Irtl/include", "-s", "stage_trace", "-o", bench, "tb/icarus/stage_trace.v"] + verilog)
    events = [line.split() for line in run(["vvp", "-n", bench, f"+program={words}"]).splitlines()]
    events = [(int(e[0]), int(e[1]), e[2], int(e[3])) for e in events if len(e) == 4 and e[0].isdigit()]
    if not events:
        raise DiagramError("tb/icarus/stage_trace.v printed no stage: run it by hand in " + str(folder))
    first = min(event[0] for event in events)
    return {(cycle - first, warp, stage, pc) for cycle, warp, stage, pc in events}


def source_lines():
    """The program's instructions, in the order of their PCs."""
    lines = [line.strip() for line in PROGRAM.read_text().splitlines()]
    return [" ".join(line.split()) for line in lines if line and line[0] not in "#."]


def legend(picture, top):
    x = 16
    for pc, words in enumerate(source_lines()):
        picture.rectangle(x, top, CELL, 18, f"c{pc}", 3)
        picture.text(x + CELL / 2, top + 13, str(pc), "part", "middle")
        picture.text(x + CELL + 6, top + 13, words, "part")
        x += CELL + 24 + len(words) * 7.7
    picture.rectangle(x, top, CELL, 18, "c0 waits", 3)
    picture.text(x + CELL + 6, top + 13, "not done here, stays")


def panel(picture, top, warp, events, cycles):
    """One warp's rows; returns where the next thing may begin."""
    y = top
    for routine, stages in ROUTINES:
        picture.text(16, y + 15, f"warp {warp}: {routine}")
        y += ROW
        for stage, module in stages:
            picture.text(24, y + 15, stage, "name")
            picture.text(LEFT - 10, y + 15, module, "wide", "end")
            picture.shapes.append(f'<path d="M{LEFT} {y + ROW - 0.5} H{LEFT + cycles * CELL}" class="grid"/>')
            for cycle, _, _, pc in sorted(event for event in events if event[1:3] == (warp, stage)):
                stays = stage != "ALUEx" and (cycle + 1, warp, stage, pc) in events
                x = LEFT + cycle * CELL
                picture.rectangle(x + 1, y + 2, CELL - 2, ROW - 4, f"c{pc} waits" if stays else f"c{pc}", 3)
                picture.text(x + CELL / 2, y + 16, str(pc), "part", "middle")
            y += ROW
    return y


def draw(raypool, folder):
    events = trace(raypool, folder)
    cycles = max(event[0] for event in events) + 1
    warps = sorted({event[1] for event in events})
    rows = sum(1 + len(stages) for _, stages in ROUTINES)
    height = 80 + len(warps) * (rows * ROW + 14)
    picture = Picture(height, "raypool: the two routines of a warp, cycle by cycle")
    legend(picture, 12)
    picture.text(16, 56, "cycle")
    for cycle in range(cycles):
        picture.text(LEFT + cycle * CELL + CELL / 2, 56, str(cycle), "wide", "middle")
    top = 64
    for warp in warps:
        top = panel(picture, top, warp, events, cycles) + 14
    return picture
