# The front door. Every target installs what it needs, builds what it needs in the folder BUILD,
# and keeps it. `make help` lists those that one needs first, `make help-all` all.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
MAKEFLAGS += --no-print-directory

empty :=
space := $(empty) $(empty)
ifneq (,$(findstring $(space),$(CURDIR)))
  $(error the checkout's path "$(CURDIR)" contains a space, which Verilator's makefiles cannot handle: move it)
endif

# Variables of `make sim` and their defaults; empty: chosen by raypool.
CONFIG    ?= 8w8c
CUS       ?= 1
SCENE     ?= room
SIZE      ?= 320x320
DEPTH     ?= 3
ENGINE    ?= lockstep
CHIP      ?=
# SET may have it too.
TRAVERSER ?= $(if $(findstring chip.traverser=,$(SET)),,$(if $(CHIP),static,modelled))
SET       ?=
VIEW      ?=
EYE       ?=
LOOK_AT   ?=
CAMERA    ?=
UP        ?=
FOV       ?=
LIGHT     ?=
DETAIL    ?=
OUT       ?=
WAVES     ?= 0
TRACE     ?= 0
# `make fidelity`
LEVELS    ?=
RUNS      ?= 1
# sim with ENGINE=sampled; `make intervals`
ERROR     ?=
SAMPLES   ?= 200
# `make pareto`
MACHINES  ?=
# `make compare`
A         ?=
B         ?=
# `make run`
KERNEL    ?= saxpy
ARGS      ?=
# `make synth` and its relatives; empty: chosen by the flow.
LIBERTY   ?=
CLOCK     ?=
MEMORIES  ?= macros
AGAINST   ?=
RUN       ?=
ROUNDS    ?=
POWER     ?= 0
BREAK     ?= 0
ONLY      ?=
PLAN      ?=
MODULE    ?=
PARAMETERS ?=
# `make cosim`
PROGRAMS  ?= 1000
SEED      ?= 1
COVERAGE  ?=
# `make chip-frames`
FRAMES    ?= 50
# `make traverser-trees`
TREES     ?= 1000
# `make mutants`
MUTANTS   ?= 500
# `make block-mutants`: the modules of the traverser
EACH      ?= 10
MODULES   ?= traverser tree_port triangle_group ray_exit traverser_lane ray_finish quotient_digits root_digits \
  cross_products triangle_view triangle_normal triangle_shares float_shorten ray_setup ray_direction \
  ray_padding triangle_pipe triangle_edges triangle_interval triangle_plane leaf_reader line_offers \
  tree_banks bank_arbiter tree_cache box_pipe box_axis child_order lane_hits lane_stacks
# `make fit`
SLOWER    ?= 1%
AREA      ?= 0
# `make numerics`
GATES     ?= 0
# `make extremes`
MODE      ?= all
# `make numerics-long`, and sim with ENGINE=native or embree
THREADS   ?=
# `make test-long`
SHARE     ?=
# `make quoted`
LONG      ?= 0
UPDATE    ?= 0
PAGES     ?=
FILES     ?=
# `make sweep`
EXPERIMENT ?=
WHERE     ?= here
JOBS      ?=
SCENES    ?=
# `make report`
FROM      ?=
# `make follow`
PIXEL     ?=
RAY       ?=
STATION   ?=
# Recipes read these from the environment, so that a value with spaces or quotes stays one word.
export CONFIG SET CUS SCENE SIZE DEPTH ENGINE CHIP TRAVERSER VIEW CAMERA EYE LOOK_AT UP FOV LIGHT DETAIL OUT WAVES TRACE
export A B KERNEL PROGRAMS SEED FRAMES TREES COVERAGE MUTANTS EACH MODE THREADS
export SLOWER
export PIXEL RAY STATION
export FROM EXPERIMENT WHERE JOBS SCENES LEVELS RUNS ERROR TIME SAMPLES MACHINES
export LIBERTY CLOCK MEMORIES AGAINST RUN ROUNDS ONLY PLAN MODULE PARAMETERS

# Everything that is made goes here; scripts read it from the environment.
BUILD     ?= build
export BUILD
ifneq (,$(findstring $(space),$(BUILD)))
  $(error BUILD=$(BUILD) contains a space, which Verilator's makefiles cannot handle: choose another folder)
endif
RAYPOOL := $(BUILD)/raypool
# One at a time in a folder: a second make waits here.
LOCKED := flock $(BUILD)/.lock
# Benches whose runs of hours are worth an optimised build.
OPTIMISED_BENCHES := mkdir -p $(BUILD)/benches && scripts/configure.sh $(BUILD)/benches ON \
  -DRAYPOOL_BENCHES_OPTIMISED=ON
# Only engines rtl and lockstep need a Verilated device.
WAVES_FLAG := $(if $(filter-out 0,$(WAVES)),--waves)
TRACE_FLAG := $(if $(filter-out 0,$(TRACE)),--trace $(if $(filter 1,$(TRACE)),:,"$$TRACE"))
# An environment may hold a TIME of its own, for time(1).
SAMPLE_FLAGS := $${ERROR:+--error "$$ERROR"} $(if $(findstring command,$(origin TIME)),--time "$$TIME") \
  $(if $(filter sampled,$(ENGINE)),--seed "$$SEED")
SET_FIELDS := $${SET:+--set "$$SET"}
# A chip in Verilog has its traverser inside, or not: of a frame TRAVERSER says so, of a chip SET, if it does.
INSIDE := $(if $(CHIP),$${TRAVERSER:+--set "chip.traverser=$$TRAVERSER"})
UNIT := scripts/unit.sh "$$CONFIG" $(SET_FIELDS) $(WAVES_FLAG)
# After an equals sign a number may be negative.
LOOK := $${CAMERA:+"--camera=$$CAMERA"} $${EYE:+"--eye=$$EYE"} $${LOOK_AT:+"--look-at=$$LOOK_AT"} $${UP:+"--up=$$UP"} \
  $${FOV:+"--fov=$$FOV"} $${LIGHT:+"--light=$$LIGHT"}
# The frame that is drawn, whatever draws it.
FRAME := --scene "$$SCENE" --config "$$CONFIG" --units "$$CUS" --size "$$SIZE" --depth "$$DEPTH" $(SET_FIELDS) \
  $${TRAVERSER:+--traverser "$$TRAVERSER"} $${VIEW:+--view "$$VIEW"} $(LOOK) $${DETAIL:+--detail "$$DETAIL"}
# The synthesis flow; paths may be relative to this folder.
SYNTH := PYTHONPATH=scripts python3 -m synth
SYNTH_OPTIONS := --config "$$CONFIG" $(SET_FIELDS) --memories "$$MEMORIES" $${LIBERTY:+--liberty "$$LIBERTY"} \
  $${CLOCK:+--clock "$$CLOCK"}
# Of synth, synth-replay and synth-prove.
SYNTH_CHIP := $(if $(filter-out 0,$(CHIP)),--chip --units "$$CUS")
SWEEP := RAYPOOL="$(abspath $(RAYPOOL))" PYTHONPATH=scripts python3 -m sweep
SWEEP_SETUP := setup-sweep $(if $(filter slurm,$(WHERE)),setup-slurm)
# The modules of Debian's packages are those of Debian's Python, whatever stands first in PATH.
PYTHON := $(or $(wildcard /usr/bin/python3),python3)
REPORT := RAYPOOL="$(abspath $(RAYPOOL))" PYTHONPATH=scripts $(PYTHON) -m report
# Its frame is small, whatever the defaults of make sim are: only what the command line says of it counts.
said = $(if $(findstring command,$(origin $1)),$2)
FOLLOW_CONFIG := $(if $(call said,CONFIG,yes),"$$CONFIG",4w4c)
FOLLOW_UNITS := $(if $(call said,CUS,yes),"$$CUS",1)
FOLLOWED := --config $(FOLLOW_CONFIG) --units $(FOLLOW_UNITS) $(call said,SCENE,--scene "$$SCENE") \
  $(call said,SIZE,--size "$$SIZE") $(call said,DEPTH,--depth "$$DEPTH") $${SET:+--set "$$SET"} \
  $${VIEW:+--view "$$VIEW"} $(LOOK) $${DETAIL:+--detail "$$DETAIL"} $${PIXEL:+--pixel "$$PIXEL"}
FOLLOW := RAYPOOL="$(abspath $(RAYPOOL))" PYTHONPATH=scripts python3 -m follow
FIT_SETUP := $(if $(filter-out 0,$(AREA) $(POWER)),setup-synth)
GATES_SETUP := $(if $(filter-out 0,$(GATES)),setup-synth)
UNIT_OF_ENGINE := $(if $(filter rtl lockstep,$(or $(CHIP),$(ENGINE))),$(UNIT) $(INSIDE),true)
CHIP_FLAG := $(if $(CHIP),--chip)

.PHONY: intervals
.PHONY: help help-all sim fidelity fit compare run cosim configurations mutants faults unit test test-long lint format
.PHONY: bench clean
.PHONY: setup-% program configured-%
.PHONY: numerics-long proofs synth synth-replay synth-prove growth numerics significands extremes isa diagrams quoted
.PHONY: package sweep report bench-native pareto boxes triangles synth-module follow tour chip-frames
.PHONY: traverser-trees block-mutants

# Of a target the line that lists it, made of the comment behind it.
LISTED = sed -nE 's/^($1):.*\#\# (.*)/  make \1\t\2/p' $(firstword $(MAKEFILE_LIST)) | expand -t 23

help: ## the targets and variables that one needs first
	@echo 'raypool: a ray-tracing GPU to render on, measure, verify and synthesise'
	@echo
	@$(call LISTED,sim|compare|sweep|report|run|cosim|synth|test)
	@echo
	@echo '  of make sim: SCENE=room|cornell|FILE  SIZE=WxH  DEPTH=N  CONFIG=8w8c|best_8w8c|FILE'
	@echo '               ENGINE=lockstep|rtl|model|native  CHIP=rtl for the whole chip  OUT=FOLDER'
	@echo
	@echo '  make help-all lists every target and variable, docs/commands.md what to do with them'

help-all: ## every target and variable
	@echo 'raypool: a ray-tracing GPU to render on, measure, verify and synthesise'
	@echo
	@$(call LISTED,[a-z-]+)
	@echo
	@echo 'variables of make sim                                                    default'
	@echo '  SCENE=cornell|room|FILE       what is drawn; .obj, .gltf, .glb, .ply      $(SCENE)'
	@echo '  CONFIG=4w4c|8w8c|...|FILE     hardware: configs/*.json, [best_]NwMc, file $(CONFIG)'
	@echo '  ENGINE=native|embree|functional|sampled|model|rtl|lockstep  what stands in for the unit  $(ENGINE)'
	@echo '  CHIP=model|rtl|lockstep       in place of ENGINE: what stands in for the whole chip, rtl/chip.v'
	@echo '  SIZE=WxH                      pixels, 1..16384 each                       $(SIZE)'
	@echo '  DEPTH=N                       1: eye and shadow rays; more: reflections   $(DEPTH)'
	@echo '  CUS=1|2|4                     compute units                               $(CUS)'
	@echo '  SET="FIELD=VALUE ..."         change fields of CONFIG, chip.ray_pool.size=256 (raypool config prints all)'
	@echo '  TRAVERSER=NAME                static, modelled or lanes: its timing; hardware, with CHIP  $(TRAVERSER)'
	@echo '  VIEW=FILE                     camera and light (JSON)                     from the scene'
	@echo '  CAMERA=NAME                   of a glTF file                              its first'
	@echo '  EYE=X,Y,Z LOOK_AT=X,Y,Z UP=X,Y,Z FOV=DEGREES LIGHT=X,Y,Z                  from the view'
	@echo '  DETAIL=N                      triangles of a built-in scene, 0.01..16      1'
	@echo '  OUT=FOLDER                    image.png, report.json                      $(BUILD)/out/...'
	@echo '  WAVES=1                       a waveform (FST) too; ENGINE=rtl, lockstep  $(WAVES)'
	@echo '  TRACE=FROM:CYCLES|pixel:X,Y   what happens then, for Perfetto, Konata and make report;'
	@echo '                                1: 0:20000; ENGINE=model                    $(TRACE)'
	@echo '  THREADS=N                     ENGINE=native, embree, sampled; changes no figure  all cores'
	@echo '  ERROR=N% or TIME=Ns           ENGINE=sampled: what may be afforded        ERROR=2%'
	@echo '  SEED=N                        ENGINE=sampled: of the choice of tiles      $(SEED)'
	@echo 'variables of make fidelity:  those of the frame, from SCENE to DETAIL, and OUT=FOLDER'
	@echo '  LEVELS="native model ...": only these; all if not given  RUNS=N: times that each draws, $(RUNS) if not given'
	@echo 'variables of make intervals:  SAMPLES=N: seeds of each frame, $(SAMPLES) if not given'
	@echo 'variables of make pareto:  those of the frame, OUT=FOLDER  JOBS=N: blocks that are mapped at a time'
	@echo '  MACHINES="24 20-flush 16-newton1-fit ...": only these; what one chooses among if not given'
	@echo 'variables of make bench-native:  SCENE  SIZE  DEPTH  VIEW  DETAIL and those of the camera  THREADS=N'
	@echo 'variables of make boxes, triangles:  SCENE  SIZE  DEPTH  VIEW  DETAIL and those of the camera'
	@echo 'variables of make follow:  PIXEL=X,Y: 20,10 if not given  OUT=FOLDER  those of the frame, and if not given:'
	@echo '    SCENE=examples/tour.obj with its view, CONFIG=4w4c, SIZE=32x24, DEPTH=2, CUS=1'
	@echo '  RAY="eye shadow1 ...", STATION="launch instructions kernel export pool traverser tree import frame host":'
	@echo '    show only these'
	@echo 'variables of make fit:  those of the frame, and OUT=FILE for the configuration'
	@echo '  SLOWER=N%: $(SLOWER) if not given  AREA=1: what each change saves in area'
	@echo '  POWER=1: area, and timing and power before and after'
	@echo 'variables of make sweep:  EXPERIMENT=FILE.json  OUT=FOLDER  WHERE=here|slurm  JOBS=N: points at a time'
	@echo '  SCENES=FOLDER:FOLDER: where scenes are that are not part of the project'
	@echo 'variables of make report:  FROM="FOLDER ...": sweeps, runs, synthesis reports or folders of them  OUT=FOLDER'
	@echo 'variables of make synth, synth-replay, synth-prove:  CONFIG  SET  LIBERTY=FILE  CLOCK=NS'
	@echo '    LIBERTY: .lib or .lib.gz, or a name that asks where it is  MEMORIES=macros|flops|FOLDER of Liberty files'
	@echo '  CHIP=1: the whole chip of CUS units, its traverser with SET=chip.traverser=hardware'
	@echo '  make synth:  AGAINST=REPORT  RUN=REPORT_OF_SIM  POWER=1  OUT=FOLDER  ROUNDS=0..8'
	@echo '  synth-module:  MODULE=NAME  PARAMETERS="A=1,B=2 ...": of rtl/, one row for each  LIBERTY  CLOCK  MEMORIES'
	@echo '  synth-replay:  BREAK=N;  synth-prove:  ONLY=BLOCKS;  growth:  PLAN=FILE'
	@echo 'variables of make cosim:  PROGRAMS=$(PROGRAMS)  SEED=$(SEED)  COVERAGE=FILE.json  CONFIG  SET  CUS: one machine'
	@echo 'variables of make chip-frames:  FRAMES=$(FRAMES): of each machine  SEED=$(SEED)'
	@echo '    TRAVERSER=hardware: only the machines that have it inside'
	@echo '  traverser-trees:  TREES=$(TREES): of each machine  SEED=$(SEED): of the first'
	@echo '  block-mutants:  EACH=$(EACH): faults of each module  SEED=$(SEED)  MODULES="box_pipe ...": only these'
	@echo 'variables of make numerics:  GATES=1: synthesise the lanes of every mode first'
	@echo '  significands:  SCENE  CONFIG  SET  DEPTH  VIEW  DETAIL and those of the camera'
	@echo '  extremes:  MODE=all|ieee-exact|...;  numerics-long:  THREADS=N, 1 if not given'
	@echo 'variable of make test-long:  SHARE=1..10: only this tenth of the tests'
	@echo 'variables of make quoted:  LONG=1: those that take long too;  UPDATE=1: write what is printed into the pages'
	@echo '  PAGES="docs/isa.md ...";  FILES=NAME=PATH: a file that quotes need'
	@echo 'variable of every target:  BUILD=FOLDER: for everything that is made, $(BUILD) if not given;'
	@echo '  a checkout that cannot be written needs one'
	@echo 'variables of make run:  KERNEL=saxpy|matmul|FILE.asm  CONFIG  SET  ENGINE  ARGS="--n 1000"'

sim: setup-sim program ## draw a scene on the simulated chip: picture, report, figures
	@$(UNIT_OF_ENGINE) --units "$$CUS" $(CHIP_FLAG)
	@$(RAYPOOL) sim $(FRAME) $(if $(CHIP),--chip "$$CHIP",--engine "$$ENGINE") $${OUT:+--out "$$OUT"} $(WAVES_FLAG) \
	  $(TRACE_FLAG) $${THREADS:+--threads "$$THREADS"} $(SAMPLE_FLAGS)

fidelity: setup-sim setup-fidelity program ## a frame at every level of simulation, speed against error: LEVELS, RUNS
	@scripts/fidelity.py $(FRAME) $${LEVELS:+--levels "$$LEVELS"} --runs "$$RUNS" $${OUT:+--out "$$OUT"}

intervals: setup-sim program ## do the intervals of ENGINE=sampled contain the true values as often as they say? SAMPLES
	@python3 scripts/intervals.py --samples "$$SAMPLES" $${OUT:+--out "$$OUT"}
pareto: setup-sim setup-synth program ## area against picture error: arithmetic modes and fits of a frame: MACHINES
	@scripts/pareto.py $(FRAME) $${MACHINES:+--machines "$$MACHINES"} $${JOBS:+--jobs "$$JOBS"} $${OUT:+--out "$$OUT"}

fit: setup-sim $(FIT_SETUP) program ## what a scene needs of CONFIG: a configuration with only that: SLOWER, AREA, POWER
	@mkdir -p $(BUILD)/out
	@$(RAYPOOL) fit $(FRAME) --slower "$$SLOWER" $${OUT:+--out "$$OUT"} --json $(BUILD)/out/fit.json
	@$(if $(FIT_SETUP),$(SYNTH) fit $(BUILD)/out/fit.json $(if $(filter-out 0,$(POWER)),--power))

compare: setup-sim program ## two runs beside each other: A=FOLDER_OR_REPORT B=...
	@$(RAYPOOL) compare "$$A" "$$B"

run: setup-sim program ## run a compute kernel, check its results, print its cycles
	@$(UNIT_OF_ENGINE)
	@$(RAYPOOL) run "$$KERNEL" --config "$$CONFIG" $(SET_FIELDS) --engine "$$ENGINE" $(ARGS)

# One machine where the call says which; else those of configs/cosim/, which share the programs. What an outer make has
# exported is no call.
ONE_MACHINE := $(filter command $(if $(filter 0,$(MAKELEVEL)),environment),\
  $(foreach name,CONFIG CUS SET,$(firstword $(origin $(name)))))
cosim: setup-sim program ## random programs, hardware against model, on a set of small machines, or CONFIG: PROGRAMS
	@$(if $(ONE_MACHINE),$(UNIT) --units "$$CUS",scripts/cosim_units.sh)
	@$(RAYPOOL) cosim $(if $(ONE_MACHINE),--config "$$CONFIG" $(SET_FIELDS) --units "$$CUS") --programs "$$PROGRAMS" \
	  --seed "$$SEED" $${COVERAGE:+--coverage "$$COVERAGE"}

configurations: setup-sim program ## random programs on machines with every pair of values (hours): PROGRAMS
	@scripts/configurations.sh all "$$PROGRAMS"

chip-frames: setup-sim setup-test configured-ON program ## random frames on tiny chips, RTL against model: FRAMES
	@scripts/build.sh $(BUILD) raypool_chip_frames
	@$(BUILD)/raypool_chip_frames --frames "$$FRAMES" --seed "$$SEED" $(if $(filter hardware,$(TRAVERSER)),--inside)

traverser-trees: setup-sim setup-test ## random trees, and garbage, in the traverser: TREES
	@$(OPTIMISED_BENCHES)
	@scripts/build.sh $(BUILD)/benches traverser_test traverser_large_test
	@for bench in traverser_test traverser_large_test; do \
	  RAYPOOL_TREES="$$TREES" RAYPOOL_SEED="$$SEED" \
	    $(BUILD)/benches/tb/$$bench --gtest_filter='*OfChance*' --gtest_brief=1; \
	done

mutants: setup-sim setup-lint program ## small faults put into the RTL: which does the lockstep notice? MUTANTS
	@scripts/build.sh $(BUILD) raypool_mutants
	@scripts/mutants.sh $(BUILD)/mutants tb/mutants/2w2c.json "$$MUTANTS" 1
	@$(BUILD)/raypool_mutants --unit $(BUILD)/mutants/libraypool_unit.so --list $(BUILD)/mutants/list.txt \
	  --config tb/mutants/2w2c.json --survivors tb/mutants/survivors.json --json $(BUILD)/mutants/outcomes.json

block-mutants: setup-sim setup-test configured-ON ## small faults in each module of the traverser: EACH
	@scripts/build.sh $(BUILD) raypool_block_mutants
	@mkdir -p $(BUILD)/block-mutants
	@python3 scripts/block_mutants.py rtl $(BUILD)/block-mutants/rtl $(BUILD)/block-mutants/list.json "$$EACH" \
	  "$$SEED" $(MODULES:=.v)
	@scripts/configure.sh $(BUILD)/block-mutants/benches ON -DRAYPOOL_BENCHES=pools -DRAYPOOL_BENCHES_OPTIMISED=ON \
	  -DRAYPOOL_RTL=$(abspath $(BUILD))/block-mutants/rtl
	@scripts/build.sh $(BUILD)/block-mutants/benches $$(grep -o '[a-z_]*_test' tb/mutants/benches.json)
	@$(BUILD)/raypool_block_mutants --list $(BUILD)/block-mutants/list.json \
	  --benches $(BUILD)/block-mutants/benches/tb --json $(BUILD)/block-mutants/outcomes.json \
	  $(if $(filter 10:1,$(EACH):$(SEED)),--survivors tb/mutants/traverser_survivors.json) \
	  $(if $(filter file,$(origin MODULES)),,--part)

faults: setup-sim setup-test configured-ON program ## designers' mistakes: what notices each, where its report leads
	@scripts/build.sh $(BUILD) raypool_faults
	@scripts/faults.sh $(BUILD)/faults
	@scripts/configure.sh $(BUILD)/faults/benches ON -DRAYPOOL_BENCHES_OPTIMISED=ON \
	  -DRAYPOOL_RTL=$(abspath $(BUILD))/faults/rtl
	@scripts/build.sh $(BUILD)/faults/benches $$(grep -o '[a-z_]*_test' tb/faults/benches.json)
	@$(BUILD)/raypool_faults $(BUILD)/faults --benches $(BUILD)/faults/benches/tb --json $(BUILD)/faults/outcomes.json

follow: setup-sim setup-follow program ## one pixel through the chip in Verilog, from a waveform: PIXEL, RAY, STATION
	@$(FOLLOW) $(FOLLOWED) $${RAY:+--ray "$$RAY"} $${STATION:+--station "$$STATION"} $${OUT:+--out "$$OUT"}

tour: setup-sim setup-follow program ## write what docs/from-obj-to-pixel.md shows: its pictures, and what it quotes
	@$(FOLLOW) --out $(BUILD)/out/tour | tail -n 2
	@for file in pixel.png time.svg way.svg export.svg node.svg triangle.svg launch.svg import.svg frame.svg; do \
	  cp "$(BUILD)/out/tour/$$file" "docs/images/tour-$$file"; \
	done
	@scripts/quoted_output.py --update docs/from-obj-to-pixel.md

isa: setup-sim program ## write what is derived from the tables of ALU types and instructions
	@$(RAYPOOL) isa --write
	@scripts/core.py $(RAYPOOL)

diagrams: setup-sim setup-test program ## draw docs/images/*.svg: the unit, the chip, and the stages of a run in Icarus
	@PYTHONPATH=scripts python3 -m diagrams $(RAYPOOL) $(BUILD)/diagrams

sweep: setup-sim $(SWEEP_SETUP) program ## all points of EXPERIMENT (docs/sweeps.md)
	@[ -n "$$EXPERIMENT" ] || { echo 'make sweep: say which, EXPERIMENT=configs/experiments/caches.json' >&2; exit 1; }
	@$(SWEEP) "$$EXPERIMENT" --where "$$WHERE" $${OUT:+--out "$$OUT"} $${JOBS:+--jobs "$$JOBS"}

report: setup-sim setup-report program ## sweeps, runs and synthesis reports as one page: FROM, OUT (docs/page.md)
	@$(REPORT) $${FROM:+--from $$FROM} $${OUT:+--out "$$OUT"}

unit: setup-sim program ## Verilate CUS compute units of CONFIG (WAVES=1: with waveforms; CHIP=rtl: the whole chip)
	@scripts/unit.sh "$$CONFIG" $(INSIDE) $(SET_FIELDS) $(WAVES_FLAG) --units "$$CUS" $(CHIP_FLAG)

synth: setup-sim setup-synth program ## area, timing and power of CONFIG from open tools (CHIP=1: of the whole chip)
	@$(SYNTH) report $(SYNTH_OPTIONS) $(SYNTH_CHIP) $${AGAINST:+--against "$$AGAINST"} $${RUN:+--run "$$RUN"} \
	  $${ROUNDS:+--rounds "$$ROUNDS"} $${OUT:+--out "$$OUT"} $(if $(filter-out 0,$(POWER)),--power)

synth-replay: setup-sim setup-synth program ## run the mapped netlist in lockstep; BREAK=1: a broken one must fail
	@$(SYNTH) replay $(SYNTH_OPTIONS) $(SYNTH_CHIP) --break "$(BREAK)"

synth-prove: setup-sim setup-synth program ## prove each mapped block equal to its RTL
	@$(SYNTH) prove $(SYNTH_OPTIONS) $(SYNTH_CHIP) $${ONLY:+--only "$$ONLY"}

synth-module: setup-synth ## area and slack of one module for each of PARAMETERS: MODULE
	@$(SYNTH) module "$$MODULE" $$PARAMETERS --memories "$$MEMORIES" $${LIBERTY:+--liberty "$$LIBERTY"} \
	  $${CLOCK:+--clock "$$CLOCK"}

growth: setup-sim setup-synth program ## area against warps, lanes, ALUs; what each feature costs
	@$(SYNTH) growth $${PLAN:+--plan "$$PLAN"} $${OUT:+--out "$$OUT"}

test: setup-sim setup-test setup-synth configured-ON ## what guards a change
	@scripts/build.sh $(BUILD)
	@ctest --test-dir $(BUILD) --output-on-failure -j "$$(nproc)" -LE long

test-long: setup-sim setup-test setup-synth setup-lint configured-ON program ## the other tests; SHARE=1..10: a tenth
	@[[ "$(SHARE)" =~ ^([1-9]|10)?$$ ]] || \
	  { echo 'make test-long: SHARE is "$(SHARE)": say 1 to 10, or nothing' >&2; exit 1; }
	@ctest --test-dir $(BUILD) --output-on-failure -j "$$(nproc)" \
	  -L $(if $(SHARE),'^share-$(SHARE)$$',long) --no-tests=error

numerics-long: setup-sim setup-test ## arithmetic against its oracles, 10^8 pairs; two hours: THREADS
	@$(OPTIMISED_BENCHES)
	@scripts/build.sh $(BUILD)/benches numerics_long flt_alu_test slw_alu_test slw_alu_large_test brh_alu_test \
	  small_floats_test
	@scripts/numerics_long.sh $(BUILD)/benches "$${THREADS:-1}"

quoted: setup-sim setup-test setup-synth setup-quoted configured-ON ## run what the pages quote: LONG, UPDATE, PAGES
	@scripts/build.sh $(BUILD)
	@scripts/quoted_output.py $(if $(filter-out 0,$(LONG)),--long) $(if $(filter-out 0,$(UPDATE)),--update) \
	  $(foreach file,$(FILES),--file $(file)) $(PAGES)

proofs: setup-lint ## formal proofs of blocks (Yosys, ABC)
	@scripts/proofs.sh

lint: setup-sim setup-lint configured-ON ## Verilog in three tools, C++ layout and checks, scripts
	@scripts/lint.sh

format: setup-lint ## lay out the C++ files as .clang-format says
	@scripts/sources.sh cpp | xargs clang-format -i

bench: setup-sim configured-OFF ## measured rates of the engines on this machine
	@scripts/build.sh $(BUILD) raypool raypool_bench
	@for config in 4w4c 8w8c 16w16c; do scripts/unit.sh "$$config"; done
	@$(BUILD)/raypool_bench

bench-native: setup-sim program ## our intersection beside Embree's on a frame's rays, one thread and all
	@$(RAYPOOL) bench --scene "$$SCENE" --size "$$SIZE" --depth "$$DEPTH" $${VIEW:+--view "$$VIEW"} $(LOOK) \
	  $${DETAIL:+--detail "$$DETAIL"} $${THREADS:+--threads "$$THREADS"}

# For any computer, so not from the build folder of this one.
package: setup-sim setup-package ## Debian packages of program and library, in build/package
	@mkdir -p $(BUILD)/package
	@flock $(BUILD)/package/.lock scripts/package.sh $(BUILD)/package

# The Slw lane does not depend on fma: its newton variants are not synthesised twice.
numerics: setup-sim setup-numerics $(GATES_SETUP) program ## errors of each arithmetic mode, what they do, its cost
	@$(RAYPOOL) errors
	@$(if $(GATES_SETUP),lanes=$(BUILD)/out/lanes; \
	  for config in $$($(RAYPOOL) numerics --config 1w1c --configurations "$$lanes" | grep -v 'newton.-fma'); do \
	    $(SYNTH) report --config "$$config" --memories macros > "$$lanes/synth.txt" || \
	      { cat "$$lanes/synth.txt"; exit 1; }; \
	  done)
	@echo
	@$(RAYPOOL) numerics

significands: setup-sim program ## what floats of 11 to 24 bits do to SCENE's picture, and how few bits nobody sees
	@$(RAYPOOL) significands --scene "$$SCENE" --config "$$CONFIG" $(SET_FIELDS) --depth "$$DEPTH" \
	  $${VIEW:+--view "$$VIEW"} $(LOOK) $${DETAIL:+--detail "$$DETAIL"}

boxes: setup-sim program ## boxes in integers of 16 to 6 bits: nodes and triangles that a ray of SCENE tests
	@$(RAYPOOL) boxes --scene "$$SCENE" --size "$$SIZE" --depth "$$DEPTH" $${VIEW:+--view "$$VIEW"} $(LOOK) \
	  $${DETAIL:+--detail "$$DETAIL"}

triangles: setup-sim program ## triangle tests of 53 to 24 bits: what they do to SCENE's hits and picture, to seams
	@$(RAYPOOL) triangles --scene "$$SCENE" --size "$$SIZE" --depth "$$DEPTH" $${VIEW:+--view "$$VIEW"} $(LOOK) \
	  $${DETAIL:+--detail "$$DETAIL"}

extremes: setup-sim program ## hard cases in every arithmetic mode, on every engine: MODE
	@for config in $$($(RAYPOOL) numerics --mode "$$MODE" --configurations $(BUILD)/out/modes); do \
	  scripts/unit.sh "$$config"; \
	done
	@$(RAYPOOL) numerics --mode "$$MODE" --extremes

clean: ## remove the build folder (pictures in its out/ too)
	@rm -rf $(BUILD)

setup-%:
	@scripts/setup.sh $*

# Tests are left out until a target needs them; once in, they stay in.
configured-%:
	@mkdir -p $(BUILD) 2> /dev/null && [ -w $(BUILD) ] || \
	  { echo 'make: the build folder "$(BUILD)" cannot be written: choose another one with BUILD=/path/elsewhere' >&2; \
	    exit 1; }
	@$(LOCKED) scripts/configure.sh $(BUILD) $*

program: configured-OFF
	@[ -x $(RAYPOOL) ] || echo 'building raypool; the first time this takes some minutes'
	@scripts/build.sh $(BUILD) raypool
