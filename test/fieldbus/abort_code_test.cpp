// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "fieldbus/abort_code.h"

#include <gtest/gtest.h>

namespace cia402::fieldbus {
namespace {

// All of CiA 301, table 22.
constexpr std::uint32_t kTable22[] = {
    0x05030000, 0x05040000, 0x05040001, 0x05040002, 0x05040003, 0x05040004, 0x05040005, 0x06010000,
    0x06010001, 0x06010002, 0x06020000, 0x06040041, 0x06040042, 0x06040043, 0x06040047, 0x06060000,
    0x06070010, 0x06070012, 0x06070013, 0x06090011, 0x06090030, 0x06090031, 0x06090032, 0x06090036,
    0x060A0023, 0x08000000, 0x08000020, 0x08000021, 0x08000022, 0x08000023, 0x08000024};

TEST(AbortText, has_words_for_the_whole_of_table_22) {
  for (const std::uint32_t code : kTable22) {
    EXPECT_EQ(abortText(code).find("unknown to CiA 301"), std::string::npos) << std::hex << code;
  }
}

TEST(AbortText, gives_the_number_and_its_meaning) {
  EXPECT_EQ(abortText(abort_code::kReadOnly), "0x06010002 (attempt to write a read-only object)");
  EXPECT_EQ(abortText(abort_code::kToggleBit), "0x05030000 (toggle bit not alternated)");
  EXPECT_EQ(abortText(abort_code::kNoData), "0x08000024 (no data available)");
}

TEST(AbortText, admits_that_it_does_not_know_a_code) {
  EXPECT_EQ(abortText(0x12345678), "0x12345678 (abort code unknown to CiA 301)");
}

}  // namespace
}  // namespace cia402::fieldbus
