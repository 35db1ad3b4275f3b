# Verilated models for the benches of single blocks.
#
# A model is Verilated and compiled when its bench is built: configuring costs nothing, and only the benches that run
# are built. Only tests use these models, so they are compiled for the shortest time of compiler and run together: with
# -O0 the bench of flt_alu compiles 13 s faster and runs more than a minute longer. RAYPOOL_BENCHES_OPTIMISED is for
# runs of hours (make numerics-long, traverser-trees, faults).
option(RAYPOOL_BENCHES_OPTIMISED "optimise the Verilated models of the benches" OFF)
set(raypool_model_flags OPT_FAST=-O1)
if(RAYPOOL_BENCHES_OPTIMISED)
  set(raypool_model_flags OPT_FAST=-O2)
endif()

find_program(VERILATOR verilator)
if(VERILATOR)
  execute_process(COMMAND ${VERILATOR} --getenv VERILATOR_ROOT OUTPUT_VARIABLE VERILATOR_ROOT
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  # What every model needs to run.
  add_library(raypool_verilated STATIC EXCLUDE_FROM_ALL ${VERILATOR_ROOT}/include/verilated.cpp
    ${VERILATOR_ROOT}/include/verilated_threads.cpp)
  target_compile_options(raypool_verilated PRIVATE -w)
  target_include_directories(raypool_verilated SYSTEM PUBLIC ${VERILATOR_ROOT}/include
    ${VERILATOR_ROOT}/include/vltstd)
endif()

# raypool_verilate(BENCH PREFIX CLASS TOP_MODULE MODULE SOURCES FILE...
#                  [VERILATOR_ARGS ARGUMENT...]): the class CLASS, of the header CLASS.h, for the program BENCH.
# The target BENCH_headers makes the headers alone, for clang-tidy.
function(raypool_verilate bench)
  cmake_parse_arguments(MODEL "" "PREFIX;TOP_MODULE" "SOURCES;VERILATOR_ARGS" ${ARGN})
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/models/${bench}/${MODEL_PREFIX})
  set(header ${folder}/${MODEL_PREFIX}.h)
  set(library ${folder}/${MODEL_PREFIX}__ALL.a)
  file(MAKE_DIRECTORY ${folder})
  # Verilator lists what it has read; Ninja takes that as what the model depends on.
  add_custom_command(OUTPUT ${header}
    COMMAND ${CMAKE_SOURCE_DIR}/scripts/model.sh ${folder} ${MODEL_PREFIX} ${VERILATOR} --top-module ${MODEL_TOP_MODULE}
      ${MODEL_VERILATOR_ARGS} ${MODEL_SOURCES}
    DEPENDS ${MODEL_SOURCES} ${CMAKE_SOURCE_DIR}/scripts/model.sh
    DEPFILE ${folder}/${MODEL_PREFIX}.depends
    COMMENT "Verilating ${MODEL_PREFIX}" VERBATIM)
  add_custom_command(OUTPUT ${library}
    COMMAND ${CMAKE_COMMAND} -E env --unset=MAKEFLAGS CCACHE_BASEDIR=${folder} CCACHE_NOHASHDIR=1
      make -s -C ${folder} -f ${MODEL_PREFIX}.mk ${raypool_model_flags} OBJCACHE=$<$<BOOL:${CCACHE}>:${CCACHE}>
      > ${folder}/make.log
    DEPENDS ${header}
    COMMENT "Compiling ${MODEL_PREFIX}" VERBATIM)
  if(NOT TARGET ${bench}_headers)
    add_custom_target(${bench}_headers)
  endif()
  set(model ${bench}_${MODEL_PREFIX})
  add_custom_target(${model}_header DEPENDS ${header})
  add_dependencies(${bench}_headers ${model}_header)
  add_custom_target(${model} DEPENDS ${library})
  add_dependencies(${model} ${model}_header)
  add_dependencies(${bench} ${model})
  target_include_directories(${bench} SYSTEM PRIVATE ${folder})
  target_link_libraries(${bench} PRIVATE ${library} raypool_verilated)
endfunction()

# raypool_block_models(BENCH MODULE PARAMETERS MODEL...): class V<module>_<model>, a model being the parameters' values
# with _ between; a module of rtl/, or of tb/unit/. With SYNTHESIS, as for the benches of the arithmetic:
# the multiplier that hardware has. That is `raypool_multiplier`; without, the simulator multiplies.
set(raypool_multiplier -DSYNTHESIS)
function(raypool_block_models bench module names)
  rtl_file(source ${module})
  set(top rp_${module})
  if(NOT source)
    file(GLOB source ${CMAKE_CURRENT_SOURCE_DIR}/unit/*/${module}.v)
    set(top ${module})
  endif()
  foreach(model IN LISTS ARGN)
    string(REPLACE "_" ";" values ${model})
    set(parameters)
    foreach(name value IN ZIP_LISTS names values)
      list(APPEND parameters -G${name}=${value})
    endforeach()
    raypool_verilate(${bench} SOURCES ${source} PREFIX V${module}_${model} TOP_MODULE ${top}
      VERILATOR_ARGS -O3 --default-language 1364-2005 ${raypool_multiplier} ${RAYPOOL_RTL_SEARCH}
      ${parameters})
  endforeach()
endfunction()
