#include "chip/board_modules.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstring>

#include "chip/frame_setup.hpp"
#include "chip/module_tree.hpp"

namespace raypool {

namespace chip {

// ---- Frame buffer

FrameBufferModule::FrameBufferModule(const sc_core::sc_module_name& name, FrameSink& sink)
    : sc_module(name), sink_(sink) {
  socket.register_b_transport(this, &FrameBufferModule::b_transport);
}

void FrameBufferModule::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time&) {
  if (!payload.is_write() || payload.get_data_length() != kBeatBytes) {
    payload.set_response_status(tlm::TLM_COMMAND_ERROR_RESPONSE);
    return;
  }
  sink_.add(contribution_of(payload));
  payload.set_response_status(tlm::TLM_OK_RESPONSE);
}

FrameContribution contribution_of(const tlm::tlm_generic_payload& payload) {
  FrameContribution contribution;
  std::memcpy(&contribution.pixel, payload.get_data_ptr(), sizeof contribution.pixel);
  std::memcpy(contribution.rgb.data(), payload.get_data_ptr() + 4, sizeof contribution.rgb);
  return contribution;
}

// ---- Host

namespace {

void access(tlm::tlm_blocking_transport_if<>& chip, tlm::tlm_command command, uint32_t address, void* data,
            uint32_t bytes) {
  tlm::tlm_generic_payload payload;
  payload.set_command(command);
  payload.set_address(address);
  payload.set_data_ptr(static_cast<unsigned char*>(data));
  payload.set_data_length(bytes);
  payload.set_streaming_width(bytes);
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  chip.b_transport(payload, delay);
  if (payload.is_response_error()) {
    throw InputError(fmt::format("the chip answers {} to the host's {} of {} bytes at address 0x{:x}",
                                 payload.get_response_string(), payload.is_read() ? "read" : "write", bytes, address));
  }
}

}  // namespace

void write_registers(tlm::tlm_blocking_transport_if<>& chip, uint32_t address, const uint32_t* words, uint32_t count) {
  std::vector<uint32_t> data(words, words + count);
  access(chip, tlm::TLM_WRITE_COMMAND, address, data.data(), 4 * count);
}

uint32_t read_register(tlm::tlm_blocking_transport_if<>& chip, uint32_t address) {
  uint32_t word = 0;
  access(chip, tlm::TLM_READ_COMMAND, address, &word, sizeof word);
  return word;
}

HostModule::HostModule(const sc_core::sc_module_name& name, const FrameSetup& setup, FrameBegin begin)
    : sc_module(name), setup_(setup), begin_(begin) {
  SC_METHOD(start);
  sensitive << start_;
  dont_initialize();
  SC_METHOD(stop);
  sensitive << done.pos();
  dont_initialize();
}

void HostModule::start() {
  errors_.guard([this] {
    HostRegisters registers;
    registers.set(setup_);
    for (uint32_t address = host_register::kProgramLength; address < host_register::kBytes; address += 4) {
      const uint32_t word = registers.load(address);
      write_registers(*socket[0], address, &word, 1);
    }
    const uint32_t start = host_register::kStart | (begin_ == FrameBegin::Reset ? host_register::kReset : 0);
    write_registers(*socket[0], host_register::kControl, &start, 1);
  });
}

// ---- The board

SystemcBoard::SystemcBoard(const ChipOptions& options, ChipDevice& device, FrameBegin begin)
    : chip_("chip", options, device),
      memory_("memory", *options.memory, options.configuration.chip),
      frame_("frame", *options.frame),
      host_("host", frame_setup(options), begin) {
  chip_.memory.bind(memory_.socket);
  if (options.tree != nullptr) {
    tree_.emplace("tree", options.tree->memory, options.configuration.chip);
    chip_.tree.bind(tree_->socket);
  }
  chip_.frame.bind(frame_.socket);
  host_.socket.bind(chip_.host);
  chip_.done.bind(done_);
  host_.done.bind(done_);
}

ChipResult SystemcBoard::draw() {
  simulation_.run();
  host_.rethrow();
  return chip_.result();
}

}  // namespace chip

ChipResult run_chip(const ChipOptions& options, ChipDevice& chip, FrameBegin begin) {
  const auto begun = std::chrono::steady_clock::now();
  if (options.memory == nullptr || options.frame == nullptr) throw std::logic_error("a frame needs memory and frame");
  ChipResult result = chip::SystemcBoard(options, chip, begin).draw();
  result.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return result;
}

std::string chip_modules(const ChipOptions& options, ChipDevice& chip) {
  const chip::SystemcBoard board(options, chip);
  return chip::module_tree();
}

}  // namespace raypool
