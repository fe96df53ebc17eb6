// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/pdo/text.h"

#include <gtest/gtest.h>

#include "canopen/scripted_peer.h"

namespace cia402::canopen {
namespace {

constexpr Time kNoon(std::chrono::hours(12));

/// TPDO 1 of six bytes on 183h, TPDO 2 of three on 283h.
PdoImage twoTpdos() {
  PdoConfig first, second;
  first.cob_id = 0x183;
  first.entries = {{{0x6041, 0}, 16, ""}, {{0x6064, 0}, 32, ""}};
  second.number = 2;
  second.cob_id = 0x283;
  second.entries = {{{0x6061, 0}, 8, ""}, {{0x6041, 0}, 16, ""}};
  return PdoImage({first, second});
}

TEST(PdoText, names_what_is_missing_and_why) {
  PdoImage image = twoTpdos();
  EXPECT_EQ(missingText(image), "");
  for (int i = 0; i < 11; ++i) {
    image.age(kNoon);
    image.receive(0, test::frame("183 37 02"), kNoon);
  }
  EXPECT_EQ(missingText(image),
            "TPDO 1 (COB-ID 0x183) comes too short (2 bytes instead of 6), "
            "TPDO 2 (COB-ID 0x283) does not come");
  image.receive(1, test::frame("283 08 50 02"), kNoon);
  EXPECT_EQ(missingText(image), "TPDO 1 (COB-ID 0x183) comes too short (2 bytes instead of 6)");
}

TEST(PdoText, a_tpdo_that_was_too_short_once_and_fails_to_come_later_does_not_come) {
  PdoConfig statusword;
  statusword.cob_id = 0x183;
  statusword.entries = {{{0x6041, 0}, 16, ""}};
  PdoImage image({statusword});
  const auto silence = [&image] {
    for (int i = 0; i < 11; ++i) image.age(kNoon);
  };
  image.receive(0, test::frame("183 37"), kNoon);
  silence();
  EXPECT_EQ(missingText(image), "TPDO 1 (COB-ID 0x183) comes too short (1 bytes instead of 2)");
  image.receive(0, test::frame("183 37 02"), kNoon);
  EXPECT_EQ(missingText(image), "");
  silence();
  EXPECT_EQ(missingText(image), "TPDO 1 (COB-ID 0x183) does not come");
  image.receive(0, test::frame("183 37"), kNoon);
  image.invalidate();  // the drive restarts
  silence();
  EXPECT_EQ(missingText(image), "TPDO 1 (COB-ID 0x183) does not come");
}

TEST(PdoText, names_what_is_overdue_and_what_has_a_wrong_length) {
  PdoImage image = twoTpdos();
  EXPECT_EQ(staleText(image), "");
  EXPECT_EQ(wrongLengthText(image), "");
  image.receive(0, test::frame("183 37 02"), kNoon);
  image.receive(1, test::frame("283 08 50 02 00"), kNoon);
  image.receive(1, test::frame("283 08 50 02 00"), kNoon);
  EXPECT_EQ(
      wrongLengthText(image),
      "TPDO 1 (COB-ID 0x183) came with 2 bytes instead of 6: too short, not taken (1 so far), "
      "TPDO 2 (COB-ID 0x283) came with 4 bytes instead of 3: too long, its beginning was taken "
      "(2 so far)");
  for (int i = 0; i < 11; ++i) image.age(kNoon);
  EXPECT_EQ(staleText(image),
            "TPDO 1 (COB-ID 0x183) did not come for 11 cycles, TPDO 2 (COB-ID 0x283) did not come "
            "for 11 cycles");
}

}  // namespace
}  // namespace cia402::canopen
