// For tests: the smallest chip around a compute unit, or a multiprocessor. Launches kernels, answers memory, gives
// packages, takes rays and contributions, with randomly hesitating ports.
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "bits.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"
#include "random.hpp"

namespace raypool::test {

class TestChip {
 public:
  /// ready_percent: chance that a port is ready in a cycle. latency: cycles from a line read to its first beat.
  TestChip(ComputeUnit& unit, Memory& memory, uint32_t seed = 1, int ready_percent = 100, int latency = 20)
      : unit_(&unit),
        memory_(&memory),
        random_(seed),
        ready_percent_(ready_percent),
        latency_(static_cast<uint64_t>(latency)) {}

  std::deque<LaunchCommand> launches;    ///< to be launched, in order
  std::vector<Ray> rays;                 ///< exported
  std::vector<FrameContribution> frame;  ///< contributed
  std::vector<ImportKind> requests;      ///< packages requested, by kind
  uint64_t kernels_done = 0;
  uint64_t cycles = 0;
  bool exports_ready = true;  ///< false holds exports and contributions back
  bool imports_ready = true;
  /// The n-th package that is given.
  std::function<Intersection(uint32_t)> package = [](uint32_t n) {
    Intersection words;
    for (uint32_t i = 0; i < kIntersectionWords; ++i) words[i] = n * 100 + i;
    return words;
  };

  void cycle() {
    const UnitOutputs& out = unit_->outputs();
    UnitInputs in;
    if (!launches.empty()) {
      in.launch_valid = true;
      in.launch = launches.front();
      if (out.launch_ready) launches.pop_front();
    }
    memory(out, in);
    imports(out, in);
    in.export_ready = exports_ready && chance();
    if (out.export_valid && in.export_ready) {
      ray_.insert(ray_.end(), out.export_data.begin(), out.export_data.end());
      if (out.export_last) {
        Ray ray{};
        for (size_t i = 0; i < ray.size() && i < ray_.size(); ++i) ray[i] = ray_[i];
        rays.push_back(ray);
        ray_.clear();
      }
    }
    in.frame_ready = exports_ready && chance();
    if (out.frame_valid && in.frame_ready) frame.push_back(out.frame);
    unit_->clock(in);
    ++cycles;
    kernels_done += popcount(unit_->outputs().kernel_done);
  }

  /// Until all is launched and the unit has been idle for some cycles, has a fault, or
  /// `limit` cycles have passed. True if idle.
  bool run(uint64_t limit = 100000) {
    for (int idle = 0; limit > 0; --limit) {
      cycle();
      if (unit_->outputs().fault.code != FaultCode::None) return false;
      idle = unit_->outputs().idle && launches.empty() ? idle + 1 : 0;
      if (idle == 8) return true;
    }
    return false;
  }

 private:
  struct Line {
    uint64_t due;
    uint32_t address;
    uint8_t id;
  };

  bool chance() { return ready_percent_ >= 100 || static_cast<int>(random_() % 100) < ready_percent_; }

  void memory(const UnitOutputs& out, UnitInputs& in) {
    in.memory_request_ready = chance();
    if (out.memory_request_valid && in.memory_request_ready) {
      const MemoryRequest& request = out.memory_request;
      if (request.write) {
        for (uint32_t i = 0; i < kBeatWords; ++i) {
          if (request.mask >> i & 1) memory_->store(request.address + 4 * i, request.data[i]);
        }
      } else {
        // Data are those of now: a read sees every earlier write and no later one.
        lines_.push_back({cycles + latency_, request.address, request.id});
        for (uint32_t i = 0; i < 16; ++i) line_data_.push_back(memory_->load(request.address + 4 * i));
      }
    }
    if (!lines_.empty() && lines_.front().due <= cycles && chance()) {
      in.memory_response_valid = true;
      in.memory_response.id = lines_.front().id;
      in.memory_response.beat = beat_;
      for (uint32_t i = 0; i < kBeatWords; ++i, line_data_.pop_front()) in.memory_response.data[i] = line_data_.front();
      if (++beat_ == 4) {
        beat_ = 0;
        lines_.pop_front();
      }
    }
  }

  void imports(const UnitOutputs& out, UnitInputs& in) {
    in.import_request_ready = imports_ready && chance();
    if (!packages_.empty() && chance()) {
      in.import_beat_valid = true;
      for (size_t i = 0; i < kBeatWords; ++i) {
        const size_t word = package_beat_ * kBeatWords + i;
        in.import_beat[i] = word < kIntersectionWords ? packages_.front()[word] : 0;
      }
      if (++package_beat_ == kIntersectionBeats) {
        package_beat_ = 0;
        packages_.pop_front();
      }
    }
    if (out.import_request_valid && in.import_request_ready) {
      packages_.push_back(package(size32(requests)));
      requests.push_back(out.import_request_kind);
    }
  }

  ComputeUnit* unit_;
  Memory* memory_;
  Random random_;
  int ready_percent_;
  uint64_t latency_;
  std::deque<Line> lines_;
  std::deque<uint32_t> line_data_;
  uint8_t beat_ = 0;
  std::deque<Intersection> packages_;
  size_t package_beat_ = 0;
  std::vector<uint32_t> ray_;
};

}  // namespace raypool::test
