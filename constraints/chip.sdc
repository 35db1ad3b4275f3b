# Constraints of the chip, beside those of any module (module.sdc): its traverser, memory and frame buffer have registers
# at their side of every port.

# Reset is released long before a frame.
set_case_analysis 1 [get_ports rst_ni]
# Set by the host before a frame and constant while it is drawn.
set_false_path -from [get_ports {program_length_i* memory_limit_i* depth_limit_i* reflections_i}]
set_false_path -from [get_ports {eye_pc_i* secondary_pc_i* direct_pc_i* shade_pc_i*}]
set_false_path -from [get_ports {tree_root_i* tree_lower_i* tree_upper_i* triangles_line_i* triangle_lines_i* stacks_line_i*}]
set_false_path -from [get_ports {material_base_i* record_i*}]
# Chosen and read by the host while no frame is drawn, when no counter changes.
set_false_path -from [get_ports {counter_unit_i* counter_select_i*}]
set_false_path -to [get_ports counter_o*]
