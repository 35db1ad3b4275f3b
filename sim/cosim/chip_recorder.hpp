// Writes down what a chip gets and shows in every cycle, so that another simulator can replay it:
// tb/icarus/chip_replay.v.
#pragma once

#include <ostream>

#include "config/configuration.hpp"
#include "machine/chip/chip_device.hpp"

namespace raypool {

/// Stands in front of a chip. A line a cycle: inputs, expected outputs and, bit by bit, which of them count, as
/// hexadecimal numbers. The fields are those of chip_replay.v, in its order, the first one in the highest bits. Valids
/// always count, a payload while it is valid, of a write to the memory the words that it writes.
class ChipRecorder : public ChipDevice {
 public:
  /// `chip`, of this configuration, and `out` must outlive it.
  ChipRecorder(const Configuration& configuration, ChipDevice& chip, std::ostream& out);

  uint32_t units() const override { return chip_.units(); }
  void start(const FrameSetup& setup) override;
  void start_next(const FrameSetup& setup) override;
  const ChipOutputs& outputs() const override { return chip_.outputs(); }
  void clock(const ChipInputs& inputs) override;
  ChipCounts counts() override { return chip_.counts(); }
  uint64_t counter(int number) override { return chip_.counter(number); }
  std::optional<TraverserWork> traverser_work() const override { return chip_.traverser_work(); }

 private:
  struct Host {
    bool reset = false, start = false;
    bool argument = false;  ///< is written
    uint32_t index = 0, value = 0;
  };

  void record_arguments();
  /// `checked`: the outputs count.
  void record(const Host& host, const ChipInputs& inputs, bool checked);

  ChipDevice& chip_;
  std::ostream& out_;
  uint32_t arguments_;
  int kinds_, place_bits_;
  bool inside_;  // the traverser
  bool starts_ = false;
  FrameSetup setup_;
};

}  // namespace raypool
