#include "cosim/coverage.hpp"

#include <algorithm>

#include "bits.hpp"

namespace raypool {
namespace {

constexpr uint64_t kNoBeatYet = ~uint64_t{0} / 2;
// A store that waited for its line passes again within this many cycles of the line's last beat.
constexpr uint64_t kReplayCycles = 12;
constexpr uint32_t kInstructionId = 16;
constexpr uint64_t kOpenCycles = 300;
// An access that waits for a package's words retires as many cycles after these came.
constexpr uint64_t kPackageCycles = 4;

/// Of a line in a unit's data cache.
uint32_t line_key(uint32_t unit, uint32_t address) { return unit << 26 | address / kLineBytes; }
bool is_instruction(uint8_t id) { return (id & 31) == kInstructionId; }

size_t row_of(const InstructionInfo* info) { return static_cast<size_t>(info - kInstructions); }

}  // namespace

Coverage::Coverage(const Configuration& configuration, int units)
    : configuration_(configuration),
      units_(static_cast<uint32_t>(units)),
      lanes_(configuration.lanes),
      full_(lanes_ == 32 ? ~0u : (1u << lanes_) - 1),
      rows_(std::size(kInstructions)),
      empty_(std::size(kInstructions)),
      partial_(std::size(kInstructions)),
      depths_(configuration.stack_depth + 1),
      code_(1u << 16) {}

void Coverage::begin() {
  now_ = 1000;  // so that "some cycles ago" is never before 0
  warps_.assign(units_ * configuration_.warps, Warp{});
  for (Warp& warp : warps_) {
    warp.registers.assign(size_t{kRegisters} * lanes_, 0);
    warp.roles = {0, 1, 2};
  }
  recent_.clear();
  lines_.clear();
  reads_ = {};
  data_fetches_ = 0;
  last_line_end_ = last_beat_ = last_import_beat_ = 0;
  import_beat_ = 0;
  import_thread_ = 0;
  set_written_ = {};
  made_ = left_ = {};
  moved_ = {};
  accepted_ = {};
  launched_.clear();
  ended_ = 0;
  last_slow_.reset();
  last_pc_ = ~0u;
  open_cycles_ = 0;
  arguments_ = {};
  words_.clear();
  pcs_.assign(code_.size(), false);
}

void Coverage::faulted(const std::vector<Fault>& faults) {
  // Those of a unit stand together, the one that wins first.
  const Fault* winner = nullptr;
  for (const Fault& fault : faults) {
    if (winner == nullptr || winner->unit != fault.unit) {
      winner = &fault;
      ++faults_[fault.code];
      const Warp& warp = warp_of(fault.unit, fault.warp);
      if (warp.element > 0 && fault.pc == warp.last_pc) hit(Event::FaultInTriple);
      if (warp.inside && launched_.size() > ended_ + 1)
        hit(warp.kernel == ended_ ? Event::FaultInOlder : Event::FaultInNewer);
      const uint32_t upper = 1u << (configuration_.pc_bits - 1);
      // Instructions have retired beyond it: the twin is inside.
      const bool outside = fault.code == FaultCode::PcOutsideProgram && (fault.pc & upper) != 0;
      if (outside && std::find(pcs_.begin() + (fault.pc ^ upper), pcs_.end(), true) != pcs_.end())
        hit(Event::TwinInside);
    } else {
      ++fault_pairs_[winner->code][fault.code][winner->warp < fault.warp ? 1 : 0];
    }
  }
}

void Coverage::cycle(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace) {
  ++now_;
  for (const StoreEvent& event : trace.stores) stored(event);
  launches(outputs, inputs);
  for (const RetireEvent& event : trace.retired) retired(event);
  if (units_ == 1) overlap(trace);
  memory_response(inputs);
  memory_request(outputs, inputs);
  pools(outputs, inputs, trace);
  if (outputs.fault.code != FaultCode::None) after_fault(outputs, inputs, trace);
}

void Coverage::after_fault(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace) {
  if (!trace.retired.empty()) hit(Event::RetiresAfterFault);
  if (!trace.stores.empty()) hit(Event::StoreAfterFault);
  if (inputs.memory_response_valid && inputs.memory_response.beat == 3) hit(Event::LineAfterFault);
  if ((outputs.export_valid && inputs.export_ready) || (outputs.frame_valid && inputs.frame_ready))
    hit(Event::ExportAfterFault);
  const bool open =
      inputs.memory_request_ready && inputs.import_request_ready && inputs.export_ready && inputs.frame_ready;
  open_cycles_ = open ? open_cycles_ + 1 : 0;
  if (open_cycles_ == kOpenCycles) hit(Event::OpenAfterFault);
}

void Coverage::end(ComputeUnit& unit) {
  const uint64_t misses = unit.counter(counter::kDataCacheMisses);
  hit(Event::LoadHit, unit.counter(counter::kDataCacheHits));
  hit(Event::LoadMiss, misses);
  hit(Event::Store, unit.counter(counter::kDataCacheStores));
  hit(Event::ElementsOverlap, unit.counter(counter::kFltOverlapped));
  hit(Event::InstructionHit, unit.counter(counter::kInstructionCacheHits));
  hit(Event::InstructionMiss, unit.counter(counter::kInstructionCacheMisses));
  // Every fetch is of one quadword that missed; the others used its line.
  if (misses > data_fetches_) hit(Event::FetchShared, misses - data_fetches_);
}

void Coverage::retired(const RetireEvent& event) {
  const Instruction instruction = unpack(event.instruction);
  if (instruction.info == nullptr || event.unit >= units_) return;
  const size_t row = row_of(instruction.info);
  const Opcode opcode = instruction.info->opcode;
  const size_t type = to_underlying(alu_of(opcode));
  Warp& warp = warp_of(event.unit, event.warp);
  ++rows_[row];
  if (event.mask == 0) ++empty_[row];
  if (event.mask != 0 && event.mask != full_) ++partial_[row];
  if (warp.last_type >= 0) ++after_[warp.last_type][type];
  if (warp.stack.empty()) warp.stack = {{event.pc, 0xffff}};
  if (!warp.inside) enter_kernel(warp, event.warp);
  triple(warp, event, instruction);
  if (type == to_underlying(AluType::Slw)) slow(event);
  if (warp.stack.size() < depths_.size()) ++depths_[warp.stack.size()];
  together(event, type);
  code(event);
  predicates(warp, event, instruction);
  last_of_all(event, instruction);
  if (opcode == Opcode::Arg) argument(event, instruction);
  if (opcode == Opcode::Ld) loaded(warp, event, instruction);
  if (instruction.info->kind == Kind::Swap)
    swapped(warp, event, opcode);
  else if (type == to_underlying(AluType::Ray) && set_written_[warp.roles[1]] + kPackageCycles >= now_)
    hit(Event::PackageIntoSet);
  if (writes_register(*instruction.info)) {
    for (uint32_t mask = event.mask; mask != 0; mask &= mask - 1) {
      const auto lane = lowest(mask);
      warp.registers[instruction.rd * lanes_ + lane] = event.data[lane];
    }
  }
  warp.last_type = static_cast<int>(type);
  warp.last_retired = now_;
  control(warp, event, instruction);
}

// Each element retires, with the instruction that it is an element of.
void Coverage::triple(Warp& warp, const RetireEvent& event, const Instruction& instruction) {
  warp.last_pc = event.pc;
  if (!is_triple(*instruction.info)) {
    warp.element = 0;
    return;
  }
  warp.element = (warp.element + 1) % kElements;
  if (warp.element == 0 && elements_depend(instruction)) hit(Event::ElementsDepend);
}

// Groups enter in consecutive cycles, and a task retires as long after its last group as any other.
void Coverage::slow(const RetireEvent& event) {
  const uint32_t groups = configuration_.slow_groups();
  const uint32_t first = full_ >> (lanes_ - lanes_ / groups);
  if (event.mask != 0 && (event.mask & first) == 0) hit(Event::FirstGroupMasked);
  if (last_slow_ && last_slow_->cycle + groups == now_ && last_slow_->warp / configuration_.warps == event.unit)
    hit(Event::GroupsInARow);
  last_slow_ = Recent{now_, event.unit * configuration_.warps + event.warp, to_underlying(AluType::Slw)};
}

// A warp takes part in the launches that have threads for it, one after the other.
void Coverage::enter_kernel(Warp& warp, uint32_t number) {
  while (warp.kernel < launched_.size() && launched_[warp.kernel] <= number * lanes_) ++warp.kernel;
  warp.inside = warp.kernel < launched_.size();
}

// Kernels end in the order of their launches.
void Coverage::overlap(const UnitTrace& trace) {
  uint32_t older = 0, newer = 0;  // warps that retire something
  for (const RetireEvent& event : trace.retired) {
    const Warp& warp = warp_of(event.unit, event.warp);
    if (warp.inside) (warp.kernel > ended_ ? newer : older) |= 1u << event.warp;
  }
  if (newer == 0) return;
  hit(Event::NewerRetires);
  if (older != 0) hit(Event::BothRetire);
  for (uint32_t w = lowest(newer) + 1; w < configuration_.warps; ++w)
    if (warps_[w].inside && warps_[w].kernel == ended_) hit(Event::OlderIsHigher);
}

void Coverage::code(const RetireEvent& event) {
  const uint32_t pc = event.pc;
  if (pcs_[pc]) {
    if (code_[pc] != event.instruction) hit(Event::CodeRewritten);
    code_[pc] = event.instruction;
    return;
  }
  pcs_[pc] = true;
  code_[pc] = event.instruction;
  for (uint32_t bit = kFirstUpperPcBit; bit < pc_bits_.size(); ++bit) {
    pc_bits_[bit] += pc >> bit & 1;
    if (pcs_[pc ^ 1u << bit]) ++pc_twins_[bit];
  }
}

void Coverage::argument(const RetireEvent& event, const Instruction& instruction) {
  if (event.mask == 0) return;
  const uint32_t value = event.data[lowest(event.mask)];
  std::optional<uint32_t>& before = arguments_[instruction.immediate % kArguments];
  if (before && *before != value) hit(Event::ArgumentRewritten);
  before = value;
}

void Coverage::predicates(Warp& warp, const RetireEvent& event, const Instruction& instruction) {
  const auto read = [&](uint32_t number) {
    if ((warp.left & ~warp.written) >> number & 1) ++left_set_[number];
  };
  read(instruction.guard);
  if (has_operand(*instruction.info, Operand::Px)) read(instruction.x & 15);
  if (has_operand(*instruction.info, Operand::Pb)) read(instruction.rb);
  if (writes_predicate(*instruction.info)) {
    const uint32_t bit = 1u << instruction.rd;
    warp.written |= bit;
    warp.set = event.predicate != 0 ? warp.set | bit : warp.set & ~bit;
  }
  if (instruction.info->opcode != Opcode::Exit) return;
  warp.left = warp.set & ~1u;
  warp.set = warp.written = 0;
}

void Coverage::last_of_all(const RetireEvent& event, const Instruction& instruction) {
  const Opcode opcode = instruction.info->opcode;
  if (opcode == Opcode::Arg && instruction.immediate % kArguments == configuration_.arguments - 1)
    hit(Event::LastArgument);
  if (event.warp + 1 != configuration_.warps || (event.mask >> (lanes_ - 1) & 1) == 0) return;
  if (writes_register(*instruction.info) && instruction.rd == configuration_.registers - 1) hit(Event::LastRegister);
  if (writes_predicate(*instruction.info) && instruction.rd == configuration_.predicates - 1 &&
      (event.predicate >> (lanes_ - 1) & 1) != 0)
    hit(Event::LastPredicate);
  if (opcode == Opcode::Rst && instruction.x + 1u == configuration_.intersection_words) hit(Event::LastWord);
  if (opcode == Opcode::Ld) hit(Event::LastLoad);
  if (opcode == Opcode::St) hit(Event::LastStore);
}

// An instruction that retires in this cycle was in its ALU for at least the type's depth, so it was there
// together with all that retired since.
void Coverage::together(const RetireEvent& event, size_t type) {
  const auto alu = static_cast<AluType>(type);
  const auto per_unit = configuration_.warps;
  const uint32_t me = event.unit * per_unit + event.warp;
  const int depth = alu == AluType::Mem ? 3 : alu == AluType::Ray ? 2 : configuration_.task_of(alu).depth;
  while (!recent_.empty() && recent_.front().cycle + 64 < now_) recent_.pop_front();
  for (auto other = recent_.rbegin(); other != recent_.rend() && other->cycle + static_cast<uint64_t>(depth) >= now_;
       ++other)
    if (other->warp != me && other->warp / per_unit == event.unit)
      ++together_[std::min(type, other->type)][std::max(type, other->type)];
  recent_.push_back({now_, me, type});
}

void Coverage::control(Warp& warp, const RetireEvent& event, const Instruction& instruction) {
  const Opcode opcode = instruction.info->opcode;
  Entry& top = warp.stack.back();
  top.pc = event.pc + 1;
  if (instruction.info->kind == Kind::Control) {
    const uint32_t low = instruction.immediate & 0xffff;
    const bool jumps = event.mask != 0 ? opcode == Opcode::Jany : opcode == Opcode::Jnone || opcode == Opcode::Loop;
    if (jumps) {
      if (warp.stack.size() > 1 && low > top.rpc) hit(top.loop ? Event::LoopLeft : Event::FunctionLeft);
      if (warp.stack.size() > 1 && low < top.begin) hit(top.loop ? Event::LoopLeftBack : Event::FunctionLeftBack);
      top.pc = low;
    } else if (opcode == Opcode::Loop) {
      top.pc = event.pc;
      warp.stack.push_back({event.pc + 1, low, event.pc + 1, true});
    } else if (opcode == Opcode::Call) {
      warp.stack.push_back({low, instruction.immediate >> 16, low, false});
    } else if (opcode == Opcode::Ret) {
      warp.stack.pop_back();
    } else if (opcode == Opcode::Exit) {
      warp.stack.clear();
      warp.last_type = -1;
      warp.inside = false;
      ++warp.kernel;
    }
  }
  while (warp.stack.size() > 1 && warp.stack.back().pc >= warp.stack.back().rpc) warp.stack.pop_back();
}

uint32_t Coverage::set_of(uint32_t address) const {
  return address / kLineBytes % (configuration_.data_cache_bytes / (2 * kLineBytes));
}

void Coverage::loaded(const Warp& warp, const RetireEvent& event, const Instruction& instruction) {
  std::array<uint32_t, 32> quadwords{};
  size_t count = 0, active = 0;
  for (uint32_t mask = event.mask; mask != 0; mask &= mask - 1, ++active) {
    const auto lane = lowest(mask);
    const uint32_t address = warp.registers[instruction.ra * lanes_ + lane] + instruction.immediate;
    if (std::find(quadwords.begin(), quadwords.begin() + count, address / 16) == quadwords.begin() + count)
      quadwords[count++] = address / 16;
    for (uint32_t bit = kFirstUpperBit; bit < load_bits_.size(); ++bit) load_bits_[bit] += address >> bit & 1;
    const auto line = lines_.find(line_key(event.unit, address));
    if (line != lines_.end() && line->second.stored) hit(Event::StoreHit);
    const auto [word, first] = words_.emplace(address, event.data[lane]);
    if (!first && word->second != event.data[lane]) hit(Event::WordRewritten);
    word->second = event.data[lane];
  }
  if (active > 1 && count == 1) hit(Event::OneQuadword);
  if (count > 1) hit(Event::SeveralQuadwords);
  if (count > 1 && count == lanes_) hit(Event::QuadwordALane);
}

void Coverage::stored(const StoreEvent& event) {
  for (uint32_t bit = kFirstUpperBit; bit < store_bits_.size(); ++bit) store_bits_[bit] += event.address >> bit & 1;
  for (uint32_t word = 0; word < kBeatWords; ++word)
    if ((event.mask >> word & 1) != 0) words_.erase(event.address + 4 * word);
  const auto line = lines_.find(line_key(event.unit, event.address));
  if (line == lines_.end()) return;
  line->second.stored = true;
  const bool waited = warp_of(event.unit, event.warp).last_retired < line->second.first_beat;
  if (waited && line->second.last_beat + kReplayCycles >= now_) hit(Event::StoreAfterRefill);
}

void Coverage::swapped(Warp& warp, const RetireEvent& event, Opcode opcode) {
  if (opcode == Opcode::Rin) {
    std::swap(warp.roles[0], warp.roles[1]);
  } else {
    if (warp.last_export > left_[event.unit]) hit(Event::RotatedTwice);
    std::swap(warp.roles[1], warp.roles[2]);
    hit(event.mask == 0 ? Event::NothingLeaves : opcode == Opcode::Rout ? Event::RayLeaves : Event::ContributionLeaves);
    made_[event.unit] += popcount(event.mask);
    if (event.mask != 0) warp.last_export = made_[event.unit];
  }
  const size_t permutation = size_t{warp.roles[0]} * 2 + (warp.roles[1] > warp.roles[2] ? 1 : 0);
  ++events_[to_underlying(Event::SetPermutation0) + permutation];
}

void Coverage::launches(const UnitOutputs& outputs, const UnitInputs& inputs) {
  for (uint32_t unit = 0; unit < units_; ++unit) accepted_[unit] -= static_cast<int>(outputs.kernel_done >> unit & 1);
  if (units_ == 1) ended_ += outputs.kernel_done & 1;
  if (units_ == 1 && accepted_[0] > 2) hit(Event::ThirdWaits);
  if (!inputs.launch_valid) return;
  if (!outputs.launch_ready) return hit(Event::LaunchWaits);
  const uint32_t threads = inputs.launch.threads;
  if ((outputs.busy >> outputs.launch_unit & 1) != 0) hit(Event::LaunchQueued);
  if (threads == configuration_.contents()) hit(Event::FullBlock);
  if (threads == 1) hit(Event::OneThread);
  if (threads % lanes_ != 0) hit(Event::PartOfWarp);
  if ((threads + lanes_ - 1) / lanes_ < configuration_.warps) hit(Event::WarpsLeftOut);
  if (last_pc_ != ~0u && last_pc_ != inputs.launch.pc) hit(Event::OtherKernelNext);
  last_pc_ = inputs.launch.pc;
  if (units_ == 1) launched_.push_back(threads);
  if (inputs.launch.import != ImportKind::None) import_thread_ = 0;
  ++accepted_[outputs.launch_unit];
}

void Coverage::memory_request(const UnitOutputs& outputs, const UnitInputs& inputs) {
  if (!outputs.memory_request_valid) {
    if (inputs.memory_request_ready) hit(Event::MemoryRequestFree);
    return;
  }
  if (!inputs.memory_request_ready) return hit(Event::MemoryRequestWaits);
  hit(Event::MemoryRequestMoves);
  if (moved_[0] + 1 == now_) hit(Event::MemoryRequestTwice);
  moved_[0] = now_;
  const MemoryRequest& request = outputs.memory_request;
  if (request.write) return;
  reads_[request.id] = {true, request.address, reads_asked_++};
  if (is_instruction(request.id)) return;

  ++data_fetches_;
  hit(Event::LineFetched);
  const uint32_t unit = unit_of_id(request.id);
  Line& line = lines_[line_key(unit, request.address)];
  if (++line.fetches > 1) hit(Event::FetchedAgain);
  line.stored = false;
  line.first_beat = kNoBeatYet;
  uint32_t in_use = 0, of_set = 0;
  for (uint32_t id = unit * 32; id < unit * 32 + kInstructionId; ++id) {
    if (!reads_[id].valid) continue;
    ++in_use;
    if (set_of(reads_[id].address) == set_of(request.address)) ++of_set;
    const uint32_t difference = reads_[id].address ^ request.address;
    if (id == request.id || (difference & (difference - 1)) != 0) continue;
    if (difference == 1u << 31)
      hit(Event::TopBitOnTheWay);
    else if (difference >= 1u << kFirstUpperBit)
      hit(Event::UpperBitOnTheWay);
  }
  if (in_use == configuration_.data_cache_mshrs) hit(Event::AllRegisters);
  if (of_set > 1) hit(Event::OneSet);
  if (reads_[unit * 32 + kInstructionId].valid) hit(Event::BothCaches);
}

void Coverage::memory_response(const UnitInputs& inputs) {
  if (!inputs.memory_response_valid) return;
  const MemoryResponse& response = inputs.memory_response;
  Read& read = reads_[response.id];
  if (response.beat > 0 && last_beat_ + 1 != now_) hit(Event::ResponseGap);
  if (response.beat == 0 && last_line_end_ + 1 == now_) hit(Event::ResponseTwice);
  last_beat_ = now_;
  const bool data = !is_instruction(response.id);
  const uint32_t key = line_key(unit_of_id(response.id), read.address);
  if (response.beat == 0 && data) lines_[key].first_beat = now_;
  if (response.beat != 3) return;
  last_line_end_ = now_;
  read.valid = false;
  for (const Read& other : reads_)
    if (other.valid && other.order < read.order) hit(Event::OutOfOrder);
  if (data) lines_[key].last_beat = now_;
}

void Coverage::pools(const UnitOutputs& outputs, const UnitInputs& inputs, const UnitTrace& trace) {
  if (outputs.import_request_valid)
    hit(inputs.import_request_ready ? Event::ImportRequestMoves : Event::ImportRequestWaits);
  if (!outputs.import_request_valid && inputs.import_request_ready) hit(Event::ImportRequestFree);
  const auto leaves = [&](bool valid, bool ready, Event moves, uint64_t& moved) {
    const auto event = [&](size_t n) { return static_cast<Event>(static_cast<size_t>(moves) + n); };
    if (!valid || !ready) {
      if (valid || ready) hit(event(valid ? 1 : 2));
      return;
    }
    hit(moves);
    if (moved + 1 == now_) hit(event(3));
    moved = now_;
  };
  leaves(outputs.export_valid, inputs.export_ready, Event::ExportMoves, moved_[1]);
  leaves(outputs.frame_valid, inputs.frame_ready, Event::FrameMoves, moved_[2]);
  const bool beat_leaves = outputs.export_valid && inputs.export_ready;
  if (beat_leaves && outputs.export_last) ++left_[outputs.export_unit];
  if (outputs.frame_valid && inputs.frame_ready) ++left_[outputs.frame_unit];
  if (!inputs.import_beat_valid) return;
  if (!trace.ray_writes.empty()) hit(Event::ImportAndStore);
  if (beat_leaves) hit(Event::ImportAndExport);
  if (units_ == 1 && accepted_[0] > 1 && outputs.busy != 0) hit(Event::ImportAhead);
  if (import_beat_ > 0 && last_import_beat_ + 1 != now_) hit(Event::ImportGap);
  if (import_beat_ == 0 && last_import_beat_ + 1 == now_) hit(Event::ImportTwice);
  last_import_beat_ = now_;
  // An engine without time takes a launch while packages of the one before still come.
  const size_t importing = import_thread_ / lanes_;
  if (units_ == 1 && importing < warps_.size()) set_written_[warps_[importing].roles[0]] = now_;
  import_beat_ = (import_beat_ + 1) % configuration_.intersection_beats();
  if (import_beat_ == 0) ++import_thread_;
}

}  // namespace raypool
