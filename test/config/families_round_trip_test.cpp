// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every quantity of every family over all its numbers, for joints that are drawn: what is read and
// sent again is the same number, what is commanded and read again the same to half a unit of the
// drive, and what does not fit is no number at all.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "config/loaded.h"

namespace cia402::config {
namespace {

using drive::AxisGeometry;
using drive::Conversion;
using drive::Encoding;
using drive::ObjectSpec;
using drive::Quantity;

constexpr int kJoints = 60;

class FamilyRoundTrip : public testing::TestWithParam<const char*> {
 protected:
  FamilyRoundTrip() {
    const LoadedRobot loaded =
        loadText("bus: {interface: sim, sync_period: 0.004}\naxes: {joint: {node_id: 1, drive: " +
                 std::string(GetParam()) +
                 ", counts_per_turn: 4096, rated_torque: 1.0, limits: {velocity: 1.0, "
                 "acceleration: 4.0}}}\n");
    EXPECT_EQ(loaded.problems, "");
    profile_ = loaded.robot.axes.at(0).profile;
  }

  double within(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  AxisGeometry drawGeometry() {
    AxisGeometry geometry;
    const auto kind = random_() % 3;
    geometry.type = kind == 0   ? AxisGeometry::Type::revolute
                    : kind == 1 ? AxisGeometry::Type::prismatic
                                : AxisGeometry::Type::continuous;
    geometry.counts_per_turn = std::exp2(within(8.0, 24.0));
    geometry.gear_ratio = std::exp(within(-2.0, 6.0));
    geometry.lead = std::exp(within(-7.0, -1.0));
    geometry.direction = random_() % 2 == 0 ? 1 : -1;
    geometry.position_offset = within(-10.0, 10.0);
    geometry.rated_torque = std::exp(within(-3.0, 3.0));
    return geometry;
  }

  /// Calls `check` for each object that holds a quantity, and joints that are drawn.
  /// @return how many conversions that were
  template <class Check>
  int forEach(const Check& check) {
    int made = 0;
    for (const ObjectSpec& object : profile_->objects) {
      if (object.quantity == Quantity::none) continue;
      for (int joint = 0; joint < kJoints; ++joint) {
        const AxisGeometry geometry = drawGeometry();
        const auto conversion = Conversion::create(object, *profile_, geometry);
        if (!conversion) continue;  // of a quantity that this joint cannot have
        ++made;
        SCOPED_TRACE(object.name + ", joint " + std::to_string(joint));
        check(object, *conversion);
        if (testing::Test::HasFailure()) return made;
      }
    }
    return made;
  }

  std::mt19937 random_{20261127};
  std::shared_ptr<const drive::DriveProfile> profile_;
};

/// All bits that a number of the object has.
std::uint64_t allBits(const ObjectSpec& object) {
  const unsigned bits = fieldbus::sizeBits(object.type);
  return bits == 0 || bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

TEST_P(FamilyRoundTrip, OfANumberThatWasReadIsTheSameNumber) {
  const int made = forEach([&](const ObjectSpec& object, const Conversion& conversion) {
    if (object.encoding != Encoding::integer) return;  // in the next test: some bits are no numbers
    const double low = conversion.lowest(), high = conversion.highest();
    for (int i = 0; i < 50; ++i) {
      std::uint64_t raw = (std::uint64_t{random_()} << 32 | random_()) & allBits(object);
      if (i == 0) raw = conversion.lowestRaw() & allBits(object);
      if (i == 1) raw = conversion.highestRaw() & allBits(object);
      const double value = conversion.toJoint(raw);
      if (value < low || value > high) continue;  // out of the range that the profile gives
      std::uint64_t back = ~raw;
      ASSERT_TRUE(conversion.toDevice(value, back)) << raw;
      if (allBits(object) > (std::uint64_t{1} << 52)) {  // a double has 53 bits
        ASSERT_NEAR(conversion.toJoint(back), value, 1e-12 * (high - low));
      } else {
        ASSERT_EQ(back, raw);
      }
    }
  });
  EXPECT_GT(made, kJoints * 3);
}

TEST_P(FamilyRoundTrip, OfAValueIsTheSameToHalfAUnitOfTheDrive) {
  const int made = forEach([&](const ObjectSpec&, const Conversion& conversion) {
    const double low = std::max(conversion.lowest(), -1e9),
                 high = std::min(conversion.highest(), 1e9);
    ASSERT_LT(low, high);
    for (int i = 0; i < 50; ++i) {
      const double value = i == 0 ? low : i == 1 ? high : within(low, high);
      std::uint64_t raw = 0;
      ASSERT_TRUE(conversion.toDevice(value, raw)) << value;
      const double resolution = conversion.resolution();  // 0 for floats: 24 bits of mantissa
      const double rounding = resolution > 0.0 ? 0.5000001 * resolution + 1e-12 * (high - low)
                                               : std::ldexp(std::fabs(value) + 10.0, -23);
      ASSERT_NEAR(conversion.toJoint(raw), value, rounding);
    }
  });
  EXPECT_GT(made, kJoints * 3);
}

TEST_P(FamilyRoundTrip, OfWhatDoesNotFitIsNone) {
  forEach([&](const ObjectSpec&, const Conversion& conversion) {
    const double low = conversion.lowest(), high = conversion.highest();
    const double step = std::max(1.01 * conversion.resolution(), 1e-6 * (high - low));
    for (const double value : {low - step, high + step, low - 3.0 * (high - low),
                               high + 3.0 * (high - low), 1e300, -1e300, std::nan("")}) {
      if (!std::isfinite(value) && !std::isnan(value)) continue;  // of the widest floats
      std::uint64_t raw = 0xA5A5;
      ASSERT_FALSE(conversion.toDevice(value, raw)) << value << " of " << low << " to " << high;
      ASSERT_EQ(raw, 0xA5A5U) << "it is left alone";
    }
  });
}

INSTANTIATE_TEST_SUITE_P(All, FamilyRoundTrip,
                         testing::Values("generic_cia402", "sv660c", "nimotion_stepper",
                                         "id286_cnfa", "damiao_dm", "megmeet_dm5"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace cia402::config
