# Benches of what every room uses.

# What counts events for the report: narrow, so that it wraps.
raypool_bench(event_counter_test)
raypool_block_models(event_counter_test event_counter "BITS;LOW_BITS;EVENT_BITS;LATE"
  4_2_2_0 6_3_2_0 7_3_1_1 13_12_6_0)
