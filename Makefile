# The front door. Every target installs what it needs, builds what it needs in the folder BUILD,
# and keeps it. `make help` lists those that one needs first, `make help-all` all.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
MAKEFLAGS += --no-print-directory

# Targets of the machine stand here, those of its studies there.
STUDIES := studies/studies.mk
empty :=
space := $(empty) $(empty)
ifneq (,$(findstring $(space),$(CURDIR)))
  $(error the checkout's path "$(CURDIR)" contains a space, which Verilator's makefiles cannot handle: move it)
endif

# `make help-all` prints each comment that begins with `#:`, and the default that stands below it. What has no default
# here is chosen by the program.
#: variables of make sim: the frame, and what draws it                      default
#:   SCENE=cornell|room|FILE       what is drawn; .obj, .gltf, .glb, .ply
#:   SCENES=FOLDER:FOLDER          where SCENE is looked for too               scenes, examples, examples/scenes
export SCENE ?= room
#:   SIZE=WxH                      pixels, 1..16384 each
export SIZE ?= 200x200
#:   DEPTH=N                       1: eye and shadow rays; more: reflections
export DEPTH ?= 3
#:   SHADERS=FOLDER                GLSL shaders that draw                      the built-in kernels
#:   SPP=N                         SHADERS: frames that add up to the picture  1
#:   CONFIG=4w4c|8w8c|...|FILE     hardware: configs/*.json, [best_]NwMc, file
export CONFIG ?= 8w8c
#:   ENGINE=native|estimate|functional|sampled|model|rtl|lockstep
#:                                 what stands in for the hardware
export ENGINE ?= lockstep
#:   BOUNDARY=unit|chip            ENGINE=rtl, lockstep: what is Verilog       unit
#:   CUS=1|2|4                     compute units
export CUS ?= 1
#:   SET="FIELD=VALUE ..."         change fields of CONFIG, chip.ray_pool.size=256 (raypool config prints all)
#:   TRAVERSER=static|hardware     of constant speed, or rtl/traverser/rp_traverser.v       as CONFIG says: hardware
#:   VIEW=FILE                     camera and light (JSON)                     from the scene
#:   CAMERA=NAME                   of a glTF file                              its first
#:   EYE=X,Y,Z  LOOK_AT=X,Y,Z  UP=X,Y,Z  FOV=DEGREES  LIGHT=X,Y,Z              from the view
#:   DETAIL=N                      triangles of a built-in scene, 0.01..16     1
#:   OUT=FOLDER                    image.png, report.json                      BUILD/out/...
#:   WAVES=1                       a waveform (FST) too; ENGINE=rtl, lockstep
#:   TRACE=FROM:CYCLES|pixel:X,Y   what happens then, for Perfetto, Konata and make report;
#:                                 1: 0:20000; ENGINE=model
#:   HITS=own|embree               ENGINE=native: the hits to draw with        own
#:   THREADS=N                     ENGINE=native, estimate, sampled            all cores
#:   ERROR=N%  or  WITHIN=Ns       chooses an engine by what may be afforded, or is of ENGINE=sampled
#:   SEED=N                        of what is random: ENGINE=sampled, cosim ...
export SEED ?= 1
# Recipes read values from the environment. Not so ARGS: make writes them into the recipe, and no make inside has them.
unexport ARGS
# Those of NAMES that the command line has.
said = $(foreach name,$1,$(if $(findstring command,$(origin $(name))),$(name)))
# These leave the engine to the program.
ifneq (,$(and $(strip $(call said,ERROR WITHIN)),$(filter file,$(origin ENGINE))))
  ENGINE :=
endif

# What is mistyped must not be ignored. What an outer make hands on is not looked at; tools have variables of their own.
TOOLS := CC CXX CFLAGS CXXFLAGS LDFLAGS VERILATOR CCACHE_% CMAKE_% RAYPOOL_%
given := $(if $(filter 0,$(MAKELEVEL)),$(filter-out $(TOOLS),$(call said,$(.VARIABLES))))
known := $(if $(given),$(shell grep -hoE '(^|  |export )[A-Z_]+ *[:?+]?=' Makefile $(STUDIES) | \
  sed -E 's/export//; s/[^A-Z_]//g'))
unknown := $(firstword $(filter-out $(known),$(given)))
# nearest WORD,WORDS: a question for the one that is like it.
nearest = $(patsubst %,: did you mean %?,$(shell python3 -c \
  'import difflib, sys; print(*difflib.get_close_matches(sys.argv[1], sys.argv[2:], 1))' "$1" $2))
LIST := (make help-all lists all)
ifneq (,$(unknown))
  $(error $(unknown) is not a variable of this Makefile$(call \
    nearest,$(shell tr a-z- A-Z_ <<< '$(unknown)'),$(known)) $(LIST))
endif
# So is a target, and so is what a target does not look at, where that would be another result.
.DEFAULT:
	@$(error there is no target $@$(call nearest,$@,$(shell sed -nE 's/^([a-z-]+):.*/\1/p' Makefile $(STUDIES))) $(LIST))

#: variables of every target
#:   ARGS="--option ..."           further options of what the target runs, as they are written
#:   BUILD=FOLDER                  for everything that is made; a checkout
#:                                 that cannot be written needs one
export BUILD ?= build
ifneq (,$(findstring $(space),$(BUILD)))
  $(error BUILD=$(BUILD) contains a space, which Verilator's makefiles cannot handle: choose another folder)
endif
RAYPOOL := $(BUILD)/raypool
# Benches with runs of hours, which are worth an optimised build.
OPTIMISED_BENCHES := mkdir -p $(BUILD)/benches && scripts/configure.sh $(BUILD)/benches ON \
  -DRAYPOOL_BENCHES_OPTIMISED=ON
# Where nothing is built yet, make sim compiles only what draws. The engines estimate and sampled are studies, and
# without an engine it may be one of these.
DRAWS := $(if $(or $(wildcard $(RAYPOOL)),$(filter estimate sampled,$(or $(ENGINE),estimate))),raypool,raypool-sim)
# built PROGRAM,WORDS: builds it, and prints WORDS where it is not there yet.
built = @[ -x $(BUILD)/$1 ] || echo 'building $2'; scripts/build.sh $(BUILD) $1
# options NAMES: of each variable that is set the option, --look-at for LOOK_AT, --units for CUS, --samples for SPP. A
# value stays one word, and behind the equals sign it may begin with a minus.
options = $(shell for name in $1; do option=$${name/CUS/units} option=$${option/SPP/samples} option=$${option,,}; \
  printf '$${%s:+"--%s=$$%s"} ' $$name $${option//_/-} $$name; done)
# What is seen of a scene; the frame that is drawn, whatever draws it.
LOOK := VIEW CAMERA EYE LOOK_AT UP FOV LIGHT DETAIL
FRAME := SCENE CONFIG CUS SIZE DEPTH SET TRAVERSER $(LOOK)
WAVES_FLAG := $(if $(filter-out 0,$(WAVES)),--waves)
TRACE_FLAG := $(if $(filter-out 0,$(TRACE)),--trace $(if $(filter 1,$(TRACE)),:,"$$TRACE"))
POWER_FLAG := $(if $(filter-out 0,$(POWER)),--power)
# Only engines rtl and lockstep need a Verilated device.
UNIT = scripts/unit.sh "$$CONFIG" $(call options,SET) $(WAVES_FLAG)
UNIT_OF_ENGINE = $(if $(filter rtl lockstep,$(ENGINE)),$(UNIT),true)
# That of a frame may be the chip, with its traverser inside or not.
OF_FRAME = $(call options,CUS BOUNDARY) $${TRAVERSER:+--set "chip.traverser=$$TRAVERSER"}
# The modules of Debian's packages are those of Debian's Python, whatever stands first in PATH.
PYTHON := $(or $(wildcard /usr/bin/python3),python3)
# The synthesis flow; paths may be relative to this folder.
SYNTH := PYTHONPATH=scripts $(PYTHON) -m synth
LIBRARY := MEMORIES LIBERTY CLOCK
# Of synth, synth-replay and synth-prove.
SYNTH_CHIP = $(if $(filter-out 0,$(CHIP)),--chip $(call options,CUS),$(if $(call said,CUS),\
  $(error CUS is for whole chips: make $@ CHIP=1 CUS=$(CUS), or leave it out, for a unit)))
FOLLOW := RAYPOOL="$(abspath $(RAYPOOL))" PYTHONPATH=scripts python3 -m follow

.PHONY: help help-all sim compare run cosim configurations faults unit test test-long lint format
.PHONY: bench clean
.PHONY: setup-% program configured-%
.PHONY: numerics-long proofs synth synth-replay synth-prove growth areas isa diagrams quoted docs
.PHONY: package bench-native synth-module follow tour chip-frames
.PHONY: traverser-trees

# Of targets of a file the lines that list them, made of the comments behind them.
LISTED = sed -nE 's/^($1):.*\#\# (.*)/  make \1\t\2/p' $2 | expand -t 23

help: ## the targets and variables that one needs first
	@echo 'raypool: a ray-tracing GPU to render on, measure, verify and synthesise'
	@$(call LISTED,sim|compare|run|cosim|synth|test,Makefile)
	@echo 'studies of the machine'
	@$(call LISTED,fit|sweep|report,$(STUDIES))
	@echo
	@sed -nE '/^#: .*make sim/,/^$$/ s/^#:   ((SCENE|CONFIG|ENGINE|BOUNDARY|SIZE|DEPTH|OUT)=[^ ]*).*/\1/p' Makefile | \
	  paste -sd ' ' | fold -sw 96 | sed '1s/^/  of make sim: /; 2,$$s/^/               /; s/ $$//'
	@echo '  make help-all lists every target and variable, docs/use/commands.md what to do with them'

help-all: ## every target and variable
	@echo 'raypool: a ray-tracing GPU to render on, measure, verify and synthesise'
	@echo
	@echo 'the machine: simulate, verify and synthesise it'
	@$(call LISTED,[a-z-]+,Makefile)
	@echo
	@echo 'studies of the machine'
	@$(call LISTED,[a-z-]+,$(STUDIES))
	@echo
	@awk 'line && /^export /  { line = sprintf("%-75s ", line) $$4 } line { print line; line = "" } \
	  /^#: / { line = substr($$0, 4) }' Makefile $(STUDIES)

# What cannot be right is refused before anything is installed or built for it.
WITH_FRAME := sim fidelity pareto fit
WITH_CONFIG := run cosim unit synth synth-replay synth-prove
checked-%:
	@scripts/check_values.sh $* $(if $(filter $*,$(WITH_CONFIG)),CONFIG)

sim: checked-sim setup-sim configured-OFF ## draw a scene on the simulated chip: picture, report, figures
	$(call built,$(DRAWS),what draws; the first time this takes about two minutes)
	@RAYPOOL=$(BUILD)/$(DRAWS) $(UNIT_OF_ENGINE) $(OF_FRAME)
	@$(BUILD)/$(DRAWS) sim $(call options,$(FRAME) SHADERS SPP ENGINE BOUNDARY HITS OUT THREADS \
	  $(call said,ERROR WITHIN) $(if $(filter sampled,$(ENGINE)),SEED)) $(WAVES_FLAG) $(TRACE_FLAG) $(ARGS)

#: variables of make compare:  A=FOLDER|REPORT  B=FOLDER|REPORT
compare: setup-sim program ## two runs beside each other: A=FOLDER_OR_REPORT B=...
	@$(RAYPOOL) compare "$${A-}" "$${B-}" $(ARGS)

#: variables of make run: CONFIG, SET, ENGINE
#:   KERNEL=saxpy|matmul|FILE.asm  with ARGS="--n 1000", or what a file needs
export KERNEL ?= saxpy
run: checked-run setup-sim program ## run a compute kernel, check its results, print its cycles
	@$(UNIT_OF_ENGINE)
	@$(RAYPOOL) run "$$KERNEL" $(call options,CONFIG SET ENGINE) $(ARGS)

#: variables of make cosim, with which CONFIG, SET or CUS mean one machine
#:   PROGRAMS=N                    of all; make configurations: of each machine
export PROGRAMS ?= 1000
#:   COVERAGE=FILE.json            what was covered
# One machine where the call names it; else those of configs/cosim/, which share the programs. What an outer make has
# exported is no call.
ONE_MACHINE := $(filter command $(if $(filter 0,$(MAKELEVEL)),environment),\
  $(foreach name,CONFIG CUS SET,$(firstword $(origin $(name)))))
cosim: checked-cosim setup-sim program ## random programs, hardware against model, on a set of small machines, or CONFIG
	@$(if $(ONE_MACHINE),$(UNIT) $(call options,CUS),scripts/cosim_units.sh)
	@$(RAYPOOL) cosim $(call options,$(if $(ONE_MACHINE),CONFIG SET CUS) PROGRAMS SEED COVERAGE) $(ARGS)

configurations: setup-sim program ## random programs on machines with every pair of values (hours)
	@scripts/configurations.sh all "$$PROGRAMS" $(ARGS)

#: variables of make chip-frames: TRAVERSER=hardware for the machines that have it inside
#:   FRAMES=N                      of each machine
export FRAMES ?= 50
chip-frames: setup-sim setup-test configured-ON program ## random frames on tiny chips, RTL against model
	@scripts/build.sh $(BUILD) raypool_chip_frames
	@$(BUILD)/raypool_chip_frames $(call options,FRAMES SEED) $(if $(filter hardware,$(TRAVERSER)),--inside) $(ARGS)

#: variables of make traverser-trees
#:   TREES=N                       of each machine, from that of SEED
export TREES ?= 1000
traverser-trees: setup-sim setup-test ## random trees, and garbage, in the traverser
	@$(OPTIMISED_BENCHES)
	@scripts/build.sh $(BUILD)/benches traverser_test traverser_large_test
	@for bench in traverser_test traverser_large_test; do \
	  RAYPOOL_TREES="$$TREES" RAYPOOL_SEED="$$SEED" \
	    $(BUILD)/benches/tb/$$bench --gtest_filter='*.Random*' --gtest_brief=1 $(ARGS); \
	done

#: variables of make faults
#:   SOURCE=catalogue|units|frames|mutants|blocks
#:                                 seeded bugs (3 ways), or mutants (2)
export SOURCE ?= catalogue
#:   COUNT=N                       mutants: of all; blocks: of each module     500; 10
#:   MODULES="box_pipe ..."        mutants, blocks: in these only
#:   MACHINES=2w2c,4w2c_few,...    only these, frames: by number; mutants: CONFIG=FILE
#:                                 ARGS="--every 40", "--only 16 21", "--resume", ...
faults: setup-sim setup-test configured-ON program ## faults in the Verilog: what detects each, where its report leads
	@scripts/build.sh $(BUILD) raypool_faults
	@PYTHONPATH=scripts python3 -m faults $(SOURCE) $(BUILD)/faults $(call options,COUNT SEED MODULES MACHINES) \
	  $(call options,$(call said,CONFIG))
	@$(BUILD)/raypool_faults $(SOURCE) $(BUILD)/faults $(call options,MACHINES $(call said,FRAMES)) $(ARGS)

# Its frame is small, whatever the defaults of make sim are: only what is set on the command line counts.
#: variables of make follow: those of the frame; without them SCENE is examples/tour.obj with its view, CONFIG 4w4c,
#:     SIZE 32x24, DEPTH 2
#:   PIXEL=X,Y                     from 0, y downwards                         20,10
#:   RAY="eye shadow1 ..."         show only these
#:   STATION="launch ..."          only these: instructions kernel export pool traverser tree import frame host
#:   OUT=FOLDER
follow: setup-sim setup-follow program ## one pixel through the chip in Verilog, from a waveform
	@$(FOLLOW) $(call options,$(call said,SCENE CONFIG CUS SIZE DEPTH) SET $(LOOK) PIXEL RAY STATION OUT) $(ARGS)

tour: setup-sim setup-follow program ## write the pictures and quotes of the tour, docs/start/from-*.md
	@$(FOLLOW) --out $(BUILD)/out/tour | tail -n 2
	@for file in pixel.png time.svg way.svg export.svg node.svg triangle.svg launch.svg import.svg frame.svg; do \
	  cp "$(BUILD)/out/tour/$$file" "docs/images/tour-$$file"; \
	done
	@scripts/quoted_output.py --update docs/start/from-*-to-*.md

# A program of the tables alone: a row that is wrong is reported before all that includes the tables is compiled.
isa: setup-sim configured-OFF ## write what is derived from the tables of instructions and parameters
	$(call built,raypool-tables,raypool-tables; the first time this takes about half a minute)
	@$(BUILD)/raypool-tables --write
	@scripts/core.py $(BUILD)/raypool-tables

diagrams: setup-sim setup-test program ## draw docs/images/*.svg: the unit, the chip, and the stages of a run in Icarus
	@PYTHONPATH=scripts python3 -m diagrams $(RAYPOOL) $(BUILD)/diagrams

unit: checked-unit setup-sim program ## Verilate CUS units of CONFIG (WAVES=1: with waveforms; BOUNDARY=chip: a chip)
	@$(UNIT) $(OF_FRAME) $(ARGS)

#: variables of make synth, synth-replay and synth-prove: CONFIG, SET
#:   CHIP=1                        the whole chip of CUS units; SET=chip.traverser=static: no traverser inside
#:   LIBERTY=FILE                  .lib or .lib.gz, or a name that asks where it is
#:   CLOCK=NS                      LIBERTY and CLOCK                           those of constraints/
#:   MEMORIES=macros|flops|FOLDER  a folder has Liberty files                  macros
#: variables of make synth:  AGAINST=REPORT  RUN=REPORT_OF_SIM  POWER=1  OUT=FOLDER  ROUNDS=0..8
synth: checked-synth setup-sim setup-synth program ## area, timing and power of CONFIG from open tools (CHIP=1: a chip)
	@$(SYNTH) report $(call options,CONFIG SET $(LIBRARY) AGAINST RUN ROUNDS OUT) $(SYNTH_CHIP) $(POWER_FLAG) $(ARGS)

#: variable of make synth-replay:  BREAK=N: the cell that is swapped
synth-replay: checked-synth-replay setup-sim setup-synth program ## run the netlist in lockstep; BREAK=1: broken
	@$(SYNTH) replay $(call options,CONFIG SET $(LIBRARY) BREAK) $(SYNTH_CHIP) $(ARGS)

#: variable of make synth-prove:  ONLY=BLOCK,BLOCK
synth-prove: checked-synth-prove setup-sim setup-synth program ## prove each mapped block equal to its RTL
	@$(SYNTH) prove $(call options,CONFIG SET $(LIBRARY) ONLY) $(SYNTH_CHIP) $(ARGS)

#: variables of make synth-module: LIBERTY, CLOCK, MEMORIES
#:   MODULE=NAME                   of rtl/
#:   PARAMETERS="A=1,B=2 ..."      one row for each
synth-module: setup-synth ## area and slack of one module for each of PARAMETERS
	@$(SYNTH) module "$${MODULE-}" $${PARAMETERS-} $(call options,$(LIBRARY)) $(ARGS)

#: variables of make growth:  PLAN=FILE  OUT=FOLDER
growth: setup-sim setup-synth program ## area against warps, lanes, ALUs; what each feature costs
	@$(SYNTH) growth $(call options,PLAN OUT) $(ARGS)

#: variable of make areas:  ARGS=--check: designs that it was not made from, beside it
areas: setup-sim setup-synth program ## the table of areas that make explore takes, from about ten synthesised designs
	@$(SYNTH) areas $(ARGS)

#: variable of make test:  ONLY=NAME: a test or test program that docs/develop/where.md names, or report_*
test: setup-sim setup-test setup-synth configured-ON ## what guards a change; ONLY=NAME: one test of it
	@$(if $(ONLY),scripts/one_test.py $(BUILD) "$$ONLY",scripts/build.sh $(BUILD); \
	  ctest --test-dir $(BUILD) --output-on-failure -j "$$(nproc)" -LE '^long-')

#: variable of make test-long:  SHARE=1..10: only this tenth of the tests
test-long: setup-sim setup-test setup-synth setup-lint configured-ON ## the other tests; SHARE=1..10: a tenth
	@[[ "$(SHARE)" =~ ^([1-9]|10)?$$ ]] || \
	  { echo 'make test-long: SHARE is "$(SHARE)": give 1 to 10, or nothing' >&2; exit 1; }
	@scripts/build.sh $(BUILD)
	@ctest --test-dir $(BUILD) --output-on-failure -j "$$(nproc)" \
	  -L '^long-$(or $(SHARE),.*)$$' --no-tests=error

#: variable of make numerics-long:  THREADS=N: 1 if not given
numerics-long: setup-sim setup-test ## arithmetic against its oracles, 10^8 pairs; two hours
	@$(OPTIMISED_BENCHES)
	@scripts/build.sh $(BUILD)/benches numerics_long flt_alu_test flt_alu_large_test slw_alu_test \
	  slw_alu_large_test brh_alu_test small_floats_test
	@scripts/numerics_long.sh $(BUILD)/benches "$${THREADS:-1}"

#: of make quoted:  ARGS="--long --update docs/machine/isa.md": what takes long too; write it into the pages; only these
quoted: setup-sim setup-test setup-synth configured-ON ## run what the pages quote
	@scripts/build.sh $(BUILD) all raypool_chip_frames
	@scripts/quoted_output.py $(ARGS)

docs: setup-docs ## the pages as a site that works from disk: build/docs/index.html
	@scripts/docs.sh $(BUILD)/docs

proofs: setup-lint ## formal proofs of blocks (Yosys, ABC)
	@scripts/proofs.sh

lint: setup-sim setup-lint configured-ON ## Verilog in three tools, C++ layout and checks, scripts
	@scripts/lint.sh

format: setup-lint ## lay out the C++ files by .clang-format
	@scripts/sources.sh cpp | xargs clang-format -i

bench: setup-sim configured-OFF ## measured rates of the engines on this machine
	@scripts/build.sh $(BUILD) raypool raypool_bench
	@for config in 4w4c 8w8c 16w16c; do scripts/unit.sh "$$config"; done
	@$(BUILD)/raypool_bench $(ARGS)

#: variables of make bench-native: SCENE, SIZE, DEPTH, and from VIEW to DETAIL, THREADS
bench-native: setup-sim program ## our intersection beside Embree's on a frame's rays, one thread and all
	@$(RAYPOOL) bench $(call options,SCENE SIZE DEPTH $(LOOK) THREADS) $(ARGS)

# For any computer, so not from the build folder of this one.
package: setup-sim setup-package ## Debian packages of program and library, in build/package
	@mkdir -p $(BUILD)/package
	@flock $(BUILD)/package/.lock scripts/package.sh $(BUILD)/package

include $(STUDIES)

clean: ## remove the build folder (pictures in its out/ too)
	@rm -rf $(BUILD)

setup-%:
	@scripts/setup.sh $*

# Tests are left out until a target needs them; once in, they stay in.
configured-%:
	@mkdir -p $(BUILD) 2> /dev/null && [ -w $(BUILD) ] || \
	  { echo 'make: the build folder "$(BUILD)" cannot be written: choose another one with BUILD=/path/elsewhere' >&2; \
	    exit 1; }
	@scripts/configure.sh $(BUILD) $*

program: configured-OFF
	$(call built,raypool,raypool; the first time this takes about three minutes)
