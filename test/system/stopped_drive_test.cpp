// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive in the NMT state stopped answers no SDO: it is brought out of it, or told as it is.
#include "bus/canopen/dcf_command.h"
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NmtState;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::AllOf;
using testing::HasSubstr;

class StoppedDrive : public testing::Test, private sim::Listener {
 protected:
  StoppedDrive() : scene(loadText(genericPair())) {}
  void boot() {
    scene.world().bus().setMonitor([this](const can::Frame& frame, Time) {
      asked += frame.id == 0x601 && scene.truth("left").nmt == NmtState::stopped ? 1U : 0U;
    });
    ASSERT_TRUE(scene.boot()) << scene.told();
    stranger = &scene.world().bus().attach(*this, "stranger", 16);
  }
  /// Another device stops the drive, which then does not hear the next NMT commands.
  void stop(unsigned lost) {
    ASSERT_TRUE(stranger->send(can::Frame(0x000, {0x02, 0x01}), scene.now()));
    scene.run(1ms);
    ASSERT_EQ(scene.truth("left").nmt, NmtState::stopped);
    sim::FaultRule commands;
    commands.id = 0x000;
    commands.count = lost;
    commands.receiver = "left";
    scene.world().bus().faults().add(commands);
    asked = 0;
  }
  void onFrame(const can::Frame&, Time) override {}

  Scene scene;
  sim::Port* stranger = nullptr;
  unsigned asked = 0;  // by SDO while it was stopped
};

TEST_F(StoppedDrive, IsBackSoonThoughTheCommandsOutOfItWereLost) {
  boot();
  stop(3);
  const Time begin = scene.now();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 1s));
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_LT(scene.now() - begin, 2s);
  EXPECT_TRUE(scene.truth("left").power_stage_on);
  EXPECT_LE(asked, 4U) << "what was on its way, and one question before its heartbeat told";
}

TEST_F(StoppedDrive, IsRecoveredThoughItsResetWasLost) {
  boot();
  ASSERT_TRUE(call(scene, bus::NmtServiceCommand{"left", "stop"}).success);
  ASSERT_EQ(scene.truth("left").nmt, NmtState::stopped);
  stop(2);
  const Time begin = scene.now();
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_LT(scene.now() - begin, 2s);
  EXPECT_EQ(asked, 0U) << "it cannot answer";
}

TEST_F(StoppedDrive, ThatStaysStoppedIsToldAsThat) {
  boot();
  ASSERT_TRUE(call(scene, bus::NmtServiceCommand{"left", "stop"}).success);
  stop(100000);
  const Time begin = scene.now();
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_FALSE(recovered.success);
  EXPECT_THAT(recovered.message,
              AllOf(HasSubstr("left (node 1)"), HasSubstr("it says that it is stopped"),
                    HasSubstr("look for another NMT master that stops it")));
  EXPECT_LT(scene.now() - begin, 3s);
  EXPECT_EQ(asked, 0U) << "it cannot answer";
  scene.world().bus().faults().clear();
  const auto again = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(again.success) << again.message;
}

TEST_F(StoppedDrive, IsNotAskedForObjectsThatItCannotTell) {
  boot();
  ASSERT_TRUE(call(scene, bus::NmtServiceCommand{"left", "stop"}).success);
  asked = 0;
  const Time begin = scene.now();
  const auto reading = std::make_shared<bus::DcfReading>();
  const std::pair<const char*, bus::Answer> answers[] = {
      {"6041:00 statusword", call(scene, bus::ReadObjectCommand{"left", "6041:00"})},
      {"6065:00 ", call(scene, bus::WriteObjectCommand{"left", "6065:00", "1000"})},
      {"its error history (1003h)", call(scene, bus::ErrorHistoryCommand{"left"})},
      {"its objects for a DCF", call(scene, bus::SaveDcfCommand{"left", reading})},
  };
  for (const auto& [what, answer] : answers) {
    EXPECT_FALSE(answer.success);
    EXPECT_THAT(answer.message,
                AllOf(HasSubstr("left (node 1): " + std::string(what)), HasSubstr("answers no SDO"),
                      HasSubstr("recover, or nmt start")));
  }
  EXPECT_LT(scene.now() - begin, 100ms);
  EXPECT_EQ(asked, 0U);
  EXPECT_TRUE(call(scene, bus::NmtServiceCommand{"left", "start"}).success);
  EXPECT_TRUE(call(scene, bus::ReadObjectCommand{"left", "6041:00"}).success);
}

}  // namespace
}  // namespace cia402
