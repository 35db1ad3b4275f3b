// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_memory_arbiter.v: joins the instruction side and the data side to the unit's
// memory port, and routes responses.
#pragma once

#include <cstdint>

#include "machine/compute/compute_unit.hpp"

namespace raypool {

class MemoryArbiter {
 public:
  static constexpr uint8_t kInstructionId = 16;  ///< of a read of the instruction side

  void reset() { valid_ = false; }

  bool request_valid() const { return valid_; }
  const MemoryRequest& request() const { return request_; }  ///< means something while request_valid()
  bool idle() const { return !valid_; }

  // Readies of both sides: the instruction side goes first.
  bool instruction_request_ready(bool request_ready) const { return !valid_ || request_ready; }
  bool data_request_ready(bool request_ready, bool instruction_request_valid) const {
    return instruction_request_ready(request_ready) && !instruction_request_valid;
  }
  static bool of_instruction(uint8_t response_id) { return response_id == kInstructionId; }

  /// The end of a cycle; `data_request` means something with `data_request_valid`.
  void clock(bool request_ready, bool instruction_request_valid, uint32_t instruction_request_address,
             bool data_request_valid, const MemoryRequest& data_request) {
    if (!instruction_request_ready(request_ready)) return;
    valid_ = instruction_request_valid || data_request_valid;
    if (instruction_request_valid) {
      request_ = MemoryRequest{};
      request_.address = instruction_request_address;
      request_.id = kInstructionId;
    } else if (data_request_valid) {
      request_ = data_request;
    }
  }

 private:
  bool valid_ = false;
  MemoryRequest request_;
};

}  // namespace raypool
