# Benches of the chip: pools, ports, policies, controller and order of tiles.
raypool_bench(ray_pool_test)
raypool_block_models(ray_pool_test ray_pool "SIZE;OVERHEAD;CYCLES_PER_BEAT;PIPELINED;CULLING"
  1_1_1_0_0 1_2_1_1_0 2_1_1_1_1 7_2_1_0_1 5_9_3_1_1 16_3_2_0_1 3_64_64_1_0 512_2_1_0_0 512_2_1_1_1)

raypool_bench(intersection_pool_test)
raypool_block_models(intersection_pool_test intersection_pool
  "SIZE;INTERSECTION_WORDS;OVERHEAD;CYCLES_PER_BEAT;PIPELINED;CULLING;SHADOWS"
  1_21_1_1_0_0_1 1_21_2_1_1_1_1 2_16_1_1_1_0_0 3_12_9_2_0_1_1 3_21_64_64_1_0_1 5_21_9_1_1_1_0 7_18_3_3_1_0_1
  512_21_2_1_0_0_1 512_16_2_1_1_1_0)

# What the controller decides with.
raypool_bench(policies_test)
raypool_block_models(policies_test thesis_policy
  "CONTENTS;UNITS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;RAY_THRESHOLD;INTERSECTION_THRESHOLD"
  1_1_1_1_48_8 4_2_7_5_48_8 64_1_512_512_48_8 64_4_512_512_7_3 128_2_40_16_48_8 1024_4_512_512_48_8)
raypool_block_models(policies_test fill_policy "CONTENTS;UNITS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;BATCH"
  1_1_1_1_1 4_2_7_5_3 64_1_512_512_64 64_4_512_512_128 128_2_40_16_600 1024_4_512_512_64)
raypool_block_models(policies_test launch_rules
  "CONTENTS;UNITS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;HELD_LIMIT;WINDOW_REMEDY;TRAVERSER_SHADES"
  1_1_1_1_1_1_0 4_2_7_5_3_0_0 64_1_512_512_512_1_1 64_4_512_512_100_0_0)

# The order of the tiles.
raypool_bench(tile_walk_test)
raypool_block_models(tile_walk_test tile_walk "CONTENTS;HELD_LIMIT;TILE_ORDER"
  64_512_0 1_1_0 128_40_0 64_512_1 1_1_1 2_512_1 64_8_1 128_40_1 1024_512_1)

# The frame buffer's port has no parameters.
raypool_bench(frame_port_test)
raypool_verilate(frame_port_test SOURCES ${RAYPOOL_RTL}/chip/rp_frame_port.v PREFIX Vframe_port TOP_MODULE rp_frame_port
  VERILATOR_ARGS -O3 --default-language 1364-2005 ${RAYPOOL_RTL_SEARCH})

# The controller around policies, rules and order of the tiles.
raypool_bench(controller_test)
target_link_libraries(controller_test PRIVATE raypool_chip)
raypool_block_models(controller_test controller
  "UNITS;CONTENTS;RAY_POOL_SIZE;INTERSECTION_POOL_SIZE;HELD_LIMIT;WINDOW_REMEDY;LAUNCH_AHEAD;POLICY;RAY_THRESHOLD;\
INTERSECTION_THRESHOLD;BATCH;TRAVERSER_SHADES;CULLING;TILE_ORDER;EXPORT_BITS"
  1_64_512_512_512_1_1_0_48_8_64_0_0_0_16 4_64_512_512_512_1_1_1_48_8_256_1_1_1_8 1_1_1_1_1_1_1_0_48_8_1_0_0_0_8
  2_4_3_9_8_0_1_1_48_8_3_0_1_0_8 4_2_3_9_6_1_0_0_2_1_4_0_0_1_8 2_128_40_16_16_1_1_1_48_8_600_0_1_1_8)

# The memory's port. Without LINES, they are enough for LATENCY.
raypool_bench(memory_port_test)
raypool_block_models(memory_port_test memory_port "QUEUE;TRAVERSER_QUEUE;CYCLES_PER_BEAT;LATENCY"
  8_32_2_120 1_1_1_6 3_2_3_12 5_3_64_195 2_64_2_1000 8_8_1_50)
raypool_block_models(memory_port_test memory_port "QUEUE;TRAVERSER_QUEUE;CYCLES_PER_BEAT;LATENCY;LINES"
  4_4_1_120_1 2_5_3_40_2 64_3_2_120_5)
