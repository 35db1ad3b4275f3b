#include "chip/answer_watch.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace raypool::chip {

void AnswerWatch::Port::clock(uint64_t cycle, bool asks, bool beat) {
  if (beat && ++beats == raypool::MemoryLine::kBeats) {
    beats = 0;
    if (!asked.empty()) asked.pop_front();
  }
  if (asks) asked.push_back(cycle);
}

std::optional<std::string> AnswerWatch::waits() const {
  std::string all;
  for (const Port& port : ports_) {
    if (port.asked.empty()) continue;
    all += fmt::format("{}{} waits for {} lines of the memory, since cycle {}", all.empty() ? "" : ", ", port.requester,
                       port.asked.size(), port.asked.front());
  }
  return all.empty() ? std::nullopt : std::optional(all);
}

const AnswerWatch::Port* AnswerWatch::late_port() const {
  for (const Port& port : ports_)
    if (!port.asked.empty() && cycle_ - port.asked.front() > limit_) return &port;
  return nullptr;
}

std::string AnswerWatch::late() const {
  const Port* port = late_port();
  if (port == nullptr) return "";
  return fmt::format(
      "{} waits at port {} since cycle {} for a line of the memory, and none takes more than {} cycles: the memory has "
      "lost a request or an answer",
      port->requester, port->name, port->asked.front(), limit_);
}

bool AnswerWatch::look(uint64_t cycle, const ChipOutputs& outputs, const ChipInputs& inputs) {
  cycle_ = cycle;
  const auto reads = [](bool valid, bool ready, bool write) { return valid && ready && !write; };
  const TraverserPorts& traverser = outputs.traverser;
  ports_[0].clock(
      cycle, reads(outputs.memory_request_valid, inputs.memory_request_ready, outputs.memory_request.request.write),
      inputs.memory_beat_valid && outputs.memory_beat_ready);
  ports_[1].clock(cycle, reads(traverser.tree_request_valid, outputs.tree_request_ready, traverser.tree_request.write),
                  outputs.tree_response_valid);
  ports_[2].clock(cycle,
                  reads(outputs.device.memory_request_valid, outputs.to_device.memory_request_ready,
                        outputs.device.memory_request.write),
                  outputs.to_device.memory_response_valid);
  due_ = kNever;
  for (const Port& port : ports_)
    if (!port.asked.empty()) due_ = std::min(due_, port.asked.front() + limit_ + 1);
  return cycle >= due_;
}

}  // namespace raypool::chip
