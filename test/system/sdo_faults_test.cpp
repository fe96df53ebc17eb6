// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The SDO client against the simulated server on a bus that loses, repeats and delays frames: a
// transfer ends correctly or fails and says why, and never brings wrong data.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tools/sdo_bus.h"

namespace cia402 {
namespace {

using canopen::SdoOptions;
using canopen::SdoTicket;
using fieldbus::Bytes;
using fieldbus::ObjectId;
using fieldbus::Transfer;
using std::chrono::milliseconds;

struct Kind {
  const char* name;
  ObjectId object;
  std::size_t size;
  SdoOptions::Block block;
};
constexpr Kind kKinds[] = {{"expedited", {0x2000, 0}, 4, SdoOptions::Block::never},
                           {"segmented", {0x2001, 0}, 60, SdoOptions::Block::never},
                           {"block", {0x2002, 0}, 3000, SdoOptions::Block::always},
                           {"short block", {0x2003, 0}, 200, SdoOptions::Block::always}};
constexpr std::size_t kKindCount = 4;
// No segment is ever repeated, so long transfers seldom survive; 143 and 14,286 segments.
constexpr Kind kThousand = {"segmented 1,000", {0x2004, 0}, 1000, SdoOptions::Block::never};
constexpr Kind kHundredThousand = {
    "segmented 100,000", {0x2005, 0}, 100'000, SdoOptions::Block::never};

/// Codes that tell a disturbed transfer, not a refused one.
bool tellsDisturbance(std::uint32_t code) {
  return code == 0x05030000 || (code >= 0x05040000 && code <= 0x05040004) || code == 0x06070010 ||
         code == 0x06070012 || code == 0x06070013;
}

class SdoFaults {
 public:
  explicit SdoFaults(double rate, std::uint64_t seed) : bus(options(), seed), random(seed) {
    bus.addNumber({0x2000, 0}, 0);
    for (std::size_t i = 1; i < kKindCount; ++i) {
      bus.addDomain(kKinds[i].object, Bytes(kKinds[i].size));
    }
    for (const Kind& kind : {kThousand, kHundredThousand}) {
      bus.addDomain(kind.object, Bytes(kind.size));
    }
    sim::DeviceBehaviour& behaviour = bus.device().behaviour();
    behaviour.sdo_block_crc = seed % 4 != 0;
    behaviour.upload_without_size = seed % 3 == 0;
    behaviour.sdo_block_size = seed % 5 == 0 ? 20 : 127;
    behaviour.sdo_block_size_varies = seed % 7 == 0;
    bus.start();
    sim::FaultRates rates;
    rates.loss = rates.duplicate = rates.delay = rate;
    rates.longest_delay = milliseconds(3);
    bus.bus().faults().setRates(rates);
  }

  void writeAndRead(const Kind& kind) {
    Bytes data(kind.size);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    const Bytes before = held(kind);
    const SdoTicket written = run(bus.client().download(kind.object, data, "", options(kind)));
    if (written->ok()) {
      EXPECT_EQ(held(kind), data) << kind.name << " write";
      ++writes;
    } else {
      EXPECT_TRUE(held(kind) == data || held(kind) == before) << kind.name;
    }
    const SdoTicket read = run(bus.client().upload(kind.object, "", options(kind)));
    if (!read->ok()) return;
    EXPECT_EQ(read->data(), held(kind)) << kind.name << " read";
    ++reads;
  }

  tools::SdoBus bus;
  std::mt19937_64 random;
  int writes = 0, reads = 0;

 private:
  static SdoOptions options() {
    SdoOptions result;
    result.timeout = milliseconds(20);
    result.retries = 2;
    return result;
  }
  static SdoOptions options(const Kind& kind) {
    SdoOptions result = options();
    result.block = kind.block;
    return result;
  }
  Bytes held(const Kind& kind) {
    const sim::Entry& entry = *bus.dictionary().find(kind.object);
    if (kind.size > 4) return entry.bytes;
    return fieldbus::toBytes(entry.number, 4);
  }
  SdoTicket run(SdoTicket ticket) {
    bus.finish(ticket, std::chrono::seconds(20));
    EXPECT_TRUE(ticket->done()) << "endless";
    if (ticket->done() && !ticket->ok()) {
      EXPECT_TRUE(tellsDisturbance(ticket->abortCode())) << ticket->message();
      EXPECT_NE(ticket->reason(), "");
    }
    return ticket;
  }
};

class SdoFaultsTest : public ::testing::TestWithParam<double> {};

TEST_P(SdoFaultsTest, transfers_end_correctly_or_say_why_not_and_never_bring_wrong_data) {
  constexpr std::uint64_t kSeeds = 300;
  int writes[kKindCount] = {}, reads[kKindCount] = {};
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SdoFaults world(GetParam(), seed);
    for (int round = 0; round < 3; ++round) {
      for (std::size_t i = 0; i < kKindCount; ++i) {
        world.writes = world.reads = 0;
        world.writeAndRead(kKinds[i]);
        writes[i] += world.writes;
        reads[i] += world.reads;
      }
    }
    // On a bus that is well again everything works at once.
    world.bus.bus().faults().clear();
    world.bus.run(std::chrono::seconds(1));
    world.writes = world.reads = 0;
    for (const Kind& kind : kKinds) world.writeAndRead(kind);
    EXPECT_EQ(world.writes, 4);
    EXPECT_EQ(world.reads, 4);
    if (::testing::Test::HasFailure()) return;
  }
  for (std::size_t i = 0; i < kKindCount; ++i) {
    RecordProperty(std::string(kKinds[i].name) + "_writes", writes[i]);
    RecordProperty(std::string(kKinds[i].name) + "_reads", reads[i]);
    if (GetParam() > 0.05 && kKinds[i].size > 1000) continue;  // 430 segments: hardly ever
    EXPECT_GT(writes[i], 0) << kKinds[i].name;
    EXPECT_GT(reads[i], 0) << kKinds[i].name;
  }
}

/// How often `kind` was written and read in `rounds` rounds at this rate of disturbances.
struct Survivors {
  int writes = 0, reads = 0;
};
Survivors survivors(const Kind& kind, double rate, std::uint64_t rounds) {
  Survivors survivors;
  for (std::uint64_t seed = 1; seed <= rounds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SdoFaults world(rate, seed);
    world.writeAndRead(kind);
    survivors.writes += world.writes;
    survivors.reads += world.reads;
  }
  return survivors;
}

TEST(SdoLongSegmentedTest, of_1000_bytes_some_survive_where_one_frame_in_a_hundred_is_disturbed) {
  const Survivors some = survivors(kThousand, 0.01, 100);
  EXPECT_GT(some.writes, 0);
  EXPECT_GT(some.reads, 0);
}

TEST(SdoLongSegmentedTest, of_1000_bytes_none_survives_one_in_ten_and_none_is_wrong) {
  const Survivors none = survivors(kThousand, 0.1, 100);  // 0.81 to the power of 143
  EXPECT_EQ(none.writes, 0);
  EXPECT_EQ(none.reads, 0);
}

TEST(SdoLongSegmentedTest, of_100000_bytes_none_survives_one_in_a_hundred_and_none_is_wrong) {
  for (const double rate : {0.01, 0.1}) {
    const Survivors none = survivors(kHundredThousand, rate, 30);
    EXPECT_EQ(none.writes, 0) << rate;
    EXPECT_EQ(none.reads, 0) << rate;
  }
}

TEST(SdoLongSegmentedTest, of_100000_bytes_most_survive_one_in_a_million) {
  const Survivors most = survivors(kHundredThousand, 1e-6, 10);  // 28,574 frames each
  EXPECT_GE(most.writes, 8);
  EXPECT_GE(most.reads, 8);
}

INSTANTIATE_TEST_SUITE_P(Rates, SdoFaultsTest, ::testing::Values(0.01, 0.1));

}  // namespace
}  // namespace cia402
