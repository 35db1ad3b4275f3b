#include "traverser/lanes.hpp"

#include <algorithm>

#include "bits.hpp"

namespace raypool::traverser {

namespace {

constexpr uint32_t kLineBytes = 64;
constexpr uint64_t kCacheLatency = 2;

}  // namespace

Lanes::Cache::Cache(uint32_t lines, uint32_t ways, uint32_t mshrs, uint32_t most_banks, uint32_t lanes)
    : bank_turns(lanes), offers(lanes) {
  const uint32_t count = std::min(most_banks, std::max(1u, lines / ways));
  while (1u << bank_bits < count) ++bank_bits;
  const uint32_t mshrs_a_bank = std::clamp(mshrs / count, 1u, TreeCache::kMostMshrs);
  for (uint32_t bank = 0; bank < count; ++bank)
    banks.emplace_back(TreeCache::Sizes{lanes, lines / count, ways, mshrs_a_bank});
  inputs.resize(count);
  lookups.resize(count);
  lane_turns.resize(count);
  wanted.resize(count);
  chosen.resize(count);
}

void Lanes::Cache::add_to(CacheWork& work) const {
  for (const TreeCache& bank : banks) {
    work.hits += bank.work().hits;
    work.misses += bank.work().misses;
    work.joined += bank.work().joined;
  }
}

Lanes::Lanes(const ChipConfiguration& chip, MemoryTurns& turns)
    : slots_a_lane_(TraverserSizes(chip).rays / TraverserSizes(chip).box_pipes),
      lanes_(TraverserSizes(chip).box_pipes, Lane(chip, slots_a_lane_, StepLatencies(chip, kCacheLatency))),
      setup_(chip.modelled_traverser_setup_latency),
      nodes_(chip.modelled_traverser_node_cache_bytes / node_bytes(chip.modelled_traverser_nodes),
             chip.modelled_traverser_node_cache_ways, chip.modelled_traverser_node_cache_mshrs,
             chip.modelled_traverser_cache_banks, TraverserSizes(chip).box_pipes),
      triangles_(chip.modelled_traverser_triangle_cache_bytes / kLineBytes, chip.modelled_traverser_triangle_cache_ways,
                 chip.modelled_traverser_triangle_cache_mshrs, chip.modelled_traverser_cache_banks,
                 chip.modelled_traverser_box_pipes),
      memory_(chip, turns),
      finish_(chip.modelled_traverser_finish_latency) {}

bool Lanes::ready() const {
  return cycle_ >= enters_from_ &&
         std::any_of(lanes_.begin(), lanes_.end(), [](const Lane& lane) { return lane.free_slots() > 0; });
}

// The lanes take turns, those without a free slot left out.
uint32_t Lanes::push(const VisitList& visits) {
  uint32_t free = 0;
  for (uint32_t lane = 0; lane < lanes_.size(); ++lane) free |= (lanes_[lane].free_slots() > 0 ? 1u : 0u) << lane;
  const uint32_t lane = enter_turn_.choose(free);
  enter_turn_.advance(lane);
  const uint32_t slot = lane * slots_a_lane_ + lanes_[lane].enter(cycle_, visits, setup_.latency());
  setup_.push(cycle_, slot);
  enters_from_ = cycle_ + kEnter;
  work_.ray_cycles += (cycle_ - since_) * in_flight_;
  since_ = cycle_;
  ++work_.rays;
  work_.most_rays = std::max(work_.most_rays, ++in_flight_);
  return slot;
}

void Lanes::clock(uint64_t cycle) {
  cycle_ = cycle;
  finish();
  fill();
  look_up<true>(nodes_);
  look_up<false>(triangles_);
  for (Lane& lane : lanes_) lane.begin_triangle(cycle);
  give<true>(nodes_);
  give<false>(triangles_);
  for (Lane& lane : lanes_) lane.clock(cycle);
  take_prepared();
  ask_memory();
  for (Cache* cache : {&nodes_, &triangles_}) {
    for (size_t bank = 0; bank < cache->banks.size(); ++bank) {
      TreeCache::Inputs& inputs = cache->inputs[bank];
      if (inputs.lookup != nullptr || !cache->banks[bank].idle()) cache->banks[bank].clock(inputs);
      inputs = {};
    }
  }
}

// The oldest line that has come is offered to its bank until that takes it.
void Lanes::fill() {
  if (!memory_.valid(cycle_)) return;
  const TreeMemory::Returned line = memory_.front();
  if (line.source == TreeMemory::Source::Stacks) {
    lanes_[line.which / slots_a_lane_].filled();
    memory_.take();
    return;
  }
  Cache& cache = line.source == TreeMemory::Source::Nodes ? nodes_ : triangles_;
  const uint32_t bank = line.which >> 8;
  cache.inputs[bank].fill = true;
  cache.inputs[bank].fill_id = line.which & 255;
  if (cache.banks[bank].fill_ready()) memory_.take();
}

// Lanes to whom a line is offered for which a ray has waited take one, and ask for none themselves. Returns them.
template <bool nodes>
uint32_t Lanes::take_offers(Cache& cache) {
  uint32_t offered = 0, offering = 0;
  for (uint32_t bank = 0; bank < cache.banks.size(); ++bank) {
    if (!cache.banks[bank].offers()) continue;
    offering |= 1u << bank;
    offered |= 1u << cache.banks[bank].offer_lane();
  }
  for (uint32_t bits = offered; bits != 0; bits &= bits - 1) {
    const uint32_t lane = lowest(bits);
    if (!nodes && !lanes_[lane].leaf_room()) continue;
    uint32_t choices = 0;
    for (uint32_t banks = offering; banks != 0; banks &= banks - 1)
      choices |= (cache.banks[lowest(banks)].offer_lane() == lane ? 1u : 0u) << lowest(banks);
    const uint32_t bank = cache.bank_turns[lane].choose(choices);
    cache.bank_turns[lane].advance(bank);
    cache.inputs[bank].offer_taken = true;
    if (!nodes) lanes_[lane].leaf_taken();
  }
  return offered;
}

// What the other lanes offer to look up. Returns those that do.
template <bool nodes>
uint32_t Lanes::ask(Cache& cache, uint32_t but) {
  std::fill(cache.wanted.begin(), cache.wanted.end(), 0);
  uint32_t asking = 0;
  for (uint32_t lane = 0; lane < lanes_.size(); ++lane) {
    cache.offers[lane] = {};
    if ((but >> lane & 1) != 0) continue;
    cache.offers[lane] = nodes ? lanes_[lane].node_offers() : lanes_[lane].leaf_offers();
    for (const Lane::Want* const want : cache.offers[lane]) {
      if (want == nullptr) continue;
      asking |= 1u << lane;
      cache.wanted[cache.bank_of(want->line)] |= 1u << lane;
    }
  }
  return asking;
}

// Each bank chooses a line. Returns those that do.
uint32_t Lanes::choose_lines(Cache& cache) {
  uint32_t looking = 0;
  for (uint32_t bank = 0; bank < cache.banks.size(); ++bank) {
    const uint32_t wanted = cache.wanted[bank];
    if (wanted == 0 || cache.inputs[bank].fill || !cache.banks[bank].ready()) continue;
    looking |= 1u << bank;
    const uint32_t first = cache.lane_turns[bank].choose(wanted);
    cache.lane_turns[bank].advance(first);
    const Lane::Offers& offers = cache.offers[first];
    const bool is_first = offers[0] != nullptr && cache.bank_of(offers[0]->line) == bank;
    cache.chosen[bank] = offers[is_first ? 0 : 1]->line;
    cache.lookups[bank].line = cache.chosen[bank] >> cache.bank_bits;
    cache.lookups[bank].lanes = 0;
  }
  return looking;
}

// A lane asks two banks, and each chooses a line; then the lane takes one, if both have chosen its line.
template <bool nodes>
void Lanes::look_up(Cache& cache) {
  const uint32_t asking = ask<nodes>(cache, take_offers<nodes>(cache));
  const uint32_t looking = choose_lines(cache);
  for (uint32_t bits = asking; bits != 0; bits &= bits - 1) {
    const uint32_t lane = lowest(bits);
    const auto& offers = cache.offers[lane];
    const auto is_chosen = [&](const Lane::Want* want) {
      if (want == nullptr) return false;
      const uint32_t bank = cache.bank_of(want->line);
      return (looking >> bank & 1) != 0 && cache.chosen[bank] == want->line;
    };
    const auto* const place = std::find_if(offers.begin(), offers.end(), is_chosen);
    const Lane::Want* const taken = place == offers.end() ? nullptr : *place;
    if (taken != nullptr) {
      const uint32_t bank = cache.bank_of(taken->line);
      cache.inputs[bank].lookup = &cache.lookups[bank];
      if (!taken->prefetch) {
        cache.lookups[bank].lanes |= 1u << lane;
        cache.lookups[bank].slots[lane] = static_cast<uint8_t>(taken->slot);
      }
    }
    if (nodes) {
      lanes_[lane].node_offered(taken);
    } else {
      lanes_[lane].leaf_offered(cycle_, taken);
    }
  }
}

template <bool nodes>
void Lanes::give(Cache& cache) {
  for (const TreeCache& bank : cache.banks) {
    const TreeCache::Given& given = bank.given();
    for (uint32_t bits = given.lanes; bits != 0; bits &= bits - 1) {
      const uint32_t lane = lowest(bits);
      if (nodes) {
        lanes_[lane].node_given(cycle_, given.slots[lane]);
      } else {
        lanes_[lane].leaf_given(cycle_, given.slots[lane]);
      }
    }
  }
}

void Lanes::take_prepared() {
  while (setup_.valid(cycle_)) prepared_.push_back(setup_.take());
  if (prepared_.empty()) return;
  const uint32_t slot = prepared_.front();
  if (lanes_[slot / slots_a_lane_].prepared(cycle_, slot % slots_a_lane_)) prepared_.pop_front();
}

bool Lanes::request(Cache& cache, TreeMemory::Source source) {
  uint32_t banks = 0;
  for (uint32_t bank = 0; bank < cache.banks.size(); ++bank)
    banks |= (cache.banks[bank].request_valid() ? 1u : 0u) << bank;
  if (banks == 0) return false;
  const uint32_t bank = cache.request_turn.choose(banks);
  cache.request_turn.advance(bank);
  const TreeCache& asks = cache.banks[bank];
  cache.inputs[bank].request_taken = true;
  memory_.read(cycle_, source, asks.request_line() << cache.bank_bits | bank, bank << 8 | asks.request_id());
  return true;
}

bool Lanes::request_stacks() {
  uint32_t asking = 0;
  for (uint32_t lane = 0; lane < lanes_.size(); ++lane) asking |= (lanes_[lane].request_valid() ? 1u : 0u) << lane;
  if (asking == 0) return false;
  const uint32_t lane = stack_turn_.choose(asking);
  stack_turn_.advance(lane);
  const Lane::StackRequest request = lanes_[lane].take_request();
  memory_.serve_stack(cycle_, {lane * slots_a_lane_ + request.slot, request.write, request.block});
  return true;
}

// Nodes, triangles and stacks in rotation, one request in a cycle.
void Lanes::ask_memory() {
  for (uint32_t i = 0; i < 3; ++i) {
    const uint32_t source = (source_turn_ + i) % 3;
    const bool served = source == 0   ? request(nodes_, TreeMemory::Source::Nodes)
                        : source == 1 ? request(triangles_, TreeMemory::Source::Triangles)
                                      : request_stacks();
    if (!served) continue;
    source_turn_ = (source + 1) % 3;
    return;
  }
}

void Lanes::finish() {
  finished_ = finish_.valid(cycle_);
  if (finished_) {
    slot_ = finish_.take();
    lanes_[slot_ / slots_a_lane_].leave(slot_ % slots_a_lane_);
    work_.ray_cycles += (cycle_ - since_) * in_flight_--;
    since_ = cycle_;
  }
  uint32_t done = 0;
  for (uint32_t lane = 0; lane < lanes_.size(); ++lane) done |= (lanes_[lane].done_valid() ? 1u : 0u) << lane;
  if (done == 0) return;
  const uint32_t lane = done_turn_.choose(done);
  done_turn_.advance(lane);
  finish_.push(cycle_, lane * slots_a_lane_ + lanes_[lane].take_done(cycle_));
}

uint64_t Lanes::next() const { return in_flight_ == 0 ? kNever : cycle_ + 1; }

uint64_t Lanes::earliest_done(uint64_t now) const {
  uint64_t earliest = kNever;
  for (const Lane& lane : lanes_) earliest = std::min(earliest, lane.earliest_done(now));
  return earliest;
}

void Lanes::remember(const VisitList& places) {
  for (const Visit& place : places) {
    Cache& cache = place.triangles == 0 ? nodes_ : triangles_;
    const LineRange lines = lines_of(place);
    for (uint32_t line = lines.first; line < lines.first + lines.count; ++line)
      cache.banks[cache.bank_of(line)].remember(line >> cache.bank_bits);
  }
}

TraverserWork Lanes::work() const {
  TraverserWork work = work_;
  for (const Lane& lane : lanes_) lane.add_to(work);
  nodes_.add_to(work.node_cache);
  triangles_.add_to(work.triangle_cache);
  memory_.add_to(work);
  return work;
}

}  // namespace raypool::traverser
