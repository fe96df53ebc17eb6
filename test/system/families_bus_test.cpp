// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The families on the bus: rates, node-IDs, SYNC, several of a kind, late ones and lost ones.
#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NmtState;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::AllOf;
using testing::HasSubstr;

class FamilyBus : public testing::TestWithParam<FamilyMode> {};

INSTANTIATE_TEST_SUITE_P(All, FamilyBus, allFamilies(), nameOfFamily);

// The master has another node-ID where a drive has 127.
TEST_P(FamilyBus, HasAnyNodeId) {
  for (const unsigned node : {1U, 2U, 64U, 126U, 127U}) {
    BusOptions bus;
    if (node == 127) bus.more = ", node_id: 3";
    TracedScene scene(busRobot(busAxis(GetParam(), "joint", node), bus));
    expectBootsAndGoes(scene);
    for (const unsigned service : {0x580U, 0x180U, 0x200U}) {
      EXPECT_GT(scene.count(wireText(can::Frame(service + node, {}))), 20U) << node;
    }
    EXPECT_GT(scene.count(node == 127 ? "703 05" : "77F 05"), 10U) << "the master's heartbeat";
  }
}

struct FamilyRate {
  FamilyMode tested;
  const char *bitrate, *period;
};

class FamilyBusAt : public testing::TestWithParam<FamilyRate> {};

TEST_P(FamilyBusAt, ARateOfItsManualGoesWhereItIsTold) {
  const FamilyRate& rate = GetParam();
  BusOptions bus;
  bus.bitrate = rate.bitrate;
  bus.period = rate.period;
  bus.heartbeat = "1.0";
  Scene scene(loadText(busRobot(busAxis(rate.tested, "joint", 1, ", feedback: []"), bus)));
  expectBootsAndGoes(scene);
}

// A set-point each 20 ms at most for `ip` of an SV660C; the others stand slower ones.
INSTANTIATE_TEST_SUITE_P(
    That, FamilyBusAt,
    testing::Values(
        FamilyRate{kBusNimotion, "10000", "0.1"}, FamilyRate{kBusNimotion, "20000", "0.05"},
        FamilyRate{kBusNimotion, "50000", "0.02"}, FamilyRate{kBusNimotion, "100000", "0.01"},
        FamilyRate{kBusNimotion, "125000", "0.01"}, FamilyRate{kBusNimotion, "250000", "0.004"},
        FamilyRate{kBusNimotion, "500000", "0.004"}, FamilyRate{kBusNimotion, "800000", "0.004"},
        FamilyRate{kBusNimotion, "1000000", "0.004"}, FamilyRate{kBusId286, "125000", "0.01"},
        FamilyRate{kBusId286, "250000", "0.004"}, FamilyRate{kBusId286, "500000", "0.004"},
        FamilyRate{kBusId286, "1000000", "0.004"}, FamilyRate{kBusSv660c, "20000", "0.02"},
        FamilyRate{kBusDamiao, "10000", "0.1"}, FamilyRate{kBusDamiao, "20000", "0.05"},
        FamilyRate{kBusDamiao, "50000", "0.02"}, FamilyRate{kBusDamiao, "125000", "0.01"},
        FamilyRate{kBusDamiao, "250000", "0.004"}, FamilyRate{kBusDamiao, "500000", "0.004"},
        FamilyRate{kBusDamiao, "800000", "0.004"}),
    [](const auto& tested) {
      return std::string(tested.param.tested.family) + "_" + tested.param.bitrate;
    });

struct FamilyPeriod {
  FamilyMode tested;
  const char* name;
  const char* period;
  Duration length;
};

class FamilySync : public testing::TestWithParam<FamilyPeriod> {};

TEST_P(FamilySync, IsProducedAtThePeriodAndFollowed) {
  BusOptions bus;
  bus.period = GetParam().period;
  TracedScene scene(busRobot(busAxis(GetParam().tested), bus));
  expectBootsAndGoes(scene);
  std::vector<Time> at;
  for (std::size_t i = 0; i < scene.lines.size(); ++i) {
    if (scene.lines[i].compare(0, 3, "080") == 0) at.push_back(scene.times[i]);
  }
  ASSERT_GT(at.size(), 100U);
  for (std::size_t i = at.size() - 100; i < at.size(); ++i) {
    EXPECT_NEAR(toSeconds(at[i] - at[i - 1]), toSeconds(GetParam().length), 3e-4) << i;
  }
}

constexpr FamilyMode kBusNimotionIp{"nimotion_stepper", "4000", "ip"};

INSTANTIATE_TEST_SUITE_P(
    Of, FamilySync,
    testing::Values(FamilyPeriod{kBusNimotion, "nimotion_csp_1ms", "0.001", 1ms},
                    FamilyPeriod{kBusNimotion, "nimotion_csp_20ms", "0.02", 20ms},
                    FamilyPeriod{kBusNimotionIp, "nimotion_ip_1ms", "0.001", 1ms},
                    FamilyPeriod{kBusNimotionIp, "nimotion_ip_2ms", "0.002", 2ms},
                    FamilyPeriod{kBusNimotionIp, "nimotion_ip_10ms", "0.01", 10ms},
                    FamilyPeriod{kBusNimotionIp, "nimotion_ip_20ms", "0.02", 20ms},
                    FamilyPeriod{kBusId286, "id286_2ms", "0.002", 2ms},
                    FamilyPeriod{kBusId286, "id286_10ms", "0.01", 10ms},
                    FamilyPeriod{kBusId286, "id286_20ms", "0.02", 20ms},
                    FamilyPeriod{kBusDm5, "dm5_1ms", "0.001", 1ms},
                    FamilyPeriod{kBusDm5, "dm5_2ms", "0.002", 2ms},
                    FamilyPeriod{kBusDm5, "dm5_10ms", "0.01", 10ms},
                    FamilyPeriod{kBusSv660c, "sv660c_1ms", "0.001", 1ms},
                    FamilyPeriod{kBusDamiao, "damiao_1ms", "0.001", 1ms},
                    FamilyPeriod{kBusDamiao, "damiao_2500us", "0.0025", 2500us},
                    FamilyPeriod{kBusDamiao, "damiao_10ms", "0.01", 10ms}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(FamilyPeriods, ThatAreTooShortAreRefused) {
  BusOptions bus;
  bus.period = "0.001";
  EXPECT_THAT(problemsOfRobot(busRobot(busAxis(kBusId286), bus)),
              HasSubstr("`joint` (profile id286_cnfa) follows no period below 0.002 s"));
}

// Three of a kind: what is given to them with one SYNC is begun with one SYNC.
TEST_P(FamilyBus, TakesItsSetPointsWithSyncTogetherWithOthers) {
  TracedScene scene(busRobot(busAxis(GetParam(), "a", 1) + busAxis(GetParam(), "b", 2) +
                             busAxis(GetParam(), "c", 3)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.run(100ms);
  const bool ip = is(GetParam(), kBusSv660c);
  const auto target = [&](const char* name) {
    return ip ? numberIn(scene, 0x60C1, 1, name) : numberIn(scene, 0x607A, 0, name);
  };
  unsigned changes = 0, between = 0;  // RPDOs leave half a period, 2 ms, after SYNC
  double apart = 0.0, from[3];
  std::uint64_t last = target("b");
  for (std::size_t i = 0; i < 3; ++i) from[i] = scene.position(i);
  scene.watch([&] {
    const auto sync = std::find_if(scene.lines.rbegin(), scene.lines.rend(),
                                   [](const auto& line) { return line.compare(0, 3, "080") == 0; });
    const Time synced = scene.times[static_cast<std::size_t>(scene.lines.rend() - sync) - 1];
    if (target("b") != last) {
      ++changes;
      between += scene.now() - synced > 1500us ? 1U : 0U;
    }
    last = target("b");
    const double a = scene.position(0) - from[0];
    apart = std::max({apart, std::abs(scene.position(1) - from[1] - a),
                      std::abs(scene.position(2) - from[2] - a)});
  });
  for (const char* name : {"a", "b", "c"}) {
    ASSERT_EQ(scene.setpoint(name, scene.state(name).position + 0.8), "");
  }
  scene.run(600ms);
  scene.watch({});
  EXPECT_GT(scene.velocity("a"), 0.3);
  EXPECT_LT(apart, 1e-4) << "0.1 ms at 0.8 rad/s are 8e-5 rad";
  EXPECT_GE(changes, 1U);
  EXPECT_EQ(between, 0U);
}

/// What the simulated drive calls a fault that it leaves by a reset.
const char* someFault(const FamilyMode& tested) {
  if (is(tested, kBusSv660c)) return "position_command";
  return is(tested, kBusDm5) || is(tested, kBusDamiao) ? "overvoltage" : "over_voltage";
}

TEST_P(FamilyBus, HasItsFaultsAloneBesideOthers) {
  Scene scene(loadText(busRobot(busAxis(GetParam(), "a", 1) + busAxis(GetParam(), "b", 2) +
                                busAxis(GetParam(), "c", 3))));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  for (const char* name : {"a", "b", "c"}) {
    ASSERT_EQ(scene.setpoint(name, scene.state(name).position + 0.8), "");
  }
  scene.run(600ms);
  scene.inject("b", someFault(GetParam()));
  // Some end by themselves later on; the drive is off then, too.
  EXPECT_TRUE(scene.runUntil([&] { return !scene.axis("b").faultText().empty(); }, 200ms));
  scene.run(2s);
  EXPECT_FALSE(scene.truth("b").power_stage_on);
  for (const char* name : {"a", "c"}) {
    EXPECT_NEAR(scene.position(name), 0.8, 1e-3) << scene.told();
    EXPECT_TRUE(scene.truth(name).power_stage_on);
    EXPECT_EQ(scene.axis(name).faultText(), "");
  }
  EXPECT_TRUE(scene.procedure(ProcedureKind::clear_faults, "b").success);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable, "b").success) << scene.told();
}

TEST_P(FamilyBus, IsTakenInThoughItComesLate) {
  Scene scene(loadText(busJoint(GetParam(),
                                ", simulation: {with: {communication: "
                                "{boot_time: 10.0}}}")));
  scene.robot().start();
  scene.run(9s);
  EXPECT_NE(scene.state("joint").health, Health::ready);
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 12s)) << scene.told();
  scene.forget();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  scene.run(200ms);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
}

TEST_P(FamilyBus, IsToldToBeMissingWhereThereIsNoTraffic) {
  Scene scene(loadText(busJoint(GetParam())));
  scene.robot().start();
  scene.drive("joint").powerOff(scene.now());
  scene.port("joint").setPowered(false);
  scene.run(15s);
  EXPECT_EQ(scene.state("joint").health, Health::absent);
  EXPECT_THAT(scene.told(),
              HasSubstr("joint (node 1): does not answer: neither a boot-up message"));
}

/// The writes of a boot, each once, without the controlword, which stops it.
std::vector<std::string> settingsOf(const TracedScene& scene) {
  std::vector<std::string> found = scene.writes();
  const auto controlword = [](const std::string& line) { return line.substr(3, 5) == "40 60"; };
  found.erase(std::remove_if(found.begin(), found.end(), controlword), found.end());
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

TEST_P(FamilyBus, IsConfiguredAnewAndLeftDisabledWhenItRestarts) {
  for (const bool enabled : {false, true}) {
    TracedScene scene(busJoint(GetParam()));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    const auto first = settingsOf(scene);
    ASSERT_GT(first.size(), 15U);
    if (enabled) {
      ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
      ASSERT_EQ(scene.setpoint("joint", scene.state("joint").position + 1.5), "");
      scene.run(800ms);
      ASSERT_GT(scene.velocity("joint"), 0.3);
    }
    scene.clear();
    scene.inject("joint", "power_cycle");
    ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").health != Health::ready; }, 4s));
    ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, kFamilyBoot))
        << scene.told();
    EXPECT_THAT(settingsOf(scene), testing::IsSupersetOf(first));
    scene.forget();
    scene.run(1s);
    EXPECT_FALSE(scene.truth("joint").power_stage_on) << "nobody asked for it";
    EXPECT_EQ(scene.truth("joint").nmt, NmtState::operational);
    EXPECT_EQ(scene.seen("joint").travel(), 0.0);
    const bus::Answer recovered = scene.procedure(ProcedureKind::recover, "joint");
    EXPECT_TRUE(recovered.success) << recovered.message;
    scene.run(300ms);
    EXPECT_LT(scene.seen("joint").travel(), 1e-4) << "not on to the old target";
    expectGoes(scene, 0.3);
  }
}

}  // namespace
}  // namespace cia402
