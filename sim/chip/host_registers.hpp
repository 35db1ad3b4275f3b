// The registers of the chip at its socket `host`: 32 bits each, little endian, at byte addresses that are multiples of
// 4. docs/machine/board.md has the table.
#pragma once

#include <array>
#include <cstdint>

#include "machine/chip/chip_device.hpp"

namespace raypool::chip {

namespace host_register {

inline constexpr uint32_t kControl = 0x000;  ///< write: kStart, or kStart and kReset
inline constexpr uint32_t kStatus = 0x004;   ///< read only: kBusy, kReady, kDone
inline constexpr uint32_t kProgramLength = 0x008;
inline constexpr uint32_t kMemoryLimit = 0x00c;
inline constexpr uint32_t kWidth = 0x010;
inline constexpr uint32_t kHeight = 0x014;
inline constexpr uint32_t kDepth = 0x018;
inline constexpr uint32_t kReflections = 0x01c;
inline constexpr uint32_t kEntries = 0x020;   ///< PCs by number of RayKernel
inline constexpr uint32_t kTreeRoot = 0x040;  ///< this and the next five: of TreeSetup
inline constexpr uint32_t kTreeLower = 0x044;
inline constexpr uint32_t kTreeUpper = 0x050;
inline constexpr uint32_t kTrianglesLine = 0x05c;
inline constexpr uint32_t kTriangleLines = 0x060;
inline constexpr uint32_t kStacksLine = 0x064;
inline constexpr uint32_t kMaterialBase = 0x068;
inline constexpr uint32_t kRecord = 0x080;     ///< of each place of an intersection its word; 31: zero
inline constexpr uint32_t kArguments = 0x100;  ///< of the kernels
inline constexpr uint32_t kBytes = kArguments + 4 * static_cast<uint32_t>(raypool::kArguments);

// Of kControl.
inline constexpr uint32_t kStart = 1 << 0;  ///< a frame begins, as the registers are now
inline constexpr uint32_t kReset = 1 << 1;  ///< after a reset of the chip
// Of kStatus.
inline constexpr uint32_t kBusy = 1 << 0;   ///< a frame is being drawn
inline constexpr uint32_t kReady = 1 << 1;  ///< the next one may begin without a reset
inline constexpr uint32_t kDone = 1 << 2;   ///< the last one is drawn, and its counts are final

}  // namespace host_register

/// What stays for a frame, as registers.
class HostRegisters {
 public:
  HostRegisters() { set({}); }

  /// `address`: a multiple of 4, below host_register::kBytes.
  uint32_t load(uint32_t address) const { return words_[address / 4]; }
  void store(uint32_t address, uint32_t word) { words_[address / 4] = word; }

  void set(const FrameSetup& setup);
  /// `record_words`: of an intersection (RecordLayout::words), which the chip is built for.
  FrameSetup setup(uint32_t record_words) const;

 private:
  std::array<uint32_t, host_register::kBytes / 4> words_{};
};

}  // namespace raypool::chip
