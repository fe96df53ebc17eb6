// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Each answer to a single request counts once, with the time that it took.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canopen/sdo_client_fixture.h"

namespace cia402::canopen {
namespace {

using std::chrono::milliseconds;

class SdoCountersTest : public test::SdoClientFixture {
 protected:
  static SdoOptions block() {
    SdoOptions result = options();
    result.block = SdoOptions::Block::always;
    return result;
  }
  /// These answers come, each 10 ms after what it answers.
  void expectCounted(const std::vector<std::string>& answers) {
    client.tick(now);
    std::uint64_t count = client.counters().answers;
    Duration total = client.counters().total_latency;
    for (const std::string& answer : answers) {
      wait(10);
      receive(answer);
      EXPECT_EQ(client.counters().answers, ++count) << answer;
      EXPECT_EQ(client.counters().last_latency, milliseconds(10)) << answer;
      EXPECT_EQ(client.counters().total_latency, total += milliseconds(10)) << answer;
    }
    EXPECT_TRUE(client.idle());
  }
};

TEST_F(SdoCountersTest, of_reads) {
  client.upload({0x6041, 0});
  expectCounted({"581 4B 41 60 00 37 02 00 00"});
  client.upload({0x1008, 0});
  expectCounted({"581 41 08 10 00 0B 00 00 00", "581 00 53 65 72 76 6F 20 34",
                 "581 17 30 32 2D 58 00 00 00"});
}

TEST_F(SdoCountersTest, of_writes) {
  client.download({0x6060, 0}, {8});
  expectCounted({"581 60 60 60 00 00 00 00 00"});
  client.download({0x2000, 1}, {1, 2, 3, 4, 5, 6, 7, 8});
  expectCounted({"581 60 00 20 01 00 00 00 00", "581 20 00 00 00 00 00 00 00",
                 "581 30 00 00 00 00 00 00 00"});
}

TEST_F(SdoCountersTest, of_refusals) {
  client.upload({0x6041, 0});
  expectCounted({"581 80 41 60 00 00 00 02 06"});
}

TEST_F(SdoCountersTest, of_the_read_that_has_done_with_an_abandoned_transfer) {
  client.upload({0x6041, 0});
  client.tick(now);
  client.cancelAll("somebody stopped it");
  client.upload({0x6041, 0});
  expectCounted({"581 43 00 10 00 92 01 02 00", "581 4B 41 60 00 37 02 00 00"});
}

TEST_F(SdoCountersTest, of_block_transfers) {
  client.download({0x1F50, 1}, Bytes(20, 7), "", block());
  expectCounted({"581 A4 50 1F 01 7F 00 00 00", "581 A2 03 7F 00 00 00 00 00",
                 "581 A1 00 00 00 00 00 00 00"});
  client.upload({0x1008, 0}, "", block());
  client.tick(now);
  wait(30);
  receive("581 C2 08 10 00 0B 00 00 00");
  EXPECT_EQ(client.counters().answers, 4U);
  EXPECT_EQ(client.counters().last_latency, milliseconds(30));
}

TEST_F(SdoCountersTest, busy_is_the_time_of_transfers_not_that_between_them) {
  for (int i = 1; i <= 2; ++i) {
    client.upload({0x6041, 0});
    expectCounted({"581 4B 41 60 00 37 02 00 00"});
    EXPECT_EQ(client.counters().busy, i * milliseconds(10));
    now += milliseconds(1000);
  }
}

}  // namespace
}  // namespace cia402::canopen
