// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/receive_filters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace cia402::can {
namespace {

using Identifiers = std::bitset<2048>;

/// As the kernel does for 11-bit identifiers (net/can/raw.c).
bool passes(const std::vector<ReceiveFilter>& filters, std::uint32_t id) {
  return filters.empty() || std::any_of(filters.begin(), filters.end(), [&](const auto& filter) {
           return !filter.extended && (id & filter.mask) == (filter.id & filter.mask);
         });
}

Identifiers range(std::size_t first, std::size_t last) {
  Identifiers identifiers;
  for (std::size_t id = first; id <= last; ++id) identifiers.set(id);
  return identifiers;
}

void expectExactly(const Identifiers& identifiers) {
  const auto filters = receiveFilters(identifiers);
  for (std::uint32_t id = 0; id < 2048; ++id) {
    ASSERT_EQ(passes(filters, id), identifiers[id]) << std::hex << id;
  }
}

TEST(ReceiveFilters, AreBlocksOfIdentifiers) {
  const auto filters = receiveFilters(range(0x080, 0x0FF) | range(0x7E4, 0x7E5) | range(0, 0));
  ASSERT_EQ(filters.size(), 3u);
  EXPECT_EQ(filters[0].id, 0x000u);
  EXPECT_EQ(filters[0].mask, 0x7FFu);
  EXPECT_EQ(filters[1].id, 0x080u);
  EXPECT_EQ(filters[1].mask, 0x780u);
  EXPECT_EQ(filters[2].id, 0x7E4u);
  EXPECT_EQ(filters[2].mask, 0x7FEu);
}

TEST(ReceiveFilters, CutARangeThatIsNoBlock) {
  expectExactly(range(0x580, 0x67F));
  EXPECT_EQ(receiveFilters(range(0x580, 0x67F)).size(), 2u) << "580h-5FFh, 600h-67Fh";
  expectExactly(range(0x181, 0x1A0));
  EXPECT_EQ(receiveFilters(range(0x181, 0x1A0)).size(), 6u) << "181, 182, 184, 188, 190, 1A0";
}

TEST(ReceiveFilters, OfAllIdentifiersAreNone) {
  EXPECT_TRUE(receiveFilters(Identifiers().set()).empty());
}

TEST(ReceiveFilters, OfAnyFewIdentifiersAreExact) {
  std::mt19937 random(5);
  for (int run = 0; run < 200; ++run) {
    Identifiers identifiers;
    for (int i = 0; i < 400; ++i) identifiers.set(random() % 2048);
    expectExactly(identifiers);
  }
}

TEST(ReceiveFilters, AreNoMoreThanTheKernelTakes) {
  Identifiers every_other;
  for (std::size_t id = 0; id < 2048; id += 2) every_other.set(id);
  const auto filters = receiveFilters(every_other);
  EXPECT_LE(filters.size(), 512u);
  for (std::uint32_t id = 0; id < 2048; id += 2) EXPECT_TRUE(passes(filters, id));
  Identifiers scattered = every_other;
  for (std::size_t id = 0x600; id < 0x800; ++id) scattered.reset(id);
  const auto wide = receiveFilters(scattered);
  EXPECT_LE(wide.size(), 512u);
  EXPECT_FALSE(passes(wide, 0x700)) << "neighbours may pass, but not everything";
}

}  // namespace
}  // namespace cia402::can
