"""The compute unit: modules of rtl/ and what passes between them."""
from .svg import Picture


def launch_and_fetch(picture):
    picture.wire((116, 12), (116, 58))
    picture.text(124, 28, "launch: PC 16, threads 11, block 32, blocks 32, import 2 (valid/ready)")
    picture.box((32, 58, 168, 46), "launcher", ["one launch may wait"])
    picture.box((32, 150, 168, 46), "fetch_arbiter", ["round_robin, 1 a cycle"])
    picture.box((32, 244, 168, 62), "instruction_cache", ["2 ways, 64-byte lines", "instruction_cache.bytes"],
                "box memory")
    picture.modules.add("round_robin")
    picture.wire((200, 81), (330, 81), (330, 118))
    picture.text(338, 86, "start, PC 16, lanes")
    picture.wire((116, 196), (116, 244))
    picture.text(124, 224, "grant: warp, PC 16")
    picture.wire((320, 236), (262, 236), (262, 173), (200, 173))
    picture.text(206, 165, "request,")
    picture.text(206, 189, "PC 16")
    picture.wire((200, 272), (320, 272))
    picture.text(206, 266, "hit, 64 bits")


def warp(picture):
    picture.group((300, 118, 538, 200), "warp", "x WARPS", copies=2)
    picture.box((320, 148, 190, 46), "pc_stack", ["PC, RPC x STACK_DEPTH"])
    picture.box((320, 222, 190, 80), "instruction_buffer", ["next: instruction routine", "current: data routine"])
    picture.box((600, 148, 218, 46), "predicate_file", ["p0 .. p15, LANES bits each"], "box memory")
    picture.box((600, 222, 218, 80), "ram_2r1w", ["register bank", "16 x LANES x 32 bits"], "box memory")
    picture.wire((415, 194), (415, 222))
    picture.text(422, 212, "PC 16")
    picture.wire((510, 246), (555, 246), (555, 171), (600, 171))
    picture.text(516, 164, "guard, x, b")
    picture.wire((510, 272), (600, 272))
    picture.text(516, 288, "ra, rb, rd")


def dispatch(picture):
    picture.wire((415, 326), (415, 352), both=True)
    picture.text(423, 346, "want, instruction 64; grant")
    picture.wire((709, 326), (709, 352))
    picture.text(717, 346, "mask, operands")
    picture.box(
        (64, 352, 774, 46),
        "dispatcher",
        ["every ready ALU instance is granted to the lowest warp that wants its type and has none yet"],
    )
    picture.box(
        (64, 408, 774, 60),
        "task_register",
        [
            "warp, operation 5, mask LANES, operands a and b (and c) LANES x 32, immediate 32, word 5,",
            "predicates x and b LANES; 1 .. 4 instances (TID_COUNT ..) of each of the five left types",
        ],
        times=" x INSTANCES",
    )


ALUS = [  # left edge, width, name, modules inside, notes
    (64, 74, "tid_alu", [], ["indices,", "arguments"]),
    (146, 74, "brh_alu", [], ["compares,", "control"]),
    (228, 74, "int_alu", [], ["integer,", "logic"]),
    (310, 136, "flt_alu", ["float_lane", "float_adder", "float_multiplier", "float_convert", "float_fma"], []),
    (454, 114, "slw_alu", ["slow_lane", "slow_prepare", "slow_exact", "slow_newton"], []),
    (576, 136, "mem_alu", ["memory_sequencer", "data_cache", "miss_status", "request_queue"], []),
    (720, 118, "ray_alu", ["ray_import", "ray_memory x 3", "ray_export"], []),
]


def alus(picture):
    for x, width, name, parts, notes in ALUS:
        picture.wire((x + width / 2, 468), (x + width / 2, 498), both=True)
        picture.box((x, 498, width, 116), name, notes, "box", parts)
        picture.line((x + 16, 614), (x + 16, 640))
    picture.text(444, 486, "task, ready", anchor="middle")
    picture.wire((80, 640), (866, 640), (866, 220), (846, 220))
    picture.text(64, 658, "done, registered: valid, warp, data LANES x 32, predicate LANES; written back in that cycle")


def memory(picture):
    picture.wire((44, 306), (44, 714), (560, 714), both=True)
    picture.text(52, 706, "line wanted by the instruction cache: address 32; back: 4 beats of 128 bits")
    picture.wire((660, 614), (660, 690), both=True)
    picture.text(652, 682, "lines, quadwords", anchor="end")
    picture.box((560, 690, 150, 46), "memory_arbiter", ["instructions first"])
    picture.box((64, 740, 262, 46), "performance_counters", ["events of all blocks, 64 bits each"])


def ports(picture):
    picture.wire((635, 736), (635, 824), both=True)
    picture.text(627, 820, "memory request: address 32, data 128, mask 4, id 5 (valid/ready)", anchor="end")
    picture.text(627, 836, "response: beat of 128 bits, its number 2, id 5 (always taken)", anchor="end")
    for x, y, words in [
        (766, 824, "import: 6 beats"),
        (796, 844, "export: ray, 3 beats"),
        (826, 864, "frame: pixel 32, colour 96"),
    ]:
        picture.wire((x, 614), (x, y), both=x == 766)
        picture.text(x - 6, y - 3, words, anchor="end")


def draw():
    picture = Picture(876, "raypool: the compute unit")
    picture.group((16, 40, 868, 758))
    picture.text(868, 60, "compute_unit", "name", "end")
    picture.modules.add("compute_unit")
    warp(picture)
    launch_and_fetch(picture)
    dispatch(picture)
    alus(picture)
    memory(picture)
    ports(picture)
    return picture
