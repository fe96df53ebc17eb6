// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/set_point_handshake.h"

#include <gmock/gmock.h>

#include <functional>
#include <utility>
#include <vector>

namespace cia402::drive {
namespace {

constexpr Duration kTimeout = std::chrono::seconds(1);

struct Wire {
  explicit Wire(Handover by = standardHandover(true)) : handover(std::move(by)) {}
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;

  Handover handover;
  SetPointHandshake handshake{handover};
  SetPointHandshake::Input input;
  Time now{};
  bool bit() const { return (handshake.word() & 0x0010) != 0; }
  bool step(bool acknowledged) {
    now += std::chrono::milliseconds(1);
    input.acknowledged = acknowledged;
    const bool ok = handshake.advance(input, now, kTimeout);
    ++input.target_frames;  // each cycle sends both RPDOs
    ++input.controlword_frames;
    return ok;
  }
};

TEST(SetPointHandshake, SendsTheTargetBeforeTheEdge) {
  Wire wire;
  wire.handshake.offer(100);
  EXPECT_TRUE(wire.step(false));
  EXPECT_EQ(wire.handshake.raw(), 100u);
  EXPECT_FALSE(wire.bit());
  EXPECT_TRUE(wire.step(false));
  EXPECT_TRUE(wire.bit());
}

TEST(SetPointHandshake, MakesNoEdgeWhileTheTargetHasNotLeft) {
  Wire wire;
  wire.handshake.offer(100);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(wire.step(false));
    wire.input.target_frames = 0;
    EXPECT_FALSE(wire.bit());
  }
}

TEST(SetPointHandshake, HoldsTheBitUntilAcknowledgedThenWaitsForTheFall) {
  Wire wire;
  wire.handshake.offer(100);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(false));
  EXPECT_TRUE(wire.bit());
  EXPECT_TRUE(wire.step(true));
  EXPECT_FALSE(wire.bit());
  EXPECT_TRUE(wire.handshake.busy());
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(true));
  EXPECT_TRUE(wire.handshake.busy());
  EXPECT_TRUE(wire.step(false));
  EXPECT_FALSE(wire.handshake.busy());
}

// One whose frame may be lost leaves three times before each of its two edges.
TEST(SetPointHandshake, InsistsOnATargetWithAFrameOfItsOwn) {
  Wire wire;
  wire.handshake.offer({100, true, false, true});
  for (int edge = 0; edge < 2; ++edge) {
    for (int frame = 0; frame < 3; ++frame) {
      EXPECT_TRUE(wire.step(false));
      EXPECT_FALSE(wire.bit()) << edge << frame;
      EXPECT_TRUE(wire.handshake.insists()) << edge << frame;
    }
    EXPECT_TRUE(wire.step(false));
    EXPECT_TRUE(wire.bit()) << edge;
    EXPECT_FALSE(wire.handshake.insists());
    EXPECT_TRUE(wire.step(true));
    EXPECT_FALSE(wire.bit());
  }
  EXPECT_TRUE(wire.step(false));
  EXPECT_FALSE(wire.handshake.busy());
}

TEST(SetPointHandshake, DoesNotInsistWhereOneFrameHasBoth) {
  Wire wire;
  wire.input.together = true;
  wire.handshake.offer({100, true, false, true});
  EXPECT_TRUE(wire.step(false));
  EXPECT_FALSE(wire.bit());
  EXPECT_TRUE(wire.step(false));
  EXPECT_TRUE(wire.bit());
}

/// A drive that looks at the controlword before the target of the same RPDO, and hears some frames
/// only.
struct HastyDrive {
  std::uint64_t target = 0, taken = 0;
  bool bit = false, acknowledges = false;
  void hear(const SetPointHandshake& handshake) {
    const bool raised = (handshake.word() & 0x0010) != 0;
    if (raised && !bit) taken = target;
    acknowledges = bit = raised;
    target = handshake.raw();
  }
};

TEST(SetPointHandshake, GivenTwiceIsTakenWhicheverFramesAreLost) {
  int old_taken = 0;
  for (unsigned lost = 0; lost < 1024; ++lost) {  // of the first ten frames, bit by bit
    for (const bool twice : {false, true}) {
      Wire wire;
      HastyDrive drive;
      wire.handshake.reset(7);
      drive.target = drive.taken = 7;
      wire.handshake.offer(100, twice);
      for (unsigned frame = 0; frame < 40 && wire.handshake.busy(); ++frame) {
        ASSERT_TRUE(wire.step(drive.acknowledges));
        if (frame >= 10 || (lost >> frame & 1U) == 0) drive.hear(wire.handshake);
      }
      EXPECT_FALSE(wire.handshake.busy());
      if (twice) {
        EXPECT_EQ(drive.taken, 100u) << lost;
      } else {
        old_taken += drive.taken == 7;
      }
    }
  }
  EXPECT_GT(old_taken, 0) << "given once it may take the previous target";
}

TEST(SetPointHandshake, ANewerTargetNeedNotWaitForTheSecondTime) {
  Wire wire;
  wire.handshake.offer(100, true);
  wire.step(false);
  wire.step(false);
  wire.handshake.offer(200);
  wire.step(true);
  wire.step(false);  // idle again
  wire.step(false);
  EXPECT_EQ(wire.handshake.raw(), 200u);
  wire.step(false);
  EXPECT_TRUE(wire.bit());
  wire.step(true);
  wire.step(false);
  EXPECT_FALSE(wire.handshake.busy()) << "once";
}

TEST(SetPointHandshake, KeepsTheTargetUnchangedWhileTheBitIsHigh) {
  Wire wire;
  wire.handshake.offer(100);
  wire.step(false);
  wire.step(false);
  ASSERT_TRUE(wire.bit());
  wire.handshake.offer(200);
  wire.handshake.offer(300);
  wire.step(false);
  EXPECT_EQ(wire.handshake.raw(), 100u);
  wire.step(true);
  wire.step(true);
  wire.step(false);  // idle again
  wire.step(false);
  EXPECT_EQ(wire.handshake.raw(), 300u);
}

TEST(SetPointHandshake, DoesNotBeginWhileAnOldAcknowledgeStands) {
  Wire wire;
  wire.handshake.offer(100);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(wire.step(true));
  EXPECT_FALSE(wire.bit());
  EXPECT_EQ(wire.handshake.raw(), 0u);
}

TEST(SetPointHandshake, GivesUpWithTheBitLow) {
  Wire wire;
  wire.handshake.offer(100);
  int steps = 0;
  while (wire.step(false) && steps < 5000) ++steps;
  EXPECT_GT(steps, 990);
  EXPECT_LT(steps, 1010);
  EXPECT_FALSE(wire.bit());
  EXPECT_FALSE(wire.handshake.busy());
}

TEST(SetPointHandshake, PulsesWithoutAnAcknowledgeBit) {
  Wire wire(standardHandover(false));
  wire.handshake.offer(100);
  int high = 0;
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(wire.step(false));
    if (wire.bit()) ++high;
  }
  EXPECT_EQ(high, 2);
  EXPECT_FALSE(wire.handshake.busy());
}

TEST(SetPointHandshake, AnAcknowledgeThatFallsAtTheLastMomentCounts) {
  Wire wire;
  wire.handshake.offer(100);
  wire.step(false);
  wire.step(false);
  ASSERT_TRUE(wire.step(true));
  for (int i = 0; i < 999; ++i) ASSERT_TRUE(wire.step(true)) << i;
  EXPECT_TRUE(wire.step(false)) << "1 s after it was to fall";
  EXPECT_FALSE(wire.handshake.busy());
}

/// The words of iD286-CNFA: 0F, 2F, 3F, each in a SYNC period of its own.
Handover threeWords() {
  Handover handover;
  handover.words = {0x0000, 0x0020, 0x0030};
  handover.acknowledge = Handover::Acknowledge::rise;
  handover.each_for = 1;
  return handover;
}

/// What is sent, word by word, as long as the handshake is busy.
std::vector<int> wordsOf(Wire& wire, const std::function<bool(int)>& acknowledges) {
  std::vector<int> words;
  while (wire.handshake.busy() && words.size() < 100) {
    EXPECT_TRUE(wire.step(acknowledges(words.empty() ? 0 : words.back())));
    words.push_back(wire.handshake.word());
  }
  return words;
}

TEST(SetPointHandshake, SendsAWordAfterTheOtherAndWaitsForTheRiseAlone) {
  Wire wire(threeWords());
  EXPECT_EQ(wire.handshake.word(), 0);
  wire.handshake.offer(100);
  bool stays = false;
  const auto words = wordsOf(wire, [&](int word) { return stays = stays || word == 0x0030; });
  EXPECT_THAT(words, testing::ElementsAre(0, 0x20, 0x30, 0, 0));
}

TEST(SetPointHandshake, HandsOverTwiceWhereTheAcknowledgeStandsAlready) {
  Wire wire(threeWords());
  wire.handshake.offer(100);
  const auto words = wordsOf(wire, [](int) { return true; });
  EXPECT_THAT(words, testing::ElementsAre(0, 0x20, 0x30, 0, 0, 0x20, 0x30, 0, 0));
}

TEST(SetPointHandshake, WithoutRiseGivesUpAtRest) {
  Wire wire(threeWords());
  wire.handshake.offer(100);
  int steps = 0;
  while (wire.step(false) && steps < 5000) ++steps;
  EXPECT_GT(steps, 990);
  EXPECT_LT(steps, 1010);
  EXPECT_EQ(wire.handshake.word(), 0);
  EXPECT_FALSE(wire.handshake.busy());
}

/// The next target leaves with the words at rest, and its first word after that.
TEST(SetPointHandshake, AnnouncesTheNextTargetWithTheWordsAtRestWhereEachIsSentOnce) {
  Wire wire(threeWords());
  wire.handshake.offer(100);
  std::vector<std::pair<int, std::uint64_t>> sent;
  for (int i = 0; i < 8; ++i) {
    if (i == 2) wire.handshake.offer(200);
    EXPECT_TRUE(wire.step(true));
    sent.emplace_back(wire.handshake.word(), wire.handshake.raw());
  }
  using testing::Pair;
  EXPECT_THAT(
      sent, testing::ElementsAre(Pair(0, 100u), Pair(0x20, 100u), Pair(0x30, 100u), Pair(0, 200u),
                                 Pair(0x20, 200u), Pair(0x30, 200u), Pair(0, 200u), Pair(0, 200u)));
}

TEST(SetPointHandshake, SendsEachWordAsOftenAsItIsTold) {
  Handover handover = threeWords();
  handover.acknowledge = Handover::Acknowledge::none;
  handover.each_for = 3;
  Wire wire(handover);
  wire.handshake.offer(100);
  const auto words = wordsOf(wire, [](int) { return false; });
  EXPECT_THAT(words, testing::ElementsAre(0, 0x20, 0x20, 0x20, 0x30, 0x30, 0x30, 0, 0, 0, 0));
}

}  // namespace
}  // namespace cia402::drive
