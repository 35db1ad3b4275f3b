# Constraints of compute_unit. The flow sets raypool_clock_ns and raypool_driver before it reads this file.
# Before layout: no wires, an ideal clock.
create_clock -name clk -period $raypool_clock_ns [get_ports clk_i]

# The chip around the unit has registers at its side of every port; a quarter of the cycle is left to it.
set away [expr {0.25 * $raypool_clock_ns}]
set inputs {}
foreach port [all_inputs] {
  if {[get_property $port full_name] ne "clk_i"} { lappend inputs $port }
}
set_input_delay $away -clock clk $inputs
set_output_delay $away -clock clk [all_outputs]
set_driving_cell -lib_cell $raypool_driver $inputs

# Reset is released long before the unit works.
set_case_analysis 1 [get_ports rst_ni]
# Set by the host before a launch and constant while a kernel runs.
set_false_path -from [get_ports {program_length_i* memory_limit_i*}]
# Chosen and read by the host while the unit is idle, when no counter changes.
set_false_path -from [get_ports counter_select_i*]
set_false_path -to [get_ports counter_o*]
# The trace is compared in simulation; no chip connects it.
set_false_path -to [get_ports {retire_* store_trace_* ray_trace_*}]
