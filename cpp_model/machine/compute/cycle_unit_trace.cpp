// What the trace ports of engine `model` show. Kept after trace_on() only, as it costs more than the rest of a cycle.
#include <algorithm>
#include <utility>

#include "bits.hpp"
#include "machine/compute/cycle_unit.hpp"

namespace raypool {

void CycleUnit::record_issue(uint32_t warp, const DecodedInstruction& instruction) {
  std::deque<Issue>& issues = issues_[warp];
  if (issues.front().retired) {
    timings_[warp].wanting = 0;
    issues.push_back(std::move(issues.front()));  // its vectors are used again
    issues.pop_front();
  } else {
    issues.emplace_back();
  }
  Issue& issue = issues.back();
  issue.retired = false;
  const auto row = [this, warp](std::vector<uint32_t>& words, uint32_t number) {
    const uint32_t* first = core_.register_row(warp, number);
    words.assign(first, first + lanes_);
  };
  issue.pc = buffer_.pc(warp);
  issue.instruction = &instruction;
  issue.mask = core_.thread_mask(warp, instruction);
  row(issue.operand_a, instruction.ra);
  row(issue.operand_b, instruction.rb);
  row(issue.operand_c, instruction.x & 15);
  if (instruction.b_is_immediate) std::fill(issue.operand_b.begin(), issue.operand_b.end(), instruction.immediate);
  issue.predicate_x = core_.predicate(warp, instruction.x & 15);
  issue.predicate_b = core_.predicate(warp, instruction.rb);
  issue.predicate = 0;
  issue.wanted = timings_[warp].fetch_cycle;
  issue.issued = now_;
}

// The warp that is about to be given the ALU.
void CycleUnit::record_grant(AluType type) {
  const uint32_t warp = lowest(Dispatcher::winner(dispatcher_.wants(type), older_[kAhead]));
  issues_[warp][timings_[warp].wanting].granted = now_;
}

// They read the operands of the next element, and want an ALU for it in two cycles.
void CycleUnit::record_next_want(uint32_t warps) {
  for (; warps != 0; warps &= warps - 1) {
    timings_[lowest(warps)].want_cycle = now_ + kAhead;
    ++timings_[lowest(warps)].wanting;
  }
}

void CycleUnit::record_result(uint32_t warp, const Step& step) {
  Issue& issue = issues_[warp].back();
  if (step.data != nullptr) issue.data.assign(step.data, step.data + lanes_);
  issue.predicate = step.predicate;
}

// What the trace ports show in the cycle that begins.
void CycleUnit::record() {
  trace_.retired.clear();
  trace_.stores.clear();
  trace_.ray_writes.clear();
  const Timeline::Cycle& due = timeline_.at(now_);
  for (uint32_t warps = due.done | due.part | mem_.done() | ray_.done(); warps != 0; warps &= warps - 1) {
    const uint32_t warp = lowest(warps);
    if (issues_[warp].front().retired) {  // an element of a triple, and the next is done
      issues_[warp].pop_front();
      --timings_[warp].wanting;
    }
    Issue& issue = issues_[warp].front();
    issue.retired = true;
    RetireEvent& event = trace_.retired.emplace_back();
    event.warp = warp;
    event.pc = issue.pc;
    event.instruction = issue.instruction->encoding;
    event.mask = issue.mask;
    event.data = issue.data;
    event.data.resize(lanes_);
    event.predicate = issue.predicate;
    const AluType alu = issue.instruction->alu();
    const bool pipelined = alu != AluType::Mem && alu != AluType::Ray;
    event.wanted = now_ - issue.wanted;
    event.issued = now_ - issue.issued;
    // A pipelined ALU has the task in the cycle after the grant.
    event.granted = pipelined ? dispatcher_.depth(to_underlying(alu)) + 1 : now_ - issue.granted;
    event.last = issue.instruction->next == nullptr;
    if ((ray_.done() >> warp & 1) != 0 && ray_.wrote())
      trace_.ray_writes.push_back({warp, issue.instruction->x, issue.mask, issue.operand_b, 0});
  }
  StoreEvent store;
  if (mem_.storing(store)) trace_.stores.push_back(store);
}

}  // namespace raypool
