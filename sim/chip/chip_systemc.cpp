#include "chip/chip_systemc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "chip/frame_setup.hpp"

namespace raypool::chip {

ChipModule::ChipModule(const sc_core::sc_module_name& name, const ChipOptions& options, ChipDevice& chip)
    : sc_module(name), options_(options), chip_(chip) {
  host.register_b_transport(this, &ChipModule::access);
  SC_METHOD(run);
  sensitive << wake_;
  dont_initialize();
}

// ---- The clock

// A module with an event where a cycle begins acts before that cycle: all such events are triggered before a delta
// notification is.
void ChipModule::run() {
  settled_ = !settled_;
  if (settled_) {
    next_trigger(sc_core::SC_ZERO_TIME);
    return;
  }
  errors_.guard([this] { clock_until_sync(); });
}

void ChipModule::clock_until_sync() {
  time_.resume();
  // The cycle that begins now is due, whatever else happens at this time.
  bool goes_on = !time_.ahead() || !time_.need_sync();
  while (goes_on) {
    if (time_.cycle() >= start_at_) start();
    if (!running_ || over()) break;
    time_.advance(board_->clock(std::min(time_.left(), start_at_ - time_.cycle())));
    if (traverser.size() != 0) time_.compute_quantum();
    goes_on = !time_.need_sync();
  }
  // The interrupt comes when SystemC's time has followed.
  if (running_ && over() && !time_.ahead()) finish();
  const uint64_t next = running_ ? time_.cycle() : start_at_;
  if (next != kNever) wake_.notify(LocalTime::until(next));
}

void ChipModule::start() {
  start_at_ = kNever;
  const FrameSetup setup = registers_.setup(options_.layout.words);
  frame_options_ = options_;
  frame_options_.frame = this;
  frame_options_.width = setup.width;
  frame_options_.height = setup.height;
  frame_options_.depth = setup.depth;
  frame_options_.reflections = setup.reflections;
  frame_options_.entries = setup.entries;
  frame_options_.program_length = setup.program_length;
  if (traverser.size() != 0) frame_options_.traverser = traverser[0];
  LineStore& memories = *this;
  board_.emplace(frame_options_, setup, chip_, memories, begin_);
  running_ = true;
  if (done.size() != 0) done->write(false);
}

void ChipModule::finish() {
  running_ = false;
  result_ = board_->result();
  if (done.size() != 0) done->write(true);
}

ChipResult ChipModule::result() {
  errors_.rethrow();
  if (!board_) throw ChipStalled("the simulation has ended, and the host has started no frame");
  if (!result_ && board_->drawn()) return board_->result();
  if (!result_) throw ChipStalled(fmt::format("the simulation has ended before the frame, at cycle {}", time_.cycle()));
  return *result_;
}

// ---- The host

void ChipModule::access(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  const uint32_t length = payload.get_data_length();
  if (payload.get_byte_enable_ptr() != nullptr) {
    payload.set_response_status(tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
    return;
  }
  if (length == 0 || length % 4 != 0 || payload.get_streaming_width() < length) {
    payload.set_response_status(tlm::TLM_BURST_ERROR_RESPONSE);
    return;
  }
  const uint64_t end = host_register::kBytes;
  if (payload.get_address() % 4 != 0 || length > end || payload.get_address() > end - length) {
    payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    return;
  }
  payload.set_response_status(tlm::TLM_OK_RESPONSE);
  const auto first = static_cast<uint32_t>(payload.get_address());
  unsigned char* data = payload.get_data_ptr();
  for (uint32_t i = 0; i < length; i += 4) {
    const uint32_t address = first + i;
    uint32_t word = 0;
    if (payload.is_read()) {
      word = address == host_register::kStatus ? status() : registers_.load(address);
      std::memcpy(data + i, &word, 4);
      continue;
    }
    std::memcpy(&word, data + i, 4);
    if (address == host_register::kStatus || (address == host_register::kControl && !control(word, delay))) {
      payload.set_response_status(tlm::TLM_COMMAND_ERROR_RESPONSE);
      return;
    }
    if (address != host_register::kControl) registers_.store(address, word);
  }
}

// False: refused.
bool ChipModule::control(uint32_t word, const sc_core::sc_time& delay) {
  if ((word & host_register::kStart) == 0) return true;
  const bool reset = (word & host_register::kReset) != 0;
  if (!reset && (status() & host_register::kReady) == 0) return false;
  begin_ = reset ? FrameBegin::Reset : FrameBegin::Next;
  start_at_ = LocalTime::cycle_after(delay);
  result_.reset();
  wake_.notify(LocalTime::until(start_at_));
  return true;
}

uint32_t ChipModule::status() {
  const bool starts = start_at_ != kNever;
  const bool busy = starts || (running_ && !board_->drawn());
  return (busy ? host_register::kBusy : 0) | (!busy && chip_.outputs().ready ? host_register::kReady : 0) |
         (!starts && !running_ && result_ ? host_register::kDone : 0);
}

// ---- Memories and frame buffer

MemoryTransport::Target& ChipModule::of(bool of_tree) {
  if (!of_tree) return *memory[0];
  if (tree.size() == 0) throw std::logic_error("the traverser asks for memory, and nothing is bound to its socket");
  return *tree[0];
}

uint64_t ChipModule::read(bool of_tree, uint32_t address, Line& line) {
  sc_core::sc_time delay = LocalTime::until(time_.cycle());
  memories_.read(of(of_tree), address, line, delay);
  time_.compute_quantum();
  return LocalTime::cycle_after(delay) - time_.cycle();
}

// Posted: no block waits for its end.
void ChipModule::write(bool of_tree, const MemoryRequest& request) {
  sc_core::sc_time delay = LocalTime::until(time_.cycle());
  memories_.write(of(of_tree), request, delay);
  time_.compute_quantum();
}

void ChipModule::add(const FrameContribution& contribution) {
  sc_core::sc_time delay = LocalTime::until(time_.cycle());
  frame_buffer_.write(*frame[0], uint64_t{kBeatBytes} * contribution.pixel,
                      {contribution.pixel, contribution.rgb[0], contribution.rgb[1], contribution.rgb[2]}, delay);
  time_.compute_quantum();
  frame_ready_from_ = std::max(LocalTime::cycle_after(delay), time_.cycle() + 1);
}

}  // namespace raypool::chip
