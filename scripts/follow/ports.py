"""What passes the ports between the blocks of rtl/chip/rp_chip.v in a frame, in its order: launches, rays,
intersections and contributions. Their order is what the blocks promise: pools are queues, and a unit imports launch
after launch."""
import bisect
from dataclasses import dataclass, field

from . import packages
from .errors import FollowError
from .walk import LANE_SIGNALS, TRAVERSER_SIGNALS

KERNELS = {"eye_pc_i": "cast_eye", "secondary_pc_i": "cast_secondary", "direct_pc_i": "cast_secondary_direct",
           "shade_pc_i": "shade"}  # fmt: skip
KINDS = {1: "normal", 2: "shadow", 3: "direct"}
PORTS = {
    "launch": "valid ready unit pc threads block import",
    "export": "valid ready data last unit",
    "outcome": "valid kept deep shadow pixel",
    "reserve": "valid kind count",
    "import": "request_valid request_ready request_kind request_unit beat_valid beat_data",
    "unit_frame": "valid ready pixel color unit",
    "ray": "valid ready data last place",
    "put": "valid ready kind data",
    "contribution": "valid ready pixel color",
    "retire": "valid pc instruction mask data predicate",
}
SIGNALS = [f"{port}_{name}" for port, names in PORTS.items() for name in names.split()] + [
    "kernel_done", "free_valid", "free_place", "frame_valid_o", "frame_ready_i", "frame_pixel_o", "frame_color_o",
    "argument_write_i", "argument_index_i", "argument_data_i", "program_length_i", "width_i", "height_i",
    "depth_limit_i", "available", "CULLING", "UNITS", "WARPS", "LANES", "INTERSECTION_WORDS", "LEVEL_BITS", *KERNELS,
    *TRAVERSER_SIGNALS, *LANE_SIGNALS]  # fmt: skip


@dataclass
class Launch:
    number: int
    cycle: int  # in which the unit takes it
    offered: int
    unit: int
    pc: int
    threads: int
    block: int
    kind: int  # of its intersections; 0: none
    kernel: str
    done: int = 0
    reserved: int = 0
    first_import: int = 0  # of its unit


@dataclass
class Package:
    """Beats that have passed a port, and what came with them."""

    cycles: list = field(default_factory=list)
    words: list = field(default_factory=list)
    unit: int = 0
    kind: int = 0
    place: int = 0
    offered: int = 0


class Chip:
    """All that passes the ports in the frame."""

    def __init__(self, wave):
        self.wave = wave
        self.units, self.warps, self.lanes = (wave.constant(name) for name in ("UNITS", "WARPS", "LANES"))
        if wave.constant("INTERSECTION_WORDS") != packages.INTERSECTION_WORDS:
            raise FollowError(
                f"this machine's intersections are compact records of {wave.constant('INTERSECTION_WORDS')} words, "
                "which cannot be followed: draw with --set intersection_words=21"
            )
        self.entries = {wave.constant(port): name for port, name in KERNELS.items()}
        ends = sorted(self.entries)[1:] + [wave.constant("program_length_i")]
        self.exit_pcs = {end - 1 for end in ends}  # a kernel ends with its only exit
        self.arguments = self.read_arguments()
        self.launches = self.read_launches()
        self.exports = self.read_exports()
        self.outcomes = list(wave.high("outcome_valid"))
        self.rays = self.read_rays()
        self.freed = [(cycle, wave.value("free_place", cycle)) for cycle in wave.high("free_valid")]
        self.puts = self.read_puts()
        self.requests, self.imports = self.read_imports()
        self.shaded = self.contributions("unit_frame_valid", "unit_frame_ready", "unit_frame_pixel", "unit_frame_color")
        self.handed = self.contributions(
            "contribution_valid", "contribution_ready", "contribution_pixel", "contribution_color"
        )
        self.frame = self.contributions("frame_valid_o", "frame_ready_i", "frame_pixel_o", "frame_color_o")

    def read_arguments(self):
        """Written before the frame begins."""
        wave, words = self.wave, {}
        for time in wave.edges[: wave.first]:
            if wave.signals["argument_write_i"].at(time):
                words[wave.signals["argument_index_i"].at(time)] = wave.signals["argument_data_i"].at(time)
        return words

    def read_launches(self):
        wave, launches, taken = self.wave, [], [0] * self.units
        offered = None
        for cycle in wave.high("launch_valid"):
            offered = cycle if offered is None else offered
            if not wave.value("launch_ready", cycle):
                continue
            names = ("launch_unit", "launch_pc", "launch_threads", "launch_block", "launch_import")
            unit, pc, threads, block, kind = (wave.value(name, cycle) for name in names)
            if pc not in self.entries:
                raise FollowError(f"in cycle {cycle} a kernel is launched at PC {pc}, where none begins")
            launches.append(Launch(len(launches), cycle, offered, unit, pc, threads, block, kind, self.entries[pc]))
            launches[-1].first_import = taken[unit]
            taken[unit] += threads if kind else 0
            offered = None
        reserving = (launch for launch in launches if launch.kind)
        for cycle, launch in zip(wave.high("reserve_valid"), reserving):
            launch.reserved = cycle
        for unit in range(self.units):
            ended = (cycle for cycle in wave.high("kernel_done") if wave.value("kernel_done", cycle) >> unit & 1)
            for cycle, launch in zip(ended, (launch for launch in launches if launch.unit == unit)):
                launch.done = cycle
        return launches

    def beats(self, cycles, data, is_last):
        """Packages, each of the beats until the last of it."""
        package = Package()
        for cycle in cycles:
            package.cycles.append(cycle)
            package.words += packages.words_of(self.wave.value(data, cycle), 4)
            if is_last(cycle, package):
                yield package
                package = Package()

    def read_exports(self):
        wave = self.wave
        rays = list(
            self.beats(
                wave.transfers("export_valid", "export_ready"), "export_data", lambda c, _: wave.value("export_last", c)
            )
        )
        valid = list(wave.high("export_valid"))
        before = -1
        for ray in rays:
            ray.unit = wave.value("export_unit", ray.cycles[0])
            ray.offered = valid[bisect.bisect_right(valid, before)]
            before = ray.cycles[-1]
        return rays

    def read_rays(self):
        """What the traverser reads."""
        wave = self.wave
        rays = list(
            self.beats(wave.transfers("ray_valid", "ray_ready"), "ray_data", lambda c, _: wave.value("ray_last", c))
        )
        for ray in rays:
            ray.place = wave.value("ray_place", ray.cycles[0])
        return rays

    def read_puts(self):
        wave = self.wave
        taken = [
            cycle
            for cycle in wave.high("put_valid")
            if wave.value("put_ready", cycle) >> wave.value("put_kind", cycle) - 1 & 1
        ]
        puts = list(self.beats(taken, "put_data", lambda _, package: len(package.words) >= 21))
        for put in puts:
            put.kind = wave.value("put_kind", put.cycles[0])
        return puts

    def read_imports(self):
        """Requests that have been taken, (cycle, kind, unit), and the packages that came: one for each."""
        wave = self.wave
        requests = [
            (cycle, wave.value("import_request_kind", cycle), wave.value("import_request_unit", cycle))
            for cycle in wave.transfers("import_request_valid", "import_request_ready")
        ]
        come = list(self.beats(wave.high("import_beat_valid"), "import_beat_data", lambda _, p: len(p.words) >= 21))
        for package, (_, kind, unit) in zip(come, requests):
            package.kind, package.unit = kind, unit
        return requests, come

    def contributions(self, valid, ready, pixel, color):
        """(cycle, pixel word, colour's words)"""
        wave = self.wave
        return [
            (cycle, wave.value(pixel, cycle), packages.words_of(wave.value(color, cycle), 3))
            for cycle in wave.transfers(valid, ready)
        ]

    def launch_of_import(self, number):
        """The launch that has asked for the import of this number, and the thread that gets it."""
        unit = self.imports[number].unit
        before = sum(1 for package in self.imports[:number] if package.unit == unit)
        for launch in self.launches:
            if (
                launch.unit == unit
                and launch.kind
                and launch.first_import <= before < launch.first_import + launch.threads
            ):
                return launch, before - launch.first_import
        raise FollowError(
            f"no thread has been launched for the intersection that comes in cycle {self.imports[number].cycles[0]}"
        )

    def instructions(self, launch, thread):
        """What the thread's warp retires in this launch: (cycle, PC, the lane's mask, result, predicate)."""
        wave, warp, lane = self.wave, thread // self.lanes, thread % self.lanes
        place = launch.unit * self.warps + warp
        runs = [one for one in self.launches if one.unit == launch.unit and one.threads > warp * self.lanes]
        run, found = 0, []
        for cycle in wave.high("retire_valid"):
            if not wave.value("retire_valid", cycle) >> place & 1:
                continue
            pc = wave.value("retire_pc", cycle) >> 16 * place & 0xFFFF
            if runs[run] is launch:
                bit = place * self.lanes + lane
                found.append((
                    cycle, pc, wave.value("retire_mask", cycle) >> bit & 1,
                    wave.value("retire_data", cycle) >> 32 * bit & 0xFFFFFFFF,
                    wave.value("retire_predicate", cycle) >> bit & 1))  # fmt: skip
            if pc in self.exit_pcs:
                run += 1
                if run == len(runs) or runs[run].number > launch.number:
                    break
        return found
