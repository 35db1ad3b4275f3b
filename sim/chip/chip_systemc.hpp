// The chip as one SystemC module, with TLM-2.0 sockets for both memories, the frame buffer and the host: the loop of
// board.hpp with sockets, around the C++ model of the chip, the Verilated rtl/chip/rp_chip.v, or both in lockstep.
// docs/machine/board.md has the protocols, and an example.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <optional>
#include <systemc>

#include "chip/board.hpp"
#include "chip/external_traverser.hpp"
#include "chip/host_registers.hpp"
#include "chip/local_time.hpp"
#include "chip/memory_transport.hpp"

namespace raypool::chip {

inline constexpr unsigned kHostBits = 32;  ///< width of the host's socket

/// A traverser at the chip's ports, for the port `traverser` of ChipModule.
class ExternalTraverserIf : public virtual sc_core::sc_interface, public ExternalTraverser {};

/// In a simulation (simulation.hpp) of its own. Temporally decoupled: it runs ahead of SystemC's time up to the next
/// event, so whatever the other modules do they find it in the cycle that begins at SystemC's time.
class ChipModule : public sc_core::sc_module, private LineStore, private FrameSink {
 public:
  SC_HAS_PROCESS(ChipModule);
  /// What the options point to, and `chip`, must outlive the module; a frame's setup comes from the host, and
  /// contributions go to the socket, whatever the options hold. An answer of a memory may take some hundred times
  /// `chip.memory.latency` of the configuration (AnswerWatch).
  ChipModule(const sc_core::sc_module_name& name, const ChipOptions& options, ChipDevice& chip);

  tlm_utils::simple_initiator_socket<ChipModule, kMemoryBits> memory{"memory"};  ///< of the units
  /// Of the traverser; unbound where it asks for nothing.
  tlm_utils::simple_initiator_socket_optional<ChipModule, kMemoryBits> tree{"tree"};
  /// Contributions: writes of 16 bytes, pixel (x in bits 15:0, y in bits 31:16) and three floats, to be added to that
  /// pixel, at address 16 * pixel.
  tlm_utils::simple_initiator_socket<ChipModule, kMemoryBits> frame{"frame"};
  tlm_utils::simple_target_socket<ChipModule, kHostBits> host{"host"};  ///< registers: host_registers.hpp
  /// One of the user's own, of a chip without one inside; unbound: that of the options.
  sc_core::sc_port<ExternalTraverserIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> traverser{"traverser"};
  /// An interrupt: true from when a frame is done, as host_register::kDone, until the next one starts.
  sc_core::sc_port<sc_core::sc_signal_write_if<bool>, 1, sc_core::SC_ZERO_OR_MORE_BOUND> done{"done"};

  /// Of the frame that was started last, once the simulation has ended; without the time that it took. Throws what
  /// ended the simulation: what run_board() throws, InputError if a memory or the frame buffer refused an access;
  /// ChipStalled if it ended before the frame did.
  ChipResult result();

 private:
  void run();
  void clock_until_sync();
  void start();
  void finish();
  void access(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);
  bool control(uint32_t word, const sc_core::sc_time& delay);
  uint32_t status();
  /// The frame may be left: all that is counted is counted, and no answer of a memory is on its way.
  bool over() { return board_->ended() && chip_.outputs().ready; }

  uint64_t read(bool of_tree, uint32_t address, Line& line) override;
  void write(bool of_tree, const MemoryRequest& request) override;
  bool ready() override { return time_.cycle() >= frame_ready_from_; }
  void add(const FrameContribution& contribution) override;
  MemoryTransport::Target& of(bool of_tree);

  const ChipOptions options_;
  ChipDevice& chip_;
  HostRegisters registers_;
  LocalTime time_;
  ProcessErrors errors_;
  MemoryTransport memories_{"memory"}, frame_buffer_{"frame buffer"};
  sc_core::sc_event wake_;
  bool settled_ = false;        // others with an event at this time have had it
  uint64_t start_at_ = kNever;  // cycle
  FrameBegin begin_ = FrameBegin::Reset;
  uint64_t frame_ready_from_ = 0;  // cycle

  ChipOptions frame_options_;  // of the frame
  std::optional<Board> board_;
  bool running_ = false;
  std::optional<ChipResult> result_;
};

}  // namespace raypool::chip
