// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Methods 1 to 14 of the iD286-CNFA as its manual prints them [L1946-2171]: home, the speed of each
// leg, and the limits that end them in an error; what is refused, and which sign the offset has.
#include <algorithm>
#include <cmath>

#include "system/families_homing.h"
#include "system/id286_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kBelow = 0.0, kOn = 1.8, kAbove = 3.6;  // of the home switch, turns of the motor
constexpr double kOnNegative = -2.4, kOnPositive = 5.4;  // on the limit switches

/// Where it starts, where home is, and the legs of the way there: direction, high or low speed.
struct Id286Route {
  int method;
  double start, home;
  const char* legs;
};
void PrintTo(const Id286Route& route, std::ostream* out) {
  *out << "method " << route.method << " from " << route.start;
}

/// The legs that a motor makes, by its speed.
class Legs {
 public:
  void look(double velocity) {
    constexpr double kStands = 0.01;
    const char direction = velocity > kStands ? '+' : velocity < -kStands ? '-' : ' ';
    if (direction != direction_) end();
    direction_ = direction;
    fastest_ = std::max(fastest_, std::fabs(velocity));
  }
  std::string text() {
    end();
    return text_;
  }

 private:
  void end() {
    constexpr double kFast = 2.0 * kZeroSpeed;
    if (direction_ != ' ') {
      text_ +=
          (text_.empty() ? "" : " ") + std::string(1, direction_) + (fastest_ > kFast ? "H" : "L");
    }
    direction_ = ' ';
    fastest_ = 0.0;
  }
  char direction_ = ' ';
  double fastest_ = 0.0;
  std::string text_;
};

class Id286Method : public testing::TestWithParam<Id286Route> {};

TEST_P(Id286Method, GoesThePrintedWayAtThePrintedSpeeds) {
  const Id286Route& c = GetParam();
  Scene scene(loadText(homingJoint({kId286InPp, "", {c.method, c.start, c.home}})));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  Legs legs;
  scene.watch([&] { legs.look(scene.velocity("joint")); });
  const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
  ASSERT_TRUE(homed.success) << homed.message << scene.told();
  EXPECT_EQ(legs.text(), c.legs);
  EXPECT_NEAR(scene.state("joint").position - kReadAtHome,
              scene.position("joint") - c.home * kTurnOfMotor, kTurnOfMotor / 10000 + 2e-6);
}

INSTANTIATE_TEST_SUITE_P(
    CaseA, Id286Method,
    testing::Values(Id286Route{1, kBelow, -1.7, "-H +L"}, Id286Route{2, kAbove, 4.3, "+H -L"},
                    Id286Route{3, kBelow, 0.3, "+H -L"}, Id286Route{4, kBelow, 1.3, "+L"},
                    Id286Route{5, kAbove, 3.3, "-H +L"}, Id286Route{6, kAbove, 2.3, "-L"},
                    Id286Route{7, kBelow, 0.3, "+H -L"}, Id286Route{8, kBelow, 1.3, "+L"},
                    Id286Route{9, kBelow, 2.3, "+H -L"}, Id286Route{10, kBelow, 3.3, "+L"},
                    Id286Route{11, kAbove, 3.3, "-H +L"}, Id286Route{12, kAbove, 2.3, "-L"},
                    Id286Route{13, kAbove, 1.3, "-H +L"}, Id286Route{14, kAbove, 0.3, "-L"}),
    [](const auto& tested) { return "Method" + std::to_string(tested.param.method); });
INSTANTIATE_TEST_SUITE_P(
    CaseB, Id286Method,
    testing::Values(Id286Route{1, kOnNegative, -1.7, "+L"}, Id286Route{2, kOnPositive, 4.3, "-L"},
                    Id286Route{3, kOn, 0.3, "-L"}, Id286Route{4, kOn, 1.3, "-H +L"},
                    Id286Route{5, kOn, 3.3, "+L"}, Id286Route{6, kOn, 2.3, "+H -L"},
                    Id286Route{7, kOn, 0.3, "-L"}, Id286Route{8, kOn, 1.3, "-H +L"},
                    Id286Route{9, kOn, 2.3, "+H -L"}, Id286Route{10, kOn, 3.3, "+L"},
                    Id286Route{11, kOn, 3.3, "+L"}, Id286Route{12, kOn, 2.3, "+H -L"},
                    Id286Route{13, kOn, 1.3, "-H +L"}, Id286Route{14, kOn, 0.3, "-L"}),
    [](const auto& tested) { return "Method" + std::to_string(tested.param.method); });
INSTANTIATE_TEST_SUITE_P(
    CaseC, Id286Method,
    testing::Values(Id286Route{7, kAbove, 0.3, "+H -L"}, Id286Route{8, kAbove, 1.3, "+L -H +L"},
                    Id286Route{9, kAbove, 2.3, "+H -L"}, Id286Route{10, kAbove, 3.3, "+L -H +L"},
                    Id286Route{11, kBelow, 3.3, "-H +L"}, Id286Route{12, kBelow, 2.3, "-L +H -L"},
                    Id286Route{13, kBelow, 1.3, "-H +L"}, Id286Route{14, kBelow, 0.3, "-L +H -L"}),
    [](const auto& tested) { return "Method" + std::to_string(tested.param.method); });

/// Where it starts, and where the home switch is, so that it meets a limit that is an error.
struct Id286Error {
  int method;
  double start, home_from;
};
void PrintTo(const Id286Error& error, std::ostream* out) {
  *out << "method " << error.method << " from " << error.start;
}

class Id286HomingError : public testing::TestWithParam<Id286Error> {
 protected:
  static std::string yaml(const Id286Error& c, const std::string& more = {}) {
    const auto place = [](double turns) { return std::to_string(turns * kTurnOfMotor); };
    std::string text = homingJoint({kId286InPp, "", {c.method, c.start, 0.0}});
    text = replaced(text, "home_switch: [" + place(1.0) + ", " + place(2.6) + "]",
                    "home_switch: [" + place(c.home_from) + ", " + place(c.home_from + 1.6) + "]");
    return replaced(text, "index_offset: 0.3", "index_offset: 0.3" + more);
  }
  /// Bit 13, warning 2000h, an immediate stop and no home.
  static void expectError(Scene& scene) {
    bool bit_13 = false;
    scene.watch([&] { bit_13 = bit_13 || (scene.truth("joint").statusword & 0x2000) != 0; });
    const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
    EXPECT_FALSE(homed.success);
    EXPECT_THAT(homed.message, AllOf(HasSubstr("joint (node 1): homing stopped: the drive reports"),
                                     HasSubstr("homing error")));
    EXPECT_TRUE(bit_13);
    EXPECT_THAT(scene.told(), HasSubstr("0x2000 warning: homing failed"));
    scene.run(300ms);
    EXPECT_FALSE(scene.state("joint").homed);
    // 0.8 rad/s end within 0.08 rad by the acceleration limit, once the drive has seen the limit.
    const double way = 0.8 * 0.8 / (2.0 * 4.0) + 0.8 * 0.01;
    EXPECT_GT(scene.position("joint"),
              std::min(-2.0 * kTurnOfMotor - way, -2.4 * kTurnOfMotor - 1e-3));
    EXPECT_LT(scene.position("joint"),
              std::max(5.0 * kTurnOfMotor + way, 5.4 * kTurnOfMotor + 1e-3));
    scene.forget();
    scene.run(500ms);
    EXPECT_LT(scene.seen("joint").travel(), 1e-5);
  }
};

TEST_P(Id286HomingError, IsBit13AndWarning2000AndAnImmediateStop) {
  Scene scene(loadText(yaml(GetParam())));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  expectError(scene);
}

constexpr double kThere = 1.0, kBeyond = 8.0, kFarBelow = -8.0;  // the home switch

// 1 and 2 by the other limit, 3 to 6 by any, 7 to 14 by the one that they do not turn at.
INSTANTIATE_TEST_SUITE_P(
    OnTheSwitch, Id286HomingError,
    testing::Values(Id286Error{1, kOnPositive, kThere}, Id286Error{2, kOnNegative, kThere},
                    Id286Error{3, kOnNegative, kThere}, Id286Error{3, kOnPositive, kThere},
                    Id286Error{4, kOnNegative, kThere}, Id286Error{4, kOnPositive, kThere},
                    Id286Error{5, kOnNegative, kThere}, Id286Error{5, kOnPositive, kThere},
                    Id286Error{6, kOnNegative, kThere}, Id286Error{6, kOnPositive, kThere},
                    Id286Error{7, kOnNegative, kThere}, Id286Error{8, kOnNegative, kThere},
                    Id286Error{9, kOnNegative, kThere}, Id286Error{10, kOnNegative, kThere},
                    Id286Error{11, kOnPositive, kThere}, Id286Error{12, kOnPositive, kThere},
                    Id286Error{13, kOnPositive, kThere}, Id286Error{14, kOnPositive, kThere}),
    [](const auto& tested) {
      return "Method" + std::to_string(tested.param.method) + "Case" + std::to_string(tested.index);
    });
INSTANTIATE_TEST_SUITE_P(
    OnTheWay, Id286HomingError,
    testing::Values(Id286Error{3, kAbove, kThere}, Id286Error{4, kAbove, kThere},
                    Id286Error{5, kBelow, kThere}, Id286Error{6, kBelow, kThere},
                    Id286Error{7, kAbove, kBeyond}, Id286Error{8, kAbove, kBeyond},
                    Id286Error{9, kAbove, kBeyond}, Id286Error{10, kAbove, kBeyond},
                    Id286Error{11, kBelow, kFarBelow}, Id286Error{12, kBelow, kFarBelow},
                    Id286Error{13, kBelow, kFarBelow}, Id286Error{14, kBelow, kFarBelow}),
    [](const auto& tested) { return "Method" + std::to_string(tested.param.method); });

// 13 and 14 are printed to fail at the negative limit, which their case C turns at [L2152, L2171]:
// a drive that does what is printed reports an error there.
class Id286LiteralMethod : public Id286HomingError {};

TEST_P(Id286LiteralMethod, FailsInWordsAtTheLimitThatItWouldTurnAt) {
  const std::string number = std::to_string(GetParam().method);
  Scene scene(loadText(
      yaml(GetParam(), ", with: {homing: {routes: {" + number +
                           ": {legs: \"-fast home on, +slow index\", from_limit: \"+slow index\","
                           " fails_at: [negative, positive]}}}}")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  expectError(scene);
}
INSTANTIATE_TEST_SUITE_P(AsPrinted, Id286LiteralMethod,
                         testing::Values(Id286Error{13, kBelow, kThere},
                                         Id286Error{14, kBelow, kThere}),
                         [](const auto& tested) {
                           return "Method" + std::to_string(tested.param.method);
                         });

// [L1944, L1565]: 1 to 14, 17 to 30, 33 to 35 alone.
TEST(Id286HomingMethods, ThatItDoesNotHaveAreRefusedByDriverAndDrive) {
  for (const int method : {-1, 0, 15, 16, 31, 32, 36, 37, 100}) {
    Problems problems;
    config::loadRobot(YAML::Load(homingJoint({kId286InPp, "", {method, 0.0, 0.0}})),
                      config::profilesIn({test::configFolder() + "/drives"}), problems);
    EXPECT_THAT(problems.text(),
                AllOf(HasSubstr("axes/joint/homing/method"),
                      HasSubstr("profile id286_cnfa has no method " + std::to_string(method))));
  }
  Scene scene(loadText(familyJoint(kId286InPp)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  for (const char* method : {"15", "31", "36", "100"}) {
    bus::WriteObjectCommand write;
    write.axis = "joint";
    write.object = "homing_method";
    write.value = method;
    EXPECT_FALSE(call(scene, write).success) << method;
  }
  EXPECT_EQ(scene.drive("joint").dictionary().find({0x6098, 0})->number, 21U) << "the factory's";
}

// In counts: 50 * 10000 / (2 pi) to the rad.
TEST(Id286HomingNumbers, StandInTheDrive) {
  Scene scene(loadText(homingJoint({kId286InPp, "", {17, 0.0, -2.0}})));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success);
  const auto number = [&](std::uint16_t index, std::uint8_t sub) {
    return static_cast<double>(scene.drive("joint").dictionary().find({index, sub})->number);
  };
  EXPECT_EQ(number(0x6098, 0), 17.0);
  EXPECT_NEAR(number(0x6099, 1), 63662.0, 1.0) << "0.8 rad/s";
  EXPECT_NEAR(number(0x6099, 2), 12732.0, 1.0) << "0.16 rad/s";
  EXPECT_NEAR(number(0x609A, 0), 318310.0, 1.0) << "4 rad/s^2";
  EXPECT_NEAR(number(0x607C, 0), 19894.0, 1.0) << "0.25 rad";
  EXPECT_NEAR(number(0x6085, 0), 636620.0, 1.0) << "8 rad/s^2";
}

std::string homesWith(const std::string& sim, const std::string& more) {
  return familyJoint(kId286InPp,
                     ", homing: {method: 17, offset: 0.25, search_velocity: 0.4, zero_velocity: "
                     "0.05, acceleration: 2.0" +
                         more + "}, simulation: {lower_limit_switch: -0.4, with: {" + sim + "}}");
}

// The bits of a search that has ended stand until the next one begins.
TEST(Id286StaleBits, OfAnEarlierHomingAreNotTakenForSuccess) {
  Scene scene(loadText(
      homesWith("quirks: {homing_result_stays: true}, modes: {6: {behaviour: homing}}", "")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  scene.drive("joint").mechanics().negative_limit_switch = -0.9 / kTurnOfMotor;
  bool stale = false, searches = false;
  scene.watch([&] {
    const auto truth = scene.truth("joint");
    searches = searches || scene.velocity("joint") < -0.01;
    stale = stale || (!searches && truth.mode == 6 && (truth.statusword & 0x1427) == 0x1427);
  });
  const auto homed = scene.begin(ProcedureKind::home, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return homed->has_value(); }, 20s));
  EXPECT_TRUE(stale) << "they stood";
  EXPECT_TRUE((*homed)->success) << (*homed)->message;
  EXPECT_NEAR(scene.position("joint"), -0.9, 0.02);
  // And one that fails then has not succeeded.
  scene.drive("joint").mechanics().negative_limit_switch = -1e9;
  scene.drive("joint").mechanics().positive_limit_switch = -0.95 / kTurnOfMotor;
  const bus::Answer failed = scene.procedure(ProcedureKind::home, "joint");
  EXPECT_FALSE(failed.success) << failed.message;
}

// The sign of 607Ch is not printed.
TEST(Id286HomeOffset, IsReadBackAndAWrongSignToldInsteadOfAWrongZero) {
  for (const bool shifts : {false, true}) {
    for (const bool said : {false, true}) {
      Scene scene(loadText(
          homesWith(shifts ? "homing: {home_offset: shift_of_zero}"
                           : "homing: {home_offset: position_at_home}",
                    said ? ", offset_means: shift_of_zero" : ", offset_means: position_at_home")));
      ASSERT_TRUE(scene.boot(20s)) << scene.told();
      const bus::Answer homed = scene.procedure(ProcedureKind::home, "joint");
      EXPECT_EQ(homed.success, shifts == said) << homed.message;
      EXPECT_EQ(scene.state("joint").homed, shifts == said);
      if (shifts == said) {
        EXPECT_NEAR(scene.state("joint").position - 0.25, scene.position("joint") + 0.4, 1e-5);
      } else {
        EXPECT_THAT(homed.message, AllOf(HasSubstr("joint (node 1): "), HasSubstr("607C:00"),
                                         HasSubstr("homing/offset_means")));
        EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3);
      }
    }
  }
}

// Bit 8 brakes by 6084h, where the modes that follow a stream leave ten times the limit.
TEST(Id286Homing, IsHaltedByTheAccelerationLimitWhateverTheModeBefore) {
  FamilyScene scene(familyJoint({kId286Cnfa, "10000", "position_by_velocity"},
                                ", homing: {method: 17, search_velocity: 0.6, zero_velocity: 0.05,"
                                " acceleration: 4.0}"));
  const auto home = scene.begin(ProcedureKind::home, "joint");
  ASSERT_TRUE(scene.runUntil([&] { return scene.velocity("joint") < -0.59; }, 2s)) << scene.told();
  scene.run(100ms);
  std::vector<double> speeds;
  scene.watch([&] { speeds.push_back(std::fabs(scene.velocity("joint"))); });
  scene.mustSucceed(ProcedureKind::halt);
  scene.watch({});
  double hardest = 0.0;  // over 20 ms
  for (std::size_t i = 20; i < speeds.size(); ++i) {
    hardest = std::max(hardest, (speeds[i - 20] - speeds[i]) / 0.020);
  }
  EXPECT_GT(hardest, 0.8 * 4.0);
  EXPECT_LT(hardest, 1.1 * 4.0);
  ASSERT_TRUE(home->has_value());
  EXPECT_FALSE((*home)->success);
}

}  // namespace
}  // namespace cia402
