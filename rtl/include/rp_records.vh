// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/isa/records.hpp by `raypool isa --write`; a test compares. Do not edit.
  // Of each record how many bits it has, and of each of its fields the lowest bit and how many. To be included
  // inside a module body. A module uses some of them only.
  /* verilator lint_off UNUSEDPARAM */

  // what a lane of the traverser gives a triangle pipe: a triangle, and its ray
  localparam integer TEST_BITS = 875;
  localparam integer TEST_CORNERS = 0, TEST_CORNERS_BITS = 288;
  localparam integer TEST_NUMBER = 288, TEST_NUMBER_BITS = 32;
  localparam integer TEST_ORIGIN = 320, TEST_ORIGIN_BITS = 96;
  localparam integer TEST_PADDED_LOWER = 416, TEST_PADDED_LOWER_BITS = 96;
  localparam integer TEST_PADDED_UPPER = 512, TEST_PADDED_UPPER_BITS = 96;
  localparam integer TEST_INVERSE = 608, TEST_INVERSE_BITS = 96;
  localparam integer TEST_MAIN_AXIS = 704, TEST_MAIN_AXIS_BITS = 2;
  localparam integer TEST_SHEAR = 706, TEST_SHEAR_BITS = 64;
  localparam integer TEST_DIRECTION = 770, TEST_DIRECTION_BITS = 105;

  // a triangle in the traverser's memory
  localparam integer TRIANGLE_BITS = 352;
  localparam integer TRIANGLE_CORNERS = 0, TRIANGLE_CORNERS_BITS = 288;
  localparam integer TRIANGLE_NUMBER = 288, TRIANGLE_NUMBER_BITS = 32;
  localparam integer TRIANGLE_MATERIAL = 320, TRIANGLE_MATERIAL_BITS = 32;

  // a node there, the low bits of its line
  localparam integer NODE_BITS = 448;
  localparam integer NODE_GRID = 0, NODE_GRID_BITS = 96;
  localparam integer NODE_STEP = 96, NODE_STEP_BITS = 24;
  localparam integer NODE_CHILDREN = 120, NODE_CHILDREN_BITS = 8;
  localparam integer NODE_LOWER = 128, NODE_LOWER_BITS = 96;
  localparam integer NODE_UPPER = 224, NODE_UPPER_BITS = 96;
  localparam integer NODE_REFERENCES = 320, NODE_REFERENCES_BITS = 128;

  // a ray, in beats of 128 bits; word by word machine/common/packages.hpp
  localparam integer RAY_BITS = 384;
  localparam integer RAY_ORIGIN = 0, RAY_ORIGIN_BITS = 96;
  localparam integer RAY_DIRECTION = 96, RAY_DIRECTION_BITS = 96;
  localparam integer RAY_LIMIT = 192, RAY_LIMIT_BITS = 32;
  localparam integer RAY_PIXEL = 224, RAY_PIXEL_BITS = 32;
  localparam integer RAY_COLOR = 256, RAY_COLOR_BITS = 96;
  localparam integer RAY_DEPTH = 352, RAY_DEPTH_BITS = 8;
  localparam integer RAY_UNUSED = 360, RAY_UNUSED_BITS = 20;
  localparam integer RAY_MET = 380, RAY_MET_BITS = 1;
  localparam integer RAY_FIRST = 381, RAY_FIRST_BITS = 1;
  localparam integer RAY_RETURNS = 382, RAY_RETURNS_BITS = 1;
  localparam integer RAY_SHADOW = 383, RAY_SHADOW_BITS = 1;
  /* verilator lint_on UNUSEDPARAM */
