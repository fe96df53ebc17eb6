// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Whatever has happened on the bus, and however its drives are supervised and addressed: once the
// causes are gone `recover` brings every axis back, and nobody has to restart the driver.
#include <random>

#include "system/disturbance.h"
#include "system/lss_scene.h"
#include "system/synced_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;

struct Variant {
  const char* name;
  std::string yaml;
  bool external_sync = false;
  int recoveries = 1;  // that it may need
  friend std::ostream& operator<<(std::ostream& out, const Variant& variant) {
    return out << variant.name;
  }
};

std::vector<Variant> variants() {
  return {{"heartbeat", genericPair()},
          {"guarded", genericPair(kGuarded, kGuarded)},
          {"unsupervised", genericPair(", error_control: none", ", error_control: none")},
          {"optional", genericPair(", optional: true", ", optional: true")},
          {"external_sync", syncExternal(), true},
          {"sync_counter", withBus("sync_counter: 10")},
          // A node-ID is taken for that of a drive in operation until nobody answers to it; the
          // one that forgot it is looked for then.
          {"lss", genericPair(lssOf(111) + unconfigured(111), lssOf(222) + unconfigured(222)),
           false, 2}};
}

constexpr const char* kAxes[] = {"left", "right"};
constexpr const char* kFaults[] = {"power_cycle", "silent", "sdo_silent",  "encoder",
                                   "overcurrent", "0x7500", "short_tpdos", "blocked_rotor"};
constexpr const char* kNmtWords[] = {"stop", "pre_operational", "start", "reset_node"};
constexpr ProcedureKind kProcedures[] = {ProcedureKind::enable, ProcedureKind::recover,
                                         ProcedureKind::quick_stop, ProcedureKind::disable,
                                         ProcedureKind::save_parameters};

/// Parameters: the robot, and the number of its history.
class Aftermath : public testing::TestWithParam<std::tuple<Variant, std::uint64_t>> {
 protected:
  Aftermath()
      : scene(variant().yaml, {}, std::get<1>(GetParam())), random(std::get<1>(GetParam())) {
    if (!variant().external_sync) scene.cease();
  }
  static const Variant& variant() { return std::get<0>(GetParam()); }
  unsigned pick(std::size_t n) { return static_cast<unsigned>(random() % n); }
  template <class Choice, std::size_t n>
  Choice pick(const Choice (&choices)[n]) {
    return choices[pick(n)];
  }
  std::chrono::milliseconds upTo(unsigned ms) { return std::chrono::milliseconds(pick(ms)); }

  void happen(const std::string& axis) {
    switch (pick(10)) {
      case 0:
      case 1:
        return scene.inject(axis, pick(kFaults));
      case 2:
        return scene.port(axis).setAttached(false);
      case 3:
        return scene.port(axis).forceBusOff();
      case 4:
        return scene.world().bus().faults().setRates(pick(kDisturbances).rates());
      case 5:
        (void)ask(scene, bus::NmtServiceCommand{axis, pick(kNmtWords)});
        return;
      case 6:
        return scene.cease();
      case 7:
        return scene.robot().freeze(upTo(1500));
      case 8:
        return scene.robot().port().setAttached(pick(2) == 0);
      default:
        (void)scene.begin(pick(kProcedures), axis);
    }
  }
  void endFor(const std::string& axis) {
    scene.inject(axis, "clear");
    scene.port(axis).setAttached(true);
    scene.port(axis).requestRecovery();
    scene.robot().port().setAttached(true);
    if (variant().external_sync) scene.produce();
  }
  bus::Answer recover(const std::string& axis) {
    bus::Answer answer = scene.procedure(ProcedureKind::recover, axis);
    for (int i = 1; i < variant().recoveries && !answer.success; ++i) {
      EXPECT_THAT(answer.message, HasSubstr("does not answer"));
      scene.run(10s);
      answer = scene.procedure(ProcedureKind::recover, axis);
    }
    return answer;
  }

  SyncedScene scene;
  std::mt19937_64 random;
};

TEST_P(Aftermath, EveryAxisIsBackByRecover) {
  ASSERT_TRUE(scene.boot()) << scene.told();
  for (int round = 0; round < 25; ++round) {
    const std::string axis = pick(kAxes);
    happen(axis);
    scene.run(upTo(1200));
    if (pick(2) == 0) endFor(axis);
  }
  scene.world().bus().faults().setRates({});
  for (const char* axis : kAxes) endFor(axis);
  scene.run(45s);
  for (const char* axis : kAxes) {  // by name: all at once leaves optional ones out
    const bus::Answer recovered = recover(axis);
    EXPECT_TRUE(recovered.success) << recovered.message << "\n" << scene.told();
    EXPECT_TRUE(scene.truth(axis).power_stage_on) << axis;
  }
}

std::string nameOf(const testing::TestParamInfo<Aftermath::ParamType>& tested) {
  return std::get<0>(tested.param).name + std::string("_") +
         std::to_string(std::get<1>(tested.param));
}
INSTANTIATE_TEST_SUITE_P(Of, Aftermath,
                         testing::Combine(testing::ValuesIn(variants()),
                                          testing::Range<std::uint64_t>(1, 11)),
                         nameOf);

}  // namespace
}  // namespace cia402
