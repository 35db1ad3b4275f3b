// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Included in a module with a pipeline that never waits: whether the data registers behind its second stage or a later
// one load.
// Where no clock gates are they do in every cycle, and a bit costs two gates less than with an enable: what they take
// from an empty stage is never read, and as the registers behind the first stage keep theirs, nothing moves in an idle
// unit. Else, and in simulators, which are quicker if they skip an empty stage: with `enable`.
`ifndef STAGE_LOADS
`ifdef NO_CLOCK_GATES
`define STAGE_LOADS(enable) 1'b1
`else
`define STAGE_LOADS(enable) (enable)
`endif
`endif
