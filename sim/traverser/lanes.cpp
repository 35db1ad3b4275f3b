#include "traverser/lanes.hpp"

#include <algorithm>

#include "bits.hpp"

namespace raypool::traverser {

namespace {

constexpr uint32_t kLineBytes = 64;
constexpr uint64_t kCacheLatency = 2;

// As many banks as have a set at least.
TreeBanks::Sizes sizes(uint32_t lines, uint32_t ways, uint32_t mshrs, uint32_t most_banks, uint32_t lanes) {
  const uint32_t banks = std::min(most_banks, std::max(1u, lines / ways));
  return {lanes, lines, ways, banks * std::clamp(mshrs / banks, 1u, TreeCache::kMostMshrs), banks};
}

}  // namespace

Lanes::Cache::Cache(uint32_t lines, uint32_t ways, uint32_t mshrs, uint32_t most_banks, uint32_t lanes)
    : banks(sizes(lines, ways, mshrs, most_banks, lanes)), offers(lanes) {}

void Lanes::Cache::add_to(CacheWork& work) const {
  for (const TreeCache& bank : banks.banks()) {
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
    cache->banks.clock(cache->request_taken);
    cache->request_taken = false;
    cache->fill = TreeBanks::kNone;
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
  cache.fill = line.which;
  if (cache.banks.fill_ready(cache.fill)) memory_.take();
}

// Lanes for which there are lines for which a ray has waited ask for none themselves.
template <bool nodes>
void Lanes::look_up(Cache& cache) {
  const uint32_t waited = cache.banks.waited();
  uint32_t asking = 0, room = 0;
  for (uint32_t lane = 0; lane < lanes_.size(); ++lane) {
    if ((waited >> lane & 1) != 0) {
      room |= (nodes || lanes_[lane].leaf_room() ? 1u : 0u) << lane;
      continue;
    }
    cache.offers[lane] = nodes ? lanes_[lane].node_offers() : lanes_[lane].leaf_offers();
    cache.wants[lane] = &cache.wanted[lane];
    for (uint32_t i = 0; i < cache.offers[lane].size(); ++i) {
      const Lane::Want* const want = cache.offers[lane][i];
      cache.wanted[lane][i].valid = want != nullptr;
      if (want == nullptr) continue;
      cache.wanted[lane][i] = {true, want->prefetch, static_cast<uint8_t>(want->slot), want->line};
      asking |= 1u << lane;
    }
  }
  cache.banks.choose(cache.wants, asking, room, cache.fill);
  for (uint32_t bits = nodes ? 0 : waited & room; bits != 0; bits &= bits - 1) lanes_[lowest(bits)].leaf_taken();
  for (uint32_t bits = asking; bits != 0; bits &= bits - 1) {
    const uint32_t lane = lowest(bits);
    const uint32_t offer = cache.banks.taken(lane);
    const Lane::Want* const taken = offer == 0 ? nullptr : cache.offers[lane][offer >> 1];
    if (nodes) {
      lanes_[lane].node_offered(taken);
    } else {
      lanes_[lane].leaf_offered(cycle_, taken);
    }
  }
}

template <bool nodes>
void Lanes::give(Cache& cache) {
  for (uint32_t bits = cache.banks.given_lanes(); bits != 0; bits &= bits - 1) {
    const uint32_t lane = lowest(bits);
    if (nodes) {
      lanes_[lane].node_given(cycle_, cache.banks.given(lane).slot);
    } else {
      lanes_[lane].leaf_given(cycle_, cache.banks.given(lane).slot);
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
  if (!cache.banks.request_valid()) return false;
  cache.request_taken = true;
  memory_.read(cycle_, source, cache.banks.request_line(), cache.banks.request_id());
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
    for (uint32_t line = lines.first; line < lines.first + lines.count; ++line) cache.banks.remember(line);
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
