// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "system/families_scene.h"

namespace cia402 {

constexpr char kNimotionStepper[] = "nimotion_stepper", kId286Cnfa[] = "id286_cnfa",
               kMegmeetDm5[] = "megmeet_dm5", kSv660c[] = "sv660c";

inline FamilyMode nimotionIn(const char* mode) { return {kNimotionStepper, "4000", mode}; }

/// Every mode by which these families are streamed, sent to goals or pushed.
inline std::vector<FamilyMode> familyModes() {
  std::vector<FamilyMode> modes;
  for (const char* mode : {"pp", "vl", "pv", "ip", "csp", "csv"}) {
    modes.push_back({kNimotionStepper, "4000", mode});
  }
  for (const char* mode :
       {"pp", "pv", "csv", "pt", "position_by_velocity", "position_by_set_points"}) {
    modes.push_back({kId286Cnfa, "10000", mode});
  }
  for (const char* mode : {"pp", "pv", "csp", "csv", "pt", "cst"}) {
    modes.push_back({kMegmeetDm5, "8388608", mode});
  }
  for (const char* mode : {"ip", "pp", "pv", "csv", "pt"}) {
    modes.push_back({kSv660c, "100000", mode});
  }
  return modes;
}

/// Each of them once, in the mode that most of them are used in.
inline std::vector<FamilyMode> families() {
  return {{kNimotionStepper, "4000", "csp"},
          {kId286Cnfa, "10000", "pp"},
          {kMegmeetDm5, "8388608", "csp"},
          {kSv660c, "100000", "ip"}};
}

inline std::string familyModeName(const testing::TestParamInfo<FamilyMode>& tested) {
  return std::string(tested.param.family) + "_" + tested.param.mode;
}
inline std::string familyName(const testing::TestParamInfo<FamilyMode>& tested) {
  return tested.param.family;
}

inline bool familyModeTurnsUpwardsOnly(const FamilyMode& tested) {
  return tested.family == std::string(kId286Cnfa) && tested.mode == std::string("pt");
}
inline bool isTorqueMode(const FamilyMode& tested) {
  return tested.mode == std::string("pt") || tested.mode == std::string("cst");
}

/// Those of familyModes() for which `wanted` holds.
template <typename Wanted>
std::vector<FamilyMode> familyModesThat(const Wanted& wanted) {
  std::vector<FamilyMode> modes;
  for (const FamilyMode& mode : familyModes()) {
    if (wanted(mode)) modes.push_back(mode);
  }
  return modes;
}

/// rad of the joint of familyJoint(), by a count of its drive
inline double oneCount(const FamilyMode& tested) {
  return 6.283185307179586 / (50.0 * std::stod(tested.counts_per_turn));
}

/// What turns it downwards where it can be turned so: 6071h of the iD286 takes 0 to 120 alone.
inline double downwards(const FamilyMode& tested) {
  return familyModeTurnsUpwardsOnly(tested) ? 1.0 : -1.0;
}

/// The same text with the first `what` in it replaced.
inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// As familyJoint(), with room for several modes: `modes` as "[pp, pv]".
inline std::string familyJointWith(const FamilyMode& tested, const std::string& modes,
                                   const std::string& more = {}) {
  return replaced(familyJoint(tested, more), "modes: [" + std::string(tested.mode) + "]",
                  "modes: " + modes);
}

/// A joint that has booted and is enabled.
struct FamilyScene : Scene {
  explicit FamilyScene(const std::string& yaml) : Scene(loadText(yaml)) {
    EXPECT_TRUE(boot(std::chrono::seconds(20))) << told();
    const bus::Answer enabled = procedure(drive::ProcedureKind::enable);
    EXPECT_TRUE(enabled.success) << enabled.message;
  }
  drive::ControlKind kind() { return state("joint").mode->kind; }
  std::uint64_t number(std::uint16_t index, std::uint8_t subindex = 0) {
    return drive("joint").dictionary().find({index, subindex})->number;
  }

  /// Sends the joint off by what its mode takes, upwards (1) or downwards (-1): it moves by more
  /// than 0.3 rad/s then, and goes on for some time.
  void sendOff(double direction = 1.0) {
    using namespace std::chrono_literals;
    if (kind() == drive::ControlKind::position) {
      EXPECT_EQ(setpoint("joint", position("joint") + 1.4 * direction), "");
      run(500ms);
    } else {
      stream("joint", direction * (kind() == drive::ControlKind::velocity ? 0.5 : 5.0), 600ms);
    }
    EXPECT_GT(direction * velocity("joint"), 0.3) << told();
  }
  /// Nothing moves for so long.
  void expectStands(Duration time, double most = 1e-4) {
    forget();
    run(time);
    EXPECT_LT(seen("joint").travel(), most) << told();
  }
  void mustSucceed(drive::ProcedureKind kind, const std::string& mode = {}) {
    const bus::Answer answer = procedure(kind, "joint", mode);
    ASSERT_TRUE(answer.success) << answer.message << "\n" << told();
  }
};

}  // namespace cia402
