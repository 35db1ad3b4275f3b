"""Puts faults into a copy of rtl/ and builds what shall detect them, for raypool_faults:

    python3 -m faults catalogue|units|frames|mutants|blocks FOLDER [OPTION]...
    python3 -m faults prove FOLDER NUMBER...

In FOLDER catalogue/, mutants/ or blocks/ gets
    faults.json             the faults, numbered from 1, and whether their survivors are all judged, some, or none
    rtl/                    the Verilog with all of them; the environment variable RAYPOOL_FAULT selects one (none: 0)
    list                    a line for each Verilated machine: name, file of the configuration, units
    NAME/libraypool_unit.so a machine
    benches/                a build folder with benches
    chips/                  Verilated chips of raypool_chip_frames
RAYPOOL names the program (default raypool in the build folder, BUILD). What is up to date is not built again.
`prove` asks whether mutants are equivalent: docs/develop/mutants.md.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

from . import blocks, catalogue, mutants
from .errors import Refused
from .prove import prove

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / os.environ.get("BUILD", "build")
RAYPOOL = pathlib.Path(os.environ.get("RAYPOOL", BUILD / "raypool")).resolve()
SMALL = ROOT / "tb/mutants/2w2c.json"
# Modules of the traverser, which no program reaches.
MODULES = """traverser tree_port triangle_group ray_exit traverser_lane ray_finish quotient_digits root_digits
    cross_products triangle_view triangle_normal triangle_shares float_shorten ray_setup ray_direction ray_padding
    triangle_pipe triangle_edges triangle_interval triangle_plane leaf_reader line_offers tree_banks bank_arbiter
    tree_cache box_pipe box_axis child_order lane_hits lane_stacks""".split()
COUNTS = {"mutants": 500, "blocks": 10}


def run(*command, **kwargs):
    done = subprocess.run([str(word) for word in command], text=True, check=False, cwd=ROOT, **kwargs)
    if done.returncode != 0:
        raise Refused(f"{pathlib.Path(command[0]).name} has failed")
    return done.stdout


def parameters_of(config):
    return run(RAYPOOL, "config", config, "--verilog-parameters", stdout=subprocess.PIPE).split()


def file_of(module):
    return f"rp_{module}.v"


def files_of(rtl):
    """{name: path} of the Verilog below a folder: each name is there once."""
    return {path.name: path for path in rtl.rglob("*") if path.suffix in (".v", ".vh", ".vlt")}


def write_folder(folder, texts):
    """The folder has these files, in the subfolders of rtl/, and no others; what is as it was is left alone, so that
    nothing is built again for it."""
    for path in files_of(folder).values():
        if path.name not in texts:
            path.unlink()
    places = {name: path.parent.relative_to(ROOT / "rtl") for name, path in files_of(ROOT / "rtl").items()}
    for name, text in texts.items():
        path = folder / places[name] / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def put_in(source, folder, options):
    """The faults, in the rtl/ of a tree: verilate.sh builds from the tree that it stands in."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {name: path.read_text() for name, path in files_of(ROOT / "rtl").items()}
    count, judged = options.count or COUNTS.get(source), "all"
    names = [file_of(name) for name in options.modules]
    if source in COUNTS and (count, options.seed) != (COUNTS[source], 1):
        judged = "none"
    if source == "mutants":
        judged = judged if options.config == SMALL and not names else "none"
        faults = mutants.put_in(texts, folder, count, options.seed, names, parameters_of(options.config))
    elif source == "blocks":
        judged = "some" if names and judged == "all" else judged
        faults = blocks.put_in(texts, count, options.seed, names or [file_of(name) for name in MODULES])
    else:
        faults = catalogue.put_in(texts, options.catalogue)
    write_folder(folder / "rtl", texts)
    for link in ("cpp_model", "sim", "scripts"):
        if not (folder / link).is_symlink():
            (folder / link).symlink_to(ROOT / link)
    told = [{key: fault[key] for key in ("number", "file", "bug")} for fault in faults]
    lines = ",\n".join("  " + json.dumps(fault) for fault in told)
    (folder / "faults.json").write_text(f'{{"judged": "{judged}", "faults": [\n{lines}\n]}}\n')
    print(f"{len(faults)} faults in {len({fault['file'] for fault in faults})} modules", flush=True)


def machines_of(source, folder, options):
    """[(name, file of the configuration, units)]"""
    if source == "mutants":
        return [(options.config.stem, options.config, "1")]
    # The small machine of the cosim tests, as one unit and as four, one with all features of `best`, those that the
    # tests configurations_quick_* walk, and the others of `raypool cosim` by the names of their files.
    machines = [("2w2c", SMALL, "1"), ("2w8c-best", ROOT / "tb/mutants/2w8c_best.json", "1"), ("2w2c-4cu", SMALL, "4")]
    made = folder / "configurations"
    run(RAYPOOL, "configurations", "--most", "12", "--out", made, stdout=subprocess.DEVNULL)
    for line in (made / "list").read_text().splitlines():
        file, units = line.split()
        machines.append((pathlib.Path(file).stem, made / file, units))
    for line in run(RAYPOOL, "cosim", "--machines", stdout=subprocess.PIPE).splitlines():
        file, units = line.split()
        if not os.path.samefile(ROOT / file, SMALL):
            machines.append((pathlib.Path(file).stem, ROOT / file, units))
    wanted = options.machines or [name for name, *_ in machines]
    if unknown := [name for name in wanted if name not in [name for name, *_ in machines]]:
        raise Refused(f"there is no machine {unknown[0]}: {', '.join(name for name, *_ in machines)}")
    return [machine for machine in machines if machine[0] in wanted]


def build_machines(source, folder, options):
    machines = machines_of(source, folder, options)
    quick = [] if source == "mutants" else ["--quick"]
    for name, file, units in machines:
        run(folder / "scripts/verilate.sh", folder / name, *quick, f"UNITS={units}", *parameters_of(file),
            env={"JOBS": str(os.cpu_count()), **os.environ})  # fmt: skip
    (folder / "list").write_text("".join(f"{name} {file} {units}\n" for name, file, units in machines))


def build_benches(source, folder, options):
    if source == "frames":  # builds its machines, which may take longer than a bench may
        run("scripts/build.sh", BUILD, "raypool_chip_frames")
        machines = ["--machine", ",".join(options.machines)] if options.machines else []
        run(BUILD / "raypool_chip_frames", "--tree", folder, "--frames", "1", *machines, stdout=subprocess.DEVNULL)
        return
    build = folder / "benches"
    some = ["-DRAYPOOL_BENCHES=traverser"] if source == "blocks" else []
    run("scripts/configure.sh", build, "ON", *some, "-DRAYPOOL_BENCHES_OPTIMISED=ON", f"-DRAYPOOL_RTL={folder}/rtl")
    benches = json.loads((ROOT / "tb/faults/benches.json").read_text())[source]
    run("scripts/build.sh", build, *sorted({bench["bench"] for bench in benches}))


def arguments_of(words):
    parser = argparse.ArgumentParser(prog="python3 -m faults", allow_abbrev=False)
    parser.add_argument("source", choices=["catalogue", "units", "frames", *COUNTS])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, help="of mutants 500, of blocks 10 of each module, if not given")
    parser.add_argument("--seed", type=int, default=1, help="of mutants and blocks")
    parser.add_argument("--modules", type=str.split, default=[], help="put faults into these only")
    parser.add_argument("--config", type=pathlib.Path, default=SMALL, help="of mutants")
    parser.add_argument("--machines", type=lambda text: text.split(","), default=[],
                        help="only these, by name; of frames by number")  # fmt: skip
    parser.add_argument("--catalogue", type=pathlib.Path, default=ROOT / "tb/faults/catalogue.json")
    return parser.parse_args(words)


def main(words):
    if words[:1] == ["prove"]:
        if len(words) < 3:
            raise Refused("usage: python3 -m faults prove FOLDER NUMBER...")
        return 0 if prove(pathlib.Path(words[1]), words[2:]) else 1
    options = arguments_of(words)
    source = options.source
    options.config = options.config.resolve()
    folder = options.folder.resolve() / (source if source in COUNTS else "catalogue")
    put_in(source, folder, options)
    if source in ("catalogue", "units", "mutants"):
        build_machines(source, folder, options)
    if source in ("catalogue", "frames", "blocks"):
        build_benches(source, folder, options)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (Refused, OSError, ValueError, KeyError) as error:
        sys.exit(f"faults: {error}")
