#include "kernel/recorded.hpp"

#include <fmt/format.h>

#include "isa/input_error.hpp"
#include "machine/packages.hpp"

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

int RecordedKernel::word(int number, const Location& where) {
  check("ray word", number, kIntersectionWords, where);
  const int rd = recorder_.emit_value(Opcode::Rld, where);
  recorder_.last_op().word = number;
  return rd;
}

void RecordedKernel::write_word(int number, int value, const Location& where) {
  check("ray word", number, kIntersectionWords, where);
  Op& op = recorder_.emit(Opcode::Rst, where);
  op.rb = value;
  op.word = number;
}

}  // namespace raypool::kernel
