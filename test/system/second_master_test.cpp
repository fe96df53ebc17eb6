// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Another master on the bus is noticed before it is disturbed; drives that a driver left behind are
// none.
#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;
using testing::Not;

class SecondMaster : public testing::Test, private sim::Listener {
 protected:
  void begin(const std::string& yaml = genericPair()) {
    scene.emplace(loadText(yaml));
    stranger = &scene->world().bus().attach(*this, "stranger", 16);
    scene->world().bus().setMonitor([this](const can::Frame& frame, Time) {
      const bool from_drive = (frame.id >= 0x181 && frame.id < 0x200) || frame.id == 0x081 ||
                              frame.id == 0x082 || frame.id == 0x701 || frame.id == 0x702;
      others += from_drive ? 0U : 1U;
    });
  }
  void send(const can::Frame& frame) {
    ASSERT_TRUE(stranger->send(frame, scene->now()));
    ++own;
  }
  void onFrame(const can::Frame&, Time) override {}

  std::optional<Scene> scene;
  sim::Port* stranger = nullptr;
  unsigned own = 0;     // frames that the stranger has sent
  unsigned others = 0;  // frames on the wire that no drive has sent
};

TEST_F(SecondMaster, ThatMovesTheDrivesIsLeftAloneUntilItEnds) {
  begin();
  scene->robot().start();
  for (int i = 0; i < 250; ++i) {
    send(can::Frame(0x080, {}));
    send(can::Frame(0x201, {0x0F, 0x00, 0x08, 0, 0, 0, 0}));
    scene->run(4ms);
  }
  EXPECT_EQ(others, own) << "the driver has sent a frame";
  EXPECT_THAT(scene->told(), HasSubstr("another master is on the bus, heard: SYNC (COB-ID 0x080)"));
  const auto refused = scene->procedure(ProcedureKind::enable);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("another master is on the bus"));
  scene->run(100ms);
  EXPECT_EQ(others, own);
  ASSERT_TRUE(scene->runUntil([&] { return allReady(scene->robot()); }, 3s)) << scene->told();
  const auto enabled = scene->procedure(ProcedureKind::enable);
  EXPECT_TRUE(enabled.success) << enabled.message;
}

TEST_F(SecondMaster, IsNoneOfTheDrivesThatADriverLeftBehind) {
  begin();
  scene->world().powerOn();
  scene->run(1s);
  for (const char* axis : {"left", "right"}) {
    sim::ObjectDictionary& objects = scene->drive(axis).dictionary();
    ASSERT_EQ(objects.write({0x1017, 0}, {20, 0}), 0u);  // heartbeats every 20 ms
    ASSERT_EQ(objects.write({0x1800, 2}, {0xFE}), 0u);   // a TPDO by its timer,
    ASSERT_EQ(objects.write({0x1800, 5}, {10, 0}), 0u);  // every 10 ms
  }
  send(can::Frame(0x000, {0x01, 0x00}));
  scene->run(200ms);
  const unsigned before = others;
  scene->robot().startDriver();
  scene->run(140ms);
  EXPECT_EQ(others, before);
  ASSERT_TRUE(scene->runUntil([&] { return allReady(scene->robot()); }, 3s)) << scene->told();
  EXPECT_THAT(scene->told(), Not(HasSubstr("another master")));
}

TEST_F(SecondMaster, IsNotLookedForWhereThatIsConfigured) {
  begin(withBus("listen: 0"));
  scene->robot().start();
  send(can::Frame(0x77F, {0x05}));
  scene->run(10ms);
  EXPECT_GT(others, own);
}

TEST_F(SecondMaster, IsNotTheSyncOfTheDeviceThatLeads) {
  begin(withBus("sync: external"));
  scene->robot().start();
  for (int i = 0; i < 1000 && !allReady(scene->robot()); ++i) {
    send(can::Frame(0x080, {}));
    scene->run(4ms);
  }
  EXPECT_TRUE(allReady(scene->robot())) << scene->told();
  EXPECT_THAT(scene->told(), Not(HasSubstr("another master")));
}

}  // namespace
}  // namespace cia402
