# Random programs, regressions, configurations and the second simulator, as tests.
# docs/develop/verification.md describes what each is for.
set(raypool_program $<TARGET_FILE:raypool>)
set(scripts ${CMAKE_SOURCE_DIR}/scripts)
set(small_config ${CMAKE_SOURCE_DIR}/tb/mutants/2w2c.json)

# A small unit of two warps and two lanes, for what needs many runs.
add_test(NAME verilate_2w2c_small COMMAND ${CMAKE_COMMAND} -E env RAYPOOL=${raypool_program} ${scripts}/unit.sh
  ${small_config})
set_tests_properties(verilate_2w2c_small PROPERTIES FIXTURES_SETUP unit_2w2c_small TIMEOUT 900)
# The machines of `make cosim`, which together have every feature: sim/cosim/machines.cpp lists them.
add_test(NAME verilate_cosim_machines COMMAND ${CMAKE_COMMAND} -E env RAYPOOL=${raypool_program}
  ${scripts}/cosim_units.sh)
set_tests_properties(verilate_cosim_machines PROPERTIES FIXTURES_SETUP units_of_cosim FIXTURES_REQUIRED unit_2w2c_small
  TIMEOUT 900)
# Each of the four runs the programs from the seed on: 75, then those behind them, which makes 250 for each.
add_test(NAME cosim_machines COMMAND raypool cosim --programs 300 --seed 1 --no-minimise --quiet)
add_test(NAME cosim_machines_more COMMAND raypool cosim --programs 700 --seed 76 --no-minimise --quiet)
set_tests_properties(cosim_machines cosim_machines_more PROPERTIES FIXTURES_REQUIRED units_of_cosim TIMEOUT 300)
raypool_long(50 cosim_machines_more)
add_test(NAME cosim_command COMMAND ${scripts}/tests/cosim.sh ${raypool_program} ${CMAKE_BINARY_DIR}/cosim-test)
set_tests_properties(cosim_command PROPERTIES FIXTURES_REQUIRED units_of_cosim TIMEOUT 300)

# Shader sets in lockstep, on that unit and on chips that chip_lockstep_test and chip_traverser_test Verilate too.
foreach(boundary unit chip)
  add_test(NAME shaders_in_lockstep_${boundary} COMMAND ${scripts}/tests/shaders_in_lockstep.sh ${raypool_program}
    ${boundary} ${CMAKE_BINARY_DIR}/test-units)
  add_test(NAME shaders_in_lockstep_${boundary}_large COMMAND ${scripts}/tests/shaders_in_lockstep.sh
    ${raypool_program} ${boundary} ${CMAKE_BINARY_DIR}/test-units large)
  set_tests_properties(shaders_in_lockstep_${boundary} shaders_in_lockstep_${boundary}_large PROPERTIES
    FIXTURES_REQUIRED unit_2w2c_small TIMEOUT 900)
  raypool_long(80 shaders_in_lockstep_${boundary}_large)
endforeach()

# Random sets: the first few, and those that found a bug. 450: no registers for what spilling left, once stores went
# that nothing needs. 612: a condition that nothing defines, kept in a register.
add_test(NAME random_shaders COMMAND ${scripts}/tests/random_shaders.sh ${raypool_program}
  $<TARGET_FILE:raypool_random_set> 0 1 2 3 4 5 6 7 8 9 450 612)
set_tests_properties(random_shaders PROPERTIES FIXTURES_REQUIRED unit_2w2c_small TIMEOUT 900)

# The catalogue of seeded faults fits the Verilog, and a few of them are detected soon; `make faults` runs them all.
add_test(NAME faults_catalogue COMMAND ${scripts}/tests/faults_test.sh ${raypool_program} $<TARGET_FILE:raypool_faults>
  ${CMAKE_BINARY_DIR}/faults-test)
set_tests_properties(faults_catalogue PROPERTIES TIMEOUT 900 FIXTURES_SETUP faulty_2w2c)
# So do generated faults of single blocks; `make faults SOURCE=blocks` runs them.
add_test(NAME block_mutants COMMAND ${scripts}/tests/block_mutants_test.py)
set_tests_properties(block_mutants PROPERTIES TIMEOUT 300)
raypool_long(12 block_mutants)
# A run that meets a difference is repeated with a look inside the RTL: on seeded faults.
add_test(NAME inspected_differences COMMAND ${scripts}/tests/inspect.sh ${raypool_program}
  ${CMAKE_BINARY_DIR}/faults-test)
set_tests_properties(inspected_differences PROPERTIES FIXTURES_REQUIRED faulty_2w2c TIMEOUT 300)

# docs/machine/modules.md names every module of rtl/, and no page names what is not there.
add_test(NAME module_table COMMAND ${scripts}/module_table.py)
# docs/develop/coverage.md lists for each counter of rtl/ the test in which it wraps.
add_test(NAME counter_table COMMAND ${scripts}/counter_table.py)
add_test(NAME pages COMMAND ${scripts}/pages.py)
# Neither the machine nor what verifies it uses a study of it; CMakeLists.txt checks the same of targets.
add_test(NAME layers COMMAND ${scripts}/layers.py)
add_test(NAME layers_refused COMMAND ${scripts}/tests/layers_test.sh)

# clang-tidy on all sources; `make lint` reads those that have changed.
find_program(CLANG_TIDY clang-tidy)
if(CLANG_TIDY)
  foreach(part RANGE 1 ${RAYPOOL_SHARES})
    add_test(NAME tidy_${part} COMMAND ${scripts}/tidy.py ${CMAKE_BINARY_DIR} --share ${part}/${RAYPOOL_SHARES})
    set_tests_properties(tidy_${part} PROPERTIES TIMEOUT 1800)
    raypool_long(200 tidy_${part})
  endforeach()
else()
  message(STATUS "clang-tidy was not found: the tests tidy_* are left out (scripts/setup.sh lint)")
endif()

# Yosys on what is large; `make lint` has it read what is small.
find_program(YOSYS yosys)
if(YOSYS)
  foreach(kind lint_units lint_chip lint_blocks)
    add_test(NAME ${kind} COMMAND ${scripts}/lint.sh ${kind})
    set_tests_properties(${kind} PROPERTIES TIMEOUT 3600)
  endforeach()
  raypool_long(300 lint_units)
  raypool_long(500 lint_chip)
  raypool_long(80 lint_blocks)
endif()

add_test(NAME shares COMMAND ${scripts}/tests/shares_test.py ${CMAKE_BINARY_DIR})
add_test(NAME one_test COMMAND ${scripts}/tests/one_test_test.py ${CMAKE_BINARY_DIR})

# Every program that has once shown a fault.
file(GLOB regressions CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}/tb/regressions
  ${CMAKE_SOURCE_DIR}/tb/regressions/*.json)
foreach(regression IN LISTS regressions)
  add_test(NAME regression_${regression} COMMAND ${scripts}/tests/regression.sh ${raypool_program}
    ${CMAKE_SOURCE_DIR}/tb/regressions/${regression}
                                                 ${CMAKE_BINARY_DIR}/regressions)
  set_tests_properties(regression_${regression} PROPERTIES FIXTURES_REQUIRED unit_2w2c_small TIMEOUT 900)
endforeach()

# These two have machines of their own, which they Verilate.
raypool_long(12 regression_instruction_cache-8w1c_small-seed64.json regression_data_cache-2w2c_small-seed2280.json)

# Every parameter value, and most pairs of values that a machine of 8 threads can have.
foreach(part RANGE 1 4)
  add_test(NAME configurations_quick_${part}
           COMMAND ${CMAKE_COMMAND} -E env RAYPOOL=${raypool_program} ${scripts}/configurations.sh quick 40
           ${CMAKE_BINARY_DIR}/configurations/${part} ${part}/4)
  set_tests_properties(configurations_quick_${part} PROPERTIES TIMEOUT 2400)
  raypool_long(200 configurations_quick_${part})
endforeach()

# The same Verilog in a 4-state simulator.
find_program(IVERILOG iverilog)
if(IVERILOG)
  add_test(NAME icarus_2w2c_small COMMAND ${scripts}/icarus.sh ${raypool_program} ${small_config}
    ${CMAKE_BINARY_DIR}/icarus/2w2c_small 1 2 3 4 5 6 7 8)
  set_tests_properties(icarus_2w2c_small PROPERTIES FIXTURES_REQUIRED unit_2w2c_small TIMEOUT 300)
  raypool_long(30 icarus_2w2c_small)
  add_test(NAME icarus_4w4c COMMAND ${scripts}/icarus.sh ${raypool_program} 4w4c ${CMAKE_BINARY_DIR}/icarus/4w4c 1 3)
  set_tests_properties(icarus_4w4c PROPERTIES FIXTURES_REQUIRED unit_4w4c TIMEOUT 300)
  # The whole chip, without and with the traverser inside.
  set(chip_frames $<TARGET_FILE:raypool_chip_frames>)
  foreach(machine 1 23 26)
    raypool_built_test(icarus_chip_${machine} 90 raypool_chip_frames ${scripts}/icarus_chip.sh ${chip_frames}
      ${CMAKE_BINARY_DIR}/icarus/chip_${machine} ${machine} 2)
  endforeach()
  # The pictures in docs show modules that are there, and the stages that a run has now.
  add_test(NAME diagrams COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${scripts} python3 -m diagrams ${raypool_program}
    ${CMAKE_BINARY_DIR}/diagrams --check)
  set_tests_properties(diagrams PROPERTIES TIMEOUT 60)
  raypool_built_test(icarus_detects_x 100 raypool_chip_frames ${scripts}/tests/icarus_detects.sh ${raypool_program}
    ${chip_frames} ${CMAKE_BINARY_DIR}/icarus/detects)
  set_tests_properties(icarus_detects_x PROPERTIES FIXTURES_REQUIRED unit_2w2c_small)
endif()
