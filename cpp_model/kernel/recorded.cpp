#include "kernel/recorded.hpp"

#include <fmt/format.h>

#include "isa/input_error.hpp"
#include "machine/common/packages.hpp"

namespace raypool::kernel {
namespace {

void check(const char* what, int number, int count, const Location& where) {
  if (number >= 0 && number < count) return;
  throw InputError(fmt::format("{}: there is no {} {}; they are 0 to {}", to_string(where), what, number, count - 1));
}

}  // namespace

int RecordedKernel::argument(int number, const Location& where) {
  check("kernel argument", number, kArguments, where);
  const int rd = recorder_.emit_value(Opcode::Arg, where);
  recorder_.last_op().immediate = static_cast<uint32_t>(number);
  return rd;
}

int RecordedKernel::load(const Int& address, int offset, const Location& where) {
  const int rd = recorder_.emit_unary(Opcode::Ld, address.number(), where);
  recorder_.last_op().immediate = static_cast<uint32_t>(offset);
  return rd;
}

void RecordedKernel::store_number(const Int& address, int offset, int value, const Location& where) {
  Op& op = recorder_.emit(Opcode::St, where);
  op.ra = address.number();
  op.rb = value;
  op.immediate = static_cast<uint32_t>(offset);
}

void RecordedKernel::invalidate(const Int& address, int offset, const Location& where) {
  Op& op = recorder_.emit(Opcode::Inval, where);
  op.ra = address.number();
  op.immediate = static_cast<uint32_t>(offset);
}

// Requests of a unit reach the memory in their order: what is read there is answered behind the stores.
void RecordedKernel::wait_for_stores(const Int& address, int offset, const Location& where) {
  invalidate(address, offset, where);
  load(address, offset, where);
  recorder_.last_op().fence = true;
}

// A ray's words are exported from their own places, whatever is imported there.
uint8_t RecordedKernel::place(int number, const Location& where) const {
  check("ray word", number, kIntersectionWords, where);
  const uint8_t place = number < kRayWords ? static_cast<uint8_t>(number) : layout_.place[number];
  if (place == RecordLayout::kAbsent)
    throw InputError(fmt::format("{}: ray word {} is not in the compact record", to_string(where), number));
  return place;
}

int RecordedKernel::word(int number, const Location& where) {
  const uint8_t at = place(number, where);
  const int rd = recorder_.emit_value(Opcode::Rld, where);
  recorder_.last_op().word = at;
  return rd;
}

void RecordedKernel::write_word(int number, int value, const Location& where) {
  const uint8_t at = place(number, where);
  Op& op = recorder_.emit(Opcode::Rst, where);
  op.rb = value;
  op.word = at;
}

}  // namespace raypool::kernel
