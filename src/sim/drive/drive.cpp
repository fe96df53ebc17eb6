// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/drive.h"
#include "common/text.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "sim/definition/drive_definition.h"
#include "sim/dictionary/axis_objects.h"
#include "sim/drive/build_dictionary.h"
#include "sim/drive/drive_axis.h"
#include "sim/drive/effect_times.h"
#include "sim/drive/emergency_sender.h"
#include "sim/drive/gate.h"
#include "sim/drive/maker_state.h"
#include "sim/drive/object_roles.h"
#include "sim/drive/own_bus.h"
#include "sim/drive/parameter_store.h"
#include "sim/drive/raw_faults.h"

namespace cia402::sim {
namespace {

constexpr Duration kPowerCycle = std::chrono::milliseconds(500);
constexpr Duration kSoftwareReset = std::chrono::milliseconds(10);  // the write is answered before

}  // namespace

struct Drive::Impl : Device::Application, DriveCore::Reports {
  Impl(std::shared_ptr<const DriveDefinition> drive_definition, canopen::NodeId node,
       can::Sink& sink, const AxisMechanics& mechanics, const DriveIdentity& identity,
       const std::vector<AxisMechanics>& further)
      : definition(std::move(drive_definition)),
        dictionary(buildDictionary(*definition, node, identity)),
        effects(definition->own.effects, dictionary),
        own_bus(definition->own.bus, dictionary),
        gate(sink),
        device(node, gate, dictionary, definition->communication, *this),
        emergencies(*definition, device),
        store(
            dictionary, definition->memory, definition->axisCount(),
            [this] { return !definition->stores_while_enabled && enabled(); },
            [this] { forEach(&DriveCore::onParametersStored); }) {
    for (unsigned i = 0; i < definition->axisCount(); ++i) {
      const bool own = i > 0 && i <= further.size();
      axes.emplace_back(*definition, i, own ? further[i - 1] : mechanics, dictionary, *this);
    }
    installHooks();
  }

  void installHooks() {
    for (const auto& pair : dictionary.entries()) {
      const Entry& entry = pair.second;
      if (entry.access != Access::rw && entry.access != Access::wo) continue;
      if (entry.id.index < 0x2000) continue;
      dictionary.onWriteCheck(entry.id, [this](const Entry& e, std::uint64_t number) {
        return refuseWrite(e, number);
      });
      const auto role = roleOf(*definition, entry.id);
      const Encoding encoding = encodingOf(*definition, entry.id);
      const bool own = axes[0].terminals.holds(entry.id) || axes[0].encoder.holds(entry.id) ||
                       own_bus.holds(entry.id);
      if (role || encoding != Encoding::integer || own) {
        dictionary.onWrite(entry.id,
                           [this, role, encoding](const Entry& e) { written(e, role, encoding); });
      }
    }
  }

  DriveAxis& axisWith(const Entry& entry) {
    return axes[axisOf(entry.id, definition->axisCount())];
  }

  // An object of the device itself is refused by any of its axes.
  std::uint32_t refuseWrite(const Entry& entry, std::uint64_t number) {
    if (entry.id.index >= kFirstAxisObject) return axisWith(entry).core.refuseWrite(entry, number);
    std::uint32_t refused = 0;
    for (const DriveAxis& axis : axes) {
      if (refused == 0) refused = axis.core.refuseWrite(entry, number);
    }
    if (refused != 0) return refused;
    store.keep(entry, number);
    effects.writing(entry.id);
    return 0;
  }

  void written(const Entry& entry, std::optional<Role> role, Encoding encoding) {
    DriveAxis& axis = axisWith(entry);
    if (encoding != Encoding::integer && badFloat(decodeNumber(entry, encoding))) {
      ++axis.bad_floats;
      axis.core.onNonFinite();
      return;
    }
    if (role == Role::controlword) axis.core.onControlword();
    if (role == Role::mode) axis.core.onMode();
    if (role == Role::target_position || role == Role::interpolation_target) {
      axis.core.onTargetPosition();
    }
    if (role == Role::gear_numerator || role == Role::gear_denominator)
      axis.core.motion().publish();
    if (role == Role::touch_probe_function) axis.core.motion().parts().probes.command();
    if (role == Role::clear_errors && entry.number != 0) axis.core.resetFault();
    if (role == Role::software_reset && entry.number == 1) reset_at = now + kSoftwareReset;
    const bool command = role == Role::emergency_stop || role == Role::homing_start;
    const bool saves = role == Role::save_zero && entry.number != 0;
    if (role == Role::alarm_select || role == Role::home_offset || saves ||
        (command && entry.number == 1))
      axis.core.onWrite(*role);
    axis.encoder.written(entry);
    own_bus.written(entry, now);
    if (axis.terminals.holds(entry.id)) axis.obey();
  }

  bool badFloat(double value) const {
    if (!std::isfinite(value)) return definition->float_traps.non_finite;
    return value == 0.0 && std::signbit(value) && definition->float_traps.negative_zero;
  }

  /// Calls a method of every axis.
  template <typename Method, typename... Arguments>
  void forEach(Method method, Arguments... arguments) {
    for (DriveAxis& axis : axes) (axis.core.*method)(arguments...);
  }

  bool enabled() const {
    return std::any_of(axes.begin(), axes.end(),
                       [](const DriveAxis& axis) { return axis.core.enabled(); });
  }
  bool powered() {
    return std::any_of(axes.begin(), axes.end(),
                       [](DriveAxis& axis) { return axis.core.motion().powered(); });
  }
  std::uint8_t errorRegister() const {
    unsigned bits = 0;
    for (const DriveAxis& axis : axes) bits |= axis.core.faults().errorRegister();
    return static_cast<std::uint8_t>(bits);
  }

  // Device::Application
  void onPowerOn(Time time) override {
    now = time;
    heard = false;
    for (DriveAxis& axis : axes) axis.start(cold, time);
    forEach(&DriveCore::start, cold, time);
    gate.foreign = own_bus.foreign() || (cold ? store.silent() : gate.foreign);
    for (DriveAxis& axis : axes) axis.encoder.start(cold);
    cold = false;
  }
  std::optional<canopen::NodeId> ownNodeId() const override { return own_bus.nodeId(); }
  void onNodeId(canopen::NodeId before, canopen::NodeId now_is) override {
    for (const ObjectId id : definition->dictionary.nodeIdObjects()) {
      if (id != definition->own.bus.node_id) store.moveDefault(id, std::int64_t{now_is} - before);
    }
  }
  void onResetCommunication(Time) override {}  // the power drive system goes on
  void onNmtState(canopen::NmtState state, Time) override {
    forEach(&DriveCore::onNmtState, state);
    const bool booted = state == canopen::NmtState::pre_operational;
    if (booted && !heard) forEach(&DriveCore::onBootedAlone);
  }
  void onSync(Time) override { forEach(&DriveCore::onSync); }
  void onMasterLost(Time) override { forEach(&DriveCore::onMasterLost); }
  bool hasFault() const override {
    return std::any_of(axes.begin(), axes.end(),
                       [](const DriveAxis& axis) { return !axis.core.faults().empty(); });
  }

  // DriveCore::Reports: one EMCY channel and one 1001h for all axes.
  void emergency(const FaultDefinition& fault) override {
    emergencies.report(fault, errorRegister(), now);
  }
  void errorsGone() override { emergencies.errorsGone(errorRegister(), now); }

  void bringTo(Time time) {
    now = std::max(now, time);
    if (reset_at && now >= *reset_at) {
      cutPower();
      restart_at = std::exchange(reset_at, std::nullopt);
    }
    if (restart_at && now >= *restart_at) {
      const Time at = *restart_at;
      restart_at.reset();
      forEach(&DriveCore::advance, at);
      cold = true;
      device.powerOn(at);
    }
    for (DriveAxis& axis : axes) {
      axis.core.advance(now);
      axis.look(now);
    }
    showMakerState(definition->own.states, axes[0].core.statusword(),
                   axes[0].core.motion().powered(), dictionary);
    if (effects.watches() && effects.look(powered())) {
      for (DriveAxis& axis : axes) axis.obey();
    }
    if (now >= own_bus.due()) countOwnBus();
  }

  void cutPower() {
    device.powerOff();
    forEach(&DriveCore::powerOff);
    effects.powerOff();
    own_bus.powerOff();
  }

  void countOwnBus() {
    if (own_bus.count(device.node())) {
      device.receive(can::Frame(0x000, {130, device.node()}), now);  // reset communication
    }
    gate.foreign = own_bus.foreign();
  }

  // Another drive of the same kind takes this one's place: other serial number, as from the
  // factory.
  void exchange() {
    store.restore(1);
    own_bus.setUp();
    Entry* serial = dictionary.find({0x1018, 4});
    if (serial != nullptr) ++serial->initial_number;
  }

  // What ends with "clear".
  void removeTroubles() {
    gate.closed = false;
    emergencies.stopStorm();
    device.behaviour().sdo_silent = definition->communication.sdo_silent;
    device.behaviour().tpdo_size_error = definition->communication.tpdo_size_error;
    forEach(&DriveCore::removeCauses);
  }

  void flushChanges() {
    if (device.powered()) device.notifyChange(now);
  }

  std::shared_ptr<const DriveDefinition> definition;
  ObjectDictionary dictionary;
  EffectTimes effects;
  OwnBus own_bus;
  Gate gate;
  Device device;
  EmergencySender emergencies;
  std::deque<DriveAxis> axes;
  ParameterStore store;
  Time now{};
  std::optional<Time> restart_at;
  std::optional<Time> reset_at;  ///< by its own object
  RawFaults raw_faults;
  bool heard = false;  ///< anything, since power-on
  bool cold = false;
  bool first_power = true;
};

Drive::Drive(std::shared_ptr<const DriveDefinition> definition, canopen::NodeId node,
             can::Sink& sink, AxisMechanics mechanics, const DriveIdentity& identity,
             const std::vector<AxisMechanics>& further)
    : impl_(std::make_unique<Impl>(std::move(definition), node, sink, mechanics, identity,
                                   further)) {}

Drive::~Drive() = default;

void Drive::powerOn(Time now) {
  impl_->bringTo(now);
  impl_->restart_at.reset();
  impl_->cold = !impl_->first_power;  // at first an incremental counter stands where the rotor is
  impl_->first_power = false;
  impl_->device.powerOn(now);
}

void Drive::powerOff(Time now) {
  impl_->bringTo(now);
  impl_->restart_at.reset();
  impl_->cutPower();
}

void Drive::receive(const can::Frame& frame, Time now) {
  impl_->bringTo(now);
  impl_->heard = impl_->heard || !impl_->gate.shut();
  if (!impl_->gate.shut()) {
    impl_->axes[0].monitors.heard(frame);
    impl_->device.receive(frame, now);
  }
  impl_->flushChanges();
}

void Drive::tick(Time now) {
  impl_->bringTo(now);
  impl_->device.tick(now);
  impl_->emergencies.tick(impl_->now);
  impl_->flushChanges();
}

Time Drive::nextEvent() const {
  Time next =
      std::min({impl_->device.nextEvent(), impl_->emergencies.nextEvent(), impl_->own_bus.due()});
  for (const DriveAxis& axis : impl_->axes) next = std::min(next, axis.core.nextEvent());
  next = std::min(next, impl_->restart_at.value_or(kNever));
  return std::min(next, impl_->reset_at.value_or(kNever));
}

Result<void> Drive::inject(const std::string& fault, Time now, unsigned axis) {
  Impl& impl = *impl_;
  impl.bringTo(now);
  DriveCore& core = impl.axes.at(axis).core;
  if (const FaultDefinition* known = impl.definition->fault(fault)) {
    core.raise(*known);
  } else if (const ObstacleDefinition* obstacle = impl.definition->obstacle(fault)) {
    core.obstacle().put(obstacle);
    core.onObstacle();
  } else if (fault == "power_cycle" || fault == "exchange") {
    powerOff(now);
    if (fault == "exchange") impl.exchange();
    impl.restart_at = now + kPowerCycle;
  } else if (fault == "silent") {
    impl.gate.closed = true;
  } else if (fault == "sdo_silent") {
    impl.device.behaviour().sdo_silent = true;
  } else if (fault == "emergency_storm") {
    impl.emergencies.storm(impl.now);
  } else if (fault == "short_tpdos" || fault == "long_tpdos") {
    impl.device.behaviour().tpdo_size_error = fault == "short_tpdos" ? -1 : 1;
  } else if (fault == "blocked_rotor") {
    core.motion().motor().block(true);
  } else if (fault == "reversed_motor") {
    core.motion().motor().reverse(true);
  } else if (fault == "clear") {
    impl.removeTroubles();
  } else if (const FaultDefinition* raw = impl.raw_faults.find(fault)) {
    core.raise(*raw);
  } else {
    return Error{"no fault '" + fault + "' in the simulated drive " + impl.definition->name +
                 " (node " + std::to_string(impl.device.node()) +
                 "); known: " + joined(faultNames(), ", ") + ", or an error code like 0x7305"};
  }
  impl.flushChanges();
  return {};
}

std::vector<std::string> Drive::faultNames() const {
  std::vector<std::string> names;
  for (const FaultDefinition& fault : impl_->definition->faults) names.push_back(fault.name);
  for (const ObstacleDefinition& obstacle : impl_->definition->obstacles) {
    names.push_back(obstacle.name);
  }
  names.insert(names.end(),
               {"blocked_rotor", "clear", "emergency_storm", "exchange", "long_tpdos",
                "power_cycle", "reversed_motor", "sdo_silent", "short_tpdos", "silent"});
  return names;
}

void Drive::setProbe(unsigned probe, bool active, Time now, unsigned axis) {
  impl_->bringTo(now);
  impl_->axes.at(axis).core.motion().parts().probes.setInput(probe, active);
  impl_->flushChanges();
}

void Drive::setInput(unsigned bit, bool active, Time now, unsigned axis) {
  impl_->bringTo(now);
  DriveAxis& changed = impl_->axes.at(axis);
  changed.core.obstacle().setInput(bit, active);
  changed.core.onObstacle();
  changed.obey();
  impl_->flushChanges();
}

void Drive::setPulseWidth(double duty, Time now, unsigned axis) {
  impl_->bringTo(now);
  impl_->axes.at(axis).core.motion().parts().maker.setDuty(duty);
  impl_->flushChanges();
}

DriveTruth Drive::truth(Time now, unsigned axis) {
  impl_->bringTo(now);
  DriveTruth truth = impl_->axes.at(axis).truth();
  truth.nmt = impl_->device.nmtState();
  return truth;
}

void Drive::hangOn(std::uint32_t bit_rate) {
  impl_->device.setBusBitrate(bit_rate);
  impl_->own_bus.hangOn(bit_rate);
  if (impl_->first_power) impl_->own_bus.setUp();
}

unsigned Drive::axisCount() const { return static_cast<unsigned>(impl_->axes.size()); }
Device& Drive::device() { return impl_->device; }
ObjectDictionary& Drive::dictionary() { return impl_->dictionary; }
AxisMechanics& Drive::mechanics(unsigned axis) { return impl_->axes.at(axis).mechanics; }

}  // namespace cia402::sim
