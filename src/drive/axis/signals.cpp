// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/signals.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace cia402::drive {
namespace {

using Reading = AxisPoller::Reading;

struct Row {
  SignalId id;
  const char* name;  ///< of the profile format
  fieldbus::ObjectId object;
  Reading reading;
};

/// In the order of SignalId, which is that in which they are asked for.
constexpr std::array<Row, kSignalIds> kRows = {{
    {SignalId::statusword, "statusword", {0x6041, 0}, Reading::never},
    {SignalId::position, "position_actual", {0x6064, 0}, Reading::never},
    {SignalId::velocity, "velocity_actual", {0x606C, 0}, Reading::always},
    {SignalId::effort, "torque_actual", {0x6077, 0}, Reading::always},
    {SignalId::following_error, "following_error", {0x60F4, 0}, Reading::when_looked_at},
    {SignalId::mode_display, "mode_display", {0x6061, 0}, Reading::always},
    {SignalId::error_code, "error_code", {0x603F, 0}, Reading::never},  // ErrorEvidence asks
    {SignalId::digital_inputs, "digital_inputs", {0x60FD, 0}, Reading::always},
}};

/// The fixed name of the profile format, or else the standard's own index.
const ObjectSpec* findObject(const DriveProfile& profile, const Row& row) {
  const ObjectSpec* spec = profile.find(row.name);
  return spec != nullptr ? spec : profile.find(profile.own(row.object));
}

void require(const Signal& signal, const AxisConfig& config, const fieldbus::Device& device,
             const std::string& what) {
  if (signal.mapped()) return;
  throw std::invalid_argument(whoIs(config) + ": " + what + " must be mapped into a " +
                              device.terms().cyclic);
}

}  // namespace

Signals::Signals(const AxisConfig& config, fieldbus::Device& device)
    : device_(device), image_(device.image()) {
  const DriveProfile& profile = *config.profile;
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    rows_[i] = make(config, findObject(profile, kRows[i]), kRows[i].reading);
  }
  named_.reserve(profile.signals.size());
  for (const std::string& name : profile.signals) {
    named_.push_back(make(config, profile.find(name), Reading::when_looked_at));
  }
  require((*this)[SignalId::statusword], config, device,
          "the statusword (" + profile.address(0x6041) + ")");
  require((*this)[SignalId::position], config, device,
          "the actual position (" + profile.address(0x6064) + ")");
}

Signal Signals::make(const AxisConfig& config, const ObjectSpec* spec, Reading reading) {
  Signal row;
  const auto& lacks = config.lacks;
  const bool lacking =
      spec == nullptr || std::find(lacks.begin(), lacks.end(), spec->name) != lacks.end();
  if (!lacking) {
    row.spec = spec;
    row.slot = image_.inputSlot(spec->id);
    if (row.mapped()) row.value = &image_.input(row.slot);
    const auto conversion = Conversion::create(*spec, *config.profile, config.geometry);
    if (conversion) {
      row.conversion = *conversion;
    } else if (spec->quantity != Quantity::none) {
      row = Signal();  // e.g. torque without a rated torque: unknown rather than wrong
    }
  }
  row.polled = poller_.add(row, reading);
  if (row.polled >= 0) row.asked = &poller_.value(row.polled);
  if (row.polled >= 0 && reading == Reading::always) row.value = row.asked;
  return row;
}

bool Signals::travels(const Signal& row) const {
  return row.mapped() && !image_.inputLeftOut(row.slot);
}

void Signals::look() {
  const auto ask = [this](const Signal& row) {
    if (row.polled >= 0 && !travels(row)) poller_.look(row.polled);
  };
  for (const Signal& row : rows_) ask(row);
  for (const Signal& row : named_) ask(row);
}

std::vector<ShownSignal> Signals::shown(Time now) const {
  std::vector<ShownSignal> all;
  for (const Signal& row : named_) {
    const fieldbus::ProcessValue* value = travels(row) ? told(row) : nullptr;
    if (value == nullptr) value = poller_.value(row.polled, now);
    ShownSignal shown;
    shown.object = row.spec;
    shown.known = value != nullptr;
    if (shown.known) {
      shown.raw = value->raw;
      shown.stamp = value->stamp;
    }
    all.push_back(shown);
  }
  return all;
}

}  // namespace cia402::drive
