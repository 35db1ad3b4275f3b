# Constraints of compute_unit, beside those of any module (module.sdc): the chip around it has registers at its side of
# every port.

# Reset is released long before the unit works.
set_case_analysis 1 [get_ports rst_ni]
# Set by the host before a launch and constant while a kernel runs.
set_false_path -from [get_ports {program_length_i* memory_limit_i*}]
# Chosen and read by the host while the unit is idle, when no counter changes.
set_false_path -from [get_ports counter_select_i*]
set_false_path -to [get_ports counter_o*]
# The trace is compared in simulation; no chip connects it.
set_false_path -to [get_ports {retire_* store_trace_* ray_trace_*}]
