// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the answer to a call says is true of the motor.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "campaign/oracle.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

// An answer speaks of feedback that is up to three cycles and their frames old.
constexpr Duration kFeedbackAge = 25ms;

class Answers final : public Oracle {
 public:
  explicit Answers(const Stage& stage) : seen_(stage.axes().size()) {}
  const char* name() const override { return "untrue_answer"; }

  void look(const View& view) override {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const AxisTruth& truth = view.truths[i];
      if (truth.power) seen_[i].on = view.now;
      if (!truth.power) seen_[i].off = view.now;
      if (std::fabs(truth.velocity) <= view.stage.axes()[i].creep()) seen_[i].still = view.now;
      if (!truth.faulted()) seen_[i].well = view.now;
      for (NmtSeen& state : seen_[i].nmt) {
        if (truth.nmt == state.state) state.last = view.now;
      }
    }
  }
  /// A power stage may be on between two looks only; the drive's own frame tells it.
  void onFrame(const can::Frame& frame, const View& view) override {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const PdoPlace* const place = view.stage.statusword(i);
      if (place == nullptr || !place->isIn(frame, 2)) continue;
      if ((frame.data[place->byte] & 0x6F) == 0x27) seen_[i].on = view.now;
    }
  }
  void onAnswer(const Call& call, const bus::Answer& answer, const View& view) override {
    if (!answer.success) return;
    static const std::set<std::string> kStands{"halt",         "disable", "quick_stop", "set_mode",
                                               "set_position", "save",    "restore",    "home"};
    const bool says_so = answer.message.find("still moves") != std::string::npos;
    static const std::set<std::string> kOff{"disable", "save", "restore"};
    static const std::set<std::string> kOn{"enable", "recover"};
    const auto says = [&](const std::set<std::string>& verbs) {
      return verbs.count(call.verb) != 0;
    };
    for (std::size_t i : call.axes) {
      const Seen& seen = seen_[i];
      const Duration cycles = 3 * view.stage.loaded().robot.bus.sync_period + 5ms;
      const auto lately = [&](Time time) {
        return view.now - time <= std::max(kFeedbackAge, cycles);
      };
      const bool idle = call.verb == "set_mode" && !view.truths[i].power;
      // One that was homed before the others takes commands again.
      const bool commanded =
          call.verb == "home" && call.axes.size() > 1 && view.permits.given(i) > call.at;
      // One that stood held fast, and was let go just then, leaps.
      const bool leaps = view.now < view.conditions.axes[i].blocked;
      if (says(kStands) && !says_so && !idle && !commanded && !leaps && !lately(seen.still)) {
        report(view, i,
               call.verb + " is answered with success (" + answer.message +
                   ") while the motor turns at " + number(view.truths[i].velocity) + " per s");
      }
      if (says(kOff) && !lately(seen.off)) {
        report(view, i,
               call.verb + " is answered with success (" + answer.message +
                   ") while the power stage is on");
      }
      if (says(kOn) && !lately(seen.on)) {
        report(view, i,
               call.verb + " is answered with success (" + answer.message +
                   ") while the power stage is off");
      }
      if (call.verb == "clear_faults" && !lately(seen.well)) {
        report(view, i,
               "clear_faults is answered with success (" + answer.message +
                   ") while the drive shows a fault");
      }
      // Others' commands, and heartbeats that are late, make an answer old before it is given.
      // One without heartbeat tells nobody, and its answer says so.
      const bool told = call.verb == "nmt" &&
                        answer.message.find("to tell whether") == std::string::npos &&
                        view.now >= view.conditions.foreign && view.now >= view.conditions.lossy &&
                        view.now >= view.conditions.axes[i].cut_off &&
                        view.now >= view.conditions.axes[i].unheard;
      if (told && !lately(seen.inState(wanted(call.argument)))) {
        report(view, i,
               "nmt " + call.argument + " is answered with success (" + answer.message +
                   ") while the drive is " + canopen::toString(view.truths[i].nmt));
      }
    }
  }

 private:
  struct NmtSeen {
    canopen::NmtState state;
    Time last{-1h};
  };
  struct Seen {
    Time on{-1h}, off{-1h}, still{-1h}, well{-1h};
    std::array<NmtSeen, 3> nmt{{{canopen::NmtState::stopped},
                                {canopen::NmtState::pre_operational},
                                {canopen::NmtState::operational}}};
    Time inState(canopen::NmtState state) const {
      for (const NmtSeen& known : nmt) {
        if (known.state == state) return known.last;
      }
      return Time(-1h);
    }
  };
  /// Where a drive is after an NMT command that was obeyed: a reset is followed by a boot.
  static canopen::NmtState wanted(const std::string& command) {
    if (command == "stop") return canopen::NmtState::stopped;
    if (command == "pre_operational") return canopen::NmtState::pre_operational;
    return canopen::NmtState::operational;
  }
  std::vector<Seen> seen_;
};

}  // namespace

std::unique_ptr<Oracle> makeAnswers(const Stage& stage) { return std::make_unique<Answers>(stage); }

}  // namespace cia402::campaign
