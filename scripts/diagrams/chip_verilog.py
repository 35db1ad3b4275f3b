"""The chip in Verilog: what rtl/chip/rp_chip.v joins, with what stands in its multiprocessor and its traverser."""
from .svg import Picture

# Modules that are shown from inside, and what of these is left out: arbiters of a few gates.
OPENED = ("chip", "multiprocessor", "traverser")
LEFT_OUT = {"round_robin"}


def around(picture):
    picture.group((14, 40, 872, 772), "chip", "rtl/chip/rp_chip.v: all but memory, frame buffer and host")
    picture.box((346, 66, 218, 62), "controller", ["tiles, which kernel next,", "whether it is safe"])
    picture.box((30, 271, 144, 80), "intersection_pool", ["what rays have hit,", "of each kind"], "box memory")
    picture.box((740, 303, 130, 80), "ray_pool", ["rays that are", "still to be traced"], "box memory")
    picture.box((740, 180, 130, 63), "frame_port", ["contributions", "to pixels"], "box memory")
    picture.box((346, 496, 218, 46), "memory_port", ["one after the other"], "box memory")


def multiprocessor(picture):
    picture.group((200, 156, 500, 298), "multiprocessor")
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


def traverser(picture):
    picture.group((56, 600, 790, 180), "traverser", "what a ray hits; left out, it stands at the chip's ports")
    picture.box((72, 630, 140, 62), "ray_exit", ["record of the hit,", "or contribution"])
    for copy in (2, 1):
        picture.rectangle(320 + 4 * copy, 630 + 4 * copy, 250, 62, "box")
    picture.box((320, 630, 250, 62), "traverser_lane", ["nodes in narrow integers,", "stacks"], times=" x LANES")
    picture.box((680, 630, 144, 62), "ray_setup", ["once for each ray"])
    picture.box((240, 726, 210, 46), "triangle_group", ["triangles, decided exactly"], times=" x PIPES")
    picture.box((480, 726, 150, 46), "tree_banks", ["nodes; triangles"], "box memory", times=" x 2")
    picture.box((680, 726, 144, 46), "tree_port", ["lines, stack blocks"], "box memory")
    picture.wire((680, 661), (578, 661))
    picture.wire((320, 661), (212, 661))
    picture.text(226, 653, "hit or miss")
    picture.wire((370, 700), (370, 726), both=True)
    picture.wire((530, 700), (530, 726), both=True)
    picture.wire((630, 749), (680, 749), both=True)


def between(picture):
    picture.wire((455, 12), (455, 66), both=True)
    picture.text(463, 28, "host: arguments, size of the frame, start; busy")
    picture.wire((455, 128), (455, 190), both=True)
    picture.text(463, 148, "launch: PC, threads, block")
    picture.text(447, 148, "kernel done, idle", anchor="end")
    picture.wire((346, 97), (102, 97), (102, 271), both=True)
    picture.text(112, 90, "levels; places promised")
    picture.wire((174, 311), (212, 311), both=True)
    picture.wire((684, 283), (712, 283), (712, 211), (740, 211), both=True)
    picture.wire((684, 343), (740, 343), both=True)
    picture.wire((838, 180), (838, 12))
    picture.text(830, 28, "frame buffer", anchor="end")
    picture.wire((455, 436), (455, 496), both=True)
    picture.wire((564, 519), (897, 519), both=True)
    picture.text(574, 512, "memory: 128 bits at a time")
    picture.wire((824, 749), (836, 749), (836, 570), (510, 570), (510, 542), both=True)
    picture.text(520, 588, "the tree's lines")
    picture.wire((780, 383), (780, 630))
    picture.text(772, 484, "rays, oldest first", anchor="end")
    picture.wire((72, 661), (44, 661), (44, 351))
    picture.text(52, 486, "intersections, where")
    picture.text(52, 502, "there is room")
    picture.wire((138, 692), (138, 802), (878, 802), (878, 211), (870, 211))
    picture.text(146, 798, "contributions of shadow rays, if it shades")


def draw():
    picture = Picture(826, "raypool: the chip in Verilog")
    around(picture)
    multiprocessor(picture)
    traverser(picture)
    between(picture)
    return picture
