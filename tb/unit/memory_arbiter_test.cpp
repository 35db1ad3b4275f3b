// The memory arbiter: random traffic on both sides against a queue.
#include <gtest/gtest.h>
#include <verilated.h>

#include <deque>
#include <memory>
#include <random>

#include "Vmemory_arbiter_unit.h"

namespace raypool::bench {
namespace {

struct Request {
  bool write = false;
  uint32_t address = 0, mask = 0, id = 0;
  uint32_t data[4] = {};
};

TEST(MemoryArbiter, KeepsOrderPrefersInstructionsAndHoldsPayload) {
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    auto u = std::make_unique<Vmemory_arbiter_unit>();
    const auto clock = [&] {
      u->clk_i = 0;
      u->eval();
      u->clk_i = 1;
      u->eval();
    };
    u->rst_ni = 0;
    clock();
    u->rst_ni = 1;
    std::deque<Request> expected;
    Request data;
    uint32_t fetch = 0;
    bool data_waits = false, fetch_waits = false;
    int taken = 0, full_rate = 0;
    for (int i = 0; i < 4000; ++i) {
      const bool always = i >= 3000;  // full rate: everybody always
      if (!data_waits && (always || random() % 3)) {
        data_waits = true;
        data.write = random() % 2;
        data.address = static_cast<uint32_t>(random());
        data.mask = random() % 16;
        data.id = random() % 16;
        for (uint32_t& word : data.data) word = static_cast<uint32_t>(random());
      }
      if (!fetch_waits && random() % 8 == 0) {
        fetch_waits = true;
        fetch = static_cast<uint32_t>(random()) & ~63u;
      }
      u->data_request_valid_i = data_waits;
      u->data_request_write_i = data.write;
      u->data_request_address_i = data.address;
      u->data_request_mask_i = data.mask;
      u->data_request_id_i = data.id;
      for (int w = 0; w < 4; ++w) u->data_request_data_i[w] = data.data[w];
      u->instruction_request_valid_i = fetch_waits;
      u->instruction_request_address_i = fetch;
      u->request_ready_i = always || random() % 2;
      const uint32_t response = random() % 17;
      u->response_valid_i = random() % 2;
      u->response_id_i = response;
      u->clk_i = 0;
      u->eval();
      EXPECT_EQ(u->instruction_response_valid_o, u->response_valid_i && response == 16);
      EXPECT_EQ(u->data_response_valid_o, u->response_valid_i && response < 16);
      ASSERT_EQ(u->request_valid_o, !expected.empty());
      EXPECT_EQ(u->idle_o, expected.empty());
      if (!expected.empty()) {
        const Request& want = expected.front();
        ASSERT_EQ(u->request_write_o, want.write);
        ASSERT_EQ(u->request_address_o, want.address);
        if (!want.write) {
          ASSERT_EQ(u->request_id_o, want.id);
        } else {
          ASSERT_EQ(u->request_mask_o, want.mask);
          for (int w = 0; w < 4; ++w) ASSERT_EQ(u->request_data_o[w], want.data[w]);
        }
        if (u->request_ready_i) {
          expected.pop_front();
          ++taken;
          full_rate += always;
        }
      }
      const bool take_fetch = fetch_waits && u->instruction_request_ready_o;
      const bool take_data = data_waits && u->data_request_ready_o;
      ASSERT_FALSE(take_fetch && take_data);
      ASSERT_FALSE(take_data && fetch_waits) << "instructions first";
      if (take_fetch) {
        Request request;
        request.address = fetch;
        request.id = 16;
        expected.push_back(request);
        fetch_waits = false;
      }
      if (take_data) {
        expected.push_back(data);
        data_waits = false;
      }
      ASSERT_LE(expected.size(), 1u);
      u->clk_i = 1;
      u->eval();
    }
    EXPECT_GT(taken, 1500);
    EXPECT_GE(full_rate, 998) << "one request a cycle";
    u->final();
  }
}

}  // namespace
}  // namespace raypool::bench
