// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Choosing by bits of which one at most is set, as an AND of each item and an OR of all. Included in a module; these
// macros write its functions: a function's widths are those of its module. Where it is called under no condition it
// needs no variables of the instance in Verilator (sim/rtl/shared_modules.vlt). tb/proofs/control/onehot.v proves both.
`ifndef ONEHOT_SELECT
// name(onehot, items): of COUNT items of WIDTH bits the one with its bit set; 0 if none is.
`define ONEHOT_SELECT(name, COUNT, WIDTH) \
  function [(WIDTH)-1:0] name(input [(COUNT)-1:0] onehot, input [(COUNT)*(WIDTH)-1:0] items); \
    integer item; \
    begin \
      name = {(WIDTH){1'b0}}; \
      for (item = 0; item < (COUNT); item = item + 1) \
        if (onehot[item]) name = name | items[item*(WIDTH) +: (WIDTH)]; \
    end \
  endfunction
// name(onehot): the number, in BITS bits, of the one of COUNT bits that is set; 0 if none is.
`define ONEHOT_NUMBER(name, COUNT, BITS) \
  function [(BITS)-1:0] name(input [(COUNT)-1:0] onehot); \
    integer item; \
    begin \
      name = {(BITS){1'b0}}; \
      for (item = 0; item < (COUNT); item = item + 1) if (onehot[item]) name = name | item[(BITS)-1:0]; \
    end \
  endfunction
`endif
