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
  int recoveries = 1;  // that it may need
  friend std::ostream& operator<<(std::ostream& out, const Variant& variant) {
    return out << variant.name;
  }
};

std::string withBus(const std::string& more) {
  std::string yaml = genericPair();
  return yaml.replace(yaml.find("heartbeat: 0.1"), 14, "heartbeat: 0.1" + more);
}

std::vector<Variant> variants() {
  const std::string guarded =
      ", error_control: guarding, simulation: {drive: generic_cia402_guarding}";
  return {{"heartbeat", genericPair()},
          {"guarded", genericPair(guarded, guarded)},
          {"unsupervised", genericPair(", error_control: none", ", error_control: none")},
          {"optional", genericPair(", optional: true", ", optional: true")},
          {"external_sync", syncExternal()},
          {"sync_counter", withBus(", sync_counter: 10")},
          // A node-ID is taken for that of a drive in operation until nobody answers to it; the
          // one that forgot it is looked for then.
          {"lss", genericPair(lssOf(111) + unconfigured(111), lssOf(222) + unconfigured(222)), 2}};
}

class Aftermath : public testing::TestWithParam<Variant> {};

TEST_P(Aftermath, EveryAxisIsBackByRecover) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const bool external = std::string(GetParam().name) == "external_sync";
    SyncedScene scene(GetParam().yaml);
    if (!external) scene.cease();
    ASSERT_TRUE(scene.boot()) << scene.told();
    std::mt19937_64 random(seed);
    const auto pick = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
    const char* const faults[] = {"power_cycle", "silent", "sdo_silent",  "encoder",
                                  "overcurrent", "0x7500", "short_tpdos", "blocked_rotor"};
    const ProcedureKind kinds[] = {ProcedureKind::enable, ProcedureKind::recover,
                                   ProcedureKind::quick_stop, ProcedureKind::disable,
                                   ProcedureKind::save_parameters};
    for (int round = 0; round < 25; ++round) {
      const std::string axis = pick(2) == 0 ? "left" : "right";
      switch (pick(10)) {
        case 0:
        case 1:
          scene.inject(axis, faults[pick(8)]);
          break;
        case 2:
          scene.port(axis).setAttached(false);
          break;
        case 3:
          scene.port(axis).forceBusOff();
          break;
        case 4:
          scene.world().bus().faults().setRates(kDisturbances[pick(6)].rates());
          break;
        case 5: {
          const char* const words[] = {"stop", "pre_operational", "start", "reset_node"};
          (void)ask(scene, bus::NmtServiceCommand{axis, words[pick(4)]});
          break;
        }
        case 6:
          if (external) scene.cease();
          break;
        case 7:
          scene.robot().freeze(std::chrono::milliseconds(pick(1500)));
          break;
        case 8:
          scene.robot().port().setAttached(pick(2) == 0);
          break;
        default:
          (void)scene.begin(kinds[pick(5)], axis);
      }
      scene.run(std::chrono::milliseconds(pick(1200)));
      if (pick(2) != 0) continue;
      scene.inject(axis, "clear");
      scene.port(axis).setAttached(true);
      scene.port(axis).requestRecovery();
      scene.robot().port().setAttached(true);
      if (external) scene.produce();
    }
    scene.world().bus().faults().setRates({});
    scene.robot().port().setAttached(true);
    if (external) scene.produce();
    for (const char* axis : {"left", "right"}) {
      scene.inject(axis, "clear");
      scene.port(axis).setAttached(true);
      scene.port(axis).requestRecovery();
    }
    scene.run(45s);
    for (const char* axis : {"left", "right"}) {  // by name: all at once leaves optional ones out
      auto recovered = scene.procedure(ProcedureKind::recover, axis);
      for (int i = 1; i < GetParam().recoveries && !recovered.success; ++i) {
        EXPECT_THAT(recovered.message, HasSubstr("does not answer"));
        scene.run(10s);
        recovered = scene.procedure(ProcedureKind::recover, axis);
      }
      EXPECT_TRUE(recovered.success) << recovered.message << "\n" << scene.told();
      EXPECT_TRUE(scene.truth(axis).power_stage_on) << axis;
    }
  }
}

std::string nameOf(const testing::TestParamInfo<Variant>& tested) { return tested.param.name; }
INSTANTIATE_TEST_SUITE_P(Of, Aftermath, testing::ValuesIn(variants()), nameOf);

}  // namespace
}  // namespace cia402
