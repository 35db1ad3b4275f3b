// The memory arbiter: random traffic on both sides against a queue.
#include <gtest/gtest.h>
#include <verilated.h>

#include <deque>
#include <random>
#include <string>

#include "Vmemory_arbiter_unit.h"

namespace raypool::bench {
namespace {

struct Request {
  bool write = false;
  uint32_t address = 0, mask = 0, id = 0;
  uint32_t data[4] = {};
};

// Random requests of both sides, which wait until they are taken, and a queue of what the arbiter owes the memory.
class MemoryArbiterBench {
 public:
  explicit MemoryArbiterBench(uint32_t seed) : random_(seed) {
    unit_.rst_ni = 0;
    clock_edge();
    unit_.rst_ni = 1;
  }
  ~MemoryArbiterBench() { unit_.final(); }

  /// One cycle. `always`: data and the memory in every cycle.
  void clock(bool always) {
    request(always);
    show();
    unit_.request_ready_i = always || random_() % 2;
    const uint32_t response = random_() % 17;
    unit_.response_valid_i = random_() % 2;
    unit_.response_id_i = response;
    unit_.clk_i = 0;
    unit_.eval();
    EXPECT_EQ(unit_.instruction_response_valid_o, unit_.response_valid_i && response == 16);
    EXPECT_EQ(unit_.data_response_valid_o, unit_.response_valid_i && response < 16);
    ASSERT_NO_FATAL_FAILURE(check_request());
    ASSERT_NO_FATAL_FAILURE(check_taken());
    unit_.clk_i = 1;
    unit_.eval();
  }
  int sent() const { return sent_; }  ///< requests that the memory has taken

 private:
  void clock_edge() {
    unit_.clk_i = 0;
    unit_.eval();
    unit_.clk_i = 1;
    unit_.eval();
  }
  void request(bool always) {
    if (!data_waits_ && (always || random_() % 3)) {
      data_waits_ = true;
      data_.write = random_() % 2;
      data_.address = static_cast<uint32_t>(random_());
      data_.mask = random_() % 16;
      data_.id = random_() % 16;
      for (uint32_t& word : data_.data) word = static_cast<uint32_t>(random_());
    }
    if (!fetch_waits_ && random_() % 8 == 0) {
      fetch_waits_ = true;
      fetch_ = static_cast<uint32_t>(random_()) & ~63u;
    }
  }
  void show() {
    unit_.data_request_valid_i = data_waits_;
    unit_.data_request_write_i = data_.write;
    unit_.data_request_address_i = data_.address;
    unit_.data_request_mask_i = data_.mask;
    unit_.data_request_id_i = data_.id;
    for (int w = 0; w < 4; ++w) unit_.data_request_data_i[w] = data_.data[w];
    unit_.instruction_request_valid_i = fetch_waits_;
    unit_.instruction_request_address_i = fetch_;
  }
  void check_request() {
    ASSERT_EQ(unit_.request_valid_o, !expected_.empty());
    EXPECT_EQ(unit_.idle_o, expected_.empty());
    if (expected_.empty()) return;
    const Request& want = expected_.front();
    ASSERT_EQ(unit_.request_write_o, want.write);
    ASSERT_EQ(unit_.request_address_o, want.address);
    if (!want.write) {
      ASSERT_EQ(unit_.request_id_o, want.id);
    } else {
      ASSERT_EQ(unit_.request_mask_o, want.mask);
      for (int w = 0; w < 4; ++w) ASSERT_EQ(unit_.request_data_o[w], want.data[w]);
    }
    if (!unit_.request_ready_i) return;
    expected_.pop_front();
    ++sent_;
  }
  void check_taken() {
    const bool take_fetch = fetch_waits_ && unit_.instruction_request_ready_o;
    const bool take_data = data_waits_ && unit_.data_request_ready_o;
    ASSERT_FALSE(take_fetch && take_data);
    ASSERT_FALSE(take_data && fetch_waits_) << "instructions first";
    if (take_fetch) {
      Request request;
      request.address = fetch_;
      request.id = 16;
      expected_.push_back(request);
      fetch_waits_ = false;
    }
    if (take_data) {
      expected_.push_back(data_);
      data_waits_ = false;
    }
    ASSERT_LE(expected_.size(), 1u);
  }

  Vmemory_arbiter_unit unit_;
  std::mt19937 random_;
  std::deque<Request> expected_;
  Request data_;
  uint32_t fetch_ = 0;
  bool data_waits_ = false, fetch_waits_ = false;
  int sent_ = 0;
};

TEST(MemoryArbiter, KeepsOrderPrefersInstructionsAndHoldsPayload) {
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    MemoryArbiterBench bench(seed);
    for (int i = 0; i < 3000; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(false));
    const int at_random = bench.sent();
    for (int i = 0; i < 1000; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(true));
    EXPECT_GT(bench.sent(), 1500);
    EXPECT_GE(bench.sent() - at_random, 998) << "one request a cycle";
  }
}

}  // namespace
}  // namespace raypool::bench
