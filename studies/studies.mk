# What is studied with the machine. The Makefile includes it behind its own variables: those of a frame, the program,
# and `options`.
.PHONY: fidelity intervals pareto fit sweep report numerics significands boxes triangles referee convergence models
.PHONY: extremes explore

SWEEP := RAYPOOL="$(abspath $(RAYPOOL))" PYTHONPATH=studies $(PYTHON) -m sweep
SWEEP_SETUP := setup-sweep $(if $(filter slurm,$(WHERE)),setup-slurm)
REPORT := RAYPOOL="$(abspath $(RAYPOOL))" PYTHONPATH=studies:scripts $(PYTHON) -m report
FIT_SETUP := $(if $(filter-out 0,$(AREA) $(POWER)),setup-synth)
GATES_SETUP := $(if $(filter-out 0,$(GATES)),setup-synth)

#: variables of make fidelity: those of the frame, from SCENE to DETAIL; SHADERS, SPP
#:   LEVELS="native model ..."     only these                                  all
#:   RUNS=N                        times that each draws                       1
#:   OUT=FOLDER
fidelity: checked-fidelity setup-sim setup-fidelity program ## a frame at every level of simulation, speed against error
	@$(PYTHON) studies/fidelity.py $(call options,$(FRAME) SHADERS SPP LEVELS RUNS OUT) $(ARGS)

#: of make intervals:  ARGS="--samples 50 --traverser hardware": seeds of each frame, 200 if not given; else static
intervals: setup-sim program ## do the intervals of ENGINE=sampled have the coverage that they claim?
	@python3 studies/intervals.py $(call options,OUT) $(ARGS)

#: variables of make pareto: those of the frame; SHADERS, SPP
#:   MACHINES="24 20-flush ..."    only these                                  what one chooses among
#:   JOBS=N                        blocks that are mapped at a time            all cores
#:   OUT=FOLDER
pareto: checked-pareto setup-sim setup-synth program ## area against picture error: arithmetic modes and fits of a frame
	@$(PYTHON) studies/pareto.py $(call options,$(FRAME) SHADERS SPP MACHINES JOBS OUT) $(ARGS)

#: variables of make fit: those of the frame, and SHADERS
#:   SLOWER=N%                     cycles that the whole may take more         1%
#:   AREA=1                        what each change saves in area
#:   POWER=1                       area, and timing and power before and after
#:   OUT=FILE                      for the configuration
fit: checked-fit setup-sim $(FIT_SETUP) program ## what a scene needs of CONFIG: a configuration with only that
	@mkdir -p $(BUILD)/out
	@$(RAYPOOL) fit $(call options,$(FRAME) SHADERS SLOWER OUT) --json $(BUILD)/out/fit.json $(ARGS)
	@$(if $(FIT_SETUP),$(SYNTH) fit $(BUILD)/out/fit.json $(POWER_FLAG))

#: variables of make explore: SCENE, SIZE, DEPTH, CONFIG, SET, SEED, and from VIEW to DETAIL
#:   MACHINES=N                    at most                                     10000
#:   OUT=FILE                      JSON of all machines; the plot is beside it
#:   ARGS="--vary warps=4,8 --check 100": ARGS=--help lists the options
explore: setup-sim setup-report program ## the fastest machines for their area, of thousands around CONFIG
	@out="$${OUT:-$(BUILD)/out/explore/explore.json}"; mkdir -p "$$(dirname "$$out")"; \
	  $(RAYPOOL) explore $(call options,$(strip $(call said,SCENE SIZE DEPTH CONFIG)) SET SEED MACHINES $(LOOK)) \
	    --out "$$out" $(ARGS) && $(PYTHON) studies/explore_plot.py "$$out"

#: variables of make sweep
#:   EXPERIMENT=FILE.json
#:   WHERE=here|slurm                                                          here
#:   JOBS=N                        points at a time                            all cores; slurm: 100
#:   SCENES=FOLDER:FOLDER          where scenes are that are not part of the project, as of make sim
#:   OUT=FOLDER
sweep: setup-sim $(SWEEP_SETUP) program ## all points of EXPERIMENT (docs/use/sweeps.md)
	@[ -n "$${EXPERIMENT-}" ] || { echo 'make sweep: name one, EXPERIMENT=configs/experiments/caches.json' >&2; exit 1; }
	@$(SWEEP) "$$EXPERIMENT" $(call options,WHERE OUT JOBS) $(ARGS)

#: variables of make report
#:   FROM="FOLDER ..."             sweeps, runs, synthesis reports, or folders of them
#:   OUT=FOLDER
report: setup-sim setup-report program ## sweeps, runs and synthesis reports as one page (docs/use/page.md)
	@$(REPORT) $${FROM:+--from $$FROM} $(call options,OUT) $(ARGS)

#: variables of make numerics:  GATES=1: synthesise the lanes of every mode first;  OUT=FOLDER;  with SHADERS, what each
#:   mode does to that frame: those of the frame, SPP
ifneq (,$(SHADERS))
numerics: setup-sim program
	@$(RAYPOOL) numerics $(call options,SHADERS SPP SCENE SIZE DEPTH CONFIG SET $(LOOK) OUT) $(ARGS)
else
# The Slw lane does not depend on fma: its newton variants are not synthesised twice.
numerics: setup-sim setup-numerics $(GATES_SETUP) program ## errors of each arithmetic mode, what they do, its cost
	@$(RAYPOOL) errors
	@$(if $(GATES_SETUP),lanes=$(BUILD)/out/lanes; \
	  for config in $$($(RAYPOOL) numerics --config 1w1c --configurations "$$lanes" | grep -v 'newton.-fma'); do \
	    $(SYNTH) report --config "$$config" --memories macros > "$$lanes/synth.txt" || \
	      { cat "$$lanes/synth.txt"; exit 1; }; \
	  done)
	@echo
	@$(RAYPOOL) numerics $(call options,OUT) $(ARGS)
	@$(PYTHON) studies/numerics_plots.py "$${OUT:-$(BUILD)/out/numerics}"
endif

#: variables of make estimates:  MACHINES=N: random ones;  SEED=N
estimates: setup-sim program ## how far engine estimate is off, on random machines and frames
	@RAYPOOL=$(RAYPOOL) $(PYTHON) studies/estimates.py $(call options,MACHINES SEED) $(ARGS)

#: variables of make significands: SCENE, CONFIG, SET, DEPTH, and from VIEW to DETAIL
significands: setup-sim program ## what floats of 11 to 24 bits do to SCENE's picture, and how few bits are enough
	@$(RAYPOOL) significands $(call options,SCENE CONFIG SET DEPTH $(LOOK)) $(ARGS)

#: variables of make boxes, triangles: SCENE, SIZE, DEPTH, and from VIEW to DETAIL
boxes: setup-sim program ## boxes in integers of 16 to 6 bits: nodes and triangles that a ray of SCENE tests
	@$(RAYPOOL) boxes $(call options,SCENE SIZE DEPTH $(LOOK)) $(ARGS)

triangles: setup-sim program ## triangle tests of 53 to 24 bits: what they do to SCENE's hits and picture, to seams
	@$(RAYPOOL) triangles $(call options,SCENE SIZE DEPTH $(LOOK)) $(ARGS)

#: variables of make referee
#:   CASES=N                       hard rays                                   1000000
#:   SEED=S                        of these; ARGS="--smallest": the smallest case of each fault
export CASES ?= 1000000
referee: setup-sim setup-test configured-ON ## hits of hard rays beside rational numbers: ours, Embree's, four papers'
	@scripts/build.sh $(BUILD) raypool raypool_match referee_answers
	@mkdir -p $(BUILD)/out/referee
	@$(RAYPOOL) referee $(call options,CASES SEED) --write /dev/stdout | \
	  $(BUILD)/tb/referee_answers > $(BUILD)/out/referee/Verilog.jsonl
	@$(BUILD)/raypool_match $(call options,CASES SEED) --answers $(BUILD)/out/referee/Verilog.jsonl $(ARGS)

#: variables of make convergence
#:   SPP=N                         samples a pixel                             4096
#:   ARGS="--scenes cornell --size 64x64 --depth 3 ...": ARGS=--help lists them
convergence: setup-sim setup-test configured-ON ## pictures of SHADERS=path beside a path tracer in double precision
	@scripts/build.sh $(BUILD) raypool_converge
	@$(BUILD)/raypool_converge $(call options,SPP) $(ARGS)

#: variables of make models: SIZE, DEPTH, THREADS, OUT
#:   SPP=N                         samples a pixel; of Cycles 4 N              64
#:   ARGS="--only crate vase ..."
models: setup-sim setup-models program ## ten glTF models by SHADERS=path beside Blender's Cycles
	@RAYPOOL=$(abspath $(RAYPOOL)) PYTHONPATH=studies $(PYTHON) -m models \
	  $(call options,$(call said,SIZE DEPTH THREADS OUT) SPP) $(ARGS)

EXTREMES = $(RAYPOOL) numerics $(call options,MODE) $(if $(filter chip,$(BOUNDARY)),--config tiny)

#: variables of make extremes
#:   MODE=all|ieee-exact|...       arithmetic                                  all
#:   BOUNDARY=chip                 small chips, whole, in Verilog too
extremes: setup-sim program ## hard cases in every arithmetic mode, on every engine
	@for config in $$($(EXTREMES) --configurations $(BUILD)/out/modes); do scripts/unit.sh "$$config"; done
	@[ "$(BOUNDARY)" != chip ] || for config in $$($(EXTREMES) --boundary chip --configurations $(BUILD)/out/chips); do \
	  scripts/unit.sh "$$config" --boundary chip; done
	@$(EXTREMES) $(call options,BOUNDARY) --extremes $(ARGS)
