"""The chip: modules of sim/chip/ around the device, which is rtl/multiprocessor.v or its model."""
from .svg import Picture


def device(picture):
    picture.group((184, 124, 532, 346), "device_host", "clocks the device")
    multiprocessor(picture, "in Verilog or C++")


def multiprocessor(picture, note=""):
    picture.group((200, 156, 500, 298), "multiprocessor", note)
    picture.box((350, 190, 210, 46), "block_scheduler", ["idle units first, in turn"])
    for copy in (2, 1):
        picture.rectangle(366 + 4 * copy, 280 + 4 * copy, 170, 62, "box")
    picture.box((366, 280, 170, 62), "compute_unit", ["WARPS x LANES", "threads each"], times=" x UNITS")
    picture.box((212, 288, 118, 46), "import_arbiter", ["by request"])
    picture.box((578, 260, 106, 46), "port_arbiter", ["frame"])
    picture.box((578, 320, 106, 46), "port_arbiter", ["export"])
    picture.box((366, 390, 178, 46), "unit_memory_arbiter", ["port_arbiter"])
    picture.wire((455, 236), (455, 280))
    picture.wire((330, 311), (366, 311), both=True)
    picture.line((544, 311), (560, 311))
    picture.wire((560, 311), (560, 283), (578, 283))
    picture.wire((560, 311), (560, 343), (578, 343))
    picture.wire((455, 350), (455, 390), both=True)


def around(picture):
    picture.box((16, 20, 236, 62), "pixel_ledger", ["told by ports and controller", "who still works on a pixel"])
    picture.box((346, 20, 218, 62), "controller", ["which kernel next (policy),", "and whether it is safe"])
    picture.box((600, 20, 140, 46), "chip_clock", ["1 GHz, 4 phases"])
    picture.box((752, 20, 132, 46), "monitor", ["watchdog"])
    picture.box(
        (16, 271, 144, 80),
        "intersection_pool",
        ["512 of each kind,", "8 cycles for one:", "6 beats of 128 bits"],
        "box memory",
    )
    picture.box(
        (740, 303, 144, 80), "ray_pool", ["512 rays,", "5 cycles for one:", "3 beats of 128 bits"], "box memory"
    )
    picture.box((740, 180, 144, 63), "frame_port", ["one a cycle: pixel", "32, colour 96 bits"], "box memory")
    picture.box((346, 508, 218, 46), "memory_port", ["8 GB/s: a beat in 2 cycles"], "box memory")
    picture.box(
        (604, 508, 190, 62),
        "fixed_latency_memory",
        ["a line's last beat after 120;", "bind another one there"],
        "box memory",
    )
    picture.box((346, 606, 218, 62), "traverser", ["finds what rays hit; when, say", "static_ or modelled_traverser"])


def between(picture):
    picture.wire((455, 82), (455, 190), both=True)
    picture.text(463, 104, "launch: PC, threads, block, import kind (valid/ready)")
    picture.text(447, 104, "kernel done, idle", anchor="end")
    picture.wire((160, 311), (212, 311), both=True)
    picture.wire((684, 283), (728, 283), (728, 211), (740, 211), both=True)
    picture.wire((684, 343), (740, 343), both=True)
    picture.wire((455, 436), (455, 508), both=True)
    picture.wire((564, 531), (604, 531), both=True)
    picture.wire((455, 606), (455, 554), both=True)
    picture.text(463, 584, "lines of the tree, if modelled")
    picture.text(584, 500, "TLM-2.0 socket", anchor="middle")
    picture.text(447, 492, "id 7: unit 2, id of the unit 5", anchor="end")
    picture.wire((812, 383), (812, 637), (564, 637))
    picture.text(804, 629, "oldest first", anchor="end")
    picture.wire((564, 653), (892, 653), (892, 211), (884, 211))
    picture.text(804, 668, "contributions, if it shades", anchor="end")
    picture.wire((346, 637), (88, 637), (88, 351))
    picture.text(96, 629, "what may go on, if there is room")


def draw():
    picture = Picture(690, "raypool: the chip")
    device(picture)
    around(picture)
    between(picture)
    return picture
