// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/drive_trouble.h"

#include <cmath>
#include <stdexcept>

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr const char* kPowerCycle = "power_cycle";  // of the drive
constexpr Duration kOffFor = 600ms;                 // by that, until it is heard again

/// A drive that plans its motion itself goes on planning while its rotor is blocked: what it takes
/// to stop that demand, and to come back from it to where the axis was told to stop meanwhile.
Duration catchingUp(const AxisFacts& axis, Duration blocked) {
  const double stop = axis.velocity / axis.acceleration;
  const double ahead = axis.velocity * (toSeconds(blocked) + 0.5 * stop);
  return fromSeconds(stop + 2.0 * std::sqrt(ahead / axis.acceleration));
}

}  // namespace

DriveTrouble::Action DriveTrouble::find(const std::string& verb) {
  static const std::map<std::string, Action> kVerbs{
      {"fault", &DriveTrouble::fault},     {"clear", &DriveTrouble::clear},
      {"power", &DriveTrouble::cutPower},  {"silent", &DriveTrouble::silence},
      {"mute", &DriveTrouble::mute},       {"block", &DriveTrouble::block},
      {"switch", &DriveTrouble::limitHere}};
  const auto known = kVerbs.find(verb);
  return known == kVerbs.end() ? nullptr : known->second;
}

bool DriveTrouble::act(const Words& words) {
  const Action action = find(words[0]);
  if (action == nullptr) return false;
  for (std::size_t i : session_.stage.named(words.at(1))) (this->*action)(i, words);
  return true;
}

void DriveTrouble::inject(std::size_t axis, const std::string& what) {
  const Result<void> done =
      session_.stage.driveOf(axis).inject(what, session_.now(), place(axis).axis);
  if (!done) throw std::invalid_argument(done.error().message);
}

void DriveTrouble::clearLater(std::size_t axis, Duration delay) {
  session_.later(delay, [this, axis] { inject(axis, "clear"); });
}

void DriveTrouble::fault(std::size_t axis, const Words& words) {
  const std::string& name = words.at(2);
  const sim::FaultDefinition* const known = session_.stage.fault(axis, name);
  if (session_.stage.coasts(axis, name)) session_.mayCoast(axis);
  if (known != nullptr && !known->resettable) dead_[place(axis).drive] = true;  // until power-off
  if (name == kPowerCycle) session_.mayCoastInDriveOf(axis);
  inject(axis, name);
  if (name == kPowerCycle) session_.breakLink(axis, kOffFor);
}

void DriveTrouble::clear(std::size_t axis, const Words&) { inject(axis, "clear"); }

void DriveTrouble::cutPower(std::size_t axis, const Words& words) {
  session_.mayCoastInDriveOf(axis);
  const Duration length = toDuration(words.at(2));
  session_.breakLink(axis, length);
  session_.stage.driveOf(axis).powerOff(session_.now());
  ++cuts_[place(axis).drive];
  session_.later(length, [this, axis] {
    if (--cuts_[place(axis).drive] == 0) session_.stage.driveOf(axis).powerOn(session_.now());
  });
}

void DriveTrouble::silence(std::size_t axis, const Words& words) {
  const Duration length = toDuration(words.at(2));
  session_.breakLink(axis, length);
  inject(axis, "silent");
  clearLater(axis, length);
}

void DriveTrouble::mute(std::size_t axis, const Words& words) {
  inject(axis, "sdo_silent");
  clearLater(axis, toDuration(words.at(2)));
}

void DriveTrouble::block(std::size_t axis, const Words& words) {
  const Duration length = toDuration(words.at(2));
  const Time now = session_.now();
  inject(axis, "blocked_rotor");
  Conditions::extend(session_.conditions.axes[axis].blocked,
                     now + length + 400ms + catchingUp(session_.stage.axes()[axis], length));
  session_.permits.hinder(axis, now + length);
  clearLater(axis, length);
}

/// A limit switch right where it stands.
void DriveTrouble::limitHere(std::size_t axis, const Words& words) {
  sim::Drive& drive = session_.stage.driveOf(axis);
  const unsigned number = place(axis).axis;
  sim::AxisMechanics& mechanics = drive.mechanics(number);
  double& limit =
      words.at(2) == "lower" ? mechanics.negative_limit_switch : mechanics.positive_limit_switch;
  const double before = switches_.emplace(&limit, limit).first->second;
  limit = drive.truth(session_.now(), number).position_turns;
  session_.later(toDuration(words.at(3)), [&limit, before] { limit = before; });
}

void DriveTrouble::calm() {
  sim::World& world = session_.stage.world();
  for (std::size_t i = 0; i < session_.stage.drives().size(); ++i) {
    const std::size_t axis = session_.stage.drives()[i].axes.front();
    inject(axis, "clear");
    world.port(i).setAttached(true);
    world.port(i).requestRecovery();
    if (dead_[i]) {
      session_.mayCoastInDriveOf(axis);
      session_.mayBeUnheard(axis, kOffFor);
      inject(axis, kPowerCycle);
    }
    dead_[i] = false;
  }
  session_.stage.host().interface().port().setAttached(true);
}

}  // namespace cia402::campaign
