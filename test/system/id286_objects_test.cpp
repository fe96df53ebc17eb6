// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The objects of the iD286-CNFA with length, access, range and factory's number as its manual
// prints them [L1340-1599], against its simulated drive.
#include "system/families_faults.h"

namespace cia402 {
namespace {

constexpr std::int64_t kOpen = -9000000000;  // not printed

struct PrintedObject {
  fieldbus::ObjectId id;
  unsigned bytes;
  bool writable;
  std::int64_t low, high, factory;
};

constexpr PrintedObject kPrinted[] = {{{0x2064, 0}, 2, false, 0, 65535, kOpen},
                                      {{0x2065, 0}, 2, false, 0, 65535, kOpen},
                                      {{0x206C, 0}, 2, false, 0, 65535, kOpen},
                                      {{0x206D, 0}, 2, false, 0, 65535, kOpen},
                                      {{0x206E, 0}, 2, false, 0, 65535, kOpen},
                                      {{0x206F, 0}, 2, false, 0, 65535, kOpen},
                                      {{0x207E, 0}, 2, false, 0, 65535, kOpen},
                                      {{0x20C8, 0}, 2, true, 50, 30000, 800},
                                      {{0x20C9, 0}, 2, true, 0, 3, 0},
                                      {{0x20CE, 0}, 2, true, 0, 5, 0},
                                      {{0x20D5, 0}, 2, true, 10, 120, 50},
                                      {{0x20D7, 0}, 2, true, 50, 30000, 800},
                                      {{0x20D9, 0}, 2, true, 0, 2, 0},
                                      {{0x20DE, 0}, 2, true, 50, 30000, 800},
                                      {{0x20E0, 0}, 2, true, 0, 500, 50},
                                      {{0x20E1, 0}, 2, true, 1000, 2000, 1000},
                                      {{0x20E4, 0}, 2, true, 50, 30000, 800},
                                      {{0x20F1, 0}, 2, true, 0, 6500, 1000},
                                      {{0x20F2, 0}, 4, true, 0, 4294967295, 10000},
                                      {{0x20F5, 0}, 2, true, 0, 65535, 200},
                                      {{0x20F6, 0}, 2, true, 200, 65535, 10000},
                                      {{0x20F7, 0}, 2, true, 1, 1000, 5},
                                      {{0x20F8, 0}, 2, true, 0, 1000, 500},
                                      {{0x20FB, 0}, 2, true, 0, 30000, 1000},
                                      {{0x20FC, 0}, 2, true, 0, 30000, 50},
                                      {{0x20FD, 0}, 2, true, 0, 30000, 0},
                                      {{0x20FF, 0}, 2, true, 0, 30000, 500},
                                      {{0x2100, 0}, 2, true, 0, 30000, 1000},
                                      {{0x2101, 0}, 2, true, 0, 30000, 0},
                                      {{0x2102, 0}, 2, true, 1, 30000, 1000},
                                      {{0x2127, 0}, 2, true, 0, 1, kOpen},
                                      {{0x2190, 1}, 2, true, 0, 23, 0},
                                      {{0x2190, 2}, 2, true, 0, 23, 0},
                                      {{0x2190, 3}, 2, true, 0, 23, 0},
                                      {{0x2190, 4}, 2, true, 0, 23, 0},
                                      {{0x2190, 5}, 2, true, 0, 23, 0},
                                      {{0x2190, 6}, 2, true, 0, 23, 0},
                                      {{0x2190, 7}, 2, true, 0, 23, 0},
                                      {{0x2190, 8}, 2, true, 0, 23, 0},
                                      {{0x21A4, 1}, 2, true, 100, 109, 101},
                                      {{0x21A4, 2}, 2, true, 100, 109, 100},
                                      {{0x21A4, 3}, 2, true, 100, 109, 100},
                                      {{0x21A4, 4}, 2, true, 100, 109, 100},
                                      {{0x21A4, 5}, 2, true, 100, 109, 100},
                                      {{0x21AD, 0}, 2, true, 0, 65535, kOpen},
                                      {{0x21AE, 0}, 2, true, 0, 256, kOpen},
                                      {{0x603F, 0}, 2, false, 0, 65535, 0},
                                      {{0x6040, 0}, 2, true, 0, 65535, 0},
                                      {{0x6041, 0}, 2, false, 0, 65535, 0},
                                      {{0x605A, 0}, 2, true, 0, 65535, 0},
                                      {{0x6060, 0}, 1, true, kOpen, kOpen, 1},
                                      {{0x6061, 0}, 1, false, kOpen, kOpen, 0},
                                      {{0x6064, 0}, 4, false, -2147483647, 2147483647, 0},
                                      {{0x606C, 0}, 4, false, -2147483647, 2147483647, 0},
                                      {{0x6071, 0}, 2, true, 0, 120, 100},
                                      {{0x6074, 0}, 2, false, 0, 65535, 0},
                                      {{0x6077, 0}, 2, false, -32767, 32767, 0},
                                      {{0x607A, 0}, 4, true, -2147483647, 2147483647, 0},
                                      {{0x607C, 0}, 4, true, -2147483647, 2147483647, 0},
                                      {{0x607D, 1}, 4, true, -2000000000, 2000000000, -2000000000},
                                      {{0x607D, 2}, 4, true, -2000000000, 2000000000, 2000000000},
                                      {{0x6080, 0}, 4, true, -2147483647, 2147483647, 3000},
                                      {{0x6081, 0}, 4, true, -2147483647, 2147483647, 50000},
                                      {{0x6082, 0}, 4, true, kOpen, kOpen, kOpen},
                                      {{0x6083, 0}, 4, true, -2147483647, 2147483647, 4000},
                                      {{0x6084, 0}, 4, true, -2147483647, 2147483647, 4000},
                                      {{0x6085, 0}, 4, true, -2147483647, 2147483647, 40000000},
                                      {{0x6087, 0}, 4, true, 0, 4294967295, kOpen},
                                      {{0x6098, 0}, 1, true, 0, 100, 21},
                                      {{0x6099, 1}, 4, true, -2147483647, 2147483647, 50000},
                                      {{0x6099, 2}, 4, true, kOpen, kOpen, kOpen},
                                      {{0x609A, 0}, 4, true, -2147483647, 2147483647, 25000},
                                      {{0x60B0, 0}, 4, true, kOpen, kOpen, kOpen},
                                      {{0x60FD, 0}, 4, false, 0, 4294967295, 0},
                                      {{0x60FE, 1}, 4, true, 0, 4294967295, 0},
                                      {{0x60FE, 2}, 4, true, 0, 4294967295, 0},
                                      {{0x60FF, 0}, 4, true, kOpen, kOpen, kOpen},
                                      {{0x6502, 0}, 4, false, 0, 4294967295, 165}};

std::int64_t numberOf(const sim::Entry& entry) {
  return fieldbus::isSigned(entry.type) ? sim::asSigned(entry)
                                        : static_cast<std::int64_t>(entry.number);
}

TEST(Id286Objects, AreThoseOfTheManual) {
  const auto definition = familyDefinition(kId286Cnfa);
  const sim::ObjectDictionary dictionary = definition->dictionary.build(canopen::NodeId{1});
  for (const PrintedObject& printed : kPrinted) {
    const std::string name = fieldbus::toString(printed.id);
    const sim::Entry* entry = dictionary.find(printed.id);
    ASSERT_NE(entry, nullptr) << name;
    EXPECT_EQ(fieldbus::sizeBits(entry->type), 8 * printed.bytes) << name;
    EXPECT_EQ(entry->access == sim::Access::rw, printed.writable) << name;
    if (printed.factory != kOpen) {
      EXPECT_EQ(numberOf(*entry), printed.factory) << name;
    }
    if (!printed.writable || printed.low == kOpen || printed.id.index == 0x6040) continue;
    // Printed with a sign, but of an unsigned type: as far as both go.
    const std::int64_t low =
        fieldbus::isSigned(entry->type) ? printed.low : std::max<std::int64_t>(printed.low, 0);
    ASSERT_TRUE(entry->low && entry->high) << name;
    EXPECT_EQ(*entry->low, static_cast<double>(low)) << name;
    EXPECT_EQ(*entry->high, static_cast<double>(printed.high)) << name;
  }
}

// 9.3.4 and what other pages tell of [L827-857, L729-731].
TEST(Id286Objects, OfTheBusAreThoseOfTheManual) {
  const auto definition = familyDefinition(kId286Cnfa);
  const sim::ObjectDictionary dictionary = definition->dictionary.build(canopen::NodeId{1});
  const auto find = [&](unsigned index) {
    return dictionary.find({static_cast<std::uint16_t>(index), 0});
  };
  for (const unsigned index : {0x1000U, 0x1001U, 0x1003U, 0x1005U, 0x1006U, 0x1007U, 0x1008U,
                               0x1009U, 0x100AU, 0x1014U, 0x1017U, 0x1018U, 0x1200U}) {
    EXPECT_NE(find(index), nullptr) << std::hex << index;
  }
  for (unsigned i = 0; i < 4; ++i) {
    for (const unsigned first : {0x1400U, 0x1600U, 0x1800U, 0x1A00U}) {
      EXPECT_NE(find(first + i), nullptr) << std::hex << first + i;
    }
  }
  for (const unsigned index : {0x1010U, 0x1011U, 0x1019U, 0x1029U, 0x6007U, 0x605BU, 0x605CU,
                               0x605DU, 0x605EU, 0x6065U, 0x6067U, 0x607EU, 0x60F4U}) {
    EXPECT_EQ(find(index), nullptr) << std::hex << index;
  }
}

}  // namespace
}  // namespace cia402
