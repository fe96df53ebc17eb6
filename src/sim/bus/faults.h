// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

#include "can/frame.h"
#include "cia402_driver/common/time.h"

namespace cia402::sim {

/// What can go wrong with a frame on the simulated bus.
enum class FaultKind {
  lose,       ///< sent and acknowledged, but a receiver's controller loses it (overrun)
  duplicate,  ///< the sender misses the last bit of the acknowledged frame and sends it once more
  corrupt,    ///< a bit is disturbed: error frame, error counters, automatic retransmission
  delay,      ///< the sender's software hands the frame to its controller late
};

/// Faults by chance. Probabilities are 0..1 for each frame (`loss`: each frame and receiver;
/// `corrupt`: each attempt to send). All zero: a perfect bus.
struct FaultRates {
  double loss = 0;
  double duplicate = 0;
  double corrupt = 0;
  double delay = 0;
  Duration longest_delay{};  ///< a delayed frame waits a uniform time up to this
};

/// A fault by rule: hits the next `count` frames of one identifier, then is used up.
struct FaultRule {
  FaultKind kind = FaultKind::lose;
  std::uint32_t id = 0;
  std::uint32_t mask = 0x1FFFFFFF;  ///< bits of the identifier that must match; 0 hits every frame
  unsigned count = 1;               ///< frames (`corrupt`: attempts)
  Duration delay{};                 ///< for FaultKind::delay
  std::string_view receiver{};      ///< for FaultKind::lose: the port that loses it; empty: all.
                                    ///< The name must outlive the rule.
};

/// Decides which frames are hit. The same seed and the same frames give the same faults on every
/// platform: the generator is standardised, the mapping to real numbers is our own.
class BusFaults {
 public:
  /// @param seed of what happens by chance.
  explicit BusFaults(std::uint64_t seed);

  /// How often frames are disturbed from now on.
  void setRates(const FaultRates& rates);
  const FaultRates& rates() const { return rates_; }
  /// Adds a rule. Not for the cyclic path: may allocate.
  void add(const FaultRule& rule);
  /// Takes back one rule like this one, if it has not been used up.
  void remove(const FaultRule& rule);
  /// Back to a perfect bus; the generator goes on.
  void clear();
  /// False as long as no frame can be hit.
  bool active() const { return active_; }

  /// A number in [0, 1): the upper 53 bits of the generator's next output.
  double uniform();

  // The bus asks these; each use of a rule counts.
  /// How much later the frame comes; nothing if it is not delayed.
  std::optional<Duration> delayOf(const can::Frame& frame);
  /// Whether the frame ends in an error frame and is repeated.
  bool corrupts(const can::Frame& frame);
  /// Whether it comes twice.
  bool duplicates(const can::Frame& frame);
  /// Whether nobody gets it.
  bool losesForAll(const can::Frame& frame);
  /// Whether the receiver of that name does not get it.
  bool losesAt(std::string_view receiver, const can::Frame& frame);

 private:
  bool chance(double probability);
  const FaultRule* use(FaultKind kind, const can::Frame& frame, std::string_view receiver = {});

  std::mt19937_64 generator_;
  FaultRates rates_;
  std::vector<FaultRule> rules_;
  bool active_ = false;
};

}  // namespace cia402::sim
