# Benches of the chip's pools, ports, policies, order of tiles and box pipe in Verilog, against their classes.
# raypool_pool_models(BENCH MODULE PARAMETERS MODEL...): class V<module>_<model>, a model being the parameters' values
# with _ between; a module of rtl/, or of this folder. With SYNTHESIS, as for the benches of the arithmetic: the
# multiplier that hardware has. That is what `raypool_multiplier` says; without, the simulator multiplies.
set(raypool_multiplier -DSYNTHESIS)
function(raypool_pool_models bench module names)
  set(source ${RAYPOOL_RTL}/${module}.v)
  if(NOT EXISTS ${source})
    set(source ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${module}.v)
  endif()
  foreach(model IN LISTS ARGN)
    string(REPLACE "_" ";" values ${model})
    set(parameters)
    foreach(name value IN ZIP_LISTS names values)
      list(APPEND parameters -G${name}=${value})
    endforeach()
    raypool_verilate(${bench} SOURCES ${source} PREFIX V${module}_${model} TOP_MODULE ${module}
      VERILATOR_ARGS -O3 --default-language 1364-2005 ${raypool_multiplier} -y ${RAYPOOL_RTL} -I${RAYPOOL_RTL}
      ${parameters})
  endforeach()
endfunction()

raypool_bench(ray_pool_test)
raypool_pool_models(ray_pool_test ray_pool "SIZE;OVERHEAD;CYCLES_PER_BEAT;PIPELINED;CULLING"
  1_1_1_0_0 1_2_1_1_0 2_1_1_1_1 7_2_1_0_1 5_9_3_1_1 16_3_2_0_1 3_64_64_1_0 512_2_1_0_0 512_2_1_1_1)

raypool_bench(intersection_pool_test)
raypool_pool_models(intersection_pool_test intersection_pool
  "SIZE;INTERSECTION_WORDS;OVERHEAD;CYCLES_PER_BEAT;PIPELINED;CULLING;SHADOWS"
  1_21_1_1_0_0_1 1_21_2_1_1_1_1 2_16_1_1_1_0_0 3_12_9_2_0_1_1 3_21_64_64_1_0_1 5_21_9_1_1_1_0 7_18_3_3_1_0_1
  512_21_2_1_0_0_1 512_16_2_1_1_1_0)

# The traverser's narrow box test. Its oracle counts in rational numbers.
find_library(GMP_LIBRARY gmp REQUIRED)
raypool_bench(box_pipe_test)
target_link_libraries(box_pipe_test PRIVATE ${GMP_LIBRARY})
raypool_pool_models(box_pipe_test box_pipe "BITS" 6 7 10 12 16)

# The edges of its triangle test, against the same oracle.
raypool_bench(triangle_edges_test)
target_link_libraries(triangle_edges_test PRIVATE ${GMP_LIBRARY})
raypool_verilate(triangle_edges_test SOURCES ${RAYPOOL_RTL}/triangle_edges.v
  PREFIX Vtriangle_edges TOP_MODULE triangle_edges
  VERILATOR_ARGS -O3 --default-language 1364-2005 -DSYNTHESIS -y ${RAYPOOL_RTL} -I${RAYPOOL_RTL})

# The triangle pipe, whose rays are set up as those of a scene are, and apart from it the multiplier that it has.
raypool_bench(triangle_pipe_test)
target_link_libraries(triangle_pipe_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_pool_models(triangle_pipe_test float_products "EXPONENT_BITS;MANTISSA_BITS;SUBNORMALS" 11_31_1)
raypool_pool_models(triangle_pipe_test float_quotient "EXPONENT_BITS;MANTISSA_BITS" 6_5 11_31)
set(raypool_multiplier)
raypool_pool_models(triangle_pipe_test triangle_pipe "BITS" 26 32)
set(raypool_multiplier -DSYNTHESIS)

# The set-up of a ray, against what engines prepare too.
raypool_bench(ray_setup_test)
target_link_libraries(ray_setup_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_pool_models(ray_setup_test ray_setup "BITS" 6 12 16)

# The finish of a ray, and what of it can be tried apart.
raypool_bench(ray_finish_test)
target_sources(ray_finish_test PRIVATE ${CMAKE_CURRENT_LIST_DIR}/ray_finish_parts_test.cpp)
target_link_libraries(ray_finish_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_pool_models(ray_finish_test ray_finish "TAG_BITS" 16)
raypool_pool_models(ray_finish_test cross_products "MANTISSA_BITS" 23 35)
raypool_pool_models(ray_finish_test root_digits "DIGITS" 3 15)

# What the controller decides with.
raypool_bench(policies_test)
raypool_pool_models(policies_test thesis_policy
  "CONTENTS;UNITS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;RAY_THRESHOLD;INTERSECTION_THRESHOLD"
  1_1_1_1_48_8 4_2_7_5_48_8 64_1_512_512_48_8 64_4_512_512_7_3 128_2_40_16_48_8 1024_4_512_512_48_8)
raypool_pool_models(policies_test fill_policy "CONTENTS;UNITS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;BATCH"
  1_1_1_1_1 4_2_7_5_3 64_1_512_512_64 64_4_512_512_128 128_2_40_16_600 1024_4_512_512_64)
raypool_pool_models(policies_test launch_rules
  "CONTENTS;UNITS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;HELD_LIMIT;WINDOW_REMEDY;TRAVERSER_SHADES"
  1_1_1_1_1_1_0 4_2_7_5_3_0_0 64_1_512_512_512_1_1 64_4_512_512_100_0_0)

# The order of the tiles.
raypool_bench(tile_walk_test)
raypool_pool_models(tile_walk_test tile_walk "CONTENTS;HELD_LIMIT;TILE_ORDER"
  64_512_0 1_1_0 128_40_0 64_512_1 1_1_1 2_512_1 64_8_1 128_40_1 1024_512_1)

# The frame buffer's port has no parameters.
raypool_bench(frame_port_test)
raypool_verilate(frame_port_test SOURCES ${RAYPOOL_RTL}/frame_port.v PREFIX Vframe_port TOP_MODULE frame_port
  VERILATOR_ARGS -O3 --default-language 1364-2005 -y ${RAYPOOL_RTL} -I${RAYPOOL_RTL})

# What counts events for the report: narrow, so that it wraps.
raypool_bench(event_counter_test)
raypool_pool_models(event_counter_test event_counter "BITS;LOW_BITS;EVENT_BITS;LATE"
  4_2_2_0 6_3_2_0 7_3_1_1 13_12_6_0)

# The controller around policies, rules and order of the tiles.
raypool_bench(controller_test)
target_link_libraries(controller_test PRIVATE raypool_chip)
raypool_pool_models(controller_test controller
  "UNITS;CONTENTS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;HELD_LIMIT;WINDOW_REMEDY;LAUNCH_AHEAD;POLICY;RAY_THRESHOLD;\
INTERSECTION_THRESHOLD;BATCH;TRAVERSER_SHADES;CULLING;TILE_ORDER;EXPORT_BITS"
  1_64_512_512_512_1_1_0_48_8_64_0_0_0_16 4_64_512_512_512_1_1_1_48_8_256_1_1_1_8 1_1_1_1_1_1_1_0_48_8_1_0_0_0_8
  2_4_3_9_8_0_1_1_48_8_3_0_1_0_8 4_2_3_9_6_1_0_0_2_1_4_0_0_1_8 2_128_40_16_16_1_1_1_48_8_600_0_1_1_8)

# The memory's port. Without LINES, they are enough for LATENCY.
raypool_bench(memory_port_test)
raypool_pool_models(memory_port_test memory_port "QUEUE;TRAVERSER_QUEUE;CYCLES_PER_BEAT;LATENCY"
  8_32_2_120 1_1_1_6 3_2_3_12 5_3_64_195 2_64_2_1000 8_8_1_50)
raypool_pool_models(memory_port_test memory_port "QUEUE;TRAVERSER_QUEUE;CYCLES_PER_BEAT;LATENCY;LINES"
  4_4_1_120_1 2_5_3_40_2 64_3_2_120_5)

# A bank of the traverser's caches.
raypool_bench(tree_cache_test)
raypool_pool_models(tree_cache_test tree_cache "LANES;SLOTS;LINES;WAYS;MSHRS;LINE_BITS;DATA_BITS"
  1_1_4_2_1_5_32 3_5_64_4_5_23_32 8_24_128_16_8_23_32 32_2_16_2_3_9_32)

# Such a cache, of banks, with who is next at each.
raypool_bench(tree_banks_test)
raypool_pool_models(tree_banks_test tree_banks "LANES;SLOTS;LINES;WAYS;MSHRS;BANKS;LINE_BITS;DATA_BITS"
  1_2_4_2_1_1_5_32 3_5_64_4_6_2_23_32 16_3_64_2_12_4_20_32 2_9_256_4_16_16_12_32)
raypool_large_bench(tree_banks 150)
raypool_pool_models(tree_banks_large_test tree_banks "LANES;SLOTS;LINES;WAYS;MSHRS;BANKS;LINE_BITS;DATA_BITS"
  8_24_1024_16_64_8_26_32 32_2_32_2_4_1_9_32)

# The stacks of a lane of the traverser.
raypool_bench(lane_stacks_test)
raypool_pool_models(lane_stacks_test lane_stacks "SLOTS;ENTRIES;KEY_BITS;REFERENCE_BITS;BLOCK_BITS"
  1_8_3_12_7 3_9_21_20_3 5_8_6_10_4 8_12_8_8_7 24_16_32_32_7 33_64_2_9_2)

# A lane of the traverser, with a triangle pipe whose multipliers the simulator has.
raypool_bench(traverser_lane_test)
target_link_libraries(traverser_lane_test PRIVATE raypool_scene)
set(raypool_multiplier)
raypool_pool_models(traverser_lane_test lane_units "SLOTS;ENTRIES;BITS;TRIANGLE_BITS"
  1_8_6_26 3_9_10_30 6_8_16_28 24_16_12_32)

# The whole traverser.
raypool_bench(traverser_test)
target_link_libraries(traverser_test PRIVATE raypool_scene)
set(sizes "LANES;SLOTS;ENTRIES;BITS;TRIANGLE_PIPES;NODE_LINES;NODE_WAYS;NODE_MSHRS;NODE_BANKS;TRIANGLE_LINES;\
TRIANGLE_WAYS;TRIANGLE_MSHRS;TRIANGLE_BANKS;POOL;RECORD_WORDS;SHADING;CULLING")
raypool_pool_models(traverser_test traverser "${sizes}"
  1_1_8_6_1_4_2_1_1_4_2_1_1_1_21_0_0 3_4_9_10_2_16_2_4_2_32_4_6_2_9_16_1_1)
raypool_large_bench(traverser 200)
target_link_libraries(traverser_large_test PRIVATE raypool_scene)
raypool_pool_models(traverser_large_test traverser "${sizes}" 5_24_16_12_1_64_4_16_8_32_2_5_1_160_20_0_1)
set(raypool_multiplier -DSYNTHESIS)
