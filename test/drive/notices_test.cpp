// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/notices.h"

#include <gtest/gtest.h>

namespace cia402::drive {
namespace {

TEST(Notices, AreKeptUntilSomebodyLooks) {
  Notices notices;
  EXPECT_EQ(notices.at(0).text, "");
  notices.warn("it is warm");
  notices.fail("it is stopped");
  notices.informOnce("its name is x");
  ASSERT_EQ(notices.count(), 3U);
  EXPECT_EQ(notices.at(1).text, "it is warm");
  EXPECT_EQ(notices.at(1).kind, NoticeKind::warning);
  EXPECT_EQ(notices.at(2).text, "it is stopped");
  EXPECT_EQ(notices.at(2).kind, NoticeKind::error);
  EXPECT_EQ(notices.at(3).text, "its name is x");
  EXPECT_EQ(notices.at(3).kind, NoticeKind::information);
}

TEST(Notices, KeepTheLastOnesInTheirPlaces) {
  Notices notices;
  for (std::uint32_t i = 1; i <= 3 * Notices::kKept; ++i) notices.notify(std::to_string(i));
  const std::uint32_t count = notices.count();
  EXPECT_EQ(count, 3 * Notices::kKept);
  EXPECT_EQ(notices.at(count).text, std::to_string(count));
  EXPECT_EQ(notices.at(count - Notices::kKept + 1).text,
            std::to_string(count - Notices::kKept + 1));
}

TEST(Notices, ThatAreToldOnceCountOnce) {
  Notices notices;
  notices.warnOnce("a");
  notices.warnOnce("a");
  notices.informOnce("a");
  EXPECT_EQ(notices.count(), 1U);
  EXPECT_EQ(notices.at(1).kind, NoticeKind::warning);
}

TEST(Notices, OfAFailureThatNobodyIsToldOfAreNone) {
  Notices notices;
  notices.fail("the device is lost", false);
  EXPECT_EQ(notices.count(), 0U);
  EXPECT_EQ(notices.takeFailure(), "the device is lost");
  EXPECT_FALSE(notices.failed());
}

}  // namespace
}  // namespace cia402::drive
