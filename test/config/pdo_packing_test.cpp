// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/pdo_packing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cia402::config {
namespace {

using testing::ElementsAre;

TEST(FrameBits, AreThoseOfTheStandard) {
  const double nominal[] = {47, 55, 63, 71, 79, 87, 95, 103, 111};
  const double worst[] = {55, 65, 75, 85, 95, 105, 115, 125, 135};
  for (unsigned bytes = 0; bytes <= 8; ++bytes) {
    EXPECT_EQ(frameBits(bytes).nominal, nominal[bytes]) << bytes;
    EXPECT_EQ(frameBits(bytes).worst, worst[bytes]) << bytes;
  }
}

TEST(PackPdos, PutsWhatFitsIntoOnePdo) {
  const auto packed = packPdos({{"controlword", 16, 1}, {"target", 32, 1}}, {});
  ASSERT_TRUE(packed);
  ASSERT_EQ(packed->size(), 1u);
  EXPECT_THAT(packed->front().items, ElementsAre("controlword", "target"));
  EXPECT_EQ(packed->front().number, 1u);
}

TEST(PackPdos, KeepsSlowObjectsOutOfFastPdos) {
  // In one PDO: 95 bits per cycle in the worst case; apart: 75 + 75 / 10.
  const auto packed = packPdos({{"fast", 16, 1}, {"slow", 16, 10}}, {});
  ASSERT_TRUE(packed);
  ASSERT_EQ(packed->size(), 2u);
  EXPECT_EQ(packed->at(0).every, 1u);
  EXPECT_EQ(packed->at(1).every, 10u);
}

TEST(PackPdos, SharesAPdoWhereThatIsCheaper) {
  // A byte more costs 10 bits per cycle, a frame of its own every second one 65 / 2.
  const auto packed = packPdos({{"fast", 16, 1}, {"second", 8, 2}}, {});
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->size(), 1u);
}

TEST(PackPdos, KeepsFastObjectsTogetherWhereTheWorstCaseIsTheSame) {
  // What may change in every cycle costs the same however it is packed, at worst; on the average
  // the two slow ones in a PDO of their own are the cheapest.
  PackRules rules;
  rules.pdos = 2;
  rules.may_change_every_cycle = true;
  const PackItem a{"a", 32, 1}, b{"b", 32, 1}, slow{"slow", 32, 10}, slower{"slower", 32, 20};
  for (const auto& items :
       {std::vector<PackItem>{a, slow, b, slower}, std::vector<PackItem>{slow, a, slower, b},
        std::vector<PackItem>{a, slow, slower, b}}) {
    const auto packed = packPdos(items, rules);
    ASSERT_TRUE(packed);
    ASSERT_EQ(packed->size(), 2u);
    EXPECT_EQ(packed->at(0).every + packed->at(1).every, 11u);  // 1 and 10
  }
}

TEST(PackPdos, FillsFurtherPdosOnlyWithinTheRules) {
  PackRules rules;
  rules.pdos = 1;
  EXPECT_FALSE(packPdos({{"a", 32, 1}, {"b", 32, 1}, {"c", 8, 1}}, rules));
  rules.pdos = 2;
  EXPECT_TRUE(packPdos({{"a", 32, 1}, {"b", 32, 1}, {"c", 8, 1}}, rules));
  rules.pdos = 1;
  rules.entries = 1;
  EXPECT_FALSE(packPdos({{"a", 8, 1}, {"b", 8, 1}}, rules));
  EXPECT_FALSE(packPdos({{"a", 65, 1}}, {}));
  std::vector<PackItem> wide = {{"a", 64, 1}, {"b", 64, 1}, {"c", 64, 1}, {"d", 64, 1}};
  EXPECT_TRUE(packPdos(wide, {}));
  wide.push_back({"e", 64, 1});
  EXPECT_FALSE(packPdos(wide, {})) << "there are four";
  std::vector<PackItem> bytes;
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) bytes.push_back({name, 7, 1});
  EXPECT_EQ(packPdos(bytes, {})->size(), 1u);
  bytes.push_back({"i", 7, 1});
  EXPECT_EQ(packPdos(bytes, {})->size(), 2u) << "63 bits, but nine objects";
}

TEST(PackPdos, ComesToAnEndWithManyObjects) {
  std::vector<PackItem> items;
  for (unsigned i = 0; i < 40; ++i)
    items.push_back({"o" + std::to_string(i), 8 + i % 9, 1 + i % 7});
  PackRules rules;
  rules.pdos = 16;
  EXPECT_TRUE(packPdos(items, rules));
  rules.pdos = 7;  // 40 objects of 12 bits on average: 7.5 PDOs
  EXPECT_FALSE(packPdos(items, rules));
}

TEST(PackPdos, UsesAFixedPdoThatCarriesWhatIsWanted) {
  PackRules rules;
  rules.fixed = {{1, {{"statusword", 16, 1}}}, {3, {{"statusword", 16, 1}, {"position", 32, 1}}}};
  const auto packed = packPdos({{"statusword", 16, 1}, {"position", 32, 1}, {"mode", 8, 1}}, rules);
  ASSERT_TRUE(packed);
  ASSERT_EQ(packed->size(), 1u) << "all three fit into a free one: 125 bits instead of 115 + 65";
  rules.pdos = 2;
  rules.entries = 2;
  rules.fixed = {{2, {{"statusword", 16, 1}, {"position", 32, 1}}}};
  const auto mixed = packPdos({{"statusword", 16, 1}, {"position", 32, 1}, {"mode", 8, 1}}, rules);
  ASSERT_TRUE(mixed);
  ASSERT_EQ(mixed->size(), 2u);
  EXPECT_THAT(mixed->at(0).items, ElementsAre("mode"));
  EXPECT_EQ(mixed->at(0).number, 1u);
  EXPECT_THAT(mixed->at(1).items, ElementsAre("statusword", "position"));
}

TEST(PackPdos, AFixedPdoCostsItsFrameAndNoBitMore) {
  // 6 bytes in every cycle, 115 bits, are cheaper than 75 and, every second cycle, 95; 7 would not
  // be. The drive lets one object be mapped into a PDO, its own carries two.
  PackRules rules;
  rules.entries = 1;
  rules.fixed = {{2, {{"statusword", 16, 1}, {"position", 32, 2}}}};
  const auto packed = packPdos({{"statusword", 16, 1}, {"position", 32, 2}}, rules);
  ASSERT_TRUE(packed);
  ASSERT_EQ(packed->size(), 1u);
  EXPECT_EQ(packed->front().number, 2u);
  EXPECT_EQ(packed->front().every, 1u);
}

TEST(PackPdos, CannotPutAnythingElseIntoAFixedPdo) {
  PackRules rules;
  rules.pdos = 1;
  rules.fixed = {{1, {{"statusword", 16, 1}}}};
  EXPECT_TRUE(packPdos({{"statusword", 16, 1}}, rules));
  EXPECT_FALSE(packPdos({{"statusword", 16, 1}, {"position", 32, 1}}, rules));
}

}  // namespace
}  // namespace cia402::config
